// Records signals and states of drives tick by tick in bounded memory. Around a trip every sample is kept, before it
// from a ring; elsewhere samples are thinned out evenly, more the longer the run gets.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "sim/base/time.hpp"
#include "sim/scenario/observation.hpp"
#include "sim/scenario/recording.hpp"

namespace vinv::scenario {

struct RecorderSettings {
  Duration period = std::chrono::milliseconds(1);  // of the samples
  Duration before = std::chrono::milliseconds(500);
  Duration after = std::chrono::milliseconds(500);
  std::size_t max_cells = 4'000'000;         // values of the evenly thinned part
  std::size_t max_window_cells = 8'000'000;  // values around trips
};

class Recorder {
 public:
  // The observers outlive the recorder.
  Recorder(std::vector<const Observer*> drives, RecorderSettings settings);

  // After each look of the observers.
  void sample(Instant now);
  // Keeps every sample around now.
  void mark(Instant now);
  // Until then samples belong to a window.
  Instant window_ends() const { return windows_.empty() ? Instant{} : windows_.back().until; }
  void add_wire(WireRecord record);

  // Leaves the recorder empty.
  Recording take();

  // All that has been recorded; of the same drives with the same settings.
  friend void archive(Archive& a, Recorder& recorder) { recorder.archive_state(a); }

 private:
  struct Rows {
    std::vector<Instant> times;
    std::vector<double> cells;  // row after row
    VINV_ARCHIVE(Rows, times, cells);
  };
  struct Window {
    Rows rows;
    Instant until;
    VINV_ARCHIVE(Window, rows, until);
  };

  void append(Rows& rows, Instant now, const double* row) const;
  void thin_out();
  void record_states(Instant now);
  void archive_state(Archive& a);
  bool holds(const Rows& rows) const { return rows.cells.size() == rows.times.size() * width_; }

  std::vector<const Observer*> drives_;
  RecorderSettings settings_;
  std::size_t width_ = 0;  // columns
  std::vector<double> row_;
  Rows base_;
  std::uint64_t stride_ = 1;
  std::uint64_t samples_ = 0;
  Rows ring_;
  std::size_t ring_rows_ = 0;  // capacity
  std::size_t ring_next_ = 0;
  std::vector<Window> windows_;
  std::size_t window_cells_ = 0;
  std::uint64_t windows_lost_ = 0;
  std::vector<StateTrace> states_;
  std::vector<WireRecord> wire_;
};

}  // namespace vinv::scenario
