// vinverter run: a plant in real time until a signal.
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "sim/rig/live_plant.hpp"
#include "sim/rig/words.hpp"
#include "tools/vinverter/subcommands.hpp"
#include "vinverter_data.hpp"

namespace vinv::tools {
namespace {

struct RunOptions {
  std::string plant_file;
  std::string ready_file;
  double duration_s = 0;
  rig::LiveOptions live;
};

constexpr double kLongestDuration = 1e8;  // s, three years

std::string is_duration(const std::string& text) {
  double seconds = 0;
  if (rig::parse_number(text, seconds) && seconds > 0 && seconds <= kLongestDuration) return {};
  return "\"" + text + "\" is no duration; allowed: a number of seconds, more than 0, up to 100000000.";
}

void notice(const std::string& sentence) { fmt::print(stderr, "vinverter: {}\n", sentence); }

rig::PlantFile plant_file_of(const RunOptions& options, const rig::Catalogue& catalogue) {
  if (options.plant_file.empty()) return rig::parse_plant_file(data::DEMO_PLANT, "demo.yaml (built in)", catalogue);
  return rig::load_plant_file(options.plant_file, catalogue);
}

int run(const RunOptions& options) {
  const rig::Catalogue catalogue = rig::shipped_catalogue();
  rig::PlantFile file = plant_file_of(options, catalogue);
  const std::string name = file.name;
  if (!options.ready_file.empty()) std::remove(options.ready_file.c_str());  // one of an earlier run says nothing

  // A client that goes away while it is being answered is no reason to end.
  std::signal(SIGPIPE, SIG_IGN);
  transports::EventLoop loop;
  rig::LivePlant live(loop, std::move(file), catalogue, options.live, notice);
  loop.on_signal([&](int) { loop.stop(); });
  std::string ready_failure;
  live.when_ready([&] {
    fmt::print("{}\ncontrol  {}\n         vinverter ctl --plant {} list\nEEPROM   {}\n", live.table(),
               live.control_path(), name, live.state_folder());
    std::fflush(stdout);
    if (options.ready_file.empty()) return;
    try {
      rig::write_whole_file(options.ready_file, live.ready_json().dump() + "\n");
    } catch (const std::runtime_error& e) {
      ready_failure = e.what();
      loop.stop();
    }
  });
  if (options.duration_s > 0)
    loop.scheduler().schedule(loop.scheduler().now() + seconds_to_duration(options.duration_s),
                              kernel::Priority::kObserver, [&](Instant) { loop.stop(); });
  loop.run();

  const std::string failure = live.store_eeproms();
  fmt::print("\nstopped after {:.1f} s\n{}\n", to_seconds(loop.scheduler().now()), loop.lateness().text());
  if (!options.ready_file.empty()) std::remove(options.ready_file.c_str());
  if (!ready_failure.empty()) throw std::runtime_error(ready_failure);
  if (failure.empty()) return kDone;
  notice(failure);
  return kRefused;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* sub = app.add_subcommand("run", "Run a plant in real time, until Ctrl-C");
  sub->add_option("PLANT", options->plant_file, "Plant file (docs/plant-file.md); default: the built-in demo");
  sub->add_option("--ready-file", options->ready_file,
                  "Write endpoints as JSON to this file, once everything is listening; removed at the end");
  sub->add_flag("--fresh", options->live.fresh, "Discard stored EEPROMs and flash memories: drives start with the plant file's values");
  sub->add_option(
      "--state-dir", options->live.state_folder,
      "Folder of the EEPROM files; default: $XDG_STATE_HOME/vinverter/PLANT or ~/.local/state/vinverter/PLANT");
  sub->add_option("--runtime-dir", options->live.runtime_folder,
                  "Folder of control socket and pseudo-terminal names; default: $XDG_RUNTIME_DIR/vinverter/PLANT or "
                  "/tmp/vinverter-UID/PLANT");
  sub->add_option("--record-ip", options->live.record_ip, "Record all TCP traffic and the UDP of EtherNet/IP to this pcapng file");
  sub->add_option("--record-can", options->live.record_can,
                  "Record CAN to this file: a candump log if it ends in .log, a capture if it ends in .pcapng; "
                  "NETWORK=FILE records one bus; may be repeated")
      ->allow_extra_args(false);
  sub->add_option("--duration", options->duration_s, "Stop after this many seconds")->check(is_duration);
  sub->footer(
      "\nSIGINT or SIGTERM stop the plant; EEPROMs are stored, and how late events ran is printed.\n"
      "Exit codes: 0 stopped; 1 an EEPROM could not be stored; 2 the plant cannot start.");
  sub->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace vinv::tools
