// UDP sockets of this machine. Addresses depend on the process: others may run the same tests.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "sim/transports/broadcast_listener.hpp"
#include "sim/transports/udp_socket.hpp"

namespace vinv::transports {
namespace {

using namespace std::chrono_literals;

class UdpTest : public ::testing::Test {
 protected:
  std::unique_ptr<UdpSocket> open(const UdpSocketOptions& options) {
    auto opened = UdpSocket::open(loop, options);
    EXPECT_TRUE(opened) << opened.error();
    auto socket = std::move(*opened);
    socket->set_handler(recorder());
    return socket;
  }
  UdpPort::OnDatagram recorder() {
    return [this](Instant, const Ipv4Endpoint& from, ByteView bytes) {
      heard.push_back({from, std::string(bytes.begin(), bytes.end())});
    };
  }
  static void send(UdpPort& from, const Ipv4Endpoint& to, const std::string& text, std::uint8_t dscp = 0) {
    from.send({}, to, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, dscp);
  }
  // Until so many datagrams have come; then a little longer for those that should not.
  void run_until_heard(std::size_t count, Duration limit = 5s) {
    const Instant end = loop.scheduler().now() + limit;
    loop.scheduler().schedule_every(loop.scheduler().now() + 20ms, 20ms, kernel::Priority::kObserver,
                                    [&, end, count](Instant now) {
                                      if (heard.size() >= count || now >= end) loop.stop();
                                    });
    loop.run();
  }
  static std::uint32_t address(unsigned last) {
    const auto id = static_cast<unsigned>(::getpid());
    return ipv4(127, 64 + (id >> 8) % 128, id % 256, last);
  }
  EventLoop loop;
  std::vector<std::pair<Ipv4Endpoint, std::string>> heard;
};

TEST_F(UdpTest, DatagramsComeFromTheBoundAddress) {
  const auto a = open({address(2)}), b = open({address(3)});
  send(*a, b->local(), "one");
  send(*a, b->local(), "two", 47);
  run_until_heard(2);
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[0].first, a->local());
  EXPECT_EQ(heard[0].second + heard[1].second, "onetwo");
}

TEST_F(UdpTest, ManyWaitingDatagramsAllArrive) {
  const auto a = open({address(2)}), b = open({address(3)});
  for (int i = 0; i < 100; ++i) send(*a, b->local(), std::to_string(i));
  run_until_heard(100);
  ASSERT_EQ(heard.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(heard[static_cast<std::size_t>(i)].second, std::to_string(i));
}

TEST_F(UdpTest, EveryAddressIsOnlyForThoseWhoSaySo) {
  UdpSocketOptions any;
  any.address = 0;
  const auto refused = UdpSocket::open(loop, any);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("every address"), std::string::npos);
  any.any_address = true;
  EXPECT_TRUE(UdpSocket::open(loop, any));
}

TEST_F(UdpTest, AddressInUseOrNotOurs) {
  const auto a = open({address(2)});
  const auto again = UdpSocket::open(loop, {a->local().address, a->local().port});
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().find("another program"), std::string::npos);
  EXPECT_FALSE(UdpSocket::open(loop, {ipv4(203, 0, 113, 9)}));
}

TEST_F(UdpTest, NobodyListeningDoesNotSwallowTheNextDatagram) {
  const auto a = open({address(2)}), b = open({address(3)});
  for (int i = 0; i < 3; ++i) {
    send(*a, {address(4), 9}, "x");
    send(*a, b->local(), "y");
  }
  run_until_heard(3);
  EXPECT_EQ(heard.size(), 3u);
}

TEST_F(UdpTest, MulticastOnTheLoopback) {
  const std::uint32_t group = ipv4(239, 192, static_cast<unsigned>(::getpid()) % 256, 32);
  UdpSocketOptions options;
  options.address = group;
  options.shared = true;
  const auto receiver = open(options);
  const auto sender = open({address(2)});
  // By the interface that the sender's address is on.
  const auto member = open({address(3)});
  ASSERT_TRUE(member->join(group));
  send(*sender, {group, receiver->local().port}, "m");
  run_until_heard(1);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_EQ(heard[0].first, sender->local());
}

TEST_F(UdpTest, BroadcastOnTheLoopbackIsHeardByEveryListener) {
  const auto where = find_interface(address(2));
  ASSERT_TRUE(where) << where.error();
  EXPECT_TRUE(where->is_loopback);
  EXPECT_EQ(ipv4_text(where->broadcast()), "127.255.255.255");
  const auto port = open({address(9)})->local().port;  // most likely free everywhere
  std::vector<Ipv4Endpoint> to_whom;
  const auto listen = [&](Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes) {
    to_whom.push_back(to);
    recorder()(now, from, bytes);
  };
  const auto one = BroadcastListener::open(loop, *where, port, listen);
  ASSERT_TRUE(one) << one.error();
  const auto two = BroadcastListener::open(loop, *where, port, listen);
  ASSERT_TRUE(two) << two.error();
  const auto sender = open({address(2)});
  send(*sender, {where->broadcast(), port}, "who");
  run_until_heard(2);
  EXPECT_EQ(heard.size(), 2u);
  EXPECT_EQ(to_whom, std::vector<Ipv4Endpoint>(2, {where->broadcast(), port}));
}

TEST_F(UdpTest, SocketOfAHostHearsTheGroupsThatItJoined) {
  const std::uint32_t group = ipv4(239, 193, static_cast<unsigned>(::getpid()) % 256, 32);
  const auto sender = open({address(2)}), member = open({address(3)});
  const Ipv4Endpoint to{group, member->local().port};
  send(*sender, to, "before");
  ASSERT_TRUE(member->join(group));
  send(*sender, to, "joined");
  send(*sender, member->local(), "own");
  run_until_heard(2);
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[0].first, sender->local());
  EXPECT_EQ(std::set({heard[0].second, heard[1].second}), (std::set<std::string>{"joined", "own"}));
  member->leave(group);
  send(*sender, to, "left");
  send(*sender, member->local(), "own again");
  run_until_heard(3);
  ASSERT_EQ(heard.size(), 3u);
  EXPECT_EQ(heard[2].second, "own again");
}

TEST_F(UdpTest, AddressWithoutInterface) { EXPECT_FALSE(find_interface(ipv4(203, 0, 113, 9))); }

}  // namespace
}  // namespace vinv::transports
