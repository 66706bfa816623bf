#include "motor_model/inverter/alarm_table.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "motor_model/inverter/csv.hpp"

namespace vinv::inverter {
namespace {

using drive::TripKind;

constexpr std::array<std::pair<std::string_view, TripKind>, 14> kTripNames{{
    {"over_current_acceleration", TripKind::kOverCurrentAcceleration},
    {"over_current_constant", TripKind::kOverCurrentConstant},
    {"over_current_deceleration", TripKind::kOverCurrentDeceleration},
    {"over_voltage_acceleration", TripKind::kOverVoltageAcceleration},
    {"over_voltage_constant", TripKind::kOverVoltageConstant},
    {"over_voltage_deceleration", TripKind::kOverVoltageDeceleration},
    {"inverter_overload", TripKind::kInverterOverload},
    {"motor_overload", TripKind::kMotorOverload},
    {"heat_sink", TripKind::kHeatSink},
    {"stall_prevention", TripKind::kStallPrevention},
    {"brake_transistor", TripKind::kBrakeTransistor},
    {"earth_fault", TripKind::kEarthFault},
    {"output_phase_loss", TripKind::kOutputPhaseLoss},
    {"external_thermal", TripKind::kExternalThermal},
}};

}  // namespace

Result<AlarmTable, std::string> AlarmTable::load(std::string_view csv) {
  const auto table = parse_csv(csv);
  if (!table) return Unexpected(table.error());
  CsvReader in(*table);
  AlarmTable out;
  for (std::size_t i = 0; i < in.size() && !in.error(); ++i) {
    in.select(i);
    AlarmRow row;
    row.name = in.text("name");
    const long code = in.integer("data_code_hex", 16);
    if (code < 0 || code > 255) in.fail("data_code_hex", "must be 00 to FF");
    row.code = static_cast<std::uint8_t>(code);
    if (table->column("canopen_emcy_code_hex")) {
      row.emergency_code = static_cast<std::uint16_t>(in.integer("canopen_emcy_code_hex", 16));
      row.error_register = static_cast<std::uint8_t>(in.integer("error_register_1001h_value_hex", 16));
    }
    row.display = table->column("display") ? in.text("display") : row.name;
    row.cause = in.text("cause");
    row.source = in.text("source");
    row.confidence = in.text("confidence");
    if (row.name == "none") {
      if (code != 0) in.fail("data_code_hex", "no alarm must be 00");
      continue;
    }
    if (const std::string& trip = in.text("trip_kind"); !trip.empty()) {
      const auto* known =
          std::find_if(kTripNames.begin(), kTripNames.end(), [&](const auto& n) { return n.first == trip; });
      if (known == kTripNames.end()) {
        in.fail("trip_kind", "'" + trip + "' is not a trip of the control core");
      } else {
        row.trip_kind = known->second;
      }
    }
    for (std::string_view setting : split(in.text("retry_pr65"), '|')) {
      if (setting.size() != 1 || setting[0] < '0' || setting[0] > '9') {
        in.fail("retry_pr65", "must be digits with | between");
      } else {
        row.retry_settings |= 1u << (setting[0] - '0');
      }
    }
    const std::string& reset = in.text("reset");
    if (reset == "power") {
      row.reset = ResetRule::kPowerCycle;
    } else if (reset != "any") {
      in.fail("reset", "must be any or power");
    }
    if (code == 0 || out.by_code(row.code) || out.by_name(row.name))
      in.fail("name", row.name + ": name or code is there twice or 0");
    out.rows_.push_back(std::move(row));
  }
  if (in.error()) return Unexpected(*in.error());
  for (const auto& [name, kind] : kTripNames) {
    if (!out.by_trip(kind)) return Unexpected("no alarm for the trip " + std::string(name));
  }
  return out;
}

std::optional<std::size_t> AlarmTable::by_name(std::string_view name) const {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].name == name) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> AlarmTable::by_code(std::uint8_t code) const {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].code == code) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> AlarmTable::by_trip(drive::TripKind kind) const {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].trip_kind == kind) return i;
  }
  return std::nullopt;
}

void push_alarm(port::AlarmHistory& history, std::uint8_t code) {
  std::copy_backward(history.begin(), history.end() - 1, history.end());
  history[0] = code;
}

}  // namespace vinv::inverter
