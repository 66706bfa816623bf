#include "motor_model/inverter/a700/commercial_switch.hpp"

#include <algorithm>

namespace vinv::inverter::a700 {
namespace {

constexpr double kLong_s = 1e6;

}  // namespace

CommercialSwitch::Place CommercialSwitch::wanted(const Settings& settings, const Input& input) {
  if (input.alarm) {
    automatic_ = false;
    return settings.mains_at_alarm && !input.alarm_keeps_off ? Place::kMains : Place::kOpen;
  }
  if (!input.enabled) {
    automatic_ = false;
    return place_ == Place::kMains ? Place::kOpen : Place::kInverter;
  }
  if (!input.inverter_wanted) {
    automatic_ = false;
    return Place::kMains;
  }
  if (!settings.automatic_hz) {
    automatic_ = false;
    return Place::kInverter;
  }
  if (automatic_) {
    const bool slower = settings.back_below_hz && input.set_hz < *settings.automatic_hz - *settings.back_below_hz;
    if (slower || !input.start_on) {
      automatic_ = false;
      to_stop_ = !input.start_on;
    }
  } else if (input.running && input.start_on && permitted_ && input.output_hz >= *settings.automatic_hz) {
    automatic_ = true;
  }
  return automatic_ ? Place::kMains : Place::kInverter;
}

void CommercialSwitch::step(double dt_s, const Settings& settings, const Input& input) {
  mc1_ = !input.alarm;
  in_place_s_ = std::min(in_place_s_ + dt_s, kLong_s);
  const Place next = wanted(settings, input);
  if (place_ != Place::kOpen && next != place_) {
    if (place_ == Place::kMains) catches_ = next == Place::kInverter;
    place_ = Place::kOpen;
    in_place_s_ = 0;
  } else if (place_ == Place::kOpen && next != Place::kOpen && in_place_s_ >= settings.interlock_s) {
    place_ = next;
    in_place_s_ = 0;
    if (next == Place::kMains) catches_ = to_stop_ = false;
  }
  permitted_ = input.enabled && !input.alarm && next == Place::kInverter && place_ == Place::kInverter &&
               in_place_s_ >= settings.start_wait_s + (catches_ ? settings.catch_wait_s : 0);
  if (permitted_ && input.running) catches_ = to_stop_ = false;
  // Without a start signal of an automatic switch-over the motor coasts: later it may stand.
  if (permitted_ && !input.start_on && !to_stop_) catches_ = false;
}

}  // namespace vinv::inverter::a700
