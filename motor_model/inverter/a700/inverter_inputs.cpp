// Command and frequency sources of the FR-A700: which terminal, key or network bit counts in which operation mode.
// FR-A7NE manual 4.4 (network operation); analog inputs, jog, PID and override typical for the family.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motor_model/inverter/a700/command_sources.hpp"
#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"
#include "motor_model/inverter/mitsubishi/multi_speed.hpp"

namespace vinv::inverter::a700 {
namespace {

using drive::RunDirection;
using mitsubishi::AnalogInput;
using mitsubishi::Inputs;
using port::OperationMode;

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kMostCurrent_ma = 20;

constexpr InputSignals mask_of(std::initializer_list<InputSignal> signals) {
  InputSignals mask;
  for (InputSignal s : signals) mask.set(s, true);
  return mask;
}
// What PU operation does not listen to.
constexpr InputSignals kSpeedSignals = mask_of(
    {InputSignal::kRl, InputSignal::kRm, InputSignal::kRh, InputSignal::kRex, InputSignal::kAu, InputSignal::kJog});

// Pr.73: digits of its tens and units.
struct AnalogSelection {
  double full_scale_2 = 5;
  bool current_2 = false;
  double full_scale_1_v = 10;
  bool override = false;    // terminal 1 is the main speed, terminal 2 its override
  bool reversible = false;  // a negative sum turns the direction
};
AnalogSelection analog_selection(int raw_pr73) {
  AnalogSelection a;
  const int units = raw_pr73 % 10;
  a.reversible = raw_pr73 >= 10;
  a.current_2 = units >= 6;
  a.full_scale_2 = a.current_2 ? kMostCurrent_ma : units == 0 || units == 2 || units == 4 ? 10 : 5;
  a.full_scale_1_v = units == 2 || units == 3 || units == 5 || units == 7 ? 5 : 10;
  a.override = units == 4 || units == 5;
  return a;
}

double full_scale_4(int raw_pr267) { return raw_pr267 == 0 ? kMostCurrent_ma : raw_pr267 == 1 ? 5 : 10; }

AnalogLine line_of(const ParameterStore& p, unsigned bias, unsigned gain) {
  return {p.value(bias, 2), p.value(bias, 1), p.value(gain, 2), p.value(gain, 1)};
}

}  // namespace

A700Inverter::Rights A700Inverter::network_rights() const {
  // With X67 assigned its terminal says whether Pr.338 and Pr.339 hold; without it everything is external.
  if (has_function(InputSignal::kX67) && !wired_signals().has(InputSignal::kX67)) return {1, 1};
  return {store_.integer(pr::kOperationRight), store_.integer(pr::kSpeedRight)};
}

Inputs A700Inverter::read_inputs() {
  const InputSignals wired = wired_signals();
  const auto& command = v_.network.command;
  InputSignals network = assigned(command);
  // Pr.17 = 2 turns the sense of the network's bit too, 4 leaves it.
  if (store_.integer(pr::kMrsSense) == 2 && has_function(InputSignal::kMrs)) {
    network.set(InputSignal::kMrs, !network.has(InputSignal::kMrs));
  }
  const bool interlock = store_.integer(pr::kOperationMode) == 7 && !has_function(InputSignal::kX12);
  Inputs in;
  in.signals = wired;
  bool by_panel = false;
  switch (v_.mode) {
    case OperationMode::kPu:
      in.signals.bits &= ~kSpeedSignals.bits;
      by_panel = true;
      break;
    case OperationMode::kCombined2: by_panel = true; break;
    case OperationMode::kNetwork: {
      const Rights rights = network_rights();
      in.signals = command_sources().effective(wired, network_commands() ? network : InputSignals{}, rights.operation,
                                               rights.speed, interlock);
      if (rights.operation == 0 && command.has(port::NetTerminal::kOutputStop)) in.output_stop = true;
      break;
    }
    default: break;
  }
  // With Pr.79 = 7 and no X12 signal MRS is the interlock of PU operation and stops nothing.
  // With the switch-over to the commercial supply it permits operation.
  if (in.signals.has(InputSignal::kMrs) && !interlock && !drives_contactors()) in.output_stop = true;
  s_.supply.operation_enabled = in.signals.has(InputSignal::kMrs);
  s_.supply.inverter_wanted = in.signals.has(InputSignal::kCs);
  take_start(in,
             {in.signals.has(InputSignal::kStf), in.signals.has(InputSignal::kStr), in.signals.has(InputSignal::kStop)},
             by_panel);
  // Jog by terminal begins at standstill and stays until the motor has stopped.
  const bool jog_possible = v_.mode == OperationMode::kExternal || v_.mode == OperationMode::kNetwork;
  if (!running()) s_.external_jog = jog_possible && in.signals.has(InputSignal::kJog);
  if (s_.external_jog && !in.signals.has(InputSignal::kJog)) in.direction = RunDirection::kStop;
  s_.brake_open = in.signals.has(InputSignal::kBri);
  follow_motor(in);
  s_.thermal_relay_open = in.external_thermal;
  if (s_.communication.stopping() || s_.late_alarm != LateAlarm::kNone) in.direction = RunDirection::kStop;
  if (in.direction == RunDirection::kStop && !running()) s_.asleep = s_.pid_started = false;
  return in;
}

double A700Inverter::analog_percent_2() {
  const AnalogSelection a = analog_selection(store_.integer(pr::kAnalogSelection));
  // Pr.849 moves the whole input, so that noise around zero does not turn the motor.
  const double offset = store_.value(pr::kAnalogOffset) - 100;
  return filtered_percent(v_.input_2, std::min(100.0, wiring_.at(AnalogInput::k2) / a.full_scale_2 * 100 + offset));
}

double A700Inverter::analog_percent_4() {
  const double full_scale = full_scale_4(store_.integer(pr::kTerminal4Input));
  return filtered_percent(v_.input_4, std::min(100.0, wiring_.at(AnalogInput::k4) / full_scale * 100));
}

// Signed: the line of Pr.917 and Pr.918, turned round for a negative voltage.
double A700Inverter::compensation_hz(double percent_1) const {
  if (store_.value(pr::kTerminal1Function) != 0) return 0;
  const AnalogLine line = line_of(store_, pr::kTerminal1Bias, pr::kTerminal1Gain);
  return std::copysign(line.frequency(std::abs(percent_1)), percent_1);
}

// Pr.592: 1 in external operation only, 2 in every mode; X37 where a terminal has it. Begins when the set frequency has
// been reached.
double A700Inverter::traverse(const Inputs& inputs, double set_hz) {
  const int selection = store_.integer(pr::kTraverse);
  const bool wanted = selection != 0 && (selection == 2 || v_.mode == OperationMode::kExternal) && !v_.pid_active &&
                      !jogging() && inputs.direction != RunDirection::kStop &&
                      (!has_function(InputSignal::kX37) || inputs.signals.has(InputSignal::kX37));
  if (!wanted) {
    s_.traversing = false;
    s_.traverse.reset();
    return set_hz;
  }
  if (core_.outputs().state == drive::RunState::kConstant && core_.outputs().up_to_frequency) s_.traversing = true;
  if (!s_.traversing) return set_hz;
  return s_.traverse.step(
      kPeriod_s,
      {store_.value(pr::kTraverseAmplitude) / 100, store_.value(pr::kTraverseDipDown) / 100,
       store_.value(pr::kTraverseDipUp) / 100, store_.value(pr::kTraverseUpTime), store_.value(pr::kTraverseDownTime)},
      set_hz);
}

double A700Inverter::set_frequency(const Inputs& inputs) {
  return speed_limit(traverse(inputs, source_frequency(inputs)), inputs.direction == RunDirection::kReverse);
}

double A700Inverter::source_frequency(const Inputs& inputs) {
  // All inputs are followed in every mode, so that a change of source meets a settled filter.
  const AnalogSelection analog = analog_selection(store_.integer(pr::kAnalogSelection));
  const double percent_2 = analog_percent_2();
  const double percent_4 = analog_percent_4();
  const double percent_1 = filtered_percent(
      s_.input_1, std::clamp(wiring_.at(AnalogInput::k1) / analog.full_scale_1_v * 100, -100.0, 100.0));
  s_.percent_1 = percent_1;
  s_.percent_4 = percent_4;
  s_.reversed = false;
  follow_sleep(inputs);
  v_.pid_active = false;
  if (jogging()) {
    v_.pid.reset();
    return store_.value(pr::kJogFrequency);
  }
  if (const auto by_load = load_speed_frequency(inputs)) {
    v_.pid.reset();
    return *by_load;
  }
  const bool in_network = v_.mode == OperationMode::kNetwork;
  const Rights rights = in_network ? network_rights() : Rights{};
  const bool network_sets =
      in_network && command_sources().network_frequency(rights.operation, rights.speed) == Source::kNetwork;
  // Terminal 1 adds to the analog inputs; to speeds, remote setting and the network's frequency only with Pr.28 = 1.
  const double compensation = v_.mode == OperationMode::kPu ? 0 : compensation_hz(percent_1);
  const double gated = store_.integer(pr::kSpeedCompensation) == 1 ? compensation : 0;
  const int remote = store_.integer(pr::kRemoteSetting);
  const auto with_sign = [&](double hz) {
    s_.reversed = analog.reversible && hz < 0;
    return analog.reversible ? std::abs(hz) : std::max(0.0, hz);
  };
  if (remote == 0 || v_.mode == OperationMode::kPu) {
    if (const auto speed = mitsubishi::multi_speed_hz(store_, inputs.signals)) {
      v_.pid.reset();
      return with_sign(*speed + gated);
    }
  }
  const AnalogLine line_2 = line_of(store_, pr::kVoltageBias, pr::kVoltageGain);
  const AnalogLine line_4 = line_of(store_, pr::kCurrentBias, pr::kCurrentGain);
  double main_hz = 0;
  if (v_.mode != OperationMode::kPu && inputs.signals.has(InputSignal::kAu) && terminal_4_sets_frequency()) {
    main_hz = line_4.frequency(percent_4) + compensation * store_.value(pr::kCompensation4) / 100;
  } else if (network_sets) {
    main_hz = v_.network.frequency_hz + gated;
  } else if (panel_sets_speed()) {
    main_hz = v_.panel_frequency_hz;
  } else if (in_network && command_sources().terminal_2(rights.operation, rights.speed) == Source::kNone) {
    main_hz = 0;
  } else if (analog.override) {
    const double low = store_.value(pr::kOverrideBias);
    const double share = low + (store_.value(pr::kOverrideGain) - low) * std::clamp(percent_2, 0.0, 100.0) / 100;
    main_hz = compensation * share / 100;
  } else {
    main_hz = line_2.frequency(percent_2) + compensation * store_.value(pr::kCompensation2) / 100;
  }
  main_hz = pid_or_main(inputs, main_hz, percent_1, percent_2, percent_4);
  if (v_.pid_active) return main_hz;
  if (remote == 0 || v_.mode == OperationMode::kPu) return with_sign(main_hz);
  return with_sign(main_hz + remote_frequency(inputs, std::max(0.0, main_hz)) + gated);
}

// PID control acts while X14 is on. Pr.128: 10, 11 the deviation comes at terminal 1; 20, 21 the measured value at
// terminal 4; the odd ones act forward, and X64 turns that.
double A700Inverter::pid_or_main(const Inputs& inputs, double main_hz, double percent_1, double percent_2,
                                 double percent_4) {
  const int selection = store_.integer(pr::kPidAction);
  const bool by_deviation = selection == 10 || selection == 11;
  const bool by_measured = selection == 20 || selection == 21;
  const bool wanted =
      inputs.signals.has(InputSignal::kX14) && (by_deviation || by_measured) && inputs.direction != RunDirection::kStop;
  // Pr.127: the motor first runs up without control.
  if (wanted && !store_.is_9999(pr::kPidSwitchover) &&
      std::abs(core_.outputs().output_frequency_hz) >= store_.value(pr::kPidSwitchover)) {
    s_.pid_started = true;
  }
  if (!wanted || (!store_.is_9999(pr::kPidSwitchover) && !s_.pid_started)) {
    v_.pid.reset();
    return store_.is_9999(pr::kPidSwitchover) || !wanted ? main_hz : store_.value(pr::kPidSwitchover);
  }
  const AnalogLine line_2 = line_of(store_, pr::kVoltageBias, pr::kVoltageGain);
  const AnalogLine line_4 = line_of(store_, pr::kCurrentBias, pr::kCurrentGain);
  const auto share = [](double percent, const AnalogLine& line) {
    const double span = line.gain_percent - line.bias_percent;
    return span > 0.1 ? (percent - line.bias_percent) / span * 100 : 0;
  };
  const bool forward = (selection % 2 == 1) != inputs.signals.has(InputSignal::kX64);
  const bool terminal_sets =
      v_.mode == OperationMode::kExternal || v_.mode == OperationMode::kCombined2 || store_.is_9999(pr::kPidSetPoint);
  // A deviation at terminal 1 is a set point against nothing.
  const double set_point = by_deviation                                        ? percent_1
                           : terminal_sets && store_.is_9999(pr::kPidSetPoint) ? share(percent_2, line_2)
                                                                               : store_.value(pr::kPidSetPoint);
  const double measured = by_deviation ? 0 : share(percent_4, line_4);
  s_.pid_set_point = set_point;
  s_.pid_measured = measured;
  return pid_frequency(inputs, forward ? drive::PidAction::kForward : drive::PidAction::kReverse, set_point, measured,
                       line_2.gain_hz);
}

// Pr.575 to Pr.577: with little to do for long enough the output goes off until the deviation asks for it.
void A700Inverter::follow_sleep(const Inputs& inputs) {
  if (!v_.pid_active || store_.is_9999(pr::kSleepTime)) {
    s_.asleep = false;
    s_.sleep_due.step(kPeriod_s, false, 0);
    return;
  }
  const bool idle =
      inputs.direction != RunDirection::kStop && v_.published.set_frequency_hz < store_.value(pr::kSleepFrequency);
  if (!s_.asleep) {
    s_.asleep = s_.sleep_due.step(kPeriod_s, idle, store_.value(pr::kSleepTime));
  } else if (v_.pid.deviation_percent() >= store_.value(pr::kSleepCancel) - 1000) {
    s_.asleep = false;
    s_.sleep_due.clear();
  }
}

Outcome A700Inverter::set_reference(double hz) {
  if (panel_sets_speed()) return set_panel_frequency(hz);
  if (v_.mode == OperationMode::kNetwork && network_rights().speed != 1) {
    return Unexpected(std::string("the network master sets the speed; ") + mode_sentence());
  }
  if (v_.pid_active) {
    return Unexpected(
        std::string("under PID control (X14) the input is a set point, not a frequency: set it by analog"));
  }
  const bool terminal_4 = wired_signals().has(InputSignal::kAu) && terminal_4_sets_frequency();
  const AnalogSelection analog = analog_selection(store_.integer(pr::kAnalogSelection));
  if (!terminal_4 && analog.override) {
    return Unexpected(std::string("with Pr.73 = 4, 5, 14 or 15 terminal 2 is an override: set it by analog"));
  }
  const AnalogLine line = terminal_4 ? line_of(store_, pr::kCurrentBias, pr::kCurrentGain)
                                     : line_of(store_, pr::kVoltageBias, pr::kVoltageGain);
  const double span_hz = line.gain_hz - line.bias_hz;
  // Inverse of AnalogLine; the input ends at 100 %.
  const double percent =
      span_hz != 0 ? line.bias_percent + (hz - line.bias_hz) / span_hz * (line.gain_percent - line.bias_percent) : -1;
  if (!(percent >= 0 && percent <= 100)) {
    char text[160];
    std::snprintf(text, sizeof text, "terminal %s gives %.2f to %.2f Hz with its calibration, not %.2f Hz",
                  terminal_4 ? "4" : "2", line.frequency(0), line.frequency(100), hz);
    return Unexpected(std::string(text));
  }
  if (terminal_4) return set_analog("4", percent / 100 * full_scale_4(store_.integer(pr::kTerminal4Input)));
  return set_analog("2", percent / 100 * analog.full_scale_2);
}

}  // namespace vinv::inverter::a700
