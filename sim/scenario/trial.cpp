#include "sim/scenario/trial.hpp"

#include <algorithm>

#include "sim/rig/words.hpp"

namespace vinv::scenario {

Trial::Trial(const rig::PlantFile& plant, const rig::Catalogue& catalogue) {
  rig::PlantOptions options;
  options.catalogue = catalogue;
  plant_ = std::make_unique<rig::Plant>(plant, scheduler_, std::move(options));
  for (const auto& d : plant_->drives()) observers_.push_back(std::make_unique<Observer>(*d));
}

std::vector<std::string_view> Trial::drive_names() const {
  std::vector<std::string_view> out;
  for (const auto& d : plant_->drives()) out.push_back(d->spec.name);
  return out;
}

bool Trial::has_parameter(std::size_t drive, std::string_view name) {
  return plant_->drives()[drive]->inverter->get_parameter(name).has_value();
}

// Some refusals mean only that the drive is without power.
void Trial::start_up() {
  if (started_) return;
  started_ = true;
  constexpr Duration kStartUp = std::chrono::seconds(5);
  constexpr Duration kStep = std::chrono::milliseconds(50);
  plant_->start();
  for (const auto& d : plant_->drives()) plant_->set_power(*d, true);
  for (Duration t{}; t < kStartUp && !plant_->settled(); t += kStep) scheduler_.run_until(scheduler_.now() + kStep);
}

std::optional<std::string> Trial::objection(std::size_t drive, std::string_view command, const rig::Json& value) {
  rig::DriveUnit& unit = *plant_->drives()[drive];
  if (command == "parameter") return parameter_objection(drive, value);
  const auto done = rig::execute(*plant_, command, unit.spec.name, value);
  if (done) return {};
  if (done.error().code == rig::CommandCode::kInvalidValue || done.error().code == rig::CommandCode::kUnknownCommand)
    return done.error().message;
  // Names are told by the drive itself, as a refusal.
  if (command == "terminal") {
    const auto& known = observers_[drive]->terminal_names();
    for (const auto& [name, on] : value.items())
      if (std::find(known.begin(), known.end(), name) == known.end()) return done.error().message;
  }
  if (command == "switch" || command == "analog") return done.error().message;
  return {};
}

std::optional<std::string> Trial::parameter_objection(std::size_t drive, const rig::Json& value) {
  rig::DriveUnit& unit = *plant_->drives()[drive];
  if (!value.is_object() || value.empty()) return "parameter takes {Pr.7: 2}, with the values to write.";
  for (const auto& [name, written] : value.items()) {
    double number = 0;
    if (!written.is_string() || !rig::parse_number(written.get<std::string>(), number))
      return name + " is " + written.dump() + "; allowed: a number, without unit (a parameter has its own).";
    // Range and existence, outside the panel's rules, which depend on the drive's state.
    const auto preset = unit.inverter->preset_parameter(name, number);
    if (preset) continue;
    if (!has_parameter(drive, name)) {
      // Not a parameter, but perhaps one of the clears. Only a drive with power knows them, and it may refuse them for
      // its mode, which is no mistake of the file: an unknown name is refused with the same sentence as a preset, a
      // wrong value with the same sentence as any other wrong value.
      start_up();
      constexpr double kNeverRight = -12345;
      const auto cleared = unit.inverter->set_parameter(name, number);
      if (cleared) continue;
      if (cleared.error() != preset.error()) {
        const auto wrong = unit.inverter->set_parameter(name, kNeverRight);
        if (wrong || wrong.error() != cleared.error()) continue;
        return rig::sentence(cleared.error());
      }
    }
    std::vector<std::string> names;
    for (const auto& p : unit.inverter->parameters())
      names.push_back("Pr." + std::to_string(p.id.number) + (p.id.sub != 0 ? "." + std::to_string(p.id.sub) : ""));
    const bool known = std::find(names.begin(), names.end(), name) != names.end();
    return rig::sentence((preset.error().find(name) == std::string::npos ? name + ": " : std::string{}) +
                         preset.error()) +
           (known ? std::string{} : rig::suggestion(name, std::vector<std::string_view>(names.begin(), names.end())));
  }
  return {};
}

}  // namespace vinv::scenario
