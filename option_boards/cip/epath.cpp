#include "option_boards/cip/epath.hpp"

#include <algorithm>
#include <type_traits>

namespace vinv::cip {
namespace {

// The three high bits of a segment's first byte.
enum class SegmentKind : std::uint8_t { kPort = 0, kLogical = 1, kNetwork = 2, kSymbolic = 3, kData = 4 };

constexpr std::uint8_t kLowBits = 0x1F;
constexpr std::uint8_t kSizedAddress = 0x10;
constexpr std::uint8_t kPortMask = 0x0F;
constexpr std::uint16_t kExtendedPort = 15;
constexpr std::uint8_t kSpecial = 5;           // logical type of the electronic key
constexpr std::uint8_t kElectronicKey = 0x34;  // special, format 0
constexpr std::uint8_t kKeyFormat = 4;
constexpr std::uint8_t kCompatibilityBit = 0x80;
constexpr std::uint8_t kManyNetworkWords = 0x10;
constexpr std::uint8_t kSimpleData = 0x80;
constexpr std::uint8_t kAnsiSymbol = 0x91;
constexpr std::uint8_t kDoubleByteText = 0x20, kTripleByteText = 0x40;
constexpr std::uint8_t kNumeric = 0xC0, kNumericFirst = 6, kNumericLast = 8;

constexpr std::size_t bytes_of(LogicalWidth width) { return std::size_t{1} << static_cast<unsigned>(width); }

std::string_view as_text(ByteView bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
ByteView as_bytes(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

std::uint8_t first_byte(SegmentKind kind, unsigned low) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(kind) << 5 | low);
}

bool width_allowed(LogicalType type, LogicalWidth width) {
  switch (type) {
    case LogicalType::kService: return width == LogicalWidth::k8;
    case LogicalType::kClass:
    case LogicalType::kAttribute: return width != LogicalWidth::k32;
    default: return true;
  }
}

// Reads one segment; the first fault is kept and everything after it is 0.
class Cursor {
 public:
  Cursor(ByteView rest, PathForm form) : rest_(rest), form_(form) {}

  std::uint8_t byte() {
    const ByteView one = bytes(1);
    return one.empty() ? std::uint8_t{0} : one[0];
  }
  std::uint16_t word() {
    const ByteView two = bytes(2);
    return two.empty() ? std::uint16_t{0} : read_le16(two, 0);
  }
  std::uint32_t number(LogicalWidth width) {
    const ByteView raw = bytes(bytes_of(width));
    std::uint32_t value = 0;
    for (std::size_t i = raw.size(); i-- > 0;) value = value << 8 | raw[i];
    return value;
  }
  ByteView bytes(std::size_t count) {
    if (fault_) return {};
    if (count > rest_.size() - used_) {
      fail(PathFault::kTruncated);
      return {};
    }
    const ByteView taken = rest_.subspan(used_, count);
    used_ += count;
    return taken;
  }
  ByteView some_bytes(std::size_t count) {
    if (count == 0) fail(PathFault::kEmpty);
    return bytes(count);
  }
  void pad() {
    if (form_ == PathForm::kPadded && byte() != 0) fail(PathFault::kBadPad);
  }
  void pad_to_word() {
    if (used_ % 2 != 0) pad();
  }
  void fail(PathFault fault) {
    if (!fault_) fault_ = fault;
  }
  const std::optional<PathFault>& fault() const { return fault_; }
  std::size_t used() const { return used_; }

