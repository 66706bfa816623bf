#include "sim/transports/serial_recorder.hpp"

#include <utility>

#include "sim/transports/stream_handlers.hpp"

namespace vinv::transports {
namespace {

// Event types of the RTAC serial header, seen from our end. All its numbers are big endian.
constexpr std::uint8_t kDataTxStart = 1;
constexpr std::uint8_t kDataRxStart = 2;

class LineLog {
 public:
  LineLog(std::shared_ptr<CaptureFile> file, const std::string& name)
      : file_(std::move(file)), interface_id_(file_->add_interface(LinkType::kRtacSerial, name)) {}

  void bytes(Instant now, std::uint8_t event, ByteView bytes) {
    if (!pending_.empty() && (event != event_ || now - last_ > SerialRecorder::kFrameGap)) write_pending();
    if (pending_.empty()) {
      event_ = event;
      first_ = now;
    }
    last_ = now;
    pending_.insert(pending_.end(), bytes.begin(), bytes.end());
    if (pending_.size() >= ByteStream::kMaxQueuedBytes) write_pending();
  }

  void write_pending() {
    if (pending_.empty()) return;
    packet_.clear();
    const auto us = static_cast<std::uint64_t>(to_ns(first_) / 1000);
    append_be32(packet_, static_cast<std::uint32_t>(us / 1'000'000));
    append_be32(packet_, static_cast<std::uint32_t>(us % 1'000'000));
    packet_.push_back(event_);
    packet_.push_back(0);  // control lines: none
    append_be16(packet_, 0);
    packet_.insert(packet_.end(), pending_.begin(), pending_.end());
    file_->packet(interface_id_, first_, packet_,
                  event_ == kDataRxStart ? PacketDirection::kInbound : PacketDirection::kOutbound);
    pending_.clear();
  }

  StreamHandlers handlers;

 private:
  std::shared_ptr<CaptureFile> file_;
  std::uint32_t interface_id_;
  std::uint8_t event_ = kDataRxStart;
  Instant first_{};
  Instant last_{};
  Bytes pending_;
  Bytes packet_;
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
          log->bytes(now, kDataRxStart, bytes);
          log->handlers.bytes(now, bytes, line_error);
        },
        [log = log_](Instant now, const std::string& reason) {
          log->write_pending();
          log->handlers.closed(now, reason);
        });
  }
  void send(Instant now, ByteView bytes) override {
    log_->bytes(now, kDataTxStart, bytes);
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
