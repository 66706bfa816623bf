// A live plant that runs until its client, on a thread of its own, is done; what it is asked over sockets.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "sim/rig/live_plant.hpp"

namespace vinv::rig {

namespace fs = std::filesystem;

// Sends, then reads until enough has come or 5 s have passed.
inline std::string exchange(int fd, const std::string& request, const std::function<bool(const std::string&)>& enough) {
  std::string answer;
  const timeval patience{5, 0};
  ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  if (::send(fd, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()))
    return "not sent";
  char buffer[4096];
  while (!enough(answer)) {
    const ssize_t n = ::recv(fd, buffer, sizeof buffer, 0);
    if (n <= 0) break;
    answer.append(buffer, static_cast<std::size_t>(n));
  }
  ::close(fd);
  return answer;
}

inline std::string ask_tcp(std::uint16_t port, const std::string& request, std::size_t answer_bytes) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) return "not connected";
  return exchange(fd, request, [&](const std::string& a) { return a.size() >= answer_bytes; });
}

inline std::string ask_control(const std::string& path, const std::string& request) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  if (::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) return "not connected";
  return exchange(fd, request + "\n", [](const std::string& a) { return a.ends_with("\n"); });
}

class LivePlantTest : public testing::Test {
 protected:
  LivePlantTest() {
    std::string pattern = (fs::temp_directory_path() / "vinv-live-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    options_.state_folder = folder_ + "/state";
    options_.runtime_folder = folder_ + "/run";
  }
  ~LivePlantTest() override { fs::remove_all(folder_); }

  // Runs a plant until it is ready, then the client on its own thread, then stops.
  void serve(const std::string& text, const std::function<void(LivePlant&, const Json& ready)>& client) {
    transports::EventLoop loop;
    const Catalogue catalogue = shipped_catalogue();
    LivePlant live(loop, parse_plant_file(text, "p.yaml", catalogue), catalogue, options_,
                   [this](const std::string& s) { notices_.push_back(s); });
    std::thread thread;
    live.when_ready([&] {
      thread = std::thread([&, ready = live.ready_json()] {
        client(live, ready);
        loop.stop();
      });
    });
    loop.run();
    if (thread.joinable()) thread.join();
    EXPECT_EQ(live.store_eeproms(), "");
  }

  std::string folder_;
  LiveOptions options_;
  std::vector<std::string> notices_;
};

}  // namespace vinv::rig
