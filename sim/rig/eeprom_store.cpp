#include "sim/rig/eeprom_store.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace vinv::rig {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFileBytes = 4 * 1024 * 1024;  // far above any EEPROM; a wrong file is not read whole

[[noreturn]] void fail(const std::string& what, int error) {
  throw std::runtime_error(what + ": " + std::strerror(error) + ".");
}

struct Descriptor {
  int fd = -1;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

void sync_folder(const std::string& folder) {
  const Descriptor dir{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (dir.fd < 0 || ::fsync(dir.fd) != 0) fail("the folder " + folder + " cannot be synchronised", errno);
}

}  // namespace

void write_whole_file(const std::string& path, std::string_view text, FileSync sync) {
  const std::string temporary = path + ".new";
  const auto give_up = [&](const std::string& name, int error) {
    ::unlink(temporary.c_str());  // a full disk would otherwise stay full of it
    fail(name + " cannot be written", error);
  };
  {
    const Descriptor file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (file.fd < 0) fail(temporary + " cannot be written", errno);
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t n = ::write(file.fd, text.data() + done, text.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) give_up(temporary, errno);
      done += static_cast<std::size_t>(n);
    }
    if (sync == FileSync::kYes && ::fsync(file.fd) != 0) give_up(temporary, errno);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) give_up(path, errno);
  if (sync == FileSync::kYes)
    sync_folder(fs::path(path).has_parent_path() ? fs::path(path).parent_path().string() : ".");
}

EepromStore::EepromStore(std::string folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw std::runtime_error("the state folder " + folder_ + " cannot be made: " + error.message() + ".");
  const std::string lock = folder_ + "/lock";
  lock_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) fail(lock + " cannot be opened", errno);
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const int reason = errno;
    ::close(lock_);
    if (reason == EWOULDBLOCK)
      throw std::runtime_error("the state folder " + folder_ +
                               " is in use by another vinverter; stop it, name the plant differently, or give another "
                               "--state-dir.");
    fail(lock + " cannot be locked", reason);
  }
  writer_ = std::thread([this] {
    // Descriptors of its own, for the loop's sake: of a table that threads share, each call on a socket takes and
    // returns its descriptor with atomic counts. Where there is no such call it stays shared.
    static_cast<void>(::close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_UNSHARE));
    write_queued();
  });
}

EepromStore::~EepromStore() {
  {
    const std::lock_guard guard(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  writer_.join();
  ::close(lock_);
}

std::optional<std::string> EepromStore::load(const std::string& drive, Memory memory) const {
  const std::string file = path(drive, memory);
  const Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  if (in.fd < 0) {
    if (errno == ENOENT) return {};
    fail(file + " cannot be read", errno);
  }
  std::string text;
  char buffer[16384];
  while (text.size() <= kMaxFileBytes) {
    const ssize_t n = ::read(in.fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(file + " cannot be read", errno);
    if (n == 0) break;
    text.append(buffer, static_cast<std::size_t>(n));
  }
  return text;
}

std::string EepromStore::keep_aside(const std::string& drive, Memory memory) const {
  const std::string file = path(drive, memory);
  for (int n = 1;; ++n) {
    const std::string aside = file + ".damaged-" + std::to_string(n);
    // link, unlike rename, never replaces a file that is there already.
    if (::link(file.c_str(), aside.c_str()) == 0) {
      if (::unlink(file.c_str()) != 0) fail(file + " cannot be moved aside", errno);
      sync_folder(folder_);
      return aside;
    }
    if (errno != EEXIST) fail(file + " cannot be moved aside", errno);
  }
}

void EepromStore::store(const std::string& drive, std::string text, Memory memory) {
  {
    const std::lock_guard guard(mutex_);
    queued_[file_name(drive, memory)] = std::move(text);
    queue_failed();
  }
  changed_.notify_all();
}

std::string EepromStore::flush() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return queued_.empty() && !writing_; });
  if (!failed_.empty()) {
    failure_.clear();  // told before, or by the new attempt
    queue_failed();
    changed_.notify_all();
    changed_.wait(lock, [this] { return queued_.empty() && !writing_; });
  }
  return std::exchange(failure_, {});
}

// A text that is queued already is newer.
void EepromStore::queue_failed() {
  queued_.merge(failed_);
  failed_.clear();
}

std::string EepromStore::take_failure() {
  const std::lock_guard guard(mutex_);
  return std::exchange(failure_, {});
}

void EepromStore::write_queued() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || !queued_.empty(); });
    if (queued_.empty()) return;
    auto [file, text] = std::pair(queued_.begin()->first, std::move(queued_.begin()->second));
    queued_.erase(queued_.begin());
    writing_ = true;
    lock.unlock();
    std::string failure;
    try {
      write_whole_file(folder_ + "/" + file, text);
    } catch (const std::runtime_error& e) {
      failure = e.what();
    }
    lock.lock();
    writing_ = false;
    if (!failure.empty()) failed_[file] = std::move(text);
    if (failure_.empty()) failure_ = failure;
    changed_.notify_all();
  }
}

}  // namespace vinv::rig
