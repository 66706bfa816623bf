#include "sim/rig/folders.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace vinv::rig {
namespace {

// The XDG specification: a relative path is to be ignored.
std::string absolute_from(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && value[0] == '/' ? value : "";
}

}  // namespace

std::string default_state_folder(const std::string& plant) {
  if (const std::string state = absolute_from("XDG_STATE_HOME"); !state.empty()) return state + "/vinverter/" + plant;
  const std::string home = absolute_from("HOME");
  return (home.empty() ? "/tmp" : home) + "/.local/state/vinverter/" + plant;
}

std::string runtime_root() {
  if (const std::string run = absolute_from("XDG_RUNTIME_DIR"); !run.empty()) return run + "/vinverter";
  return "/tmp/vinverter-" + std::to_string(::getuid());
}

std::string default_runtime_folder(const std::string& plant) { return runtime_root() + "/" + plant; }

void make_private_folder(const std::string& folder) {
  const std::filesystem::path path(folder);
  const std::string parent = path.parent_path().string();
  if (!parent.empty() && parent != folder && !std::filesystem::exists(parent)) make_private_folder(parent);
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    throw std::runtime_error("the folder " + folder + " cannot be made: " + std::strerror(errno) + ".");
  struct stat info {};
  if (::lstat(folder.c_str(), &info) != 0 || !S_ISDIR(info.st_mode) || info.st_uid != ::getuid())
    throw std::runtime_error(folder + " is not a folder of this user; remove it, or set XDG_RUNTIME_DIR.");
}

}  // namespace vinv::rig
