// Ageing of the power circuit's parts and its alarms (Pr.255 to 259). Typical for the family; a capacitor lives 87600 h
// at 40 degC around it and half as long with every 10 degC more.
#pragma once

#include <cstdint>

namespace vinv::inverter::a700 {

// Seconds of capacitor life at 40 degC that a second at this temperature takes.
double ageing_rate(double ambient_c);

// What is left, percent. Each has its alarm at its own level.
int inrush_circuit_percent(std::int64_t operations);  // Pr.256: 1 000 000 operations; alarm at 10
int control_capacitor_percent(double aged_s);         // Pr.257: alarm at 10
int main_capacitor_percent(double aged_s);            // Pr.258, once measured: capacitance; alarm at 85
inline constexpr int kPartAlarm_percent = 10;
inline constexpr int kMainCapacitorAlarm_percent = 85;
inline constexpr int kWornPart_percent = 5;  // of a part that a fault has worn
inline constexpr int kWornMainCapacitor_percent = 80;

// Pr.259.
enum class CapacitorMeasuring : std::int64_t { kOff = 0, kArmed = 1, kDone = 3, kForcedEnd = 8 };

}  // namespace vinv::inverter::a700
