// Carries out the words of a profile over a protocol, one order at a time: writes, waits, reads back.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"
#include "sim/masters/profile.hpp"

namespace vinv::masters {

// What a protocol's client does for the runner. One read or write is under way at a time.
class Access {
 public:
  virtual ~Access() = default;
  virtual void begin_write(Instant now, std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) = 0;
  virtual void begin_read(Instant now, std::uint8_t node, Item item, std::uint8_t size) = 0;
  // The value read (0 of a write), once; the error is "exception 05", "SDO abort 06020000 (...)".
  virtual std::optional<Result<std::uint32_t, std::string>> poll_access() = 0;
  // Without answer.
  virtual void command(Instant now, std::uint8_t node, std::uint32_t command) = 0;
  virtual void set_output(std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) = 0;
  virtual void send_output(Instant now, std::uint8_t node, Item item) = 0;
  // Emergencies of the node so far, and the newest; of protocols that have them.
  virtual std::uint64_t emergencies(std::uint8_t /*node*/) const { return 0; }
  virtual std::optional<std::array<std::uint8_t, 8>> emergency(std::uint8_t /*node*/) const { return std::nullopt; }
  // "register 24000", "object 6040H".
  virtual std::string name_of(Item item) const = 0;
};

class WordRunner {
 public:
  // Between two reads of Act::kAwait.
  static constexpr Duration kAwaitInterval = std::chrono::milliseconds(20);

  // The access outlives the runner.
  explicit WordRunner(Access& access) : access_(access) {}

  // Ends an order that is under way without an outcome. The profile outlives the order.
  void begin(Instant now, const BoardProfile& profile, const Order& order);
  // After anything that the client received, and at next_deadline().
  void advance(Instant now);
  std::optional<Instant> next_deadline() const { return state_.wake_at; }
  std::optional<Outcome> poll();
  bool busy() const { return state_.order.has_value(); }

  // The row that the order under way has come to; 0 of one that reads or writes a single value.
  std::size_t step() const { return state_.step; }
  // The client has been asked and its answer not taken yet.
  bool in_access() const { return state_.in_access || state_.stale; }

  // Snapshots: the profile by board and protocol; a load is refused if it is not one of profiles().
  friend void archive(Archive& a, WordRunner& runner) { runner.archive_state(a); }
  // While loading: the order under way is for a node and of acts that the client has.
  void require_client(Archive& a, unsigned last_node, bool has_images) const;

 private:
  struct Memory {
    bool reverse = false;
    double rpm = 0;
    VINV_ARCHIVE(Memory, reverse, rpm);
  };
  struct State {
    const BoardProfile* profile = nullptr;  // of the order; one of profiles(), or a test's
    std::optional<Order> order;             // under way
    std::size_t step = 0;                   // of the profile's rows
    bool begun = false;                     // the step
    bool in_access = false;                 // a read or write of the step is under way
    bool stale = false;                     // that access belongs to an order that was replaced
    std::optional<Instant> wake_at;
    Instant give_up_at{};
    std::uint64_t emergencies_before = 0;
    std::string last_seen;  // kAwait: what the last read gave
    std::map<std::uint8_t, Memory> memory;
    std::optional<Outcome> outcome;
  };

  void archive_state(Archive& a);
  void finish(Outcome outcome);
  void fail(const std::string& what);
  void next_step(std::size_t skip = 0);
  void find_step();
  void begin_step(Instant now, const ProfileStep& step);
  void on_answer(Instant now, const ProfileStep& step, const Result<std::uint32_t, std::string>& answer);
  void begin_parameter(Instant now);
  void begin_monitor(Instant now);
  void on_value(const Result<std::uint32_t, std::string>& answer);
  void remember(const Order& order);
  Result<std::uint32_t, std::string> raw_of(const ProfileStep& step) const;
  std::string with_meaning(const std::string& error) const;

  Access& access_;
  State state_;
};

}  // namespace vinv::masters
