// Switch-over of the motor between inverter and commercial supply: which contactors are closed. MC1 feeds the inverter,
// MC2 puts the motor on the mains, MC3 on the inverter; MC2 and MC3 are never closed together. Pr.135 to Pr.139 and
// Pr.159, typical for the family.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/base/archive.hpp"

namespace vinv::inverter::a700 {

class CommercialSwitch {
 public:
  struct Settings {
    double interlock_s = 1;               // both open, Pr.136
    double start_wait_s = 0.5;            // MC3 closed before the output comes on, Pr.137
    double catch_wait_s = 0;              // ... and this in addition where the motor turns, Pr.57
    bool mains_at_alarm = false;          // Pr.138
    std::optional<double> automatic_hz;   // to the mains at and above this output, Pr.139
    std::optional<double> back_below_hz;  // Pr.159: back when the set frequency is this far below
  };
  struct Input {
    bool enabled = false;         // MRS: operation at all
    bool inverter_wanted = true;  // CS: off is the commercial supply
    bool start_on = false;
    bool alarm = false;
    bool alarm_keeps_off = false;  // not to the mains with this one: motor or control at fault
    bool running = false;
    double output_hz = 0;  // magnitude
    double set_hz = 0;
  };
  void step(double dt_s, const Settings& settings, const Input& input);

  bool mc1() const { return mc1_; }
  bool mc2() const { return place_ == Place::kMains; }
  bool mc3() const { return place_ == Place::kInverter; }
  bool output_permitted() const { return permitted_; }
  // The motor comes from the mains and turns: the output that comes on next has to catch it, also to decelerate it.
  bool catches() const { return catches_; }
  bool catches_to_stop() const { return catches_ && to_stop_; }

 private:
  enum class Place : std::uint8_t { kOpen, kInverter, kMains };
  friend VINV_ENUM_RANGE(Place, kOpen, kMains);
  Place wanted(const Settings& settings, const Input& input);

  Place place_ = Place::kOpen;
  double in_place_s_ = 0;
  bool mc1_ = false;
  bool automatic_ = false;  // on the mains by Pr.139
  bool permitted_ = false;
  bool catches_ = false;
  bool to_stop_ = false;
  VINV_ARCHIVE(CommercialSwitch, place_, in_place_s_, mc1_, automatic_, permitted_, catches_, to_stop_);
};

}  // namespace vinv::inverter::a700
