#include "sim/scenario/watch_reader.hpp"

#include <filesystem>
#include <memory>

#include "sim/scenario/node_values.hpp"

namespace vinv::scenario {

std::optional<Watch> WatchReader::read(const std::string& word, const YAML::Node& value) const {
  Watch w;
  bool fine = true;
  if (word == "always" || word == "never") {
    w.kind = word == "always" ? Watch::Kind::kAlways : Watch::Kind::kNever;
    w.all = reader_.condition(value, word);
    fine = !w.all.empty();
  } else if (word == "follows") {
    w.kind = Watch::Kind::kFollows;
    fine = follows(value, w);
  } else {
    const bool overshoot = word == "overshoot";
    w.kind = overshoot ? Watch::Kind::kOvershoot : word == "rising" ? Watch::Kind::kRising : Watch::Kind::kFalling;
    // {output_frequency: 50 Hz, at_most: 1 Hz}; `rising: output_frequency` needs no mapping.
    const std::string limit = overshoot ? "at_most" : "tolerance";
    if (!overshoot && value.IsScalar()) {
      const auto what = reader_.signal(value.Scalar(), rig::position_of(value));
      if (what) w.what = *what;
      fine = what.has_value();
    } else {
      const rig::YamlMap m(value, word, nullptr, problems_);
      const YAML::Node* distance = m ? m.find(limit) : nullptr;
      const rig::YamlMap::Entry* signal = nullptr;
      for (const auto& e : m.entries())
        if (e.key != limit) {
          if (signal != nullptr) problems_.add(e.at, word + " watches one signal; \"" + e.key + "\" is the second.");
          if (signal == nullptr) signal = &e;
        }
      if (!m || signal == nullptr || (overshoot && distance == nullptr)) {
        if (m && (signal == nullptr || !m.has(limit)))
          problems_.add(m.at(), overshoot
                                    ? "overshoot takes a signal with its target and at_most, as {speed: 1450 rpm, "
                                      "at_most: 20 rpm}."
                                    : word + " takes a signal, as output_frequency, or {output_frequency: 0.1 Hz}.");
        fine = false;
      } else if (const auto what = reader_.signal(signal->key, signal->at); !what) {
        fine = false;
      } else {
        w.what = *what;
        const auto first = reader_.value(signal->value, *what);
        fine = first.has_value();
        if (overshoot) {
          w.target = first.value_or(0);
          const auto more = reader_.distance(*distance, *what, w.target);
          fine = fine && more.has_value();
          w.tolerance = more.value_or(0);
        } else {
          w.tolerance = first.value_or(0);
        }
      }
    }
  }
  if (!fine) return {};
  return w;
}

// {file: fan.csv, speed: 2 rpm, torque: 0.1 Nm}: the distances that are allowed.
bool WatchReader::follows(const YAML::Node& value, Watch& w) const {
  const rig::YamlMap m(value, "follows", nullptr, problems_);
  if (!m) return false;
  bool fine = true;
  if (const YAML::Node* begin = m.find("begin")) {
    const auto d = read_duration(*begin, "begin in follows", Duration{}, problems_);
    fine = d.has_value();
    w.trace_begin = d.value_or(Duration{});
  }
  const auto file = m.text("file");
  if (!file) {
    if (!m.has("file")) problems_.add(m.at(), "\"file\" is missing in follows; write the name of a CSV table.");
    return false;
  }
  const std::string path = (std::filesystem::path(folder_) / *file).lexically_normal().string();
  auto trace = rig::load_trace(path);
  if (!trace) {
    problems_.add(*m.find("file"), path + " " + trace.error());
    return false;
  }
  w.trace = std::make_shared<const rig::Trace>(std::move(*trace));
  for (const auto& e : m.entries()) {
    if (e.empty || e.key == "file" || e.key == "begin") continue;
    Watch::Followed f;
    const auto what = reader_.signal(e.key, e.at);
    // A report names the drive too.
    const rig::Trace::Column* column = w.trace->find(e.key);
    if (column == nullptr) column = w.trace->find(reader_.drive_name() + "." + e.key);
    if (what && column == nullptr) problems_.add(e.at, path + " has no column \"" + e.key + " " + what->unit + "\".");
    if (!what || column == nullptr) {
      fine = false;
      continue;
    }
    f.what = *what;
    f.column = static_cast<std::size_t>(column - w.trace->columns.data());
    if (column->unit != what->unit) {
      problems_.add(e.at, "column " + e.key + " of " + path + " is in \"" + column->unit + "\"; the signal is in \"" +
                              what->unit + "\".");
      fine = false;
    }
    const auto distance = reader_.distance(e.value, *what, 0);
    fine = fine && distance.has_value();
    f.tolerance = distance.value_or(0);
    w.followed.push_back(std::move(f));
  }
  if (fine && w.followed.empty()) {
    problems_.add(m.at(), "follows takes signals with how far they may be off, as {file: fan.csv, speed: 2 rpm}.");
    return false;
  }
  return fine;
}

}  // namespace vinv::scenario
