// EtherNet/IP adapters on real sockets, each on an address of its own with the standard ports, and on a network in
// memory. Addresses depend on the process: others may run the same tests.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <set>

#include "sim/rig/live_ethernet_ip.hpp"
#include "sim/transports/ip_recorder.hpp"
#include "sim/transports/memory_datagrams.hpp"
#include "sim/transports/memory_link.hpp"
#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"
#include "tests/sim/transports/loop_thread.hpp"
#include "tests/sim/transports/temporary_folder.hpp"
#include "tests/support/eip_scanner.hpp"

namespace vinv::rig {
namespace {

using namespace std::chrono_literals;
using scanner::EipScanner;
using scanner::Octets;
using scanner::Opened;
using scanner::OpenOptions;

std::uint32_t address(unsigned last) {
  const auto id = static_cast<unsigned>(::getpid());
  return ipv4(127, 2 + (id >> 8) % 60, id % 256, last);
}

OpenOptions owner() {
  OpenOptions o;
  o.path = {0x34, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0x20, 4, 0x24, 0x65, 0x2c, 21, 0x2c, 71};
  return o;
}
OpenOptions with_heartbeat(std::uint8_t point, std::uint16_t serial) {
  OpenOptions o;
  o.connection_serial = serial;
  o.path = {0x20, 4, 0x2c, point, 0x2c, 71};
  o.o2t_size = 2;
  return o;
}

// Adapters on a loop of their own; everything of theirs is touched there.
class LiveAdapters : public ::testing::Test {
 protected:
  struct Unit {
    explicit Unit(std::uint64_t seed) : adapter(device, options(seed)) {}
    static ethernet_ip::AdapterOptions options(std::uint64_t seed) {
      ethernet_ip::AdapterOptions o;
      o.seed = seed;
      return o;
    }
    test::FakeDevice device;
    ethernet_ip::Adapter adapter;
    std::unique_ptr<EthernetIpPort> port;
  };
  void TearDown() override {
    thread.call([this] {
      host.reset();
      units.clear();
    });
  }
  void add(unsigned count) {
    thread.call([&] {
      if (!host) host = std::make_unique<LiveEthernetIp>(thread.loop());
      for (unsigned i = 0; i < count; ++i) {
        const auto last = static_cast<unsigned>(units.size() + 1);
        units.push_back(std::make_unique<Unit>(last));
        EthernetIpAddress where;
        where.address = address(last);
        std::string notice;
        Unit& unit = *units.back();
        unit.port = std::make_unique<EthernetIpPort>(thread.loop().scheduler(), unit.adapter);
        const auto added = host->add(*unit.port, where, &notice);
        ASSERT_TRUE(added) << added.error();
        EXPECT_EQ(notice, "");
        unit.port->start(thread.loop().now(), {where.address, 0, where.io_port});
      }
    });
  }
  std::vector<std::string> log(std::size_t unit) {
    std::vector<std::string> lines;
    thread.call([&] { lines = std::exchange(units[unit]->device.log, {}); });
    return lines;
  }
  // Answers each packet of the target until so many have come.
  static std::vector<scanner::IoPacket> run(EipScanner& s, Opened& c, std::size_t packets, const Octets& data,
                                            bool heartbeat = false) {
    std::vector<scanner::IoPacket> got;
    while (got.size() < packets) {
      const auto p = s.receive_io(5000);
      if (!p) break;
      got.push_back(*p);
      s.send_io(c, data, true, heartbeat);
    }
    return got;
  }

