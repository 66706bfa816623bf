// Where a live plant keeps files: state that lasts (EEPROM) and what lives as long as the process (control socket,
// names of pseudo-terminals).
#pragma once

#include <string>

namespace vinv::rig {

// $XDG_STATE_HOME/vinverter/PLANT, or ~/.local/state/vinverter/PLANT.
std::string default_state_folder(const std::string& plant);

// $XDG_RUNTIME_DIR/vinverter, or /tmp/vinverter-UID.
std::string runtime_root();
// runtime_root()/PLANT
std::string default_runtime_folder(const std::string& plant);
// Name of the control socket in a plant's runtime folder.
inline constexpr const char* kControlSocketName = "control.sock";

// Makes the folder and missing parents, readable by this user only. Throws std::runtime_error with a sentence if it
// cannot, or if there is something there that belongs to somebody else or is a link.
void make_private_folder(const std::string& folder);

}  // namespace vinv::rig
