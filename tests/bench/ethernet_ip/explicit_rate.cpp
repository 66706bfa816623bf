#include "tests/bench/ethernet_ip/explicit_rate.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>

#include "sim/transports/unique_fd.hpp"
#include "tests/bench/ethernet_ip/measure.hpp"
#include "tests/support/eip_scanner.hpp"

namespace vinv::bench {
namespace {

using scanner::EipScanner;
using scanner::Octets;
using transports::UniqueFd;

constexpr int kMaxEvents = 128;

void no_delay(int fd) {
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

void watch(int epoll, int fd, std::uint32_t data) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u32 = data;
  ::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event);
}

// The least that a server can do. Never returns.
void serve_echo(int listener) {
  const UniqueFd epoll(::epoll_create1(0));
  watch(epoll.get(), listener, static_cast<std::uint32_t>(listener));
  std::array<epoll_event, kMaxEvents> events{};
  std::array<char, 2048> buffer{};
  for (;;) {
    const int count = ::epoll_wait(epoll.get(), events.data(), kMaxEvents, -1);
    for (int i = 0; i < count; ++i) {
      const int fd = static_cast<int>(events[static_cast<std::size_t>(i)].data.u32);
      if (fd == listener) {
        const int accepted = ::accept(listener, nullptr, nullptr);
        no_delay(accepted);
        watch(epoll.get(), accepted, static_cast<std::uint32_t>(accepted));
        continue;
      }
      const ssize_t size = ::recv(fd, buffer.data(), buffer.size(), 0);
      if (size <= 0) {
        ::close(fd);
      } else if (::send(fd, buffer.data(), static_cast<std::size_t>(size), MSG_NOSIGNAL) != size) {
        ::close(fd);
      }
    }
  }
}

struct Listener {
  Listener() : fd(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(fd.get(), reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(fd.get(), 256) != 0)
      throw std::runtime_error("the echo cannot listen");
    ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size);
    port = ntohs(address.sin_port);
  }
  UniqueFd fd;
  std::uint16_t port = 0;
};

UniqueFd connect_to(std::uint16_t port) {
  UniqueFd fd(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(port);
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    throw std::runtime_error("the echo does not answer");
  return fd;
}

// Connections that are ready for requests, with one epoll for all.
class Requesters {
 public:
  Requesters() : epoll_(::epoll_create1(0)) {}
  // Request: what is sent; answer: how many bytes come back, and what they end with.
  void add(int fd, Octets request, std::size_t answer, Octets answer_end) {
    no_delay(fd);
    watch(epoll_.get(), fd, static_cast<std::uint32_t>(all_.size()));
    all_.push_back({fd, std::move(request), std::move(answer_end), answer, 0});
  }
  // Round trips per second.
  double run(double seconds) {
    const std::int64_t start = monotonic_ns();
    const auto end = start + static_cast<std::int64_t>(seconds * 1e9);
    for (One& c : all_) send(c);
    std::uint64_t trips = 0;
    std::size_t under_way = all_.size();
    std::int64_t now = start;
    while (under_way != 0) {
      std::array<epoll_event, kMaxEvents> events{};
      const int count = ::epoll_wait(epoll_.get(), events.data(), kMaxEvents, 5000);
      if (count <= 0) throw std::runtime_error("no answer for 5 s");
      now = monotonic_ns();
      for (int i = 0; i < count; ++i) {
        One& c = all_[events[static_cast<std::size_t>(i)].data.u32];
        std::array<std::uint8_t, 2048> buffer{};
        const ssize_t size = ::recv(c.fd, buffer.data(), buffer.size(), 0);
        if (size <= 0) throw std::runtime_error("the server closed a connection");
        c.got += static_cast<std::size_t>(size);
        if (c.got < c.answer) continue;
        check(c, buffer.data() + size);
        c.got = 0;
        ++trips;
        if (now < end) {
          send(c);
        } else {
          --under_way;
        }
      }
    }
    return static_cast<double>(trips) * 1e9 / static_cast<double>(now - start);
  }

 private:
  struct One {
    int fd;
    Octets request, answer_end;
    std::size_t answer, got;
  };
  static void send(const One& c) {
    if (::send(c.fd, c.request.data(), c.request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(c.request.size()))
      throw std::runtime_error("a request could not be sent");
  }
  // end: of the bytes that came last; an answer comes in one piece, or its end does.
  static void check(const One& c, const std::uint8_t* end) {
    if (c.got != c.answer || !std::equal(c.answer_end.begin(), c.answer_end.end(), end - c.answer_end.size()))
      throw std::runtime_error("an answer is not the expected one");
  }
  UniqueFd epoll_;
  std::vector<One> all_;
};

ExplicitResult measure(const ExplicitOptions& o, unsigned connections, std::uint16_t echo_port) {
  std::vector<std::unique_ptr<EipScanner>> scanners;
  std::vector<UniqueFd> plain;
  Requesters server, echo;
  for (unsigned i = 0; i < connections; ++i) {
    scanners.push_back(std::make_unique<EipScanner>(o.own, o.host, o.port));
    EipScanner& s = *scanners.back();
    if (!s.connect()) throw std::runtime_error("the server does not register a session");
    const Octets request = s.get_attribute_message(o.class_id, o.instance, o.attribute);
    if (!s.send_raw(request)) throw std::runtime_error("the server does not take a request");
    const Octets answer = s.receive_message(5000);
    // Reply header 4 bytes, then the value; the reply starts 40 bytes into the message.
    if (answer.size() < 45 || answer[40] != 0x8e || answer[42] != 0)
      throw std::runtime_error("the server refuses the attribute");
    server.add(s.tcp(), request, answer.size(), {answer.begin() + 40, answer.end()});
    plain.push_back(connect_to(echo_port));
    const Octets same(std::max(request.size(), answer.size()), 0x55);
    echo.add(plain.back().get(), same, same.size(), {0x55});
  }
  server.run(o.round_s / 2);
  echo.run(o.round_s / 2);
  std::vector<double> server_rates, echo_rates, ratios;
  double cpu = 0, trips = 0;
  for (unsigned round = 0; round < o.rounds; ++round) {
    // Whoever comes first in a round has it in turns.
    if (round % 2 != 0) echo_rates.push_back(echo.run(o.round_s));
    const double before = o.pid != 0 ? cpu_seconds(o.pid) : 0;
    server_rates.push_back(server.run(o.round_s));
    if (o.pid != 0) cpu += cpu_seconds(o.pid) - before;
    trips += server_rates.back() * o.round_s;
    if (round % 2 == 0) echo_rates.push_back(echo.run(o.round_s));
    ratios.push_back(server_rates.back() / echo_rates.back());
  }
  ExplicitResult result;
  result.connections = connections;
  result.server_per_s = median(server_rates);
  result.echo_per_s = median(echo_rates);
  result.ratio = median(ratios);
  result.best_ratio = *std::max_element(ratios.begin(), ratios.end());
  result.cpu_us_per_trip = o.pid != 0 ? 1e6 * cpu / trips : 0;
  return result;
}

}  // namespace

std::vector<ExplicitResult> measure_explicit(const ExplicitOptions& options) {
  if (!pin(0, options.cpu) || (options.pid != 0 && !pin(options.pid, options.cpu)))
    throw std::runtime_error("the processes cannot be pinned to one processor");
  const Listener listener;
  const Child echo([&] { serve_echo(listener.fd.get()); });
  std::vector<ExplicitResult> results;
  for (const unsigned n : options.connections) results.push_back(measure(options, n, listener.port));
  return results;
}

}  // namespace vinv::bench
