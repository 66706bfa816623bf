// The text of the socketcand protocol: messages in angle brackets, words between blanks. As the linux-can/socketcand
// project's doc/protocol.md has it and as its server and python-can 4.1 write and read it:
//
//   server:  < frame 123 1700000000.123456 DEADBEEF >   < rtr 123 1700000000.123456 4 >   < error 004 1700000000.123456
//   > client:  < send 123 4 DE AD BE EF >                 < sendrtr 123 4 >
//
// Identifiers are hexadecimal, with 3 digits (standard) or 8 (extended). A frame without data leaves two blanks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

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

// The words of one message, up to one more than any of them has.
class SocketcandWords {
 public:
  static constexpr std::size_t kMax = 12;

  void push_back(std::string_view word) {
    if (count_ < kMax) words_[count_++] = word;
  }
  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  std::string_view operator[](std::size_t i) const { return words_[i]; }
  operator std::span<const std::string_view>() const { return {words_.data(), count_}; }

 private:
  std::array<std::string_view, kMax> words_;
  std::size_t count_ = 0;
};
SocketcandWords socketcand_words(std::string_view inside);

// From a client: the words of send or sendrtr. An identifier is extended if it has 8 digits or does not fit 11 bits
// (python-can writes it without leading zeros).
Result<CanFrame, std::string> parse_socketcand_send(std::span<const std::string_view> words);
void append_socketcand_send(std::string& out, const CanFrame& frame);
inline std::string socketcand_send(const CanFrame& frame) {
  std::string out;
  append_socketcand_send(out, frame);
  return out;
}

struct SocketcandReceived {
  CanFrame frame;
  std::int64_t unix_us = 0;
};
// From a server: the words of frame or rtr. Data may be in one word or in one for each byte.
Result<SocketcandReceived, std::string> parse_socketcand_received(std::span<const std::string_view> words);
void append_socketcand_received(std::string& out, const CanFrame& frame, std::int64_t unix_us);
inline std::string socketcand_received(const CanFrame& frame, std::int64_t unix_us) {
  std::string out;
  append_socketcand_received(out, frame, unix_us);
  return out;
}

// error_class: the CAN_ERR_ bits of linux/can/error.h.
std::string socketcand_error(std::uint32_t error_class, std::int64_t unix_us);

}  // namespace vinv::transports
