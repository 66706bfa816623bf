// Terminals to signals, and the pieces of command and frequency sources that the Mitsubishi families share.
#include <algorithm>
#include <cmath>

#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"
#include "motor_model/inverter/mitsubishi/run_command.hpp"

namespace vinv::inverter::mitsubishi {
namespace {

using drive::RunDirection;

constexpr double kPeriod_s = to_seconds(Inverter::kControlPeriod);
constexpr double kFilterUnit_s = 0.005;  // Pr.74: times 2 to the power of the setting

}  // namespace

InputSignals MitsubishiInverter::assigned(port::NetTerminals closed) const {
  InputSignals out;
  for (const InputTerminal& input : personality_.inputs) {
    if (!closed.has(input.bit)) continue;
    const auto signal = input.signal ? input.signal : data_.signals.input(store_.integer(input.function));
    if (signal) out.set(*signal, true);
  }
  return out;
}

bool MitsubishiInverter::has_function(InputSignal signal) const {
  // Asked for several times in each tick, and the answer changes with the parameters only.
  if (functions_revision_ != store_.revision()) {
    functions_ = {};
    for (const InputTerminal& input : personality_.inputs) {
      const auto has = input.signal ? input.signal : data_.signals.input(store_.integer(input.function));
      if (has) functions_.set(*has, true);
    }
    functions_revision_ = store_.revision();
  }
  return functions_.has(signal);
}

InputSignals MitsubishiInverter::wired_signals() const {
  InputSignals signals = assigned(wiring_.closed);
  // Pr.17: a normally closed contact.
  if (v_.mrs_inverted && has_function(InputSignal::kMrs)) {
    signals.set(InputSignal::kMrs, !signals.has(InputSignal::kMrs));
  }
  return signals;
}

void MitsubishiInverter::take_start(Inputs& in, const StartSignals& start, bool by_panel) {
  const StopSelection stop = stop_selection(store_.value(pr::kStopSelection));
  const RunDirection by_signals = v_.start_latch.step(by_panel ? StartSignals{} : start, stop.str_is_direction);
  in.direction = permitted(by_panel ? v_.panel.run : by_signals, store_.integer(pr::kReversePrevention));
  const InputSignals any = assigned({static_cast<std::uint16_t>(wiring_.closed.bits | v_.network.command.bits)});
  v_.any_start_signal = any.has(InputSignal::kStf) || any.has(InputSignal::kStr) ||
                        v_.panel.run != RunDirection::kStop || by_signals != RunDirection::kStop;
  if (v_.panel.stopped_by_panel) in.direction = RunDirection::kStop;
  // The contact of the thermal relay is closed while all is well.
  in.external_thermal =
      has_function(InputSignal::kOh) && (!assigned(wiring_.closed).has(InputSignal::kOh) || causes_.external_thermal);
}

double MitsubishiInverter::filtered_percent(AnalogFilter& filter, double percent) const {
  return filter.step(percent, kPeriod_s, kFilterUnit_s * std::exp2(store_.integer(pr::kInputFilter)));
}

double MitsubishiInverter::pid_frequency(const Inputs& inputs, drive::PidAction action, double set_point,
                                         double measured, double full_scale_hz) {
  v_.pid_active = inputs.direction != RunDirection::kStop;
  const auto limit = [this](unsigned number, double none) {
    return store_.is_9999(number) ? none : store_.value(number);
  };
  drive::PidSettings pid;
  pid.action = action;
  pid.proportional_band_percent = limit(pr::kPidBand, 0);
  pid.integral_s = limit(pr::kPidIntegral, 0);
  pid.derivative_s = limit(pr::kPidDerivative, 0);
  pid.upper_limit_percent = limit(pr::kPidUpper, 1e9);
  pid.lower_limit_percent = limit(pr::kPidLower, -1e9);
  return v_.pid.step(kPeriod_s, pid, set_point, measured) / 100 * full_scale_hz;
}

double MitsubishiInverter::remote_frequency(const Inputs& inputs, double main_hz) {
  const double up_s = store_.value(pr::kSecondRamp);
  const double down_s = or_else(store_, pr::kSecondDeceleration, up_s);
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

}  // namespace vinv::inverter::mitsubishi
