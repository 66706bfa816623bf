#include "motor_model/drive/remote_setting.hpp"

#include <algorithm>

namespace vinv::drive {

double RemoteSetting::step(double dt_s, const RemoteSettings& settings, const RemoteInputs& inputs) {
  if (dt_s <= 0) return frequency_hz_;
  if (inputs.clear) {
    frequency_hz_ = 0;
  } else if (inputs.raise && !inputs.lower) {
    frequency_hz_ += settings.raise_rate_hz_s * dt_s;
  } else if (inputs.lower && !inputs.raise) {
    frequency_hz_ -= settings.lower_rate_hz_s * dt_s;
  }
  frequency_hz_ = std::clamp(frequency_hz_, 0.0, std::max(settings.max_hz, 0.0));

  rested_s_ = inputs.raise || inputs.lower ? 0 : std::min(rested_s_ + dt_s, 2 * kStoreAfter_s);
  const bool stopped = last_start_ && !inputs.start;
  last_start_ = inputs.start;
  if (!settings.memory) {
    store_due_ = false;
  } else if (frequency_hz_ != stored_hz_ && (stopped || rested_s_ >= kStoreAfter_s)) {
    store_due_ = true;
  }
  return frequency_hz_;
}

std::optional<double> RemoteSetting::take_store() {
  if (!store_due_) return std::nullopt;
  store_due_ = false;
  stored_hz_ = frequency_hz_;
  return stored_hz_;
}

void RemoteSetting::power_on(double stored_hz) {
  *this = RemoteSetting{};
  frequency_hz_ = stored_hz;
  stored_hz_ = stored_hz;
}

}  // namespace vinv::drive
