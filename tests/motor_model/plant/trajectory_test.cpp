// The machine, link and shaft equations against trajectories of an independent code (explicit order 8, rtol 1e-11; x0
// from another model family altogether), under each trace's own continuous input. Headers of the data files hold all
// parameters. Losses are zero here, as they are in the data.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/motor_model/plant/plant_trace.hpp"
#include "tests/motor_model/plant/reference_table.hpp"

namespace vinv::plant::test {
namespace {

constexpr double kUn = 326.5986324, kUb = 16.32993162;  // V/f law of the data, phase peaks
constexpr double kOfPeak = 1e-3;                        // of the trace's own peak, at every sample

double peak(const std::vector<double>& values) {
  double out = 0;
  for (const double v : values) out = std::max(out, std::abs(v));
  return out;
}

// Largest deviation of each quantity over a trace.
struct Deviation {
  double speed = 0, torque = 0, current = 0, flux = 0;
};

// Follows the samples of a file; before(t) is called at each sample with the sample's time and may change the load.
template <class AtSample>
Deviation follow(PlantTrace& trace, const ReferenceTable& data, AtSample at_sample, std::size_t rows) {
  const auto times = data.numbers("t_s"), omega = data.numbers("omega_rad_s"), torque = data.numbers("Te_Nm");
  const auto i_d = data.numbers("isd_A"), i_q = data.numbers("isq_A"), psi_s = data.numbers("psis_abs_Wb");
  Deviation worst;
  for (std::size_t row = 0; row < rows; ++row) {
    trace.run_to(times[row]);
    const Flows f = trace.now();
    const FluxPair psi = flux_of(trace.y());
    worst.speed = std::max(worst.speed, std::abs(trace.omega() - omega[row]));
    worst.torque = std::max(worst.torque, std::abs(f.torque_nm - torque[row]));
    worst.current = std::max(worst.current, std::hypot(f.i.i_sd - i_d[row], f.i.i_sq - i_q[row]));
    worst.flux = std::max(worst.flux, std::abs(std::hypot(psi.psi_sd, psi.psi_sq) - psi_s[row]));
    at_sample(times[row]);
  }
  return worst;
}

void expect_within(const Deviation& d, const ReferenceTable& data, double of_peak) {
  const double speed = peak(data.numbers("omega_rad_s"));
  EXPECT_LE(d.speed, of_peak * speed);
  EXPECT_LE(d.torque, of_peak * peak(data.numbers("Te_Nm")));
  EXPECT_LE(d.current, of_peak * peak(data.numbers("is_abs_A")));
  EXPECT_LE(d.flux, of_peak * peak(data.numbers("psis_abs_Wb")));
}

const auto kNothing = [](double) {};

class Trajectory : public testing::TestWithParam<SolverChoice> {
 protected:
  SolverSettings solver() const { return {GetParam(), SolverSettings{}.relative_tolerance, 100e-6}; }
};

TEST_P(Trajectory, DirectOnLine3HpFollowsA1) {
  const ReferenceTable data("a1_dol_krause3hp_noload.csv.gz");
  PlantTrace trace(
      "krause_3hp", 0.089,
      [](double) {
        return TraceInput{179.6292478, 60};
      },
      solver());
  trace.start();
  expect_within(follow(trace, data, kNothing, data.rows()), data, kOfPeak);
}

TEST_P(Trajectory, DirectOnLine50HpFollowsA2) {
  const ReferenceTable data("a2_dol_krause50hp_noload.csv.gz");
  PlantTrace trace(
      "krause_50hp", 1.662,
      [](double) {
        return TraceInput{375.5884272, 60};
      },
      solver());
  trace.start();
  expect_within(follow(trace, data, kNothing, data.rows()), data, kOfPeak);
}

TEST_P(Trajectory, RampWithFanLoadFollowsB) {
  const ReferenceTable data("b_vf_ramp_fan_2k2.csv.gz");
  const auto input = [](double t) {
    const double f = t < 5 ? 10 * t : 50;
    return TraceInput{vf_law(f, kUb, kUn, 50), f};
  };
  PlantTrace trace("motulator_2k2", 0.015, input, solver());
  trace.model.load.quadratic_nm_s2 = 0.000591715712471;
  trace.start();
  expect_within(follow(
                    trace, data,
                    [&](double t) {
                      if (t == 5) trace.jump();
                    },
                    data.rows()),
                data, kOfPeak);
}

TEST_P(Trajectory, LoadStepFollowsC) {
  const ReferenceTable data("c_load_step_2k2.csv.gz");
  PlantTrace trace(
      "motulator_2k2", 0.015,
      [](double) {
        return TraceInput{kUn, 50};
      },
      solver());
  trace.start({0.0498594892088, -1.03719892507, 0.0476747903593, -0.991751863048}, 157.079632679);
  const auto load = [&](double t) {
    if (t == 0.1) trace.model.load.hoist_nm = 14.6;
    if (t == 0.6) trace.model.load.hoist_nm = 0;
    if (t == 0.1 || t == 0.6) trace.jump();
  };
  expect_within(follow(trace, data, load, data.rows()), data, kOfPeak);
}

TraceInput ramp_down(double t, double ramp_s) {
  const double f = t < 0 ? 50 : std::max(0.0, 50 * (1 - t / ramp_s));
  return {vf_law(f, kUb, kUn, 50), f};
}

TEST_P(Trajectory, DecelerationIntoTheLinkFollowsD) {
  const ReferenceTable data("d_decel_overvoltage_2k2.csv.gz");
  PlantTrace trace(
      "motulator_2k2", 0.15, [](double t) { return ramp_down(t - 0.1, 1); }, solver());
  trace.use_link({0.000235, 2, 565.685424949238});
  trace.start({0.0498284404193, -1.03655303455, 0.0476451020381, -0.991134273592}, 157.079632679, 565.333158049);
  const auto link = data.numbers("Vdc_V");
  std::size_t row = 0;
  double worst_link = 0;
  const auto compare = [&](double t) {
    worst_link = std::max(worst_link, std::abs(trace.link_v() - link[row++]));
    if (t == 0.1) trace.jump();
  };
  expect_within(follow(trace, data, compare, data.rows()), data, kOfPeak);
  EXPECT_LE(worst_link, kOfPeak * 820);
}

TEST_P(Trajectory, LinkLevelsOfDAreReachedOnTime) {
  PlantTrace trace(
      "motulator_2k2", 0.15, [](double t) { return ramp_down(t - 0.1, 1); }, solver());
  trace.use_link({0.000235, 2, 565.685424949238});
  trace.start({0.0498284404193, -1.03655303455, 0.0476451020381, -0.991134273592}, 157.079632679, 565.333158049);
  trace.run_to(0.1);
  trace.jump();
  const std::pair<double, double> events[] = {{650, 0.132003238}, {700, 0.138485793}, {720, 0.140839191},
                                              {740, 0.143107419}, {760, 0.145310776}, {780, 0.147464214},
                                              {800, 0.149579121}, {820, 0.151664409}};
  for (const auto& [level, time] : events) {
    trace.watch_link(level);
    bool reached = false;
    while (!reached && trace.t() < 0.2) reached = trace.run_to(std::floor(trace.t() * 1000 + 1.0001) / 1000);
    ASSERT_TRUE(reached) << level;
    EXPECT_NEAR(trace.t(), time, 1e-4) << level;
    trace.jump();
  }
}

TEST_P(Trajectory, LockedRotorOnLineFollowsE1) {
  const ReferenceTable data("e1_locked_rotor_dol_2k2.csv.gz");
  PlantTrace trace(
      "motulator_2k2", 0.015,
      [](double) {
        return TraceInput{kUn, 50};
      },
      solver());
  trace.model.load.locked = true;
  trace.start();
  expect_within(follow(trace, data, kNothing, data.rows()), data, kOfPeak);
}

TEST_P(Trajectory, LockedRotorAtFiveHertzFollowsE2) {
  const ReferenceTable data("e2_locked_rotor_vf5hz_2k2.csv.gz");
  const auto input = [](double t) {
    const double f = t < 0.5 ? 10 * t : 5;
    return TraceInput{vf_law(f, kUb, kUn, 50), f};
  };
  PlantTrace trace("motulator_2k2", 0.015, input, solver());
  trace.model.load.locked = true;
  trace.start();
  expect_within(follow(
                    trace, data,
                    [&](double t) {
                      if (t == 0.5) trace.jump();
                    },
                    data.rows()),
                data, kOfPeak);
}

// Voltage held for 250 us at a time in the stator frame, from another simulator. Here the frame stands still with its d
// axis on the voltage vector, and is turned when the vector changes direction.
TEST_P(Trajectory, VoltageReplayFollowsX0) {
  const ReferenceTable data("x0_motulator_vhz_replay.csv.gz");
  const auto times = data.numbers("t_s"), u_a = data.numbers("u_alpha_V"), u_b = data.numbers("u_beta_V");
  const auto omega = data.numbers("omega_rad_s"), torque = data.numbers("Te_Nm");
  const auto i_a = data.numbers("is_alpha_A"), i_b = data.numbers("is_beta_A");
  double voltage = 0, angle = 0;
  PlantTrace trace(
      "motulator_2k2", 0.015,
      [&](double) {
        return TraceInput{voltage, 0};
      },
      solver());
  trace.start();
  double worst_speed = 0, worst_torque = 0, worst_current = 0, peak_current = 0;
  for (std::size_t row = 0; row < data.rows(); ++row) {
    trace.run_to(times[row]);
    const Flows f = trace.now();
    worst_speed = std::max(worst_speed, std::abs(trace.omega() - omega[row]));
    worst_torque = std::max(worst_torque, std::abs(f.torque_nm - torque[row]));
    const double is_alpha = f.i.i_sd * std::cos(angle) - f.i.i_sq * std::sin(angle);
    const double is_beta = f.i.i_sd * std::sin(angle) + f.i.i_sq * std::cos(angle);
    worst_current = std::max(worst_current, std::hypot(is_alpha - i_a[row], is_beta - i_b[row]));
    peak_current = std::max(peak_current, std::hypot(i_a[row], i_b[row]));

    if (times[row] >= 1.1) trace.model.load.hoist_nm = 14.6;
    voltage = std::hypot(u_a[row], u_b[row]);
    const double next_angle = voltage > 0 ? std::atan2(u_b[row], u_a[row]) : angle;
    trace.turn_frame(next_angle - angle);
    angle = next_angle;
    trace.jump();
  }
  EXPECT_LE(worst_speed, kOfPeak * peak(omega));
  EXPECT_LE(worst_torque, kOfPeak * peak(torque));
  EXPECT_LE(worst_current, kOfPeak * peak_current);
}

std::string solver_name(const testing::TestParamInfo<SolverChoice>& parameter) {
  switch (parameter.param) {
    case SolverChoice::kErk: return "Erk";
    case SolverChoice::kCvodeBdf: return "CvodeBdf";
    case SolverChoice::kRk4: return "Rk4";
  }
  return "";
}

INSTANTIATE_TEST_SUITE_P(Solvers, Trajectory,
                         testing::Values(SolverChoice::kErk, SolverChoice::kCvodeBdf, SolverChoice::kRk4), solver_name);

}  // namespace
}  // namespace vinv::plant::test
