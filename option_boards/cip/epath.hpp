// Paths: a sequence of segments. CIP Vol 1, appendix C-1.
//
// A padded path consists of words: 16 and 32 bit logical values follow a pad byte of 0, and whatever would end on an
// odd byte gets one. A packed path has no pads (DeviceNet: 62 34 37). Reading takes no memory: texts and addresses are
// views of the bytes read.
//
// Refused where they occur: segments that end too late, pads other than 0, reserved formats and types, 32 bits where
// C-1.4.2 has none (class, attribute, service), key formats other than 4, port 0, empty addresses and texts. Data type
// segments and extended logical segments are not part of any path that a device here understands; they are unknown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "option_boards/cip/status.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"

namespace vinv::cip {

enum class PathForm : std::uint8_t { kPadded, kPacked };

enum class LogicalType : std::uint8_t {
  kClass = 0,
  kInstance = 1,
  kMember = 2,
  kConnectionPoint = 3,
  kAttribute = 4,
  kService = 6,
};
enum class LogicalWidth : std::uint8_t { k8 = 0, k16 = 1, k32 = 2 };

struct LogicalSegment {
  LogicalType type = LogicalType::kClass;
  LogicalWidth width = LogicalWidth::k8;
  std::uint32_t value = 0;
  friend constexpr bool operator==(const LogicalSegment&, const LogicalSegment&) = default;
};

// Key format 4. Zero matches anything.
struct ElectronicKey {
  std::uint16_t vendor_id = 0;
  std::uint16_t device_type = 0;
  std::uint16_t product_code = 0;
  std::uint8_t major_revision = 0;  // 0-127
  bool compatible = false;          // a device that can stand in for the one named will do
  std::uint8_t minor_revision = 0;
  friend constexpr bool operator==(const ElectronicKey&, const ElectronicKey&) = default;
};

struct PortSegment {
  std::uint16_t port = 1;      // 1-14, or 15-65535 in a word of its own
  bool sized_address = false;  // the address has a length: always if it is not one byte
  ByteView link_address;       // 1-255 bytes
};

// Schedules, production inhibit time (subtype 3: one byte, ms; 0x11: UDINT, us) and other words of the network.
struct NetworkSegment {
  std::uint8_t subtype = 0;  // 0x10 and above: data is a number of words
  ByteView data;             // below 0x10 one byte
};

// ASCII, 1-31 characters.
struct SymbolicSegment {
  std::string_view name;
};
// The number forms of an extended symbol: USINT, UINT or UDINT.
struct NumericSymbol {
  LogicalWidth width = LogicalWidth::k8;
  std::uint32_t value = 0;
};
// The text forms of an extended symbol: characters of 2 or 3 bytes.
struct WideSymbol {
  std::uint8_t bytes_per_character = 2;
  ByteView text;
};
// 0x80: words for the object at the end of the path (configuration data of a Forward_Open).
struct SimpleData {
  ByteView words;
};
// 0x91: ANSI extended symbol.
struct AnsiSymbol {
  std::string_view name;
};

using Segment = std::variant<LogicalSegment, ElectronicKey, PortSegment, NetworkSegment, SymbolicSegment, NumericSymbol,
                             WideSymbol, SimpleData, AnsiSymbol>;

enum class PathFault : std::uint8_t {
  kTruncated,       // the segment ends after the path
  kUnknownSegment,  // type or subtype reserved or not ours
  kReservedFormat,  // a logical format that the type does not have
  kBadPad,
  kUnknownKey,
  kBadPort,
  kEmpty,  // an address or text without bytes
};

struct PathError {
  PathFault fault = PathFault::kTruncated;
  std::size_t offset = 0;  // of the segment, in bytes from the start of the path
  friend constexpr bool operator==(const PathError&, const PathError&) = default;
};

// Goes through a path segment by segment. The bytes outlive the reader and what it returns.
class EpathReader {
 public:
  EpathReader(ByteView path, PathForm form) : path_(path), form_(form) {}
  bool at_end() const { return at_ == path_.size(); }
  // Bytes read so far.
  std::size_t offset() const { return at_; }
  // Not at the end. After an error the reader stays where it is.
  Result<Segment, PathError> next();

 private:
  ByteView path_;
  PathForm form_;
  std::size_t at_ = 0;
};

// Ends the process for a segment that has no bytes (empty address, text of 32 characters ...).
void append_segment(Bytes& out, const Segment& segment, PathForm form);
// With the smallest width that the value fits.
void append_logical(Bytes& out, LogicalType type, std::uint32_t value, PathForm form);

// Where an explicit request goes: class, then at most instance (or connection point, which stands for the instance of
// an assembly), attribute and member, each once and in this order. A path that ends with the class means instance 0.
struct ObjectPath {
  std::uint16_t class_id = 0;
  std::uint32_t instance = 0;
  std::optional<std::uint16_t> attribute;
  std::optional<std::uint32_t> member;
  friend constexpr bool operator==(const ObjectPath&, const ObjectPath&) = default;
  VINV_ARCHIVE(ObjectPath, class_id, instance, attribute, member);
};

// kPathSegmentError for anything else, an empty path included.
Result<ObjectPath, GeneralStatus> parse_object_path(ByteView path, PathForm form);
void append_object_path(Bytes& out, const ObjectPath& path, PathForm form);

}  // namespace vinv::cip
