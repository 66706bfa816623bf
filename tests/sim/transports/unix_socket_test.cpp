#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <memory>
#include <string>

#include "sim/transports/unix_socket_listener.hpp"
#include "tests/sim/transports/blocking_socket.hpp"
#include "tests/sim/transports/loop_thread.hpp"
#include "tests/support/temporary_folder.hpp"

namespace vinv::transports {
namespace {

void ignore(Instant, std::unique_ptr<ByteStream>) {}

TEST(UnixSocket, ServesAClientOfTheSameUserOnlyAndRemovesItsFile) {
  const TemporaryFolder folder;
  const std::string path = folder / "ctl.sock";
  {
    LoopThread thread;
    std::unique_ptr<UnixSocketListener> listener;
    std::unique_ptr<ByteStream> stream;
    thread.call([&] {
      auto opened = UnixSocketListener::open(thread.loop(), path, [&](Instant, std::unique_ptr<ByteStream> s) {
        stream = std::move(s);
        stream->set_handlers([&](Instant now, ByteView bytes, bool) { stream->send(now, bytes); }, {});
      });
      ASSERT_TRUE(opened) << opened.error();
      listener = std::move(*opened);
    });
    struct stat info {};
    ASSERT_EQ(::stat(path.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0600u);
    BlockingSocket client = BlockingSocket::local(path);
    ASSERT_TRUE(client.send("status"));
    EXPECT_EQ(client.receive(6), "status");
    thread.call([&] {
      EXPECT_EQ(stream->name(), path + " client 1");
      stream.reset();
      listener.reset();
    });
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(UnixSocket, RefusesAPathThatDoesNotFit) {
  EventLoop loop;
  const std::string path = "/tmp/" + std::string(103, 'x');
  const auto opened = UnixSocketListener::open(loop, path, ignore);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), "cannot listen on \"" + path + "\": a socket path has 1 to 107 bytes, this one has 108");
  EXPECT_FALSE(UnixSocketListener::open(loop, "", ignore));
}

TEST(UnixSocket, RefusesWhatIsNotASocketAndLeavesItAlone) {
  const TemporaryFolder folder;
  const std::string path = folder / "notes.txt";
  std::ofstream(path) << "mine";
  EventLoop loop;
  const auto opened = UnixSocketListener::open(loop, path, ignore);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), "cannot listen on " + path + ": a file that is not a socket is there");
  std::string kept;
  std::ifstream(path) >> kept;
  EXPECT_EQ(kept, "mine");
}

TEST(UnixSocket, RefusesASocketThatSomebodyAnswers) {
  const TemporaryFolder folder;
  const std::string path = folder / "ctl.sock";
  EventLoop loop;
  const auto first = UnixSocketListener::open(loop, path, ignore);
  ASSERT_TRUE(first);
  const auto second = UnixSocketListener::open(loop, path, ignore);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error(), "cannot listen on " + path + ": another process answers there");
}

TEST(UnixSocket, ReplacesASocketFileThatACrashLeftBehind) {
  const TemporaryFolder folder;
  const std::string path = folder / "ctl.sock";
  {
    const UniqueFd crashed(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::strncpy(at.sun_path, path.c_str(), sizeof at.sun_path - 1);
    ASSERT_EQ(::bind(crashed.get(), reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
  }
  ASSERT_TRUE(std::filesystem::exists(path));
  EventLoop loop;
  const auto opened = UnixSocketListener::open(loop, path, ignore);
  ASSERT_TRUE(opened) << opened.error();
  EXPECT_TRUE(BlockingSocket::local(path).connected());
}

TEST(UnixSocket, DoesNotRemoveAFileThatTookItsPlace) {
  const TemporaryFolder folder;
  const std::string path = folder / "ctl.sock";
  EventLoop loop;
  auto opened = UnixSocketListener::open(loop, path, ignore);
  ASSERT_TRUE(opened);
  std::filesystem::remove(path);
  std::ofstream(path) << "other";
  opened = Unexpected(std::string("closed"));
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST(UnixSocket, SaysThatTheFolderIsMissing) {
  EventLoop loop;
  const auto opened = UnixSocketListener::open(loop, "/nonexistent/ctl.sock", ignore);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), "cannot listen on /nonexistent/ctl.sock: no such file or directory");
}

}  // namespace
}  // namespace vinv::transports
