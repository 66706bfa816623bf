#include "sim/campaign/result_log.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace vinv::campaign {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  throw std::runtime_error(path + " cannot be " + what + ": " + std::strerror(error) + ".");
}

// A device or a pipe cannot be synced, which does no harm.
bool synced(int file) { return ::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS; }

}  // namespace

ResultLog::ResultLog(const std::string& path) : path_(path) {
  const fs::path folder = fs::path(path).parent_path();
  std::error_code error;
  if (!folder.empty() && !fs::is_directory(folder, error)) {
    fs::create_directories(folder, error);
    if (error) fail(folder.string(), "made", error.value());
  }
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY, 0666);
  if (file_ < 0) fail(path, "written", errno);
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(file_);
    throw std::runtime_error(path + " is being written by another run of this shard.");
  }
  struct stat info {};
  char last = '\n';
  if (::fstat(file_, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0 &&
      ::pread(file_, &last, 1, info.st_size - 1) == 1)
    torn_ = last != '\n';
  // The name of a new file is on the disk only when its folder is.
  const int parent = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (parent >= 0) {
    synced(parent);
    ::close(parent);
  }
}

ResultLog::~ResultLog() { ::close(file_); }

void ResultLog::append(const std::string& line) {
  const std::string bytes = (torn_ ? "\n" : "") + line + "\n";
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(file_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int error = errno;
      torn_ = torn_ || done > 0;
      fail(path_, "written", error);
    }
    done += static_cast<std::size_t>(n);
  }
  torn_ = false;
  if (!synced(file_)) fail(path_, "written", errno);
}

Results read_results(const std::string& folder, const Campaign& campaign, const std::string& build) {
  Results out;
  std::error_code error;
  if (!fs::exists(folder, error)) return out;
  std::vector<std::string> files;
  auto it = fs::directory_iterator(folder, error);
  for (const auto end = fs::end(it); !error && it != end; it.increment(error))
    if (it->path().extension() == ".jsonl" && it->is_regular_file(error)) files.push_back(it->path().string());
  if (error) fail(folder, "read", error.value());
  std::sort(files.begin(), files.end());
  std::map<std::uint64_t, std::string> digests;
  for (const std::string& file : files) {
    std::ifstream in(file, std::ios::binary);
    if (!in) fail(file, "read", errno);
    for (std::string line; std::getline(in, line);) {
      if (line.empty()) continue;
      auto result = from_line(line);
      if (!result) {
        ++out.torn_lines;
        continue;
      }
      const std::uint64_t number = result->number;
      if (number < 1 || number > campaign.cases()) {
        ++out.other_state;
        continue;
      }
      auto digest = digests.find(number);
      if (digest == digests.end()) digest = digests.emplace(number, campaign.digest(number)).first;
      if (result->digest != digest->second || result->measured.size() != campaign.measures.size()) {
        ++out.other_state;
        continue;
      }
      if (!build.empty() && result->build != build) {
        ++out.other_builds[result->build];
        continue;
      }
      if (build.empty()) result->build.clear();
      const auto [at, added] = out.cases.emplace(number, *result);
      if (added || at->second == *result) continue;
      // Which one stays does not depend on how the files are called.
      if (to_line(*result) < to_line(at->second)) at->second = std::move(*result);
      if (std::find(out.contradictory.begin(), out.contradictory.end(), number) == out.contradictory.end())
        out.contradictory.push_back(number);
    }
    if (in.bad()) fail(file, "read", errno);
  }
  std::sort(out.contradictory.begin(), out.contradictory.end());
  return out;
}

}  // namespace vinv::campaign
