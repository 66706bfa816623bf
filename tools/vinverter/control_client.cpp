#include "tools/vinverter/control_client.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "sim/rig/folders.hpp"

namespace vinv::tools {
namespace {

// Connected socket, or -1 with errno.
int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  const timeval patience{5, 0};
  ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  ::setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  const int reason = errno;
  ::close(fd);
  errno = reason;
  return -1;
}

}  // namespace

ControlClient::ControlClient(const std::string& socket_path) : fd_(connect_to(socket_path)) {
  if (fd_ >= 0) return;
  if (errno == EACCES)
    throw std::runtime_error(socket_path + " may not be used: only who runs a plant may command it.");
  throw std::runtime_error("no plant answers at " + socket_path + ": " + std::strerror(errno) +
                           ". `vinverter run` starts one.");
}

ControlClient::~ControlClient() { ::close(fd_); }

rig::Json ControlClient::call(const std::string& method, const rig::Json& params) {
  const int id = next_id_++;
  const std::string line = rig::Json{{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}}.dump(
                               -1, ' ', false, rig::Json::error_handler_t::replace) +
                           "\n";
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t n = ::send(fd_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw std::runtime_error("the plant does not take the command: " + std::string(std::strerror(errno)) + ".");
    sent += static_cast<std::size_t>(n);
  }
  for (;;) {
    const std::size_t end = pending_.find('\n');
    if (end != std::string::npos) {
      const rig::Json answer = rig::Json::parse(pending_.substr(0, end), nullptr, false);
      pending_.erase(0, end + 1);
      if (answer.is_object()) return answer;
      throw std::runtime_error("the plant's answer is not JSON; is this its control socket?");
    }
    char buffer[16384];
    const ssize_t n = ::recv(fd_, buffer, sizeof buffer, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) throw std::runtime_error("the plant has ended.");
    if (n < 0) throw std::runtime_error("the plant does not answer: " + std::string(std::strerror(errno)) + ".");
    pending_.append(buffer, static_cast<std::size_t>(n));
  }
}

std::vector<std::string> running_plants() {
  std::vector<std::string> out;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(rig::runtime_root(), error)) {
    const std::string path = (entry.path() / rig::kControlSocketName).string();
    const int fd = connect_to(path);
    if (fd < 0) continue;
    ::close(fd);
    out.push_back(path);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace vinv::tools
