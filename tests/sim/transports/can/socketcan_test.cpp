// The SocketCAN port on a real vcan0; run by in_vcan.py, as root of a kernel that has CAN.
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>

#include <cstdlib>
#include <deque>
#include <string>

#include "sim/transports/can/can_bridge.hpp"
#include "sim/transports/can/can_recorder.hpp"
#include "sim/transports/can/socketcan_port.hpp"
#include "sim/transports/unique_fd.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"

namespace vinv::transports {
namespace {

using std::chrono::milliseconds;

void system_call(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }

CanFrame extended(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  CanFrame f = CanFrame::standard(id, bytes);
  f.extended = true;
  return f;
}

struct Port {
  explicit Port(EventLoop& loop) {
    auto opened = SocketCanPort::open(loop, "vcan0");
    EXPECT_TRUE(opened) << opened.error();
    if (!opened) return;
    port = std::move(*opened);
    port->set_handlers({[this](Instant, const CanFrame& f) { log += show(f) + " "; },
                        [this](Instant, const CanFrame& f) { log += "sent:" + show(f) + " "; },
                        [this](Instant, const CanStatus& s) { log += "<" + std::string(text(s.state)) + "> "; }});
  }
  std::unique_ptr<SocketCanPort> port;
  std::string log;
};

class SocketCan : public testing::Test {
 protected:
  SocketCan() { system_call("ip link set vcan0 up"); }
  void run(Duration span) {
    loop.scheduler().schedule(loop.now() + span, kernel::Priority::kObserver, [this](Instant) { loop.stop(); });
    loop.run();
  }
  // Runs until the log is as expected, or ten seconds.
  void expect(const Port& p, const std::string& log) {
    for (int i = 0; i < 200 && p.log != log; ++i) run(milliseconds(50));
    EXPECT_EQ(p.log, log);
  }
  EventLoop loop;
};

TEST_F(SocketCan, FramesOfEveryKindPassAndOurOwnComeBackAsConfirmation) {
  Port a(loop);
  Port b(loop);
  EXPECT_EQ(a.port->status().state, CanState::kErrorActive);
  CanFrame ext_remote = CanFrame::remote_request(0x1abcdef0, 8);
  ext_remote.extended = true;
  for (const CanFrame& f :
       {CanFrame::standard(0x123, {1, 2, 3}), CanFrame::standard(0x7ff, {}), extended(0x123, {1, 2, 3, 4, 5, 6, 7, 8}),
        CanFrame::remote_request(0x705, 1), ext_remote}) {
    EXPECT_EQ(a.port->send(loop.now(), f), CanSend::kQueued);
  }
  expect(b, "123#010203 7FF# 00000123#0102030405060708 705#R1 1ABCDEF0#R8 ");
  expect(a, "sent:123#010203 sent:7FF# sent:00000123#0102030405060708 sent:705#R1 sent:1ABCDEF0#R8 ");
  EXPECT_EQ(a.port->status().sent, 5u);
  EXPECT_EQ(b.port->status().received, 5u);
  const auto refused = a.port->set_bitrate(loop.now(), 125'000);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "the bit rate of vcan0 is set by the system (ip link set vcan0 type can bitrate N)");
}

TEST_F(SocketCan, CanUtilsHearUsAndAreHeard) {
  Port a(loop);
  system_call("rm -f /run/candump.txt; candump -L -n 1 vcan0 > /run/candump.txt & sleep 0.5");
  system_call("cansend vcan0 705#R2; cansend vcan0 18FF1234#DEAD");
  expect(a, "705#R2 18FF1234#DEAD ");
  system_call("grep -q 'vcan0 705#R2' /run/candump.txt");
}

TEST_F(SocketCan, AnInterfaceMayGoDownAndUpAndBeMadeAnew) {
  Port a(loop);
  Port b(loop);
  system_call("ip link set vcan0 down");
  expect(a, "<offline> ");
  EXPECT_EQ(a.port->send(loop.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  EXPECT_EQ(a.port->queue_room(), 0u);
  system_call("ip link set vcan0 up");
  expect(a, "<offline> <error active> ");
  expect(b, "<offline> <error active> ");
  a.port->send(loop.now(), CanFrame::standard(1, {1}));
  expect(b, "<offline> <error active> 001#01 ");

  system_call("ip link del vcan0");
  expect(b, "<offline> <error active> 001#01 <offline> ");
  run(milliseconds(500));
  system_call("ip link add dev vcan0 type vcan && ip link set vcan0 up");
  expect(b, "<offline> <error active> 001#01 <offline> <error active> ");
  for (int i = 0; i < 100 && a.port->status().state == CanState::kOffline; ++i) run(milliseconds(50));
  a.port->send(loop.now(), CanFrame::standard(2, {2}));
  expect(b, "<offline> <error active> 001#01 <offline> <error active> 002#02 ");
}

TEST_F(SocketCan, AnInterfaceThatIsDownAtFirstIsWaitedFor) {
  system_call("ip link set vcan0 down");
  Port a(loop);
  run(milliseconds(300));
  EXPECT_EQ(a.port->status().state, CanState::kOffline);
  system_call("ip link set vcan0 up");
  expect(a, "<error active> ");
}

TEST_F(SocketCan, ErrorFramesTellTheStateOfTheController) {
  Port a(loop);
  const UniqueFd raw(::socket(PF_CAN, SOCK_RAW, CAN_RAW));
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex("vcan0"));
  ASSERT_EQ(::bind(raw.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const auto tell = [&](const CanErrorFrame& error) {
    can_frame f{};
    f.can_id = error.error_class | CAN_ERR_FLAG;
    f.can_dlc = 8;
    std::copy(error.data.begin(), error.data.end(), f.data);
    ASSERT_EQ(::write(raw.get(), &f, sizeof f), static_cast<ssize_t>(sizeof f));
  };
  tell(error_frame_of(CanStatus{CanState::kErrorWarning, {100, 0}, 0, 0, 0}));
  tell(error_frame_of(CanStatus{CanState::kErrorPassive, {130, 5}, 0, 0, 0}));
  expect(a, "<error warning> <error passive> ");
  EXPECT_EQ(a.port->status().counters, (CanErrorCounters{130, 5}));
  tell(error_frame_of(CanStatus{CanState::kBusOff, {}, 0, 0, 0}));
  expect(a, "<error warning> <error passive> <bus off> ");
  EXPECT_EQ(a.port->send(loop.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  CanErrorFrame restarted;
  restarted.error_class = 0x100;
  tell(restarted);
  expect(a, "<error warning> <error passive> <bus off> <error active> ");
}

TEST_F(SocketCan, SwitchedOffItHearsNothing) {
  Port a(loop);
  Port b(loop);
  b.port->set_online(loop.now(), false);
  a.port->send(loop.now(), CanFrame::standard(1, {}));
  run(milliseconds(100));
  b.port->set_online(loop.now(), true);
  a.port->send(loop.now(), CanFrame::standard(2, {}));
  expect(b, "<offline> <error active> 002# ");
}

// What a plant file's socketcan:vcan0 is made of: drives on a bus of ours without timing, and a bridge.
TEST_F(SocketCan, ABridgedBusAnswersRemoteFramesFromOutside) {
  CanBusOptions options;
  options.timing = CanBusOptions::Timing::kNone;
  CanBus bus(loop.scheduler(), options);
  auto opened = SocketCanPort::open(loop, "vcan0");
  ASSERT_TRUE(opened);
  CanBridge bridge(loop.now(), bus, std::move(*opened));
  std::deque<std::unique_ptr<CanNode>> nodes;
  for (std::uint8_t n = 1; n <= 10; ++n) {
    CanNodeOptions node_options;
    node_options.name = "drive " + std::to_string(n);
    nodes.push_back(bus.attach(loop.now(), node_options));
    CanNode* const node = nodes.back().get();
    node->set_handlers({[node, n](Instant now, const CanFrame& f) {
                          if (f.remote && f.id == 0x700u + n) node->send(now, CanFrame::standard(f.id, {0x7f}));
                        },
                        {},
                        {}});
  }
  Port master(loop);
  std::string expected;
  for (std::uint32_t n = 1; n <= 10; ++n) {
    master.port->send(loop.now(), CanFrame::remote_request(0x700 + n, 1));
    run(milliseconds(50));
  }
  for (int i = 0; i < 100 && master.port->status().received < 10; ++i) run(milliseconds(50));
  EXPECT_EQ(master.port->status().received, 10u);
  EXPECT_NE(master.log.find("70A#7F"), std::string::npos);
  EXPECT_EQ(bridge.lost(), 0u);
}

TEST_F(SocketCan, ABurstBeyondTheQueueIsRefusedAndTheRestArrives) {
  Port a(loop);
  Port b(loop);
  std::uint64_t queued = 0;
  for (int i = 0; i < 200; ++i) {
    queued +=
        a.port->send(loop.now(), CanFrame::standard(1, {static_cast<std::uint8_t>(i)})) == CanSend::kQueued ? 1 : 0;
  }
  for (int i = 0; i < 100 && b.port->status().received < queued; ++i) run(milliseconds(50));
  EXPECT_EQ(b.port->status().received, queued);
  EXPECT_EQ(a.port->status().sent, queued);
  EXPECT_EQ(a.port->status().lost + queued, 200u);
}

}  // namespace
}  // namespace vinv::transports
