#include "sim/rig/command_values.hpp"

#include <algorithm>

#include "sim/rig/words.hpp"

namespace vinv::rig {

void invalid(const std::string& message) { throw Refuse{{CommandCode::kInvalidValue, sentence(message)}}; }
void refused(const std::string& message) { throw Refuse{{CommandCode::kRefused, sentence(message)}}; }

void demand(const inverter::Outcome& outcome) {
  if (!outcome) refused(outcome.error());
}

std::string shown(const Json& value) { return value.is_null() ? "nothing" : value.dump(); }

std::string word_of(const Json& value, const Words& allowed, std::string_view what) {
  if (!value.is_string()) invalid(std::string(what) + " is " + shown(value) + "; allowed: " + join(allowed) + ".");
  const std::string word = value.get<std::string>();
  if (std::find(allowed.begin(), allowed.end(), word) == allowed.end())
    invalid(std::string(what) + " is \"" + word + "\"; " + allowed_words(word, allowed));
  return word;
}

bool switch_of(const Json& value, std::string_view what) {
  bool on = false;
  if (value.is_boolean()) return value.get<bool>();
  if (!value.is_string() || !parse_switch(value.get<std::string>(), on))
    invalid(std::string(what) + " is " + shown(value) + "; allowed: on, off.");
  return on;
}

double quantity_of(const Json& value, Dimension dimension, std::string_view what) {
  if (!value.is_string()) {
    const auto units = units_of(dimension);
    invalid(std::string(what) + " is " + shown(value) + "; write text with a number and one of these units: " +
            join(units) + ", for example \"5 " + std::string(units.front()) + "\".");
  }
  const auto parsed = parse_quantity(value.get<std::string>(), dimension);
  if (!parsed) invalid(std::string(what) + ": " + parsed.error());
  return *parsed;
}

double quantity_within(const Json& value, Dimension dimension, std::string_view what, double low, double high,
                       std::string_view allowed) {
  const double v = quantity_of(value, dimension, what);
  if (v < low || v > high)
    invalid(std::string(what) + " is " + shown(value) + "; allowed: " + std::string(allowed) + ".");
  return v;
}

double number_of(const Json& value, std::string_view what) {
  double v = 0;
  if (value.is_number()) return value.get<double>();
  if (!value.is_string() || !parse_number(value.get<std::string>(), v))
    invalid(std::string(what) + " is " + shown(value) + "; allowed: a number.");
  return v;
}

// A mapping with at least one entry; keys empty: any key.
const Json& map_of(const Json& value, const Words& keys, std::string_view command, std::string_view form) {
  if (!value.is_object() || value.empty())
    invalid(std::string(command) + " is " + shown(value) + "; it takes " + std::string(form) + ".");
  if (!keys.empty())
    for (const auto& [key, v] : value.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        invalid("unknown word \"" + key + "\" in " + std::string(command) + "; " + allowed_words(key, keys));
  return value;
}

}  // namespace vinv::rig
