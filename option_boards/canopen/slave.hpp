// A CANopen slave: NMT with boot-up and node guarding, one SDO server (expedited transfers), SYNC consumer, EMCY
// producer, receive and transmit PDOs with variable mapping. CiA DS-301 v4.0: 9.2.1 PDO, 9.2.2 SDO, 9.2.3 SYNC,
// 9.2.5 EMCY, 9.2.6 NMT. No heartbeat, no time stamp, no segmented or block transfer.
//
// The table says which objects there are; those of item "communication" live here: 1005H, 100BH, 100CH, 100DH, 1014H,
// 14xxH, 16xxH, 18xxH, 1AxxH. All else is the application's.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "option_boards/canopen/abort_code.hpp"
#include "option_boards/canopen/nmt.hpp"
#include "option_boards/canopen/object_table.hpp"
#include "option_boards/canopen/pdo.hpp"
#include "option_boards/canopen/sdo.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/can_frame.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::canopen {

using WriteResult = Result<void, AbortCode>;

// Who writes an object.
enum class Origin : std::uint8_t { kSdo, kPdo };

enum class PdoFault : std::uint8_t {
  kRpdoTooShort,    // fewer bytes than mapped; the PDO has no effect
  kRpdoGoodAgain,   // the next one of that PDO had enough, or the PDO was set up anew
  kTpdoNotSampled,  // a synchronous RTR-only TPDO was asked for before the first SYNC; nothing is sent
};

struct Emergency {
  std::uint16_t error_code = 0;
  std::array<std::uint8_t, 5> manufacturer{};  // bytes 3-7
  VINV_ARCHIVE(Emergency, error_code, manufacturer);
};

// What lies behind the slave's dictionary. Calls come from inside the slave's handle_ functions.
class Application {
 public:
  virtual ~Application() = default;
  // False: the table's range covers the index but this device does not have the object.
  virtual bool exists(const ObjectRow& row, std::uint16_t index) const = 0;
  // A readable object, as it travels.
  virtual Result<std::uint32_t, AbortCode> read(const ObjectRow& row, std::uint16_t index, std::uint8_t sub) const = 0;
  // A writable object with a value in its range. Empty (Origin::kSdo only): decided later, by complete_download.
  virtual std::optional<WriteResult> write(Instant now, Origin origin, const ObjectRow& row, std::uint16_t index,
                                           std::uint8_t sub, std::uint32_t raw) = 0;
  // The client gave up the download that is not decided yet: complete_download must not be called for it.
  virtual void abandon_download() = 0;
  virtual std::uint8_t error_register() const = 0;
  // A command for this node; the state has changed already. After a reset the boot-up message is still to be sent.
  virtual void on_nmt_command(Instant now, NmtCommand command, NmtState before) = 0;
  // The life time ran out, or the master asks again.
  virtual void on_guarding(Instant now, bool lost) = 0;
  virtual void on_pdo_fault(Instant now, PdoFault fault, unsigned pdo) = 0;
};

class Slave {
 public:
  static constexpr std::size_t kPdos = 4;            // of each direction
  static constexpr std::size_t kMaxEmergencies = 8;  // waiting to be sent; then the oldest is lost
  static constexpr std::size_t kMaxSdoAnswers = 8;   // of a client that does not wait for them; then the oldest is lost

  // Both outlive the slave. It is off until start.
  Slave(const ObjectTable& table, Application& application) : table_(table), application_(application) {}

  // Boots as a node, 1-127.
  void start(Instant now, std::uint8_t node);
  void stop();

  void handle_frame(Instant now, const CanFrame& frame);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const;
  std::optional<CanFrame> poll_transmit(Instant now);
  // The application's data may have changed: event-driven TPDOs look.
  void handle_new_data(Instant now);

  void complete_download(const WriteResult& result);
  // While stopped only the most recent one is kept, to be sent afterwards (9.2.5.1).
  void send_emergency(const Emergency& emergency);

  NmtState state() const { return state_.nmt; }
  std::uint8_t node() const { return state_.node; }

  friend void archive(Archive& a, Slave& slave) { slave.archive_state(a); }

