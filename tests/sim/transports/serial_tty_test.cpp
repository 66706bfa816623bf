#include "sim/transports/serial_tty.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/sim/transports/loop_thread.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/sim/transports/tty_client.hpp"

namespace vinv::transports {
namespace {

// Stands in for a serial adapter: the far end is a pty master, the device a pty slave.
struct Adapter {
  UniqueFd master{::posix_openpt(O_RDWR | O_NOCTTY)};
  std::string path;

  Adapter() {
    ::grantpt(master.get());
    ::unlockpt(master.get());
    path = ::ptsname(master.get());
  }
  void write(const std::string& bytes) {
    ASSERT_EQ(::write(master.get(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  std::string read(std::size_t size) {
    std::string out;
    while (out.size() < size) {
      pollfd p{master.get(), POLLIN, 0};
      if (::poll(&p, 1, 10'000) <= 0) break;
      char buffer[256];
      const ssize_t n = ::read(master.get(), buffer, std::min(sizeof buffer, size - out.size()));
      if (n <= 0) break;
      out.append(buffer, static_cast<std::size_t>(n));
    }
    return out;
  }
};

// Echoes, and keeps notices. Lives on the loop's thread.
class Line {
 public:
  Line(LoopThread& thread, const std::string& path) : thread_(thread) {
    thread_.call([&] {
      auto opened = SerialTty::open(thread_.loop(), {path, {19200, LineSettings::Parity::kNone}});
      ASSERT_TRUE(opened) << opened.error();
      tty = std::move(*opened);
      tty->set_notice([this](Instant, const std::string& sentence) {
        notices.push_back(sentence);
        ++notice_count;
      });
      tty->set_handlers([this](Instant now, ByteView bytes, bool) { tty->send(now, bytes); }, {});
    });
  }
  ~Line() {
    thread_.call([this] { tty.reset(); });
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  void wait_for_notices(int count) {
    for (int i = 0; i < 10'000 && notice_count < count; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_GE(notice_count, count);
  }
  std::unique_ptr<SerialTty> tty;
  std::vector<std::string> notices;
  std::atomic<int> notice_count{0};

 private:
  LoopThread& thread_;
};

TEST(SerialTty, CarriesEveryByteBothWays) {
  LoopThread thread;
  Adapter adapter;
  Line line(thread, adapter.path);
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  adapter.write(all);
  EXPECT_EQ(adapter.read(256), all);
}

TEST(SerialTty, SetsTheSpeedOfTheDevice) {
  LoopThread thread;
  Adapter adapter;
  Line line(thread, adapter.path);
  termios t{};
  ASSERT_EQ(::tcgetattr(adapter.master.get(), &t), 0);
  EXPECT_EQ(::cfgetospeed(&t), static_cast<speed_t>(B19200));
  EXPECT_EQ(t.c_iflag & (PARMRK | INPCK), static_cast<tcflag_t>(PARMRK | INPCK));
  EXPECT_EQ(t.c_cflag & CSIZE, static_cast<tcflag_t>(CS8));
  thread.call([&] { EXPECT_TRUE(line.tty->set_line_settings({4800, LineSettings::Parity::kNone})); });
  ASSERT_EQ(::tcgetattr(adapter.master.get(), &t), 0);
  EXPECT_EQ(::cfgetospeed(&t), static_cast<speed_t>(B4800));
}

TEST(SerialTty, SaysWhatTheDeviceDoesNotDo) {
  EventLoop loop;
  Adapter adapter;  // a pseudo-terminal drops parity
  const auto even = SerialTty::open(loop, {adapter.path, {9600, LineSettings::Parity::kEven}});
  ASSERT_FALSE(even);
  EXPECT_EQ(even.error(), "cannot use " + adapter.path + ": the device does not do the parity of 9600 8E1");
  const auto missing = SerialTty::open(loop, {"/dev/ttyNothing", {}});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error(), "cannot use /dev/ttyNothing: no such file or directory");
  const auto no_tty = SerialTty::open(loop, {"/dev/null", {}});
  ASSERT_FALSE(no_tty);
  EXPECT_EQ(no_tty.error(), "cannot use /dev/null: not a serial device");
}

TEST(SerialTty, HoldsTheDeviceAlone) {
  EventLoop loop;
  Adapter adapter;
  auto first = SerialTty::open(loop, {adapter.path, {}});
  ASSERT_TRUE(first);
  const auto second = SerialTty::open(loop, {adapter.path, {}});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error(), "cannot use " + adapter.path + ": another program holds it");
  (*first)->close();
  EXPECT_TRUE(SerialTty::open(loop, {adapter.path, {}}));
}

TEST(SerialTty, FindsADeviceThatVanishedAndReturned) {
  const TemporaryFolder folder;
  const std::string path = folder / "ttyUSB0";
  LoopThread thread;
  auto adapter = std::make_unique<Adapter>();
  std::filesystem::create_symlink(adapter->path, path);
  Line line(thread, path);
  adapter->write("a");
  EXPECT_EQ(adapter->read(1), "a");

  const auto second = std::make_unique<Adapter>();  // before the first goes, so that the number differs
  std::filesystem::remove(path);
  adapter.reset();
  line.wait_for_notices(1);
  thread.call([&] {
    EXPECT_FALSE(line.tty->is_present());
    line.tty->send(thread.loop().now(), Bytes{1, 2, 3});
    EXPECT_EQ(line.tty->lost_bytes(), 3u);
  });
  std::filesystem::create_symlink(second->path, path);
  line.wait_for_notices(2);
  second->write("b");
  EXPECT_EQ(second->read(1), "b");
  termios t{};
  ASSERT_EQ(::tcgetattr(second->master.get(), &t), 0);
  EXPECT_EQ(::cfgetospeed(&t), static_cast<speed_t>(B19200));
  thread.call([&] {
    EXPECT_NE(line.notices[0].find("is gone"), std::string::npos) << line.notices[0];
    EXPECT_EQ(line.notices[1], path + " is back");
  });
}

}  // namespace
}  // namespace vinv::transports
