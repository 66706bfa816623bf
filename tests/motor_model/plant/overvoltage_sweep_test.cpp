// Deceleration into the link over inertia x ramp time x load: does the link reach 760 and 800 V, and when. No losses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motor_model/plant/machine_steady.hpp"
#include "tests/motor_model/plant/plant_trace.hpp"
#include "tests/motor_model/plant/reference_table.hpp"

namespace vinv::plant::test {
namespace {

constexpr double kUn = 326.5986324, kUb = 16.32993162;
constexpr double kSource = 2, kOpenCircuit = 565.685424949238;

// At 50 Hz with this load torque: link voltage, stage limit and machine agree.
struct LoadedStart {
  FluxPair psi;
  double omega_mech = 0;
  double link_v = kOpenCircuit;
};

LoadedStart loaded_start(double torque) {
  const MachineModel machine(*find_machine("motulator_2k2"));
  const double omega = 100 * std::numbers::pi;
  LoadedStart out;
  for (int n = 0; n < 100; ++n) {
    const double voltage = std::min(kUn, out.link_v / std::numbers::sqrt3);
    const SteadyPoint point = steady_point(machine, voltage, omega, slip_for_torque(machine, voltage, omega, torque));
    out.psi = point.psi;
    out.omega_mech = (1 - point.slip) * omega / machine.pole_pairs;
    out.link_v = kOpenCircuit - kSource * point.input_power_w / out.link_v;
  }
  return out;
}

TEST(OverVoltageSweep, EveryRunTripsOrNotAndAtTheTabulatedTime) {
  const ReferenceTable table("d_overvoltage_sweep.csv");
  ASSERT_EQ(table.rows(), 60u);
  int trips = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double ramp_s = table.number(row, "t_decel_s"), torque = table.number(row, "T_load_Nm");
    SCOPED_TRACE("J " + table.text(row, "J_total_kgm2") + ", ramp " + table.text(row, "t_decel_s") + " s, load " +
                 table.text(row, "T_load_Nm"));
    const auto input = [ramp_s](double t) {
      const double f = std::max(0.0, 50 * (1 - t / ramp_s));
      return TraceInput{vf_law(f, kUb, kUn, 50), f};
    };
    PlantTrace trace("motulator_2k2", table.number(row, "J_total_kgm2"), input);
    trace.use_link({0.000235, kSource, kOpenCircuit});
    const LoadedStart start = loaded_start(torque);
    // The load opposes rotation. The table smooths its sign within 1 rad/s of standstill, the plant has it sharp.
    trace.model.load.constant_nm = torque;
    trace.model.load.mode = torque > 0 ? ShaftMode::kForward : ShaftMode::kFree;
    trace.start(start.psi, start.omega_mech, start.link_v);
    for (const auto& [column, level] : {std::pair<std::string, double>{"t_760_s", 760}, {"t_800_s", 800}}) {
      trace.watch_link(level);
      bool reached = false;
      const double end = ramp_s + 0.2;
      while (!reached && end - trace.t() > 1e-6) {
        const double stop = trace.t() < ramp_s - 1e-6 ? ramp_s : end;  // the input has a kink at the ramp's end
        reached = trace.run_to(stop);
        trace.jump();
      }
      if (table.text(row, column) == "none") {
        EXPECT_FALSE(reached) << column << " at " << trace.t();
        break;
      }
      ASSERT_TRUE(reached) << column;
      EXPECT_NEAR(trace.t(), table.number(row, column), 1e-4) << column;
      trips += level == 800;
    }
  }
  EXPECT_EQ(trips, 39);
}

}  // namespace
}  // namespace vinv::plant::test
