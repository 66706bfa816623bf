// Password lock of the FR-A700 (Pr.296, Pr.297; later firmware). FR-A700 manual 4.22.5.
#include <algorithm>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {
namespace {

constexpr std::int64_t kMostErrors = 5;
constexpr std::int32_t kLeastPassword = 1000;

struct Access {
  bool read;
  bool write;
};
struct Level {
  Access panel;
  Access option;
};
// By Pr.296 0 to 6; 100 to 106 are the same and count errors.
constexpr Level kLevels[] = {
    {{false, false}, {false, false}}, {{true, false}, {true, false}},  {{true, false}, {true, true}},
    {{true, true}, {true, false}},    {{false, false}, {true, false}}, {{false, false}, {true, true}},
    {{true, true}, {true, false}},
};
constexpr int kOnlyUserGroup = 99;
constexpr int kElsewhereThen = 4;  // what is not in the user group

}  // namespace

bool A700Inverter::locked(Writer writer, unsigned number, bool write) const {
  if (record_.counters[kPasswordSet] == 0 || store_.is_9999(pr::kPasswordLevel)) return false;
  if (number == pr::kPassword || (number == pr::kPasswordLevel && !write)) return false;
  if (number == pr::kPasswordLevel) return true;
  int level = store_.integer(pr::kPasswordLevel) % 100;
  if (level == kOnlyUserGroup) {
    if (record_.groups[0].contains(static_cast<std::uint16_t>(number))) return false;
    level = kElsewhereThen;
  }
  if (level > 6) return false;
  const Level& l = kLevels[level];
  const Access& rights = writer == Writer::kPanel ? l.panel : l.option;
  return !(write ? rights.write : rights.read);
}

std::optional<port::Refusal> A700Inverter::enter_password(std::int32_t raw) {
  auto& password = record_.counters[kPasswordSet];
  auto& errors = record_.counters[kPasswordErrors];
  if (raw < kLeastPassword || raw == kRaw9999) return std::nullopt;  // without effect
  if (password == 0) {
    if (store_.is_9999(pr::kPasswordLevel)) return port::Refusal::kOutOfRange;
    password = raw;
    errors = 0;
    return std::nullopt;
  }
  const bool counts = store_.integer(pr::kPasswordLevel) >= 100;
  if (counts && errors >= kMostErrors) return std::nullopt;  // locked until all clear
  if (raw == password) {
    password = errors = 0;
  } else if (counts) {
    errors = std::min(errors + 1, kMostErrors);
  }
  return std::nullopt;
}

std::int32_t A700Inverter::shown_password() const {
  if (record_.counters[kPasswordSet] == 0) return kRaw9999;
  return static_cast<std::int32_t>(record_.counters[kPasswordErrors]);
}

// Levels 0 and 100 leave a network option nothing to do.
bool A700Inverter::password_shuts_option_out() const {
  return option_fitted_ && record_.counters[kPasswordSet] != 0 && !store_.is_9999(pr::kPasswordLevel) &&
         store_.integer(pr::kPasswordLevel) % 100 == 0;
}

void A700Inverter::cleared(ClearKind kind) {
  if (kind != ClearKind::kAllClear) return;
  record_.counters[kPasswordSet] = record_.counters[kPasswordErrors] = 0;
}

}  // namespace vinv::inverter::a700
