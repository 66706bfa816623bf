#include "sim/scenario/units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"

namespace vinv::scenario {
namespace {

using rig::Dimension;

struct SignalUnit {
  std::string_view name;
  Dimension dimension;
  double per_base;  // one of the dimension's own unit in this unit
};

constexpr std::array kSignalUnits{
    SignalUnit{"Hz", Dimension::kFrequency, 1}, SignalUnit{"A", Dimension::kCurrent, 1e-3},
    SignalUnit{"mA", Dimension::kCurrent, 1},   SignalUnit{"V", Dimension::kVoltage, 1},
    SignalUnit{"rpm", Dimension::kSpeed, 1},    SignalUnit{"Nm", Dimension::kTorque, 1},
    SignalUnit{"W", Dimension::kPower, 1},      SignalUnit{"kW", Dimension::kPower, 1e-3},
    SignalUnit{"%", Dimension::kFraction, 100}, SignalUnit{"degC", Dimension::kTemperature, 1},
    SignalUnit{"s", Dimension::kTime, 1},
};

std::string_view shown_unit(std::string_view unit) { return unit == "degC" ? "C" : unit; }

}  // namespace

Result<double, std::string> parse_value(std::string_view text, std::string_view signal_unit) {
  const auto known = std::find_if(kSignalUnits.begin(), kSignalUnits.end(),
                                  [&](const SignalUnit& u) { return u.name == signal_unit; });
  if (known != kSignalUnits.end()) {
    const auto base = rig::parse_quantity(text, known->dimension);
    if (!base) return Unexpected(base.error());
    return *base * known->per_base;
  }
  const bool plain = signal_unit.empty() || signal_unit == "-";
  std::string_view number = text;
  if (!plain && number.ends_with(signal_unit)) number.remove_suffix(signal_unit.size());
  const bool has_unit = plain || number.size() < text.size();
  while (!number.empty() && number.back() == ' ') number.remove_suffix(1);
  double value = 0;
  if (has_unit && rig::parse_number(number, value)) return value;
  // Codes are hexadecimal in every manual.
  unsigned code = 0;
  if (plain && number.starts_with("0x")) {
    const char* const end = number.data() + number.size();
    const auto read = std::from_chars(number.data() + 2, end, code, 16);
    if (read.ec == std::errc{} && read.ptr == end) return static_cast<double>(code);
  }
  return Unexpected("\"" + std::string(text) + "\" is no " +
                    (plain ? std::string("plain number; write a number without unit.")
                           : "value in " + std::string(signal_unit) + "; write a number and this unit."));
}

std::string show_value(double value, std::string_view signal_unit) {
  // A tiny rest of a computation is no minus.
  const double shown = std::abs(value) < 5e-7 ? 0 : value;
  const bool plain = signal_unit.empty() || signal_unit == "-";
  return plain ? fmt::format("{:.6g}", shown) : fmt::format("{:.6g} {}", shown, shown_unit(signal_unit));
}

std::string show_duration(Duration d) {
  const std::int64_t ns = d.count();
  if (ns != 0 && std::abs(ns) < 1'000'000) return fmt::format("{:.12g} us", static_cast<double>(ns) * 1e-3);
  if (ns != 0 && std::abs(ns) < 1'000'000'000) return fmt::format("{:.12g} ms", static_cast<double>(ns) * 1e-6);
  return fmt::format("{:.12g} s", static_cast<double>(ns) * 1e-9);
}

std::string show_time(Instant t) { return fmt::format("{:.3f} s", to_seconds(t)); }

std::string show_bytes(ByteView bytes) { return fmt::format("{:02X}", fmt::join(bytes, " ")); }

}  // namespace vinv::scenario
