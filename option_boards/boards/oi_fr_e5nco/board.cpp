#include "option_boards/boards/oi_fr_e5nco/board.hpp"

#include <algorithm>

namespace vinv::boards::oi_fr_e5nco {
namespace {

constexpr port::ParameterId kNodeParameter{345, 0};
constexpr port::ParameterId kBitRateParameter{346, 0};
constexpr port::ParameterId kSerialParameter{347, 0};
constexpr std::uint32_t kNodeFromSwitches = 100;
constexpr std::uint32_t kDefaultBitRate = 132;       // 84H: 125 kbit/s (5.1)
constexpr std::uint32_t kDefaultSerialSetup = 0x04;  // 9600 baud, no parity (8.3.5)

// Empty: the inverter cannot tell yet. A family without the parameter has its default.
std::optional<std::uint32_t> read_startup_parameter(const port::DrivePort& drive, port::ParameterId id,
                                                    std::uint32_t fallback) {
  const auto value = drive.read_parameter(id);
  if (value) return *value;
  if (value.error() == port::Refusal::kNotReady) return std::nullopt;
  return fallback;
}

}  // namespace

Board::Board(port::DrivePort& drive, AddressSwitches switches)
    : modbus_port_(drive, state_.mailbox, MailboxUser::kModbus),
      canopen_port_(drive, state_.mailbox, MailboxUser::kCanopen),
      drive_(drive),
      unit_(modbus_port_),
      canopen_(canopen_port_) {
  state_.switches = switches;
  state_.serial = parse_pr347(kDefaultSerialSetup);
  rtu_.add_unit(unit_);
}

void Board::handle_power(Instant now, bool on) {
  if (on == (state_.supply != Supply::kOff)) return;
  if (!on) {
    state_.supply = Supply::kOff;
    state_.drive_was_ready = false;
    unit_.set_address(0);
    rtu_.stop();
    canopen_.stop();
    state_.mailbox.waiting = {};
    return;
  }
  state_.supply = Supply::kStarting;
  state_.sampled_switches = state_.switches;
  start(now);
}

void Board::start(Instant now) {
  const auto raw_pr345 = read_startup_parameter(drive_, kNodeParameter, kNodeFromSwitches);
  const auto raw_pr347 = read_startup_parameter(drive_, kSerialParameter, kDefaultSerialSetup);
  const auto raw_pr346 = read_startup_parameter(drive_, kBitRateParameter, kDefaultBitRate);
  if (!raw_pr345 || !raw_pr346 || !raw_pr347) return;
  state_.supply = Supply::kOn;
  state_.serial = parse_pr347(*raw_pr347);
  const std::uint8_t node = node_address(*raw_pr345, state_.sampled_switches);
  unit_.set_address(node);
  open_line(now);
  canopen_.start(now, node, can_bit_rate(*raw_pr346));
}

void Board::open_line(Instant now) {
  unit_.set_immediate_answer(state_.serial.immediate_answer);
  rtu_.start(now, {.baud = state_.serial.line.baud,
                   .bits_per_character = bits_per_character(state_.serial.line),
                   .answer_delay = state_.serial.answer_delay,
                   .receive_slack = state_.receive_slack});
}

void Board::handle_drive_tick(Instant now) {
  unit_.handle_drive_tick();
  if (const auto asked_at = unit_.take_mode_request()) canopen_.on_mode_of_other_master(*asked_at);
  canopen_.handle_drive_tick(now);
  if (state_.supply == Supply::kStarting) start(now);
  if (state_.supply != Supply::kOn) return;
  const bool ready = drive_.ready();
  if (ready && !state_.drive_was_ready) {
    // Start-up or a reset is over.
    const auto raw_pr347 = read_startup_parameter(drive_, kSerialParameter, kDefaultSerialSetup);
    if (raw_pr347 && parse_pr347(*raw_pr347) != state_.serial) {
      state_.serial = parse_pr347(*raw_pr347);
      open_line(now);
    }
  }
  state_.drive_was_ready = ready;
}

void Board::handle_timeout(Instant now) {
  rtu_.handle_timeout(now);
  canopen_.handle_timeout(now);
}

std::optional<Instant> Board::next_deadline() const {
  const auto of_line = rtu_.next_deadline(), of_bus = canopen_.next_deadline();
  if (!of_line || !of_bus) return of_line ? of_line : of_bus;
  return std::min(*of_line, *of_bus);
}

void Board::handle_bytes(Instant now, ByteView bytes, bool line_error) { rtu_.handle_bytes(now, bytes, line_error); }

void Board::set_receive_slack(Instant now, Duration slack) {
  state_.receive_slack = slack;
  if (state_.supply == Supply::kOn) open_line(now);
}

Result<void, std::string> Board::set_switch(std::string_view name, unsigned value) {
  constexpr unsigned kLastDigit = 9;
  if (name != "SW1" && name != "SW2") {
    return Unexpected("oi-fr-e5nco has no switch \"" + std::string(name) + "\"; it has SW1 (tens) and SW2 (units)");
  }
  if (value > kLastDigit) {
    return Unexpected(std::string(name) + " is a digit, 0 to 9; " + std::to_string(value) + " is not");
  }
  (name == "SW1" ? state_.switches.sw1 : state_.switches.sw2) = static_cast<std::uint8_t>(value);
  return {};
}

void Board::archive_state(Archive& a) {
  // The shares, too, know nothing but where drive and mailbox are.
  VINV_MEMBERS(*this, state, modbus_port, canopen_port, drive, unit, canopen, rtu);
  a.must_match("option board", kType);
  VINV_FIELDS(a, Board, state, unit, canopen, rtu);
  a.require(state.serial.line.baud > 0, "a serial line has no speed");
}

}  // namespace vinv::boards::oi_fr_e5nco
