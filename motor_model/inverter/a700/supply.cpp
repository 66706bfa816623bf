// Supply and power of the FR-A700: commercial switch-over (Pr.135-139, 159), deceleration at a power failure
// (Pr.261-266, 294), regeneration avoidance (Pr.882-886, 665), energy saving (Pr.60, 891-899), load torque high-speed
// frequency and stop-on-contact (Pr.270-276). Typical for the family.
#include "motor_model/inverter/a700/supply.hpp"

#include <algorithm>
#include <cmath>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {

using drive::RunDirection;
using drive::RunState;
using port::OperationMode;

namespace {

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kPhaseLost_s = 1;       // an input phase must be missing this long
constexpr double kGoodSupply = 0.8;      // of the nominal voltage
constexpr double kFailureBegins = 0.85;  // of the nominal DC link voltage
constexpr double kFailureHeld = 1.1;     // likewise
constexpr double kContactMost_hz = 30;
constexpr double kFilterUnit_s = 0.00075;  // of Pr.274
constexpr double kHours_a = 24 * 365;

}  // namespace

// --- commercial supply ---

bool A700Inverter::drives_contactors() const { return store_.integer(pr::kCommercialSequence) == 1; }

bool A700Inverter::has_output(OutputSignal signal) const {
  return std::any_of(personality_.outputs.begin(), personality_.outputs.end(),
                     [&](const mitsubishi::OutputTerminal& output) {
                       const auto function = data_.signals.output(store_.integer(output.function));
                       return function && function->signal == signal;
                     });
}

// A contactor is there where a terminal has its signal: without MC3 the motor is wired to the inverter.
void A700Inverter::follow_contactors(drive::DriveCommand& command) {
  Supply& s = s_.supply;
  if (!drives_contactors()) {
    if (s.drives_contactors) plant_.set_motor_source(plant::MotorSource::kInverter);
    s.drives_contactors = false;
    return;
  }
  const auto set = [this](unsigned number) {
    return store_.is_9999(number) ? std::nullopt : std::optional(store_.value(number));
  };
  if (command.direction != RunDirection::kStop) s.last_direction = static_cast<double>(command.direction);
  const std::string alarm = alarm_name();
  s.contactors.step(kPeriod_s,
                    {.interlock_s = store_.value(pr::kInterlockTime),
                     .start_wait_s = store_.value(pr::kStartWait),
                     .catch_wait_s = settings_.restart_coast_s,
                     .mains_at_alarm = store_.integer(pr::kMainsAtAlarm) == 1,
                     .automatic_hz = set(pr::kAutomaticSwitchover),
                     .back_below_hz = set(pr::kSwitchBackRange)},
                    {.enabled = s.operation_enabled,
                     .inverter_wanted = s.inverter_wanted,
                     .start_on = command.direction != RunDirection::kStop,
                     .alarm = !alarm.empty(),
                     .alarm_keeps_off = alarm == "E.OHT" || alarm == "E.CPU",
                     .running = running(),
                     .output_hz = std::abs(core_.outputs().output_frequency_hz),
                     .set_hz = v_.published.set_frequency_hz});
  s.drives_contactors = true;
  const bool mains = s.contactors.mc2() && has_output(OutputSignal::kMc2);
  const bool open = !s.contactors.mc3() && has_output(OutputSignal::kMc3);
  plant_.set_motor_source(mains  ? plant::MotorSource::kMains
                          : open ? plant::MotorSource::kOpen
                                 : plant::MotorSource::kInverter);
  if (!s.contactors.output_permitted()) {
    command.direction = RunDirection::kStop;
    command.output_stop = true;
    return;
  }
  if (!s.contactors.catches() || !settings_.restart_enabled) return;
  command.catch_motor = true;
  if (s.contactors.catches_to_stop()) {
    // The start signal has gone on the mains: the inverter takes the motor over to bring it to a stop.
    command.direction = s.last_direction < 0 ? RunDirection::kReverse : RunDirection::kForward;
    command.set_frequency_hz = std::max(command.set_frequency_hz, settings_.start_frequency_hz);
  }
}

// Without control supply the contactors fall off.
void A700Inverter::open_contactors() {
  if (!s_.supply.drives_contactors) return;
  if (has_output(OutputSignal::kMc3)) {
    plant_.set_motor_source(plant::MotorSource::kOpen);
  } else if (plant_.motor_source() == plant::MotorSource::kMains) {
    plant_.set_motor_source(plant::MotorSource::kInverter);
  }
}

