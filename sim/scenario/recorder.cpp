#include "sim/scenario/recorder.hpp"

#include <algorithm>
#include <utility>

#include "sim/rig/commands.hpp"

namespace vinv::scenario {
namespace {

constexpr std::size_t kMaxWireRecords = 1'000'000;

void change(StateTrace& trace, Instant now, std::string_view value) {
  if (!trace.changes.empty() && trace.changes.back().value == value) return;
  if (trace.changes.size() >= kMaxChanges)
    ++trace.lost;
  else
    trace.changes.push_back({now, std::string(value)});
}

// In each tick and for each state: on and off differ in length.
void change(StateTrace& trace, Instant now, bool on) {
  const std::string_view value = on ? "on" : "off";
  if (trace.changes.empty() || trace.changes.back().value.size() != value.size()) change(trace, now, value);
}

}  // namespace

Recorder::Recorder(std::vector<const Observer*> drives, RecorderSettings settings)
    : drives_(std::move(drives)), settings_(settings) {
  for (const Observer* d : drives_) {
    width_ += d->signal_names().size();
    const std::string& name = d->drive().spec.name;
    for (const std::string_view word : state_words()) states_.push_back({name, std::string(word), {}, 0});
    for (const char* word : {"alarm", "mode", "led"}) states_.push_back({name, word, {}, 0});
    for (const std::string& terminal : d->terminal_names()) states_.push_back({name, terminal, {}, 0});
  }
  row_.resize(width_);
  ring_rows_ = static_cast<std::size_t>(settings_.before / settings_.period);
  ring_.times.reserve(ring_rows_);
  ring_.cells.reserve(ring_rows_ * width_);
  // Room for all is only addresses; moving what is there costs more than making it.
  base_.times.reserve(settings_.max_cells / std::max<std::size_t>(width_, 1) + 2);
  base_.cells.reserve(settings_.max_cells + width_);
}

void Recorder::append(Rows& rows, Instant now, const double* row) const {
  rows.times.push_back(now);
  rows.cells.insert(rows.cells.end(), row, row + width_);
}

void Recorder::sample(Instant now) {
  auto cell = row_.begin();
  for (const Observer* d : drives_) cell = std::copy(d->seen().signals.begin(), d->seen().signals.end(), cell);
  if (samples_ % stride_ == 0) append(base_, now, row_.data());
  ++samples_;
  if (base_.cells.size() > settings_.max_cells) thin_out();
  if (!windows_.empty() && now <= windows_.back().until) {
    append(windows_.back().rows, now, row_.data());
    window_cells_ += width_;
  }
  if (ring_rows_ > 0) {
    if (ring_.times.size() < ring_rows_) {
      append(ring_, now, row_.data());
    } else {
      ring_.times[ring_next_] = now;
      std::copy(row_.begin(), row_.end(), ring_.cells.begin() + static_cast<std::ptrdiff_t>(ring_next_ * width_));
    }
    ring_next_ = (ring_next_ + 1) % ring_rows_;
  }
  record_states(now);
}

// Every second row goes, from here on and back to the start.
void Recorder::thin_out() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < base_.times.size(); i += 2, ++kept) {
    base_.times[kept] = base_.times[i];
    std::copy_n(base_.cells.begin() + static_cast<std::ptrdiff_t>(i * width_), width_,
                base_.cells.begin() + static_cast<std::ptrdiff_t>(kept * width_));
  }
  base_.times.resize(kept);
  base_.cells.resize(kept * width_);
  stride_ *= 2;
}

void Recorder::mark(Instant now) {
  if (!windows_.empty() && now <= windows_.back().until) {
    windows_.back().until = now + settings_.after;
    return;
  }
  const std::size_t needed =
      width_ * static_cast<std::size_t>((settings_.before + settings_.after) / settings_.period + 1);
  if (window_cells_ + needed > settings_.max_window_cells) {
    ++windows_lost_;
    return;
  }
  Window w;
  w.until = now + settings_.after;
  const Instant covered = windows_.empty() ? Instant::min() : windows_.back().until;
  const std::size_t rows = ring_.times.size();
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t at = (rows < ring_rows_ ? i : (ring_next_ + i) % rows);
    if (ring_.times[at] > covered) append(w.rows, ring_.times[at], ring_.cells.data() + at * width_);
  }
  window_cells_ += w.rows.cells.size();
  windows_.push_back(std::move(w));
}

void Recorder::record_states(Instant now) {
  std::size_t i = 0;
  for (const Observer* d : drives_) {
    const Snapshot& s = d->seen();
    for (const bool on : s.states) change(states_[i++], now, on);
    change(states_[i++], now, s.alarm);
    change(states_[i++], now, rig::mode_name(s.mode));
    change(states_[i++], now, s.led);
    for (const bool on : s.terminals) change(states_[i++], now, on);
  }
}

void Recorder::add_wire(WireRecord record) {
  if (wire_.size() < kMaxWireRecords) wire_.push_back(std::move(record));
}

Recording Recorder::take() {
  Recording out;
  for (const Observer* d : drives_)
    for (std::size_t i = 0; i < d->signal_names().size(); ++i)
      out.columns.push_back({d->drive().spec.name, d->signal_names()[i], d->signal_units()[i], {}});
  std::size_t most = base_.times.size();
  for (const Window& w : windows_) most += w.rows.times.size();
  out.times.reserve(most);
  for (SignalColumn& c : out.columns) c.values.reserve(most);
  const auto add = [&](const Rows& rows, std::size_t i) {
    if (!out.times.empty() && rows.times[i] <= out.times.back()) return;
    out.times.push_back(rows.times[i]);
    for (std::size_t c = 0; c < width_; ++c) out.columns[c].values.push_back(rows.cells[i * width_ + c]);
  };
  std::size_t next = 0;
  for (const Window& w : windows_) {
    if (w.rows.times.empty()) continue;
    for (; next < base_.times.size() && base_.times[next] < w.rows.times.front(); ++next) add(base_, next);
    for (std::size_t i = 0; i < w.rows.times.size(); ++i) add(w.rows, i);
  }
  for (; next < base_.times.size(); ++next) add(base_, next);
  out.states = std::move(states_);
  out.wire = std::move(wire_);
  out.finest = settings_.period;
  out.coarsest = settings_.period * static_cast<std::int64_t>(stride_);
  out.windows = windows_.size();
  out.windows_lost = windows_lost_;
  base_ = {};
  ring_ = {};
  windows_.clear();
  return out;
}

}  // namespace vinv::scenario
