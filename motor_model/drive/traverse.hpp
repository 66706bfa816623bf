// Traverse (A700 Pr.592-597): the frequency swings around the set one, with a dip at each turn, so that a winder lays
// its yarn across the whole bobbin.
#pragma once

#include <cstdint>

#include "sim/base/archive.hpp"

namespace vinv::drive {

struct TraverseSettings {
  double amplitude = 0;  // f1, part of the set frequency
  double dip_down = 0;   // f2, part of the amplitude: undershoot when the way down begins
  double dip_up = 0;     // f3: overshoot when the way up begins
  double up_s = 5;       // from the lowest to the highest frequency
  double down_s = 5;
};

class Traverse {
 public:
  // The frequency to run at while traverse is active and the set frequency has been reached.
  double step(double dt_s, const TraverseSettings& settings, double set_hz);
  void reset() { *this = Traverse{}; }

 private:
  bool started_ = false;
  bool up_ = true;
  double position_ = 0;  // -1 lowest ... 1 highest
  VINV_ARCHIVE(Traverse, started_, up_, position_);
};

}  // namespace vinv::drive
