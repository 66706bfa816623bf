// Snapshots of a Mitsubishi inverter: all of its memory, and the plant's.
#include <string>

#include "motor_model/inverter/mitsubishi/inverter.hpp"

namespace vinv::inverter::mitsubishi {

void MitsubishiInverter::archive_state(Archive& a) {
  // All members are named, so that a new one is thought of here. The first ones are what the inverter was made as.
  VINV_MEMBERS(*this, personality, data, model, option_fitted, nominal_mains_v_rms, brake_resistor, snapshot_grid, now,
               mains, breaker, control_alive, eeprom_changed, wiring, causes, store, record, v, core, plant, events,
               settings, settings_selection, settings_revision, functions, functions_revision);
  if (a.loads()) functions_revision = 0;  // no store has it
  a.must_match("family", personality.family);
  a.must_match("inverter", model.model);
  a.must_match("option board slot (fitted or empty)", option_fitted ? 1 : 0);
  a.must_match("supply voltage", static_cast<std::uint64_t>(nominal_mains_v_rms * 1000));
  a.must_match("snapshot grid", static_cast<std::uint64_t>(snapshot_grid.count()));
  VINV_FIELDS(a, MitsubishiInverter, now, mains, breaker, control_alive, eeprom_changed, wiring, causes, store, record,
              v, core, plant, events, settings, settings_selection, settings_revision);

  archive_family(a);

  // What is used as an index later.
  a.require(!v.alarm.row || *v.alarm.row < data.alarms.rows().size(), "an alarm that the family does not have");
  a.require(v.panel.monitor >= 0 && v.panel.monitor < 3, "a display that the panel does not have");
  for (const UserGroup& group : record.groups) {
    a.require(group.count <= UserGroup::kCapacity, "a user group is longer than there can be");
  }
}

}  // namespace vinv::inverter::mitsubishi
