// Clients that mean no good at one adapter's sockets, while another adapter of the same process has an I/O connection:
// its packets keep coming, what it hears counts, and the attacked one serves an honest client afterwards.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "sim/rig/live_ethernet_ip.hpp"
#include "tests/bench/ethernet_ip/attacks.hpp"
#include "tests/bench/ethernet_ip/measure.hpp"
#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"
#include "tests/sim/transports/loop_thread.hpp"
#include "tests/support/eip_scanner.hpp"

namespace vinv::rig {
namespace {

using namespace std::chrono_literals;
using scanner::EipScanner;
using scanner::Opened;

// What one attack may cost in memory: full tables of connections with their buffers, and the heap's slack.
constexpr std::int64_t kMostGrowthBytes = 24 << 20;
constexpr auto kAttackTime = 700ms;

std::uint32_t address(unsigned last) {
  const auto id = static_cast<unsigned>(::getpid());
  return ipv4(127, 64 + (id >> 8) % 60, id % 256, last);
}

struct Unit {
  Unit() : adapter(device, {}) {}
  test::FakeDevice device;
  ethernet_ip::Adapter adapter;
  std::unique_ptr<EthernetIpPort> port;
};

class Hostile : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    // Before there are threads: a child has one only.
    attacker = std::make_unique<bench::Child>([] {
      ::usleep(300'000);  // the adapters open their sockets
      std::atomic<std::uint64_t> count{0};
      bench::Victim victim;
      victim.host = address_of_parent(1);
      victim.input_only_point = 30;
      bench::attack(GetParam(), victim, count);
    });
    thread = std::make_unique<transports::LoopThread>();
    thread->call([this] {
      host = std::make_unique<LiveEthernetIp>(thread->loop());
      for (unsigned i = 0; i < 2; ++i) {
        EthernetIpAddress where;
        where.address = address(i + 1);
        units[i].port = std::make_unique<EthernetIpPort>(thread->loop().scheduler(), units[i].adapter);
        const auto added = host->add(*units[i].port, where);
        ASSERT_TRUE(added) << added.error();
        units[i].port->start(thread->loop().now(), {where.address, 0, where.io_port});
      }
    });
  }
  void TearDown() override {
    attacker.reset();
    thread->call([this] {
      host.reset();
      for (Unit& unit : units) unit.port.reset();
    });
  }
  static std::uint32_t address_of_parent(unsigned last) {
    const auto id = static_cast<unsigned>(::getppid());
    return ipv4(127, 64 + (id >> 8) % 60, id % 256, last);
  }

  Unit units[2];
  std::unique_ptr<bench::Child> attacker;
  std::unique_ptr<transports::LoopThread> thread;
  std::unique_ptr<LiveEthernetIp> host;
};

TEST_P(Hostile, NeighbourKeepsItsConnectionAndMemoryStaysBounded) {
  EipScanner master(address(200), address(2));
  ASSERT_TRUE(master.connect() && master.open_io());
  scanner::OpenOptions options;
  options.path = {0x20, 4, 0x2c, 21, 0x2c, 71};
  options.timeout_multiplier = 3;
  Opened io = master.open(options);
  ASSERT_TRUE(io.ok);
  const std::int64_t before = bench::resident_bytes(::getpid());

  // The sequence numbers show whether one is missing on the way.
  std::uint32_t packets = 0;
  for (const auto end = std::chrono::steady_clock::now() + 300ms + kAttackTime;
       std::chrono::steady_clock::now() < end;) {
    const auto packet = master.receive_io(2000);
    ASSERT_TRUE(packet) << "the neighbour has fallen silent after " << packets << " packets";
    EXPECT_EQ(packet->sequence, ++packets);
    master.send_io(io, {1, 2, 3, 4});
  }
  EXPECT_GE(packets, 50u);  // of a hundred, on a machine with other work
  EXPECT_LT(bench::resident_bytes(::getpid()) - before, kMostGrowthBytes);
  EXPECT_EQ(master.get_attribute(0x70, 1, 1).status, 0);
  thread->call([this] {
    EXPECT_EQ(units[1].adapter.connections().io_connections(), 1u);
    for (const std::string& line : units[1].device.log) EXPECT_EQ(line.find("timed out"), std::string::npos) << line;
    EXPECT_LE(units[0].adapter.tcp_connections(), ethernet_ip::EncapsulationLimits{}.tcp_connections);
    EXPECT_LE(units[0].adapter.connections().io_connections(), ethernet_ip::ConnectionOptions{}.io_connections);
  });
  EXPECT_EQ(master.close(io).status, 0);
  attacker.reset();

  // The attacked adapter, once its attacker is gone; the kernel may have dropped a first attempt to connect.
  bool served = false;
  for (int i = 0; i < 50 && !served; ++i) {
    EipScanner honest(address(201), address(1));
    served = honest.connect() && honest.get_attribute(0x70, 1, 1).status == 0;
    if (!served) ::usleep(100'000);
  }
  EXPECT_TRUE(served);
}

INSTANTIATE_TEST_SUITE_P(EthernetIp, Hostile, ::testing::ValuesIn(bench::attack_names()), [](const auto& test) {
  std::string name;
  bool upper = true;
  for (const char c : test.param) {
    if (c != '-') name += upper ? static_cast<char>(std::toupper(c)) : c;
    upper = c == '-';
  }
  return name;
});

}  // namespace
}  // namespace vinv::rig
