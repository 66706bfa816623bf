// What the FR-A700 shows: monitors (FR-A7NE manual 7.2.1, 7.13), output signals, meter AM, and its panel.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motor_model/inverter/a700/alarm_code.hpp"
#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {

using drive::RunDirection;
using port::OperationMode;
using port::Refusal;

namespace {

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kMeterFullScale_v = 10;
constexpr double kPreAlarm = 0.85;  // of a protection's level
constexpr double kJoulePerKwh = 3.6e6;
constexpr std::int64_t kHour_s = 3600;

}  // namespace

port::SpeedConversion A700Inverter::speed_conversion() const {
  return {static_cast<std::uint32_t>(store_.integer(pr::kSpeedDisplay)),
          static_cast<std::uint32_t>(store_.integer(pr::kPoles)), store_.value(pr::kSpeedReference)};
}

// As the wires stand (FR-A7NE manual 7.6, input terminal status).
std::uint16_t A700Inverter::terminal_bits() const {
  using port::NetTerminal;
  static constexpr NetTerminal kOrder[] = {NetTerminal::kStf, NetTerminal::kStr,  NetTerminal::kAu,  NetTerminal::kRt,
                                           NetTerminal::kRl,  NetTerminal::kRm,   NetTerminal::kRh,  NetTerminal::kJog,
                                           NetTerminal::kMrs, NetTerminal::kStop, NetTerminal::kRes, NetTerminal::kCs};
  unsigned bits = 0;
  for (unsigned i = 0; i < std::size(kOrder); ++i) bits |= wiring_.closed.has(kOrder[i]) ? 1u << i : 0u;
  return static_cast<std::uint16_t>(bits);
}

bool A700Inverter::output_on(std::size_t terminal, OutputSignal signal) const {
  // Pr.76: terminals SU, IPF, OL and FU are bits 3 to 0 of the alarm's code; 2 while there is an alarm only. The logic
  // of their functions does not turn them.
  const int coded = store_.integer(pr::kAlarmCode);
  if (terminal >= 1 && terminal <= 4 && (coded == 1 || (coded == 2 && v_.published.status.alarm))) {
    const auto function = data_.signals.output(store_.integer(personality_.outputs[terminal].function));
    const bool bit = (alarm_code(active_alarm()) >> (4 - terminal) & 1) != 0;
    return bit != (function && function->inverted);
  }
  // Remote output: one bit of Pr.496 for each terminal.
  if (signal == OutputSignal::kRem) return (store_.integer(pr::kRemoteOutput1) >> terminal & 1) != 0;
  return MitsubishiInverter::output_on(terminal, signal);
}

