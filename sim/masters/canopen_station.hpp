// A CANopen master on a CAN bus, in virtual time.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/masters/canopen_master.hpp"
#include "sim/masters/station.hpp"
#include "sim/transports/can/can_port.hpp"

namespace vinv::masters {

class CanopenStation : public Station, private Access {
 public:
  // The scheduler outlives the station.
  CanopenStation(kernel::Scheduler& scheduler, const CanopenMasterSettings& settings,
                 std::unique_ptr<transports::CanPort> port);
  ~CanopenStation() override;

  bool send_frame(Instant now, ByteView frame) override;

  // The client, for what has no word: guarding, SDOs, PDOs, SYNC. It acts when now's work is done.
  template <class Do>
  auto with_master(Instant now, Do&& action) {
    if constexpr (std::is_void_v<decltype(action(master_))>) {
      action(master_);
      settle(now);
    } else {
      auto result = action(master_);
      settle(now);
      return result;
    }
  }
  // After the bus, which has the port's node.
  void archive(Archive& a) override;
  const CanopenMaster& master() const { return master_; }
  // What happened since the last call, oldest first; at most CanopenMaster::kMaxEvents.
  std::vector<CanopenEvent> take_events();
  transports::CanPort& port() { return *port_; }

 private:
  WordRunner& runner() override { return runner_; }
  std::optional<Instant> work(Instant now) override;

  void begin_write(Instant now, std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) override;
  void begin_read(Instant now, std::uint8_t node, Item item, std::uint8_t size) override;
  std::optional<Result<std::uint32_t, std::string>> poll_access() override;
  void command(Instant now, std::uint8_t node, std::uint32_t command) override;
  void set_output(std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) override;
  void send_output(Instant now, std::uint8_t node, Item item) override;
  std::uint64_t emergencies(std::uint8_t node) const override { return master_.emergencies_of(node); }
  std::optional<std::array<std::uint8_t, 8>> emergency(std::uint8_t node) const override;
  std::string name_of(Item item) const override;
  void ask(const SdoTransfer& transfer);

  CanopenMaster master_;
  std::unique_ptr<transports::CanPort> port_;
  WordRunner runner_;
  struct State {
    std::optional<SdoId> access;  // under way
    std::optional<Result<std::uint32_t, std::string>> access_result;
    std::vector<CanopenEvent> events;
    VINV_ARCHIVE(State, access, access_result, events);
  } state_;
};

// A frame as WireFrame has it, and back; empty if the bytes are no classical CAN frame.
Bytes wire_bytes(const CanFrame& frame);
std::optional<CanFrame> can_frame(ByteView bytes);

}  // namespace vinv::masters
