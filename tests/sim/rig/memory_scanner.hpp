// A scanner in virtual time, on the Ethernet in memory of a plant: one TCP connection and a UDP port for I/O.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "sim/rig/plant.hpp"
#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::rig::test {

using vinv::test::encapsulated;
using vinv::test::from_hex;
using vinv::test::item;
using vinv::test::join;
using vinv::test::le16;
using vinv::test::le32;

class MemoryScanner {
 public:
  MemoryScanner(Plant& plant, std::uint32_t target, std::uint32_t own = ipv4(192, 168, 1, 1))
      : plant_(plant), target_(target), own_(own) {
    io_ = std::move(*plant.datagrams().open({own, 2222}));
    io_->set_handler([this](Instant now, const Ipv4Endpoint& from, ByteView bytes) { on_packet(now, from, bytes); });
  }

  // False: nobody listens there, or the session is refused.
  bool connect() {
    stream_ = plant_.connect_tcp(plant_.now(), {own_, 50'000}, {target_, 44818});
    if (stream_ == nullptr) return false;
    closed = false;
    stream_->set_handlers([this](Instant, ByteView b, bool) { answers_.insert(answers_.end(), b.begin(), b.end()); },
                          [this](Instant, const std::string&) { closed = true; });
    const Bytes answer = say(encapsulated(0x65, 0, from_hex("01 00 00 00")));
    session_ = answer.size() >= 8 ? read_le32(answer, 4) : 0;
    return session_ != 0;
  }
  // What the adapter answers within so long.
  Bytes say(const Bytes& message, Duration patience = std::chrono::milliseconds(20)) {
    answers_.clear();
    stream_->send(plant_.now(), message);
    const Instant until = plant_.now() + patience;
    while (answers_.empty() && plant_.now() < until)
      plant_.scheduler().run_until(plant_.now() + std::chrono::microseconds(500));
    return answers_;
  }
  // A message router reply; empty: none came.
  Bytes ask(const std::string& message, Duration patience = std::chrono::milliseconds(20)) {
    const Bytes answer =
        say(encapsulated(0x6f, session_,
                         join({from_hex("00 00 00 00 05 00 02 00 00 00 00 00"), item(0xb2, from_hex(message))})),
            patience);
    return answer.size() < 40 ? Bytes{} : Bytes(answer.begin() + 40, answer.end());
  }
  // Get_Attribute_Single; the data as hex, or the status.
  std::string get(unsigned class_id, unsigned instance, unsigned attribute) {
    char path[64];
    std::snprintf(path, sizeof path, "0E 03 20 %02X 24 %02X 30 %02X", class_id, instance, attribute);
    return shown(ask(path));
  }
  static std::string shown(const Bytes& reply) {
    if (reply.size() < 4) return "nothing";
    char status[8];
    std::snprintf(status, sizeof status, "!%02X", reply[2]);
    return reply[2] != 0 ? status : vinv::test::to_hex(Bytes(reply.begin() + 4, reply.end()));
  }
  // Exclusive owner 21/71 at 10 ms each way.
  bool own() {
    const Bytes reply =
        ask("54 02 20 06 24 01 0A 0E 00 00 00 00 44 33 22 11 01 00 37 13 2A 00 00 00 00 00 00 00 10 27 00 00 0A 48 "
            "10 27 00 00 06 48 01 03 20 04 2C 15 2C 47");
    if (reply.size() < 12 || reply[2] != 0) return false;
    o2t_id = read_le32(reply, 4);
    sequence_ = 0;
    return true;
  }
  void run_to(Instant at) { plant_.scheduler().run_until(at); }
  void run_for(Duration time) { plant_.scheduler().run_until(plant_.now() + time); }

  // Each packet of the adapter is answered with this data; its first byte is the control word of instance 21.
  Bytes output{0, 0, 0, 0};
  bool silent = false;
  bool closed = false;
  std::uint32_t o2t_id = 0;
  std::uint64_t packets = 0;
  Bytes input;        // of the last packet, behind its sequence count
  std::string heard;  // time and bytes of each packet

  // As a part of a snapshot, after the plant's own.
  void archive_state(Archive& a) {
    a.io(o2t_id);
    a.io(sequence_);
    a.io(session_);
    a.io(output);
    plant_.streams().archive_end(a, stream_);
    if (a.loads() && !a.failed())
      stream_->set_handlers([this](Instant, ByteView b, bool) { answers_.insert(answers_.end(), b.begin(), b.end()); },
                            [this](Instant, const std::string&) { closed = true; });
  }

 private:
  void on_packet(Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    ++packets;
    input.assign(bytes.begin() + kPacketHeader, bytes.end());
    heard += std::to_string(to_ns(now)) + " " + vinv::test::to_hex(Bytes(bytes.begin(), bytes.end())) + "\n";
    if (silent) return;
    ++sequence_;
    io_->send(now, {from.address, 2222},
              join({le16(2), item(0x8002, join({le32(o2t_id), le32(sequence_)})),
                    item(0xb1, join({le16(sequence_ & 0xffff), le32(1), output}))}));
  }

  static constexpr std::ptrdiff_t kPacketHeader = 20;  // item count, sequenced address, data item, sequence count

  Plant& plant_;
  std::uint32_t target_, own_;
  std::unique_ptr<transports::UdpPort> io_;
  std::unique_ptr<transports::ByteStream> stream_;
  Bytes answers_;
  std::uint32_t session_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace vinv::rig::test
