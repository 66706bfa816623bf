// Records serial lines into a capture file, each as an interface of link type RTAC serial (250), which carries
// direction and time. tshark 4.0 reads Modbus RTU in it with `tshark -r FILE -d rtacser.data,mbrtu`.
//
// The last packet of a line (serial_packets.hpp) is written when something else happens on it, or when the stream ends.
#pragma once

#include <memory>
#include <string>

#include "sim/transports/byte_stream.hpp"
#include "sim/transports/capture_file.hpp"

namespace vinv::transports {

class SerialRecorder {
 public:
  explicit SerialRecorder(std::shared_ptr<CaptureFile> file) : file_(std::move(file)) {}
  // line_name names the interface in the file. The wrapped stream may outlive the recorder.
  std::unique_ptr<ByteStream> wrap(std::unique_ptr<ByteStream> stream, const std::string& line_name);

 private:
  std::shared_ptr<CaptureFile> file_;
};

}  // namespace vinv::transports
