// One drive of a plant: inverter, option board and the surroundings that people set.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "motor_model/inverter/inverter.hpp"
#include "option_boards/boards/option_board.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/rig/ethernet_ip_port.hpp"
#include "sim/rig/plant_file.hpp"

namespace vinv::rig {

// Where a foreign client finds the drive, as the transports opened it.
struct TcpEndpoint {
  std::string host;
  std::uint16_t port = 0;
};
struct SerialEndpoint {
  std::string path;
};

// A bus of ours has the ways that its network opened; any other one is reached where it is.
struct CanEndpoint {
  std::uint32_t bitrate = 0;
  std::string socketcan;      // interface
  std::string socketcand;     // address:port
  std::string slcan;          // address:port, or the path of a pseudo-terminal or tty
  std::string udp_multicast;  // group
  std::string channel;        // for socketcand
};

// Of an adapter, with the standard's ports.
struct EthernetIpEndpoint {
  std::string host;
  std::uint16_t tcp = ethernet_ip::kEncapsulationPort;
  std::uint16_t udp_io = ethernet_ip::kIoPort;
};

struct DriveUnit {
  DriveSpec spec;
  std::optional<TcpEndpoint> tcp;
  std::optional<SerialEndpoint> serial;
  std::optional<CanEndpoint> can;
  std::optional<EthernetIpEndpoint> ethernet_ip;
  std::unique_ptr<inverter::Inverter> inverter;
  std::unique_ptr<boards::OptionBoard> board;  // nullptr: none fitted
  std::optional<std::size_t> controller;       // of the board on its CAN bus
  // Of a board on Ethernet; all or none.
  boards::EthernetChannel* station = nullptr;
  std::unique_ptr<ethernet_ip::Adapter> adapter;
  std::unique_ptr<EthernetIpPort> ethernet;
  std::uint32_t claimed_address = 0;  // the board's own as the network knows it
  bool has_double = false;            // a device that is not of the plant has its address too

  // The mains are what the plant file or `mains: {voltage}` says, less a dip and lost phases.
  plant::MainsState mains;
  double dip_fraction = 0;
  double load_ramp_nm = 0;       // constant torque at the end of a load's ramp
  kernel::EventId dip_ends = 0;  // pending events of commands that take time; 0: none
  kernel::EventId power_returns = 0;
  kernel::EventId reset_released = 0;
  kernel::EventId load_ramp_ends = 0;

  bool board_powered = false;
  std::optional<Instant> board_deadline;
  kernel::EventId board_event = 0;

  // The unit identifier that masters use; what the switches say while the board is without power.
  unsigned unit() const {
    const modbus::Unit* modbus_unit = board ? board->modbus_unit() : nullptr;
    const unsigned address = modbus_unit != nullptr ? modbus_unit->address() : 0;
    return address != 0 ? address : spec.board ? spec.board->node.value : 0;
  }
  // On its CAN bus; what the switches say while the board is without power.
  unsigned can_node() const {
    const boards::CanChannel* channel = board ? board->can_channel() : nullptr;
    const unsigned node = channel != nullptr ? channel->node() : 0;
    return node != 0 ? node : spec.board ? spec.board->node.value : 0;
  }
  void apply_mains() {
    plant::MainsState now = mains;
    now.voltage_v_rms *= 1 - dip_fraction;
    inverter->set_mains(now);
  }
  // What these events do.
  void end_dip() {
    dip_ends = 0;
    dip_fraction = 0;
    apply_mains();
  }
  void release_reset() {
    reset_released = 0;
    // Its owner found the terminal when it was switched on.
    static_cast<void>(inverter->set_terminal("RES", false));
  }
  void end_load_ramp() {
    load_ramp_ends = 0;
    plant::LoadSettings settled = inverter->plant().load();
    settled.constant_nm = load_ramp_nm;
    settled.table.clear();
    inverter->set_load(settled);
  }
};

}  // namespace vinv::rig
