// An EtherNet/IP adapter with two masters, UDP and time: streams in any pieces, good and mutilated requests,
// connections of every kind, packets, silence. Whatever comes, what is sent is well-formed, nothing grows without
// limit, and in the end a new master is served.
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

using vinv::Bytes;
using vinv::ByteView;
using vinv::ethernet_ip::Channel;
using vinv::test::AdapterBench;
using vinv::test::encapsulated;
using vinv::test::from_hex;
using vinv::test::Master;
using vinv::test::OpenWish;
namespace eip = vinv::ethernet_ip;

namespace {

constexpr int kMaxOperations = 250;
constexpr const char* kPaths[] = {"20 04 2C 15 2C 47", "20 04 2C 14 2C 46",
                                  "20 04 2C 1E 2C 47", "20 04 2C 1F 2C 47",
                                  "20 02 24 01",       "20 04 24 64 2C 15 2C 47 80 02 01 02 03 04",
                                  "20 04 2C 15 2C 50", "34 04 A1 00 02 00 38 00 01 0A 20 04 2C 15 2C 47"};
constexpr unsigned kSizes[] = {10, 6, 2, 8, 4, 500};

void check_sent(AdapterBench& bench) {
  bench.poll();
  for (const auto& p : bench.sent) {
    if (p.bytes.empty()) continue;
    if (p.channel == Channel::kIo) {
      const auto packet = eip::parse_common_packet(p.bytes);
      VINV_CHECK(packet && packet->address != eip::ItemType::kNullAddress && packet->data.size() <= 12);
    } else {
      const auto header = eip::parse_header(p.bytes);
      VINV_CHECK(header && header->length + eip::kEncapsulationHeader == p.bytes.size());
      VINV_CHECK(header->status == 0 || header->length <= 4);
    }
  }
  bench.sent.clear();
  const auto& c = bench.adapter.connections();
  VINV_CHECK(c.io_connections() <= 16 && c.explicit_connections() <= 16);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  AdapterBench bench;
  Master masters[2] = {Master::registered(bench), Master::registered(bench, vinv::ipv4(127, 0, 0, 2))};
  std::uint32_t ids[4] = {};
  for (int i = 0; i < kMaxOperations && !input.empty(); ++i) {
    const std::uint8_t operation = input.byte();
    const std::uint8_t argument = operation >> 3;
    Master& m = masters[argument & 1];
    switch (operation & 7) {
      case 0: bench.adapter.handle_tcp(bench.now, m.tcp, input.chunk(input.byte())); break;
      case 1: {  // a message with any data
        const unsigned command = input.byte();
        bench.adapter.handle_tcp(bench.now, m.tcp, encapsulated(command, m.session, input.chunk(input.byte())));
        break;
      }
      case 2: m.request(input.chunk(input.byte())); break;
      case 3: {
        OpenWish w;
        w.serial = argument & 6u;
        const std::uint8_t kind = input.byte();
        w.path = kPaths[kind & 7];
        w.large = (kind & 8) != 0;
        const std::uint8_t sizes = input.byte();
        w.o2t = 0x4800u | kSizes[sizes % 6];
        w.t2o = ((sizes & 0x40) != 0 ? 0x2800u : 0x4800u) | ((sizes & 0x80) != 0 ? 0x200u : 0u) | kSizes[sizes / 6 % 6];
        w.transport = input.byte();
        w.t2o_rpi_us = 1000u * (1u + (kind >> 4));
        const auto id = m.open_id(w);
        if (id != 0) ids[argument & 3] = id;
        break;
      }
      case 4: {
        const Bytes payload = input.chunk(input.byte() % 16);
        m.send_io_raw(ids[argument & 3], input.byte(), payload);
        break;
      }
      case 5:
        bench.device.set_input(input.byte() % 2 != 0 ? "01 02 03 04" : "05 06 07 08");
        bench.adapter.handle_new_data(bench.now);
        bench.advance(std::chrono::microseconds(700) * (1 << (argument % 16)));
        break;
      case 6:
        if (argument < 8) {
          bench.adapter.handle_udp(bench.now, {vinv::ipv4(127, 0, 0, 9), 1}, input.chunk(input.byte()),
                                   (argument & 2) != 0 ? eip::Cast::kBroadcast : eip::Cast::kUnicast);
        } else if (argument < 16) {
          bench.adapter.handle_io(bench.now, {vinv::ipv4(127, 0, 0, 1), 2222}, input.chunk(input.byte()));
        } else {
          m.connected(ids[argument & 3], input.byte(), input.chunk(input.byte() % 32));
        }
        break;
      default:
        if (argument < 4) {
          bench.adapter.handle_tcp_closed(bench.now, m.tcp);
          m.connect();
          m.register_session();
        } else if (argument < 8) {
          for (const auto ticket : std::exchange(bench.device.object.tickets, {}))
            bench.device.router().complete(ticket, {});
        } else if (argument == 8) {
          bench.adapter.stop();
          bench.adapter.start({vinv::ipv4(127, 0, 0, 5), 0, 2222});
        } else {
          OpenWish w;
          w.serial = argument & 6u;
          m.close(w);
        }
        break;
    }
    check_sent(bench);
  }

  // A fault-free end: everything times out, and a new master becomes the owner.
  bench.advance(std::chrono::hours(200));
  check_sent(bench);
  for (Master& m : masters) bench.adapter.handle_tcp_closed(bench.now, m.tcp);
  auto fresh = Master::registered(bench);
  VINV_CHECK(fresh.session != 0);
  VINV_CHECK(fresh.request_hex("0E 03 20 70 24 01 30 01") == "8E 00 00 00 34 12");
  VINV_CHECK(fresh.open_id({}) != 0);
  return 0;
}
