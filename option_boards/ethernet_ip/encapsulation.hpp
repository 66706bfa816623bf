// The encapsulation header of EtherNet/IP. CIP Vol 2, 2-3 (message format), 2-4 (commands). Little-endian, 24 bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"

namespace vinv::ethernet_ip {

inline constexpr std::uint16_t kEncapsulationPort = 44818;  // 0xAF12, TCP and UDP
inline constexpr std::uint16_t kIoPort = 2222;              // 0x08AE, UDP

// Differentiated services code point of all that goes over port 44818 (Vol 2, 5-6.4.2: explicit messages).
inline constexpr std::uint8_t kExplicitDscp = 27;

inline constexpr std::size_t kEncapsulationHeader = 24;
// Data of one message that is taken; a longer one is refused with kInvalidLength and its bytes are skipped. A
// Large_Forward_Open's messages of 4000 bytes fit.
inline constexpr std::size_t kMaxEncapsulatedData = 4096;
inline constexpr std::uint16_t kProtocolVersion = 1;

enum class Command : std::uint16_t {
  kNop = 0x0000,
  kListServices = 0x0004,
  kListIdentity = 0x0063,
  kListInterfaces = 0x0064,
  kRegisterSession = 0x0065,
  kUnRegisterSession = 0x0066,
  kSendRRData = 0x006f,
  kSendUnitData = 0x0070,
};

// Vol 2, table 2-3.3.
enum class EncapsulationStatus : std::uint32_t {
  kSuccess = 0x00,
  kInvalidCommand = 0x01,
  kInsufficientMemory = 0x02,
  kIncorrectData = 0x03,
  kInvalidSession = 0x64,
  kInvalidLength = 0x65,
  kUnsupportedRevision = 0x69,
};

using SenderContext = std::array<std::uint8_t, 8>;

struct EncapsulationHeader {
  std::uint16_t command = 0;  // raw: unknown ones are answered, too
  std::uint16_t length = 0;   // of the data that follows
  std::uint32_t session = 0;
  std::uint32_t status = 0;
  SenderContext context{};  // returned as it came
  std::uint32_t options = 0;
};

// The first 24 bytes; empty if there are fewer.
std::optional<EncapsulationHeader> parse_header(ByteView bytes);
void append_header(Bytes& out, const EncapsulationHeader& header);

}  // namespace vinv::ethernet_ip
