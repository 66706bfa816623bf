// An FR-A7NE over a fake drive, asked with the bytes of explicit messages; time is the test's.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "option_boards/boards/fr_a7ne/cip_unit.hpp"
#include "tests/option_boards/support/fake_drive.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::test {

class UnitBench : public testing::Test {
 protected:
  using Unit = boards::fr_a7ne::CipUnit;
  using Kind = port::WriteRequest::Kind;

  FakeDrive drive;
  boards::fr_a7ne::CipUnitConfig config;
  Unit unit{drive, make_config()};
  Instant now = instant_from_ns(7'000'000'000);

  // The option's parameters, at their defaults.
  UnitBench() {
    for (unsigned number = 434; number <= 445; ++number)
      drive.parameters[static_cast<std::uint16_t>(number)] = {0, 0, 255};
    drive.parameters[346] = {132, 0, 4095};
    drive.parameters[540] = {0, 0, 4095};
    drive.parameters[338] = {0, 0, 1};
    drive.parameters[339] = {0, 0, 2};
    drive.parameters[349] = {0, 0, 1};
    drive.parameters[496] = {0, 0, 4095, false, true};
    drive.parameters[550] = {9999, 0, 9999};
    drive.parameters[37] = {0, 0, 9998};
    drive.parameters[79] = {0, 0, 7};
    drive.monitors = {{1, 0}, {2, 0}, {3, 0}, {14, 0}, {15, 0}};
    drive.mode = port::OperationMode::kNetwork;
  }
  void SetUp() override { power(true); }

  static boards::fr_a7ne::CipUnitConfig make_config() {
    boards::fr_a7ne::CipUnitConfig made;
    made.serial_number = 0x12345678;
    made.ethernet.mac = {0x02, 0, 0, 0, 0, 9};
    made.ethernet.lease.address = 0x7F000002;
    made.ethernet.lease.mask = 0xFF000000;
    return made;
  }
  void power(bool on) {
    unit.handle_power(now, on);
    if (on) tick();
  }
  void tick(unsigned milliseconds = 1) {
    for (unsigned i = 0; i < milliseconds; ++i) {
      now += std::chrono::milliseconds(1);
      drive.tick();
      unit.handle_drive_tick(now);
      if (const auto at = unit.next_deadline(); at && *at <= now) unit.handle_timeout(now);
    }
  }

  // General status and data of the answer as hex; "later" if there is none yet.
  std::string request(const std::string& hex) {
    const Bytes bytes = from_hex(hex);
    const auto parsed = cip::parse_request(bytes);
    EXPECT_TRUE(parsed.request.has_value()) << hex;
    cip::Reply reply;
    if (unit.router().handle(now, *parsed.request, reply)) return "later";
    return text_of(reply);
  }
  std::string poll() {
    const auto deferred = unit.router().poll_reply();
    return deferred ? text_of(deferred->reply) : "";
  }
  // The answer, however many ticks it takes; then the time until the next write is allowed.
  std::string ask(const std::string& hex) {
    std::string answer = request(hex);
    for (unsigned i = 0; answer == "later" && i < 6000; ++i) {
      tick();
      if (const std::string polled = poll(); !polled.empty()) answer = polled;
    }
    tick(100);
    return answer;
  }
  static std::string path(unsigned class_id, unsigned instance, unsigned attribute) {
    Bytes out;
    cip::append_object_path(out,
                            {static_cast<std::uint16_t>(class_id), instance, static_cast<std::uint16_t>(attribute), {}},
                            cip::PathForm::kPadded);
    const auto words = static_cast<std::uint8_t>(out.size() / 2);
    out.insert(out.begin(), words);
    return to_hex(out);
  }
  static std::string get_request(unsigned class_id, unsigned instance, unsigned attribute) {
    return "0E " + path(class_id, instance, attribute);
  }
  static std::string set_request(unsigned class_id, unsigned instance, unsigned attribute, const std::string& data) {
    return "10 " + path(class_id, instance, attribute) + " " + data;
  }
  std::string get(unsigned class_id, unsigned instance, unsigned attribute) {
    return ask(get_request(class_id, instance, attribute));
  }
  std::string set(unsigned class_id, unsigned instance, unsigned attribute, const std::string& data) {
    return ask(set_request(class_id, instance, attribute, data));
  }

  // --- I/O ---
  void open_owner() { unit.on_connection(now, owner(), cip::IoEvent::kOpened); }
  cip::IoConnection owner() const { return {cip::IoRole::kExclusiveOwner, 0, 0}; }
  // Selects assemblies (Pr.346) and restarts.
  void select(std::uint32_t pr346) {
    drive.parameters[346].value = pr346;
    power(false);
    power(true);
    open_owner();
  }
  void output(std::uint32_t instance, const std::string& hex, cip::RunMode mode = cip::RunMode::kRun) {
    unit.consume(now, instance, from_hex(hex), mode);
    tick(5);
  }
  std::string input(std::uint32_t instance) {
    const auto size = unit.produced_size(instance);
    EXPECT_TRUE(size.has_value()) << instance;
    Bytes out(size.value_or(0));
    unit.produce(now, instance, out);
    return to_hex(out);
  }
  port::WriteRequest last(Kind kind) const {
    for (auto it = drive.executed.rbegin(); it != drive.executed.rend(); ++it) {
      if (it->kind == kind) return *it;
    }
    ADD_FAILURE() << "no such write";
    return {};
  }
  std::size_t count(Kind kind) const {
    std::size_t n = 0;
    for (const auto& e : drive.executed) n += e.kind == kind ? 1u : 0u;
    return n;
  }

 private:
  static std::string text_of(const cip::Reply& reply) {
    Bytes out{static_cast<std::uint8_t>(reply.status.general)};
    out.insert(out.end(), reply.data.begin(), reply.data.end());
    return to_hex(out);
  }
};

}  // namespace vinv::test
