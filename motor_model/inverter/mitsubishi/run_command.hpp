// Start signals to a direction: STF and STR as Pr.250 reads them, self-holding by STOP, Pr.78. Typical for the family.
#pragma once

#include "motor_model/drive/drive_core.hpp"
#include "sim/base/archive.hpp"

namespace vinv::inverter::mitsubishi {

// What Pr.250 says.
struct StopSelection {
  bool str_is_direction = false;  // STF starts, STR chooses the direction
  bool coasting = false;
  double coast_delay_s = 0;
};
StopSelection stop_selection(double pr250);  // 0-100, 1000-1100 s, 8888, 9999

struct StartSignals {
  bool stf = false;
  bool str = false;
  bool stop_hold = false;  // signal STOP on: STF and STR may be pulses
};

// The held pulses of three-wire operation.
class StartLatch {
 public:
  // STF and STR on together are a stop, unless STR is only the direction.
  drive::RunDirection step(const StartSignals& in, bool str_is_direction);

 private:
  bool last_stf_ = false;
  bool last_str_ = false;
  bool held_stf_ = false;
  bool held_str_ = false;
  VINV_ARCHIVE(StartLatch, last_stf_, last_str_, held_stf_, held_str_);
};

// Pr.78: 1 forbids reverse, 2 forbids forward.
drive::RunDirection permitted(drive::RunDirection wanted, int raw_pr78);

}  // namespace vinv::inverter::mitsubishi
