// A CIP device for tests: a drive's kind of points, and an object whose answers can be delayed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "option_boards/cip/device.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::test {

// Class 0x70: service 0x0E answers with data, 0x10 takes its time until finish().
class FakeObject : public cip::Object {
 public:
  cip::Handled handle(Instant, const cip::Request& request, cip::Reply& reply) override {
    ++requests;
    if (request.is(cip::Service::kGetAttributeSingle)) {
      reply.data = data;
      return cip::Handled::kAnswered;
    }
    if (request.is(cip::Service::kSetAttributeSingle)) {
      last_write.assign(request.data.begin(), request.data.end());
      tickets.push_back(request.ticket);
      return cip::Handled::kLater;
    }
    reply.refuse(cip::GeneralStatus::kServiceNotSupported);
    return cip::Handled::kAnswered;
  }
  Bytes data = {0x34, 0x12};
  Bytes last_write;
  std::vector<cip::Ticket> tickets;
  int requests = 0;
};

// Consumed points 20 and 21 (4 bytes), 30 (none: heartbeat of input only), 31 (heartbeat of listen only); produced
// points 70 and 71 (4 bytes) and 80 (none); configuration point 100 (4 bytes) and 101 (none). 20 goes with 70, 21 with
// 71 and 80; heartbeats with any.
class FakeDevice : public cip::Device, public cip::IoPoints {
 public:
  FakeDevice() { router_.add(0x70, object); }

  cip::MessageRouter& router() override { return router_; }
  cip::IoPoints& io() override { return *this; }
  const cip::Identity& identity() const override { return id; }
  std::uint16_t identity_status() const override { return 0x0030; }
  cip::IdentityState identity_state() const override { return cip::IdentityState::kOperational; }

  std::optional<std::size_t> consumed_size(std::uint32_t point) const override {
    if (point == 30 || point == 31) return 0;
    if (point == 20 || point == 21) return 4;
    return std::nullopt;
  }
  std::optional<std::size_t> produced_size(std::uint32_t point) const override {
    if (point == 80) return 0;
    if (point == 70 || point == 71) return 4;
    return std::nullopt;
  }
  std::optional<std::size_t> configuration_size(std::uint32_t point) const override {
    if (point == 100) return 4;
    if (point == 101) return 0;
    return std::nullopt;
  }
  bool is_heartbeat(std::uint32_t point, cip::IoRole role) const override {
    return (point == 30 && role == cip::IoRole::kInputOnly) || (point == 31 && role == cip::IoRole::kListenOnly);
  }
  bool goes_with(std::uint32_t consumed, std::uint32_t produced) const override {
    return consumed >= 30 || produced == consumed + 50 || produced == 80;
  }
  cip::Status configure(Instant, std::uint32_t, ByteView data) override {
    if (data[0] == 0xff) return cip::GeneralStatus::kInvalidAttributeValue;
    configuration.assign(data.begin(), data.end());
    return {};
  }
  void consume(Instant, std::uint32_t point, ByteView data, cip::RunMode mode) override {
    log.push_back((mode == cip::RunMode::kRun ? "run " : "idle ") + std::to_string(point) + ": " + to_hex(data));
  }
  void produce(Instant, std::uint32_t, std::span<std::uint8_t> out) override {
    std::copy_n(input.begin(), out.size(), out.begin());
  }
  std::uint32_t produced_version(std::uint32_t) const override { return version; }
  void on_connection(Instant, const cip::IoConnection& c, cip::IoEvent event) override {
    constexpr const char* kRoles[] = {"owner ", "input only ", "listen only "};
    constexpr const char* kEvents[] = {" opened", " closed", " timed out"};
    log.push_back(kRoles[static_cast<int>(c.role)] + std::to_string(c.consumed_point) + "/" +
                  std::to_string(c.produced_point) + kEvents[static_cast<int>(event)]);
  }
  void on_explicit_connection(Instant, cip::IoEvent event) override {
    constexpr const char* kEvents[] = {"explicit opened", "explicit closed", "explicit timed out"};
    log.push_back(kEvents[static_cast<int>(event)]);
  }
  void set_input(std::string_view hex) {
    input = from_hex(hex);
    ++version;
  }

  FakeObject object;
  cip::Identity id{161, 2, 56, 1, 10, 0x00c0ffee, "A700"};
  Bytes input = {1, 2, 3, 4};
  std::uint32_t version = 1;
  Bytes configuration;
  std::vector<std::string> log;

 private:
  cip::MessageRouter router_;
};

}  // namespace vinv::test
