// Command and frequency sources of the FR-E500: which terminal, key or network bit counts in which operation mode.
// OI-FR-E5NCO manual 8.7.4 to 8.7.8; Pr.338, 339 and the assignment Pr.180-183 typical for the family.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/e500/multi_speed.hpp"
#include "motor_model/inverter/e500/parameter_numbers.hpp"

namespace vinv::inverter::e500 {
namespace {

using drive::RunDirection;
using port::NetTerminal;
using port::OperationMode;

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kFilterUnit_s = 0.005;  // Pr.74: times 2 to the power of the setting

// Signals that never come from the network: the thermal relay is wired, and X16 chooses the mode.
constexpr InputSignals mask_of(std::initializer_list<InputSignal> signals) {
  InputSignals mask;
  for (InputSignal s : signals) mask.set(s, true);
  return mask;
}
constexpr InputSignals kSpeedSignals =
    mask_of({InputSignal::kRl, InputSignal::kRm, InputSignal::kRh, InputSignal::kRex});
constexpr InputSignals kOperationSignals = mask_of({InputSignal::kRt, InputSignal::kX18});

}  // namespace

InputSignals E500Inverter::assigned(bool rl, bool rm, bool rh, bool mrs) const {
  InputSignals out;
  const auto add = [&](unsigned function, bool closed) {
    const auto signal = data_.signals.input(store_.integer(function));
    if (signal && closed) out.set(*signal, true);
  };
  add(pr::kRlFunction, rl);
  add(pr::kRmFunction, rm);
  add(pr::kRhFunction, rh);
  add(pr::kMrsFunction, mrs);
  return out;
}

bool E500Inverter::has_function(InputSignal signal) const {
  for (unsigned function : {pr::kRlFunction, pr::kRmFunction, pr::kRhFunction, pr::kMrsFunction}) {
    if (data_.signals.input(store_.integer(function)) == signal) return true;
  }
  return false;
}

InputSignals E500Inverter::wired_signals() const {
  const auto& closed = wiring_.closed;
  InputSignals signals = assigned(closed[kRl], closed[kRm], closed[kRh], closed[kMrs]);
  // Pr.17 = 2: a normally closed contact.
  if (v_.mrs_inverted && has_function(InputSignal::kMrs)) {
    signals.set(InputSignal::kMrs, !signals.has(InputSignal::kMrs));
  }
  return signals;
}

E500Inverter::Inputs E500Inverter::read_inputs() {
  const InputSignals wired = wired_signals();
  const auto& command = v_.network.command;
  const InputSignals from_network = assigned(command.has(NetTerminal::kRl), command.has(NetTerminal::kRm),
                                             command.has(NetTerminal::kRh), command.has(NetTerminal::kMrs));
  const StopSelection stop = stop_selection(store_.value(pr::kStopSelection));
  Inputs in;
  StartSignals start{wiring_.closed[kStf], wiring_.closed[kStr], wired.has(InputSignal::kStop)};
  bool by_panel = false;
  in.signals = wired;
  in.output_stop = wired.has(InputSignal::kMrs);
  switch (v_.mode) {
    case OperationMode::kPu:
      in.signals.bits &= ~kSpeedSignals.bits;
      in.signals.set(InputSignal::kAu, false);
      by_panel = true;
      // With Pr.79 = 7 signal MRS is the interlock, an output stop in external operation only.
      if (store_.integer(pr::kOperationMode) == 7) in.output_stop = false;
      break;
    case OperationMode::kCombined2: by_panel = true; break;
    case OperationMode::kNetwork: {
      const bool network_operates = store_.integer(pr::kOperationRight) == 0;
      const bool network_sets_speed = store_.integer(pr::kSpeedRight) == 0;
      if (store_.integer(pr::kOperationMode) == 7) in.output_stop = false;
      if (network_operates) {
        in.signals = in.signals.only({~kOperationSignals.bits}) | from_network.only(kOperationSignals);
        in.output_stop = in.output_stop || from_network.has(InputSignal::kMrs);
        const bool stopped = command.has(NetTerminal::kStop);
        start = {command.has(NetTerminal::kStf) && !stopped, command.has(NetTerminal::kStr) && !stopped, false};
      }
      if (network_sets_speed) {
        in.signals = in.signals.only({~kSpeedSignals.bits}) | from_network.only(kSpeedSignals);
        in.signals.set(InputSignal::kAu, false);
      }
      break;
    }
    default: break;
  }
  if (by_panel) start = {};
  const RunDirection by_signals = v_.start_latch.step(start, stop.str_is_direction);
  in.direction = permitted(by_panel ? v_.panel.run : by_signals, store_.integer(pr::kReversePrevention));
  v_.any_start_signal = wiring_.closed[kStf] || wiring_.closed[kStr] || command.has(NetTerminal::kStf) ||
                        command.has(NetTerminal::kStr) || v_.panel.run != RunDirection::kStop ||
                        by_signals != RunDirection::kStop;
  if (v_.panel.stopped_by_panel) in.direction = RunDirection::kStop;
  // The contact of the thermal relay is closed while all is well.
  in.external_thermal = has_function(InputSignal::kOh) && (!wired.has(InputSignal::kOh) || causes_.external_thermal);
  return in;
}

double E500Inverter::terminal_2_percent() {
  const double full_scale_v = store_.integer(pr::kVoltageRange) == 0 ? 5 : 10;
  const bool by_converter = v_.mode == OperationMode::kNetwork && v_.network.converter;
  const double percent =
      by_converter ? *v_.network.converter * 100.0 / 255 : std::min(100.0, wiring_.terminal_2_v / full_scale_v * 100);
  const double filter_s = kFilterUnit_s * std::exp2(store_.integer(pr::kInputFilter));
  return v_.input_2.step(percent, kPeriod_s, filter_s);
}

double E500Inverter::terminal_4_percent() {
  const double filter_s = kFilterUnit_s * std::exp2(store_.integer(pr::kInputFilter));
  return v_.input_4.step(std::min(100.0, wiring_.terminal_4_ma / 20 * 100), kPeriod_s, filter_s);
}

double E500Inverter::set_frequency(const Inputs& inputs) {
  // Both inputs are followed in every mode, so that a change of source meets a settled filter.
  const double percent_2 = terminal_2_percent();
  const double percent_4 = terminal_4_percent();
  const AnalogLine line_2{store_.value(pr::kVoltageBias, 2), store_.value(pr::kVoltageBias, 1),
                          store_.value(pr::kVoltageGain, 2), store_.value(pr::kVoltageGain, 1)};
  const AnalogLine line_4{store_.value(pr::kCurrentBias, 2), store_.value(pr::kCurrentBias, 1),
                          store_.value(pr::kCurrentGain, 2), store_.value(pr::kCurrentGain, 1)};
  const bool panel_sets = v_.mode == OperationMode::kPu || v_.mode == OperationMode::kCombined1;
  const bool network_sets = v_.mode == OperationMode::kNetwork && store_.integer(pr::kSpeedRight) == 0;

  if (v_.mode == OperationMode::kPu && v_.panel.jog_run) {
    v_.pid.reset();
    return store_.value(pr::kJogFrequency);
  }
  const int remote = store_.integer(pr::kRemoteSetting);
  if (remote == 0 || v_.mode == OperationMode::kPu) {
    if (const auto speed = multi_speed_hz(store_, inputs.signals)) {
      v_.pid.reset();
      return *speed;
    }
  }
  double main_hz = 0;
  if (network_sets) {
    main_hz = v_.network.frequency_hz;
  } else if (v_.mode != OperationMode::kPu && inputs.signals.has(InputSignal::kAu)) {
    main_hz = line_4.frequency(percent_4);
  } else if (panel_sets) {
    main_hz = v_.panel_frequency_hz;
  } else {
    main_hz = line_2.frequency(percent_2);
  }
  if (const int action = store_.integer(pr::kPidAction); action != 0) {
    if (inputs.direction == RunDirection::kStop) {
      v_.pid.reset();
      return main_hz;
    }
    const auto share = [](double percent, const AnalogLine& line) {
      const double span = line.gain_percent - line.bias_percent;
      return span > 0.1 ? (percent - line.bias_percent) / span * 100 : 0;
    };
    const auto limit = [this](unsigned number, double none) {
      return store_.is_9999(number) ? none : store_.value(number);
    };
    drive::PidSettings pid;
    pid.action = action == 21 ? drive::PidAction::kForward : drive::PidAction::kReverse;
    pid.proportional_band_percent = limit(pr::kPidBand, 0);
    pid.integral_s = limit(pr::kPidIntegral, 0);
    pid.derivative_s = limit(pr::kPidDerivative, 0);
    pid.upper_limit_percent = limit(pr::kPidUpper, 1e9);
    pid.lower_limit_percent = limit(pr::kPidLower, -1e9);
    // Set point: Pr.133 where panel or network set the speed, else terminal 2. Measured value: terminal 4.
    const double set_point = panel_sets || network_sets ? store_.value(pr::kPidSetPoint) : share(percent_2, line_2);
    return v_.pid.step(kPeriod_s, pid, set_point, share(percent_4, line_4)) / 100 * line_2.gain_hz;
  }
  v_.pid.reset();
  if (remote == 0 || v_.mode == OperationMode::kPu) return main_hz;
  return main_hz + remote_frequency(inputs, main_hz);
}

Outcome E500Inverter::set_reference(double hz) {
  const bool panel_sets = v_.mode == OperationMode::kPu || v_.mode == OperationMode::kCombined1;
  if (panel_sets) return set_panel_frequency(hz);
  if (v_.mode == OperationMode::kNetwork && store_.integer(pr::kSpeedRight) == 0)
    return Unexpected(std::string("the network master sets the speed; ") + mode_sentence());
  if (store_.integer(pr::kPidAction) != 0)
    return Unexpected(
        std::string("with PID control (Pr.128) the input is a set point, not a frequency: set it by analog"));
  const bool current = wired_signals().has(InputSignal::kAu);
  const unsigned bias = current ? pr::kCurrentBias : pr::kVoltageBias;
  const unsigned gain = current ? pr::kCurrentGain : pr::kVoltageGain;
  const double span_hz = store_.value(gain, 1) - store_.value(bias, 1);
  const double span_percent = store_.value(gain, 2) - store_.value(bias, 2);
  // Inverse of AnalogLine; the input ends at 100 %.
  const double percent =
      span_hz != 0 ? store_.value(bias, 2) + (hz - store_.value(bias, 1)) / span_hz * span_percent : -1;
  if (!(percent >= 0 && percent <= 100)) {
    const AnalogLine line{store_.value(bias, 2), store_.value(bias, 1), store_.value(gain, 2), store_.value(gain, 1)};
    char text[160];
    std::snprintf(text, sizeof text,
                  "terminal %s gives %.2f to %.2f Hz with its calibration (Pr.%u, Pr.%u), not %.2f Hz",
                  current ? "4" : "2", line.frequency(0), line.frequency(100), bias, gain, hz);
    return Unexpected(std::string(text));
  }
  if (current) return set_analog("4", percent / 100 * 20);
  return set_analog("2", percent / 100 * (store_.integer(pr::kVoltageRange) == 0 ? 5 : 10));
}

double E500Inverter::remote_frequency(const Inputs& inputs, double main_hz) {
  const double up_s = store_.value(pr::kSecondRamp);
  const double down_s = store_.is_9999(pr::kSecondDeceleration) ? up_s : store_.value(pr::kSecondDeceleration);
  const double reference_hz = store_.value(pr::kRampReference);
  drive::RemoteSettings remote;
  remote.memory = store_.integer(pr::kRemoteSetting) == 1;
  remote.raise_rate_hz_s = reference_hz / std::max(up_s, kPeriod_s);
  remote.lower_rate_hz_s = reference_hz / std::max(down_s, kPeriod_s);
  remote.max_hz = std::max(0.0, maximum_frequency_hz(store_) - main_hz);
  const double hz = v_.remote.step(kPeriod_s, remote,
                                   {inputs.signals.has(InputSignal::kRh), inputs.signals.has(InputSignal::kRm),
                                    inputs.signals.has(InputSignal::kRl), inputs.direction != RunDirection::kStop});
  if (const auto store = v_.remote.take_store()) {
    record_.remote_frequency = static_cast<std::int32_t>(std::lround(*store * 100));
    eeprom_written();
  }
  return hz;
}

}  // namespace vinv::inverter::e500