// --- power failure ---

bool A700Inverter::supply_good() const {
  const auto absent = std::count(mains_.phase_present.begin(), mains_.phase_present.end(), false);
  return breaker_ && absent <= 1 && mains_.voltage_v_rms >= kGoodSupply * nominal_mains_v_rms_;
}

void A700Inverter::follow_power_failure(drive::DriveCommand& command, const drive::Sensors& sensors) {
  const int selection = store_.integer(pr::kPowerFailureStop);
  const auto absent = std::count(mains_.phase_present.begin(), mains_.phase_present.end(), false);
  const bool phase_lost = s_.supply.phase_lost.step(
      kPeriod_s, running() && absent == 1 && store_.integer(pr::kInputPhaseLoss) == 1, kPhaseLost_s);
  drive::PowerFailureStop::Settings settings;
  settings.resumes = selection % 10 == 2;
  // A restart after the failure takes the place of a stop to the end.
  settings.on = selection != 0 && (settings.resumes || !settings_.restart_enabled) && !v_.alarm.row;
  settings.avoids_under_voltage = selection >= 10;
  settings.subtracted_hz = store_.value(pr::kSubtractedFrequency);
  settings.subtracted_from_hz = mitsubishi::or_else(store_, pr::kSubtractionStart, 0);
  settings.begins_below_v = kFailureBegins * settings_.nominal_dc_link_v;
  settings.held_above_v = kFailureHeld * settings_.nominal_dc_link_v;
  settings.gain = store_.value(pr::kAvoidanceGain) / 100;
  const auto decision = s_.supply.failure_stop.step(kPeriod_s, settings,
                                                    {.supply_good = supply_good(),
                                                     .phase_lost = phase_lost,
                                                     .running = running(),
                                                     .start_on = command.direction != RunDirection::kStop,
                                                     .output_hz = std::abs(core_.outputs().output_frequency_hz),
                                                     .dc_link_v = sensors.dc_link_v});
  command.lower_by_hz = decision.lower_by_hz;
  command.hold_deceleration = decision.hold;
  command.raise_by_hz = decision.raise_by_hz;
  if (s_.supply.failure_stop.active()) command.direction = RunDirection::kStop;
}

// --- regeneration ---

void A700Inverter::follow_regeneration(drive::DriveCommand& command, const drive::Sensors& sensors) {
  const int selection = store_.integer(pr::kRegenerationAvoidance);
  const RunState state = core_.outputs().state;
  drive::RegenerationAvoidance::Settings settings;
  settings.on = running() && (selection == 1 || (selection == 2 && state == RunState::kConstant));
  settings.level_v = store_.value(pr::kRegenerationLevel);
  settings.sensitivity = store_.integer(pr::kRegenerationSensitivity);
  settings.most_hz = mitsubishi::or_else(store_, pr::kRegenerationLimit, settings_.max_frequency_hz);
  settings.voltage_gain = store_.value(pr::kRegenerationVoltageGain) / 100;
  settings.frequency_gain = store_.value(pr::kRegenerationFrequencyGain) / 100;
  const auto decision =
      s_.supply.regeneration.step(kPeriod_s, settings, state == RunState::kDecelerating, sensors.dc_link_v);
  command.raise_by_hz += decision.raise_hz;
  command.hold_deceleration = command.hold_deceleration || decision.hold;
  command.link_overload = decision.active;
}

// --- energy saving ---

void A700Inverter::follow_saving(drive::DriveCommand& command) {
  const drive::DriveOutputs& out = core_.outputs();
  const plant::PlantMeasurements m = measured();
  const bool on = store_.integer(pr::kEnergySaving) == 4 && !vector_control() && out.state == RunState::kConstant &&
                  out.up_to_frequency && m.output_current_a_rms < model_.rated_current_a_rms;
  command.voltage_factor = s_.supply.voltage_saving.step(kPeriod_s, on, m.output_power_w);

  SavingMonitor::Settings settings;
  settings.motor_kw = store_.value(pr::kMotorReference);
  settings.load = store_.value(pr::kLoadFactor) / 100;
  settings.throttling = static_cast<Throttling>(store_.integer(pr::kCommercialControl));
  settings.rate_of_capacity = store_.integer(pr::kSavingReference) == 1;
  if (!store_.is_9999(pr::kAverageTime)) {
    constexpr double kHalfHour_s = 1800;
    const double hours = store_.value(pr::kAverageTime);
    settings.average_s = hours > 0 ? hours * 3600 : kHalfHour_s;
  }
  settings.held = record_.counters[kSavingMode] == 1;
  // Nothing is saved while direct current brakes the motor, or without a motor.
  const bool running = out.running && m.output_current_a_rms > 0;
  s_.supply.saving.step(
      kPeriod_s, settings,
      {running, settings_.base_frequency_hz > 0 ? std::abs(out.output_frequency_hz) / settings_.base_frequency_hz : 1,
       m.input_power_w / 1000});
}

