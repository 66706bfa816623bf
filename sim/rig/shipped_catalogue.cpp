#include "sim/rig/catalogue.hpp"

namespace vinv::rig {

Catalogue shipped_catalogue() {
  Catalogue c;
  c.make_inverter = inverter::make_inverter;
  c.families = inverter::families;
  c.models = inverter::models;
  c.make_board = boards::make_board;
  c.board_types = boards::board_types;
  c.board_families = boards::board_families;
  c.board_traits = boards::board_traits;
  return c;
}

}  // namespace vinv::rig
