// Snapshots of a slave: its state, and what has to hold of it before the protocol relies on it.
#include "option_boards/canopen/slave.hpp"

namespace vinv::canopen {
namespace {

bool is_nmt_state(NmtState state) {
  switch (state) {
    case NmtState::kOff:
    case NmtState::kInitialising:
    case NmtState::kStopped:
    case NmtState::kOperational:
    case NmtState::kPreOperational: return true;
  }
  return false;
}

}  // namespace

void Slave::archive_state(Archive& a) {
  VINV_MEMBERS(*this, table, application, state);
  a.must_match("number of objects of a CANopen slave", table.rows().size());
  a.io(state);
  if (!a.loads() || a.failed()) return;
  a.require(is_nmt_state(state.nmt), "a CANopen node is in no state of network management");
  a.require(state.node <= kLastNode, "a CANopen node has an address that no node has");
  for (const Rpdo& rpdo : state.rpdos) a.require(is_sound(PdoDirection::kReceive, rpdo.settings), "a PDO's mapping");
  for (const Tpdo& tpdo : state.tpdos) a.require(is_sound(PdoDirection::kTransmit, tpdo.settings), "a PDO's mapping");
}

// The objects are those of the mapping, and fit the PDO.
bool Slave::is_sound(PdoDirection direction, const PdoSettings& s) const {
  if (s.mapped > kMaxMapped || s.length > kMaxPdoLength) return false;
  unsigned length = 0;
  for (std::size_t i = 0; i < s.mapped; ++i) {
    const auto object = resolve_mapping(table_, direction, s.mapping[i]);
    if (!object || !(*object == s.objects[i])) return false;
    length += object->size;
  }
  return s.mapped == 0 || length == s.length;
}

}  // namespace vinv::canopen
