// Command and frequency sources of the FR-E500: which terminal, key or network bit counts in which operation mode.
// OI-FR-E5NCO manual 8.7.4 to 8.7.8; Pr.338, 339 and the assignment Pr.180-183 typical for the family.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/e500/parameter_numbers.hpp"
#include "motor_model/inverter/mitsubishi/multi_speed.hpp"

namespace vinv::inverter::e500 {
namespace {

using drive::RunDirection;
using port::NetTerminal;
using port::OperationMode;

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

mitsubishi::Inputs E500Inverter::read_inputs() {
  const InputSignals wired = wired_signals();
  const auto& command = v_.network.command;
  const InputSignals from_network = assigned(command);
  mitsubishi::Inputs in;
  mitsubishi::StartSignals start{wired.has(InputSignal::kStf), wired.has(InputSignal::kStr),
                                 wired.has(InputSignal::kStop)};
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
  take_start(in, start, by_panel);
  return in;
}

double E500Inverter::terminal_2_percent() {
  const double full_scale_v = store_.integer(pr::kVoltageRange) == 0 ? 5 : 10;
  const bool by_converter = v_.mode == OperationMode::kNetwork && v_.network.converter;
  const double percent = by_converter ? *v_.network.converter * 100.0 / 255
                                      : std::min(100.0, wiring_.at(mitsubishi::AnalogInput::k2) / full_scale_v * 100);
  return filtered_percent(v_.input_2, percent);
}

double E500Inverter::terminal_4_percent() {
  return filtered_percent(v_.input_4, std::min(100.0, wiring_.at(mitsubishi::AnalogInput::k4) / 20 * 100));
}

double E500Inverter::set_frequency(const mitsubishi::Inputs& inputs) {
  // Both inputs are followed in every mode, so that a change of source meets a settled filter.
  const double percent_2 = terminal_2_percent();
  const double percent_4 = terminal_4_percent();
  const AnalogLine line_2{store_.value(pr::kVoltageBias, 2), store_.value(pr::kVoltageBias, 1),
                          store_.value(pr::kVoltageGain, 2), store_.value(pr::kVoltageGain, 1)};
  const AnalogLine line_4{store_.value(pr::kCurrentBias, 2), store_.value(pr::kCurrentBias, 1),
                          store_.value(pr::kCurrentGain, 2), store_.value(pr::kCurrentGain, 1)};
  const bool panel_sets = panel_sets_speed();
  v_.pid_active = false;
  const bool network_sets = v_.mode == OperationMode::kNetwork && store_.integer(pr::kSpeedRight) == 0;

  if (v_.mode == OperationMode::kPu && v_.panel.jog_run) {
    v_.pid.reset();
    return store_.value(pr::kJogFrequency);
  }
  const int remote = store_.integer(pr::kRemoteSetting);
  if (remote == 0 || v_.mode == OperationMode::kPu) {
    if (const auto speed = mitsubishi::multi_speed_hz(store_, inputs.signals)) {
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
    // Set point: Pr.133 where panel or network set the speed, else terminal 2. Measured value: terminal 4.
    const double set_point = panel_sets || network_sets ? store_.value(pr::kPidSetPoint) : share(percent_2, line_2);
    return pid_frequency(inputs, action == 21 ? drive::PidAction::kForward : drive::PidAction::kReverse, set_point,
                         share(percent_4, line_4), line_2.gain_hz);
  }
  v_.pid.reset();
  if (remote == 0 || v_.mode == OperationMode::kPu) return main_hz;
  return main_hz + remote_frequency(inputs, main_hz);
}

Outcome E500Inverter::set_reference(double hz) {
  if (panel_sets_speed()) return set_panel_frequency(hz);
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

}  // namespace vinv::inverter::e500
