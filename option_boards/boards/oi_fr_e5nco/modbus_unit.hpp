// The Modbus side of the OI-FR-E5NCO: requests on its address map become accesses to the inverter's dual-port RAM.
// OI-FR-E5NCO manual, 8.3.4 (immediate answer), 8.5, 8.6, 8.7, 8.8; MODBUS Application Protocol V1.1b3, 6.3 and 6.6.
//
// Order of the checks: function (01), length and quantity (03), addresses (02, or 05 for a write to an address that can
// only be read), range of the map (03), inverter not ready (04), then what the inverter decides.
// Reads are answered at once and need no NET modality. Writes go to the one mailbox of the inverter; while it decides,
// further writes of any Modbus client are refused with 06; a write of CANopen is waited for.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "motor_model/port/drive_port.hpp"
#include "option_boards/boards/oi_fr_e5nco/register_map.hpp"
#include "option_boards/modbus/pdu.hpp"
#include "option_boards/modbus/unit.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/result.hpp"

namespace vinv::boards::oi_fr_e5nco {

class ModbusUnit final : public modbus::Unit {
 public:
  // The drive outlives the unit.
  explicit ModbusUnit(port::DrivePort& drive) : drive_(drive), map_(register_map()) {}

  // Listens under this address from now on; 0: does not listen, and outstanding answers are dropped.
  void set_address(std::uint8_t address);
  // Pr.347 bit 7: a write is acknowledged when it is in the mailbox, and the inverter's refusal is never seen.
  void set_immediate_answer(bool on) { state_.immediate_answer = on; }
  // Collects the inverter's decision on a write.
  void handle_drive_tick() { collect_outcome(); }
  // When the operation mode was asked for that the inverter accepted since the last call.
  std::optional<Instant> take_mode_request() { return std::exchange(state_.mode_asked_at, std::nullopt); }

  std::uint8_t address() const override { return state_.address; }
  void handle_request(Instant now, modbus::ClientId client, modbus::Addressing addressing, ByteView pdu) override;
  std::optional<Bytes> poll_answer(Instant now, modbus::ClientId client) override;
  bool has_request(modbus::ClientId client) const override;
  void forget(modbus::ClientId client) override;

  friend void archive(Archive& a, ModbusUnit& unit) {
    VINV_MEMBERS(unit, drive, map, state);
    a.io(state);
    for (const Answer& answer : state.answers) {
      a.require(!answer.pdu.empty() && answer.pdu.size() <= modbus::kMaxPdu, "a Modbus answer has no possible length");
    }
  }

 private:
  struct Answer {
    modbus::ClientId client = 0;
    Bytes pdu;
    VINV_ARCHIVE(Answer, client, pdu);
  };
  // The write in the mailbox.
  struct PendingWrite {
    modbus::WriteSingleRegister request;
    port::WriteRequest::Kind kind{};
    Instant posted_at{};
    std::optional<modbus::ClientId> client;  // who awaits the answer: nobody after a broadcast or immediate answer
    VINV_ARCHIVE(PendingWrite, request, kind, posted_at, client);
  };
  struct State {
    std::uint8_t address = 0;
    bool immediate_answer = false;
    std::optional<PendingWrite> pending;
    std::vector<Answer> answers;           // at most one per client
    std::optional<Instant> mode_asked_at;  // operation mode written and accepted, not taken yet
    VINV_ARCHIVE(State, address, immediate_answer, pending, answers, mode_asked_at);
  };

  Result<Bytes, modbus::Exception> read(const modbus::ReadHoldingRegisters& request) const;
  Result<std::uint16_t, modbus::Exception> read_item(const RegisterRow& row, std::uint16_t index) const;
  Result<port::WriteRequest, modbus::Exception> translate(const modbus::WriteSingleRegister& request) const;
  void write(Instant now, const modbus::WriteSingleRegister& request, std::optional<modbus::ClientId> client);
  void collect_outcome();
  void answer(modbus::ClientId client, Bytes pdu);

  port::DrivePort& drive_;
  const RegisterMap& map_;
  State state_;
};

}  // namespace vinv::boards::oi_fr_e5nco
