// An adapter with time, and masters that write their frames out byte by byte.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "option_boards/ethernet_ip/adapter.hpp"
#include "tests/option_boards/ethernet_ip/fake_device.hpp"

namespace vinv::test {

using namespace std::chrono_literals;

struct SentPacket {
  Instant at{};
  ethernet_ip::Channel channel{};
  ethernet_ip::TcpId connection = 0;
  Ipv4Endpoint to;
  std::uint8_t dscp = 0;
  Bytes bytes;
};

inline Bytes join(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}
inline Bytes le16(unsigned value) { return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)}; }
inline Bytes le32(std::uint32_t value) { return join({le16(value & 0xffff), le16(value >> 16)}); }

// Header and data, with a sender context of 01 to 08.
inline Bytes encapsulated(unsigned command, std::uint32_t session, const Bytes& data) {
  return join({le16(command),
               le16(static_cast<unsigned>(data.size())),
               le32(session),
               le32(0),
               {1, 2, 3, 4, 5, 6, 7, 8},
               le32(0),
               data});
}
inline Bytes item(unsigned type, const Bytes& data) {
  return join({le16(type), le16(static_cast<unsigned>(data.size())), data});
}

// What a test wants of a Forward_Open; the rest is as most scanners have it.
struct OpenWish {
  unsigned serial = 1;
  unsigned vendor = 0x1337;
  std::uint32_t originator_serial = 42;
  std::uint32_t t2o_id = 0x11223344;
  std::uint32_t o2t_rpi_us = 10'000, t2o_rpi_us = 10'000;
  unsigned multiplier = 0;
  // size, 0x0200 variable, priority << 10, type << 13 (1 multicast, 2 point to point)
  unsigned o2t = 0x4800 | 10, t2o = 0x4800 | 6;
  unsigned transport = 0x01;
  std::string path = "20 04 2C 15 2C 47";
  bool large = false;  // parameters move to the upper half
  Bytes extra_items;   // of the common packet
  unsigned item_count = 2;
};

// An adapter of any device.
class AdapterRun {
 public:
  explicit AdapterRun(cip::Device& of, const ethernet_ip::AdapterOptions& options = {}) : adapter(of, options) {
    adapter.start(kAddress);
  }

  // Runs deadlines until then, and polls at each.
  void advance(Duration d) {
    const Instant until = now + d;
    poll();
    while (const auto next = adapter.next_deadline()) {
      if (*next > until) break;
      now = std::max(now, *next);
      adapter.handle_timeout(now);
      poll();
    }
    now = until;
  }
  void poll() {
    while (const auto t = adapter.poll_transmit(now))
      sent.push_back({now, t->channel, t->connection, t->to, t->dscp, {t->bytes.begin(), t->bytes.end()}});
    while (const auto id = adapter.poll_tcp_close()) closed.push_back(*id);
  }
  // What was sent on a channel since the last call.
  std::vector<SentPacket> take(ethernet_ip::Channel channel) {
    poll();
    std::vector<SentPacket> out;
    std::erase_if(sent, [&](const SentPacket& p) {
      if (p.channel == channel) out.push_back(p);
      return p.channel == channel;
    });
    return out;
  }
  std::vector<std::string> take_hex(ethernet_ip::Channel channel) {
    std::vector<std::string> out;
    for (const SentPacket& p : take(channel)) out.push_back(to_hex(p.bytes));
    return out;
  }

  static constexpr ethernet_ip::Adapter::Address kAddress{ipv4(127, 0, 0, 5), 0, 2222};
  ethernet_ip::Adapter adapter;
  Instant now = instant_from_ns(5'000'000'000);
  std::vector<SentPacket> sent;
  std::vector<ethernet_ip::TcpId> closed;
};

struct FakeDeviceHolder {
  FakeDevice device;
};
class AdapterBench : public FakeDeviceHolder, public AdapterRun {
 public:
  explicit AdapterBench(const ethernet_ip::AdapterOptions& options = {}) : AdapterRun(device, options) {}
  std::vector<std::string> take_log() { return std::exchange(device.log, {}); }
};

// A master on a TCP connection of its own.
class Master {
 public:
  explicit Master(AdapterRun& b, std::uint32_t address = ipv4(127, 0, 0, 1)) : bench(b), peer{address, 50'000} {
    connect();
  }
  void connect() { tcp = bench.adapter.handle_tcp_open(bench.now, peer).value_or(0); }
  // Registered on the way.
  static Master registered(AdapterRun& b, std::uint32_t address = ipv4(127, 0, 0, 1)) {
    Master m(b, address);
    m.register_session();
    return m;
  }

