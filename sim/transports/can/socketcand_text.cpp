#include "sim/transports/can/socketcand_text.hpp"

#include <algorithm>
#include <utility>

#include "sim/transports/can/number_text.hpp"
#include "sim/transports/can/wire_format.hpp"

namespace vinv::transports {
namespace {

void append_id(std::string& out, const CanFrame& frame) { append_hex(out, frame.id, frame.extended ? 8 : 3); }

Result<CanFrame, std::string> parse_id(std::string_view word) {
  const auto id = parse_hex(word);
  if (!id || *id > 0x1fffffff) return Unexpected(std::string("bad identifier"));
  CanFrame frame;
  frame.id = *id;
  frame.extended = word.size() == 8 || *id > 0x7ff;
  return frame;
}

// Decimal, 0 to 8.
bool parse_length(std::string_view word, std::uint8_t& length) {
  if (word.size() != 1 || word[0] < '0' || word[0] > '8') return false;
  length = static_cast<std::uint8_t>(word[0] - '0');
  return true;
}

// SECONDS.MICROSECONDS, with six digits at most behind the point.
bool parse_stamp(std::string_view word, std::int64_t& unix_us) {
  const std::size_t point = word.find('.');
  if (point == 0 || point == std::string_view::npos || point > 12 || word.size() - point > 7) return false;
  std::int64_t value = 0;
  for (std::size_t i = 0; i < point + 7; ++i) {
    if (i == point) continue;
    const char c = i < word.size() ? word[i] : '0';
    if (c < '0' || c > '9') return false;
    value = value * 10 + (c - '0');
  }
  unix_us = value;
  return true;
}

}  // namespace

void SocketcandMessages::feed(ByteView bytes, const OnMessage& on_message) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::size_t begin = 0;  // of the piece of a message that began here or in an earlier call
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '<') {
      inside_ = true;
      message_.clear();
      begin = i + 1;
    } else if (!inside_) {
      continue;
    } else if (c == '>') {
      inside_ = false;
      const std::string_view piece = text.substr(begin, i - begin);
      if (message_.empty()) {
        on_message(piece);
      } else {
        message_ += piece;
        const std::string whole = std::exchange(message_, {});  // the handler may end us
        on_message(whole);
      }
    } else if (message_.size() + (i - begin) == kMaxMessageBytes) {
      inside_ = false;
      message_.clear();
      ++overlong_;
    }
  }
  if (inside_) message_ += text.substr(begin);
}

SocketcandWords socketcand_words(std::string_view inside) {
  SocketcandWords words;
  constexpr std::string_view kBlanks = " \t\r\n";
  for (std::size_t at = inside.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(inside.find_first_of(kBlanks, at), inside.size());
    words.push_back(inside.substr(at, end - at));
    at = inside.find_first_not_of(kBlanks, end);
  }
  return words;
}

Result<CanFrame, std::string> parse_socketcand_send(std::span<const std::string_view> words) {
  if (words.size() < 3) return Unexpected(std::string("identifier and length expected"));
  auto frame = parse_id(words[1]);
  if (!frame) return frame;
  if (!parse_length(words[2], frame->length)) return Unexpected(std::string("bad length"));
  frame->remote = words[0] == "sendrtr";
  if (words.size() - 3 != frame->bytes().size()) return Unexpected(std::string("length and data differ"));
  for (std::size_t i = 3; i < words.size(); ++i) {
    const auto byte = parse_hex(words[i]);
    if (!byte || words[i].size() > 2) return Unexpected(std::string("bad data"));
    frame->data[i - 3] = static_cast<std::uint8_t>(*byte);
  }
  return frame;
}

void append_socketcand_send(std::string& out, const CanFrame& frame) {
  out += frame.remote ? "< sendrtr " : "< send ";
  append_id(out, frame);
  out += ' ';
  append_hex(out, frame.length, 1);
  for (const std::uint8_t byte : frame.bytes()) {
    out += ' ';
    append_hex(out, byte, 2);
  }
  out += " >";
}

Result<SocketcandReceived, std::string> parse_socketcand_received(std::span<const std::string_view> words) {
  if (words.size() < 3) return Unexpected(std::string("identifier and time expected"));
  const auto head = parse_id(words[1]);
  if (!head) return Unexpected(head.error());
  SocketcandReceived out;
  out.frame = *head;
  if (!parse_stamp(words[2], out.unix_us)) return Unexpected(std::string("bad time"));
  if (words[0] == "rtr") {
    out.frame.remote = true;
    if (words.size() > 4 || (words.size() == 4 && !parse_length(words[3], out.frame.length))) {
      return Unexpected(std::string("bad length"));
    }
    return out;
  }
  for (const std::string_view digits : words.subspan(3)) {
    if (digits.size() % 2 != 0 || digits.size() > 2u * (8u - out.frame.length))
      return Unexpected(std::string("bad data"));
    for (std::size_t i = 0; i < digits.size(); i += 2) {
      const auto byte = parse_hex(digits.substr(i, 2));
      if (!byte) return Unexpected(std::string("bad data"));
      out.frame.data[out.frame.length++] = static_cast<std::uint8_t>(*byte);
    }
  }
  return out;
}

void append_socketcand_received(std::string& out, const CanFrame& frame, std::int64_t unix_us) {
  out += frame.remote ? "< rtr " : "< frame ";
  append_id(out, frame);
  out += ' ';
  append_stamp(out, unix_us);
  out += ' ';
  if (frame.remote) append_hex(out, frame.length, 1);
  for (const std::uint8_t byte : frame.bytes()) append_hex(out, byte, 2);
  out += " >";
}

std::string socketcand_error(std::uint32_t error_class, std::int64_t unix_us) {
  std::string out = "< error ";
  append_hex(out, error_class, error_class > 0xfff ? 8 : 3);
  out += ' ';
  append_stamp(out, unix_us);
  return out + " >";
}

}  // namespace vinv::transports
