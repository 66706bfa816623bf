// What Pr.75 selects: when a reset is accepted, whether the panel is supervised, where STOP acts. Typical for the
// family.
#pragma once

namespace vinv::inverter::mitsubishi {

struct ResetSelection {
  bool only_with_alarm = false;     // a reset is accepted only while there is an alarm
  bool panel_supervised = false;    // a disconnected panel is E.PUE
  bool stop_in_every_mode = false;  // the panel's STOP acts outside PU operation too

  // 0-3, and 14-17 the same with STOP in every mode.
  static constexpr ResetSelection of(int raw_pr75) {
    const bool every_mode = raw_pr75 >= 14;
    const int bits = every_mode ? raw_pr75 - 14 : raw_pr75;
    return {(bits & 1) != 0, (bits & 2) != 0, every_mode};
  }
};

}  // namespace vinv::inverter::mitsubishi
