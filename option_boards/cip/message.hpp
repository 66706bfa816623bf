// Explicit requests and replies of the message router. CIP Vol 1, 2-4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "option_boards/cip/epath.hpp"
#include "option_boards/cip/status.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"

namespace vinv::cip {

enum class Service : std::uint8_t {
  kGetAttributesAll = 0x01,
  kSetAttributesAll = 0x02,
  kGetAttributeList = 0x03,
  kSetAttributeList = 0x04,
  kReset = 0x05,
  kStart = 0x06,
  kStop = 0x07,
  kMultipleServicePacket = 0x0A,
  kApplyAttributes = 0x0D,
  kGetAttributeSingle = 0x0E,
  kSetAttributeSingle = 0x10,
  kRestore = 0x15,
  kSave = 0x16,
  kNoOperation = 0x17,
  kGetMember = 0x18,
  kSetMember = 0x19,
};
inline constexpr std::uint8_t kReplyBit = 0x80;
constexpr std::uint8_t code_of(Service service) { return static_cast<std::uint8_t>(service); }

// Names a request whose answer comes later. Never 0.
using Ticket = std::uint32_t;

struct Request {
  std::uint8_t service = 0;  // without the reply bit
  ObjectPath path;
  ByteView data;  // valid during the call
  // Who asks, in the words of the network (session, socket, connection); objects that serve a network use it.
  std::uint64_t origin = 0;
  // Bytes of service data that the answer may have.
  std::size_t reply_limit = std::numeric_limits<std::size_t>::max();
  // Set by the message router: the name under which an object may answer later.
  Ticket ticket = 0;

  bool is(Service s) const { return service == code_of(s); }
};

// Keeps its memory when used again.
struct Reply {
  Status status;
  Bytes data;

  void clear() {
    status = {};
    data.clear();
  }
  // The answer is an error without data.
  void refuse(Status why) {
    status = why;
    data.clear();
  }
  VINV_ARCHIVE(Reply, status, data);
};

// Takes apart: service, path size in words, padded path, data. Refusals: kNotEnoughData (shorter than two bytes),
// kPathSizeInvalid (path longer than the message), kPathSegmentError, kServiceNotSupported (reply bit set); the service
// is known unless the message is empty.
struct ParsedRequest {
  std::uint8_t service = 0;
  Result<Request, GeneralStatus> request;
};
ParsedRequest parse_request(ByteView message);
void append_request(Bytes& out, const Request& request);

// service | 80h, 0, general status, number of extended words, these, data.
void append_reply(Bytes& out, std::uint8_t service, const Reply& reply);

struct ReplyView {
  std::uint8_t service = 0;  // without the reply bit
  Status status;
  ByteView data;
};
// Empty: too short, no reply bit, or more extended words than Status holds.
std::optional<ReplyView> parse_reply(ByteView message);

// DeviceNet, message body formats with class and instance in front and the attribute as the first byte of the data
// (Get and Set_Attribute_Single): the same request as by a path. kNotEnoughData if the attribute is missing.
Result<Request, GeneralStatus> request_without_path(std::uint8_t service, std::uint16_t class_id,
                                                    std::uint16_t instance, ByteView data);

}  // namespace vinv::cip
