// The servers and clients over real sockets and pseudo-terminals.
#include "sim/transports/can/can_servers.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "sim/transports/can/slcan_client.hpp"
#include "sim/transports/can/socketcan_port.hpp"
#include "sim/transports/can/socketcand_client.hpp"
#include "sim/transports/can/udp_multicast_port.hpp"
#include "sim/transports/system_check.hpp"
#include "tests/sim/transports/blocking_socket.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"
#include "tests/sim/transports/loop_thread.hpp"
#include "tests/sim/transports/tty_client.hpp"

namespace vinv::transports {
namespace {

using std::chrono::milliseconds;

// A bus at 1 Mbit/s with one node that answers frames from 0x100 to 0x6ff with the same data at the identifier before.
struct Plant {
  Plant() {
    thread.call([&] {
      CanBusOptions options;
      options.bitrate = 1'000'000;
      bus = std::make_unique<CanBus>(thread.loop().scheduler(), options);
      CanNodeOptions node_options;
      node_options.name = "answers";
      node = bus->attach(thread.loop().now(), node_options);
      node->set_handlers({[this](Instant t, const CanFrame& f) {
                            ++heard;
                            if (f.id < 0x100 || f.id >= 0x700) return;
                            CanFrame answer = f;
                            --answer.id;
                            node->send(t, answer);
                          },
                          {},
                          {}});
      auto s = SocketcandServer::open(thread.loop(), {}, {{{"vcan0", bus.get()}}, 0});
      ASSERT_TRUE(s) << s.error();
      socketcand = std::move(*s);
      auto l = SlcanServer::open(thread.loop(), {}, *bus);
      ASSERT_TRUE(l) << l.error();
      slcan = std::move(*l);
      auto p = SlcanPty::open(thread.loop(), "", *bus);
      ASSERT_TRUE(p) << p.error();
      pty = std::move(*p);
    });
  }
  ~Plant() {
    thread.call([&] {
      socketcand.reset();
      slcan.reset();
      pty.reset();
      node.reset();
      bus.reset();
    });
  }
  template <class Condition>
  bool eventually(Condition condition) {
    for (int i = 0; i < 1000; ++i) {
      bool yes = false;
      thread.call([&] { yes = condition(); });
      if (yes) return true;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return false;
  }

  LoopThread thread;
  std::unique_ptr<CanBus> bus;
  std::unique_ptr<CanNode> node;
  std::unique_ptr<SocketcandServer> socketcand;
  std::unique_ptr<SlcanServer> slcan;
  std::unique_ptr<SlcanPty> pty;
  std::atomic<int> heard{0};
};

BlockingSocket open_raw(std::uint16_t port, int receive_buffer = 0) {
  auto c = BlockingSocket::tcp(port, receive_buffer);
  EXPECT_EQ(c.receive(6), "< hi >");
  c.send("< open can0 >");
  EXPECT_EQ(c.receive(6), "< ok >");
  c.send("< rawmode >");
  EXPECT_EQ(c.receive(6), "< ok >");
  return c;
}

TEST(CanServers, EverySocketcandClientIsANodeAndHearsTheOthers) {
  Plant plant;
  auto a = open_raw(plant.socketcand->port());
  auto b = open_raw(plant.socketcand->port());
  a.send("< send 710 1 AB >");
  const std::string frame = b.receive(std::string(" < frame 710 0.000000 AB >").size());
  EXPECT_EQ(frame.substr(0, 13), " < frame 710 ");
  EXPECT_EQ(frame.substr(frame.size() - 5), " AB >");
  a.send("< echo >");  // its own frame does not come back
  EXPECT_EQ(a.receive(8), "< echo >");
  a.close();
  EXPECT_TRUE(plant.eventually([&] { return plant.socketcand->clients() == 1; }));
}

TEST(CanServers, SlcanWorksOnTcpAndOnAPseudoTerminal) {
  Plant plant;
  auto tcp = BlockingSocket::tcp(plant.slcan->port());
  tcp.send("S8\rO\r");
  EXPECT_EQ(tcp.receive(2), "\r\r");
  TtyClient tty(plant.pty->path());
  ASSERT_TRUE(tty.is_open());
  ASSERT_TRUE(tty.set_speed(B115200));
  ASSERT_TRUE(tty.write("C\rS8\rO\r"));
  EXPECT_EQ(tty.read(3), "\a\r\r");
  tcp.send("r7011\r");
  EXPECT_EQ(tcp.receive(2), "z\r");
  EXPECT_EQ(tty.read(6), "r7011\r");
  ASSERT_TRUE(tty.write("T0000070111F\r"));
  EXPECT_EQ(tty.read(2), "Z\r");
  EXPECT_EQ(tcp.receive(13), "T0000070111F\r");
  // The next client of the tty finds the channel open, as on a USB adapter.
  tty.close();
  TtyClient next(plant.pty->path());
  ASSERT_TRUE(next.write("F\r"));
  EXPECT_EQ(next.read(4), "F00\r");
}

TEST(CanServers, AClientThatDoesNotReadIsDisconnectedAndNobodyWaitsForIt) {
  Plant plant;
  auto dead = open_raw(plant.socketcand->port(), 4096);
  auto busy = open_raw(plant.socketcand->port());
  std::string burst;
  for (int i = 0; i < 100; ++i) burst += "< send 100 8 1 2 3 4 5 6 7 8 >";
  // What the dead client may owe is kMaxQueuedBytes and what the system's buffers hold: some thousand frames of 40
  // bytes.
  bool gone = false;
  for (int i = 0; i < 200 && !gone; ++i) {
    ASSERT_TRUE(busy.send(burst));
    for (int ends = 0; ends < 100;) {
      const std::string byte = busy.receive(1);
      ASSERT_EQ(byte.size(), 1u);
      ends += byte == ">" ? 1 : 0;
    }
    plant.thread.call([&] { gone = plant.socketcand->clients() == 1; });
  }
  EXPECT_TRUE(gone);
  EXPECT_TRUE(dead.ends());
}

TEST(UdpMulticastPort, HearsItsGroupAndNeitherItselfNorOtherGroupsOfTheMachine) {
  LoopThread thread;
  std::unique_ptr<UdpMulticastPort> a, b, other;
  std::atomic<int> heard_a{0}, heard_b{0}, heard_other{0};
  const auto open = [&](const char* group, std::atomic<int>& heard) {
    auto port = UdpMulticastPort::open(thread.loop(), {group, 43117, 0});
    EXPECT_TRUE(port) << port.error();
    (*port)->set_handlers({[&heard](Instant, const CanFrame&) { ++heard; }, {}, {}});
    return std::move(*port);
  };
  thread.call([&] {
    a = open("239.74.163.2", heard_a);
    b = open("239.74.163.2", heard_b);
    other = open("239.74.163.3", heard_other);
    // In this order: when the last has come, the one before it has come wherever it was to come.
    EXPECT_EQ(a->send(thread.loop().now(), CanFrame::standard(0x123, {1})), CanSend::kQueued);
    EXPECT_EQ(b->send(thread.loop().now(), CanFrame::standard(0x123, {2})), CanSend::kQueued);
  });
  for (int i = 0; i < 1000 && (heard_a < 1 || heard_b < 1); ++i) std::this_thread::sleep_for(milliseconds(5));
  thread.call([&] {
    EXPECT_EQ(heard_a, 1);
    EXPECT_EQ(heard_b, 1);
    EXPECT_EQ(heard_other, 0);
    a.reset();
    b.reset();
    other.reset();
  });
}

TEST(CanServers, ClientsBeyondTheLimitAreRefused) {
  Plant plant;
  std::vector<BlockingSocket> clients;
  for (std::size_t i = 0; i < kMaxCanClients; ++i) {
    clients.push_back(BlockingSocket::tcp(plant.slcan->port()));
    ASSERT_TRUE(clients.back().connected());
  }
  ASSERT_TRUE(plant.eventually([&] { return plant.slcan->clients() == kMaxCanClients; }));
  auto late = BlockingSocket::tcp(plant.slcan->port());
  EXPECT_TRUE(late.ends());
  clients.front().send("V\r");
  EXPECT_EQ(clients.front().receive(6), "V1013\r");
}

TEST(CanServers, APortInUseIsRefusedWithASentence) {
  Plant plant;
  plant.thread.call([&] {
    const auto second = SlcanServer::open(plant.thread.loop(), {"127.0.0.1", plant.slcan->port()}, *plant.bus);
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().find("address in use"), std::string::npos);
    const auto name = SocketcandServer::open(plant.thread.loop(), {"example.org", 0}, {});
    ASSERT_FALSE(name);
  });
}

// A client port that joins the plant's bus and counts what it hears.
template <class Open>
void expect_a_node(Plant& plant, Open open) {
  std::unique_ptr<CanPort> port;
  std::atomic<int> answers{0};
  plant.thread.call([&] {
    auto opened = open();
    ASSERT_TRUE(opened) << opened.error();
    port = std::move(*opened);
    port->set_handlers({[&](Instant, const CanFrame& f) { answers += f.id == 0x0ff && f.remote ? 1 : 0; }, {}, {}});
  });
  EXPECT_TRUE(plant.eventually([&] { return port->status().state == CanState::kErrorActive; }));
  EXPECT_TRUE(plant.eventually([&] {
    port->send(plant.thread.loop().now(), CanFrame::remote_request(0x100, 2));
    return answers > 0;
  }));
  plant.thread.call([&] { port.reset(); });
}

TEST(CanServers, OurClientsJoinOverTcpAndTty) {
  Plant plant;
  EventLoop& loop = plant.thread.loop();
  expect_a_node(plant, [&] { return SocketcandClient::open(loop, "127.0.0.1", plant.socketcand->port(), "vcan0"); });
  expect_a_node(plant, [&] { return SlcanClient::open_tcp(loop, "127.0.0.1", plant.slcan->port(), 1'000'000); });
  expect_a_node(plant, [&] { return SlcanClient::open_tty(loop, plant.pty->path(), 115'200, 1'000'000); });
}

TEST(CanServers, AClientComesBackWhenItsServerDoes) {
  Plant plant;
  EventLoop& loop = plant.thread.loop();
  std::unique_ptr<SocketcandClient> client;
  std::uint16_t port = 0;
  plant.thread.call([&] {
    port = plant.socketcand->port();
    plant.socketcand.reset();
    auto opened = SocketcandClient::open(loop, "127.0.0.1", port, "vcan0");
    ASSERT_TRUE(opened);
    client = std::move(*opened);
  });
  EXPECT_TRUE(plant.eventually([&] { return !client->error().empty(); }));
  plant.thread.call([&] {
    EXPECT_EQ(client->error(), "cannot connect to 127.0.0.1:" + std::to_string(port) + ": Connection refused");
    EXPECT_EQ(client->status().state, CanState::kOffline);
    auto again = SocketcandServer::open(loop, {"127.0.0.1", port}, {{{"vcan0", plant.bus.get()}}, 0});
    ASSERT_TRUE(again) << again.error();
    plant.socketcand = std::move(*again);
  });
  EXPECT_TRUE(plant.eventually([&] { return client->status().state == CanState::kErrorActive; }));
  plant.thread.call([&] {
    EXPECT_EQ(client->error(), "");
    client.reset();
    EXPECT_FALSE(SocketcandClient::open(loop, "localhost.example", 1, "x"));
  });
}

TEST(SocketCanPort, WithoutInterfaceOrKernelSupportTheRefusalSaysWhatToDo) {
  EventLoop loop;
  const auto port = SocketCanPort::open(loop, "vcan_none");
  ASSERT_FALSE(port);
  const bool has_can = has_kernel_can().ok;
  const std::string expected = has_can
                                   ? "cannot use CAN interface vcan_none: there is no such interface (make one with "
                                     "ip link add dev vcan_none type vcan)"
                                   : "cannot use CAN interface vcan_none: this kernel has no CAN sockets (try "
                                     "modprobe can can_raw vcan, or use a virtual bus with socketcand)";
  EXPECT_EQ(port.error(), expected);
  EXPECT_FALSE(SocketCanPort::open(loop, ""));
  EXPECT_FALSE(SocketCanPort::open(loop, "a_name_that_is_too_long"));
}

}  // namespace
}  // namespace vinv::transports