 private:
  struct Rpdo {
    PdoSettings settings;
    bool buffered = false;  // received, acts at the next SYNC
    bool too_short = false;
    std::array<std::uint8_t, kMaxPdoLength> data{};
    VINV_ARCHIVE(Rpdo, settings, buffered, too_short, data);
  };
  struct Tpdo {
    PdoSettings settings;
    std::uint8_t syncs = 0;    // since the last transmission, cyclic types
    bool sampled = false;      // type 252: sample holds what the last SYNC found
    bool asked_early = false;  // type 252: asked for before the first SYNC, reported
    bool sent = false;         // last_sent holds something
    bool event = false;        // waits for the end of the inhibit time
    bool transmit = false;     // sample is to be sent as soon as the bus takes it
    std::array<std::uint8_t, kMaxPdoLength> sample{};
    std::array<std::uint8_t, kMaxPdoLength> last_sent{};
    std::optional<Instant> inhibit_until;  // from the last transmission
    std::optional<Instant> event_at;       // event timer, from the last transmission
    VINV_ARCHIVE(Tpdo, settings, syncs, sampled, asked_early, sent, event, transmit, sample, last_sent, inhibit_until,
                 event_at);
  };
  // First in, first out; when it is full the oldest is lost.
  template <class T, std::size_t kCapacity>
  struct Backlog {
    std::size_t count = 0;
    std::array<T, kCapacity> items{};
    void push(const T& item) {
      if (count == kCapacity) pop();
      items[count++] = item;
    }
    T pop() {
      const T first = items[0];
      std::move(items.begin() + 1, items.begin() + static_cast<std::ptrdiff_t>(count), items.begin());
      --count;
      return first;
    }
    void keep_newest() {
      while (count > 1) pop();
    }
    friend void archive(Archive& a, Backlog& backlog) {
      VINV_MEMBERS(backlog, kept, waiting);
      VINV_FIELDS(a, Backlog, kept, waiting);
      a.require(kept <= kCapacity, "more messages wait than there can be");
    }
  };
  struct Download {
    std::uint16_t index = 0;
    std::uint8_t sub = 0;
    VINV_ARCHIVE(Download, index, sub);
  };
  struct QueuedEmergency {
    Emergency emergency;
    std::uint8_t error_register = 0;
    VINV_ARCHIVE(QueuedEmergency, emergency, error_register);
  };
  struct State {
    NmtState nmt = NmtState::kOff;
    std::uint8_t node = 0;
    std::uint32_t sync_cob_id = 0;
    std::uint32_t emergency_cob_id = 0;
    std::uint16_t guard_time = 0;  // ms
    std::uint8_t life_time_factor = 0;
    bool toggle = false;                  // of the next guard answer
    bool guarded = false;                 // the master has asked at least once since boot-up
    bool guarding_lost = false;           //
    std::optional<Instant> life_ends_at;  // restarts with each guard request
    std::optional<Download> download;     // not decided yet
    bool boot_up = false;                 // to be sent, as are the next ones
    bool guard_answer = false;
    Backlog<CanFrame, kMaxSdoAnswers> sdo_answers;
    Backlog<QueuedEmergency, kMaxEmergencies> emergencies;
    std::array<Rpdo, kPdos> rpdos;
    std::array<Tpdo, kPdos> tpdos;
    VINV_ARCHIVE(State, nmt, node, sync_cob_id, emergency_cob_id, guard_time, life_time_factor, toggle, guarded,
                 guarding_lost, life_ends_at, download, boot_up, guard_answer, sdo_answers, emergencies, rpdos, tpdos);
  };

  bool on_bus() const { return state_.nmt != NmtState::kOff; }
  bool may_talk() const { return state_.nmt == NmtState::kOperational || state_.nmt == NmtState::kPreOperational; }

  // slave.cpp
  void reset_communication();
  void handle_nmt(Instant now, const CanFrame& frame);
  void enter(Instant now, NmtState next);
  void handle_guard_request(Instant now);
  Duration life_time() const;
  void handle_sdo(Instant now, const CanFrame& frame);
  void answer_download(std::uint16_t index, std::uint8_t sub, const WriteResult& result);
  Result<const ObjectRow*, AbortCode> find(std::uint16_t index, std::uint8_t sub) const;

  // slave_objects.cpp
  Result<std::uint32_t, AbortCode> read(const ObjectRow& row, std::uint16_t index, std::uint8_t sub) const;
  std::optional<WriteResult> download(Instant now, const SdoRequest& request);
  std::uint32_t read_communication(std::uint16_t index, std::uint8_t sub) const;
  WriteResult write_communication(Instant now, std::uint16_t index, std::uint8_t sub, std::uint32_t value);
  WriteResult write_pdo_communication(Instant now, PdoDirection direction, std::size_t pdo, std::uint8_t sub,
                                      std::uint32_t value);
  WriteResult write_pdo_mapping(PdoDirection direction, std::size_t pdo, std::uint8_t sub, std::uint32_t value);
  WriteResult activate_mapping(PdoDirection direction, std::size_t pdo, std::uint8_t count);
  void set_default(std::uint16_t index, std::uint8_t sub, std::uint32_t value);
  PdoSettings& settings(PdoDirection direction, std::size_t pdo);
  const PdoSettings& settings(PdoDirection direction, std::size_t pdo) const;

  // slave_pdo.cpp
  void start_pdos(Instant now);
  void restart_tpdo(Instant now, std::size_t pdo);
  void handle_sync(Instant now);
  void handle_rpdo(Instant now, std::size_t pdo, const CanFrame& frame);
  void apply(Instant now, const Rpdo& rpdo);
  void handle_tpdo_request(Instant now, std::size_t pdo);
  std::array<std::uint8_t, kMaxPdoLength> sample(const PdoSettings& settings) const;
  void trigger(Instant now, Tpdo& tpdo);
  CanFrame emit(Instant now, Tpdo& tpdo);

  // slave_snapshot.cpp
  void archive_state(Archive& a);
  bool is_sound(PdoDirection direction, const PdoSettings& settings) const;

  const ObjectTable& table_;
  Application& application_;
  State state_;
};

}  // namespace vinv::canopen
