#include "sim/campaign/files.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "sim/rig/plant_file.hpp"

namespace vinv::campaign {

std::string read_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw std::runtime_error(path + " is a folder, not a file.");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + " cannot be read: " + std::strerror(errno) + ".");
  // One byte too many is enough for a refusal; a device may never end.
  std::string text(rig::kMaxPlantFileBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw std::runtime_error(path + " cannot be read: it is no ordinary file.");
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > rig::kMaxPlantFileBytes)
    throw std::runtime_error(path + " is larger than " + std::to_string(rig::kMaxPlantFileBytes) + " bytes.");
  return text;
}

}  // namespace vinv::campaign
