// What a scenario sees of a drive: its signals, and states and texts that every family has.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/rig/drive_unit.hpp"
#include "sim/scenario/scenario.hpp"

namespace vinv::scenario {

// On or off.
enum class State : std::uint8_t {
  kPowered,
  kReady,
  kRunning,
  kStopped,
  kAtReference,  // running at the set frequency, no longer on the ramp
  kForward,
  kReverse,
  kUpToFrequency,  // the drive's own signal, with its own width
  kOverload,
  kPowerFailure,
  kFrequencyDetected,
  kTripped,
};
inline constexpr std::size_t kStateCount = 12;
const std::array<std::string_view, kStateCount>& state_words();

enum class Text : std::uint8_t { kAlarm, kMode, kDisplay, kLed };
inline constexpr std::size_t kTextCount = 4;
const std::array<std::string_view, kTextCount>& text_words();

inline constexpr std::string_view kNoAlarm = "none";

// All of a drive at one instant.
struct Snapshot {
  std::vector<double> signals;
  std::array<bool, kStateCount> states{};
  std::string alarm;  // kNoAlarm without one
  port::OperationMode mode{};
  std::string led;
  std::vector<bool> terminals;  // in the order of Inverter::terminals()
  friend void archive(Archive& a, Snapshot& snapshot);
};

class Observer {
 public:
  // The drive outlives the observer.
  explicit Observer(const rig::DriveUnit& drive);

  const rig::DriveUnit& drive() const { return drive_; }
  const std::vector<std::string>& signal_names() const { return names_; }
  const std::vector<std::string>& signal_units() const { return units_; }
  const std::vector<std::string>& terminal_names() const { return terminals_; }

  void look();  // takes a new snapshot
  const Snapshot& seen() const { return seen_; }
  // What it saw last. Its drive has the signals and terminals of the one that was saved.
  friend void archive(Archive& a, Observer& observer) { observer.archive_state(a); }

  struct Judgement {
    bool holds = false;
    double number = 0;  // where the observable is one
    std::string text;   // what is there now, for a person; empty unless asked for
  };
  // widen: fraction of the expected value by which its bounds are moved apart (live runs).
  Judgement judge(const Expectation& e, double widen, bool with_text) const;
  bool holds(const Condition& c, double widen) const;
  double number(const Observable& o) const;  // of a signal

 private:
  void archive_state(Archive& a);

  const rig::DriveUnit& drive_;
  std::vector<std::string> names_;
  std::vector<std::string> units_;
  std::vector<std::string> terminals_;
  std::optional<std::size_t> set_frequency_;
  std::optional<std::size_t> output_frequency_;
  std::optional<std::size_t> run_state_;
  Snapshot seen_;
};

}  // namespace vinv::scenario
