// What the FR-A7NE is to CIP: its objects, its I/O and its identity, over one inverter. FR-A7NE manual, 4 to 7 and the
// appendix. The objects are objects.csv and services.csv.
//
// Explicit writes: one at a time ("Object State Conflict" for a second one), answered when the inverter has decided.
// Polled output data acts when it changes (6.2.1): the last command counts, whichever way it came.
// Settings act from power-on or reset: assemblies (Pr.346), address and line (Pr.540, 434-445, flash), CtrlFromNet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/boards/fr_a7ne/drive_link.hpp"
#include "option_boards/boards/fr_a7ne/leds.hpp"
#include "option_boards/boards/fr_a7ne/network_settings.hpp"
#include "option_boards/cip/device.hpp"
#include "option_boards/cip/profile/control_supervisor.hpp"
#include "option_boards/cip/profile/speed_scale.hpp"
#include "option_boards/cip/table_object.hpp"
#include "sim/base/archive.hpp"

namespace vinv::boards::fr_a7ne {

struct CipUnitConfig {
  std::uint32_t serial_number = 1;
  EthernetSurroundings ethernet;
  Timing timing = Timing::real();
};

// Connections of one kind: an I/O role, or explicit.
struct ConnectionTally {
  std::uint32_t open = 0;
  bool timed_out = false;  // until one is opened again (1.2)
  VINV_ARCHIVE(ConnectionTally, open, timed_out);
};

// Instance 126 with WriteParam: an explicit write that the board makes by itself.
struct PolledParameter {
  cip::ObjectPath path;
  std::uint16_t raw = 0;
  VINV_ARCHIVE(PolledParameter, path, raw);
};

class CipUnit final : public cip::Device, public cip::IoPoints {
 public:
  static constexpr std::size_t kMostIoBytes = 6;
  // Unspecified: how long the self-test at power-on lasts (1.2).
  static constexpr Duration kSelfTest = std::chrono::milliseconds(500);
  // Unspecified: points that keep an input only or listen only connection open, and take no data.
  static constexpr std::uint32_t kInputOnlyPoint = 238;
  static constexpr std::uint32_t kListenOnlyPoint = 237;

  // The drive outlives the unit. Without supply until handle_power.
  CipUnit(port::DrivePort& drive, const CipUnitConfig& config);

  void handle_power(Instant now, bool on);
  void handle_drive_tick(Instant now);
  void handle_timeout(Instant now);
  std::optional<Instant> next_deadline() const { return state_.link.next_deadline(); }
  // True once after the option has restarted (supply, or an inverter reset without Pr.540 bit 11) or has left the
  // network: its connections and sessions are gone.
  bool take_restart();
  // Supplied and started; the network sees nothing of it before.
  bool online() const { return state_.supply == Supply::kOn; }
  // What it keeps over power-off; acts from the next start on.
  const Flash& flash() const { return state_.flash; }
  void set_flash(const Flash& flash) { state_.flash = flash; }
  const NetworkSettings& network() const { return state_.network; }
  LineState line() const { return line_state(state_.network.line, config_.ethernet.line_partner); }
  // The cable is plugged and the other end is alive. A link that was there and is lost is a line error (4.5.1); one
  // that has not been there since the start is not (chapter 8: the panel shows 0.00, the LED is off).
  void set_link(Instant now, bool up);
  // A fault of the option itself (4.5.2): MS lights red, it leaves the network, and the inverter is told. Acts until
  // the next start after it is mended.
  void set_failed(Instant now, bool failed);
  // Somebody else has the option's address. It then leaves the network until the next start (1.2, chapter 8).
  void set_address_conflict(Instant now, bool conflict);
  bool has_link() const { return !state_.link_down && line().link; }
  bool duplicate_address() const { return state_.duplicate_address; }
  bool failed() const { return state_.failed; }
  // The network can reach it: started, with an address of its own and a link.
  bool on_network() const;
  // All that the unit knows of it: not traffic.
  LedSituation led_situation() const;

  // cip::Device
  cip::MessageRouter& router() override { return router_; }
  const cip::MessageRouter& router() const { return router_; }
  cip::IoPoints& io() override { return *this; }
  const cip::Identity& identity() const override { return identity_; }
  std::uint16_t identity_status() const override;
  cip::IdentityState identity_state() const override;
  void on_explicit_connection(Instant now, cip::IoEvent event) override;

  // cip::IoPoints
  std::optional<std::size_t> consumed_size(std::uint32_t point) const override;
  std::optional<std::size_t> produced_size(std::uint32_t point) const override;
  std::optional<std::size_t> configuration_size(std::uint32_t point) const override;
  bool is_heartbeat(std::uint32_t point, cip::IoRole role) const override;
  bool goes_with(std::uint32_t consumed_point, std::uint32_t produced_point) const override;
  cip::Status configure(Instant now, std::uint32_t point, ByteView data) override;
  void consume(Instant now, std::uint32_t point, ByteView data, cip::RunMode mode) override;
  void produce(Instant now, std::uint32_t point, std::span<std::uint8_t> out) override;
  std::uint32_t produced_version(std::uint32_t point) const override;
  void on_connection(Instant now, const cip::IoConnection& connection, cip::IoEvent event) override;