 private:
  ByteView rest_;
  PathForm form_;
  std::size_t used_ = 0;
  std::optional<PathFault> fault_;
};

Segment read_key(Cursor& c) {
  if (c.byte() != kKeyFormat) c.fail(PathFault::kUnknownKey);
  ElectronicKey key;
  key.vendor_id = c.word();
  key.device_type = c.word();
  key.product_code = c.word();
  const std::uint8_t major = c.byte();
  key.major_revision = static_cast<std::uint8_t>(major & ~kCompatibilityBit);
  key.compatible = (major & kCompatibilityBit) != 0;
  key.minor_revision = c.byte();
  return key;
}

Segment read_logical(Cursor& c, std::uint8_t first) {
  if (first == kElectronicKey) return read_key(c);
  const auto type = static_cast<std::uint8_t>(first >> 2 & 7);
  const auto format = static_cast<std::uint8_t>(first & 3);
  LogicalSegment segment;
  if (type == kSpecial || type > static_cast<std::uint8_t>(LogicalType::kService)) {
    c.fail(PathFault::kUnknownSegment);
    return segment;
  }
  segment.type = static_cast<LogicalType>(type);
  segment.width = static_cast<LogicalWidth>(std::min<std::uint8_t>(format, 2));
  if (format > 2 || !width_allowed(segment.type, segment.width)) {
    c.fail(PathFault::kReservedFormat);
    return segment;
  }
  if (segment.width != LogicalWidth::k8) c.pad();
  segment.value = c.number(segment.width);
  return segment;
}

Segment read_port(Cursor& c, std::uint8_t first) {
  PortSegment segment;
  segment.sized_address = (first & kSizedAddress) != 0;
  const std::size_t address_bytes = segment.sized_address ? c.byte() : 1;
  segment.port = first & kPortMask;
  if (segment.port == kExtendedPort) {
    segment.port = c.word();
    if (segment.port < kExtendedPort) c.fail(PathFault::kBadPort);
  }
  if (segment.port == 0) c.fail(PathFault::kBadPort);
  segment.link_address = c.some_bytes(address_bytes);
  c.pad_to_word();
  return segment;
}

Segment read_network(Cursor& c, std::uint8_t first) {
  NetworkSegment segment;
  segment.subtype = first & kLowBits;
  if (segment.subtype == 0) c.fail(PathFault::kUnknownSegment);
  segment.data = c.bytes(segment.subtype < kManyNetworkWords ? 1 : 2 * std::size_t{c.byte()});
  return segment;
}

Segment read_symbolic(Cursor& c, std::uint8_t first) {
  if (const std::size_t length = first & kLowBits; length != 0) {
    const SymbolicSegment segment{as_text(c.bytes(length))};
    c.pad_to_word();
    return segment;
  }
  const std::uint8_t form = c.byte();
  const auto count = static_cast<std::uint8_t>(form & kLowBits);
  switch (form & ~kLowBits) {
    case kDoubleByteText:
    case kTripleByteText: {
      WideSymbol segment;
      segment.bytes_per_character = (form & ~kLowBits) == kDoubleByteText ? 2 : 3;
      segment.text = c.some_bytes(std::size_t{count} * segment.bytes_per_character);
      c.pad_to_word();
      return segment;
    }
    case kNumeric: {
      NumericSymbol segment;
      if (count < kNumericFirst || count > kNumericLast) {
        c.fail(PathFault::kUnknownSegment);
        return segment;
      }
      segment.width = static_cast<LogicalWidth>(count - kNumericFirst);
      segment.value = c.number(segment.width);
      c.pad_to_word();
      return segment;
    }
    default: c.fail(PathFault::kUnknownSegment); return SymbolicSegment{};
  }
}

Segment read_data(Cursor& c, std::uint8_t first) {
  if (first == kSimpleData) return SimpleData{c.bytes(2 * std::size_t{c.byte()})};
  if (first != kAnsiSymbol) {
    c.fail(PathFault::kUnknownSegment);
    return SimpleData{};
  }
  const AnsiSymbol segment{as_text(c.some_bytes(c.byte()))};
  c.pad_to_word();
  return segment;
}

Segment read_segment(Cursor& c) {
  const std::uint8_t first = c.byte();
  switch (static_cast<SegmentKind>(first >> 5)) {
    case SegmentKind::kPort: return read_port(c, first);
    case SegmentKind::kLogical: return read_logical(c, first);
    case SegmentKind::kNetwork: return read_network(c, first);
    case SegmentKind::kSymbolic: return read_symbolic(c, first);
    case SegmentKind::kData: return read_data(c, first);
  }
  c.fail(PathFault::kUnknownSegment);
  return LogicalSegment{};
}

class Writer {
 public:
  Writer(Bytes& out, PathForm form) : out_(out), form_(form), start_(out.size()) {}

