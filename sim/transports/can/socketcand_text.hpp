// The text of the socketcand protocol: messages in angle brackets, words between blanks. As the linux-can/socketcand
// project's doc/protocol.md has it and as its server and python-can 4.1 write and read it:
//
//   server:  < frame 123 1700000000.123456 DEADBEEF >   < rtr 123 1700000000.123456 4 >   < error 004 1700000000.123456
//   > client:  < send 123 4 DE AD BE EF >                 < sendrtr 123 4 >
//
// Identifiers are hexadecimal, with 3 digits (standard) or 8 (extended). A frame without data leaves two blanks.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/base/can_frame.hpp"
#include "sim/base/result.hpp"

namespace vinv::transports {

// Finds messages in a stream that may cut them anywhere. What lies between messages is skipped.
class SocketcandMessages {
 public:
  static constexpr std::size_t kMaxMessageBytes = 256;

  using OnMessage = std::function<void(std::string_view inside)>;
  // Without the brackets. A message beyond the limit is given up and counted; what follows is found again.
  void feed(ByteView bytes, const OnMessage& on_message);
  std::uint64_t overlong() const { return overlong_; }

 private:
  std::string message_;
  bool inside_ = false;
  std::uint64_t overlong_ = 0;
};

using SocketcandWords = std::vector<std::string_view>;
SocketcandWords socketcand_words(std::string_view inside);

// From a client: the words of send or sendrtr. An identifier is extended if it has 8 digits or does not fit 11 bits
// (python-can writes it without leading zeros).
Result<CanFrame, std::string> parse_socketcand_send(std::span<const std::string_view> words);
std::string socketcand_send(const CanFrame& frame);

struct SocketcandReceived {
  CanFrame frame;
  std::int64_t unix_us = 0;
};
// From a server: the words of frame or rtr. Data may be in one word or in one for each byte.
Result<SocketcandReceived, std::string> parse_socketcand_received(std::span<const std::string_view> words);
std::string socketcand_received(const CanFrame& frame, std::int64_t unix_us);

// error_class: the CAN_ERR_ bits of linux/can/error.h.
std::string socketcand_error(std::uint32_t error_class, std::int64_t unix_us);

}  // namespace vinv::transports
