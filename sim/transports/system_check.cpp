#include "sim/transports/system_check.hpp"

#include <linux/can.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <vector>

#include "sim/base/ipv4.hpp"
#include "sim/transports/io_error.hpp"
#include "sim/transports/port_holder.hpp"
#include "sim/transports/serial_pty.hpp"
#include "sim/transports/tcp_listener.hpp"
#include "sim/transports/udp_socket.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {
namespace {

constexpr int kArphrdCan = 280;  // linux/if_arp.h

std::string can_interfaces() {
  std::string names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/class/net", ignored)) {
    int type = 0;
    if (std::ifstream(entry.path() / "type") >> type && type == kArphrdCan) {
      names += (names.empty() ? "" : ", ") + entry.path().filename().string();
    }
  }
  return names;
}

// A refusal as it stands alone.
std::string sentence(std::string refusal) {
  if (refusal.front() >= 'a' && refusal.front() <= 'z')
    refusal.front() = static_cast<char>(refusal.front() - 'a' + 'A');
  return refusal + ".";
}

}  // namespace

kernel::LatenessHistogram measure_timer_lateness(Duration span) {
  EventLoop loop;
  loop.scheduler().schedule_every(instant_from_ns(1'000'000), std::chrono::milliseconds(1), kernel::Priority::kDrive,
                                  [&](Instant now) {
                                    if (now.time_since_epoch() >= span) loop.stop();
                                  });
  loop.run();
  return loop.lateness();
}

Finding has_kernel_can() {
  const UniqueFd fd(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
  if (!fd.is_open()) {
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
      return {false, "This kernel has no CAN sockets; try modprobe can can_raw vcan."};
    }
    return {false, "CAN sockets cannot be used: " + describe_errno(errno) + "."};
  }
  const std::string names = can_interfaces();
  if (names.empty()) {
    return {true, "CAN sockets work, but there is no CAN interface; make one with ip link add dev vcan0 type vcan."};
  }
  return {true, "CAN sockets work; interfaces: " + names + "."};
}

Finding can_bind(const std::string& host, std::uint16_t port) {
  EventLoop loop;
  TcpListenerOptions options;
  options.host = host;
  options.port = port;
  const auto listener = TcpListener::open(loop, options, [](Instant, std::unique_ptr<ByteStream>) {});
  if (!listener) return {false, sentence(listener.error())};
  return {true, "TCP " + host + " port " + std::to_string(port) + " is free to listen on."};
}

Finding can_be_adapter(std::uint32_t address, std::uint16_t explicit_port, std::uint16_t io_port) {
  EventLoop loop;
  std::string wrong;
  bool everywhere = false;
  const auto look = [&](PortKind kind, std::uint16_t port, const std::string& refusal) {
    if (refusal.empty()) return;
    wrong += sentence(refusal) + " ";
    for (const PortHolder& h : holders_of(kind, address, port)) {
      everywhere = everywhere || h.address != ipv4_text(address);
      wrong += h.address + ":" + std::to_string(port) + " is held by " +
               (h.program.empty() ? "a program of another user" : h.program) + ". ";
    }
  };
  const auto tcp = TcpListener::open(loop, {ipv4_text(address), explicit_port}, [](Instant, auto) {});
  look(PortKind::kTcp, explicit_port, tcp ? "" : tcp.error());
  const auto udp = UdpSocket::open(loop, {address, explicit_port});
  look(PortKind::kUdp, explicit_port, udp ? "" : udp.error());
  const auto io = UdpSocket::open(loop, {address, io_port});
  look(PortKind::kUdp, io_port, io ? "" : io.error());
  const std::string ports = "TCP and UDP " + std::to_string(explicit_port) + ", UDP " + std::to_string(io_port);
  if (wrong.empty()) return {true, "An adapter can be at " + ipv4_text(address) + " (" + ports + ")."};
  return {false, wrong + "An adapter needs " + ports + " of its own address" +
                     (everywhere ? ": who has them on every address has to bind its own only, or end." : ".")};
}

Finding can_schedule_realtime() {
  const int policy = ::sched_getscheduler(0);
  sched_param before{};
  if (policy < 0 || ::sched_getparam(0, &before) != 0) {
    return {false, "Real-time scheduling cannot be asked for: " + describe_errno(errno) + "."};
  }
  sched_param lowest{};
  lowest.sched_priority = ::sched_get_priority_min(SCHED_FIFO);
  if (::sched_setscheduler(0, SCHED_FIFO, &lowest) == 0) {
    ::sched_setscheduler(0, policy, &before);
    return {true, "Real-time scheduling (SCHED_FIFO) is permitted."};
  }
  const int error = errno;
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  return {false, "Real-time scheduling (SCHED_FIFO) is " + describe_errno(error) + "; RLIMIT_RTPRIO is " +
                     std::to_string(limit.rlim_cur) +
                     ". Raise rtprio in /etc/security/limits.conf or grant CAP_SYS_NICE if ticks are too late."};
}

Finding can_open_pty() {
  EventLoop loop;
  const auto line = SerialPty::open(loop, {});
  if (!line) return {false, sentence(line.error())};
  return {true, "Pseudo-terminals work (" + (*line)->name() + " was free)."};
}

}  // namespace vinv::transports
