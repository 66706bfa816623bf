#include "motor_model/inverter/a700/part_life.hpp"

#include <algorithm>
#include <cmath>

#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/parameter_numbers.hpp"

namespace vinv::inverter::a700 {
namespace {

constexpr double kCapacitorLife_s = 87600.0 * 3600;
constexpr double kAmbient_c = 40;
constexpr std::int64_t kOperationsPerPercent = 10000;

int percent(double left) { return static_cast<int>(std::clamp(std::floor(left + 1e-9), 0.0, 100.0)); }

}  // namespace

double ageing_rate(double ambient_c) { return std::exp2((ambient_c - kAmbient_c) / 10); }

int inrush_circuit_percent(std::int64_t operations) {
  return percent(100 - static_cast<double>(operations / kOperationsPerPercent));
}

int control_capacitor_percent(double aged_s) {
  return percent(100 - (100 - kPartAlarm_percent) * aged_s / kCapacitorLife_s);
}

int main_capacitor_percent(double aged_s) {
  return percent(100 - (100 - kMainCapacitorAlarm_percent) * aged_s / kCapacitorLife_s);
}

int A700Inverter::part_percent(unsigned number) const {
  const double aged_s = static_cast<double>(record_.counters[kCapacitorAgeing]) + s_.capacitor_aged_s;
  switch (number) {
    case pr::kInrushLife:
      return causes_.inrush_circuit ? kWornPart_percent : inrush_circuit_percent(record_.counters[kInrushOperations]);
    case pr::kControlCapacitorLife:
      return causes_.control_capacitor ? kWornPart_percent : control_capacitor_percent(aged_s);
    default: {
      // Shows the last measurement; new from the factory.
      const auto measured = record_.counters[kMainCapacitorPercent];
      return measured > 0 ? static_cast<int>(measured) : 100;
    }
  }
}

// Pr.255: bit 0 control circuit capacitor, 1 main circuit capacitor, 2 fan, 3 inrush current limit circuit.
int A700Inverter::life_alarms() const {
  return (part_percent(pr::kControlCapacitorLife) <= kPartAlarm_percent ? 1 : 0) |
         (part_percent(pr::kMainCapacitorLife) <= kMainCapacitorAlarm_percent ? 2 : 0) | (causes_.fan ? 4 : 0) |
         (part_percent(pr::kInrushLife) <= kPartAlarm_percent ? 8 : 0);
}

// The supply goes: the discharge through the motor tells the capacitance, if the motor stands.
void A700Inverter::measure_main_capacitor(EepromRecord& record) const {
  auto& state = record.counters[kMainCapacitorMeasuring];
  if (state != static_cast<std::int64_t>(CapacitorMeasuring::kArmed)) return;
  if (running() || v_.any_start_signal) {
    state = static_cast<std::int64_t>(CapacitorMeasuring::kForcedEnd);
    return;
  }
  state = static_cast<std::int64_t>(CapacitorMeasuring::kDone);
  record.counters[kMainCapacitorPercent] =
      causes_.main_capacitor ? kWornMainCapacitor_percent
                             : main_capacitor_percent(static_cast<double>(record.counters[kCapacitorAgeing]));
}

}  // namespace vinv::inverter::a700
