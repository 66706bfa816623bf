// Mechanical brake of a hoist (A700 Pr.278-285 with Pr.292 = 7 or 8): the motor builds up torque against the closed
// brake before it opens, and stands on its own again before it closes.
#pragma once

#include <cstdint>

#include "motor_model/drive/filters.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

struct BrakeSequenceSettings {
  double open_hz = 3;                 // the output waits here for the brake to open
  double open_current_percent = 130;  // of rated: torque is there
  double open_current_s = 0.3;        // for this long
  double start_s = 0.3;               // from the open brake to the ramp going on
  double close_hz = 6;                // the brake closes below this on the way down
  double stop_s = 0.3;                // from the closed brake to the output going off
  bool completion = true;             // the brake reports that it is open (BRI)
};

class BrakeSequence {
 public:
  static constexpr double kPatience_s = 2;  // for the brake to be asked to open, to open, to close

  struct Input {
    bool start = false;          // a direction is commanded
    double output_hz = 0;        // magnitude
    double current_percent = 0;  // of rated
    bool open = false;           // BRI
  };
  enum class Fault : std::uint8_t {
    kNone,
    kNotAsked,   // MB4: no torque within the patience
    kNotOpened,  // MB5: asked to open, BRI does not come
    kClosed,     // MB6: BRI went off while the brake should be open
    kNotClosed,  // MB7: asked to close, BRI stays
  };
  struct Decision {
    bool run = false;     // the output has to run, whatever the start signal says
    double most_hz = -1;  // and no further than this; negative: as commanded
    Fault fault = Fault::kNone;
  };
  Decision step(double dt_s, const BrakeSequenceSettings& settings, const Input& input);
  bool opening_requested() const { return bof_; }  // BOF
  void reset() { *this = BrakeSequence{}; }

 private:
  enum class Phase : std::uint8_t { kClosed, kTorque, kOpening, kOpen, kClosing };
  friend VINV_ENUM_RANGE(Phase, kClosed, kClosing);
  void enter(Phase phase);

  Phase phase_ = Phase::kClosed;
  bool bof_ = false;
  OnDelay torque_;
  OnDelay settled_;
  OnDelay patience_;
  VINV_ARCHIVE(BrakeSequence, phase_, bof_, torque_, settled_, patience_);
};

}  // namespace vinv::drive
