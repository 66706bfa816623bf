#include "sim/transports/serial_recorder.hpp"

#include <utility>

#include "sim/transports/serial_packets.hpp"
#include "sim/transports/stream_handlers.hpp"

namespace vinv::transports {
namespace {

class LineLog {
 public:
  LineLog(std::shared_ptr<CaptureFile> file, const std::string& name)
      : packets_(
            [file, id = file->add_interface(LinkType::kRtacSerial, name)](
                Instant at, ByteView packet, PacketDirection direction) { file->packet(id, at, packet, direction); }) {}

  void bytes(Instant now, PacketDirection direction, ByteView bytes) { packets_.bytes(now, direction, bytes); }
  void write_pending() { packets_.flush(); }

  StreamHandlers handlers;

 private:
  SerialPackets packets_;
};

class RecordedLine : public ByteStream {
 public:
  RecordedLine(std::unique_ptr<ByteStream> inner, std::shared_ptr<LineLog> log)
      : inner_(std::move(inner)), log_(std::move(log)) {}
  ~RecordedLine() override { close(); }
  RecordedLine(const RecordedLine&) = delete;
  RecordedLine& operator=(const RecordedLine&) = delete;

  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override {
    log_->handlers.set(std::move(on_bytes), std::move(on_closed));
    inner_->set_handlers(
        [log = log_](Instant now, ByteView bytes, bool line_error) {
          log->bytes(now, PacketDirection::kInbound, bytes);
          log->handlers.bytes(now, bytes, line_error);
        },
        [log = log_](Instant now, const std::string& reason) {
          log->write_pending();
          log->handlers.closed(now, reason);
        });
  }
  void send(Instant now, ByteView bytes) override {
    log_->bytes(now, PacketDirection::kOutbound, bytes);
    inner_->send(now, bytes);
  }
  void close() override {
    log_->write_pending();
    log_->handlers.clear();
    inner_->close();
  }
  std::string name() const override { return inner_->name(); }

 private:
  std::unique_ptr<ByteStream> inner_;
  std::shared_ptr<LineLog> log_;
};

}  // namespace

std::unique_ptr<ByteStream> SerialRecorder::wrap(std::unique_ptr<ByteStream> stream, const std::string& line_name) {
  return std::make_unique<RecordedLine>(std::move(stream), std::make_shared<LineLog>(file_, line_name));
}

}  // namespace vinv::transports
