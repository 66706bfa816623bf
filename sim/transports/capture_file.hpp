// A pcapng file that is complete after every packet, so that a crash or a reader in between finds whole blocks. A write
// that fails (disk full) ends the recording, never the simulation.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "sim/base/result.hpp"
#include "sim/transports/pcapng.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {

class CaptureFile {
 public:
  // Replaces an existing file. Shared by all recorders of one run; start_unix_ns as in PcapngEncoder.
  static Result<std::shared_ptr<CaptureFile>, std::string> create(const std::string& path,
                                                                  std::int64_t start_unix_ns = 0);
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  std::uint32_t add_interface(LinkType type, std::string_view name);
  void packet(std::uint32_t interface_id, Instant at, ByteView data,
              PacketDirection direction = PacketDirection::kUnknown);

  const std::string& path() const { return path_; }
  std::uint64_t packets() const { return packets_; }
  // Why recording ended early; empty while it goes on.
  const std::string& error() const { return error_; }

 private:
  CaptureFile(std::string path, UniqueFd fd, std::int64_t start_unix_ns)
      : path_(std::move(path)), fd_(std::move(fd)), encoder_(start_unix_ns) {}
  void write_out();

  std::string path_;
  UniqueFd fd_;
  PcapngEncoder encoder_;
  Bytes block_;
  std::uint64_t packets_ = 0;
  std::string error_;
};

}  // namespace vinv::transports
