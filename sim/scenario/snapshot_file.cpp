#include "sim/scenario/snapshot_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "sim/base/archive.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTitle = "vinverter snapshot\n";
constexpr std::size_t kMaxBytes = std::size_t{1} << 30;

// The value of "key: value\n" at the beginning of text, which loses it; false if it is not there.
bool take_line(std::string_view& text, std::string_view key, std::string& value) {
  if (!text.starts_with(key) || !text.substr(key.size()).starts_with(": ")) return false;
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return false;
  value = text.substr(key.size() + 2, end - key.size() - 2);
  text.remove_prefix(end + 1);
  return true;
}

}  // namespace

Result<void, std::string> write_snapshot_file(const std::string& path, const SnapshotFile& file) {
  const std::string head = std::string(kTitle) + "build: " + file.build + "\nscenario: " + file.scenario +
                           "\nat: " + show_duration(file.at) + "\n\n";
  // A device is written as it is.
  std::error_code error;
  const bool ordinary = !fs::exists(path, error) || fs::is_regular_file(path, error);
  const std::string temporary = ordinary ? path + ".part" : path;
  errno = 0;
  std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
  out.write(head.data(), static_cast<std::streamsize>(head.size()));
  out.write(reinterpret_cast<const char*>(file.bytes.data()), static_cast<std::streamsize>(file.bytes.size()));
  out.close();
  const int why = errno;
  if (!out) {
    if (ordinary) fs::remove(temporary, error);
    return Unexpected("the snapshot " + path + " cannot be written: " + std::strerror(why != 0 ? why : EIO) + ".");
  }
  if (!ordinary) return {};
  fs::rename(temporary, path, error);
  if (error) return Unexpected("the snapshot " + path + " cannot be written: " + error.message() + ".");
  return {};
}

Result<SnapshotFile, std::string> read_snapshot_file(const std::string& path, const std::string& build) {
  std::error_code error;
  const std::string cannot = "the snapshot " + path + " cannot be ";
  if (!fs::is_regular_file(path, error)) return Unexpected(cannot + "read: there is no such file.");
  const auto size = fs::file_size(path, error);
  if (error || size > kMaxBytes) return Unexpected(cannot + "read: it is too large.");
  std::ifstream in(path, std::ios::binary);
  std::string all(static_cast<std::size_t>(size), '\0');
  in.read(all.data(), static_cast<std::streamsize>(all.size()));
  if (!in) return Unexpected(cannot + "read: " + std::strerror(errno) + ".");
  std::string_view text = all;
  if (!text.starts_with(kTitle)) return Unexpected(cannot + "used: it is no snapshot of a run.");
  text.remove_prefix(kTitle.size());
  SnapshotFile file;
  std::string at;
  if (!take_line(text, "build", file.build)) return Unexpected(cannot + "used: its head is damaged.");
  // First: another build may write another head.
  if (file.build != build)
    return Unexpected(cannot + "used: it was written by build " + file.build + ", this is " + build +
                      ". Snapshots serve the build that wrote them.");
  if (!take_line(text, "scenario", file.scenario) || !take_line(text, "at", at) || !text.starts_with('\n'))
    return Unexpected(cannot + "used: its head is damaged.");
  text.remove_prefix(1);
  file.bytes.assign(text.begin(), text.end());
  if (Archive a = Archive::loading(file.bytes); a.failed())
    return Unexpected(cannot + "used: " + rig::sentence(a.error()));
  return file;
}

}  // namespace vinv::scenario
