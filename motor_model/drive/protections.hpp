// All that shuts the output with an alarm, judged once per tick. What was measured against which level goes into Trip.
#pragma once

#include <array>
#include <optional>

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/drive/electronic_thermal.hpp"
#include "motor_model/drive/filters.hpp"
#include "motor_model/drive/inverter_overload.hpp"
#include "sim/base/archive.hpp"

namespace vinv::drive {

// Level of the over-current comparator on the magnitude of the current vector.
double over_current_level_a_peak(const DriveSettings& settings);

// Earth fault: tested while the output comes on, not later (there the over-current comparator acts).
class EarthFault {
 public:
  static constexpr double kTestWindow_s = 0.1;
  void begin() { left_s_ = kTestWindow_s; }
  bool step(double dt_s, bool detection, bool fault) {
    const bool trips = left_s_ > 0 && detection && fault;
    left_s_ = left_s_ > dt_s ? left_s_ - dt_s : 0;
    return trips;
  }

 private:
  double left_s_ = 0;
  VINV_ARCHIVE(EarthFault, left_s_);
};

// An open output phase must persist while the output is on.
class OutputPhaseLoss {
 public:
  static constexpr double kPersistence_s = 0.5;
  bool step(double dt_s, bool protection, bool gates_on, bool phase_open) {
    return open_.step(dt_s, protection && gates_on && phase_open, kPersistence_s);
  }

 private:
  OnDelay open_;
  VINV_ARCHIVE(OutputPhaseLoss, open_);
};

class Protections {
 public:
  // The state as it was in the tick that the sensors tell about.
  struct Situation {
    RunState state = RunState::kStopped;
    bool gates_on = false;
    double output_frequency_hz = 0;  // signed
  };

  // The output comes on at the end of this tick.
  void begin_output() { earth_fault_.begin(); }
  // Thermal models, whatever the state.
  void observe(double dt_s, const DriveSettings& settings, const Sensors& sensors, const Situation& situation);
  // The first cause in order of the hardware's speed; nothing while all is well.
  std::optional<Trip> check(double dt_s, const DriveSettings& settings, const DriveCommand& command,
                            const Sensors& sensors, const Situation& situation);
  void clear_accumulators();

  // Of the motor that runs.
  const ElectronicThermal& motor() const { return motors_[second_motor_ ? 1 : 0]; }
  const InverterOverload& inverter() const { return inverter_; }

 private:
  std::array<ElectronicThermal, 2> motors_;
  bool second_motor_ = false;
  InverterOverload inverter_;
  EarthFault earth_fault_;
  OutputPhaseLoss phase_loss_;
  VINV_ARCHIVE(Protections, motors_, second_motor_, inverter_, earth_fault_, phase_loss_);
};

}  // namespace vinv::drive
