// A unit that answers when the test says so, and remembers what it was asked.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "option_boards/modbus/unit.hpp"

namespace vinv::test {

class ScriptedUnit final : public modbus::Unit {
 public:
  struct Asked {
    modbus::ClientId client;
    modbus::Addressing addressing;
    Bytes pdu;
  };

  explicit ScriptedUnit(std::uint8_t address) : address_(address) {}

  bool answer_at_once = true;  // with an echo
  std::uint8_t address_;
  std::vector<Asked> asked;
  std::map<modbus::ClientId, Bytes> outstanding;
  std::vector<modbus::ClientId> forgotten;

  // Decides what is outstanding: each client gets its own PDU back.
  void decide() { decided_ = std::exchange(outstanding, {}); }

  std::uint8_t address() const override { return address_; }
  void handle_request(Instant, modbus::ClientId client, modbus::Addressing addressing, ByteView pdu) override {
    asked.push_back({client, addressing, Bytes(pdu.begin(), pdu.end())});
    if (addressing == modbus::Addressing::kBroadcast) return;
    outstanding[client] = Bytes(pdu.begin(), pdu.end());
    if (answer_at_once) decide();
  }
  std::optional<Bytes> poll_answer(Instant, modbus::ClientId client) override {
    const auto found = decided_.find(client);
    if (found == decided_.end()) return std::nullopt;
    Bytes pdu = std::move(found->second);
    decided_.erase(found);
    return pdu;
  }
  bool has_request(modbus::ClientId client) const override {
    return outstanding.count(client) != 0 || decided_.count(client) != 0;
  }
  void forget(modbus::ClientId client) override {
    forgotten.push_back(client);
    outstanding.erase(client);
    decided_.erase(client);
  }

 private:
  std::map<modbus::ClientId, Bytes> decided_;
};

}  // namespace vinv::test
