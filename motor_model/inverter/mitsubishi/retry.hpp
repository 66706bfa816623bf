// Automatic retry after an alarm (Pr.65, 67-69). Typical for the family. Plain data.
#pragma once

#include <cstdint>

#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::inverter::mitsubishi {

struct Retry {
  enum class Phase : std::uint8_t { kIdle, kWaiting, kWatching } phase = Phase::kIdle;
  friend VINV_ENUM_RANGE(Phase, kIdle, kWatching);
  int used = 0;   // in this sequence
  Instant due{};  // end of waiting, or when the retry counts as successful

  // Pr.67: 1-10 retries without, 101-110 with alarm output meanwhile.
  static int limit(int raw_pr67) { return raw_pr67 > 100 ? raw_pr67 - 100 : raw_pr67; }
  static bool alarm_output(int raw_pr67) { return raw_pr67 > 100; }
  static constexpr int kSuccessAfterWaits = 5;  // trouble-free for this many waiting times
  VINV_ARCHIVE(Retry, phase, used, due);
};

}  // namespace vinv::inverter::mitsubishi
