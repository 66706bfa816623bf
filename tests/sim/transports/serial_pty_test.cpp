#include "sim/transports/serial_pty.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/sim/transports/loop_thread.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/sim/transports/tty_client.hpp"

namespace vinv::transports {
namespace {

// A line that answers everything with itself in brackets and notes line errors.
class EchoLine {
 public:
  explicit EchoLine(LoopThread& thread, SerialPtyOptions options = {}) : thread_(thread) {
    thread_.call([&] {
      auto opened = SerialPty::open(thread_.loop(), options);
      ASSERT_TRUE(opened) << opened.error();
      line_ = std::move(*opened);
      path_ = line_->name();
      line_->set_handlers(
          [this](Instant now, ByteView bytes, bool line_error) {
            received_ += bytes.size();
            if (line_error) {
              errors_ += bytes.size();
              return;
            }
            Bytes answer{'['};
            answer.insert(answer.end(), bytes.begin(), bytes.end());
            answer.push_back(']');
            line_->send(now, answer);
          },
          [this](Instant, const std::string&) { closed_ = true; });
    });
  }
  ~EchoLine() {
    thread_.call([this] { line_.reset(); });
  }
  EchoLine(const EchoLine&) = delete;
  EchoLine& operator=(const EchoLine&) = delete;

  const std::string& path() const { return path_; }
  SerialPty& line() { return *line_; }
  std::atomic<std::size_t> received_{0};
  std::atomic<std::size_t> errors_{0};
  std::atomic<bool> closed_{false};
  void wait_for(const std::atomic<std::size_t>& counter, std::size_t count) {
    for (int i = 0; i < 10'000 && counter < count; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_GE(counter, count);
  }
  bool has_client() {
    bool has = false;
    thread_.call([&] { has = line_->has_client(); });
    return has;
  }
  std::optional<LineSettings> peer() {
    std::optional<LineSettings> settings;
    thread_.call([&] { settings = line_->peer_settings(); });
    return settings;
  }

 private:
  LoopThread& thread_;
  std::unique_ptr<SerialPty> line_;
  std::string path_;
};

TEST(SerialPty, AClientThatSetsNothingTalksRawAndIsTakenToHaveTheRightSpeed) {
  LoopThread thread;
  EchoLine line(thread);
  TtyClient client(line.path());
  ASSERT_TRUE(client.is_open());
  // Everything that a cooked terminal would change or act on.
  const std::string bytes("\x03\x04\x0d\x0a\x11\x13\x1a\x00\xff\x7f\x01", 11);
  ASSERT_TRUE(client.write(bytes));
  EXPECT_EQ(client.read(13), "[" + bytes + "]");
  EXPECT_EQ(line.peer(), std::nullopt);
  EXPECT_EQ(line.errors_, 0u);
}

TEST(SerialPty, SeesTheSpeedThatAClientSetsAndMarksBytesOfAnother) {
  LoopThread thread;
  SerialPtyOptions options;
  options.settings = {19200, LineSettings::Parity::kEven};
  EchoLine line(thread, options);
  TtyClient client(line.path());
  ASSERT_TRUE(client.set_speed(B9600));
  EXPECT_EQ(line.peer(), (LineSettings{9600, LineSettings::Parity::kEven}));
  ASSERT_TRUE(client.write("wrong"));
  line.wait_for(line.errors_, 5);
  ASSERT_TRUE(client.set_speed(B19200));
  EXPECT_EQ(line.peer(), options.settings);
  ASSERT_TRUE(client.write("right"));
  EXPECT_EQ(client.read(7), "[right]");
  EXPECT_EQ(line.errors_, 5u);
}

TEST(SerialPty, ComparesWithTheSettingsOfNow) {
  LoopThread thread;
  EchoLine line(thread);
  TtyClient client(line.path());
  ASSERT_TRUE(client.set_speed(B9600));
  ASSERT_TRUE(client.write("a"));
  EXPECT_EQ(client.read(3), "[a]");
  thread.call([&] { EXPECT_TRUE(line.line().set_line_settings({4800, LineSettings::Parity::kNone})); });
  ASSERT_TRUE(client.write("b"));
  line.wait_for(line.errors_, 1);
  ASSERT_TRUE(client.set_speed(B4800));
  ASSERT_TRUE(client.write("c"));
  EXPECT_EQ(client.read(3), "[c]");
}

TEST(SerialPty, ClientsComeAndGo) {
  LoopThread thread;
  EchoLine line(thread);
  EXPECT_FALSE(line.has_client());
  for (int i = 0; i < 50; ++i) {
    TtyClient client(line.path());
    ASSERT_TRUE(client.is_open());
    EXPECT_TRUE(line.has_client());
    if (i % 3 == 0) {
      ASSERT_TRUE(client.set_speed(B9600));
    }
    ASSERT_TRUE(client.write("ping"));
    ASSERT_EQ(client.read(6), "[ping]") << i;
    client.close();
  }
  EXPECT_FALSE(line.has_client());
  EXPECT_FALSE(line.closed_);
  EXPECT_EQ(line.received_, 200u);
}

TEST(SerialPty, AMessageOfAClientThatClosesAtOnceArrives) {
  LoopThread thread;
  EchoLine line(thread);
  for (std::size_t i = 1; i <= 20; ++i) {
    TtyClient client(line.path());
    ASSERT_TRUE(client.write("broadcast"));
    client.close();
    line.wait_for(line.received_, 9 * i);
  }
}

TEST(SerialPty, ALateAnswerIsLostAndNotFoundByTheNextClient) {
  LoopThread thread;
  EchoLine line(thread);
  {
    TtyClient impatient(line.path());
    ASSERT_TRUE(impatient.write("asked"));
    line.wait_for(line.received_, 5);  // answered, not read
  }
  // Sent to nobody at all.
  thread.call([&] { line.line().send(thread.loop().now(), Bytes{'x', 'y'}); });
  thread.call([&] { EXPECT_GE(line.line().lost_bytes(), 2u); });
  for (int i = 0; i < 3; ++i) thread.call({});
  TtyClient next(line.path());
  EXPECT_EQ(next.read_waiting(), "");
  ASSERT_TRUE(next.write("b"));
  EXPECT_EQ(next.read(3), "[b]");
}

TEST(SerialPty, AClientThatDoesNotReadLosesBytesAndNothingElse) {
  LoopThread thread;
  EchoLine line(thread);
  EchoLine other(thread);
  TtyClient deaf(line.path());
  thread.call([&] {
    for (int i = 0; i < 200; ++i) line.line().send(thread.loop().now(), Bytes(1000, 'x'));
    EXPECT_GT(line.line().lost_bytes(), 0u);
  });
  TtyClient client(other.path());
  ASSERT_TRUE(client.write("a"));
  EXPECT_EQ(client.read(3), "[a]");
  while (!deaf.read_waiting().empty()) {
  }
  ASSERT_TRUE(deaf.write("b"));
  EXPECT_EQ(deaf.read(3), "[b]");
}

TEST(SerialPty, AFloodOfOneClientLeavesTheLoopFree) {
  LoopThread thread;
  EchoLine line(thread);
  EchoLine other(thread);
  std::atomic<bool> stop{false};
  std::thread flood([&] {
    TtyClient client(line.path());
    const std::string block(1000, 'f');
    while (!stop) {
      client.write(block);
      client.read_waiting();
    }
  });
  TtyClient client(other.path());
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(client.write("a"));
    ASSERT_EQ(client.read(3), "[a]");
  }
  stop = true;
  flood.join();
}

TEST(SerialPty, LinksAtAStableNameReplacesAnOlderLinkAndRemovesItsOwn) {
  const TemporaryFolder folder;
  SerialPtyOptions options;
  options.link = folder / "conveyor_1";
  std::filesystem::create_symlink("/dev/pts/99999", options.link);
  {
    LoopThread thread;
    EchoLine line(thread, options);
    EXPECT_EQ(std::filesystem::read_symlink(options.link).string(), line.path());
    TtyClient client(options.link);
    ASSERT_TRUE(client.write("a"));
    EXPECT_EQ(client.read(3), "[a]");
  }
  EXPECT_FALSE(std::filesystem::is_symlink(options.link));
}

TEST(SerialPty, NeverTouchesAFileOrALinkOfSomebodyElse) {
  const TemporaryFolder folder;
  EventLoop loop;
  SerialPtyOptions options;
  options.link = folder / "notes.txt";
  std::ofstream(options.link) << "mine";
  const auto over_file = SerialPty::open(loop, options);
  ASSERT_FALSE(over_file);
  EXPECT_NE(over_file.error().find("a file that is not a symbolic link is there"), std::string::npos)
      << over_file.error();
  EXPECT_TRUE(std::filesystem::is_regular_file(options.link));

  options.link = folder / "link";
  std::filesystem::create_symlink("notes.txt", options.link);
  const auto over_link = SerialPty::open(loop, options);
  ASSERT_FALSE(over_link);
  EXPECT_NE(over_link.error().find("a symbolic link to something else is there (notes.txt)"), std::string::npos);
  EXPECT_EQ(std::filesystem::read_symlink(options.link).string(), "notes.txt");

  options.link = folder / "missing/link";
  const auto no_folder = SerialPty::open(loop, options);
  ASSERT_FALSE(no_folder);
  EXPECT_NE(no_folder.error().find("no such file or directory"), std::string::npos);
}

TEST(SerialPty, LeavesALinkThatWasTakenOverSinceItsStart) {
  const TemporaryFolder folder;
  EventLoop loop;
  SerialPtyOptions options;
  options.link = folder / "line";
  auto first = SerialPty::open(loop, options);
  auto second = SerialPty::open(loop, options);
  ASSERT_TRUE(first && second);
  const std::string target = (*second)->name();
  (*first)->close();
  EXPECT_EQ(std::filesystem::read_symlink(options.link).string(), target);
}

}  // namespace
}  // namespace vinv::transports
