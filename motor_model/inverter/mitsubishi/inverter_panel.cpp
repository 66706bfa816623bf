// Operation panel of the Mitsubishi families: keys, the frequency set at the panel. Typical for the family; keys are
// presses without release, so that a jog run lasts until STOP.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"
#include "motor_model/inverter/mitsubishi/reset_selection.hpp"

namespace vinv::inverter::mitsubishi {

using drive::RunDirection;
using port::OperationMode;

namespace {

constexpr double kFrequencyStep_hz = 0.1;  // one press of UP or DOWN

std::string digits(const char* pattern, double value) {
  char text[32];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

}  // namespace

std::string MitsubishiInverter::mode_sentence() const {
  switch (v_.mode) {
    case OperationMode::kExternal: return "it is in external operation";
    case OperationMode::kPu: return "it is in PU operation";
    case OperationMode::kNetwork: return "it is in network operation";
    case OperationMode::kCombined1:
    case OperationMode::kCombined2: break;
  }
  return "it is in combined operation (Pr.79 = 3 or 4)";
}

Outcome MitsubishiInverter::press_key(PanelKey key) {
  if (!control_alive_) return Unexpected(std::string("the panel is dark: the inverter has no supply"));
  if (causes_.pu_disconnected) return Unexpected(std::string("the operation panel is disconnected"));
  if (!ready()) return Unexpected(std::string("the inverter is in start-up or reset"));
  const bool panel_starts = v_.mode == OperationMode::kPu || v_.mode == OperationMode::kCombined2;
  switch (key) {
    case PanelKey::kFwd:
    case PanelKey::kRev:
      if (!panel_starts) return Unexpected("FWD and REV start in PU operation; " + mode_sentence());
      if (auto why = panel_commands()) return Unexpected(*std::move(why));
      if (v_.alarm.row) return Unexpected("there is an alarm, " + alarm_name() + ": reset it first");
      v_.panel.run = key == PanelKey::kFwd ? RunDirection::kForward : RunDirection::kReverse;
      if (!running()) v_.panel.jog_run = v_.panel.screen == Screen::kJog && v_.mode == OperationMode::kPu;
      return {};
    case PanelKey::kStopReset:
      if (v_.alarm.row) {
        if (!reset_accepted()) return Unexpected(alarm_name() + " is cleared by a power cycle only");
        begin_reset();
        return {};
      }
      if (panel_starts) {
        v_.panel.run = RunDirection::kStop;
        return {};
      }
      // Pr.75 = 14-17: STOP acts in every mode and the start signal has to go off before the next run.
      if (!ResetSelection::of(store_.integer(pr::kResetSelection)).stop_in_every_mode) {
        return Unexpected("STOP acts in PU operation only (Pr.75 below 14); " + mode_sentence());
      }
      if (v_.direction != RunDirection::kStop || running()) v_.panel.stopped_by_panel = true;
      return {};
    case PanelKey::kPuExt:
      if (v_.panel.stopped_by_panel) {
        if (v_.any_start_signal) return Unexpected(std::string("PS: the start signals must be off first"));
        v_.panel.stopped_by_panel = false;
        return {};
      }
      return panel_mode_key();
    case PanelKey::kUp:
    case PanelKey::kDown: {
      const double step = key == PanelKey::kUp ? kFrequencyStep_hz : -kFrequencyStep_hz;
      if (v_.panel.screen == Screen::kFrequency) {
        v_.panel.edited_hz = std::clamp(v_.panel.edited_hz + step, 0.0, maximum_frequency_hz(store_));
        return {};
      }
      if (!panel_sets_speed()) {
        return Unexpected("the panel sets the frequency in PU operation or with Pr.79 = 3; " + mode_sentence());
      }
      v_.panel_frequency_hz = std::clamp(v_.panel_frequency_hz + step, 0.0, maximum_frequency_hz(store_));
      return {};
    }
    case PanelKey::kMode:
      switch (v_.panel.screen) {
        case Screen::kMonitor:
          v_.panel.screen = Screen::kFrequency;
          v_.panel.edited_hz = v_.panel_frequency_hz;
          break;
        case Screen::kFrequency:
          v_.panel.screen =
              v_.mode == OperationMode::kPu && !running() && jog_by_mode_key() ? Screen::kJog : Screen::kMonitor;
          break;
        case Screen::kJog:
          if (v_.panel.run != RunDirection::kStop || running())
            return Unexpected(std::string("stop the jog run first"));
          v_.panel.jog_run = false;
          v_.panel.screen = Screen::kMonitor;
          break;
      }
      return {};
    case PanelKey::kSet:
      if (v_.panel.screen == Screen::kMonitor) v_.panel.monitor = (v_.panel.monitor + 1) % 3;
      if (v_.panel.screen == Screen::kFrequency) return set_panel_frequency(v_.panel.edited_hz);
      return {};
  }
  return {};
}

Outcome MitsubishiInverter::set_panel_frequency(double hz) {
  if (!ready()) return Unexpected(std::string("the inverter has no supply or is in start-up or reset"));
  if (causes_.pu_disconnected) return Unexpected(std::string("the operation panel is disconnected"));
  if (!panel_sets_speed()) {
    return Unexpected("the panel sets the frequency in PU operation or with Pr.79 = 3; " + mode_sentence());
  }
  const double highest = maximum_frequency_hz(store_);
  if (!(hz >= 0 && hz <= highest)) return Unexpected("the frequency takes 0 to " + digits("%.2f", highest) + " Hz");
  record_.panel_frequency = static_cast<std::int32_t>(std::lround(hz * 100));
  v_.panel_frequency_hz = record_.panel_frequency / 100.0;
  eeprom_written();
  return {};
}

Outcome MitsubishiInverter::panel_mode_key() {
  const auto next = requested_mode(ModeRequest::kPanelKey);
  if (!next) {
    return Unexpected("the operation mode changes while stopped, with the start signals off and as Pr.79 (now " +
                      std::to_string(store_.integer(pr::kOperationMode)) + ") allows; " + mode_sentence());
  }
  change_mode(*next);
  return {};
}

bool MitsubishiInverter::panel_sets_speed() const {
  return v_.mode == OperationMode::kPu || v_.mode == OperationMode::kCombined1;
}

}  // namespace vinv::inverter::mitsubishi