double A700Inverter::monitor_value(unsigned code) const {
  const plant::PlantMeasurements m = measured();
  const drive::DriveOutputs& out = core_.outputs();
  const mitsubishi::Published& p = v_.published;
  const plant::MachineParameters& machine = plant_.config().machine;
  const double current = p.output_current / 100.0;
  const double rated_torque =
      machine.rated_speed_rpm > 0 ? machine.rated_power_w / (machine.rated_speed_rpm * M_PI / 30) : 0;
  const double torque_percent = rated_torque > 0 ? m.torque_nm / rated_torque * 100 : 0;
  const double active = std::abs(m.active_current_a_rms);
  const double rated_active = std::sqrt(std::max(
      0.01, std::pow(settings_.motor_rated_current_a_rms, 2) - std::pow(settings_.motor_no_load_current_a_rms, 2)));
  const auto hours = [](std::int64_t seconds) { return static_cast<double>(seconds / kHour_s % 65536); };
  switch (code) {
    case 1: return p.output_frequency / 100.0;
    case 2: return current;
    case 3: return p.output_voltage / 10.0;
    case 5: return p.set_frequency_hz;
    case 6: {
      const auto conversion = speed_conversion();
      return conversion.in_unit(p.output_frequency / 100.0, conversion.running_unit());
    }
    case 7: return vector_control() && m.gates_on ? std::abs(torque_percent) : 0;
    case 8: return m.dc_link_v;
    case 9: return out.brake_duty_fraction * 100;
    case 10: return out.motor_thermal_fraction * 100;
    case 11: return s_.current_peak_a;
    case 12: return s_.dc_link_peak_v;
    // Of the inverter: not what a motor on the commercial supply takes.
    case 13: return plant_.motor_source() == plant::MotorSource::kMains ? 0 : std::max(0.0, m.input_power_w) / 1000;
    case 14: return m.gates_on ? std::max(0.0, m.output_power_w) / 1000 : 0;
    case 15: return terminal_bits();
    case 16: {
      unsigned bits = 0;
      for (unsigned i = 0; i < personality_.outputs.size(); ++i) {
        const auto function = data_.signals.output(store_.integer(personality_.outputs[i].function));
        bits |= function && output_on(i, function->signal) != function->inverted ? 1u << i : 0u;
      }
      return bits;
    }
    case 17:
      return store_.value(pr::kCurrentFullScale) > 0 && m.gates_on ? active / store_.value(pr::kCurrentFullScale) * 100
                                                                   : 0;
    case 18: return m.gates_on ? std::sqrt(std::max(0.0, current * current - active * active)) : 0;
    case 20: return hours(record_.counters[kEnergizedSeconds] + static_cast<std::int64_t>(s_.energized_s));
    case 23: return hours(record_.operating_seconds + static_cast<std::int64_t>(v_.operating_s));
    case 24: return current / model_.rated_current_a_rms * 100;
    case 25: {
      const double kwh = (static_cast<double>(record_.counters[kEnergyJoule]) + s_.energy_j) / kJoulePerKwh;
      const int shift = store_.is_9999(pr::kMonitorShift) ? 0 : store_.integer(pr::kMonitorShift);
      // 9999 begins anew at the end, a shift stays there, and Pr.170 = 10 ends at 9999.
      const double shifted = std::floor(kwh / std::pow(10, shift));
      if (record_.counters[kEnergyLimit] == 10) return std::min(shifted, 9999.0);
      return store_.is_9999(pr::kMonitorShift) ? std::fmod(shifted, 65536) : std::min(shifted, 65535.0);
    }
    case 32:
      return out.gates_on && settings_.vector.on ? std::abs(out.torque_command_percent)
             : vector_control() && m.gates_on    ? std::abs(torque_percent)
                                                 : 0;
    case 33: return vector_control() && m.gates_on ? active / rated_active * 100 : 0;
    case 34: return vector_control() && m.gates_on ? std::max(0.0, m.shaft_power_w) / 1000 : 0;
    case 50: return saving_value();
    case 51: return saved_value();
    case 52: return v_.pid_active ? s_.pid_set_point : 0;
    case 53: return v_.pid_active ? s_.pid_measured : 0;
    case 54: return v_.pid_active ? s_.pid_set_point - s_.pid_measured : 0;
    default: return 0;  // encoder and digital options are not fitted
  }
}

Result<std::uint16_t, Refusal> A700Inverter::read_monitor(unsigned number) const {
  const auto& rows = monitors();
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const MonitorRow& r) { return r.code == number; });
  if (row == rows.end()) return Unexpected(Refusal::kNoSuchItem);
  const double scaled = (control_alive_ ? monitor_value(number) : 0) * std::pow(10, monitor_decimals(*row));
  // The PID deviation is signed, in two's complement; nothing else is below 0.
  return static_cast<std::uint16_t>(std::clamp(std::lround(scaled), number == 54 ? -32768L : 0L, 65535L));
}

// Full scale of a meter: Pr.55, 56 and 866, else what the monitor can reach.
double A700Inverter::meter_share(unsigned code) const {
  double full = 100;
  switch (code) {
    case 1:
    case 5: full = store_.value(pr::kFrequencyFullScale); break;
    case 6: {
      const auto conversion = speed_conversion();
      full = conversion.in_unit(store_.value(pr::kFrequencyFullScale), conversion.running_unit());
      break;
    }
    case 2:
    case 11:
    case 18: full = store_.value(pr::kCurrentFullScale); break;
    case 3:
    case 8:
    case 12: full = 2 * model_.voltage_class_v; break;
    case 7:
    case 32:
    case 33: full = store_.value(pr::kTorqueFullScale); break;
    case 9: full = settings_.chopper_duty_percent; break;
    case 13:
    case 14:
    case 34: full = 2 * model_.motor_kw; break;
    case 50: full = store_.value(pr::kMotorReference); break;
    case 21: return 1;  // always full scale, to adjust a meter
    case 24: full = 200; break;
    default: break;
  }
  return full > 0 ? monitor_value(code) / full : 0;
}

