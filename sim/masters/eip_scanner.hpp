// An EtherNet/IP scanner of one adapter: session, explicit messages (unconnected, and over a class 3 connection), one
// class 1 I/O connection. CIP Vol 2, 2-3 to 2-5 (encapsulation), 3-4 (class 1); Vol 1, 3-4 and 3-5 (connections).
//
// Explicit requests go one at a time, in their order (FR-A7NE manual, 6.3). An I/O connection that is lost is opened
// again as long as it is wanted. Whoever connects its sockets calls handle_ and drains poll_.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "option_boards/ethernet_ip/message_stream.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"
#include "sim/masters/eip_message.hpp"

namespace vinv::masters {

struct EipScannerSettings {
  // Of the triad that names connections.
  std::uint16_t vendor_id = 0x0511;
  std::uint32_t originator_serial = 1;
  Duration timeout = std::chrono::seconds(10);  // of an answer: a parameter clear takes about 5 s (6.2.2)
  Duration reopen_delay = std::chrono::seconds(1);
  // A class 3 connection ends at the target 4 << multiplier intervals after its last request.
  Duration class3_rpi = std::chrono::seconds(2);
  std::uint8_t class3_multiplier = 1;
  VINV_ARCHIVE(EipScannerSettings, vendor_id, originator_serial, timeout, reopen_delay, class3_rpi, class3_multiplier);
};

class EipScanner {
 public:
  static constexpr std::size_t kMaxWaiting = 256;  // requests; a further one is refused
  static constexpr std::size_t kMaxResults = 256;  // not fetched; then the oldest is lost
  // Before the first packet the device has at least this long (Vol 1, 3-4.5.2).
  static constexpr Duration kLeastFirstTimeout = std::chrono::seconds(10);

  explicit EipScanner(const EipScannerSettings& settings) : settings_(settings) {}

  // The TCP connection is there: a session is registered on it. Gone: what waits fails, the class 3 connection is gone,
  // the I/O connection stays.
  void handle_connected(Instant now);
  void handle_disconnected();
  bool connected() const { return state_.link != Link::kDown; }

  // A request's result comes later, also that there is no connection. Empty if too many wait.
  std::optional<CipAskId> submit(Instant now, CipAsk ask);

  // The result is the Forward_Open's. Another I/O connection that is open is forgotten without a close.
  std::optional<CipAskId> open_io(Instant now, const IoWish& wish);
  // The Forward_Close's; kNotConnected if nothing is open.
  std::optional<CipAskId> close_io(Instant now);
  bool io_open() const { return state_.io == Io::kOpen; }
  // Open, or to be opened again.
  bool io_wanted() const { return state_.wanted; }

  // The output image, as long as the wish says; sent with the next packets.
  Bytes& output() { return state_.output; }
  // Bumped by the caller after a change; the packet that has it is the first with sent_version() at or above it.
  std::uint64_t changed() { return ++state_.version; }
  std::uint64_t sent_version() const { return state_.sent_version; }
  void set_run(bool run) { state_.run = run; }
  bool run() const { return state_.run; }
  // Off: nothing is produced and nothing opened again, as of a scanner that has stopped.
  void set_producing(Instant now, bool on);
  // What the device sent last, and how many packets so far.
  const Bytes& input() const { return state_.input; }
  std::uint64_t inputs() const { return state_.inputs; }
  // The group that T->O comes to; 0: none.
  std::uint32_t multicast_group() const { return state_.io == Io::kOpen ? state_.group : 0; }

  void handle_tcp(Instant now, ByteView bytes);
  void handle_io(Instant now, ByteView datagram);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  // A whole encapsulation message.
  std::optional<Bytes> poll_tcp(Instant now);
  // A datagram for the adapter's I/O port.
  std::optional<Bytes> poll_io(Instant now);
  std::optional<CipResult> poll_result();
  // The adapter's answers make no sense: the connection has to be closed.
  bool close_requested() const { return state_.close_requested; }

