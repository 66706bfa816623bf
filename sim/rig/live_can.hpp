// The CAN buses of a live plant on this machine: servers for masters, and the ports to buses that are elsewhere.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/rig/plant.hpp"
#include "sim/transports/can/can_recorder.hpp"
#include "sim/transports/can/can_servers.hpp"
#include "sim/transports/capture_file.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::rig {

class LiveCan {
 public:
  // Opens what the buses with boards need and tells the drives their endpoints. start_unix_ns: what simulated zero is,
  // in nanoseconds since 1970. Loop and plant outlive it. Throws PlantFileError with the network's place: a port in
  // use, an interface that is not there ...
  LiveCan(transports::EventLoop& loop, Plant& plant, const std::string& runtime_folder, std::int64_t start_unix_ns);

  // "FILE" for all buses, or "NETWORK=FILE": a candump log if it ends in .log, a capture if it ends in .pcapng. Throws
  // std::runtime_error with a sentence.
  void record(const std::string& what);
  // Why a recording ended early; empty if none did.
  std::string recording_failure() const;

 private:
  void join(std::size_t bus);
  void serve_socketcand(std::size_t bus);
  void serve_slcan(std::size_t bus, const std::string& runtime_folder);
  bool is_used(std::size_t bus) const;
  [[noreturn]] void refuse(Position at, const CanNetwork& network, const std::string& why, const std::string& allowed);

  transports::EventLoop& loop_;
  Plant& plant_;
  std::int64_t start_unix_ns_;
  std::vector<CanEndpoint> endpoints_;  // by bus
  std::vector<std::unique_ptr<transports::SocketcandServer>> socketcand_;
  std::vector<std::unique_ptr<transports::SlcanServer>> slcan_;
  std::vector<std::unique_ptr<transports::SlcanPty>> slcan_ptys_;
  std::vector<std::shared_ptr<transports::CandumpLog>> logs_;
  std::vector<std::shared_ptr<transports::CaptureFile>> captures_;
};

}  // namespace vinv::rig
