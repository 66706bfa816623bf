#include "sim/scenario/live_run.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "sim/rig/live_plant.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"
#include "sim/transports/event_loop.hpp"
#include "sim/transports/udp_socket.hpp"

namespace vinv::scenario {
namespace {

namespace fs = std::filesystem;

struct OwnFolder {
  std::string path;
  OwnFolder() {
    std::string pattern = (fs::temp_directory_path() / "vinverter-scenario-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw std::runtime_error("no folder can be made like " + pattern + ": " + std::strerror(errno) + ".");
    path = pattern;
  }
  ~OwnFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

RunResult run_live(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options,
                   const std::function<void(const std::string& text)>& notice) {
  RunResult failed = not_run(scenario, options);
  try {
    const OwnFolder folder;
    transports::EventLoop loop;
    rig::LiveOptions live_options;
    live_options.fresh = true;
    live_options.state_folder = folder.path;
    live_options.seed = failed.seed;
    rig::LivePlant live(loop, scenario.plant, catalogue, live_options, notice);
    RunOptions run_options = options;
    run_options.live = true;
    run_options.open_udp =
        [&loop](const Ipv4Endpoint& own) -> Result<std::unique_ptr<transports::UdpPort>, std::string> {
      auto socket = transports::UdpSocket::open(loop, {own.address, own.port});
      if (!socket) return Unexpected(socket.error());
      return std::unique_ptr<transports::UdpPort>(std::move(*socket));
    };
    Runner runner(scenario, live.plant(), std::move(run_options));
    bool interrupted = false;
    runner.set_on_finished([&] { loop.stop(); });
    loop.on_signal([&](int) {
      interrupted = true;
      loop.stop();
    });
    runner.start();
    notice(live.table() + "control  " + live.control_path() + "\n");
    try {
      loop.run();
    } catch (const plant::SolverFailure& e) {
      runner.abort("the integration of the equations failed: " + rig::sentence(e.what()));
    }
    if (interrupted && !runner.finished()) runner.abort("interrupted at " + show_time(loop.scheduler().now()) + ".");
    return runner.take_result();
  } catch (const std::exception& e) {
    failed.reason = e.what();
    return failed;
  }
}

}  // namespace vinv::scenario