  void operator()(const LogicalSegment& s) {
    VINV_CHECK(width_allowed(s.type, s.width) && fits(s.value, s.width));
    byte(first_byte(SegmentKind::kLogical, static_cast<unsigned>(s.type) << 2 | static_cast<unsigned>(s.width)));
    if (s.width != LogicalWidth::k8 && form_ == PathForm::kPadded) byte(0);
    number(s.value, s.width);
  }
  void operator()(const ElectronicKey& s) {
    VINV_CHECK(s.major_revision < kCompatibilityBit);
    byte(kElectronicKey);
    byte(kKeyFormat);
    append_le16(out_, s.vendor_id);
    append_le16(out_, s.device_type);
    append_le16(out_, s.product_code);
    byte(static_cast<std::uint8_t>(s.major_revision | (s.compatible ? kCompatibilityBit : 0)));
    byte(s.minor_revision);
  }
  void operator()(const PortSegment& s) {
    VINV_CHECK(s.port != 0 && !s.link_address.empty() && s.link_address.size() <= 0xFF);
    VINV_CHECK(s.sized_address || s.link_address.size() == 1);
    const unsigned low = std::min(s.port, kExtendedPort);
    byte(first_byte(SegmentKind::kPort, low | (s.sized_address ? kSizedAddress : 0u)));
    if (s.sized_address) byte(static_cast<std::uint8_t>(s.link_address.size()));
    if (s.port >= kExtendedPort) append_le16(out_, s.port);
    bytes(s.link_address);
    pad_to_word();
  }
  void operator()(const NetworkSegment& s) {
    VINV_CHECK(s.subtype != 0 && s.subtype <= kLowBits);
    byte(first_byte(SegmentKind::kNetwork, s.subtype));
    if (s.subtype < kManyNetworkWords) {
      VINV_CHECK(s.data.size() == 1);
    } else {
      words(s.data);
    }
    bytes(s.data);
  }
  void operator()(const SymbolicSegment& s) {
    VINV_CHECK(!s.name.empty() && s.name.size() <= kLowBits);
    byte(first_byte(SegmentKind::kSymbolic, static_cast<unsigned>(s.name.size())));
    bytes(as_bytes(s.name));
    pad_to_word();
  }
  void operator()(const NumericSymbol& s) {
    VINV_CHECK(fits(s.value, s.width));
    byte(first_byte(SegmentKind::kSymbolic, 0));
    byte(static_cast<std::uint8_t>(kNumeric | (kNumericFirst + static_cast<unsigned>(s.width))));
    number(s.value, s.width);
    pad_to_word();
  }
  void operator()(const WideSymbol& s) {
    const std::size_t characters = s.text.size() / s.bytes_per_character;
    VINV_CHECK((s.bytes_per_character == 2 || s.bytes_per_character == 3) && characters != 0 && characters <= kLowBits);
    VINV_CHECK(characters * s.bytes_per_character == s.text.size());
    byte(first_byte(SegmentKind::kSymbolic, 0));
    byte(static_cast<std::uint8_t>((s.bytes_per_character == 2 ? kDoubleByteText : kTripleByteText) | characters));
    bytes(s.text);
    pad_to_word();
  }
  void operator()(const SimpleData& s) {
    byte(kSimpleData);
    words(s.words);
    bytes(s.words);
  }
  void operator()(const AnsiSymbol& s) {
    VINV_CHECK(!s.name.empty() && s.name.size() <= 0xFF);
    byte(kAnsiSymbol);
    byte(static_cast<std::uint8_t>(s.name.size()));
    bytes(as_bytes(s.name));
    pad_to_word();
  }

