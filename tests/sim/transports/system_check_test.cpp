#include "sim/transports/system_check.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/socket.h>

#include "sim/transports/tcp_listener.hpp"
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
