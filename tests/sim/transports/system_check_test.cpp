#include "sim/transports/system_check.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include "sim/base/ipv4.hpp"
#include "sim/transports/tcp_listener.hpp"
#include "sim/transports/udp_socket.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {
namespace {

TEST(SystemCheck, TimerLatenessCountsEveryTickOfItsSpan) {
  const auto h = measure_timer_lateness(std::chrono::milliseconds(50));
  EXPECT_EQ(h.count(), 50u);
}

TEST(SystemCheck, CanBindTellsAFreePortFromATakenOne) {
  EventLoop loop;
  const auto listener = TcpListener::open(loop, {}, [](Instant, std::unique_ptr<ByteStream>) {});
  ASSERT_TRUE(listener);
  const Finding taken = can_bind("127.0.0.1", (*listener)->port());
  EXPECT_FALSE(taken.ok);
  EXPECT_EQ(taken.sentence.rfind("Cannot listen on 127.0.0.1:", 0), 0u) << taken.sentence;
  EXPECT_NE(taken.sentence.find("address in use"), std::string::npos) << taken.sentence;
  const Finding free = can_bind("127.0.0.1", 0);
  EXPECT_TRUE(free.ok) << free.sentence;
}

TEST(SystemCheck, AdapterNeedsThreePortsAndIsToldWhoHasThem) {
  const auto id = static_cast<unsigned>(::getpid());
  const std::uint32_t own = ipv4(127, 64 + (id >> 8) % 128, id % 256, 77);
  EventLoop loop;
  UdpSocketOptions any;
  any.address = 0;
  any.any_address = true;
  const auto everywhere = UdpSocket::open(loop, any);
  const auto neighbour = UdpSocket::open(loop, {own + 1});
  const auto listener = TcpListener::open(loop, {ipv4_text(own)}, [](Instant, std::unique_ptr<ByteStream>) {});
  ASSERT_TRUE(everywhere && neighbour && listener);
  const std::uint16_t taken = (*everywhere)->local().port, free = (*neighbour)->local().port,
                      served = (*listener)->port();
  ASSERT_TRUE(taken != free && served != free && served != taken);
  const std::string us = ", process " + std::to_string(::getpid());

  const Finding good = can_be_adapter(own, free, free + 1);
  EXPECT_TRUE(good.ok) << good.sentence;  // a neighbour's port stands in nobody's way
  const Finding io = can_be_adapter(own, free, taken);
  EXPECT_FALSE(io.ok);
  EXPECT_NE(io.sentence.find("0.0.0.0:" + std::to_string(taken) + " is held by "), std::string::npos) << io.sentence;
  EXPECT_NE(io.sentence.find(us), std::string::npos) << io.sentence;
  EXPECT_NE(io.sentence.find("bind its own only"), std::string::npos) << io.sentence;
  EXPECT_EQ(io.sentence.find("Cannot listen"), std::string::npos) << "TCP is free: " << io.sentence;
  const Finding tcp = can_be_adapter(own, served, free);
  EXPECT_FALSE(tcp.ok);
  EXPECT_NE(tcp.sentence.find(ipv4_text(own) + ":" + std::to_string(served) + " is held by "), std::string::npos)
      << tcp.sentence;
  EXPECT_EQ(tcp.sentence.find("Cannot use UDP"), std::string::npos) << "UDP is free: " << tcp.sentence;
}

TEST(SystemCheck, KernelCanIsWhatTheKernelSays) {
  const UniqueFd fd(::socket(PF_CAN, SOCK_RAW, 1));
  const Finding finding = has_kernel_can();
  EXPECT_EQ(finding.ok, fd.is_open()) << finding.sentence;
  EXPECT_FALSE(finding.sentence.empty());
}

TEST(SystemCheck, TheRealTimeCheckLeavesTheSchedulingAsItWas) {
  const int before = ::sched_getscheduler(0);
  const Finding finding = can_schedule_realtime();
  EXPECT_EQ(::sched_getscheduler(0), before);
  EXPECT_NE(finding.sentence.find("SCHED_FIFO"), std::string::npos);
}

TEST(SystemCheck, APseudoTerminalCanBeOpenedWhereTheTestsRun) {
  const Finding finding = can_open_pty();
  EXPECT_TRUE(finding.ok) << finding.sentence;
}

}  // namespace
}  // namespace vinv::transports
