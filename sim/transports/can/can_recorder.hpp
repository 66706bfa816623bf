// Records a bus: as a candump -l log, which can-utils (canplayer, log2asc), python-can and Wireshark read, and as
// pcapng with the link type of SocketCAN captures (`tshark -r FILE -d can.subdissector,canopen`). Either or both.
// Destroyed frames and changes of a node's state are recorded as Linux error frames.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "sim/base/result.hpp"
#include "sim/transports/can/can_bus.hpp"
#include "sim/transports/can/error_frame.hpp"
#include "sim/transports/capture_file.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {

// LINKTYPE_CAN_SOCKETCAN of the tcpdump.org registry.
inline constexpr LinkType kLinkTypeSocketCan{227};

// A frame as LINKTYPE_CAN_SOCKETCAN has it: identifier and flags big endian, length, three zero bytes, data.
Bytes socketcan_packet(const CanFrame& frame);
Bytes socketcan_packet(const CanErrorFrame& frame);
// A line of candump -l without its end: (0000000001.000400) can0 123#DEADBEEF
std::string candump_line(std::int64_t unix_us, std::string_view interface, const CanFrame& frame);
std::string candump_line(std::int64_t unix_us, std::string_view interface, const CanErrorFrame& frame);

// Complete after every line. Shared by the recorders of all buses of one run. A write that fails ends the log.
class CandumpLog {
 public:
  // Replaces an existing file; start_unix_ns: what simulated zero is, in nanoseconds since 1970.
  static Result<std::shared_ptr<CandumpLog>, std::string> create(const std::string& path,
                                                                 std::int64_t start_unix_ns = 0);
  void write(std::string line);
  std::int64_t unix_us(Instant now) const { return (start_unix_ns_ + to_ns(now)) / 1000; }
  std::uint64_t lines() const { return lines_; }
  // Why recording ended early; empty while it goes on.
  const std::string& error() const { return error_; }

 private:
  CandumpLog(std::string path, UniqueFd fd, std::int64_t start_unix_ns)
      : path_(std::move(path)), fd_(std::move(fd)), start_unix_ns_(start_unix_ns) {}
  std::string path_;
  UniqueFd fd_;
  std::int64_t start_unix_ns_;
  std::uint64_t lines_ = 0;
  std::string error_;
};

class CanRecorder : public CanBusObserver {
 public:
  // interface: the bus's name in the files; blanks in it become underscores. log or capture may be null.
  CanRecorder(std::string interface, std::shared_ptr<CandumpLog> log, std::shared_ptr<CaptureFile> capture);
  void on_frame(Instant now, const CanFrame& frame, std::string_view sender) override;
  void on_error_frame(Instant now, CanErrorCause cause, std::string_view sender) override;
  // An error frame, but not for a node that joins the bus in good health.
  void on_node_state(Instant now, std::string_view node, const CanStatus& status) override;

 private:
  void error_frame(Instant now, const CanErrorFrame& frame);
  std::string interface_;
  std::shared_ptr<CandumpLog> log_;
  std::shared_ptr<CaptureFile> capture_;
  std::uint32_t interface_id_ = 0;
  std::set<std::string, std::less<>> joined_;  // nodes on the bus
};

}  // namespace vinv::transports
