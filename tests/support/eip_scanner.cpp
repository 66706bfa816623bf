#include "tests/support/eip_scanner.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

namespace vinv::scanner {
namespace {

constexpr std::uint16_t kIoPort = 2222;
constexpr int kAnswerMs = 10'000;

// Little-endian, appended.
struct Builder {
  Octets bytes;
  Builder& u8(unsigned v) {
    bytes.push_back(static_cast<std::uint8_t>(v));
    return *this;
  }
  Builder& u16(unsigned v) { return u8(v & 0xff).u8(v >> 8 & 0xff); }
  Builder& u32(std::uint32_t v) { return u16(v & 0xffff).u16(v >> 16); }
  Builder& add(const Octets& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return *this;
  }
};

// Little-endian, taken; zeros after the end.
struct Taker {
  const Octets& bytes;
  std::size_t at = 0;
  unsigned u8() { return at < bytes.size() ? bytes[at++] : (++at, 0u); }
  std::uint16_t u16() {
    const unsigned low = u8();
    return static_cast<std::uint16_t>(low | u8() << 8);
  }
  std::uint32_t u32() {
    const std::uint32_t low = u16();
    return low | static_cast<std::uint32_t>(u16()) << 16;
  }
  Octets rest(std::size_t n) {
    n = at >= bytes.size() ? 0 : std::min(n, bytes.size() - at);
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(n == 0 ? 0 : at);
    at += n;
    return {begin, begin + static_cast<std::ptrdiff_t>(n)};
  }
};

sockaddr_in address_of(std::uint32_t address, std::uint16_t port) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_port = htons(port);
  a.sin_addr.s_addr = htonl(address);
  return a;
}

bool readable(int fd, int timeout_ms) {
  pollfd p{fd, POLLIN, 0};
  return ::poll(&p, 1, timeout_ms) == 1;
}

Reply parse_reply(const Octets& message) {
  Reply r;
  if (message.size() < 4) return r;
  Taker t{message};
  r.answered = true;
  r.service = static_cast<std::uint8_t>(t.u8());
  t.u8();
  r.status = static_cast<std::uint8_t>(t.u8());
  for (unsigned n = t.u8(); n != 0; --n) r.extended.push_back(t.u16());
  r.data = t.rest(message.size());
  return r;
}

// Items of a common packet behind interface handle and time-out.
Octets data_item(const Octets& packet, std::uint16_t wanted) {
  Taker t{packet, 6};
  for (unsigned n = t.u16(); n != 0 && t.at < packet.size(); --n) {
    const std::uint16_t type = t.u16();
    const Octets data = t.rest(t.u16());
    if (type == wanted) return data;
  }
  return {};
}

// Interface handle, time-out, null address, unconnected data.
Octets unconnected(const Octets& message) {
  return Builder()
      .u32(0)
      .u16(10)
      .u16(2)
      .u16(0)
      .u16(0)
      .u16(0xb2)
      .u16(static_cast<unsigned>(message.size()))
      .add(message)
      .bytes;
}

Octets get_attribute_request(std::uint16_t class_id, std::uint16_t instance, std::uint8_t attribute) {
  return Builder()
      .u8(0x0e)
      .u8(5)
      .u8(0x21)
      .u8(0)
      .u16(class_id)
      .u8(0x25)
      .u8(0)
      .u16(instance)
      .u8(0x30)
      .u8(attribute)
      .bytes;
}

}  // namespace

EipScanner::~EipScanner() {
  disconnect();
  if (udp_ >= 0) ::close(udp_);
  for (const int fd : groups_) ::close(fd);
}

