#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "sim/transports/tcp_listener.hpp"
#include "tests/sim/transports/blocking_socket.hpp"
#include "tests/sim/transports/loop_thread.hpp"

namespace vinv::transports {
namespace {

// Answers every byte with itself; a line "big N\n" with N bytes. Lives on the loop's thread.
class EchoServer {
 public:
  explicit EchoServer(LoopThread& thread, std::size_t max_connections = TcpListenerOptions::kMaxConnections)
      : thread_(thread) {
    thread_.call([&] {
      TcpListenerOptions options;
      options.max_connections = max_connections;
      auto opened = TcpListener::open(
          thread_.loop(), options, [this](Instant, std::unique_ptr<ByteStream> stream) { accept(std::move(stream)); });
      ASSERT_TRUE(opened) << opened.error();
      listener_ = std::move(*opened);
      port_ = listener_->port();
    });
  }
  ~EchoServer() {
    thread_.call([this] {
      streams_.clear();
      listener_.reset();
    });
  }
  EchoServer(const EchoServer&) = delete;
  EchoServer& operator=(const EchoServer&) = delete;

  std::uint16_t port() const { return port_; }
  std::atomic<int> accepted{0};
  std::atomic<int> ended{0};
  // Ends on the loop's thread only.
  std::vector<std::string> reasons() {
    std::vector<std::string> copy;
    thread_.call([&] { copy = reasons_; });
    return copy;
  }
  std::size_t connections() {
    std::size_t n = 0;
    thread_.call([&] { n = listener_->connections(); });
    return n;
  }
  std::uint64_t refused() {
    std::uint64_t n = 0;
    thread_.call([&] { n = listener_->refused(); });
    return n;
  }
  // Until the loop has seen so many ends; the loop serves while we wait.
  void wait_for_ends(int count) {
    for (int i = 0; i < 10'000 && ended < count; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_GE(ended, count);
  }

 private:
  void accept(std::unique_ptr<ByteStream> stream) {
    const int id = ++accepted;
    ByteStream& s = *stream;
    streams_[id] = std::move(stream);
    s.set_handlers(
        [&s](Instant now, ByteView bytes, bool) {
          const std::string text(bytes.begin(), bytes.end());
          if (text.rfind("big ", 0) != 0) return s.send(now, bytes);
          const Bytes piece(1000, 'x');
          for (long left = std::stol(text.substr(4)); left > 0; left -= 1000) s.send(now, piece);
        },
        [this, id](Instant, const std::string& reason) {
          reasons_.push_back(reason);
          streams_.erase(id);
          ++ended;
        });
  }

  LoopThread& thread_;
  std::unique_ptr<TcpListener> listener_;
  std::uint16_t port_ = 0;
  std::map<int, std::unique_ptr<ByteStream>> streams_;
  std::vector<std::string> reasons_;
};

std::string refusal(const std::string& host, std::uint16_t port) {
  EventLoop loop;
  TcpListenerOptions options;
  options.host = host;
  options.port = port;
  const auto opened = TcpListener::open(loop, options, [](Instant, std::unique_ptr<ByteStream>) {});
  return opened ? "" : opened.error();
}

TEST(TcpListener, SaysWhyItCannotListen) {
  EventLoop loop;
  const auto first = TcpListener::open(loop, {}, [](Instant, std::unique_ptr<ByteStream>) {});
  ASSERT_TRUE(first);
  EXPECT_NE((*first)->port(), 0);
  EXPECT_EQ((*first)->host(), "127.0.0.1");
  const std::string where = "127.0.0.1:" + std::to_string((*first)->port());
  EXPECT_EQ(refusal("127.0.0.1", (*first)->port()),
            "cannot listen on " + where +
                ": address in use (another program listens there; choose another port, or 0 for a free one)");
  EXPECT_EQ(refusal("conveyor", 0),
            "cannot listen on \"conveyor\": not an IP address (give one of this machine's, such as 127.0.0.1 or ::1)");
  EXPECT_EQ(refusal("192.0.2.1", 1502), "cannot listen on 192.0.2.1:1502: not an address of this machine");
}

TEST(TcpListener, APortIsFreeAgainAsSoonAsItsListenerIsGone) {
  EventLoop loop;
  TcpListenerOptions options;
  auto first = TcpListener::open(loop, options, [](Instant, std::unique_ptr<ByteStream>) {});
  ASSERT_TRUE(first);
  options.port = (*first)->port();
  first = Unexpected(std::string("closed"));
  EXPECT_EQ(refusal("127.0.0.1", options.port), "");
}

TEST(TcpStream, EchoesWhatArrivesInPieces) {
  LoopThread thread;
  EchoServer server(thread);
  BlockingSocket client = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(client.connected());
  for (const std::string piece : {"o", "n", "e two three"}) ASSERT_TRUE(client.send(piece));
  EXPECT_EQ(client.receive(13), "one two three");
  // More than one wake-up reads.
  std::string large(50'000, '\0');
  for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>('a' + i % 23);
  std::string back;
  std::thread reader([&] { back = client.receive(large.size()); });
  ASSERT_TRUE(client.send(large));
  reader.join();
  EXPECT_EQ(back, large);
}

// Both ends are in this process: the accepted one is who has the client as its peer.
int type_of_service_towards(const sockaddr_in& client) {
  for (int fd = 0; fd < 1024; ++fd) {
    sockaddr_in peer{};
    socklen_t size = sizeof peer;
    if (::getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &size) != 0 || peer.sin_family != AF_INET ||
        peer.sin_port != client.sin_port || peer.sin_addr.s_addr != client.sin_addr.s_addr)
      continue;
    int tos = -1;
    size = sizeof tos;
    ::getsockopt(fd, IPPROTO_IP, IP_TOS, &tos, &size);
    return tos;
  }
  return -1;
}

TEST(TcpStream, AcceptedConnectionsHaveTheCodePointOfTheirListener) {
  for (const std::uint8_t dscp : {std::uint8_t{0}, std::uint8_t{27}}) {
    LoopThread thread;
    std::unique_ptr<TcpListener> listener;
    std::unique_ptr<ByteStream> accepted;
    thread.call([&] {
      TcpListenerOptions options;
      options.dscp = dscp;
      listener = *TcpListener::open(thread.loop(), options, [&](Instant now, std::unique_ptr<ByteStream> stream) {
        accepted = std::move(stream);
        const std::uint8_t byte = 1;
        accepted->send(now, ByteView(&byte, 1));
      });
    });
    BlockingSocket client = BlockingSocket::tcp(listener->port());
    char byte = 0;
    ASSERT_EQ(::recv(client.fd(), &byte, 1, 0), 1);
    sockaddr_in ours{};
    socklen_t size = sizeof ours;
    ::getsockname(client.fd(), reinterpret_cast<sockaddr*>(&ours), &size);
    EXPECT_EQ(type_of_service_towards(ours), dscp << 2);
    thread.call([&] {
      accepted.reset();
      listener.reset();
    });
  }
}

TEST(TcpStream, NamesTheClient) {
  LoopThread thread;
  std::unique_ptr<TcpListener> listener;
  std::string name;
  thread.call([&] {
    listener = *TcpListener::open(thread.loop(), {},
                                  [&](Instant, std::unique_ptr<ByteStream> stream) { name = stream->name(); });
  });
  BlockingSocket client = BlockingSocket::tcp(listener->port());
  EXPECT_TRUE(client.ends());  // the server has dropped the stream
  sockaddr_in ours{};
  socklen_t size = sizeof ours;
  ::getsockname(client.fd(), reinterpret_cast<sockaddr*>(&ours), &size);
  thread.call([&] { EXPECT_EQ(name, "127.0.0.1:" + std::to_string(ntohs(ours.sin_port))); });
  thread.call([&] { listener.reset(); });
}

TEST(TcpStream, AClientThatHalfClosesStillGetsItsAnswers) {
  LoopThread thread;
  EchoServer server(thread);
  BlockingSocket client = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(client.send("request"));
  client.half_close();
  EXPECT_EQ(client.receive(7), "request");
  EXPECT_TRUE(client.ends());
  server.wait_for_ends(1);
  EXPECT_EQ(server.reasons(), (std::vector<std::string>{"closed by the peer"}));
}

TEST(TcpStream, AnAnswerAfterTheHalfCloseIsSent) {
  LoopThread thread;
  std::unique_ptr<TcpListener> listener;
  std::unique_ptr<ByteStream> stream;
  kernel::Scheduler& scheduler = thread.loop().scheduler();
  thread.call([&] {
    listener = *TcpListener::open(thread.loop(), {}, [&](Instant, std::unique_ptr<ByteStream> s) {
      stream = std::move(s);
      stream->set_handlers(
          [&](Instant now, ByteView bytes, bool) {
            scheduler.schedule(
                now + std::chrono::milliseconds(50), kernel::Priority::kBoard,
                [&, copy = Bytes(bytes.begin(), bytes.end())](Instant later) { stream->send(later, copy); });
          },
          {});
    });
  });
  BlockingSocket client = BlockingSocket::tcp(listener->port());
  client.send("slow");
  client.half_close();
  EXPECT_EQ(client.receive(4), "slow");
  thread.call([&] {
    stream.reset();
    listener.reset();
  });
}

TEST(TcpStream, AResetEndsTheStreamWithItsReason) {
  LoopThread thread;
  EchoServer server(thread);
  BlockingSocket client = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(client.send("x"));
  EXPECT_EQ(client.receive(1), "x");
  client.reset();
  server.wait_for_ends(1);
  EXPECT_EQ(server.reasons(), (std::vector<std::string>{"connection reset by the peer"}));
  EXPECT_EQ(server.connections(), 0u);
}

TEST(TcpStream, APeerThatDoesNotReadIsDisconnectedAndOthersAreServed) {
  LoopThread thread;
  EchoServer server(thread);
  BlockingSocket slow = BlockingSocket::tcp(server.port(), 4096);
  BlockingSocket good = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(slow.send("big 8000000"));
  server.wait_for_ends(1);
  EXPECT_EQ(server.reasons(),
            (std::vector<std::string>{"disconnected: the peer does not read (65536 bytes wait for it)"}));
  ASSERT_TRUE(good.send("still here"));
  EXPECT_EQ(good.receive(10), "still here");
  EXPECT_TRUE(slow.ends());
}

TEST(TcpStream, WhatFitsIntoTheQueueReachesAPeerThatReadsLate) {
  LoopThread thread;
  EchoServer server(thread);
  BlockingSocket late = BlockingSocket::tcp(server.port(), 4096);
  ASSERT_TRUE(late.send("big 64000"));
  BlockingSocket other = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(other.send("x"));
  EXPECT_EQ(other.receive(1), "x");  // by now the whole answer has been handed to the stream
  EXPECT_EQ(late.receive(64'000), std::string(64'000, 'x'));
  ASSERT_TRUE(late.send("y"));
  EXPECT_EQ(late.receive(1), "y");
}

TEST(TcpStream, OneClientThatFloodsDoesNotStarveAnotherNorTheEvents) {
  LoopThread thread;
  EchoServer server(thread);
  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> ticks{0};
  kernel::EventId ticker = 0;
  thread.call([&] {
    ticker = thread.loop().scheduler().schedule_every(thread.loop().now(), std::chrono::milliseconds(1),
                                                      kernel::Priority::kDrive, [&](Instant) { ++ticks; });
  });
  BlockingSocket flood = BlockingSocket::tcp(server.port());
  std::thread writer([&] {
    const std::string block(16 * 1024, 'f');
    while (!stop && flood.send(block)) {
    }
  });
  std::thread reader([&] {
    while (!stop && !flood.receive(64 * 1024).empty()) {
    }
  });
  const std::uint64_t before = ticks;
  BlockingSocket good = BlockingSocket::tcp(server.port());
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(good.send("request"));
    ASSERT_EQ(good.receive(7), "request");
  }
  while (ticks < before + 20) std::this_thread::yield();  // ends only if events still run
  stop = true;
  ::shutdown(flood.fd(), SHUT_RDWR);
  writer.join();
  reader.join();
  thread.call([&] { thread.loop().scheduler().cancel(ticker); });
}

TEST(TcpListener, BeyondTheLimitTheNewcomerIsRefusedAndTheOldestStay) {
  LoopThread thread;
  EchoServer server(thread, 2);
  BlockingSocket one = BlockingSocket::tcp(server.port());
  BlockingSocket two = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(one.send("1"));
  EXPECT_EQ(one.receive(1), "1");
  ASSERT_TRUE(two.send("2"));
  EXPECT_EQ(two.receive(1), "2");
  BlockingSocket three = BlockingSocket::tcp(server.port());
  EXPECT_TRUE(three.ends());
  EXPECT_EQ(server.refused(), 1u);
  ASSERT_TRUE(one.send("1"));
  EXPECT_EQ(one.receive(1), "1");
  two.reset();
  server.wait_for_ends(1);
  BlockingSocket four = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(four.send("4"));
  EXPECT_EQ(four.receive(1), "4");
}

TEST(TcpListener, AHalfClosedConnectionGivesItsPlaceToANewcomer) {
  LoopThread thread;
  EchoServer server(thread, 1);
  BlockingSocket first = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(first.send("x"));
  ASSERT_EQ(first.receive(1), "x");
  first.half_close();
  for (int i = 0; i < 20; ++i) thread.call({});  // turns of the loop, in which it sees the end
  BlockingSocket second = BlockingSocket::tcp(server.port());
  ASSERT_TRUE(second.send("y"));
  EXPECT_EQ(second.receive(1), "y");
  EXPECT_EQ(server.refused(), 0u);
  EXPECT_EQ(server.reasons(), (std::vector<std::string>{"closed by the peer"}));
}

TEST(TcpStream, ManyConnectsAndDisconnectsLeaveNothingBehind) {
  LoopThread thread;
  EchoServer server(thread);
  for (int round = 0; round < 100; ++round) {
    BlockingSocket a = BlockingSocket::tcp(server.port());
    BlockingSocket b = BlockingSocket::tcp(server.port());
    ASSERT_TRUE(a.connected() && b.connected());
    ASSERT_TRUE(a.send("ping"));
    if (round % 2 == 0) {
      ASSERT_EQ(a.receive(4), "ping");
      if (round % 3 == 0) a.reset();
    }
  }
  server.wait_for_ends(200);
  EXPECT_EQ(server.connections(), 0u);
  EXPECT_EQ(server.accepted, 200);
}

TEST(TcpStream, AStreamMayBeDestroyedInItsOwnHandlerAndSendsAfterTheEndAreIgnored) {
  LoopThread thread;
  std::unique_ptr<TcpListener> listener;
  std::unique_ptr<ByteStream> stream;
  int calls = 0;
  thread.call([&] {
    listener = *TcpListener::open(thread.loop(), {}, [&](Instant, std::unique_ptr<ByteStream> s) {
      stream = std::move(s);
      stream->set_handlers(
          [&, guard = std::string(100, 'g')](Instant now, ByteView bytes, bool) {
            stream->send(now, bytes);
            stream->close();
            stream->send(now, bytes);
            stream.reset();
            calls += static_cast<int>(guard.size());
          },
          [&](Instant, const std::string&) { calls = -1; });
    });
  });
  BlockingSocket client = BlockingSocket::tcp(listener->port());
  ASSERT_TRUE(client.send("x"));
  EXPECT_EQ(client.receive(1), "x");
  EXPECT_TRUE(client.ends());
  thread.call([&] {
    EXPECT_EQ(calls, 100);
    listener.reset();
  });
}

}  // namespace
}  // namespace vinv::transports
