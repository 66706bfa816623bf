// A Modbus master (client) on one serial line or one TCP connection: a queue of requests, one of them on the wire,
// time-outs and retries, cyclic reads.
// MODBUS over Serial Line V1.02: 2.4.1 master states, 2.5.1 RTU framing. MODBUS Messaging on TCP/IP V1.0b: 3.1.3 MBAP.
//
// On a serial line a request waits for 3.5 characters of silence; the time-out runs from its last character; after a
// broadcast the line rests for the turnaround delay. An answer ends with 3.5 characters of silence. A damaged one is
// asked for again at once, one of another unit does not end the waiting.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"
#include "sim/masters/modbus_request.hpp"

namespace vinv::masters {

enum class ModbusFraming : std::uint8_t { kRtu, kTcp };
VINV_ENUM_RANGE(ModbusFraming, kRtu, kTcp);

struct ModbusMasterSettings {
  ModbusFraming framing = ModbusFraming::kRtu;
  std::uint32_t baud = 9600;         // kRtu, > 0
  unsigned bits_per_character = 10;  // kRtu: start, data, parity and stop bits
  Duration timeout = std::chrono::milliseconds(500);
  unsigned retries = 2;  // after a time-out or a damaged answer; an exception is an answer
  Duration turnaround = std::chrono::milliseconds(100);
  VINV_ARCHIVE(ModbusMasterSettings, framing, baud, bits_per_character, timeout, retries, turnaround);
};

using ModbusRequestId = std::uint32_t;

struct ModbusResult {
  ModbusRequestId id = 0;
  std::optional<std::size_t> cycle;  // of a cyclic request: its number
  ModbusRequest request;
  ModbusAnswer answer = Unexpected(ModbusFailure{});
  unsigned attempts = 0;
  friend void archive(Archive& a, ModbusResult& result) {
    VINV_MEMBERS(result, id, cycle, request, answer, attempts);
    VINV_FIELDS(a, ModbusResult, id, cycle, request, answer, attempts);
    a.require(!answer || !answer->empty(), "a Modbus answer is empty");
  }
};

class ModbusMaster {
 public:
  static constexpr std::size_t kMaxWaiting = 256;  // requests; a further one is refused
  static constexpr std::size_t kMaxCycles = 64;
  static constexpr std::size_t kMaxResults = 256;  // not fetched; then the oldest is lost

  explicit ModbusMaster(const ModbusMasterSettings& settings);

  // Line or connection is there, with nothing on it. Gone: everything that waits fails with kNotConnected.
  void handle_connected(Instant now);
  void handle_disconnected();
  bool connected() const { return state_.connected; }

  // A legal request; empty if too many wait. Its result comes later, also that there is no connection.
  std::optional<ModbusRequestId> submit(Instant now, ModbusRequest request);
  // Asks every interval from now on; one that still waits when it is due again is not queued twice. The number of the
  // cycle; empty beyond kMaxCycles.
  std::optional<std::size_t> add_cycle(Instant now, ModbusRequest request, Duration interval);

  void handle_bytes(Instant now, ByteView bytes, bool line_error);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  // A whole frame, to be sent from now on.
  std::optional<Bytes> poll_transmit(Instant now);
  std::optional<ModbusResult> poll_result();
  // What came is no Modbus/TCP: the connection has to be closed.
  bool close_requested() const { return state_.close_requested; }

  // Requests that wait or are on the wire.
  std::size_t waiting() const { return state_.queue.size() + (state_.current ? 1 : 0); }
  Duration frame_time(std::size_t bytes) const;
  const ModbusMasterSettings& settings() const { return settings_; }

  // Snapshots: the settings too; a load refuses another framing.
  friend void archive(Archive& a, ModbusMaster& master) { master.archive_state(a); }

 private:
  struct Waiting {
    ModbusRequestId id = 0;
    std::optional<std::size_t> cycle;
    ModbusRequest request;
    VINV_ARCHIVE(Waiting, id, cycle, request);
  };
  struct Current {
    Waiting what;
    unsigned attempts = 0;             // sent so far
    std::uint16_t transaction_id = 0;  // kTcp: of the last attempt
    std::optional<Instant> answer_by;  // empty: to be sent (again)
    VINV_ARCHIVE(Current, what, attempts, transaction_id, answer_by);
  };
  struct Cycle {
    ModbusRequest request;
    Duration interval{};
    Instant due_at{};  // adds the interval each time
    bool waits = false;
    VINV_ARCHIVE(Cycle, request, interval, due_at, waits);
  };
  struct State {
    bool connected = false;
    bool close_requested = false;
    ModbusRequestId next_id = 1;
    std::uint16_t next_transaction_id = 1;
    std::deque<Waiting> queue;
    std::optional<Current> current;
    std::vector<Cycle> cycles;
    std::deque<ModbusResult> results;
    Bytes received;  // of the frame that comes
    bool damaged = false;
    std::optional<Instant> frame_ends_at;  // kRtu: 3.5 characters after the last one
    Instant line_free_at{};                // kRtu: the next request starts not before
    VINV_ARCHIVE(State, connected, close_requested, next_id, next_transaction_id, queue, current, cycles, results,
                 received, damaged, frame_ends_at, line_free_at);
  };

  void archive_state(Archive& a);
  void follow_settings();
  void finish(const ModbusAnswer& answer);
  void report(Waiting what, const ModbusAnswer& answer, unsigned attempts);
  void attempt_failed(ModbusFailure failure);
  void end_rtu_frame();
  void take_adus();
  void start_cycles(Instant now);

  ModbusMasterSettings settings_;
  Duration character_{};
  Duration silence_{};  // 3.5 characters
  State state_;
};

}  // namespace vinv::masters
