// RTU framing of one serial line for one or more units. MODBUS over Serial Line V1.02: 2.2 addressing rules,
// 2.4.2 server states, 2.5.1 RTU framing, 2.5.1.1 silent intervals.
//
// A frame is what ends with 3.5 characters of silence; more than 1.5 characters of silence inside it, a line error, a
// wrong CRC, a length outside 4-256 or another unit's address: no answer. The line is half duplex and the server takes
// a request in its idle state only: what arrives while an answer is being prepared is dropped as a whole frame, and the
// answer waits until the line has been silent for 3.5 characters again.
//
// Bytes come in chunks with the time of their last character. Inside a chunk there is no silence; before a chunk of n
// characters n - 1 character times count as reception, not as silence.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "option_boards/modbus/unit.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::modbus {

// 2.5.1.1: from the character time up to 19200 baud, fixed above (750 us, 1.75 ms).
struct SilentIntervals {
  Duration character{};
  Duration t1_5{};
  Duration t3_5{};
  VINV_ARCHIVE(SilentIntervals, character, t1_5, t3_5);
};
SilentIntervals silent_intervals(std::uint32_t baud, unsigned bits_per_character);

class RtuServer {
 public:
  static constexpr std::size_t kMinFrame = 4;  // address, function, CRC
  static constexpr std::size_t kMaxFrame = 256;

  struct Settings {
    std::uint32_t baud = 9600;         // > 0
    unsigned bits_per_character = 10;  // start, data, parity and stop bits
    Duration answer_delay{};           // from the answer being ready to its first character
    // How late a driver may hand over characters (FIFO and latency timer of a real tty); widens both silences.
    Duration receive_slack{};
    VINV_ARCHIVE(Settings, baud, bits_per_character, answer_delay, receive_slack);
  };

  explicit RtuServer(ClientId client) : client_(client) {}
  // The unit outlives the server. At most one unit answers an address: the first added.
  void add_unit(Unit& unit) { units_.push_back(&unit); }

  // Opens the line. The first frame may start after 3.5 characters of silence (figure 14, initial state).
  void start(Instant now, const Settings& settings);
  // Closes it: what was received or not yet answered is dropped.
  void stop();

  void handle_bytes(Instant now, ByteView bytes, bool line_error);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  // The whole answer frame, once the unit has decided, the delay is over and the line is silent.
  std::optional<Bytes> poll_transmit(Instant now);

  friend void archive(Archive& a, RtuServer& server) { server.archive_state(a); }

 private:
  enum class Transaction : std::uint8_t { kNone, kAwaitingUnit, kAnswering };
  friend VINV_ENUM_RANGE(Transaction, kNone, kAnswering);

  struct State {
    bool open = false;
    Settings settings;
    SilentIntervals silence;
    bool receiving = false;  // characters came and the 3.5 characters of silence are not over
    bool discard = false;    // the frame being received will not be used
    std::size_t length = 0;
    std::array<std::uint8_t, kMaxFrame> frame{};
    Instant last_character_at{};
    Transaction transaction = Transaction::kNone;
    std::size_t unit_index = 0;     // of the transaction
    std::uint8_t unit_address = 0;  // as asked
    Bytes answer;                   // kAnswering: the frame
    Instant answer_at{};            // kAnswering: earliest start
    VINV_ARCHIVE(State, open, settings, silence, receiving, discard, length, frame, last_character_at, transaction,
                 unit_index, unit_address, answer, answer_at);
  };

  void archive_state(Archive& a);
  Instant frame_ends_at() const;
  void end_frame(Instant now);
  void dispatch(Instant now, ByteView frame);

  ClientId client_;
  std::vector<Unit*> units_;
  State state_;
};

}  // namespace vinv::modbus
