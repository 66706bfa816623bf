// What the motor hangs on: the stage, the mains, a voltage table or nothing.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/plant/machine_steady.hpp"
#include "motor_model/plant/plant_impl.hpp"
#include "sim/base/check.hpp"

namespace vinv::plant {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

void PowerPlant::Impl::set_line(double voltage_v_rms) {
  if (voltage_v_rms == line_v_rms) return;
  const double step = std::abs(voltage_v_rms - line_v_rms);
  const bool lived = line_feeds();
  line_v_rms = voltage_v_rms;
  if (source != MotorSource::kMains) return;
  constexpr double kJumpOfNominal = 0.01;
  anew = anew || lived != line_feeds() || step > kJumpOfNominal * config.nominal_mains_v_rms;
  if (model.on_line) model.line_peak_v = phase_peak(line_v_rms);
}

void PowerPlant::Impl::set_motor_source(MotorSource next) {
  VINV_CHECK(next != MotorSource::kTable || !config.voltage_table.empty());
  if (next == source) return;
  if (model.fed()) interrupt_stator();
  model.gates_on = model.on_line = false;
  source = next;
  source_since = time;
  take_stage_levels();
  anew = true;
}

bool PowerPlant::Impl::line_feeds() const {
  return source == MotorSource::kTable || (source == MotorSource::kMains && line_v_rms > 0);
}

// The stator current ends at once; the energy of its leakage field dies in what interrupts it.
void PowerPlant::Impl::interrupt_stator() {
  const CurrentPair i = currents(model.machine, flux_of(y()));
  y()[state::kInverter] += 0.75 * model.machine.L_sigma * (i.i_sd * i.i_sd + i.i_sq * i.i_sq);
  open_stator(model, y());
}

void PowerPlant::Impl::refresh_line() {
  const bool closes = line_feeds() && !model.on_line;
  model.on_line = line_feeds();
  voltage_end = Duration::max();
  if (!model.on_line) return;
  if (source == MotorSource::kTable) return enter_voltage_point();
  model.line_peak_v = phase_peak(line_v_rms);
  model.line_omega = kTurn * config.mains_frequency_hz;
  if (closes) {
    const double now_s = to_seconds(base) + t;
    const double turns = std::remainder(config.mains_frequency_hz * now_s, 1.0);
    align_frame(config.mains_phase_rad + kTurn * turns, y());
  }
}

// The frame stands still with its d axis on the vector.
void PowerPlant::Impl::enter_voltage_point() {
  const auto& table = config.voltage_table;
  const Duration since = time - source_since;
  const auto next = std::upper_bound(table.begin() + 1, table.end(), since, [](Duration at, const VoltagePoint& point) {
    return at < seconds_to_duration(point.time_s);
  });
  const VoltagePoint& point = *(next - 1);
  if (next != table.end()) voltage_end = source_since + seconds_to_duration(next->time_s);
  model.line_peak_v = std::hypot(point.alpha_v, point.beta_v);
  model.line_omega = 0;
  if (model.line_peak_v > 0) align_frame(std::atan2(point.beta_v, point.alpha_v), y());
}

}  // namespace vinv::plant
