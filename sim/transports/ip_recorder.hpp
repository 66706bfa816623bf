// Records TCP streams and UDP ports into a capture file, as the frames that tshark or Wireshark would have seen on a
// wire
// (`tshark -r FILE -o mbtcp.tcp.port:1502`: by that port it also tells queries from answers). Any number of streams
// share one recorder.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/capture_file.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::transports {

class IpRecorder {
 public:
  static Result<std::unique_ptr<IpRecorder>, std::string> open(const std::string& path, std::int64_t start_unix_ns = 0);
  // Into a file that other recorders use too.
  explicit IpRecorder(std::shared_ptr<CaptureFile> file);

  // An accepted connection: the stream's name is the client's address, host and port are ours. A stream whose name is
  // no address (a memory link) gets one of TEST-NET-1. The wrapped stream may outlive the recorder. dscp: of what we
  // send.
  std::unique_ptr<ByteStream> wrap(Instant now, std::unique_ptr<ByteStream> stream, const std::string& host,
                                   std::uint16_t port, std::uint8_t dscp = 0);

  // A port of ours: what it sends and receives. The wrapped port may outlive the recorder.
  std::unique_ptr<UdpPort> wrap(std::unique_ptr<UdpPort> port);

  // One that came in by no port that is wrapped: a broadcast.
  void received(Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes);

  const CaptureFile& file() const { return *file_; }

 private:
  std::shared_ptr<CaptureFile> file_;
  std::uint32_t interface_id_;
  std::uint32_t connections_ = 0;
  std::uint16_t ip_id_ = 0;  // of received()
  Bytes frame_;
};

}  // namespace vinv::transports
