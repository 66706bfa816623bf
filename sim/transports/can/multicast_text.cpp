#include "sim/transports/can/multicast_text.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string_view>

#include "sim/transports/can/wire_format.hpp"

namespace vinv::transports {
namespace {

constexpr std::uint8_t kNil = 0xc0;
constexpr std::uint8_t kFalse = 0xc2;
constexpr std::uint8_t kTrue = 0xc3;
constexpr std::uint8_t kBin8 = 0xc4;
constexpr std::uint8_t kFloat32 = 0xca;
constexpr std::uint8_t kFloat64 = 0xcb;
constexpr std::uint8_t kUint8 = 0xcc;  // 16, 32 and 64 bits follow
constexpr std::uint8_t kInt8 = 0xd0;   // 16, 32 and 64 bits follow
constexpr std::uint8_t kStr8 = 0xd9;   // 16 and 32 bits follow
constexpr std::uint8_t kMap16 = 0xde;

void key(Bytes& out, std::string_view name) {
  out.push_back(static_cast<std::uint8_t>(0xa0 | name.size()));  // all names are shorter than 32
  out.insert(out.end(), name.begin(), name.end());
}

void flag(Bytes& out, std::string_view name, bool value) {
  key(out, name);
  out.push_back(value ? kTrue : kFalse);
}

// The values that can occur; what it says of a value is the last one read.
class Reader {
 public:
  explicit Reader(ByteView bytes) : bytes_(bytes) {}

  std::optional<std::size_t> map_size() {
    const auto head = byte();
    if (!head) return std::nullopt;
    if ((*head & 0xf0) == 0x80) return *head & 0x0f;
    if (*head == kMap16) return number(2);
    return std::nullopt;
  }

  // False if the datagram ends within it, or it is an array, a map or an extension.
  bool value() {
    integer = kNoInteger;
    boolean.reset();
    block = {};
    is_bytes = false;
    const auto head = byte();
    if (!head) return false;
    if (*head < 0x80) return integer = *head, true;
    if (*head >= 0xe0 || *head == kNil) return true;  // negative numbers mean nothing here
    if ((*head & 0xe0) == 0xa0) return take(*head & 0x1f);
    if (*head == kFalse || *head == kTrue) return boolean = *head == kTrue, true;
    if (*head >= kBin8 && *head < kBin8 + 3) return is_bytes = true, take_counted(*head - kBin8);
    if (*head >= kStr8 && *head < kStr8 + 3) return take_counted(*head - kStr8);
    if (*head == kFloat32) return number(4).has_value();
    if (*head == kFloat64) return number(8).has_value();
    if (*head >= kUint8 && *head < kUint8 + 4) return take_number(std::size_t{1} << (*head - kUint8));
    if (*head >= kInt8 && *head < kInt8 + 4) return number(std::size_t{1} << (*head - kInt8)).has_value();
    return false;
  }
  bool at_end() const { return bytes_.empty(); }

  // Beyond all that mean something here: the value was none.
  static constexpr std::uint64_t kNoInteger = ~std::uint64_t{0};
  std::uint64_t integer = kNoInteger;
  std::optional<bool> boolean;
  ByteView block;  // of a string, or of bytes
  bool is_bytes = false;
  std::string_view text() const { return {reinterpret_cast<const char*>(block.data()), block.size()}; }

 private:
  std::optional<std::uint8_t> byte() {
    if (bytes_.empty()) return std::nullopt;
    const std::uint8_t b = bytes_[0];
    bytes_ = bytes_.subspan(1);
    return b;
  }
  std::optional<std::uint64_t> number(std::size_t size) {
    if (bytes_.size() < size) return std::nullopt;
    std::uint64_t v = 0;
    for (std::size_t i = 0; i < size; ++i) v = v << 8 | bytes_[i];
    bytes_ = bytes_.subspan(size);
    return v;
  }
  bool take_number(std::size_t size) {
    const auto v = number(size);
    if (v) integer = *v;
    return v.has_value();
  }
  bool take(std::uint64_t size) {
    if (bytes_.size() < size) return false;
    block = bytes_.subspan(0, size);
    bytes_ = bytes_.subspan(size);
    return true;
  }
  bool take_counted(int width) {
    const auto size = number(std::size_t{1} << width);
    return size && take(*size);
  }

  ByteView bytes_;
};

}  // namespace

Bytes multicast_datagram(const CanFrame& frame, double timestamp_s) {
  Bytes out{0x8b};  // eleven entries
  key(out, "timestamp");
  out.push_back(kFloat64);
  const auto raw = std::bit_cast<std::uint64_t>(timestamp_s);
  append_be32(out, static_cast<std::uint32_t>(raw >> 32));
  append_be32(out, static_cast<std::uint32_t>(raw));
  key(out, "arbitration_id");
  out.push_back(kUint8 + 2);
  append_be32(out, frame.id);
  flag(out, "is_extended_id", frame.extended);
  flag(out, "is_remote_frame", frame.remote);
  flag(out, "is_error_frame", false);
  key(out, "channel");
  out.push_back(kNil);
  key(out, "dlc");
  out.push_back(frame.length);
  key(out, "data");
  out.push_back(kBin8);
  out.push_back(static_cast<std::uint8_t>(frame.bytes().size()));
  out.insert(out.end(), frame.bytes().begin(), frame.bytes().end());
  flag(out, "is_fd", false);
  flag(out, "bitrate_switch", false);
  flag(out, "error_state_indicator", false);
  return out;
}

std::optional<CanFrame> parse_multicast_datagram(ByteView bytes) {
  Reader in(bytes);
  const auto entries = in.map_size();
  if (!entries) return std::nullopt;
  CanFrame frame;
  bool has_id = false;
  std::uint64_t dlc = Reader::kNoInteger;
  ByteView data;
  for (std::size_t i = 0; i < *entries; ++i) {
    if (!in.value()) return std::nullopt;
    const std::string_view name = in.text();
    if (!in.value()) return std::nullopt;
    if (name == "arbitration_id") {
      if (in.integer > 0x1fffffff) return std::nullopt;
      frame.id = static_cast<std::uint32_t>(in.integer);
      has_id = true;
    } else if (name == "is_extended_id") {
      frame.extended = in.boolean.value_or(false);
    } else if (name == "is_remote_frame") {
      frame.remote = in.boolean.value_or(false);
    } else if (name == "is_error_frame" || name == "is_fd") {
      if (in.boolean.value_or(false)) return std::nullopt;
    } else if (name == "dlc") {
      dlc = in.integer;
    } else if (name == "data" && in.is_bytes) {
      data = in.block;
    }
  }
  if (!in.at_end() || !has_id || dlc > 8 || data.size() > 8) return std::nullopt;
  frame.length = static_cast<std::uint8_t>(dlc);
  if (!is_well_formed(frame) || (!frame.remote && data.size() != frame.length)) return std::nullopt;
  if (!frame.remote) std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

}  // namespace vinv::transports
