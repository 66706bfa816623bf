#include "sim/rig/quantity.hpp"

#include <array>

#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

struct Unit {
  Dimension dimension;
  std::string_view name;
  double scale;
  bool spoken = true;  // named in messages; the others are further spellings
};

constexpr std::array kUnits{
    Unit{Dimension::kFrequency, "Hz", 1},
    Unit{Dimension::kFrequency, "kHz", 1000},
    Unit{Dimension::kTorque, "Nm", 1},
    Unit{Dimension::kTorque, "mNm", 1e-3},
    Unit{Dimension::kTorque, "kNm", 1e3},
    Unit{Dimension::kTorque, "N m", 1, false},
    Unit{Dimension::kInertia, "kg m2", 1},
    Unit{Dimension::kInertia, "kg_m2", 1, false},
    Unit{Dimension::kInertia, "kgm2", 1, false},
    Unit{Dimension::kInertia, "kg m^2", 1, false},
    Unit{Dimension::kVoltage, "V", 1},
    Unit{Dimension::kVoltage, "mV", 1e-3},
    Unit{Dimension::kVoltage, "kV", 1e3},
    Unit{Dimension::kCurrent, "mA", 1},
    Unit{Dimension::kCurrent, "A", 1e3},
    Unit{Dimension::kTime, "s", 1},
    Unit{Dimension::kTime, "ms", 1e-3},
    Unit{Dimension::kTime, "us", 1e-6},
    Unit{Dimension::kTime, "min", 60},
    Unit{Dimension::kFraction, "%", 1e-2},
    Unit{Dimension::kTemperature, "C", 1},
    Unit{Dimension::kTemperature, "degC", 1, false},
    Unit{Dimension::kTemperature, "\u00b0C", 1, false},
    Unit{Dimension::kSpeed, "rpm", 1},
    Unit{Dimension::kSpeed, "1/min", 1, false},
    Unit{Dimension::kPower, "W", 1},
    Unit{Dimension::kPower, "kW", 1e3},
};

}  // namespace

std::vector<std::string_view> units_of(Dimension dimension) {
  std::vector<std::string_view> out;
  for (const Unit& u : kUnits)
    if (u.dimension == dimension && u.spoken) out.push_back(u.name);
  return out;
}

Result<double, std::string> parse_quantity(std::string_view text, Dimension dimension) {
  const auto refuse = [&](const std::string& what) {
    const auto units = units_of(dimension);
    return Unexpected("\"" + std::string(text) + "\" " + what + "; write a number and one of these units: " +
                      join(units) + ", for example \"5 " + std::string(units.front()) + "\".");
  };
  const std::size_t number_end = std::min(text.find_first_not_of("+-.0123456789"), text.size());
  double number = 0;
  if (!parse_number(text.substr(0, number_end), number)) return refuse("does not begin with a number");
  std::string_view unit = text.substr(number_end);
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  while (!unit.empty() && unit.back() == ' ') unit.remove_suffix(1);
  if (unit.empty()) return refuse("has no unit");
  for (const Unit& u : kUnits)
    if (u.dimension == dimension && u.name == unit) return number * u.scale;
  return refuse("has the wrong unit");
}

}  // namespace vinv::rig
