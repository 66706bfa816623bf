// Auto tuning of the Mitsubishi families (Pr.96): a direct current through the standing motor gives its stator
// resistance (Pr.90). Typical for the family; the times are chosen.
#pragma once

#include <cstdint>

#include "motor_model/plant/power_plant.hpp"
#include "sim/base/archive.hpp"

namespace vinv::inverter::mitsubishi {

// What Pr.96 reads.
enum class TuningStatus : std::uint8_t { kOff = 0, kArmed = 1, kRunning = 2, kDone = 3, kStopped = 8, kAlarm = 9 };
VINV_ENUM_RANGE(TuningStatus, kOff, kAlarm);

class AutoTuning {
 public:
  bool running() const { return running_; }
  double resistance_ohm() const { return resistance_ohm_; }

  void start();
  void abort() { running_ = false; }
  // One control tick. Returns the stage input for it; running() is false once the measurement is complete.
  plant::StageInput step(double period_s, double rated_current_a_rms, double voltage_limit_peak_v,
                         const plant::PlantMeasurements& measured);
  bool succeeded() const { return resistance_ohm_ > 0; }

 private:
  bool running_ = false;
  double elapsed_s_ = 0;
  double voltage_peak_v_ = 0;
  double sum_voltage_ = 0;
  double sum_current_ = 0;
  double resistance_ohm_ = 0;
  VINV_ARCHIVE(AutoTuning, running_, elapsed_s_, voltage_peak_v_, sum_voltage_, sum_current_, resistance_ohm_);
};

}  // namespace vinv::inverter::mitsubishi