  // The objects, for reports and tests.
  static const cip::AttributeTable& objects();

 private:
  struct Bindings;  // what the rows of the tables are bound to
  using Image = std::array<std::uint8_t, kMostIoBytes>;
  // Run1 and Run2 by the run/stop events of the drive profile: the manual says nothing of both at once.
  static constexpr cip::RunStyle kRunStyle = cip::RunStyle::kEdges;
  enum class Supply : std::uint8_t { kOff, kStarting, kOn };
  friend VINV_ENUM_RANGE(Supply, kOff, kOn);

  // The input data as somebody last asked for its version.
  struct InputVersion {
    Image image{};
    std::uint32_t number = 0;
    VINV_ARCHIVE(InputVersion, image, number);
  };
  struct State {
    Supply supply = Supply::kOff;
    bool started = false;  // the inverter has been ready since power-on
    bool was_ready = false;
    bool restart_due = false;
    bool restarted = false;
    StartupParameters startup;
    NetworkSettings network;
    AssemblyPair assemblies;
    bool control_from_net_at_start = false;
    Flash flash;
    DriveLink link;
    port::NetTerminals terminals;  // what the network has on
    port::NetTerminals wanted;     // the same with what is on its way to the inverter
    cip::RunSignals run;           // Run1 and Run2 as they were written last
    cip::FaultResetEdge explicit_reset, polled_reset;
    // Polled data: as it came, as it last acted.
    Image output{}, acted{};
    bool acted_before = false, acted_idle = false;
    bool polled_control = false;                     // NetCtrl was on: the run bits are the master's
    std::optional<PolledParameter> parameter_write;  // waits for the explicit write in work
    std::array<ConnectionTally, 4> connections{};    // by IoRole, then explicit
    bool owner_timed_out = false, link_down = false;
    bool link_seen = false;  // since the start
    bool address_conflict = false, duplicate_address = false;
    bool broken = false, failed = false;  // now; since the start
    bool option_alarm = false;            // E.3, before the inverter was reset
    Instant supplied_at{};
    Instant now{};  // of the last tick
    VINV_ARCHIVE(State, supply, started, was_ready, restart_due, restarted, startup, network, assemblies,
                 control_from_net_at_start, flash, link, terminals, wanted, run, explicit_reset, polled_reset, output,
                 acted, acted_before, acted_idle, polled_control, parameter_write, connections, owner_timed_out,
                 link_down, link_seen, address_conflict, duplicate_address, broken, failed, option_alarm, supplied_at,
                 now);
  };

  void start();
  void restart();
  bool read_startup_parameters();
  void advance(Instant now);
  void on_finished(const Finished& finished);
  static constexpr std::size_t kExplicit = 3;  // of connections
  ConnectionTally& tally(cip::IoRole role) { return state_.connections[static_cast<std::size_t>(role)]; }
  static void count(ConnectionTally& tally, cip::IoEvent event);
  void look_for_link();
  void look_for_duplicate();
  void leave_network();
  bool line_error() const;
  bool self_tests() const { return state_.supply == Supply::kStarting && state_.now < state_.supplied_at + kSelfTest; }
  void report_line_error();

  // Reads of the inverter.
  std::uint32_t parameter_or(std::uint16_t number, std::uint32_t fallback) const;
  bool network_mode() const { return drive_.operation_mode() == port::OperationMode::kNetwork; }
  bool control_from_net() const;
  bool reference_from_net() const;
  cip::SpeedScale speed_scale() const;
  std::uint16_t speed_actual() const;
  bool fault_reset_allowed() const;
  // The terminals that follow when Run1 and Run2 are written; notes them as wanted.
  port::NetTerminals with_run(cip::RunSignals run);
  void want(port::NetTerminals terminals, cip::RunSignals run);

  // Explicit writes; kObjectStateConflict while one is in work.
  std::optional<cip::GeneralStatus> refuses_explicit(Instant now) const;
  cip::SetResult post(Instant now, ExplicitJob job, cip::Ticket ticket);
  cip::SetResult post(Instant now, const port::WriteRequest& request, cip::Ticket ticket);

  // Polled data (cip_unit_io.cpp).
  void act_on_output(Instant now, cip::RunMode mode);
  void poll_terminals(cip::RunMode mode);
  void poll_reset(bool bit);
  void poll_speed();
  void poll_parameter();
  void poll_outputs();
  void write_polled_parameter(Instant now);
  cip::ObjectPath parameter_path() const;
  void fill_input(Instant now, std::uint32_t instance, std::span<std::uint8_t> out) const;
  std::uint8_t status_byte(std::uint32_t instance) const;
  std::uint16_t parameter_read_data() const;
  std::uint16_t selected_monitor() const;
  void append_assembly(std::uint32_t instance, Bytes& out) const;

  port::DrivePort& drive_;
  CipUnitConfig config_;
  cip::Identity identity_;
  cip::MessageRouter router_;
  cip::BoundObject<CipUnit> objects_;
  State state_;
  mutable InputVersion input_version_;
  mutable Bytes scratch_;  // keeps its memory

  friend void archive(Archive& a, CipUnit& unit) {
    a.io(unit.state_);
    a.io(unit.input_version_);
    a.io(unit.router_);
  }
};

}  // namespace vinv::boards::fr_a7ne
