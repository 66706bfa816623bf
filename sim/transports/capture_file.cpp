#include "sim/transports/capture_file.hpp"

#include <fcntl.h>

#include <cerrno>

#include "sim/transports/io_error.hpp"

namespace vinv::transports {

Result<std::shared_ptr<CaptureFile>, std::string> CaptureFile::create(const std::string& path,
                                                                      std::int64_t start_unix_ns) {
  UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  if (!fd.is_open()) return Unexpected("cannot record to " + path + ": " + describe_errno(errno));
  const std::shared_ptr<CaptureFile> file(new CaptureFile(path, std::move(fd), start_unix_ns));
  file->encoder_.begin_section(file->block_, "vinverter");
  file->write_out();
  if (!file->error_.empty()) return Unexpected(file->error_);
  return file;
}

std::uint32_t CaptureFile::add_interface(LinkType type, std::string_view name) {
  const std::uint32_t id = encoder_.add_interface(block_, type, name);
  write_out();
  return id;
}

void CaptureFile::packet(std::uint32_t interface_id, Instant at, ByteView data, PacketDirection direction) {
  encoder_.packet(block_, interface_id, at, data, direction);
  ++packets_;
  write_out();
}

void CaptureFile::write_out() {
  std::size_t done = 0;
  while (error_.empty() && done < block_.size()) {
    const ssize_t n = ::write(fd_.get(), block_.data() + done, block_.size() - done);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n == 0 || errno != EINTR) {
      error_ = "recording to " + path_ + " ended: " + describe_errno(n == 0 ? ENOSPC : errno);
    }
  }
  block_.clear();
}

}  // namespace vinv::transports
