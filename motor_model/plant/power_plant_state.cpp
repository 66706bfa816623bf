// Snapshots: the solver's states, and everything else the future depends on as a list of numbers.
#include <algorithm>
#include <cstdint>

#include "motor_model/plant/plant_impl.hpp"
#include "sim/base/check.hpp"

namespace vinv::plant {

namespace {

// One pass over all held values, in either direction.
class Writer {
 public:
  explicit Writer(std::vector<double>& out) : out_(out) {}
  void value(const double& x) { out_.push_back(x); }
  void value(const bool& x) { out_.push_back(x ? 1 : 0); }
  // A double holds 53 bits: in two halves every nanosecond survives.
  void value(const Duration& d) {
    out_.push_back(static_cast<double>(d.count() >> 32));
    out_.push_back(static_cast<double>(d.count() & 0xffffffff));
  }
  void value(const ShaftMode& m) { out_.push_back(static_cast<double>(m)); }
  void table(const std::vector<LoadPoint>& points) {
    out_.push_back(static_cast<double>(points.size()));
    for (const auto& p : points) {
      out_.push_back(p.time_s);
      out_.push_back(p.torque_nm);
    }
  }

 private:
  std::vector<double>& out_;
};

class Reader {
 public:
  explicit Reader(const std::vector<double>& in) : in_(in) {}
  void value(double& x) { x = next(); }
  void value(bool& x) { x = next() != 0; }
  void value(Duration& d) {
    const auto high = static_cast<std::int64_t>(next());
    d = Duration{high * (std::int64_t{1} << 32) + static_cast<std::int64_t>(next())};
  }
  void value(ShaftMode& m) { m = static_cast<ShaftMode>(next()); }
  void table(std::vector<LoadPoint>& points) {
    points.resize(static_cast<std::size_t>(next()));
    for (auto& p : points) {
      p.time_s = next();
      p.torque_nm = next();
    }
  }
  bool at_end() const { return at_ == in_.size(); }

 private:
  double next() {
    VINV_CHECK(at_ < in_.size());
    return in_[at_++];
  }
  const std::vector<double>& in_;
  std::size_t at_ = 0;
};

template <class Pass, class Impl>
void visit(Pass& pass, Impl& p) {
  pass.value(p.time);
  pass.value(p.stage.gates_on);
  pass.value(p.stage.frequency_hz);
  pass.value(p.stage.voltage_peak_v);
  pass.value(p.stage.chopper_enabled);
  pass.value(p.stage.chopper_on_v);
  pass.value(p.stage.chopper_off_v);
  pass.value(p.stage_jumps);
  pass.value(p.model.omega_k);
  pass.value(p.model.commanded_peak_v);
  pass.value(p.config.mains.voltage_v_rms);
  for (auto& phase : p.config.mains.phase_present) pass.value(phase);
  pass.value(p.config.ambient_c);
  pass.value(p.carrier_hz);
  pass.value(p.cooling_factor);
  pass.value(p.config.load.inertia_kg_m2);
  pass.value(p.config.load.constant_nm);
  pass.value(p.config.load.linear_nm_s);
  pass.value(p.config.load.quadratic_nm_s2);
  pass.value(p.config.load.hoist_nm);
  pass.table(p.config.load.table);
  pass.value(p.model.load.locked);
  pass.value(p.model.load.mode);
  pass.value(p.model.gates_on);
  pass.value(p.switches.gates_commanded);
  pass.value(p.switches.gates_latched);
  pass.value(p.switches.over_voltage);
  pass.value(p.switches.under_voltage_armed);
  pass.value(p.switches.bypassed);
  pass.value(p.switches.chopper_on);
}

}  // namespace

PowerPlant::State PowerPlant::save() const {
  State out;
  out.y.assign(impl_->y(), impl_->y() + state::kStates);
  Writer writer(out.aux);
  visit(writer, *impl_);
  return out;
}

void PowerPlant::restore(const State& saved) {
  Impl& p = *impl_;
  VINV_CHECK(saved.y.size() == state::kStates);
  std::copy(saved.y.begin(), saved.y.end(), p.y());
  Reader reader(saved.aux);
  visit(reader, p);
  VINV_CHECK(reader.at_end());

  p.base = p.time;
  p.t = 0;
  plant::set_load(p.model.load, p.config.load, p.config.losses, p.config.machine.inertia_kg_m2);
  p.enter_table_segment();
  p.model.thermal.ambient_c = p.config.ambient_c;
  p.take_inverter_loss();
  p.take_stage_levels();
  p.end_stage_way();
  p.refresh_rectifier();
  p.model.chopper_on = p.switches.chopper_on;
  p.anew = true;
  p.measure();
}

}  // namespace vinv::plant
