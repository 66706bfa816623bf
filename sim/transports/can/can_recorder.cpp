#include "sim/transports/can/can_recorder.hpp"

#include <fcntl.h>

#include <cerrno>
#include <utility>

#include "sim/transports/can/number_text.hpp"
#include "sim/transports/io_error.hpp"

namespace vinv::transports {
namespace {

// linux/can.h
constexpr std::uint32_t kExtendedFlag = 0x80000000;
constexpr std::uint32_t kRemoteFlag = 0x40000000;

constexpr std::size_t kLineBytes = 64;  // more than a line has besides the interface

Bytes packet(std::uint32_t id, std::uint8_t length, ByteView data) {
  Bytes out;
  append_be32(out, id);
  out.push_back(length);
  out.insert(out.end(), 3, 0);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

std::string line_head(std::int64_t unix_us, std::string_view interface) {
  std::string out = "(";
  out.reserve(kLineBytes + interface.size());
  append_stamp(out, unix_us, 10);
  out += ") ";
  out += interface;
  out += ' ';
  return out;
}

void append_data(std::string& line, ByteView data) {
  for (const std::uint8_t byte : data) append_hex(line, byte, 2);
}

}  // namespace

Bytes socketcan_packet(const CanFrame& frame) {
  const std::uint32_t flags = (frame.extended ? kExtendedFlag : 0) | (frame.remote ? kRemoteFlag : 0);
  return packet(frame.id | flags, frame.length, frame.bytes());
}

Bytes socketcan_packet(const CanErrorFrame& frame) {
  return packet(frame.error_class | CanErrorFrame::kFlag, 8, frame.data);
}

std::string candump_line(std::int64_t unix_us, std::string_view interface, const CanFrame& frame) {
  std::string line = line_head(unix_us, interface);
  append_hex(line, frame.id, frame.extended ? 8 : 3);
  line += '#';
  if (frame.remote) {
    line += 'R';
    if (frame.length > 0) append_hex(line, frame.length, 1);
  }
  append_data(line, frame.bytes());
  return line;
}

std::string candump_line(std::int64_t unix_us, std::string_view interface, const CanErrorFrame& frame) {
  std::string line = line_head(unix_us, interface);
  append_hex(line, frame.error_class | CanErrorFrame::kFlag, 8);
  line += '#';
  append_data(line, frame.data);
  return line;
}

Result<std::shared_ptr<CandumpLog>, std::string> CandumpLog::create(const std::string& path,
                                                                    std::int64_t start_unix_ns) {
  UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  if (!fd.is_open()) return Unexpected("cannot record to " + path + ": " + describe_errno(errno));
  return std::shared_ptr<CandumpLog>(new CandumpLog(path, std::move(fd), start_unix_ns));
}

void CandumpLog::write(std::string line) {
  line += '\n';
  std::size_t done = 0;
  while (error_.empty() && done < line.size()) {
    const ssize_t n = ::write(fd_.get(), line.data() + done, line.size() - done);
    if (n > 0)
      done += static_cast<std::size_t>(n);
    else if (n == 0 || errno != EINTR) {
      error_ = "recording to " + path_ + " ended: " + describe_errno(n == 0 ? ENOSPC : errno);
    }
  }
  if (error_.empty()) ++lines_;
}

CanRecorder::CanRecorder(std::string interface, std::shared_ptr<CandumpLog> log, std::shared_ptr<CaptureFile> capture)
    : interface_(std::move(interface)), log_(std::move(log)), capture_(std::move(capture)) {
  if (interface_.empty()) interface_ = "can0";
  for (char& c : interface_) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  if (capture_) interface_id_ = capture_->add_interface(kLinkTypeSocketCan, interface_);
}

void CanRecorder::on_frame(Instant now, const CanFrame& frame, std::string_view) {
  if (log_) log_->write(candump_line(log_->unix_us(now), interface_, frame));
  if (capture_) capture_->packet(interface_id_, now, socketcan_packet(frame));
}

void CanRecorder::on_error_frame(Instant now, CanErrorCause cause, std::string_view) {
  error_frame(now, error_frame_of(cause));
}

void CanRecorder::on_node_state(Instant now, std::string_view node, const CanStatus& status) {
  if (status.state == CanState::kOffline) {
    joined_.erase(std::string(node));
    return;
  }
  const bool joins = joined_.emplace(node).second;
  if (!joins || status.state != CanState::kErrorActive) error_frame(now, error_frame_of(status));
}

void CanRecorder::error_frame(Instant now, const CanErrorFrame& frame) {
  if (log_) log_->write(candump_line(log_->unix_us(now), interface_, frame));
  if (capture_) capture_->packet(interface_id_, now, socketcan_packet(frame));
}

}  // namespace vinv::transports