 private:
  static bool fits(std::uint32_t value, LogicalWidth width) {
    return width == LogicalWidth::k32 || value >> (8 * bytes_of(width)) == 0;
  }
  void byte(std::uint8_t value) { out_.push_back(value); }
  void bytes(ByteView values) { out_.insert(out_.end(), values.begin(), values.end()); }
  void words(ByteView values) {
    VINV_CHECK(values.size() % 2 == 0 && values.size() / 2 <= 0xFF);
    byte(static_cast<std::uint8_t>(values.size() / 2));
  }
  void number(std::uint32_t value, LogicalWidth width) {
    for (std::size_t i = 0; i < bytes_of(width); ++i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  void pad_to_word() {
    if (form_ == PathForm::kPadded && (out_.size() - start_) % 2 != 0) byte(0);
  }

  Bytes& out_;
  PathForm form_;
  std::size_t start_;
};

// Classes, instances and attributes in the forms that requests have, read without a Segment: one byte for the type and
// one for the number, whether padded or packed; or padded with two for the number. The bytes taken; 0: something else.
std::size_t take_usual(ByteView path, PathForm form, LogicalSegment& segment) {
  constexpr unsigned kByte = 0x20, kPaddedWord = 0x21;
  if (path.size() < 2) return 0;
  segment.type = static_cast<LogicalType>(path[0] >> 2 & 7);
  if (segment.type != LogicalType::kClass && segment.type != LogicalType::kInstance &&
      segment.type != LogicalType::kAttribute)
    return 0;
  const unsigned kind_and_width = path[0] & 0xe3;
  if (kind_and_width == kByte) {
    segment.value = path[1];
    return 2;
  }
  if (kind_and_width != kPaddedWord || form != PathForm::kPadded || path.size() < 4 || path[1] != 0) return 0;
  segment.value = read_le16(path, 2);
  return 4;
}

// The same for whatever is a logical segment; empty for another one and for an error.
std::optional<LogicalSegment> take_logical(ByteView& path, PathForm form) {
  LogicalSegment usual;
  if (const std::size_t taken = take_usual(path, form, usual); taken != 0) {
    path = path.subspan(taken);
    return usual;
  }
  EpathReader reader(path, form);
  const auto segment = reader.next();
  const auto* const logical = segment ? std::get_if<LogicalSegment>(&*segment) : nullptr;
  if (logical == nullptr) return std::nullopt;
  path = path.subspan(reader.offset());
  return *logical;
}

}  // namespace

Result<Segment, PathError> EpathReader::next() {
  Cursor cursor(path_.subspan(at_), form_);
  const Segment segment = read_segment(cursor);
  if (cursor.fault()) return Unexpected(PathError{*cursor.fault(), at_});
  at_ += cursor.used();
  return segment;
}

void append_segment(Bytes& out, const Segment& segment, PathForm form) { std::visit(Writer(out, form), segment); }

void append_logical(Bytes& out, LogicalType type, std::uint32_t value, PathForm form) {
  const LogicalWidth width = value <= 0xFF ? LogicalWidth::k8 : value <= 0xFFFF ? LogicalWidth::k16 : LogicalWidth::k32;
  append_segment(out, LogicalSegment{type, width, value}, form);
}

Result<ObjectPath, GeneralStatus> parse_object_path(ByteView path, PathForm form) {
  constexpr auto kError = Unexpected(GeneralStatus::kPathSegmentError);
  enum class Seen : std::uint8_t { kNothing, kClass, kInstance, kAttribute, kMember };
  Seen seen = Seen::kNothing;
  ObjectPath object;
  while (!path.empty()) {
    const auto logical = take_logical(path, form);
    if (!logical) return kError;
    switch (logical->type) {
      case LogicalType::kClass:
        if (seen != Seen::kNothing) return kError;
        seen = Seen::kClass;
        object.class_id = static_cast<std::uint16_t>(logical->value);
        break;
      case LogicalType::kInstance:
      case LogicalType::kConnectionPoint:
        if (seen != Seen::kClass) return kError;
        seen = Seen::kInstance;
        object.instance = logical->value;
        break;
      case LogicalType::kAttribute:
        if (seen != Seen::kClass && seen != Seen::kInstance) return kError;
        seen = Seen::kAttribute;
        object.attribute = static_cast<std::uint16_t>(logical->value);
        break;
      case LogicalType::kMember:
        if (seen == Seen::kNothing || seen == Seen::kMember) return kError;
        seen = Seen::kMember;
        object.member = logical->value;
        break;
      default: return kError;
    }
  }
  if (seen == Seen::kNothing) return kError;
  return object;
}

void append_object_path(Bytes& out, const ObjectPath& path, PathForm form) {
  append_logical(out, LogicalType::kClass, path.class_id, form);
  append_logical(out, LogicalType::kInstance, path.instance, form);
  if (path.attribute) append_logical(out, LogicalType::kAttribute, *path.attribute, form);
  if (path.member) append_logical(out, LogicalType::kMember, *path.member, form);
}

}  // namespace vinv::cip
