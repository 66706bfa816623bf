// Writes pcapng blocks: bytes out, no files. draft-ietf-opsawg-pcapng-02, sections 4.1 (section header), 4.2 (interface
// description) and 4.3 (enhanced packet). Little endian, nanosecond time stamps. Multi-octet numbers inside packets
// are the caller's.
#pragma once

#include <cstdint>
#include <string_view>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::transports {

// LINKTYPE_ values of the tcpdump.org registry.
enum class LinkType : std::uint16_t { kEthernet = 1, kRtacSerial = 250 };
enum class PacketDirection : std::uint8_t { kUnknown = 0, kInbound = 1, kOutbound = 2 };

class PcapngEncoder {
 public:
  // start_unix_ns: what simulated zero is in the file, in nanoseconds since 1970. Zero keeps files reproducible.
  explicit PcapngEncoder(std::int64_t start_unix_ns = 0) : start_unix_ns_(start_unix_ns) {}

  // All append to out. The section header comes first, an interface before its packets.
  void begin_section(Bytes& out, std::string_view application) const;
  std::uint32_t add_interface(Bytes& out, LinkType type, std::string_view name);
  void packet(Bytes& out, std::uint32_t interface_id, Instant at, ByteView data,
              PacketDirection direction = PacketDirection::kUnknown) const;

 private:
  std::int64_t start_unix_ns_;
  std::uint32_t interfaces_ = 0;
};

}  // namespace vinv::transports
