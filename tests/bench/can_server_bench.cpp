// SDO round trips of a drive over the servers of its bus, which takes no time (CanBusOptions::Timing::kNone), against
// an echo of as many bytes that does nothing but epoll_wait, read and write. Both take turns in one run, client and
// server on one core, since two cores measure wake-ups: to_echo is what counts, 1 would be the bare echo.
//
// And 99 drives with their motors in real time at 1 Mbit/s, a master that polls them over socketcand: the share of one
// core, and how late events ran.
#include <benchmark/benchmark.h>
#include <sched.h>
#include <sys/epoll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <ctime>
#include <thread>

#include "sim/transports/can/can_servers.hpp"
#include "tests/bench/allocation_count.hpp"
#include "tests/bench/can_drive.hpp"
#include "tests/sim/transports/blocking_socket.hpp"
#include "tests/sim/transports/loop_thread.hpp"

namespace vinv::transports {
namespace {

using WallClock = std::chrono::steady_clock;

// This thread and those that it starts, until the end of the scope.
class OnOneCore {
 public:
  OnOneCore() {
    ::sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(::sched_getcpu(), &one);
    ::sched_setaffinity(0, sizeof one, &one);
  }
  ~OnOneCore() { ::sched_setaffinity(0, sizeof before_, &before_); }
  OnOneCore(const OnOneCore&) = delete;
  OnOneCore& operator=(const OnOneCore&) = delete;

 private:
  cpu_set_t before_{};
};

class RawEcho {
 public:
  RawEcho() : listener_(::socket(AF_INET, SOCK_STREAM, 0)), epoll_(::epoll_create1(0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    VINV_CHECK(::bind(listener_.get(), reinterpret_cast<sockaddr*>(&address), size) == 0);
    VINV_CHECK(::listen(listener_.get(), 64) == 0);
    ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    watch(listener_.get());
    thread_ = std::thread([this] { serve(); });
  }
  ~RawEcho() {
    stop_ = true;
    BlockingSocket::tcp(port_);  // wakes it
    thread_.join();
  }
  RawEcho(const RawEcho&) = delete;
  RawEcho& operator=(const RawEcho&) = delete;
  std::uint16_t port() const { return port_; }

 private:
  void watch(int fd) {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.fd = fd;
    ::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, fd, &event);
  }
  void serve() {
    std::array<epoll_event, 64> events{};
    std::array<char, 4096> buffer{};
    std::vector<UniqueFd> clients;
    while (!stop_) {
      const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), -1);
      for (int i = 0; i < count; ++i) {
        const int fd = events[static_cast<std::size_t>(i)].data.fd;
        if (fd == listener_.get()) {
          clients.emplace_back(::accept(fd, nullptr, nullptr));
          watch(clients.back().get());
          continue;
        }
        const ssize_t size = ::read(fd, buffer.data(), buffer.size());
        if (size <= 0 || ::write(fd, buffer.data(), static_cast<std::size_t>(size)) != size)
          ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, fd, nullptr);
      }
    }
  }
  UniqueFd listener_;
  UniqueFd epoll_;
  std::uint16_t port_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// Drives on a bus with both servers, on an event loop with a thread of its own.
