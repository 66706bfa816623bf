// The control core of a V/f inverter, common to all families: run states, ramps, V/f law, slip compensation, DC
// injection brake, stall prevention, protections. One call per control tick. All values are physical; which parameter
// sets them is the family's personality (motor_model/inverter). Plain data throughout, so that a copy is a snapshot.
#pragma once

#include "motor_model/drive/brake_duty.hpp"
#include "motor_model/drive/dc_brake.hpp"
#include "motor_model/drive/detection_outputs.hpp"
#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/fast_current_limit.hpp"
#include "motor_model/drive/filters.hpp"
#include "motor_model/drive/power_failure.hpp"
#include "motor_model/drive/protections.hpp"
#include "motor_model/drive/ramp_generator.hpp"
#include "motor_model/drive/shortest_ramp.hpp"
#include "motor_model/drive/slip_compensation.hpp"
#include "motor_model/drive/stall_prevention.hpp"
#include "motor_model/drive/torque_current.hpp"
#include "motor_model/drive/vector_control.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

class DriveCore {
 public:
  // Settings may change at any tick; they are not stored. period is the control tick.
  //
  // A start is by level: with a direction on, a set frequency of at least the start frequency and nothing against it
  // (MRS, permit, DC link, power failure) the output comes on at the start frequency. After reset() too; a family that
  // wants a new start edge takes the direction away meanwhile.
  const DriveOutputs& tick(Duration period, const DriveSettings& settings, const DriveCommand& command,
                           const Sensors& sensors);
  const DriveOutputs& outputs() const { return out_; }

  // Clears a trip. Thermal accumulators survive unless cold: power-off clears them (family rule).
  enum class Accumulators : std::uint8_t { kKeep, kClear };
  void reset(Accumulators accumulators);

  // An alarm that the personality raised (option, EEPROM, CPU ...) or the user injected: output off, state tripped.
  void force_trip();

 private:
  struct Tick;  // the arguments of one tick

  bool output_on() const;
  void output_off(RunState state);
  void start(const Tick& t);
  void catch_motor(const Tick& t, double before_hz);
  void stop_or_run(const Tick& t);
  void run_ramp(const Tick& t, double target_hz);
  void begin_brake(const Tick& t);
  void brake(const Tick& t);
  void supply_failed(const Tick& t);
  void trip(const Trip& cause);
  Motion motion(double target_hz) const;
  void set_stage(const Tick& t);
  void set_vector_stage(const Tick& t, double reference_hz, double limit, Motion motion);
  void publish(const Tick& t);

  RunState state_ = RunState::kStopped;
  RunState state_before_dip_ = RunState::kStopped;
  RampGenerator ramp_;
  StallPrevention stall_;
  ShortestRamp shortest_;
  SlipCompensation slip_;
  Droop droop_;
  VectorControl vector_;
  double start_hold_left_s_ = 0;
  FastCurrentLimit current_limit_;
  FirstOrderLag compensation_current_;
  DcBrake dc_brake_;
  OnDelay coast_delay_;
  LinkSupervision link_;
  PowerFailure power_failure_;
  RestartCushion cushion_;
  BrakeDuty brake_duty_;
  Protections protections_;
  DetectionOutputs detection_;
  bool catching_ = false;             // since a turning motor was caught, until the set frequency is reached
  bool stalled_at_constant_ = false;  // stall prevention has taken a constant speed down and it is not yet back
  bool overload_ = false;
  bool link_overload_ = false;
  DriveOutputs out_;
  VINV_ARCHIVE(DriveCore, state_, state_before_dip_, ramp_, stall_, shortest_, slip_, droop_, vector_,
               start_hold_left_s_, current_limit_, compensation_current_, dc_brake_, coast_delay_, link_,
               power_failure_, cushion_, brake_duty_, protections_, detection_, catching_, stalled_at_constant_,
               overload_, link_overload_, out_);
};

}  // namespace vinv::drive