void A700Inverter::publish_family(OutputSignals& o) {
  mitsubishi::Published& p = v_.published;
  const drive::DriveOutputs& out = core_.outputs();
  const plant::PlantMeasurements m = measured();
  const double hz = std::abs(out.output_frequency_hz);
  const double speed_hz = std::abs(plant_.config().machine.pole_pairs * m.speed_rpm / 60);
  const bool started = v_.direction != RunDirection::kStop;
  count(kPeriod_s);

  // Peaks are kept from one start to the next.
  if (p.status.running && !s_.was_running) s_.current_peak_a = s_.dc_link_peak_v = 0;
  s_.was_running = p.status.running;
  if (p.status.running) {
    s_.current_peak_a = std::max(s_.current_peak_a, p.output_current / 100.0);
    s_.dc_link_peak_v = std::max(s_.dc_link_peak_v, m.dc_link_v);
  }
  if (s_.supply.failure_stop.active() && p.status.running) p.status.stopping = true;
  p.status.fault_stop = s_.communication.stopping() && p.status.running;

  o.set(OutputSignal::kIpf, p.status.power_failure);
  o.set(OutputSignal::kOl,
        s_.overloaded.step(kPeriod_s, p.status.overload && !store_.is_9999(pr::kOlTimer), store_.value(pr::kOlTimer)));
  o.set(OutputSignal::kMc1, s_.supply.drives_contactors && s_.supply.contactors.mc1());
  o.set(OutputSignal::kMc2, s_.supply.drives_contactors && s_.supply.contactors.mc2());
  o.set(OutputSignal::kMc3, s_.supply.drives_contactors && s_.supply.contactors.mc3());
  o.set(OutputSignal::kY46, s_.supply.failure_stop.active());
  o.set(OutputSignal::kY92, s_.supply.saving.updated());
  o.set(OutputSignal::kBof, s_.brake.opening_requested());
  o.set(OutputSignal::kFu2, p.status.running && hz >= store_.value(pr::kDetection2));
  o.set(OutputSignal::kFu3, p.status.running && hz >= store_.value(pr::kDetection3));
  o.set(OutputSignal::kRbp, out.brake_duty_fraction >= kPreAlarm);
  o.set(OutputSignal::kThp, out.motor_thermal_fraction >= kPreAlarm);
  o.set(OutputSignal::kPu, v_.mode == OperationMode::kPu);
  o.set(OutputSignal::kFan, causes_.fan);
  o.set(OutputSignal::kFin, m.heat_sink_c >= kPreAlarm * settings_.heat_sink_trip_c);
  o.set(OutputSignal::kRy2, p.status.ready && !p.status.running);
  o.set(OutputSignal::kLs, p.status.running && hz <= store_.value(pr::kLowSpeedDetection));
  o.set(OutputSignal::kTu, vector_control() && monitor_value(7) >= store_.value(pr::kTorqueDetection));
  o.set(OutputSignal::kFb, p.status.running && speed_hz >= settings_.detect_forward_hz);
  o.set(OutputSignal::kFb2, p.status.running && speed_hz >= store_.value(pr::kDetection2));
  o.set(OutputSignal::kFb3, p.status.running && speed_hz >= store_.value(pr::kDetection3));
  o.set(OutputSignal::kRun2, p.status.running);
  o.set(OutputSignal::kRun3, p.status.running || started);
  o.set(OutputSignal::kPid, v_.pid_active);
  o.set(OutputSignal::kSleep, s_.asleep);
  o.set(OutputSignal::kY64, v_.retry.phase == mitsubishi::Retry::Phase::kWaiting);
  o.set(OutputSignal::kY90, life_alarms() != 0);
  o.set(OutputSignal::kY91, v_.alarm.row && data_.alarms.rows()[*v_.alarm.row].reset == ResetRule::kPowerCycle);
  const bool maintenance = !store_.is_9999(pr::kMaintenanceLimit) &&
                           command_value(pr::kMaintenanceTimer) >= store_.integer(pr::kMaintenanceLimit);
  o.set(OutputSignal::kY95, maintenance);
  o.set(OutputSignal::kAlm2, p.status.alarm);
  o.set(OutputSignal::kLf, causes_.fan || v_.network.communication_lost);
  o.set(OutputSignal::kEr, p.status.overload || out.motor_thermal_fraction >= kPreAlarm || maintenance || causes_.fan);

  const double am_v = std::clamp(meter_share(static_cast<unsigned>(store_.integer(pr::kAmSelection))) *
                                     kMeterFullScale_v * store_.value(pr::kAmCalibration) / 100,
                                 0.0, kMeterFullScale_v);
  p.am_v = s_.am.step(am_v, kPeriod_s, store_.value(pr::kAmFilter));
}