bool EipScanner::connect() {
  tcp_ = ::socket(AF_INET, SOCK_STREAM, 0);
  const sockaddr_in from = address_of(own_, 0), to = address_of(target_, port_);
  if (::bind(tcp_, reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0 ||
      ::connect(tcp_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    return false;
  if (!send_raw(encapsulate(0x65, {1, 0, 0, 0}))) return false;
  const Octets answer = receive_message(kAnswerMs);
  if (answer.size() != 28) return false;
  Taker t{answer, 4};
  session_ = t.u32();
  return session_ != 0;
}

void EipScanner::disconnect() {
  if (tcp_ >= 0) ::close(tcp_);
  tcp_ = -1;
  session_ = 0;
}

int EipScanner::new_udp(std::uint32_t address, std::uint16_t port, bool shared) const {
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  const int on = 1;
  ::setsockopt(fd, SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
  if (shared) ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const int room = 4 * 1024 * 1024;
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  const sockaddr_in a = address_of(address, port);
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&a), sizeof a) == 0) return fd;
  ::close(fd);
  return -1;
}

bool EipScanner::open_io() {
  udp_ = new_udp(own_, kIoPort, false);
  return udp_ >= 0;
}

bool EipScanner::join(std::uint32_t group) {
  const int fd = new_udp(group, kIoPort, true);
  if (fd < 0) return false;
  groups_.push_back(fd);
  ip_mreq request{};
  request.imr_multiaddr.s_addr = htonl(group);
  request.imr_interface.s_addr = htonl(own_);
  return ::setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0;
}

Octets EipScanner::encapsulate(std::uint16_t command, const Octets& data) const {
  return Builder()
      .u16(command)
      .u16(static_cast<unsigned>(data.size()))
      .u32(session_)
      .u32(0)
      .u32(0x11111111)
      .u32(0x22222222)
      .u32(0)
      .add(data)
      .bytes;
}

bool EipScanner::send_raw(const Octets& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::send(tcp_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

Octets EipScanner::receive_message(int timeout_ms) {
  Octets message;
  std::size_t wanted = 24;
  while (message.size() < wanted) {
    if (!readable(tcp_, timeout_ms)) return {};
    std::uint8_t buffer[2048];
    const ssize_t n = ::recv(tcp_, buffer, std::min(sizeof buffer, wanted - message.size()), 0);
    if (n <= 0) return {};
    message.insert(message.end(), buffer, buffer + n);
    if (message.size() == 24) wanted = 24 + (message[2] | static_cast<std::size_t>(message[3]) << 8);
  }
  return message;
}

Octets EipScanner::exchange(std::uint16_t command, const Octets& data) {
  if (!send_raw(encapsulate(command, data))) return {};
  const Octets answer = receive_message(kAnswerMs);
  if (answer.size() < 24) return {};
  return {answer.begin() + 24, answer.end()};
}

Reply EipScanner::request(const Octets& message) {
  return parse_reply(data_item(exchange(0x6f, unconnected(message)), 0xb2));
}

Reply EipScanner::get_attribute(std::uint16_t class_id, std::uint16_t instance, std::uint8_t attribute) {
  return request(get_attribute_request(class_id, instance, attribute));
}

Octets EipScanner::get_attribute_message(std::uint16_t class_id, std::uint16_t instance, std::uint8_t attribute) const {
  return encapsulate(0x6f, unconnected(get_attribute_request(class_id, instance, attribute)));
}

Opened EipScanner::open(const OpenOptions& o) {
  Builder b;
  b.u8(o.large ? 0x5b : 0x54).u8(2).u8(0x20).u8(6).u8(0x24).u8(1).u8(0x07).u8(0xe9);
  b.u32(0).u32(0x51000000u | o.connection_serial).u16(o.connection_serial).u16(o.vendor).u32(o.originator_serial);
  b.u8(o.timeout_multiplier).u8(0).u16(0);
  const auto parameters = [&](bool multicast, std::uint16_t size) {
    const unsigned flags = o.null ? 0 : (multicast ? 0x2000u : 0x4000u) | 0x0800u;
    if (o.large) {
      b.u16(size).u16(flags);
    } else {
      b.u16(flags | size);
    }
  };
  b.u32(o.o2t_rpi_us);
  parameters(false, o.o2t_size);
  b.u32(o.t2o_rpi_us);
  parameters(o.t2o_multicast, o.t2o_size);
  b.u8(o.transport).u8(static_cast<unsigned>(o.path.size() / 2)).add(o.path);
  const Octets answer = exchange(0x6f, unconnected(b.bytes));
  const Reply reply = parse_reply(data_item(answer, 0xb2));
  Opened opened;
  opened.asked = o;
  opened.status = reply.status;
  opened.extended = reply.extended;
  if (!reply.answered || reply.status != 0 || reply.data.size() < 26) return opened;
  opened.ok = true;
  Taker t{reply.data};
  opened.o2t_id = t.u32();
  opened.t2o_id = t.u32();
  t.rest(8);
  opened.o2t_api_us = t.u32();
  opened.t2o_api_us = t.u32();
  const Octets sockaddr = data_item(answer, 0x8001);
  if (sockaddr.size() == 16)
    opened.multicast_group = static_cast<std::uint32_t>(sockaddr[4]) << 24 |
                             static_cast<std::uint32_t>(sockaddr[5]) << 16 |
                             static_cast<std::uint32_t>(sockaddr[6]) << 8 | sockaddr[7];
  return opened;
}

Reply EipScanner::close(const Opened& c) {
  return request(Builder()
                     .u8(0x4e)
                     .u8(2)
                     .u8(0x20)
                     .u8(6)
                     .u8(0x24)
                     .u8(1)
                     .u8(0x07)
                     .u8(0xe9)
                     .u16(c.asked.connection_serial)
                     .u16(c.asked.vendor)
                     .u32(c.asked.originator_serial)
                     .u8(static_cast<unsigned>(c.asked.path.size() / 2))
                     .u8(0)
                     .add(c.asked.path)
                     .bytes);
}

Reply EipScanner::connected_request(Opened& class3, const Octets& message) {
  const Octets packet = Builder()
                            .u32(0)
                            .u16(0)
                            .u16(2)
                            .u16(0xa1)
                            .u16(4)
                            .u32(class3.o2t_id)
                            .u16(0xb1)
                            .u16(static_cast<unsigned>(message.size() + 2))
                            .u16(++class3.count)
                            .add(message)
                            .bytes;
  Octets data = data_item(exchange(0x70, packet), 0xb1);
  if (data.size() < 2) return {};
  data.erase(data.begin(), data.begin() + 2);
  return parse_reply(data);
}

void EipScanner::send_io(Opened& c, const Octets& data, bool run, bool modeless) {
  Builder payload;
  payload.u16(++c.count);
  if (!modeless) payload.u32(run ? 1 : 0);
  payload.add(data);
  const Octets packet = Builder()
                            .u16(2)
                            .u16(0x8002)
                            .u16(8)
                            .u32(c.o2t_id)
                            .u32(++c.sequence)
                            .u16(0xb1)
                            .u16(static_cast<unsigned>(payload.bytes.size()))
                            .add(payload.bytes)
                            .bytes;
  const sockaddr_in to = address_of(target_, io_port_);
  ::sendto(udp_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

std::optional<IoPacket> EipScanner::receive_io(int timeout_ms) {
  std::vector<pollfd> fds{{udp_, POLLIN, 0}};
  for (const int fd : groups_) fds.push_back({fd, POLLIN, 0});
  if (::poll(fds.data(), fds.size(), timeout_ms) <= 0) return std::nullopt;
  for (const pollfd& p : fds) {
    if ((p.revents & POLLIN) == 0) continue;
    Octets bytes(1500);
    sockaddr_in from{}, bound{};
    socklen_t size = sizeof from, bound_size = sizeof bound;
    const ssize_t n = ::recvfrom(p.fd, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    ::getsockname(p.fd, reinterpret_cast<sockaddr*>(&bound), &bound_size);
    if (n < 18) continue;
    bytes.resize(static_cast<std::size_t>(n));
    Taker t{bytes};
    IoPacket packet;
    packet.from = ntohl(from.sin_addr.s_addr);
    packet.to = ntohl(bound.sin_addr.s_addr);
    if (t.u16() != 2 || t.u16() != 0x8002 || t.u16() != 8) continue;
    packet.connection_id = t.u32();
    packet.sequence = t.u32();
    if (t.u16() != 0xb1) continue;
    packet.data = t.rest(t.u16());
    return packet;
  }
  return std::nullopt;
}

std::vector<Octets> EipScanner::list_identity(std::uint32_t to, std::uint16_t max_delay_ms, int listen_ms) {
  std::vector<Octets> answers;
  const int fd = new_udp(own_, 0, false);
  if (fd < 0) return answers;
  const Octets ask = Builder().u16(0x63).u16(0).u32(0).u32(0).u16(max_delay_ms).u16(0).u32(0).u32(0).bytes;
  const sockaddr_in address = address_of(to, port_);
  ::sendto(fd, ask.data(), ask.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(listen_ms);
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
    if (left <= 0 || !readable(fd, static_cast<int>(left))) break;
    Octets bytes(1500);
    const ssize_t n = ::recv(fd, bytes.data(), bytes.size(), 0);
    if (n <= 0) continue;
    bytes.resize(static_cast<std::size_t>(n));
    answers.push_back(std::move(bytes));
  }
  ::close(fd);
  return answers;
}

}  // namespace vinv::scanner
