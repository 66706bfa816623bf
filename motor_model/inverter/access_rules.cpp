#include "motor_model/inverter/access_rules.hpp"

namespace vinv::inverter {
namespace {

bool mode_permits(const AccessSituation& s) {
  if (s.writer == Writer::kNetwork) return s.mode == port::OperationMode::kNetwork;
  // The combined modes count as PU operation for the panel's parameter writes.
  return s.mode != port::OperationMode::kExternal && s.mode != port::OperationMode::kNetwork;
}

}  // namespace

std::optional<port::Refusal> write_refusal(const ParameterRow& row, const AccessSituation& s) {
  if (row.kind == ParameterKind::kManufacturer || row.read_only) return port::Refusal::kReadOnly;
  if (s.writer == Writer::kNetwork && row.network_read_only) return port::Refusal::kReadOnly;
  if (!s.in_user_group) return port::Refusal::kWriteDisabled;
  const bool any_mode = s.disable == WriteDisable::kAlways || (s.writer == Writer::kPanel && row.panel_any_mode);
  if (!any_mode && !mode_permits(s)) return port::Refusal::kWrongMode;
  if (s.disable == WriteDisable::kLocked && !row.write_when_locked) return port::Refusal::kWriteDisabled;
  if (s.running) {
    const bool permitted = s.disable == WriteDisable::kAlways ? row.write_while_running_free : row.write_while_running;
    if (!permitted) return port::Refusal::kRunning;
  }
  return std::nullopt;
}

std::optional<port::Refusal> clear_refusal(const AccessSituation& s) {
  if (s.disable != WriteDisable::kAlways && !mode_permits(s)) return port::Refusal::kWrongMode;
  if (s.disable == WriteDisable::kLocked) return port::Refusal::kWriteDisabled;
  if (s.running) return port::Refusal::kRunning;
  return std::nullopt;
}

}  // namespace vinv::inverter
