// Remote setting (E500 Pr.59): RH raises a frequency, RM lowers it, RL clears it, as a motor potentiometer. The result
// is added to the main speed by the personality.
#pragma once

#include <optional>

#include "sim/base/archive.hpp"

namespace vinv::drive {

struct RemoteSettings {
  bool memory = true;           // Pr.59 = 1: the frequency survives power-off; 2: it does not
  double raise_rate_hz_s = 10;  // by Pr.44 or 7; infinite: at once
  double lower_rate_hz_s = 10;  // by Pr.45, 44 or 8
  double max_hz = 120;          // what is left up to the maximum frequency
};

struct RemoteInputs {
  bool raise = false;  // RH
  bool lower = false;  // RM; both: no change
  bool clear = false;  // RL, before the others
  bool start = false;  // a start signal is on
};

class RemoteSetting {
 public:
  static constexpr double kStoreAfter_s = 60;

  // Returns the remote frequency, Hz, 0 ... max_hz.
  double step(double dt_s, const RemoteSettings& settings, const RemoteInputs& inputs);
  double frequency_hz() const { return frequency_hz_; }

  // With memory: the frequency to write to the EEPROM, once, when it differs from the stored one and either the start
  // signal has gone off or RH and RM have both rested for a minute.
  std::optional<double> take_store();
  // At power-on: the stored frequency with memory, 0 without.
  void power_on(double stored_hz);

 private:
  double frequency_hz_ = 0;
  double stored_hz_ = 0;
  double rested_s_ = 0;
  bool last_start_ = false;
  bool store_due_ = false;
  VINV_ARCHIVE(RemoteSetting, frequency_hz_, stored_hz_, rested_s_, last_start_, store_due_);
};

}  // namespace vinv::drive
