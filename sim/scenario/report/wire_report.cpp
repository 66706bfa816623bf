#include "sim/scenario/report/wire_report.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "sim/base/can_frame.hpp"
#include "sim/transports/can/can_recorder.hpp"
#include "sim/transports/can/error_frame.hpp"
#include "sim/transports/pcapng.hpp"
#include "sim/transports/serial_packets.hpp"
#include "sim/transports/tcp_conversation.hpp"
#include "sim/transports/udp_frame.hpp"

namespace vinv::scenario {
namespace {

using transports::CanErrorFrame;
using transports::PacketDirection;

// Identifier flags of linux/can.h.
constexpr std::uint32_t kExtendedFlag = 0x80000000;
constexpr std::uint32_t kRemoteFlag = 0x40000000;
constexpr std::uint32_t kExtendedMask = 0x1FFFFFFF;
constexpr std::uint32_t kStandardMask = 0x7FF;

bool is_can(const WireRecord& r) {
  return r.kind == WireRecord::Kind::kCanFrame || r.kind == WireRecord::Kind::kCanError;
}

// A remote frame's record holds as many bytes as it asks for.
CanFrame can_frame(const WireRecord& r) {
  CanFrame f;
  f.extended = (r.id & kExtendedFlag) != 0;
  f.remote = (r.id & kRemoteFlag) != 0;
  f.id = r.id & (f.extended ? kExtendedMask : kStandardMask);
  f.length = static_cast<std::uint8_t>(std::min<std::size_t>(r.bytes.size(), f.data.size()));
  if (!f.remote) std::copy_n(r.bytes.begin(), f.length, f.data.begin());
  return f;
}

CanErrorFrame error_frame(const WireRecord& r) {
  CanErrorFrame f;
  f.error_class = r.id & ~CanErrorFrame::kFlag;
  std::copy_n(r.bytes.begin(), std::min(r.bytes.size(), f.data.size()), f.data.begin());
  return f;
}

// As CanRecorder names them: no blanks.
std::string interface_name(const std::string& network, const std::string& fallback) {
  std::string name = network.empty() ? fallback : network;
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return name;
}

transports::IpEndpoint test_net(std::uint8_t host, std::uint16_t port) {
  transports::IpEndpoint end;
  end.address = {192, 0, 2, host};
  end.port = port;
  return end;
}

bool from_master(const WireRecord& r) { return r.sender == "master"; }

class Capture {
 public:
  Capture() { encoder_.begin_section(head_, "vinverter"); }

  void add(const WireRecord& r) {
    switch (r.kind) {
      case WireRecord::Kind::kCanFrame: return can(r, transports::socketcan_packet(can_frame(r)));
      case WireRecord::Kind::kCanError: return can(r, transports::socketcan_packet(error_frame(r)));
      case WireRecord::Kind::kSerial: return serial(r);
      case WireRecord::Kind::kTcp: return tcp(r);
      case WireRecord::Kind::kUdp: return udp(r);
    }
  }

  Bytes finish() {
    for (auto& [network, line] : lines_) line->flush();
    for (auto& [key, connection] : connections_) connection->conversation->close(transports::TcpSide::kClient);
    // A serial packet is complete only some time after it began.
    std::stable_sort(blocks_.begin(), blocks_.end(), [](const Block& a, const Block& b) { return a.at < b.at; });
    head_.reserve(head_.size() + packets_.size());
    for (const Block& b : blocks_) {
      const auto begin = packets_.begin() + static_cast<std::ptrdiff_t>(b.begin);
      head_.insert(head_.end(), begin, begin + static_cast<std::ptrdiff_t>(b.size));
    }
    return std::move(head_);
  }

 private:
  struct Block {
    Instant at;
    std::size_t begin = 0;  // in packets_
    std::size_t size = 0;
  };
  struct Connection {
    Instant last{};
    std::unique_ptr<transports::TcpConversation> conversation;
  };

  void packet(std::uint32_t interface_id, Instant at, ByteView data,
              PacketDirection direction = PacketDirection::kUnknown) {
    const std::size_t begin = packets_.size();
    encoder_.packet(packets_, interface_id, at, data, direction);
    blocks_.push_back({at, begin, packets_.size() - begin});
  }

