// A serial client as libraries write them: open, tcgetattr, cfsetspeed, tcsetattr, write, read with a time limit.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <termios.h>

#include <string>

#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {

class TtyClient {
 public:
  explicit TtyClient(const std::string& path) : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {}

  bool is_open() const { return fd_.is_open(); }
  int fd() const { return fd_.get(); }
  bool set_speed(speed_t speed) {
    termios t{};
    if (::tcgetattr(fd(), &t) != 0) return false;
    ::cfmakeraw(&t);
    ::cfsetispeed(&t, speed);
    ::cfsetospeed(&t, speed);
    return ::tcsetattr(fd(), TCSANOW, &t) == 0;
  }
  bool write(const std::string& bytes) {
    return ::write(fd(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  }
  // This many bytes, or what came within ten seconds.
  std::string read(std::size_t size) {
    std::string out;
    while (out.size() < size) {
      pollfd p{fd(), POLLIN, 0};
      if (::poll(&p, 1, 10'000) <= 0) break;
      char buffer[256];
      const ssize_t n = ::read(fd(), buffer, std::min(sizeof buffer, size - out.size()));
      if (n <= 0) break;
      out.append(buffer, static_cast<std::size_t>(n));
    }
    return out;
  }
  // What is there now.
  std::string read_waiting() {
    char buffer[4096];
    const ssize_t n = ::read(fd(), buffer, sizeof buffer);
    return n > 0 ? std::string(buffer, static_cast<std::size_t>(n)) : std::string();
  }
  void close() { fd_.reset(); }

 private:
  UniqueFd fd_;
};

}  // namespace vinv::transports
