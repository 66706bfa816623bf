// Files of a campaign as texts.
#pragma once

#include <string>

namespace vinv::campaign {

// Throws std::runtime_error with a sentence: no such file, a folder, a device, larger than a plant file may be.
std::string read_file(const std::string& path);

}  // namespace vinv::campaign
