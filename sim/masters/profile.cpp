#include "sim/masters/profile.hpp"

#include <algorithm>

#include "sim/masters/fr_a7ne_profiles.hpp"
#include "sim/masters/profile_tables.hpp"

namespace vinv::masters {

std::string_view name_of(Word word) {
  switch (word) {
    case Word::kEnterNetwork: return "enter network mode";
    case Word::kLeaveNetwork: return "leave network mode";
    case Word::kRunForward: return "run forward";
    case Word::kRunReverse: return "run reverse";
    case Word::kStop: return "stop";
    case Word::kQuickStop: return "quick stop";
    case Word::kReferenceHz: return "reference in Hz";
    case Word::kReferenceRpm: return "reference in rpm";
    case Word::kReset: return "reset";
    case Word::kFaultReset: return "fault reset";
    case Word::kClearAlarms: return "clear alarms";
    case Word::kWriteParameter: return "write parameter";
    case Word::kReadParameter: return "read parameter";
    case Word::kMonitor: return "monitor";
  }
  return {};
}

std::vector<Word> BoardProfile::words() const {
  std::vector<Word> out;
  for (std::size_t i = 0; i < kWords; ++i) {
    const auto word = static_cast<Word>(i);
    const bool known = word == Word::kMonitor ? !monitors.empty()
                       : word == Word::kWriteParameter || word == Word::kReadParameter
                           ? !parameters.empty()
                           : std::any_of(steps.begin(), steps.end(), [&](const auto& s) { return s.word == word; });
    if (known) out.push_back(word);
  }
  return out;
}

const ParameterRule* BoardProfile::parameter(std::uint16_t number, std::uint8_t sub) const {
  for (const ParameterRule& rule : parameters)
    if (number >= rule.first && number <= rule.last && sub >= rule.first_sub && sub <= rule.last_sub) return &rule;
  return nullptr;
}

const MonitorRow* BoardProfile::monitor(std::string_view name) const {
  for (const MonitorRow& row : monitors)
    if (row.name == name) return &row;
  return nullptr;
}

std::span<const BoardProfile> profiles() {
  static constexpr BoardProfile kProfiles[] = {
      oi_fr_e5nco::kModbus,
      oi_fr_e5nco::kCanopen,
      oi_fr_e5nco::kCanopenSdo,
      oi_fr_e5nco::kCanopen402,
      fr_a7ne::k21,
      fr_a7ne::k20,
      fr_a7ne::k126,
      fr_a7ne::k129,
      fr_a7ne::kExplicit,
  };
  return kProfiles;
}

const BoardProfile* find_profile(std::string_view board, std::string_view protocol) {
  for (const BoardProfile& p : profiles())
    if (p.board == board && p.protocol == protocol) return &p;
  return nullptr;
}

}  // namespace vinv::masters
