#include "sim/transports/pcapng.hpp"

namespace vinv::transports {
namespace {

constexpr std::uint32_t kSectionHeader = 0x0a0d0d0a;
constexpr std::uint32_t kByteOrderMagic = 0x1a2b3c4d;
constexpr std::uint32_t kInterfaceDescription = 1;
constexpr std::uint32_t kEnhancedPacket = 6;
constexpr std::uint16_t kOptionEnd = 0;
constexpr std::uint16_t kShbUserAppl = 4;
constexpr std::uint16_t kIfName = 2;
constexpr std::uint16_t kIfTsResol = 9;
constexpr std::uint16_t kEpbFlags = 2;
constexpr std::uint32_t kSnapLength = 262144;

void pad(Bytes& out, std::size_t start) {
  while ((out.size() - start) % 4 != 0) out.push_back(0);
}

void append(Bytes& out, ByteView bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); }

void option(Bytes& out, std::uint16_t code, ByteView value) {
  append_le16(out, code);
  append_le16(out, static_cast<std::uint16_t>(value.size()));
  const std::size_t start = out.size();
  append(out, value);
  pad(out, start);
}

ByteView view(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

// A block repeats its total length at the end; it is known only then.
class Block {
 public:
  Block(Bytes& out, std::uint32_t type) : out_(out), start_(out.size()) {
    append_le32(out_, type);
    append_le32(out_, 0);
  }
  ~Block() {
    const auto length = static_cast<std::uint32_t>(out_.size() - start_ + 4);
    append_le32(out_, length);
    for (std::size_t i = 0; i < 4; ++i) out_[start_ + 4 + i] = static_cast<std::uint8_t>(length >> (8 * i));
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

 private:
  Bytes& out_;
  std::size_t start_;
};

}  // namespace

void PcapngEncoder::begin_section(Bytes& out, std::string_view application) const {
  const Block block(out, kSectionHeader);
  append_le32(out, kByteOrderMagic);
  append_le16(out, 1);  // version 1.0
  append_le16(out, 0);
  append_le32(out, 0xffffffff);  // section length not given
  append_le32(out, 0xffffffff);
  option(out, kShbUserAppl, view(application));
  option(out, kOptionEnd, {});
}

std::uint32_t PcapngEncoder::add_interface(Bytes& out, LinkType type, std::string_view name) {
  const Block block(out, kInterfaceDescription);
  append_le16(out, static_cast<std::uint16_t>(type));
  append_le16(out, 0);
  append_le32(out, kSnapLength);
  option(out, kIfName, view(name));
  const std::uint8_t nanoseconds = 9;
  option(out, kIfTsResol, {&nanoseconds, 1});
  option(out, kOptionEnd, {});
  return interfaces_++;
}

void PcapngEncoder::packet(Bytes& out, std::uint32_t interface_id, Instant at, ByteView data,
                           PacketDirection direction) const {
  const auto stamp = static_cast<std::uint64_t>(start_unix_ns_ + to_ns(at));
  const Block block(out, kEnhancedPacket);
  append_le32(out, interface_id);
  append_le32(out, static_cast<std::uint32_t>(stamp >> 32));
  append_le32(out, static_cast<std::uint32_t>(stamp));
  append_le32(out, static_cast<std::uint32_t>(data.size()));
  append_le32(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = out.size();
  append(out, data);
  pad(out, start);
  if (direction == PacketDirection::kUnknown) return;
  const std::uint8_t flags[] = {static_cast<std::uint8_t>(direction), 0, 0, 0};
  option(out, kEpbFlags, flags);
  option(out, kOptionEnd, {});
}

}  // namespace vinv::transports
