#include "sim/transports/ip_recorder.hpp"

#include <algorithm>
#include <utility>

#include "sim/transports/stream_handlers.hpp"
#include "sim/transports/tcp_conversation.hpp"
#include "sim/transports/udp_frame.hpp"

namespace vinv::transports {
namespace {

// The stand-in for an address that cannot be known.
IpEndpoint test_net(std::uint32_t number, std::uint16_t port) {
  IpEndpoint end;
  end.address = {192, 0, 2, static_cast<std::uint8_t>(1 + number % 254)};
  end.port = port;
  return end;
}

class RecordedTcp : public ByteStream {
 public:
  RecordedTcp(Instant now, std::unique_ptr<ByteStream> inner, std::shared_ptr<CaptureFile> file,
              std::uint32_t interface_id, IpEndpoint client, IpEndpoint server, std::uint32_t number, std::uint8_t dscp)
      : inner_(std::move(inner)),
        state_(std::make_shared<State>(std::move(file), interface_id, client, server, number, dscp)) {
    state_->last = now;
    state_->conversation.open();
  }
  ~RecordedTcp() override { close(); }
  RecordedTcp(const RecordedTcp&) = delete;
  RecordedTcp& operator=(const RecordedTcp&) = delete;

  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override {
    state_->handlers.set(std::move(on_bytes), std::move(on_closed));
    inner_->set_handlers(
        [state = state_](Instant now, ByteView bytes, bool line_error) {
          state->data(now, TcpSide::kClient, bytes);
          state->handlers.bytes(now, bytes, line_error);
        },
        [state = state_](Instant now, const std::string& reason) {
          state->end(now, TcpSide::kClient);
          state->handlers.closed(now, reason);
        });
  }
  void send(Instant now, ByteView bytes) override {
    state_->data(now, TcpSide::kServer, bytes);
    inner_->send(now, bytes);
  }
  void close() override {
    state_->handlers.clear();
    state_->end(state_->last, TcpSide::kServer);
    inner_->close();
  }
  std::string name() const override { return inner_->name(); }

 private:
  struct State {
    State(std::shared_ptr<CaptureFile> f, std::uint32_t interface_id, IpEndpoint client, IpEndpoint server,
          std::uint32_t number, std::uint8_t dscp)
        : file(std::move(f)),
          conversation(
              client, server, number,
              [this, interface_id](TcpSide from, ByteView frame) {
                file->packet(interface_id, last, frame,
                             from == TcpSide::kClient ? PacketDirection::kInbound : PacketDirection::kOutbound);
              },
              dscp) {}

    void data(Instant now, TcpSide from, ByteView bytes) {
      if (ended) return;
      last = std::max(last, now);
      conversation.data(from, bytes);
    }
    void end(Instant now, TcpSide first) {
      if (std::exchange(ended, true)) return;
      last = std::max(last, now);
      conversation.close(first);
    }

    std::shared_ptr<CaptureFile> file;
    StreamHandlers handlers;
    Instant last{};  // the latest time seen: close() is not told the time
    bool ended = false;
    TcpConversation conversation;
  };

  std::unique_ptr<ByteStream> inner_;
  std::shared_ptr<State> state_;
};

class RecordedUdp : public UdpPort {
 public:
  RecordedUdp(std::unique_ptr<UdpPort> inner, std::shared_ptr<CaptureFile> file, std::uint32_t interface_id)
      : inner_(std::move(inner)), file_(std::move(file)), interface_id_(interface_id) {}

  void set_handler(OnDatagram on_datagram) override {
    inner_->set_handler(
        [this, handler = std::move(on_datagram)](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
          write(now, from, inner_->local(), bytes, 0, PacketDirection::kInbound);
          handler(now, from, bytes);
        });
  }
  void send(Instant now, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp) override {
    write(now, inner_->local(), to, bytes, dscp, PacketDirection::kOutbound);
    inner_->send(now, to, bytes, dscp);
  }
  Result<void, std::string> join(std::uint32_t group) override { return inner_->join(group); }
  void leave(std::uint32_t group) override { inner_->leave(group); }
  Ipv4Endpoint local() const override { return inner_->local(); }

 private:
  void write(Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp,
             PacketDirection direction) {
    make_udp_frame(frame_, from, to, bytes, {ip_id_++, dscp});
    file_->packet(interface_id_, now, frame_, direction);
  }

  std::unique_ptr<UdpPort> inner_;
  std::shared_ptr<CaptureFile> file_;
  std::uint32_t interface_id_;
  std::uint16_t ip_id_ = 0;
  Bytes frame_;
};

}  // namespace

std::unique_ptr<UdpPort> IpRecorder::wrap(std::unique_ptr<UdpPort> port) {
  return std::make_unique<RecordedUdp>(std::move(port), file_, interface_id_);
}

void IpRecorder::received(Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes) {
  make_udp_frame(frame_, from, to, bytes, {ip_id_++, 0});
  file_->packet(interface_id_, now, frame_, PacketDirection::kInbound);
}

Result<std::unique_ptr<IpRecorder>, std::string> IpRecorder::open(const std::string& path, std::int64_t start_unix_ns) {
  auto file = CaptureFile::create(path, start_unix_ns);
  if (!file) return Unexpected(file.error());
  return std::make_unique<IpRecorder>(*file);
}

IpRecorder::IpRecorder(std::shared_ptr<CaptureFile> file)
    : file_(std::move(file)), interface_id_(file_->add_interface(LinkType::kEthernet, "tcp")) {}

std::unique_ptr<ByteStream> IpRecorder::wrap(Instant now, std::unique_ptr<ByteStream> stream, const std::string& host,
                                             std::uint16_t port, std::uint8_t dscp) {
  const std::uint32_t number = connections_++;
  const bool is_v6 = host.find(':') != std::string::npos;
  const std::string ours = (is_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
  const IpEndpoint server = parse_ip_endpoint(ours).value_or(test_net(253, port));
  const IpEndpoint client = parse_ip_endpoint(stream->name())
                                .value_or(test_net(number % 253, static_cast<std::uint16_t>(49152 + number % 16384)));
  return std::make_unique<RecordedTcp>(now, std::move(stream), file_, interface_id_, client, server, number, dscp);
}

}  // namespace vinv::transports
