#include "motor_model/drive/slip_compensation.hpp"

#include <algorithm>
#include <cmath>

namespace vinv::drive {
namespace {

// Torque current beyond this many times the rated one is not compensated.
constexpr double kMostLoad = 2;

// Torque-forming part of the motor's rated current.
double rated_torque_current_a_rms(const DriveSettings& s) {
  const double rated = s.motor_rated_current_a_rms > 0 ? s.motor_rated_current_a_rms : s.rated_current_a_rms;
  const double no_load = s.motor_no_load_current_a_rms;
  return no_load < rated ? std::sqrt(rated * rated - no_load * no_load) : rated;
}

}  // namespace

double SlipCompensation::step(double dt_s, const DriveSettings& settings, double ramp_hz, double torque_current_a_rms) {
  const double rated = rated_torque_current_a_rms(settings);
  const bool off = settings.rated_slip_hz <= 0 || rated <= 0 ||
                   (!settings.slip_in_constant_output && ramp_hz > settings.base_frequency_hz);
  const double load = off ? 0 : std::clamp(torque_current_a_rms / rated, -kMostLoad, kMostLoad);
  lag_.step(dt_s, settings.slip_response_s, load * settings.rated_slip_hz);
  return off ? 0 : lag_.value();
}

double Droop::step(double dt_s, const DriveSettings& settings, bool ramping, double torque_current_a_rms) {
  const double rated = rated_torque_current_a_rms(settings);
  const bool off = settings.droop_hz <= 0 || rated <= 0 || (ramping && !settings.droop_in_ramps);
  const double load = off ? 0 : std::clamp(torque_current_a_rms / rated, -kMostLoad, kMostLoad);
  lag_.step(dt_s, settings.droop_filter_s, load * settings.droop_hz);
  return settings.droop_hz > 0 ? lag_.value() : 0;
}

}  // namespace vinv::drive
