#include "tests/bench/ethernet_ip/io_intervals.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

#include "sim/transports/unique_fd.hpp"
#include "tests/bench/ethernet_ip/measure.hpp"
#include "tests/support/eip_scanner.hpp"

namespace vinv::bench {
namespace {

using scanner::EipScanner;
using scanner::Octets;
using scanner::Opened;
using transports::UniqueFd;

constexpr unsigned kBatch = 64;
constexpr int kReceiveRoom = 8 * 1024 * 1024;
constexpr std::uint32_t kSenderId = 0x77000000;  // plus the stream
// After the connections are open and before what counts.
constexpr double kWarmUp = 0.3;

sockaddr_in address_of(std::uint32_t address, std::uint16_t port) {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_addr.s_addr = htonl(address);
  a.sin_port = htons(port);
  return a;
}

void put(Octets& out, unsigned bytes, std::uint32_t value) {
  for (unsigned i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}
void put_at(Octets& out, std::size_t at, unsigned bytes, std::uint32_t value) {
  for (unsigned i = 0; i < bytes; ++i) out[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

// A class 1 packet; the sequence count is at 10, the count of the data at 18.
Octets packet(std::uint32_t id, bool header, unsigned data) {
  Octets p;
  put(p, 2, 2);
  put(p, 2, 0x8002);
  put(p, 2, 8);
  put(p, 4, id);
  put(p, 4, 0);
  put(p, 2, 0xb1);
  put(p, 2, 2 + (header ? 4 : 0) + data);
  put(p, 2, 0);
  if (header) put(p, 4, 0);  // idle: the drive stands still
  p.insert(p.end(), data, 0);
  return p;
}
void count_up(Octets& p, std::uint32_t& count) {
  ++count;
  put_at(p, 10, 4, count);
  put_at(p, 18, 2, count & 0xffff);
}

// Absolute deadlines, one socket, a heap. Never returns.
void send_at_deadlines(std::uint32_t to, unsigned streams, unsigned interval_us, unsigned data_bytes) {
  struct Stream {
    std::int64_t next;
    Octets packet;
    std::uint32_t count;
    bool operator<(const Stream& other) const { return next > other.next; }
  };
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM, 0));
  const sockaddr_in address = address_of(to, 2222);
  const std::int64_t interval = std::int64_t{interval_us} * 1000;
  const std::int64_t start = monotonic_ns() + 1'000'000;
  std::vector<Stream> heap;
  for (unsigned i = 0; i < streams; ++i)
    heap.push_back({start + interval * i / streams, packet(kSenderId + i, false, data_bytes), 0});
  std::make_heap(heap.begin(), heap.end());
  for (;;) {
    std::pop_heap(heap.begin(), heap.end());
    Stream& s = heap.back();
    if (monotonic_ns() < s.next) sleep_until_ns(s.next);
    count_up(s.packet, s.count);
    ::sendto(fd.get(), s.packet.data(), s.packet.size(), 0, reinterpret_cast<const sockaddr*>(&address),
             sizeof address);
    s.next += interval;
    std::push_heap(heap.begin(), heap.end());
  }
}

// What came of each stream, by the low bytes of its connection identifier.
class Arrivals {
 public:
  Arrivals(unsigned streams, unsigned interval_us) : interval_ns_(interval_us * 1000.0), last_(streams, 0) {}
  void add(std::size_t stream, std::int64_t at) {
    if (stream >= last_.size()) return;
    ++count_;
    if (last_[stream] != 0)
      deviations_us_.push_back(std::abs(static_cast<double>(at - last_[stream]) - interval_ns_) / 1000);
    last_[stream] = at;
  }
  std::uint64_t count() const { return count_; }
  std::vector<double>& deviations_us() { return deviations_us_; }

 private:
  double interval_ns_;
  std::vector<std::int64_t> last_;
  std::uint64_t count_ = 0;
  std::vector<double> deviations_us_;
};

// Takes all datagrams that wait, with their time of arrival.
class Receiver {
 public:
  explicit Receiver(int fd) : fd_(fd) {
    const int on = 1;
    ::setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
    if (::setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &kReceiveRoom, sizeof kReceiveRoom) != 0)
      ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &kReceiveRoom, sizeof kReceiveRoom);
    for (unsigned i = 0; i < kBatch; ++i) {
      pieces_[i] = {buffers_[i].data(), buffers_[i].size()};
      messages_[i].msg_hdr.msg_iov = &pieces_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
      messages_[i].msg_hdr.msg_control = controls_[i].bytes.data();
    }
  }
  template <class Sink>
  void take(const Sink& sink) {
    for (;;) {
      for (auto& m : messages_) m.msg_hdr.msg_controllen = sizeof(Control);
      const int count = ::recvmmsg(fd_, messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
      for (int i = 0; i < count; ++i) {
        auto& m = messages_[static_cast<std::size_t>(i)];
        const auto& b = buffers_[static_cast<std::size_t>(i)];
        if (m.msg_len < 20) continue;
        std::uint32_t id = 0;
        for (unsigned k = 0; k < 4; ++k) id |= std::uint32_t{b[6 + k]} << (8 * k);
        sink(id, stamp(m.msg_hdr));
      }
      if (count < static_cast<int>(kBatch)) return;
    }
  }

 private:
  struct alignas(cmsghdr) Control {
    std::array<std::uint8_t, CMSG_SPACE(sizeof(timespec))> bytes{};
  };
  static std::int64_t stamp(msghdr& header) {
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
      timespec t{};
      std::memcpy(&t, CMSG_DATA(c), sizeof t);
      return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
    }
    return 0;
  }
  int fd_;
  std::array<mmsghdr, kBatch> messages_{};
  std::array<iovec, kBatch> pieces_{};
  std::array<std::array<std::uint8_t, 256>, kBatch> buffers_{};
  std::array<Control, kBatch> controls_{};
};

// Our side of the connections: what a master sends at the same interval, and what comes.
class Master {
 public:
  Master(const IoOptions& o, unsigned adapters, unsigned rpi_us) : options_(o), rpi_us_(rpi_us) {
    for (unsigned i = 0; i < adapters; ++i) {
      ends_.push_back(std::make_unique<End>(o.own, o.host + i, o.port, o.io_port));
      End& e = *ends_.back();
      if (!e.scanner.connect()) throw std::runtime_error("an adapter does not register a session");
      if (i == 0 && !e.scanner.open_io()) throw std::runtime_error("UDP 2222 is in use");
      e.to = address_of(o.host + i, o.io_port);
    }
    receiver_ = std::make_unique<Receiver>(ends_[0]->scanner.udp());
    for (unsigned i = 0; i < adapters; ++i) open(*ends_[i], static_cast<std::uint16_t>(i));
  }
  ~Master() {
    for (const auto& e : ends_)
      if (e->connection.ok) e->scanner.close(e->connection);
  }
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  // Goes on with the connections and counts what comes in the last part of the time.
  void run(double warm_up, double seconds, Arrivals* arrivals) {
    const std::int64_t counted = monotonic_ns() + static_cast<std::int64_t>(warm_up * 1e9);
    const std::int64_t end = counted + static_cast<std::int64_t>(seconds * 1e9);
    const std::int64_t interval = std::int64_t{rpi_us_} * 1000;
    for (;;) {
      const std::int64_t now = monotonic_ns();
      receiver_->take([&](std::uint32_t id, std::int64_t at) {
        if (arrivals != nullptr && now >= counted && (id & 0xffff0000) == 0x51000000) arrivals->add(id & 0xffff, at);
      });
      if (now >= end) return;
      // All have the same interval, so whoever sent longest ago is next.
      for (std::size_t n = 0; n < ends_.size() && ends_[next_]->next_at <= now; ++n) {
        End& e = *ends_[next_];
        next_ = (next_ + 1) % ends_.size();
        count_up(e.packet, e.count);
        ::sendto(ends_[0]->scanner.udp(), e.packet.data(), e.packet.size(), 0, reinterpret_cast<const sockaddr*>(&e.to),
                 sizeof e.to);
        e.next_at = std::max(e.next_at + interval, now - 4 * interval);
      }
      sleep_until_ns(std::min(end, ends_[next_]->next_at));
    }
  }