  transports::LoopThread thread;
  std::unique_ptr<LiveEthernetIp> host;
  std::vector<std::unique_ptr<Unit>> units;
};

TEST_F(LiveAdapters, OwnerRunsAndClosesAndAnotherOneWaitsForThat) {
  add(1);
  EipScanner one(address(200), address(1)), two(address(201), address(1));
  ASSERT_TRUE(one.connect() && one.open_io() && two.connect() && two.open_io());
  Opened c = one.open(owner());
  ASSERT_TRUE(c.ok);
  EXPECT_EQ(c.t2o_api_us, 10'000u);
  const auto packets = run(one, c, 20, {9, 8, 7, 6});
  ASSERT_EQ(packets.size(), 20u);
  EXPECT_EQ(packets[0].from, address(1));
  EXPECT_EQ(packets[19].connection_id, c.t2o_id);
  EXPECT_EQ(packets[19].sequence, 20u);
  OpenOptions rival = owner();
  rival.originator_serial = 77;
  EXPECT_EQ(two.open(rival).extended, std::vector<std::uint16_t>{0x0106});
  EXPECT_EQ(one.close(c).status, 0);
  rival.large = true;
  Opened second = two.open(rival);
  ASSERT_TRUE(second.ok);
  EXPECT_EQ(run(two, second, 3, {1, 1, 1, 1}).size(), 3u);
  const auto lines = log(0);
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines.front(), "owner 21/71 opened");
  EXPECT_NE(std::find(lines.begin(), lines.end(), "run 21: 09 08 07 06"), lines.end());
  EXPECT_NE(std::find(lines.begin(), lines.end(), "run 21: 01 01 01 01"), lines.end());
}

TEST_F(LiveAdapters, MulticastReachesOwnerAndListener) {
  add(1);
  EipScanner one(address(200), address(1)), two(address(201), address(1));
  ASSERT_TRUE(one.connect() && one.open_io() && two.connect() && two.open_io());
  OpenOptions listen = with_heartbeat(31, 5);
  listen.t2o_multicast = true;
  EXPECT_EQ(two.open(listen).extended, std::vector<std::uint16_t>{0x0119});
  OpenOptions o = owner();
  o.t2o_multicast = true;
  Opened master = one.open(o);
  ASSERT_TRUE(master.ok);
  ASSERT_NE(master.multicast_group, 0u);
  Opened listener = two.open(listen);
  ASSERT_TRUE(listener.ok);
  EXPECT_EQ(listener.multicast_group, master.multicast_group);
  EXPECT_EQ(listener.t2o_id, master.t2o_id);
  ASSERT_TRUE(one.join(master.multicast_group) && two.join(master.multicast_group));
  EXPECT_EQ(run(one, master, 5, {1, 2, 3, 4}).size(), 5u);
  const auto heard = run(two, listener, 3, {}, true);
  ASSERT_EQ(heard.size(), 3u);
  EXPECT_EQ(heard[0].to, master.multicast_group);
  EXPECT_EQ(one.close(master).status, 0);
  EXPECT_EQ(two.close(listener).status, 1);  // it ended with the owner's
}

TEST_F(LiveAdapters, SilenceTimesOutAndInputOnlyGoesOn) {
  add(1);
  EipScanner one(address(200), address(1)), two(address(201), address(1));
  ASSERT_TRUE(one.connect() && one.open_io() && two.connect() && two.open_io());
  OpenOptions o = owner();
  o.o2t_rpi_us = 50'000;  // 400 ms
  Opened master = one.open(o);
  Opened input = two.open(with_heartbeat(30, 6));
  ASSERT_TRUE(master.ok && input.ok);
  EXPECT_EQ(run(one, master, 2, {1, 2, 3, 4}).size(), 2u);
  EXPECT_EQ(run(two, input, 100, {}, true).size(), 100u);  // one second
  const auto lines = log(0);
  EXPECT_EQ(lines.back(), "owner 21/71 timed out");
}

TEST_F(LiveAdapters, Class3AndDelayedAnswers) {
  add(1);
  EipScanner one(address(200), address(1));
  ASSERT_TRUE(one.connect());
  OpenOptions o;
  o.transport = 0xa3;
  o.path = {0x20, 2, 0x24, 1};
  o.o2t_size = o.t2o_size = 500;
  o.timeout_multiplier = 3;
  o.o2t_rpi_us = o.t2o_rpi_us = 1'000'000;
  Opened c = one.open(o);
  ASSERT_TRUE(c.ok);
  const auto reply = one.connected_request(c, {0x0e, 3, 0x20, 0x70, 0x24, 1, 0x30, 1});
  EXPECT_EQ(reply.data, (Octets{0x34, 0x12}));
  EXPECT_EQ(one.get_attribute(0x70, 1, 1).data, (Octets{0x34, 0x12}));
  EXPECT_EQ(one.get_attribute(0x99, 1, 1).status, 5);
}

TEST_F(LiveAdapters, OneHundredAndTwentyEightInOneProcess) {
  constexpr unsigned kAdapters = 128;
  add(kAdapters);
  // One broadcast, all answer from their own addresses.
  EipScanner asker(address(200), address(1));
  std::set<std::uint32_t> found;
  for (const Octets& answer : asker.list_identity(ipv4(127, 255, 255, 255), 500, 1500)) {
    if (answer.size() < 44) continue;
    found.insert(static_cast<std::uint32_t>(answer[36]) << 24 | static_cast<std::uint32_t>(answer[37]) << 16 |
                 static_cast<std::uint32_t>(answer[38]) << 8 | answer[39]);
  }
  for (unsigned i = 1; i <= kAdapters; ++i) EXPECT_TRUE(found.contains(address(i))) << i;

  // One scanner each, all packets to one socket; every adapter produces every 10 ms.
  EipScanner io(address(200), address(1));
  ASSERT_TRUE(io.open_io());
  std::vector<std::unique_ptr<EipScanner>> scanners;
  std::map<std::uint32_t, std::size_t> by_address;
  for (unsigned i = 1; i <= kAdapters; ++i) {
    scanners.push_back(std::make_unique<EipScanner>(address(200), address(i)));
    ASSERT_TRUE(scanners.back()->connect()) << i;
    const Opened c = scanners.back()->open(owner());
    ASSERT_TRUE(c.ok) << i;
    by_address[address(i)] = 0;
  }
  const auto begin = std::chrono::steady_clock::now();
  std::size_t packets = 0;
  while (std::chrono::steady_clock::now() - begin < 1s) {
    const auto p = io.receive_io(100);
    if (!p) continue;
    ++by_address[p->from];
    ++packets;
  }
  EXPECT_EQ(by_address.size(), kAdapters);
  for (const auto& [from, count] : by_address) EXPECT_GT(count, 30u) << ipv4_text(from);  // 100 on an idle machine
  EXPECT_GT(packets, kAdapters * 60u);
}

TEST_F(LiveAdapters, NeighbourIsServedWhileOneIsFlooded) {
  add(2);
  EipScanner victim(address(200), address(2));
  ASSERT_TRUE(victim.connect() && victim.open_io());
  Opened c = victim.open(owner());
  ASSERT_TRUE(c.ok);
  // More connections than there are places, all silent, and garbage on each.
  std::vector<std::unique_ptr<EipScanner>> flood;
  for (int i = 0; i < 200; ++i) {
    flood.push_back(std::make_unique<EipScanner>(address(201), address(1)));
    if (flood.back()->connect()) flood.back()->send_raw({0x6f, 0, 0xff, 0xff, 1, 2, 3});
  }
  EXPECT_EQ(run(victim, c, 50, {1, 2, 3, 4}).size(), 50u);
  EXPECT_NE(victim.get_attribute(0x70, 1, 1).answered, false);
  std::size_t connections = 0;
  thread.call([&] { connections = units[0]->adapter.tcp_connections(); });
  EXPECT_LE(connections, ethernet_ip::EncapsulationLimits{}.tcp_connections);
}

// The same port in virtual time.
class MemoryAdapter : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kTarget = ipv4(192, 168, 1, 10), kMaster = ipv4(192, 168, 1, 1);
  kernel::Scheduler scheduler;
  transports::MemoryDatagrams network{scheduler, 100us};
  test::FakeDevice device;
  ethernet_ip::Adapter adapter{device, {}};
};

TEST_F(MemoryAdapter, ConnectionWorksAndALostLinkTimesItOut) {
  EthernetIpPort port(scheduler, adapter);
  port.connect(std::move(*network.open({kTarget, 44818})), std::move(*network.open({kTarget, 2222})),
               EthernetIpPort::Carrier::kInside);
  port.start(scheduler.now(), {kTarget, 0xffffff00, 2222});
  const auto io = std::move(*network.open({kMaster, 2222}));
  auto link = transports::make_memory_link(scheduler);
  port.accept(scheduler.now(), std::move(link.second), {kMaster, 50'000});
  Bytes answers;
  link.first->set_handlers([&](Instant, ByteView b, bool) { answers.insert(answers.end(), b.begin(), b.end()); },
                           [](Instant, const std::string&) {});
  link.first->send(scheduler.now(), test::encapsulated(0x65, 0, test::from_hex("01 00 00 00")));
  scheduler.run_until(scheduler.now() + 1ms);
  ASSERT_EQ(answers.size(), 28u);
  const std::uint32_t session = read_le32(answers, 4);
  answers.clear();
  const Bytes open = test::from_hex(
      "54 02 20 06 24 01 0A 0E 00 00 00 00 44 33 22 11 01 00 37 13 2A 00 00 00 00 00 00 00 10 27 00 00 0A 48 "
      "10 27 00 00 06 48 01 03 20 04 2C 15 2C 47");
  link.first->send(
      scheduler.now(),
      test::encapsulated(0x6f, session,
                         test::join({test::from_hex("00 00 00 00 05 00 02 00 00 00 00 00"), test::item(0xb2, open)})));
  std::vector<Instant> arrivals;
  std::uint32_t id = 0;
  std::uint32_t sequence = 0;
  io->set_handler([&](Instant now, const Ipv4Endpoint& from, ByteView) {
    if (id == 0) id = read_le32(answers, 44);
    arrivals.push_back(now);
    ++sequence;
    io->send(now, from,
             test::join({test::le16(2), test::item(0x8002, test::join({test::le32(id), test::le32(sequence)})),
                         test::item(0xb1, test::join({test::le16(sequence), test::le32(1), {1, 2, 3, 4}}))}));
  });
  const Instant begin = scheduler.now();
  scheduler.run_until(begin + 100ms);
  ASSERT_EQ(arrivals.size(), 10u);
  for (std::size_t i = 0; i < arrivals.size(); ++i)
    EXPECT_EQ(arrivals[i], begin + 100us + 10ms * static_cast<std::int64_t>(i));
  device.log.clear();
  network.set_link(kTarget, false);
  scheduler.run_until(begin + 200ms);
  EXPECT_EQ(device.log, std::vector<std::string>{"owner 21/71 timed out"});
}

// What tshark thinks of everything that the adapter sends: no complaint, and the connection's packets are known as
// such.
TEST_F(MemoryAdapter, TsharkDissectsARecordingWithoutAComplaint) {
  const transports::TemporaryFolder folder;
  const std::string path = folder / "enip.pcapng";
  {
    const auto recorder = transports::IpRecorder::open(path);
    ASSERT_TRUE(recorder);
    EthernetIpPort port(scheduler, adapter);
    port.connect((*recorder)->wrap(std::move(*network.open({kTarget, 44818}))),
                 (*recorder)->wrap(std::move(*network.open({kTarget, 2222}))), EthernetIpPort::Carrier::kInside);
    port.start(scheduler.now(), {kTarget, 0xffffff00, 2222});
    const auto udp = std::move(*network.open({kMaster, 50'000}));
    udp->send(scheduler.now(), {kTarget, 44818}, test::encapsulated(0x63, 0, {}));
    udp->send(scheduler.now(), {kTarget, 44818}, test::encapsulated(0x04, 0, {}));
    auto link = transports::make_memory_link(scheduler);
    port.accept(scheduler.now(), (*recorder)->wrap(scheduler.now(), std::move(link.second), ipv4_text(kTarget), 44818),
                {kMaster, 50'000});
    Bytes answers;
    link.first->set_handlers([&](Instant, ByteView b, bool) { answers.assign(b.begin(), b.end()); },
                             [](Instant, const std::string&) {});
    const auto say = [&](const Bytes& bytes) {
      link.first->send(scheduler.now(), bytes);
      scheduler.run_until(scheduler.now() + 1ms);
    };
    say(test::encapsulated(0x65, 0, test::from_hex("01 00 00 00")));
    const std::uint32_t session = read_le32(answers, 4);
    const auto ask = [&](const Bytes& message) {
      say(test::encapsulated(
          0x6f, session,
          test::join({test::from_hex("00 00 00 00 05 00 02 00 00 00 00 00"), test::item(0xb2, message)})));
    };
    const std::string open =
        "54 02 20 06 24 01 0A 0E 00 00 00 00 44 33 22 11 01 00 37 13 2A 00 00 00 00 00 00 00 10 27 00 00 0A 48 "
        "10 27 00 00 06 ";
    ask(test::from_hex(open + "28 01 03 20 04 2C 15 2C 47"));  // multicast
    ask(test::from_hex(open + "28 01 03 20 04 2C 15 2C 47"));  // duplicate
    ask(test::from_hex("56 02 20 06 24 01 01 00"));
    ask(test::from_hex("5A 02 20 06 24 01 00 03 20 04 2C 15 2C 47"));
    ask(test::from_hex("52 02 20 06 24 01 0A 0E 08 00 0E 03 20 70 24 01 30 01 01 00 01 00"));
    ask(test::from_hex("0E 03 20 70 24 01 30 01"));
    ask(test::from_hex("0E 03 20 99 24 01 30 01"));
    scheduler.run_until(scheduler.now() + 35ms);
    ask(test::from_hex("4E 02 20 06 24 01 0A 0E 01 00 37 13 2A 00 00 00 03 00 20 04 2C 15 2C 47"));
    say(test::encapsulated(0x77, session, {}));
    link.first->close();
    scheduler.run_until(scheduler.now() + 1ms);
  }
  const auto tshark = [&](const std::string& arguments) {
    FILE* pipe = ::popen(("tshark -r " + path + " " + arguments + " 2>/dev/null").c_str(), "r");
    std::string out;
    char buffer[4096];
    for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
    EXPECT_EQ(::pclose(pipe), 0);
    return out;
  };
  EXPECT_EQ(tshark("-Y '_ws.malformed || _ws.expert.severity >= 8388608'"), "");
  EXPECT_EQ(tshark("-o ip.check_checksum:TRUE -o udp.check_checksum:TRUE -Y 'ip.checksum.status == 0 || "
                   "udp.checksum.status == 0'"),
            "");
  const std::string multicast = tshark("-Y 'cipio && ip.dst == 239.192.2.32 && ip.dsfield.dscp == 47'");
  EXPECT_GE(std::count(multicast.begin(), multicast.end(), '\n'), 4);
  EXPECT_NE(tshark("-Y 'enip.command == 0x63 && enip.lir.prodcode == 56'"), "");
}

}  // namespace
}  // namespace vinv::rig
