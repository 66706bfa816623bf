// Control of speed and torque without an encoder (A700 Pr.800 = 10 to 12): a speed controller whose torque is limited,
// or a commanded torque within speed limits. Torque becomes slip on top of the rotor's frequency, and the voltage is
// that of the motor's constants at this torque.
//
// An approximation: speed and torque are the motor's own, so the estimator is perfect; there is no current controller,
// so the torque follows within some 50 ms and the speed controller has a third of the real one's response.
#pragma once

#include "motor_model/drive/filters.hpp"
#include "motor_model/drive/ramp_generator.hpp"
#include "motor_model/drive/vector_settings.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class VectorControl {
 public:
  struct Input {
    double reference_hz = 0;  // signed: the speed, or in torque control its limit in the direction of the start signal
    double backward_limit_hz = 0;  // torque control: magnitude of the limit against that direction
    double torque_percent = 0;     // torque control: commanded, positive in the forward direction
    double rotor_hz = 0;           // signed, electrical
    double torque_nm = 0;          // air gap, signed
    double voltage_factor = 1;     // what the fast current limit left of the voltage
    Motion motion = Motion::kConstant;
  };
  struct Output {
    double frequency_hz = 0;    // of the stator, signed
    double voltage_v_rms = 0;   // line to line
    double torque_percent = 0;  // commanded, signed
    bool torque_limited = false;
    bool speed_limited = false;  // torque control
    bool stalled = false;
  };
  Output step(double dt_s, const VectorSettings& settings, const Input& input);
  void reset() { *this = VectorControl{}; }

 private:
  double speed_torque(double dt_s, const VectorSettings& s, const Input& in, double least, double most);
  double limited_command(double dt_s, const VectorSettings& s, const Input& in, double least, double most,
                         bool& speed_limited);

  FirstOrderLag set_speed_;
  FirstOrderLag torque_;
  FirstOrderLag ahead_;
  FirstOrderLag flux_;  // part of the rated one
  double flux_wanted_ = 1;
  double integral_ = 0;    // of the speed controller, parts of rated torque
  double most_speed_ = 0;  // ... of the speed limits of torque control
  double least_speed_ = 0;
  double trim_ = 0;  // torque that the constants miss
  double last_reference_hz_ = 0;
  bool began_ = false;
  OnDelay stalled_;
  VINV_ARCHIVE(VectorControl, set_speed_, torque_, ahead_, flux_, flux_wanted_, integral_, most_speed_, least_speed_,
               trim_, last_reference_hz_, began_, stalled_);
};

}  // namespace vinv::drive