 private:
  struct End {
    End(std::uint32_t own, std::uint32_t host, std::uint16_t port, std::uint16_t io_port)
        : scanner(own, host, port, io_port) {}
    EipScanner scanner;
    Opened connection;
    sockaddr_in to{};
    Octets packet;
    std::uint32_t count = 0;
    std::int64_t next_at = 0;
  };
  void open(End& e, std::uint16_t serial) {
    scanner::OpenOptions open;
    open.connection_serial = serial;
    open.timeout_multiplier = 7;
    open.o2t_rpi_us = open.t2o_rpi_us = rpi_us_;
    open.o2t_size = static_cast<std::uint16_t>(6 + options_.consumed_bytes);
    open.t2o_size = static_cast<std::uint16_t>(2 + options_.produced_bytes);
    open.path = {0x20, 4};
    for (const unsigned point : options_.points) {
      open.path.push_back(0x2c);
      open.path.push_back(static_cast<std::uint8_t>(point));
    }
    e.connection = e.scanner.open(open);
    if (!e.connection.ok) {
      std::string status = "a connection is refused with status " + std::to_string(e.connection.status);
      for (const auto word : e.connection.extended) status += ", " + std::to_string(word);
      throw std::runtime_error(status);
    }
    if (e.connection.t2o_api_us != rpi_us_) throw std::runtime_error("the adapter does not keep the interval");
    e.packet = packet(e.connection.o2t_id, true, options_.consumed_bytes);
    e.next_at = monotonic_ns();
  }

