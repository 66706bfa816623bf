// The client end of a plant's control socket.
#pragma once

#include <string>
#include <vector>

#include "sim/rig/commands.hpp"

namespace vinv::tools {

class ControlClient {
 public:
  // Throws std::runtime_error with a sentence if nobody listens there.
  explicit ControlClient(const std::string& socket_path);
  ~ControlClient();
  ControlClient(const ControlClient&) = delete;
  ControlClient& operator=(const ControlClient&) = delete;

  // Sends a JSON-RPC request and waits for its answer, at most 5 s. Throws if the plant does not answer.
  rig::Json call(const std::string& method, const rig::Json& params);

 private:
  int fd_ = -1;
  int next_id_ = 1;
  std::string pending_;
};

// Control sockets below the runtime folder that somebody listens on.
std::vector<std::string> running_plants();

}  // namespace vinv::tools