void A700Inverter::add_command(const mitsubishi::Inputs& inputs, drive::DriveCommand& command,
                               drive::Sensors& sensors) {
  follow_torque(command, inputs);
  if (s_.asleep) command.direction = RunDirection::kStop;
  if (s_.reversed) {
    command.direction = command.direction == RunDirection::kForward   ? RunDirection::kReverse
                        : command.direction == RunDirection::kReverse ? RunDirection::kForward
                                                                      : RunDirection::kStop;
    command.direction = mitsubishi::permitted(command.direction, store_.integer(pr::kReversePrevention));
  }
  follow_contactors(command);
  follow_power_failure(command, sensors);
  follow_regeneration(command, sensors);
  follow_saving(command);
  follow_brake(command, sensors);
}

std::string four_digits(double value, int most_decimals) {
  char text[32];
  const double v = std::abs(value);
  const int decimals = v < 99.995 ? 2 : v < 999.95 ? 1 : 0;
  std::snprintf(text, sizeof text, "%.*f", std::min(decimals, most_decimals), value);
  return text;
}

Du07 A700Inverter::du07() const {
  Du07 d;
  if (!control_alive_) return d;
  d.pu = v_.mode == OperationMode::kPu || v_.mode == OperationMode::kCombined1 || v_.mode == OperationMode::kCombined2;
  d.external = v_.mode == OperationMode::kExternal || v_.mode == OperationMode::kCombined1 ||
               v_.mode == OperationMode::kCombined2;
  d.network = v_.mode == OperationMode::kNetwork;
  const mitsubishi::Published& p = v_.published;
  const bool waits = !p.status.running;
  d.forward = p.status.forward                                  ? Lamp::kOn
              : v_.direction == RunDirection::kForward && waits ? Lamp::kFlicker
                                                                : Lamp::kOff;
  d.reverse = p.status.reverse                                  ? Lamp::kOn
              : v_.direction == RunDirection::kReverse && waits ? Lamp::kFlicker
                                                                : Lamp::kOff;
  const drive::DriveOutputs& out = core_.outputs();
  if (v_.panel.stopped_by_panel) {
    d.warning = "PS";
  } else if (out.overload) {
    d.warning = out.link_overload ? "oL" : "OL";
  } else if (out.speed_limited) {
    d.warning = "SL";
  } else if (out.brake_duty_fraction >= kPreAlarm) {
    d.warning = "RB";
  } else if (out.motor_thermal_fraction >= kPreAlarm) {
    d.warning = "TH";
  } else if (v_.published.outputs.has(OutputSignal::kY95)) {
    d.warning = "MT";
  } else if (causes_.fan) {
    d.warning = "FN";
  }
  if (v_.in_reset) {
    d.digits = "Err.";
  } else if (now_ < v_.ready_at) {
    d.digits = "----";
  } else if (v_.alarm.row) {
    d.digits = data_.alarms.rows()[*v_.alarm.row].display;
  } else if (s_.communication.shown()) {
    d.digits = "E.OP3";
  } else if (v_.panel.stopped_by_panel) {
    d.digits = "PS";
  } else if (v_.panel.screen == mitsubishi::Screen::kFrequency) {
    d.digits = four_digits(v_.panel.edited_hz);
    d.hertz = true;
  } else if (v_.panel.screen == mitsubishi::Screen::kJog && waits) {
    d.digits = "JOG";
  }
  if (!d.digits.empty()) return d;

  d.monitor = true;
  // SET goes from the first monitor (Pr.52) to current and voltage.
  unsigned code = v_.panel.monitor == 1 ? 2u : v_.panel.monitor == 2 ? 3u : 0u;
  if (code == 0) {
    const int selection = store_.integer(pr::kDisplay);
    code = selection == 0 ? 1u : static_cast<unsigned>(selection);
    if (selection == 100) code = p.status.running ? 1u : 5u;
  }
  double value = monitor_value(code);
  if (code == 1 || code == 5) {
    const auto conversion = speed_conversion();
    const auto unit = conversion.frequency_unit(option_fitted_);
    value = conversion.in_unit(value, unit);
    d.hertz = unit == port::SpeedConversion::Unit::kHertz;
  }
  d.ampere = code == 2 || code == 11 || code == 18;
  d.volt = code == 3 || code == 8 || code == 12;
  const auto& rows = monitors();
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const MonitorRow& r) { return r.code == code; });
  if (row != rows.end() && monitor_decimals(*row) == 0) {
    char text[16];
    std::snprintf(text, sizeof text, "%.0f", std::min(value, 9999.0));
    d.digits = text;
  } else {
    // Pr.268: no more decimals than these.
    d.digits = four_digits(value, store_.is_9999(pr::kMonitorDigits) ? 2 : store_.integer(pr::kMonitorDigits));
  }
  return d;
}

}  // namespace vinv::inverter::a700
