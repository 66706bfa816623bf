#include "option_boards/ethernet_ip/message_stream.hpp"

#include <algorithm>

namespace vinv::ethernet_ip {

std::optional<EncapsulationMessage> MessageStream::take(Instant now, ByteView& bytes) {
  if (done_ != 0) {
    partial_.clear();
    done_ = 0;
  }
  if (skip_ != 0) {
    const std::size_t n = std::min(skip_, bytes.size());
    skip_ -= n;
    bytes = bytes.subspan(n);
    if (skip_ != 0) return std::nullopt;
    deadline_.reset();
  }
  if (bytes.empty()) return std::nullopt;

  if (partial_.empty()) {
    if (const auto header = parse_header(bytes); header && header->length <= kMaxEncapsulatedData) {
      const std::size_t whole = kEncapsulationHeader + header->length;
      if (bytes.size() >= whole) {
        const EncapsulationMessage message{*header, bytes.subspan(kEncapsulationHeader, header->length)};
        bytes = bytes.subspan(whole);
        return message;
      }
    }
    deadline_ = now + kPartialMessageTimeout;
  }

  const auto append = [&](std::size_t wanted) {
    const std::size_t n = std::min(wanted - std::min(wanted, partial_.size()), bytes.size());
    partial_.insert(partial_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    bytes = bytes.subspan(n);
  };
  append(kEncapsulationHeader);
  const auto header = parse_header(partial_);
  if (!header) return std::nullopt;
  if (header->length > kMaxEncapsulatedData) {
    partial_.clear();
    skip_ = header->length;
    return EncapsulationMessage{*header, {}, true};
  }
  append(kEncapsulationHeader + header->length);
  if (partial_.size() < kEncapsulationHeader + header->length) return std::nullopt;
  done_ = partial_.size();
  deadline_.reset();
  return EncapsulationMessage{*header, ByteView(partial_).subspan(kEncapsulationHeader)};
}

}  // namespace vinv::ethernet_ip
