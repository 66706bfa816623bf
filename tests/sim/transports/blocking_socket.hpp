// A client that knows nothing of our code: plain blocking sockets. Every wait ends after ten seconds, as an error.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {

class BlockingSocket {
 public:
  static BlockingSocket tcp(std::uint16_t port, int receive_buffer = 0) {
    BlockingSocket s(::socket(AF_INET, SOCK_STREAM, 0));
    if (receive_buffer > 0) ::setsockopt(s.fd(), SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    s.connected_ = ::connect(s.fd(), reinterpret_cast<sockaddr*>(&to), sizeof to) == 0;
    return s;
  }
  static BlockingSocket local(const std::string& path) {
    BlockingSocket s(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    std::strncpy(to.sun_path, path.c_str(), sizeof to.sun_path - 1);
    s.connected_ = ::connect(s.fd(), reinterpret_cast<sockaddr*>(&to), sizeof to) == 0;
    return s;
  }

  int fd() const { return fd_.get(); }
  bool connected() const { return connected_; }
  bool send(const std::string& bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = ::send(fd(), bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }
  // This many bytes, or fewer if the stream ends or stalls.
  std::string receive(std::size_t size) {
    std::string out(size, '\0');
    std::size_t done = 0;
    while (done < size) {
      const ssize_t n = ::recv(fd(), out.data() + done, size - done, 0);
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
    out.resize(done);
    return out;
  }
  // True once the other end has closed or reset; reads what is left.
  bool ends() {
    char buffer[4096];
    for (;;) {
      const ssize_t n = ::recv(fd(), buffer, sizeof buffer, 0);
      if (n == 0) return true;
      if (n < 0) return errno == ECONNRESET;
    }
  }
  void half_close() { ::shutdown(fd(), SHUT_WR); }
  void reset() {
    const linger hard{1, 0};
    ::setsockopt(fd(), SOL_SOCKET, SO_LINGER, &hard, sizeof hard);
    fd_.reset();
  }
  void close() { fd_.reset(); }

 private:
  explicit BlockingSocket(int fd) : fd_(fd) {
    const timeval limit{10, 0};
    ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    ::setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  }
  UniqueFd fd_;
  bool connected_ = false;
};

}  // namespace vinv::transports
