#include "motor_model/inverter/inverter.hpp"

namespace vinv::inverter {

Outcome Inverter::save(Bytes& out) {
  if (!on_snapshot_grid()) {
    return Unexpected(
        std::string("a snapshot is taken only on the grid of the inverter's configuration, after a tick"));
  }
  save_snapshot(*this, out);
  return {};
}

Outcome Inverter::load(ByteView snapshot) { return load_snapshot(*this, snapshot); }

}  // namespace vinv::inverter
