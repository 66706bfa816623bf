#include "option_boards/boards/oi_fr_e5nco/modbus_unit.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "option_boards/boards/oi_fr_e5nco/exception_codes.hpp"
#include "option_boards/boards/oi_fr_e5nco/words.hpp"

namespace vinv::boards::oi_fr_e5nco {

using modbus::Exception;

namespace {

constexpr std::uint16_t kAddressStep = 2;  // 8.7.1: only even addresses are used, and quantity counts items

std::uint8_t function_code(modbus::Function function) { return static_cast<std::uint8_t>(function); }

Bytes write_answer(const modbus::WriteSingleRegister& request, const port::WriteOutcome& outcome) {
  if (outcome) return modbus::emit(modbus::Request{request});
  return modbus::emit_exception(function_code(modbus::Function::kWriteSingleRegister), exception_of(outcome.error()));
}

}  // namespace

void ModbusUnit::set_address(std::uint8_t address) {
  state_.address = address;
  if (address != 0) return;
  // What is in the mailbox is still the inverter's to decide; nobody hears of it.
  if (state_.pending) state_.pending->client.reset();
  state_.answers.clear();
}

void ModbusUnit::handle_request(Instant now, modbus::ClientId client, modbus::Addressing addressing, ByteView pdu) {
  if (state_.address == 0) return;
  const bool broadcast = addressing == modbus::Addressing::kBroadcast;
  const auto request = modbus::parse_request(pdu);
  if (!request) {
    if (!broadcast) answer(client, modbus::emit_exception(modbus::function_of(pdu), request.error()));
    return;
  }
  if (const auto* wanted = std::get_if<modbus::ReadHoldingRegisters>(&*request)) {
    if (broadcast) return;
    const auto values = read(*wanted);
    answer(client, values ? *values : modbus::emit_exception(modbus::function_of(pdu), values.error()));
  } else {
    write(now, std::get<modbus::WriteSingleRegister>(*request),
          broadcast ? std::nullopt : std::optional<modbus::ClientId>(client));
  }
}

Result<Bytes, Exception> ModbusUnit::read(const modbus::ReadHoldingRegisters& request) const {
  bool inverter_needed = false;
  std::array<const RegisterRow*, modbus::kMaxReadQuantity> rows{};
  const auto address_of = [&](std::uint32_t i) { return request.address + kAddressStep * i; };
  for (std::uint32_t i = 0; i < request.quantity; ++i) {
    rows[i] = map_.find_readable(address_of(i));
    if (rows[i] == nullptr) return Unexpected(kAddressNotCorrect);
    inverter_needed |= rows[i]->item != Item::kConstant;
  }
  if (inverter_needed && !drive_.ready()) return Unexpected(kNotReady);
  std::array<std::uint16_t, modbus::kMaxReadQuantity> values{};
  for (std::uint32_t i = 0; i < request.quantity; ++i) {
    const auto value = read_item(*rows[i], rows[i]->index_at(address_of(i)));
    if (!value) return Unexpected(value.error());
    values[i] = *value;
  }
  return modbus::emit_read_answer(std::span(values).first(request.quantity));
}

Result<std::uint16_t, Exception> ModbusUnit::read_item(const RegisterRow& row, std::uint16_t index) const {
  switch (row.item) {
    case Item::kConstant: return row.constant;
    case Item::kStatus: return raw_status(drive_.status());
    case Item::kAlarms: return raw_alarm_pair(drive_.alarm_history(), index);
    case Item::kMonitor: {
      const auto value = drive_.read_monitor(index);
      if (!value) return Unexpected(exception_of(value.error()));
      return *value;
    }
    case Item::kRpm: {
      const auto value = drive_.read_monitor(index);
      if (!value) return Unexpected(exception_of(value.error()));
      return rpm_of_raw_frequency(*value, poles_of(drive_));
    }
    case Item::kParameter: {
      const auto value = drive_.read_parameter({index, 0});
      if (!value) return Unexpected(exception_of(value.error()));
      // Unspecified: a parameter whose value needs more than one word (Pr.37 above 65.535) reads as the largest word.
      return static_cast<std::uint16_t>(std::min(*value, kMaxWord));
    }
    default: return Unexpected(kAddressNotCorrect);
  }
}

Result<port::WriteRequest, Exception> ModbusUnit::translate(const modbus::WriteSingleRegister& request) const {
  using Kind = port::WriteRequest::Kind;
  const RegisterRow* row = map_.find_writable(request.address);
  if (row == nullptr) {
    // The manual has no code for a write to a read-only address: "error in the writing" fits, the address exists.
    return Unexpected(map_.find_readable(request.address) != nullptr ? kErrorInTheWriting : kAddressNotCorrect);
  }
  if (request.value < row->min || request.value > row->max) return Unexpected(kDataNotCorrect);
  if (!drive_.ready()) return Unexpected(kNotReady);
  port::WriteRequest write;
  write.value = request.value;
  switch (row->item) {
    case Item::kParameter:
      write.kind = Kind::kParameter;
      write.parameter = {row->index_at(request.address), 0};
      return write;
    case Item::kCommand:
      write.kind = Kind::kCommand;
      write.terminals = terminals_of_command(request.value);
      return write;
    case Item::kFrequency: write.kind = Kind::kFrequency; return write;
    case Item::kRpm:
      write.kind = Kind::kFrequency;
      write.value = raw_frequency_of_rpm(request.value, poles_of(drive_));
      if (write.value > kMaxWord) return Unexpected(kDataNotCorrect);
      return write;
    case Item::kAnalog: write.kind = Kind::kAnalogReference; return write;
    case Item::kClearAlarms: write.kind = Kind::kClearAlarmHistory; return write;
    case Item::kReset: write.kind = Kind::kResetInverter; return write;
    case Item::kNetworkMode: write.kind = Kind::kOperationMode; return write;
    default: return Unexpected(kErrorInTheWriting);
  }
}

void ModbusUnit::write(Instant now, const modbus::WriteSingleRegister& request,
                       std::optional<modbus::ClientId> client) {
  // A decision that is there but not collected yet does not count as a write in progress.
  collect_outcome();
  const auto refuse = [&](Exception code) {
    if (client) {
      answer(*client, modbus::emit_exception(function_code(modbus::Function::kWriteSingleRegister), code));
    }
  };
  const auto translated = translate(request);
  if (!translated) return refuse(translated.error());
  if (state_.pending) return refuse(kOverlap);
  const port::WriteOutcome posted = drive_.post_write(now, *translated);
  if (!posted) return refuse(exception_of(posted.error()));
  if (client && state_.immediate_answer) {
    answer(*client, modbus::emit(modbus::Request{request}));
    client.reset();
  }
  state_.pending = PendingWrite{request, translated->kind, now, client};
}

void ModbusUnit::collect_outcome() {
  if (!state_.pending) return;
  std::optional<port::WriteOutcome> outcome = drive_.take_outcome();
  if (!outcome && drive_.write_pending()) return;
  using Kind = port::WriteRequest::Kind;
  const PendingWrite write = *std::exchange(state_.pending, std::nullopt);
  if (!outcome) {
    // The inverter restarted and its mailbox is empty: for a reset that is the success.
    outcome = write.kind == Kind::kResetInverter ? port::WriteOutcome{}
                                                 : port::WriteOutcome{Unexpected(port::Refusal::kNotReady)};
  }
  if (write.kind == Kind::kOperationMode && *outcome) state_.mode_asked_at = write.posted_at;
  if (write.client) answer(*write.client, write_answer(write.request, *outcome));
}

void ModbusUnit::answer(modbus::ClientId client, Bytes pdu) {
  forget(client);
  state_.answers.push_back({client, std::move(pdu)});
}

std::optional<Bytes> ModbusUnit::poll_answer(Instant /*now*/, modbus::ClientId client) {
  collect_outcome();
  const auto found =
      std::find_if(state_.answers.begin(), state_.answers.end(), [&](const Answer& a) { return a.client == client; });
  if (found == state_.answers.end()) return std::nullopt;
  Bytes pdu = std::move(found->pdu);
  state_.answers.erase(found);
  return pdu;
}

bool ModbusUnit::has_request(modbus::ClientId client) const {
  return (state_.pending && state_.pending->client == client) ||
         std::any_of(state_.answers.begin(), state_.answers.end(), [&](const Answer& a) { return a.client == client; });
}

void ModbusUnit::forget(modbus::ClientId client) {
  std::erase_if(state_.answers, [&](const Answer& a) { return a.client == client; });
  if (state_.pending && state_.pending->client == client) state_.pending->client.reset();
}

}  // namespace vinv::boards::oi_fr_e5nco
