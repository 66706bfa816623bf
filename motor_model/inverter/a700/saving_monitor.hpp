// Energy saving monitor: what the motor would take on the commercial supply, less what the inverter takes, at once, as
// an average, and summed up. Pr.891 to Pr.899, typical for the family.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/base/archive.hpp"

namespace vinv::inverter::a700 {

// Pr.894: how the flow is controlled on the commercial supply.
enum class Throttling : std::uint8_t { kDischargeDamper, kInletDamper, kValve, kNone };

// Part of the rated power on the commercial supply, of the speed as a part of the rated one (0 to 1).
double commercial_power_share(Throttling throttling, double speed);

class SavingMonitor {
 public:
  struct Settings {
    double motor_kw = 0;  // Pr.893
    double load = 1;      // Pr.892
    Throttling throttling = Throttling::kDischargeDamper;
    bool rate_of_capacity = false;    // Pr.895 = 1: of Pr.893 instead of the commercial power
    std::optional<double> average_s;  // Pr.897; empty: no averages
    bool held = false;                // Pr.898 = 1: the sum stands
  };
  struct Input {
    bool running = false;
    double speed = 0;  // output frequency as a part of the base frequency
    double input_kw = 0;
  };
  void step(double dt_s, const Settings& settings, const Input& input);
  void clear_sum() { saved_kws_ = counted_s_ = 0; }

  double saving_kw() const { return saving_kw_; }                        // 1) never below 0
  double rate_percent() const { return rate_percent_; }                  // 2)
  double average_kw() const { return average_kw_; }                      // 3)
  double average_rate_percent() const { return average_rate_percent_; }  // 4)
  bool updated() const { return updated_; }                              // Y92: turns over with each new average
  double saved_kws() const { return saved_kws_; }                        // since the last take
  double counted_s() const { return counted_s_; }
  void take() { saved_kws_ = counted_s_ = 0; }  // what was counted is elsewhere now

 private:
  double saving_kw_ = 0;
  double rate_percent_ = 0;
  double sum_kws_ = 0;
  double sum_percent_s_ = 0;
  double since_s_ = 0;
  double average_kw_ = 0;
  double average_rate_percent_ = 0;
  bool updated_ = false;
  double saved_kws_ = 0;
  double counted_s_ = 0;
  VINV_ARCHIVE(SavingMonitor, saving_kw_, rate_percent_, sum_kws_, sum_percent_s_, since_s_, average_kw_,
               average_rate_percent_, updated_, saved_kws_, counted_s_);
};

}  // namespace vinv::inverter::a700
