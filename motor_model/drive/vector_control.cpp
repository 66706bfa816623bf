#include "motor_model/drive/vector_control.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vinv::drive {
namespace {

constexpr double kTrim_s = 0.05;     // integral action from missing torque to slip
constexpr double kMostTrim = 0.5;    // of rated torque
constexpr double kLeastFlux = 0.2;   // that a slip is computed with
constexpr double kLeastBuilt = 0.5;  // likewise, of the flux that it is to become: voltage laws know no build-up
constexpr double kStall_s = 3;
constexpr double kStallBand = 0.01;  // of rated torque: a limit at the stall level counts

// Torque has two ends in each direction of rotation: driving it on and braking it.
struct Limits {
  double least;
  double most;
};
Limits limits(const VectorSettings& s, const VectorControl::Input& in, double flux) {
  const double common = in.motion == Motion::kAccelerating   ? s.limit_accelerating_percent
                        : in.motion == Motion::kDecelerating ? s.limit_decelerating_percent
                                                             : -1;
  const auto limit = [&](Quadrant q) { return (common >= 0 ? common : s.limit_percent[q]) / 100; };
  const bool forward = in.rotor_hz > 0 || (in.rotor_hz == 0 && in.reference_hz >= 0);
  Limits l = forward ? Limits{-limit(kForwardBraking), limit(kForwardDriving)}
                     : Limits{-limit(kReverseDriving), limit(kReverseBraking)};
  const double f = std::abs(in.rotor_hz);
  if (!s.constant_torque_above_base && f > s.rated_frequency_hz) {
    l.least *= s.rated_frequency_hz / f;
    l.most *= s.rated_frequency_hz / f;
  }
  // While the flux builds up there is that much less torque to have.
  const double built = std::clamp(flux, 0.0, 1.0);
  return {l.least * built, l.most * built};
}

}  // namespace

double VectorControl::speed_torque(double dt_s, const VectorSettings& s, const Input& in, double least, double most) {
  const double reference = set_speed_.step(dt_s, s.speed_filter_s, in.reference_hz);
  const double error = (reference - in.rotor_hz) / s.rated_frequency_hz;
  const double gain = s.response_rad_s * s.start_s;
  double ahead = 0;
  if (s.feed_forward > 0 && dt_s > 0) {
    const double rate = (reference - last_reference_hz_) / s.rated_frequency_hz / dt_s;
    const double wanted = s.feed_forward * (1 + s.load_inertia) * s.start_s * rate;
    const double bound = s.feed_forward_most_percent / 100;
    ahead = ahead_.step(dt_s, s.feed_forward_filter_s, std::clamp(wanted, -bound, bound));
  }
  last_reference_hz_ = reference;
  const double wanted = gain * error + integral_ + ahead;
  if (s.integral_s <= 0) {
    integral_ = 0;
  } else if ((wanted < most || error < 0) && (wanted > least || error > 0)) {
    // At a limit the integral does not wind up further.
    integral_ = std::clamp(integral_ + gain * error * dt_s / s.integral_s, least, most);
  }
  return wanted;
}

// The command, taken back where it would drive the motor beyond a speed limit.
double VectorControl::limited_command(double dt_s, const VectorSettings& s, const Input& in, double least, double most,
                                      bool& speed_limited) {
  const double ahead_hz = std::abs(in.reference_hz);
  const bool forward = in.reference_hz >= 0;
  const double highest_hz = forward ? ahead_hz : in.backward_limit_hz;
  const double lowest_hz = forward ? -in.backward_limit_hz : -ahead_hz;
  const double command = std::clamp(in.torque_percent / 100, least, most);
  const double gain = s.response_rad_s * s.start_s;
  const double above = (highest_hz - in.rotor_hz) / s.rated_frequency_hz;
  const double below = (lowest_hz - in.rotor_hz) / s.rated_frequency_hz;
  const double high = gain * above + most_speed_;
  const double low = gain * below + least_speed_;
  const double torque = std::clamp(std::max(std::min(command, high), low), least, most);
  speed_limited = high < command || low > command;
  // The integrals hold the speed at its limit; off it they are given back.
  const double share = s.integral_s > 0 ? dt_s / s.integral_s : 0;
  most_speed_ =
      high < command ? std::clamp(most_speed_ + gain * above * share, least, most) : most_speed_ * (1 - share);
  least_speed_ =
      low > command ? std::clamp(least_speed_ + gain * below * share, least, most) : least_speed_ * (1 - share);
  last_reference_hz_ = in.reference_hz;
  return torque;
}

VectorControl::Output VectorControl::step(double dt_s, const VectorSettings& s, const Input& in) {
  Output out;
  if (!began_) {
    began_ = true;
    set_speed_.set(in.reference_hz);
    last_reference_hz_ = in.reference_hz;
  }
  const double base = s.rated_frequency_hz;
  const Limits most = limits(s, in, flux_.value() / std::max(flux_wanted_, kLeastFlux));
  double wanted = 0;
  if (s.torque_control) {
    integral_ = 0;
    wanted = limited_command(dt_s, s, in, most.least, most.most, out.speed_limited);
    out.torque_limited = in.torque_percent / 100 > most.most || in.torque_percent / 100 < most.least;
  } else {
    most_speed_ = least_speed_ = 0;
    wanted = speed_torque(dt_s, s, in, most.least, most.most);
    out.torque_limited = wanted > most.most || wanted < most.least;
  }
  const double torque = std::clamp(torque_.step(dt_s, s.torque_filter_s, std::clamp(wanted, most.least, most.most)),
                                   most.least, most.most);
  out.torque_percent = torque * 100;

  // Flux: weaker above the rated frequency, and without load where that is set.
  const double idle = s.idle_excitation + (1 - s.idle_excitation) * std::min(1.0, std::abs(torque));
  const double field = std::abs(in.rotor_hz) > base ? base / std::abs(in.rotor_hz) : 1;
  const double flux_wanted = flux_wanted_ = std::min(idle, field);
  const double rotor_s =
      s.torque_current_a_rms / std::max(1e-6, s.no_load_current_a_rms * 2 * std::numbers::pi * s.rated_slip_hz);
  flux_.step(dt_s, rotor_s, flux_wanted);

  const double actual = s.rated_torque_nm > 0 ? in.torque_nm / s.rated_torque_nm : torque;
  // A voltage that is held back cannot give the torque: nothing to learn from it.
  if (in.voltage_factor >= 1) trim_ = std::clamp(trim_ + (torque - actual) * dt_s / kTrim_s, -kMostTrim, kMostTrim);
  const double flux = std::max(std::max(flux_.value(), kLeastBuilt * flux_wanted), kLeastFlux);
  const double slip_hz = (torque + trim_) * s.rated_slip_hz / (flux * flux);
  out.frequency_hz = in.rotor_hz + slip_hz;

  const double id = s.no_load_current_a_rms * flux_wanted;
  const double iq = s.torque_current_a_rms * torque / std::max(flux_wanted, kLeastFlux);
  const double x = out.frequency_hz / base;
  const double vd = s.stator_ohm * id - x * s.leakage_ohm * iq;
  const double vq = s.stator_ohm * iq + x * s.magnetising_ohm * id;
  out.voltage_v_rms = std::numbers::sqrt3 * std::hypot(vd, vq);

  const bool stuck = std::abs(in.rotor_hz) < s.stall_hz && std::abs(torque) >= s.stall_percent / 100 - kStallBand &&
                     out.torque_limited;
  out.stalled = stalled_.step(dt_s, stuck && !s.torque_control, kStall_s);
  return out;
}

}  // namespace vinv::drive
