#include "sim/transports/memory_datagrams.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace vinv::transports {
namespace {

constexpr std::uint32_t kLimitedBroadcast = 0xffffffff;

// One network for all: 127.255.255.255, 192.168.1.255 and the like reach every host with the same leading bytes.
bool is_directed_broadcast(std::uint32_t to, std::uint32_t host) {
  for (std::uint32_t host_part = 0xff; host_part != 0xffffffff; host_part = host_part << 8 | 0xff)
    if ((to & host_part) == host_part && (to & ~host_part) == (host & ~host_part)) return true;
  return false;
}

}  // namespace

class MemoryDatagrams::Port : public UdpPort {
 public:
  Port(MemoryDatagrams& network, const Ipv4Endpoint& local) : network_(network), local_(local) {
    network_.ports_[local_] = this;
  }
  ~Port() override { network_.ports_.erase(local_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  void set_handler(OnDatagram on_datagram) override { handler_ = std::move(on_datagram); }
  void send(Instant now, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t /*dscp*/) override {
    network_.send(now, local_, to, bytes);
  }
  Result<void, std::string> join(std::uint32_t group) override {
    if (!is_multicast(group)) return Unexpected(ipv4_text(group) + " is not a multicast address");
    groups_.insert(group);
    return {};
  }
  void leave(std::uint32_t group) override { groups_.erase(group); }
  Ipv4Endpoint local() const override { return local_; }

  bool is_member(std::uint32_t group) const { return groups_.contains(group); }
  void receive(Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    const auto handler = handler_;  // kept, should it set another one
    if (handler) handler(now, from, bytes);
  }

 private:
  MemoryDatagrams& network_;
  Ipv4Endpoint local_;
  OnDatagram handler_;
  std::set<std::uint32_t> groups_;
};

MemoryDatagrams::~MemoryDatagrams() {
  if (event_ != 0) scheduler_.cancel(event_);
}

Result<std::unique_ptr<UdpPort>, std::string> MemoryDatagrams::open(const Ipv4Endpoint& local) {
  if (ports_.contains(local))
    return Unexpected(ipv4_text(local.address) + ":" + std::to_string(local.port) + " is in use on this network");
  return std::unique_ptr<UdpPort>(std::make_unique<Port>(*this, local));
}

void MemoryDatagrams::set_link(std::uint32_t address, bool up) {
  if (up) {
    state_.unplugged.erase(address);
  } else {
    state_.unplugged[address] = true;
  }
}

void MemoryDatagrams::send(Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes) {
  if (state_.unplugged.contains(from.address) || state_.under_way.size() >= kMaxUnderWay ||
      bytes.size() > UdpPort::kMaxDatagram) {
    ++state_.lost;
    return;
  }
  const Instant at = std::max(now, scheduler_.now()) + delay_;
  state_.under_way.push_back({at, from, to, Bytes(bytes.begin(), bytes.end())});
  if (event_ == 0) schedule_next();
}

void MemoryDatagrams::schedule_next() {
  event_ = 0;
  if (state_.under_way.empty()) return;
  event_ =
      scheduler_.schedule(state_.under_way.front().at, kernel::Priority::kWire, [this](Instant now) { deliver(now); });
}

bool MemoryDatagrams::hears(const Port& port, const Ipv4Endpoint& from, const Ipv4Endpoint& to) const {
  const Ipv4Endpoint local = port.local();
  if (state_.unplugged.contains(local.address)) return false;
  if (local == to) return true;
  if (local.port != to.port || local.address == from.address) return false;
  if (is_multicast(to.address)) return port.is_member(to.address);
  return to.address == kLimitedBroadcast || is_directed_broadcast(to.address, local.address);
}

void MemoryDatagrams::deliver(Instant now) {
  // What handlers send now arrives in an event of its own.
  std::size_t due = 0;
  while (due < state_.under_way.size() && state_.under_way[due].at <= now) ++due;
  for (; due != 0; --due) {
    const Datagram datagram = std::move(state_.under_way.front());
    state_.under_way.pop_front();
    std::vector<Ipv4Endpoint> receivers;
    if (const auto one = ports_.find(datagram.to); one != ports_.end()) {
      if (hears(*one->second, datagram.from, datagram.to)) receivers.push_back(datagram.to);
    } else {
      for (const auto& [local, port] : ports_)
        if (hears(*port, datagram.from, datagram.to)) receivers.push_back(local);
    }
    state_.lost += receivers.empty() ? 1 : 0;
    for (const Ipv4Endpoint& local : receivers) {
      const auto port = ports_.find(local);  // an earlier handler may have closed it
      if (port == ports_.end()) continue;
      ++state_.delivered;
      port->second->receive(now, datagram.from, datagram.bytes);
    }
  }
  schedule_next();
}

}  // namespace vinv::transports
