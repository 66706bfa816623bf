// A CANopen master: NMT commands, boot-up, guarding and heartbeat of its nodes, a heartbeat of its own, SDO client,
// SYNC producer, EMCY consumer, PDOs both ways. CiA DS-301 v4.0: 9.2.1 PDO, 9.2.2 SDO, 9.2.3 SYNC, 9.2.5 EMCY, 9.2.6
// NMT.
//
// Nodes are those of the predefined connection set: a node's RPDO n has COB-ID 200H, 300H ... + node, its TPDO n 180H,
// 280H ... + node. What an RPDO carries is kept as an image, byte by byte, and sent by order or with each SYNC.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "option_boards/canopen/nmt.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/can_frame.hpp"
#include "sim/base/time.hpp"
#include "sim/masters/sdo_client.hpp"

namespace vinv::masters {

struct CanopenMasterSettings {
  std::uint8_t node = 127;        // its own, for the heartbeat
  Duration heartbeat_interval{};  // 0: none
  Duration sync_interval{};       // 0: none
  std::uint32_t sync_cob_id = 0x80;
  Duration sdo_timeout = std::chrono::milliseconds(500);
  VINV_ARCHIVE(CanopenMasterSettings, node, heartbeat_interval, sync_interval, sync_cob_id, sdo_timeout);
};

struct CanopenEmergency {
  std::uint16_t error_code = 0;  // 0: the error is gone
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> manufacturer{};
  VINV_ARCHIVE(CanopenEmergency, error_code, error_register, manufacturer);
};

struct CanopenEvent {
  enum class Kind : std::uint8_t {
    kBootUp,
    kState,          // a guarding answer or heartbeat has another state than before
    kGuardToggle,    // the toggle bit did not alternate
    kGuardLost,      // no guarding answer within the life time
    kGuardBack,      // an answer after kGuardLost
    kHeartbeatLost,  // no heartbeat within the time
    kEmergency,
    kSdo,
    kPdo,
  };
  friend VINV_ENUM_RANGE(Kind, kBootUp, kPdo);
  Kind kind = Kind::kState;
  std::uint8_t node = 0;
  canopen::NmtState state = canopen::NmtState::kOff;  // kState
  CanopenEmergency emergency;
  std::optional<SdoResult> sdo;
  CanFrame pdo;
  VINV_ARCHIVE(CanopenEvent, kind, node, state, emergency, sdo, pdo);
};

class CanopenMaster {
 public:
  static constexpr std::size_t kPdos = 4;           // of a node, each way
  static constexpr std::size_t kMaxOutgoing = 256;  // frames that the bus does not take; then the newest is lost
  static constexpr std::size_t kMaxEvents = 1024;   // not fetched; then the oldest is lost

  explicit CanopenMaster(const CanopenMasterSettings& settings);

  // SYNC and heartbeat begin.
  void start(Instant now);

  // node 0: all.
  void command(canopen::NmtCommand command, std::uint8_t node);
  // Asks the node for its state each guard_time from now on; the life time is guard_time * life_time_factor, 1 or
  // more. Guard time 0 ends it. The node's own 100CH and 100DH are the caller's business.
  void guard(Instant now, std::uint8_t node, Duration guard_time, unsigned life_time_factor);
  // The node's heartbeat must come within timeout, from its first one on; 0 ends it.
  void watch_heartbeat(std::uint8_t node, Duration timeout);

  std::optional<SdoId> transfer(const SdoTransfer& transfer) { return state_.sdo.submit(transfer); }

  // pdo: 1-4. The image is as long as the farthest byte ever set; 1 to 4 bytes at offset, little endian.
  void set_output(std::uint8_t node, unsigned pdo, unsigned offset, unsigned size, std::uint32_t raw);
  void send_output(std::uint8_t node, unsigned pdo);
  // With each SYNC, ahead of it.
  void send_output_cyclically(std::uint8_t node, unsigned pdo, bool on);
  // Remote request of a TPDO.
  void request_input(std::uint8_t node, unsigned pdo, std::uint8_t length);
  void send_sync();
  // Any frame, as it is.
  void send(const CanFrame& frame);

  void handle_frame(Instant now, const CanFrame& frame);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  std::optional<CanFrame> poll_transmit(Instant now);
  std::optional<CanopenEvent> poll_event();

  // As boot-up, guarding or heartbeat told last; kOff if never.
  canopen::NmtState state_of(std::uint8_t node) const;
  // The newest emergency of the node; empty if none came.
  std::optional<CanopenEmergency> emergency_of(std::uint8_t node) const;
  // Emergencies of the node so far, those that end an error too.
  std::uint64_t emergencies_of(std::uint8_t node) const;

  // Snapshots: the settings too.
  friend void archive(Archive& a, CanopenMaster& master) { master.archive_state(a); }

 private:
  struct Output {
    std::uint8_t length = 0;
    bool cyclic = false;
    std::array<std::uint8_t, 8> data{};
    VINV_ARCHIVE(Output, length, cyclic, data);
  };
  struct Node {
    canopen::NmtState state = canopen::NmtState::kOff;
    Duration guard_time{};
    unsigned life_time_factor = 1;
    Instant guard_at{};                   // the next request; adds guard_time
    std::optional<bool> toggle;           // of the next answer; empty: either
    std::optional<Instant> life_ends_at;  // restarts with each answer
    bool guard_lost = false;
    Duration heartbeat_timeout{};
    std::optional<Instant> heartbeat_by;  // restarts with each heartbeat
    std::optional<CanopenEmergency> emergency;
    std::uint64_t emergencies = 0;
    std::array<Output, kPdos> outputs{};
    VINV_ARCHIVE(Node, state, guard_time, life_time_factor, guard_at, toggle, life_ends_at, guard_lost,
                 heartbeat_timeout, heartbeat_by, emergency, emergencies, outputs);
  };
  struct State {
    SdoClient sdo;
    std::map<std::uint8_t, Node> nodes;
    std::optional<Instant> sync_at;       // adds the interval
    std::optional<Instant> heartbeat_at;  // adds the interval
    std::deque<CanFrame> outgoing;
    std::deque<CanopenEvent> events;
    std::uint64_t lost = 0;  // frames and events, at the limits
    VINV_ARCHIVE(State, sdo, nodes, sync_at, heartbeat_at, outgoing, events, lost);
  };

  void archive_state(Archive& a);
  void push(CanopenEvent event);
  void push(CanopenEvent::Kind kind, std::uint8_t node);
  void handle_error_control(Instant now, std::uint8_t node, const CanFrame& frame);
  void handle_guard_answer(Instant now, std::uint8_t node, Node& n, bool toggle);
  void set_state(std::uint8_t node, Node& n, canopen::NmtState state);
  void collect_sdo_results();

  CanopenMasterSettings settings_;
  State state_;
};

}  // namespace vinv::masters
