// A plant in real time: its wires are sockets and serial lines of this machine, its EEPROMs files, its control socket
// open.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/rig/control_session.hpp"
#include "sim/rig/eeprom_store.hpp"
#include "sim/rig/live_can.hpp"
#include "sim/rig/live_ethernet_ip.hpp"
#include "sim/rig/plant.hpp"
#include "sim/transports/event_loop.hpp"
#include "sim/transports/ip_recorder.hpp"
#include "sim/transports/tcp_listener.hpp"
#include "sim/transports/unix_socket_listener.hpp"

namespace vinv::rig {

struct LiveOptions {
  bool fresh = false;                   // stored EEPROMs are not loaded, and overwritten
  std::string state_folder;             // empty: default_state_folder
  std::string runtime_folder;           // empty: default_runtime_folder
  std::string record_ip;                // a pcapng file for all TCP and UDP traffic; empty: none
  std::vector<std::string> record_can;  // as LiveCan::record has it
  std::uint64_t seed = 1;               // as PlantOptions has it
};

class LivePlant {
 public:
  // What a person should know while the plant runs; a sentence.
  using Notice = std::function<void(const std::string& sentence)>;

  // Opens everything and powers the drives; nothing moves before loop.run(). The loop outlives the plant. Throws
  // PlantFileError, or std::runtime_error with a sentence: a port in use, a device that is not there ...
  LivePlant(transports::EventLoop& loop, PlantFile file, const Catalogue& catalogue, const LiveOptions& options,
            Notice notice);
  ~LivePlant();

  // Calls once when every drive has started up and its address is known.
  void when_ready(std::function<void()> ready);
  // {"drives": [...], "control": PATH}, as `vinverter run --ready-file` writes it.
  Json ready_json() const;
  // Drives and endpoints for a person, with a line for each by which a foreign client reaches it.
  std::string table() const;
  // Writes all EEPROMs, and memories of option boards, that have changed. A failure as a sentence, or nothing.
  std::string store_eeproms();

  Plant& plant() { return *plant_; }
  const std::string& control_path() const { return control_listener_->path(); }
  const std::string& state_folder() const { return store_->folder(); }

 private:
  std::int64_t start_unix_ns() const;
  void open_tcp(const LiveOptions& options);
  void open_ethernet_ip();
  void open_serial(const std::string& runtime_folder);
  void open_line(std::size_t index, const std::string& runtime_folder);
  void schedule_housekeeping();
  void keep_house();
  void collect_memories();

  transports::EventLoop& loop_;
  Notice notice_;
  std::unique_ptr<EepromStore> store_;
  std::unique_ptr<transports::IpRecorder> recorder_;
  std::unique_ptr<Plant> plant_;
  std::unique_ptr<ControlServer> control_;
  std::unique_ptr<transports::UnixSocketListener> control_listener_;
  std::vector<std::unique_ptr<transports::TcpListener>> tcp_;
  std::unique_ptr<LiveEthernetIp> ethernet_ip_;
  std::unique_ptr<LiveCan> can_;
  kernel::EventId housekeeping_ = 0;
  kernel::EventId ready_check_ = 0;
  bool recording_failed_ = false;  // and was told
};

}  // namespace vinv::rig