double A700Inverter::saving_value() const {
  const SavingMonitor& s = s_.supply.saving;
  const bool averages = !store_.is_9999(pr::kAverageTime);
  if (averages && !store_.is_9999(pr::kUnitCost)) return s.average_kw() * store_.value(pr::kUnitCost);
  if (!store_.is_9999(pr::kSavingReference)) return averages ? s.average_rate_percent() : s.rate_percent();
  return averages ? s.average_kw() : s.saving_kw();
}

double A700Inverter::saved_value() const {
  const SavingMonitor& s = s_.supply.saving;
  const double kwh = (static_cast<double>(record_.counters[kSavedJoule]) / 1000 + s.saved_kws()) / 3600;
  double value = kwh;
  if (!store_.is_9999(pr::kOperationRate)) {
    const double hours = (static_cast<double>(record_.counters[kSavingSeconds]) + s.counted_s()) / 3600;
    value = hours > 0 ? kwh / hours * kHours_a * store_.value(pr::kOperationRate) / 100 : 0;
  }
  if (!store_.is_9999(pr::kUnitCost)) value *= store_.value(pr::kUnitCost);
  if (!store_.is_9999(pr::kMonitorShift)) value /= std::pow(10, store_.integer(pr::kMonitorShift));
  return std::min(std::floor(value), record_.counters[kSavingMode] == 10 ? 9999.0 : 65535.0);
}

// Currents and powers of large models are in tenths; monitor 50 is what Pr.895 to Pr.897 make of it.
int A700Inverter::monitor_decimals(const MonitorRow& row) const {
  if (row.code == 50) {
    const bool percent =
        !store_.is_9999(pr::kSavingReference) && (store_.is_9999(pr::kAverageTime) || store_.is_9999(pr::kUnitCost));
    return percent || large() ? 1 : 2;
  }
  return large() && (row.unit == "A" || row.unit == "kW") ? row.decimals - 1 : row.decimals;
}

// --- what follows the load ---

// Stop-on-contact: RL and RT together, under vector control.
bool A700Inverter::on_contact(InputSignals signals) const {
  return store_.integer(pr::kContactAndLoadSpeed) % 2 == 1 && vector_control() && v_.mode != OperationMode::kPu &&
         signals.has(InputSignal::kRl) && signals.has(InputSignal::kRt);
}

std::optional<double> A700Inverter::load_speed_frequency(const mitsubishi::Inputs& inputs) {
  if (on_contact(inputs.signals)) return std::min(store_.value(pr::kSpeedLow), kContactMost_hz);
  Supply& s = s_.supply;
  if (!running()) {
    s.load_speed.reset();
    const bool external = v_.mode == OperationMode::kExternal || v_.mode == OperationMode::kCombined2;
    s.by_load = store_.integer(pr::kContactAndLoadSpeed) >= 2 && external && inputs.signals.has(InputSignal::kX19) &&
                inputs.direction != RunDirection::kStop && !inputs.signals.has(InputSignal::kX14);
  }
  if (!s.by_load) return std::nullopt;
  drive::LoadSpeed::Settings settings;
  settings.high_hz = store_.value(pr::kSpeedHigh);
  settings.middle_hz = store_.value(pr::kSpeedMiddle);
  settings.high_current_a = store_.value(pr::kHighSpeedCurrent) / 100 * model_.rated_current_a_rms;
  settings.middle_current_a = store_.value(pr::kMiddleSpeedCurrent) / 100 * model_.rated_current_a_rms;
  settings.range_top_hz = mitsubishi::or_else(store_, pr::kAveragingRange, settings.middle_hz);
  settings.filter_s = store_.value(pr::kAveragingFilter) * kFilterUnit_s;
  return s.load_speed.step(kPeriod_s, settings, core_.outputs().output_frequency_hz, measured().output_current_a_rms);
}

}  // namespace vinv::inverter::a700
