// Alarms of the Mitsubishi families: from trips and causes to name, history, retry and reset. Typical for the family.
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"
#include "motor_model/inverter/mitsubishi/reset_selection.hpp"
#include "sim/base/check.hpp"

namespace vinv::inverter::mitsubishi {
namespace {

using drive::RunState;
using drive::TripKind;

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char text[240];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

}  // namespace

std::string MitsubishiInverter::trip_cause(const AlarmRow& row, const drive::Trip& trip) const {
  // Comparator events lie in the tick that has just been integrated.
  const bool comparator = trip.after.count() > 0;
  const double at_s = to_seconds(comparator ? now_ - kControlPeriod + trip.after : now_);
  const double output_hz = std::abs(trip.output_frequency_hz);
  const double inertia = plant_.config().machine.inertia_kg_m2 + plant_.load().inertia_kg_m2;
  const drive::DriveSettings& s = settings_;
  const plant::PlantMeasurements& m = plant_.measurements();

  std::string motion;
  switch (trip.state) {
    case RunState::kAccelerating:
      motion = format("accelerating in %.4g s with %.4g kg m2", s.acceleration_s, inertia);
      break;
    case RunState::kDecelerating:
      motion = format("decelerating in %.4g s with %.4g kg m2", s.deceleration_s, inertia);
      break;
    case RunState::kDcBraking: motion = "in DC injection braking"; break;
    case RunState::kConstant: motion = format("at constant speed with %.4g Nm of load", m.load_torque_nm); break;
    default: motion = "with the output off"; break;
  }
  const std::string when = format("at %.3f s, output %.1f Hz, ", at_s, output_hz) + motion;
  switch (trip.kind) {
    case TripKind::kOverVoltageAcceleration:
    case TripKind::kOverVoltageConstant:
    case TripKind::kOverVoltageDeceleration: return format("DC link %.0f V ", trip.value) + when;
    case TripKind::kOverCurrentAcceleration:
    case TripKind::kOverCurrentConstant:
    case TripKind::kOverCurrentDeceleration:
      return format("output current %.1f A peak (level %.1f A) ", trip.value,
                    trip.level > 0 ? trip.level : plant_.config().comparators.over_current_a_peak) +
             when;
    case TripKind::kInverterOverload:
      return format("output current %.2f A, rated %.2f A, for too long, ", m.output_current_a_rms,
                    model_.rated_current_a_rms) +
             when;
    case TripKind::kMotorOverload:
      return format("output current %.2f A, motor thermal set to %.2f A, for too long, ", m.output_current_a_rms,
                    s.electronic_thermal_a_rms) +
             when;
    case TripKind::kHeatSink:
      return format("heat sink %.0f degC (level %.0f degC) ", trip.value, s.heat_sink_trip_c) + when;
    case TripKind::kStallPrevention:
      if (s.vector.on) {
        return format("torque %.0f %% (level %.0f %%) for too long below %.2f Hz, %.4g Nm of load%s ", trip.value,
                      trip.level, s.vector.stall_hz, m.load_torque_nm,
                      plant_.shaft_locked() ? ", shaft locked, " : ",") +
               when;
      }
      return format("stall prevention at %.0f %% with %.2f A and %.4g Nm of load%s ", s.stall_level_percent,
                    m.output_current_a_rms, m.load_torque_nm, plant_.shaft_locked() ? ", shaft locked, " : ",") +
             when;
    case TripKind::kBrakeTransistor:
    case TripKind::kEarthFault:
    case TripKind::kOutputPhaseLoss:
    case TripKind::kExternalThermal: break;
  }
  return row.cause + " " + when;
}

void MitsubishiInverter::raise_trip(const drive::Trip& trip) {
  const auto row = data_.alarms.by_trip(trip.kind);
  VINV_CHECK(row.has_value());
  raise(*row, trip_cause(data_.alarms.rows()[*row], trip));
}

void MitsubishiInverter::raise(std::string_view name, std::string cause) {
  const auto row = data_.alarms.by_name(name);
  VINV_CHECK(row.has_value());
  raise(*row, std::move(cause));
}

void MitsubishiInverter::raise(std::size_t row, std::string cause) {
  if (v_.alarm.row) return;  // the first one stays until it is reset
  core_.force_trip();
  const AlarmRow& alarm = data_.alarms.rows()[row];
  const int limit = Retry::limit(store_.integer(pr::kRetries));
  const bool in_sequence = v_.retry.phase == Retry::Phase::kWatching;
  if (limit > 0 && alarm.retried_with(store_.integer(pr::kRetrySelection))) {
    if (!in_sequence) v_.retry.used = 0;
    if (v_.retry.used < limit) {
      // Only the first alarm of a sequence goes into the history.
      if (!in_sequence) {
        push_alarm(record_.alarms, alarm.code);
        eeprom_changed_ = true;
      }
      ++v_.retry.used;
      v_.retry.phase = Retry::Phase::kWaiting;
      v_.retry.due = now_ + seconds_to_duration(store_.value(pr::kRetryWait));
      v_.alarm = {row, std::move(cause)};
      return;
    }
    v_.retry = {};
    const auto used_up = data_.alarms.by_name("E.RET");
    VINV_CHECK(used_up.has_value());
    push_alarm(record_.alarms, data_.alarms.rows()[*used_up].code);
    eeprom_changed_ = true;
    v_.alarm = {*used_up, format("%d retries used up; the last alarm was %s: ", limit, alarm.name.c_str()) + cause};
    return;
  }
  v_.retry = {};
  push_alarm(record_.alarms, alarm.code);
  eeprom_changed_ = true;
  v_.alarm = {row, std::move(cause)};
}

bool MitsubishiInverter::alarm_visible() const {
  return v_.retry.phase != Retry::Phase::kWaiting || Retry::alarm_output(store_.integer(pr::kRetries));
}

void MitsubishiInverter::follow_retry() {
  if (v_.retry.phase == Retry::Phase::kIdle || now_ < v_.retry.due) return;
  if (v_.retry.phase == Retry::Phase::kWaiting) {
    v_.alarm = {};
    core_.reset(drive::DriveCore::Accumulators::kKeep);
    v_.retry.phase = Retry::Phase::kWatching;
    v_.retry.due = now_ + Retry::kSuccessAfterWaits * seconds_to_duration(store_.value(pr::kRetryWait));
    return;
  }
  v_.retry = {};
  ++record_.retry_count;
  eeprom_changed_ = true;
}

// Causes outside the control core; each trips as long as it is there.
void MitsubishiInverter::follow_causes() {
  if (now_ < v_.ready_at) return;
  follow_communication();
  if (v_.alarm.row) return;
  const int reset_selection = store_.integer(pr::kResetSelection);
  if (causes_.pu_disconnected && ResetSelection::of(reset_selection).panel_supervised) {
    raise("E.PUE", format("operation panel disconnected at %.3f s with Pr.75 = %d", to_seconds(now_), reset_selection));
  }
}

bool MitsubishiInverter::reset_accepted() const {
  if (v_.alarm.row) return data_.alarms.rows()[*v_.alarm.row].reset == ResetRule::kAny;
  return !ResetSelection::of(store_.integer(pr::kResetSelection)).only_with_alarm;
}

void MitsubishiInverter::begin_reset() {
  // As after power-on: RAM from EEPROM, mode by Pr.340. A reset clears the thermal accumulators too, which is why the
  // family warns of needless resets.
  if (v_.tuning.running()) v_.tuning.abort();
  Volatile fresh;
  fresh.mailbox = v_.mailbox;
  fresh.network.communication_lost = v_.network.communication_lost;
  fresh.network.option_failed = v_.network.option_failed;
  fresh.storage_failures = v_.storage_failures;
  fresh.current_monitor = v_.current_monitor;
  fresh.operating_s = v_.operating_s;
  core_.force_trip();
  core_.reset(drive::DriveCore::Accumulators::kClear);
  v_ = fresh;
  start_volatile();
  v_.ready_at = now_ + kResetTime;
}

}  // namespace vinv::inverter::mitsubishi