  const IoOptions& options_;
  unsigned rpi_us_;
  std::vector<std::unique_ptr<End>> ends_;
  std::unique_ptr<Receiver> receiver_;
  std::size_t next_ = 0;
};

// Rounds of one side.
struct Rounds {
  std::vector<double> p50, p99, p999;
  double got = 0, asked = 0;
  void add(Arrivals& a, double packets_asked) {
    p50.push_back(quantile(a.deviations_us(), 0.5));
    p99.push_back(quantile(a.deviations_us(), 0.99));
    p999.push_back(quantile(a.deviations_us(), 0.999));
    got += static_cast<double>(a.count());
    asked += packets_asked;
  }
  IntervalStatistics statistics() const { return {median(p50), median(p99), median(p999), std::min(1.0, got / asked)}; }
};

void measure_sender(const IoOptions& o, unsigned streams, unsigned interval_us, Rounds& rounds) {
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM, 0));
  const sockaddr_in own = address_of(o.own, 2222);
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
    throw std::runtime_error("UDP 2222 is in use");
  Receiver receiver(fd.get());
  Arrivals arrivals(streams, interval_us);
  const Child sender([&] { send_at_deadlines(o.own, streams, interval_us, o.produced_bytes); });
  const std::int64_t counted = monotonic_ns() + static_cast<std::int64_t>(kWarmUp * 1e9);
  const std::int64_t end = counted + static_cast<std::int64_t>(o.round_s * 1e9);
  // As often awake as a master would be.
  for (std::int64_t now = monotonic_ns(); now < end; now = monotonic_ns()) {
    receiver.take([&](std::uint32_t id, std::int64_t at) {
      if (now >= counted && id - kSenderId < streams) arrivals.add(id - kSenderId, at);
    });
    sleep_until_ns(now + std::int64_t{interval_us} * 1000);
  }
  rounds.add(arrivals, streams * o.round_s * 1e6 / interval_us);
}

}  // namespace

std::vector<IoResult> measure_io(const IoOptions& o) {
  std::vector<IoResult> results;
  for (const unsigned adapters : o.adapters) {
    for (const unsigned rpi_us : o.rpi_us) {
      Rounds server, sender;
      double cpu = 0;
      for (unsigned round = 0; round < o.rounds; ++round) {
        {
          Master master(o, adapters, rpi_us);
          Arrivals arrivals(adapters, rpi_us);
          master.run(kWarmUp, 0, nullptr);
          const double before = o.pid != 0 ? cpu_seconds(o.pid) : 0;
          master.run(0, o.round_s, &arrivals);
          if (o.pid != 0) cpu += cpu_seconds(o.pid) - before;
          server.add(arrivals, adapters * o.round_s * 1e6 / rpi_us);
        }
        measure_sender(o, adapters, rpi_us, sender);
      }
      IoResult result;
      result.adapters = adapters;
      result.rpi_us = rpi_us;
      result.server = server.statistics();
      result.sender = sender.statistics();
      result.cpu_share_per_drive = cpu / (o.rounds * o.round_s) / adapters;
      results.push_back(result);
    }
  }
  return results;
}

struct Neighbour::Impl {
  Impl(const IoOptions& o, unsigned rpi) : options(o), rpi_us(rpi), master(options, 1, rpi) {}
  IoOptions options;
  unsigned rpi_us;
  Master master;
};

Neighbour::Neighbour(const IoOptions& options, unsigned rpi_us) : impl_(new Impl(options, rpi_us)) {}
Neighbour::~Neighbour() { delete impl_; }

IntervalStatistics Neighbour::run(double seconds) {
  Arrivals arrivals(1, impl_->rpi_us);
  impl_->master.run(kWarmUp, seconds, &arrivals);
  Rounds one;
  one.add(arrivals, seconds * 1e6 / impl_->rpi_us);
  return one.statistics();
}

}  // namespace vinv::bench
