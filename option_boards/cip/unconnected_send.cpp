#include "option_boards/cip/unconnected_send.hpp"

#include <variant>

namespace vinv::cip {

Result<UnconnectedSend, GeneralStatus> parse_unconnected_send(ByteView data) {
  constexpr std::size_t kHeader = 4;
  constexpr std::size_t kPathHeader = 2;
  if (data.size() < kHeader) return Unexpected(GeneralStatus::kNotEnoughData);
  UnconnectedSend send;
  send.priority_and_tick = data[0];
  send.timeout_ticks = data[1];
  const std::size_t size = read_le16(data, 2);
  data = data.subspan(kHeader);
  const std::size_t padded = size + size % 2;
  if (data.size() < padded + kPathHeader) return Unexpected(GeneralStatus::kNotEnoughData);
  send.message = data.first(size);
  if (padded != size && data[size] != 0) return Unexpected(GeneralStatus::kInvalidParameter);
  data = data.subspan(padded);
  const std::size_t path = 2 * std::size_t{data[0]};
  if (data[1] != 0) return Unexpected(GeneralStatus::kInvalidParameter);
  data = data.subspan(kPathHeader);
  if (data.size() < path) return Unexpected(GeneralStatus::kNotEnoughData);
  if (data.size() > path) return Unexpected(GeneralStatus::kTooMuchData);
  send.route_path = data;
  return send;
}

void append_unconnected_send(Bytes& out, const UnconnectedSend& send) {
  out.push_back(send.priority_and_tick);
  out.push_back(send.timeout_ticks);
  append_le16(out, static_cast<std::uint16_t>(send.message.size()));
  out.insert(out.end(), send.message.begin(), send.message.end());
  if (send.message.size() % 2 != 0) out.push_back(0);
  out.push_back(static_cast<std::uint8_t>(send.route_path.size() / 2));
  out.push_back(0);
  out.insert(out.end(), send.route_path.begin(), send.route_path.end());
}

bool route_ends_here(const UnconnectedSend& send, Reply& reply) {
  if (send.route_path.empty()) return true;
  EpathReader reader(send.route_path, PathForm::kPadded);
  const auto segment = reader.next();
  const bool is_port = segment && std::holds_alternative<PortSegment>(*segment);
  reply.refuse({GeneralStatus::kConnectionFailure, is_port ? kPortNotAvailable : kInvalidSegmentInPath});
  reply.data.push_back(static_cast<std::uint8_t>(send.route_path.size() / 2));
  reply.data.push_back(0);
  return false;
}

}  // namespace vinv::cip
