// What the operation panel FR-DU07 shows: four digits and its lamps, as values for a panel to draw. Typical for the
// family; mode lamps: FR-A7NE manual 4.3.1.
#pragma once

#include <cstdint>
#include <string>

namespace vinv::inverter::a700 {

enum class Lamp : std::uint8_t { kOff, kOn, kFlicker };

struct Du07 {
  std::string digits;   // five characters at most, the point counts: "60.00", "E.  3", "PS"
  std::string warning;  // flashes beside the digits: OL, SL, RB, TH, MT, FN, PS; empty without one
  bool hertz = false;
  bool ampere = false;
  bool volt = false;
  bool monitor = false;
  bool pu = false;
  bool external = false;
  bool network = false;
  Lamp forward = Lamp::kOff;  // flickers while a start signal is on and the motor does not follow it
  Lamp reverse = Lamp::kOff;
};

// A number in four digits: 0.00 to 99.99, 100.0 to 999.9, 1000 to 9999.
std::string four_digits(double value, int most_decimals = 2);

}  // namespace vinv::inverter::a700