  Bytes send(const Bytes& bytes) {
    bench.adapter.handle_tcp(bench.now, tcp, bytes);
    Bytes all;
    for (const SentPacket& p : bench.take(ethernet_ip::Channel::kTcp))
      if (p.connection == tcp) all.insert(all.end(), p.bytes.begin(), p.bytes.end());
    return all;
  }
  Bytes command(unsigned code, const Bytes& data = {}) { return send(encapsulated(code, session, data)); }
  void register_session() {
    const Bytes answer = command(0x65, from_hex("01 00 00 00"));
    session = answer.size() == 28 ? read_le32(answer, 4) : 0;
  }
  // The message router's reply; empty if there is no answer, or the encapsulation refused.
  Bytes request(const Bytes& message, const Bytes& extra_items = {}, unsigned count = 2) {
    last = command(0x6f, join({le32(0), le16(5), le16(count), item(0, {}), item(0xb2, message), extra_items}));
    if (last.size() < 40) return {};
    const std::size_t size = read_le16(last, 38);
    return {last.begin() + 40, last.begin() + 40 + static_cast<std::ptrdiff_t>(size)};
  }
  std::string request_hex(std::string_view hex) { return to_hex(request(from_hex(hex))); }

  Bytes open(const OpenWish& w) {
    const Bytes path = from_hex(w.path);
    const auto parameters = [&](unsigned p) { return w.large ? join({le16(p & 0x1ff), le16(p & ~0x1ffu)}) : le16(p); };
    return request(join({{static_cast<std::uint8_t>(w.large ? 0x5b : 0x54), 2, 0x20, 6, 0x24, 1, 0x0a, 0x0e},
                         le32(0),
                         le32(w.t2o_id),
                         le16(w.serial),
                         le16(w.vendor),
                         le32(w.originator_serial),
                         {static_cast<std::uint8_t>(w.multiplier), 0, 0, 0},
                         le32(w.o2t_rpi_us),
                         parameters(w.o2t),
                         le32(w.t2o_rpi_us),
                         parameters(w.t2o),
                         {static_cast<std::uint8_t>(w.transport)},
                         {static_cast<std::uint8_t>(path.size() / 2)},
                         path}),
                   w.extra_items, w.item_count);
  }
  // The O->T identifier; 0 if refused.
  std::uint32_t open_id(const OpenWish& w) {
    const Bytes reply = open(w);
    return reply.size() >= 30 && reply[2] == 0 ? read_le32(reply, 4) : 0;
  }
  // "01: 0106", the general status and the extended words.
  std::string open_status(const OpenWish& w) { return status_of(open(w)); }
  static std::string status_of(const Bytes& reply) {
    if (reply.size() < 4) return "nothing";
    char text[8];
    std::snprintf(text, sizeof text, "%02X", reply[2]);
    std::string all = text;
    for (std::size_t i = 0; i < reply[3]; ++i) {
      std::snprintf(text, sizeof text, " %04X", read_le16(reply, 4 + 2 * i));
      all += text;
    }
    return all;
  }
  Bytes close(const OpenWish& w) {
    const Bytes path = from_hex(w.path);
    return request(join({{0x4e, 2, 0x20, 6, 0x24, 1, 0x0a, 0x0e},
                         le16(w.serial),
                         le16(w.vendor),
                         le32(w.originator_serial),
                         {static_cast<std::uint8_t>(path.size() / 2), 0},
                         path}));
  }
  // A class 1 packet: sequenced address, sequence count, run/idle header with run, data.
  void send_io(std::uint32_t id, std::uint32_t sequence, unsigned count, std::string_view hex, bool run = true) {
    send_io_raw(id, sequence, join({le16(count), le32(run ? 1 : 0), from_hex(hex)}));
  }
  void send_io_raw(std::uint32_t id, std::uint32_t sequence, const Bytes& data) {
    bench.adapter.handle_io(bench.now, {peer.address, 2222},
                            join({le16(2), item(0x8002, join({le32(id), le32(sequence)})), item(0xb1, data)}));
  }
  // A class 3 request; the data of the answer's data item.
  Bytes connected(std::uint32_t id, unsigned sequence, const Bytes& message) {
    const Bytes answer = command(
        0x70, join({le32(0), le16(0), le16(2), item(0xa1, le32(id)), item(0xb1, join({le16(sequence), message}))}));
    return answer.size() < 44 ? answer : Bytes(answer.begin() + 44, answer.end());
  }

  AdapterRun& bench;
  Ipv4Endpoint peer;
  ethernet_ip::TcpId tcp = 0;
  std::uint32_t session = 0;
  Bytes last;  // the whole answer
};

}  // namespace vinv::test