  void can(const WireRecord& r, const Bytes& data) {
    auto found = buses_.find(r.network);
    if (found == buses_.end()) {
      found = buses_
                  .emplace(r.network, encoder_.add_interface(head_, transports::kLinkTypeSocketCan,
                                                             interface_name(r.network, "can0")))
                  .first;
    }
    packet(found->second, r.at, data);
  }

  void serial(const WireRecord& r) {
    auto& line = lines_[r.network];
    if (!line) {
      const std::uint32_t id =
          encoder_.add_interface(head_, transports::LinkType::kRtacSerial, interface_name(r.network, "serial"));
      line = std::make_unique<transports::SerialPackets>(
          [this, id](Instant at, ByteView data, PacketDirection direction) { packet(id, at, data, direction); });
    }
    line->bytes(r.at, from_master(r) ? PacketDirection::kInbound : PacketDirection::kOutbound, r.bytes);
  }

  std::uint32_t ethernet(const std::string& name) {
    auto network = ethernets_.find(name);
    if (network == ethernets_.end())
      network = ethernets_
                    .emplace(name, encoder_.add_interface(head_, transports::LinkType::kEthernet,
                                                          interface_name(name, "tcp")))
                    .first;
    return network->second;
  }

  // Class 1 packets; both ends have the standard's port.
  void udp(const WireRecord& r) {
    constexpr std::uint16_t kIoPort = 2222;
    const auto device = transports::parse_ip_endpoint(r.network).value_or(test_net(254, 0)).address;
    const Ipv4Endpoint drive{ipv4(device[0], device[1], device[2], device[3]), kIoPort};
    const Ipv4Endpoint master{ipv4(192, 0, 2, 1), kIoPort};
    transports::make_udp_frame(frame_, from_master(r) ? master : drive, from_master(r) ? drive : master, r.bytes,
                               {.ip_id = next_ip_id_++, .dscp = 0});
    packet(ethernet(r.network), r.at, frame_, from_master(r) ? PacketDirection::kInbound : PacketDirection::kOutbound);
  }

  void tcp(const WireRecord& r) {
    using transports::TcpSide;
    auto& connection = connections_[{r.network, r.connection}];
    if (!connection) {
      const auto number = static_cast<std::uint32_t>(connections_.size() - 1);
      const std::uint32_t id = ethernet(r.network);
      connection = std::make_unique<Connection>();
      connection->last = r.at;
      connection->conversation = std::make_unique<transports::TcpConversation>(
          test_net(1, static_cast<std::uint16_t>(49152 + number % 16384)),
          transports::parse_ip_endpoint(r.network).value_or(test_net(254, 502)), number,
          [this, id, &last = connection->last](TcpSide from, ByteView frame) {
            packet(id, last, frame, from == TcpSide::kClient ? PacketDirection::kInbound : PacketDirection::kOutbound);
          });
      connection->conversation->open();
    }
    connection->last = r.at;
    connection->conversation->data(from_master(r) ? TcpSide::kClient : TcpSide::kServer, r.bytes);
  }

  Bytes frame_;
  std::uint16_t next_ip_id_ = 0;
  Bytes head_;  // the section and its interfaces
  Bytes packets_;
  std::vector<Block> blocks_;
  transports::PcapngEncoder encoder_;
  std::map<std::string, std::uint32_t> buses_;
  std::map<std::string, std::unique_ptr<transports::SerialPackets>> lines_;
  std::map<std::string, std::uint32_t> ethernets_;
  std::map<std::pair<std::string, std::uint32_t>, std::unique_ptr<Connection>> connections_;
};

}  // namespace

std::string candump_log(const Recording& recording) {
  std::string out;
  for (const WireRecord& r : recording.wire) {
    if (!is_can(r)) continue;
    const std::string name = interface_name(r.network, "can0");
    const std::int64_t us = to_ns(r.at) / 1000;
    out += r.kind == WireRecord::Kind::kCanFrame ? transports::candump_line(us, name, can_frame(r))
                                                 : transports::candump_line(us, name, error_frame(r));
    out += '\n';
  }
  return out;
}

Bytes wire_pcapng(const Recording& recording) {
  if (recording.wire.empty()) return {};
  Capture capture;
  for (const WireRecord& r : recording.wire) capture.add(r);
  return capture.finish();
}

}  // namespace vinv::scenario
