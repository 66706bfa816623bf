#include "option_boards/ethernet_ip/forward_open.hpp"

#include <variant>

namespace vinv::ethernet_ip {
namespace {

// Priority and ticks, connection identifiers, triad, multiplier, reserved, then intervals with parameters of 2 or 4
// bytes, transport, path size.
constexpr std::size_t kForwardOpenSize = 36;
constexpr std::size_t kLargeForwardOpenSize = 40;
constexpr std::size_t kForwardCloseSize = 12;
constexpr std::uint8_t kInhibitTimeMs = 0x03;
constexpr std::uint8_t kInhibitTimeUs = 0x11;
constexpr std::uint16_t kDataAttribute = 3;  // of an assembly instance

std::optional<cip::GeneralStatus> check_path_size(std::size_t left, std::size_t words) {
  if (left < 2 * words) return cip::GeneralStatus::kNotEnoughData;
  if (left > 2 * words) return cip::GeneralStatus::kTooMuchData;
  return std::nullopt;
}

ConnectionTriad triad_at(ByteView data, std::size_t at) {
  return {read_le16(data, at), read_le16(data, at + 2), read_le32(data, at + 4)};
}

Duration microseconds_at(ByteView data, std::size_t at) { return std::chrono::microseconds(read_le32(data, at)); }

// Fills a path segment by segment; false: a segment that does not belong there.
struct PathBuilder {
  ConnectionPath path;
  bool application = false;  // key and network segments stand before it

  std::optional<ConnectionStatus> take(const cip::LogicalSegment& s) {
    using cip::LogicalType;
    application = true;
    switch (s.type) {
      case LogicalType::kClass:
        if (path.class_id && *path.class_id != s.value) return ConnectionStatus::kInvalidApplicationPath;
        path.class_id = static_cast<std::uint16_t>(s.value);
        return std::nullopt;
      case LogicalType::kInstance:
      case LogicalType::kConnectionPoint:
        if (!path.class_id || path.point_count == ConnectionPath::kMaxPoints) return ConnectionStatus::kInvalidSegment;
        path.points[path.point_count++] = s.value;
        return std::nullopt;
      case LogicalType::kAttribute:
        // The data of an assembly is what its instance stands for in any case.
        if (path.point_count != 0 && s.value == kDataAttribute) return std::nullopt;
        return ConnectionStatus::kInvalidSegment;
      default: return ConnectionStatus::kInvalidSegment;
    }
  }
  std::optional<ConnectionStatus> take(const cip::ElectronicKey& key) {
    if (path.key || application) return ConnectionStatus::kInvalidSegment;
    path.key = key;
    return std::nullopt;
  }
  std::optional<ConnectionStatus> take(const cip::NetworkSegment& s) {
    if (application || path.inhibit_time) return ConnectionStatus::kInvalidSegment;
    if (s.subtype == kInhibitTimeMs && s.data.size() == 1) {
      path.inhibit_time = std::chrono::milliseconds(s.data[0]);
    } else if (s.subtype == kInhibitTimeUs && s.data.size() == 4) {
      path.inhibit_time = std::chrono::microseconds(read_le32(s.data, 0));
    } else {
      return ConnectionStatus::kInvalidSegment;
    }
    return std::nullopt;
  }
  std::optional<ConnectionStatus> take(const cip::SimpleData& s) {
    if (!path.configuration.empty()) return ConnectionStatus::kInvalidSegment;
    path.configuration = s.words;
    return std::nullopt;
  }
  // There is nothing behind this device.
  std::optional<ConnectionStatus> take(const cip::PortSegment&) { return ConnectionStatus::kPortNotAvailable; }
  template <class Other>
  std::optional<ConnectionStatus> take(const Other&) {
    return ConnectionStatus::kInvalidSegment;
  }
};

}  // namespace

NetworkParameters network_parameters(std::uint16_t word) {
  NetworkParameters p;
  p.size = word & 0x1ff;
  p.variable = (word & 0x200) != 0;
  p.priority = static_cast<Priority>(word >> 10 & 3);
  p.type = static_cast<ConnectionType>(word >> 13 & 3);
  p.redundant_owner = (word & 0x8000) != 0;
  return p;
}

NetworkParameters large_network_parameters(std::uint32_t word) {
  NetworkParameters p = network_parameters(static_cast<std::uint16_t>(word >> 16));
  p.size = static_cast<std::uint16_t>(word);
  return p;
}

Result<ForwardOpen, cip::GeneralStatus> parse_forward_open(ByteView data, bool large) {
  const std::size_t fixed = large ? kLargeForwardOpenSize : kForwardOpenSize;
  if (data.size() < fixed) return Unexpected(cip::GeneralStatus::kNotEnoughData);
  if (const auto wrong = check_path_size(data.size() - fixed, data[fixed - 1])) return Unexpected(*wrong);
  ForwardOpen open;
  open.o2t_id = read_le32(data, 2);
  open.t2o_id = read_le32(data, 6);
  open.triad = triad_at(data, 10);
  open.timeout_multiplier = data[18];
  open.o2t_rpi = microseconds_at(data, 22);
  if (large) {
    open.o2t = large_network_parameters(read_le32(data, 26));
    open.t2o_rpi = microseconds_at(data, 30);
    open.t2o = large_network_parameters(read_le32(data, 34));
  } else {
    open.o2t = network_parameters(read_le16(data, 26));
    open.t2o_rpi = microseconds_at(data, 28);
    open.t2o = network_parameters(read_le16(data, 32));
  }
  open.transport = data[fixed - 2];
  open.path = data.subspan(fixed);
  return open;
}

Result<ForwardClose, cip::GeneralStatus> parse_forward_close(ByteView data) {
  if (data.size() < kForwardCloseSize) return Unexpected(cip::GeneralStatus::kNotEnoughData);
  if (const auto wrong = check_path_size(data.size() - kForwardCloseSize, data[10])) return Unexpected(*wrong);
  return ForwardClose{triad_at(data, 2), data.subspan(kForwardCloseSize)};
}

Result<ConnectionPath, ConnectionStatus> parse_connection_path(ByteView bytes) {
  cip::EpathReader reader(bytes, cip::PathForm::kPadded);
  PathBuilder builder;
  while (!reader.at_end()) {
    const auto segment = reader.next();
    if (!segment) return Unexpected(ConnectionStatus::kInvalidSegment);
    const auto refused = std::visit([&](const auto& s) { return builder.take(s); }, *segment);
    if (refused) return Unexpected(*refused);
  }
  return builder.path;
}

}  // namespace vinv::ethernet_ip