  // Snapshots: the settings too.
  friend void archive(Archive& a, EipScanner& scanner) { scanner.archive_state(a); }

 private:
  enum class Link : std::uint8_t { kDown, kRegister, kRegistering, kUp };
  friend VINV_ENUM_RANGE(Link, kDown, kUp);
  enum class Io : std::uint8_t { kClosed, kOpening, kOpen, kLost };
  friend VINV_ENUM_RANGE(Io, kClosed, kLost);
  // What a request is to the scanner itself.
  enum class Purpose : std::uint8_t { kUser, kOpenIo, kReopenIo, kCloseIo, kOpenClass3 };
  friend VINV_ENUM_RANGE(Purpose, kUser, kOpenClass3);

  struct Waiting {
    CipAskId id = 0;
    Purpose purpose = Purpose::kUser;
    CipAsk ask;
    VINV_ARCHIVE(Waiting, id, purpose, ask);
  };
  struct State {
    Link link = Link::kDown;
    bool close_requested = false;
    std::uint32_t session = 0;
    std::uint32_t next_context = 1;
    CipAskId next_id = 1;
    std::uint16_t next_serial = 1;
    ethernet_ip::MessageStream stream;
    std::deque<Waiting> queue;
    std::optional<Waiting> current;    // on the wire
    std::uint32_t context = 0;         // of the current request
    std::optional<Instant> answer_by;  // of the session's registration or the current request
    std::deque<CipResult> results;
    // class 3
    bool class3_open = false;
    std::uint32_t class3_o2t = 0, class3_t2o = 0;
    std::uint16_t class3_count = 0;
    Instant class3_until{};  // the target gives it up; restarts from each request
    // class 1
    Io io = Io::kClosed;
    bool wanted = false;
    IoWish wish;
    std::uint16_t serial = 0;
    std::uint32_t o2t_id = 0, t2o_id = 0, group = 0;
    Duration o2t_api{}, t2o_api{};
    Bytes output, input;
    bool run = true, producing = true;
    std::uint64_t version = 1, sent_version = 0, inputs = 0;
    std::uint32_t sequence = 0;
    std::uint16_t count = 0;
    std::optional<std::uint32_t> last_sequence;
    Instant send_at{};                 // adds the interval
    Instant lost_at{};                 // restarts from each packet of the device
    std::optional<Instant> reopen_at;  // kLost
    VINV_ARCHIVE(State, link, close_requested, session, next_context, next_id, next_serial, stream, queue, current,
                 context, answer_by, results, class3_open, class3_o2t, class3_t2o, class3_count, class3_until, io,
                 wanted, wish, serial, o2t_id, t2o_id, group, o2t_api, t2o_api, output, input, run, producing, version,
                 sent_version, inputs, sequence, count, last_sequence, send_at, lost_at, reopen_at);
  };

  void archive_state(Archive& a);
  std::optional<CipAskId> queue(CipAsk ask, Purpose purpose);
  void finish(Instant now, CipAnswer answer, std::uint32_t group = 0);
  void report(CipAskId id, CipAnswer answer);
  void handle_message(Instant now, const ethernet_ip::EncapsulationMessage& message);
  void on_reply(Instant now, ByteView reply, std::uint32_t group);
  void on_opened(Instant now, const Bytes& data, std::uint32_t group);
  void lose_io(Instant now);
  CipAsk forward_open(const IoWish& wish, std::uint16_t serial, std::uint32_t t2o_id) const;
  CipAsk class3_open(std::uint16_t serial, std::uint32_t t2o_id) const;
  CipAsk forward_close(std::uint16_t serial) const;
  Bytes encapsulated(std::uint16_t command, ByteView data) const;
  Bytes unconnected(const CipAsk& ask) const;
  Bytes over_class3(const CipAsk& ask) const;

  EipScannerSettings settings_;
  State state_;
};

}  // namespace vinv::masters