class Served {
 public:
  Served(CanBusOptions options, unsigned drives) {
    thread_.call([&] {
      auto& scheduler = thread_.loop().scheduler();
      bus_ = std::make_unique<CanBus>(scheduler, std::move(options));
      drives_ = std::make_unique<test::CanDrives>(scheduler, *bus_, drives);
      socketcand_ = std::move(SocketcandServer::open(thread_.loop(), {}, {{{"can0", bus_.get()}}, 0})).value();
      slcan_ = std::move(SlcanServer::open(thread_.loop(), {}, *bus_)).value();
    });
  }
  ~Served() {
    thread_.call([&] {
      socketcand_.reset();
      slcan_.reset();
      drives_.reset();
      bus_.reset();
    });
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  LoopThread& thread() { return thread_; }
  CanBus& bus() { return *bus_; }
  BlockingSocket socketcand() {
    BlockingSocket client = BlockingSocket::tcp(socketcand_->port());
    VINV_CHECK(client.receive(6) == "< hi >");
    for (const char* message : {"< open can0 >", "< rawmode >"}) {
      client.send(message);
      VINV_CHECK(client.receive(6) == "< ok >");
    }
    return client;
  }
  BlockingSocket slcan() {
    BlockingSocket client = BlockingSocket::tcp(slcan_->port());
    client.send("O\r");
    VINV_CHECK(client.receive(1) == "\r");
    return client;
  }

 private:
  LoopThread thread_;
  std::unique_ptr<CanBus> bus_;
  std::unique_ptr<test::CanDrives> drives_;
  std::unique_ptr<SocketcandServer> socketcand_;
  std::unique_ptr<SlcanServer> slcan_;
};

// Reads until the text has this many messages that end in end.
std::size_t read_messages(const BlockingSocket& client, char end, std::ptrdiff_t messages) {
  std::array<char, 4096> buffer{};
  std::size_t total = 0;
  while (messages > 0) {
    const ssize_t size = ::recv(client.fd(), buffer.data(), buffer.size(), 0);
    VINV_CHECK(size > 0);
    messages -= std::count(buffer.begin(), buffer.begin() + size, end);
    total += static_cast<std::size_t>(size);
  }
  return total;
}

struct Protocol {
  BlockingSocket (Served::*open)();
  const char* request;
  char end;
  std::ptrdiff_t messages;  // that answer one request
};
constexpr Protocol kSocketcand{&Served::socketcand, "< send 601 8 40 0 10 0 0 0 0 0 >", '>', 1};
constexpr Protocol kSlcan{&Served::slcan, "t60184000100000000000\r", '\r', 2};

void sdo_over(benchmark::State& bench, const Protocol& protocol) {
  constexpr int kTrips = 500;
  const OnOneCore pinned;
  CanBusOptions options;
  options.timing = CanBusOptions::Timing::kNone;
  Served served(std::move(options), 1);
  RawEcho echo;
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // the drive starts up
  BlockingSocket client = (served.*protocol.open)();
  BlockingSocket bare = BlockingSocket::tcp(echo.port());
  const std::string request = protocol.request;
  client.send(request);
  const std::string answer(read_messages(client, protocol.end, protocol.messages), 'x');
  double echo_s = 0, trips_s = 0;
  std::uint64_t allocations = 0;
  for ([[maybe_unused]] auto _ : bench) {
    const auto start = WallClock::now();
    for (int i = 0; i < kTrips; ++i) {
      bare.send(answer);
      bare.receive(answer.size());
    }
    const auto middle = WallClock::now();
    const auto before = test::allocation_count();
    for (int i = 0; i < kTrips; ++i) {
      client.send(request);
      read_messages(client, protocol.end, protocol.messages);
    }
    const std::chrono::duration<double> took = WallClock::now() - middle;
    allocations += test::allocation_count() - before;
    echo_s += std::chrono::duration<double>(middle - start).count();
    trips_s += took.count();
    bench.SetIterationTime(took.count());
  }
  const double trips = kTrips * static_cast<double>(bench.iterations());
  bench.counters["trips_per_s"] = trips / trips_s;
  bench.counters["to_echo"] = echo_s / trips_s;
  // With those of the drive's ticks meanwhile, of which there are few.
  bench.counters["allocs_per_trip"] = static_cast<double>(allocations) / trips;
}
BENCHMARK_CAPTURE(sdo_over, Socketcand, kSocketcand)->Name("CanSdoOverSocketcand")->UseManualTime();
BENCHMARK_CAPTURE(sdo_over, Slcan, kSlcan)->Name("CanSdoOverSlcan")->UseManualTime();

// One request makes the node answer with this many frames in one instant, as SYNC does with many drives.
void CanBurstOverSocketcand(benchmark::State& bench) {
  const OnOneCore pinned;
  const auto frames = static_cast<int>(bench.range(0));
  CanBusOptions options;
  options.timing = CanBusOptions::Timing::kNone;
  Served served(std::move(options), 0);
  std::unique_ptr<CanNode> node;
  served.thread().call([&] {
    CanNodeOptions node_options;
    node_options.queue_frames = 256;
    node = served.bus().attach(served.thread().loop().now(), node_options);
    node->set_handlers({[&](Instant now, const CanFrame&) {
                          for (int i = 0; i < frames; ++i)
                            node->send(now, CanFrame::standard(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
                        },
                        {},
                        {}});
  });
  BlockingSocket client = served.socketcand();
  for ([[maybe_unused]] auto _ : bench) {
    client.send("< send 80 0 >");
    read_messages(client, '>', frames);
  }
  bench.counters["frames_per_s"] =
      benchmark::Counter(frames * static_cast<double>(bench.iterations()), benchmark::Counter::kIsRate);
  served.thread().call([&] { node.reset(); });
}
BENCHMARK(CanBurstOverSocketcand)->Arg(1)->Arg(99)->UseRealTime();

double process_cpu_s() {
  timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// The master reads 1000H of one drive after the other, as fast as they answer.
void CanDrivesInRealTime(benchmark::State& bench) {
  CanBusOptions options;
  options.bitrate = 1'000'000;
  const auto count = static_cast<unsigned>(bench.range(0));
  Served served(std::move(options), count);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  BlockingSocket client = served.socketcand();
  std::uint64_t trips = 0;
  for ([[maybe_unused]] auto _ : bench) {
    const auto start = WallClock::now();
    const double cpu = process_cpu_s();
    while (WallClock::now() - start < std::chrono::seconds(5)) {
      client.send(socketcand_send(
          CanFrame::standard(0x601 + static_cast<std::uint32_t>(trips % count), {0x40, 0, 0x10, 0, 0, 0, 0, 0})));
      read_messages(client, '>', 1);
      ++trips;
    }
    const double took = std::chrono::duration<double>(WallClock::now() - start).count();
    bench.SetIterationTime(took);
    served.thread().call([&] {
      const auto& late = served.thread().loop().lateness();
      bench.counters["late_p50_us"] = 1e6 * to_seconds(late.quantile(0.5));
      bench.counters["late_p99_us"] = 1e6 * to_seconds(late.quantile(0.99));
      bench.counters["late_max_us"] = 1e6 * to_seconds(late.maximum());
      bench.counters["bus_load"] = served.bus().stats(served.thread().loop().now()).load.last_second;
    });
    bench.counters["cpu_share"] = (process_cpu_s() - cpu) / took;
    bench.counters["trips_per_s"] = static_cast<double>(trips) / took;
  }
}
BENCHMARK(CanDrivesInRealTime)->Arg(1)->Arg(10)->Arg(99)->Iterations(1)->UseManualTime();

}  // namespace
}  // namespace vinv::transports
