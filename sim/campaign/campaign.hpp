// A campaign as data: a scenario, and which of its values vary how. Case k, counted from 1, is a plain scenario whose
// text is a pure function of the campaign's files and k.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/campaign/document.hpp"
#include "sim/campaign/plan.hpp"

namespace vinv::campaign {

// A number that each run leaves in its result, beside verdict and alarm.
struct Measure {
  enum class Kind : std::uint8_t { kMinimum, kMaximum, kLast };
  std::string name;
  Kind kind = Kind::kMaximum;
  std::string drive;
  std::string signal;
  std::string unit;
};

inline constexpr std::uint64_t kMaxCases = 10'000'000;

class Campaign {
 public:
  std::string path;   // as messages name it
  std::string name;   // file name without ending
  std::string title;  // the first line's comment
  std::uint64_t seed = 1;
  Document base;              // the scenario
  std::string base_path;      // plant files are named relative to it
  std::vector<Block> blocks;  // one after the other
  std::vector<Measure> measures;

  // After the blocks have changed.
  void number_cases();
  std::uint64_t cases() const { return ends_.empty() ? 0 : ends_.back(); }
  // Names of what varies, in the order of the file.
  const std::vector<std::string>& axes() const { return axes_; }

  // number: 1 to cases().
  Assignment assignment(std::uint64_t number) const;
  // "decel = 0.5 s, inertia = 0.1"
  std::string shown_values(std::uint64_t number) const;
  // The scenario of a case with its plant in it. Throws std::runtime_error with a sentence if a value has no place in
  // the scenario, or a plant file cannot be read.
  Document scenario(std::uint64_t number) const;
  std::string scenario_text(std::uint64_t number) const;
  // Title line and document.
  static std::string text_of(const Document& scenario, const std::string& title);
  // Changes with everything that the case is made of: 16 hexadecimal digits.
  std::string digest(std::uint64_t number) const;
  // "NAME_case_17", a file name without ending.
  std::string case_name(std::uint64_t number) const;

 private:
  struct PlantText {
    Document document;
    std::uint64_t hash = 0;
  };
  const PlantText* plant_of(const Assignment& values) const;  // nullptr: inline
  std::vector<std::uint64_t> ends_;                           // last case of each block
  std::vector<std::string> axes_;
  std::uint64_t base_hash_ = 0;
  mutable std::map<std::string, PlantText> plants_;  // by path, read once
};

}  // namespace vinv::campaign
