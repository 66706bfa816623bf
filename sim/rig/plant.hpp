// A plant of drives: inverters, boards and wires on one scheduler. It runs the same in virtual time (tests, scenarios)
// and on an event loop: who owns the scheduler makes the time pass.
//
// At each control period all drives tick in the order of the plant file; after each tick its board sees the drive, then
// channels are drained and deadlines read. Bytes that arrive go to the board at once.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/rig/board_line.hpp"
#include "sim/rig/can_line.hpp"
#include "sim/rig/catalogue.hpp"
#include "sim/rig/drive_unit.hpp"
#include "sim/rig/plant_file.hpp"
#include "sim/rig/tcp_port.hpp"
#include "sim/rig/wire_tap.hpp"
#include "sim/transports/memory_datagrams.hpp"
#include "sim/transports/memory_streams.hpp"

namespace vinv::rig {

struct PlantOptions {
  Catalogue catalogue;
  // The stored EEPROM of a drive; empty if there is none. Not set: nothing is stored.
  std::function<std::optional<std::string>(const std::string& drive)> stored_eeprom;
  // A stored EEPROM was refused, for this reason.
  std::function<void(const std::string& drive, const std::string& reason)> damaged_eeprom;
  // The same for the memory of its option board.
  std::function<std::optional<std::string>(const std::string& drive)> stored_flash;
  std::function<void(const std::string& drive, const std::string& reason)> damaged_flash;
  // Time now. Default: the scheduler's; an event loop knows it better between two events.
  std::function<Instant()> clock;
  // Of everything random: faults on wires.
  std::uint64_t seed = 1;
};

class Plant {
 public:
  // Builds everything, without power. What a drive or board refuses of the file is a PlantFileError with its place.
  // The scheduler outlives the plant and is not run after the plant is gone.
  Plant(PlantFile file, kernel::Scheduler& scheduler, PlantOptions options);
  ~Plant();
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  // Powers the drives that the file has powered, now, and ticks from then on.
  void start();

  const PlantFile& file() const { return file_; }
  kernel::Scheduler& scheduler() { return scheduler_; }
  Instant now() const { return clock_ ? clock_() : scheduler_.now(); }
  std::vector<std::unique_ptr<DriveUnit>>& drives() { return drives_; }
  const std::vector<std::unique_ptr<DriveUnit>>& drives() const { return drives_; }
  DriveUnit* find(std::string_view name);

  // Wires, by their index in the plant file.
  // Somebody outside the plant has the line's other end: a pseudo-terminal, a serial adapter.
  bool serial_is_outside(std::size_t line) const { return lines_[line].is_outside(); }
  void connect_serial(std::size_t line, std::unique_ptr<transports::ByteStream> stream, LineOptions options = {});
  void accept_tcp(std::size_t port, Instant now, std::unique_ptr<transports::ByteStream> stream);
  // Lines in memory that snapshots hold, for masters in virtual time.
  transports::MemoryStreams& streams() { return streams_; }
  // The Ethernet in virtual time: adapters at the addresses of the plant file, masters at any other one. UDP ports of
  // masters are opened here; faults and cables are those of the drive's EthernetIpPort.
  transports::MemoryDatagrams& datagrams() { return datagrams_; }
  // A line in memory to the TCP port of the adapter at this address; nullptr if there is none.
  std::unique_ptr<transports::ByteStream> connect_tcp(Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to,
                                                      const transports::MemoryLinkOptions& options = {});
  // The drive whose adapter is reached at this address; nullptr if there is none.
  DriveUnit* find_address(std::uint32_t address);
  CanLine& can_line(std::size_t bus) { return *buses_[bus]; }
  // The bus that the drive's board hangs on; nullptr if none.
  CanLine* can_line_of(const DriveUnit& drive);
  // The cable of the drive's board on Ethernet. False: it has none.
  bool plug_ethernet(DriveUnit& drive, bool plugged);
  // A device outside the plant that has, and keeps, the address of the drive's board on Ethernet.
  void set_double(DriveUnit& drive, bool there);
  // Where faults go on the serial line, the TCP port and the UDP ports of the drive; nullptr if it has none.
  WireTap* serial_tap_of(const DriveUnit& drive);
  WireTap* tcp_tap_of(const DriveUnit& drive);
  WireTap* udp_tap_of(const DriveUnit& drive);

