// vinverter doctor: what works on this machine.
#include <fmt/format.h>
#include <unistd.h>

#include <memory>
#include <stdexcept>

#include "option_boards/ethernet_ip/encapsulation.hpp"
#include "sim/base/ipv4.hpp"
#include "sim/rig/folders.hpp"
#include "sim/transports/system_check.hpp"
#include "tools/vinverter/subcommands.hpp"

namespace vinv::tools {
namespace {

constexpr std::uint32_t kFirstAdapter = ipv4(127, 0, 0, 2);  // where plants put theirs

transports::Finding runtime_folder() {
  try {
    rig::make_private_folder(rig::runtime_root());
  } catch (const std::runtime_error& e) {
    return {false, e.what()};
  }
  return {true, "control sockets and names of serial lines go to " + rig::runtime_root() + "."};
}

int doctor() {
  const auto show = [](const char* what, const transports::Finding& finding, bool needed) {
    fmt::print("{:<4} {:<17} {}\n", finding.ok ? "ok" : needed ? "BAD" : "no", what, finding.sentence);
    return finding.ok || !needed;
  };
  bool good = true;
  good &= show("pseudo-terminals", transports::can_open_pty(), true);
  good &= show("TCP", transports::can_bind("127.0.0.1", 0), true);
  good &= show("runtime folder", runtime_folder(), true);
  show("TCP port 1502", transports::can_bind("127.0.0.1", 1502), false);
  show("TCP port 502", transports::can_bind("127.0.0.1", 502), false);
  show("TCP port 29536", transports::can_bind("127.0.0.1", 29536), false);
  show("EtherNet/IP", transports::can_be_adapter(kFirstAdapter, ethernet_ip::kEncapsulationPort, ethernet_ip::kIoPort),
       false);
  show("kernel CAN", transports::has_kernel_can(), false);
  show("real-time", transports::can_schedule_realtime(), false);
  fmt::print("\nlateness of a 1 ms tick over one second:\n{}\n", transports::measure_timer_lateness().text());
  return good ? kDone : kRefused;
}

}  // namespace

void add_doctor(CLI::App& app, int& exit_code) {
  CLI::App* sub = app.add_subcommand("doctor", "Tell what works on this machine, and how exact its timers are");
  sub->footer(
      "\nok: works. no: does not, and a plant runs without it. BAD: a plant cannot run.\n"
      "Exit codes: 0 a plant can run; 1 it cannot.");
  sub->callback([&exit_code] { exit_code = doctor(); });
}

}  // namespace vinv::tools
