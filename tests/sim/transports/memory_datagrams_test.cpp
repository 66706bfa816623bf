// A UDP network in memory.
#include "sim/transports/memory_datagrams.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace vinv::transports {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kA = ipv4(10, 0, 0, 1), kB = ipv4(10, 0, 0, 2), kC = ipv4(10, 0, 1, 3);

class MemoryDatagramsTest : public ::testing::Test {
 protected:
  std::unique_ptr<UdpPort> open(std::uint32_t address, std::uint16_t port, MemoryDatagrams* on = nullptr) {
    auto opened = (on != nullptr ? *on : network).open({address, port});
    EXPECT_TRUE(opened);
    auto p = std::move(*opened);
    const std::string name = ipv4_text(address) + ":" + std::to_string(port);
    p->set_handler([this, name](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
      heard.push_back(std::to_string(to_ns(now) / 1'000'000) + " " + name + " from " + ipv4_text(from.address) + " " +
                      std::string(bytes.begin(), bytes.end()));
    });
    return p;
  }
  static void send(kernel::Scheduler& scheduler, UdpPort& from, const Ipv4Endpoint& to, const std::string& text) {
    from.send(scheduler.now(), to, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  void send(UdpPort& from, const Ipv4Endpoint& to, const std::string& text) { send(scheduler, from, to, text); }
  std::vector<std::string> run(Duration d) {
    scheduler.run_until(scheduler.now() + d);
    return std::exchange(heard, {});
  }
  kernel::Scheduler scheduler;
  MemoryDatagrams network{scheduler, 2ms};
  std::vector<std::string> heard;
};

TEST_F(MemoryDatagramsTest, DatagramsArriveInOrderAfterTheDelay) {
  const auto a = open(kA, 100), b = open(kB, 200);
  send(*a, {kB, 200}, "one");
  send(*a, {kB, 200}, "two");
  EXPECT_TRUE(run(1ms).empty());
  send(*b, {kA, 100}, "three");
  EXPECT_EQ(run(10ms), (std::vector<std::string>{"2 10.0.0.2:200 from 10.0.0.1 one", "2 10.0.0.2:200 from 10.0.0.1 two",
                                                 "3 10.0.0.1:100 from 10.0.0.2 three"}));
}

TEST_F(MemoryDatagramsTest, NobodyThereIsLoss) {
  const auto a = open(kA, 100);
  send(*a, {kB, 200}, "one");
  send(*a, {kA, 101}, "two");
  run(10ms);
  EXPECT_EQ(network.lost(), 2u);
}

TEST_F(MemoryDatagramsTest, MulticastReachesMembersOnThePort) {
  const auto a = open(kA, 100), b = open(kB, 2222), c = open(kC, 2222), d = open(kC, 2223);
  const std::uint32_t group = ipv4(239, 192, 1, 0);
  ASSERT_TRUE(b->join(group));
  ASSERT_TRUE(d->join(group));
  EXPECT_FALSE(b->join(kA));
  send(*a, {group, 2222}, "x");
  EXPECT_EQ(run(10ms), std::vector<std::string>{"2 10.0.0.2:2222 from 10.0.0.1 x"});
  b->leave(group);
  send(*a, {group, 2222}, "y");
  EXPECT_TRUE(run(10ms).empty());
}

TEST_F(MemoryDatagramsTest, BroadcastsReachTheOthersOfTheNetwork) {
  const auto a = open(kA, 7), b = open(kB, 7), c = open(kC, 7);
  send(*a, {0xffffffff, 7}, "all");
  EXPECT_EQ(run(10ms).size(), 2u);
  send(*a, {ipv4(10, 0, 0, 255), 7}, "near");
  EXPECT_EQ(run(10ms), std::vector<std::string>{"12 10.0.0.2:7 from 10.0.0.1 near"});
  send(*a, {ipv4(10, 255, 255, 255), 7}, "far");
  EXPECT_EQ(run(10ms).size(), 2u);
}

TEST_F(MemoryDatagramsTest, UnpluggedHostNeitherSendsNorHears) {
  const auto a = open(kA, 7), b = open(kB, 7);
  send(*a, {kB, 7}, "under way");
  network.set_link(kB, false);
  send(*b, {kA, 7}, "unheard");
  EXPECT_TRUE(run(10ms).empty());
  network.set_link(kB, true);
  send(*b, {kA, 7}, "back");
  EXPECT_EQ(run(10ms).size(), 1u);
}

TEST_F(MemoryDatagramsTest, AddressIsTakenOnce) {
  auto a = open(kA, 7);
  EXPECT_FALSE(network.open({kA, 7}));
  a.reset();
  EXPECT_TRUE(network.open({kA, 7}));
}

TEST_F(MemoryDatagramsTest, AnswerWithoutDelayArrivesInTheSameInstant) {
  MemoryDatagrams fast(scheduler, 0ms);
  auto a = open(kA, 7, &fast), b = open(kB, 7, &fast);
  b->set_handler([&](Instant now, const Ipv4Endpoint& from, ByteView bytes) { b->send(now, from, bytes); });
  send(*a, {kB, 7}, "echo");
  EXPECT_EQ(run(0ms), std::vector<std::string>{"0 10.0.0.1:7 from 10.0.0.2 echo"});
}

TEST_F(MemoryDatagramsTest, SnapshotHasWhatIsUnderWay) {
  const auto a = open(kA, 7), b = open(kB, 7);
  run(5ms);
  send(*a, {kB, 7}, "one");
  struct Whole {
    kernel::Scheduler& scheduler;
    MemoryDatagrams& network;
    static void archive_whole(Archive& archive, Whole& w) {
      archive.io(w.scheduler);
      archive.io(w.network);
      w.scheduler.archive_waiting(archive);
    }
  } whole{scheduler, network};
  Bytes bytes;
  Archive out = Archive::saving(bytes);
  Whole::archive_whole(out, whole);
  out.seal();
  const auto uninterrupted = run(10ms);
  ASSERT_EQ(uninterrupted.size(), 1u);

  kernel::Scheduler later;
  MemoryDatagrams resumed(later, 2ms);
  const auto other = open(kB, 7, &resumed);
  Whole into{later, resumed};
  Archive in = Archive::loading(bytes);
  Whole::archive_whole(in, into);
  in.seal();
  ASSERT_FALSE(in.failed()) << in.error();
  later.run_until(later.now() + 10ms);
  EXPECT_EQ(heard, uninterrupted);
}

}  // namespace
}  // namespace vinv::transports