  // The drive's own breaker; its board follows.
  void set_power(DriveUnit& drive, bool on);
  // The end of a power cycle.
  void return_power(DriveUnit& drive);
  // Hands out the EEPROM of each drive that has changed since the last call.
  using Store = std::function<void(const std::string& drive, std::string text)>;
  void collect_eeproms(const Store& store);
  // The same for the memories of option boards.
  void collect_flashes(const Store& store);
  // Drives and their boards are up: nobody is in start-up. Drives without power count as up.
  bool settled() const;
  std::uint64_t ticks() const { return ticks_; }

  // --- snapshots of a plant in virtual time (docs/decisions/0005-snapshots.md) ---

  // Why none can be taken now, a sentence; empty if one can: before the first tick, and right after each tick on the
  // inverters' grid, as long as nobody outside the plant is connected to it. Lines in memory of streams() are inside.
  std::string snapshot_objection() const;
  // All of it, fault plans and random numbers included. Refused with snapshot_objection().
  Result<void, std::string> save(Bytes& out);
  // Into a plant of the same file that has the same nodes on its CAN buses, started or not; it goes on byte for byte as
  // the one that was saved. A refused load leaves the plant as it was. Observers' events on the scheduler are dropped.
  Result<void, std::string> load(ByteView snapshot);
  // Another PlantOptions::seed from here on: a continuation with other luck.
  void reseed(std::uint64_t seed);
  // As a part of a larger snapshot, with scheduler and net: the owner asks snapshot_objection() before it saves or
  // loads, archives its own ends of lines and its events after the plant, and then calls
  // MemoryStreams::archive_owners() and Scheduler::archive_waiting().
  friend void archive(Archive& a, Plant& plant) { plant.archive_state(a); }

 private:
  // problems: what the drive refuses of the file, though it can be built.
  std::unique_ptr<DriveUnit> build(const DriveSpec& spec, const PlantOptions& options, std::vector<Problem>& problems);
  [[noreturn]] void refuse(Position at, const std::string& drive, const std::string& message) const;
  void first_parameters(DriveUnit& drive, std::vector<Problem>& problems);
  void inputs(DriveUnit& drive, std::vector<Problem>& problems);
  void wire(DriveUnit& drive, std::uint64_t seed);
  void tick(Instant now);
  void settle(Instant now, DriveUnit& drive);
  void follow_power(Instant now, DriveUnit& drive);
  void board_timeout(Instant now, DriveUnit& drive);
  void follow_ethernet(Instant now, DriveUnit& drive);
  bool is_taken(const DriveUnit& drive, std::uint32_t address) const;
  void claim_address(Instant now, DriveUnit& drive, std::uint32_t address);
  BoardLine::OnTraffic traffic_of(std::size_t line);
  void archive_state(Archive& a);
  void archive_drive(Archive& a, DriveUnit& drive);
  std::string signature() const;

  PlantFile file_;
  kernel::Scheduler& scheduler_;
  std::function<Instant()> clock_;
  transports::MemoryDatagrams datagrams_;
  std::vector<std::unique_ptr<DriveUnit>> drives_;
  transports::MemoryStreams streams_;
  std::vector<BoardLine> lines_;
  std::vector<std::vector<DriveUnit*>> drives_on_line_;
  std::vector<std::unique_ptr<TcpPort>> ports_;
  std::vector<std::unique_ptr<CanLine>> buses_;
  std::vector<WireTap> serial_taps_;
  std::vector<WireTap> tcp_taps_;
  kernel::EventId tick_event_ = 0;
  std::uint64_t ticks_ = 0;
};

}  // namespace vinv::rig
