// A plant of one drive with our masters on its wires, in virtual time.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/masters/canopen_station.hpp"
#include "sim/masters/modbus_station.hpp"
#include "sim/rig/plant.hpp"

namespace vinv::test {

using std::chrono::milliseconds;

// Node 5 on each wire. A flywheel that a stop in 0.3 s makes a generator of.
inline constexpr std::string_view kFlywheelPlant = R"(
networks:
  bus: { can: virtual, bitrate: 125k }
drives:
  - name: mill
    inverter: { family: fr-e500, model: FR-E540-1.5K }
    load: { inertia_kg_m2: 0.08, torque: { constant_Nm: 2 } }
    board: { type: oi-fr-e5nco, node: 5, network: bus }
    parameters: { Pr.8: 0.3 }
)";

struct PlantBench {
  explicit PlantBench(std::string_view text = kFlywheelPlant)
      : plant(rig::parse_plant_file(text, "bench.yaml", rig::shipped_catalogue()), scheduler, options()) {
    plant.start();
    run(milliseconds(2000));
    EXPECT_TRUE(plant.settled());
  }
  static rig::PlantOptions options() {
    rig::PlantOptions o;
    o.catalogue = rig::shipped_catalogue();
    return o;
  }

  Instant now() const { return scheduler.now(); }
  void run(Duration d) { scheduler.run_until(scheduler.now() + d); }
  // Steps of 1 ms.
  bool wait(const std::function<bool()>& condition, Duration at_most) {
    const Instant end = now() + at_most;
    for (;;) {
      if (condition()) return true;
      if (now() >= end) return false;
      run(milliseconds(1));
    }
  }
  rig::DriveUnit& mill() { return *plant.drives().front(); }
  double signal(std::string_view name) {
    for (const auto& s : mill().inverter->signals())
      if (s.name == name) return s.value;
    ADD_FAILURE() << "no signal " << name;
    return 0;
  }

  std::unique_ptr<masters::ModbusStation> serial_master(masters::ModbusMasterSettings settings = {}) {
    settings.framing = masters::ModbusFraming::kRtu;
    return std::make_unique<masters::ModbusStation>(
        scheduler, settings,
        [this, settings](Instant) {
          auto [board, master] =
              plant.streams().connect({.character = std::chrono::nanoseconds(
                                           std::int64_t{1'000'000'000} * settings.bits_per_character / settings.baud)});
          plant.connect_serial(*mill().spec.board->serial, std::move(board));
          return std::move(master);
        },
        &plant.streams());
  }
  std::unique_ptr<masters::ModbusStation> tcp_master(masters::ModbusMasterSettings settings = {}) {
    settings.framing = masters::ModbusFraming::kTcp;
    return std::make_unique<masters::ModbusStation>(
        scheduler, settings,
        [this](Instant at) {
          auto [board, master] = plant.streams().connect({.delay = std::chrono::microseconds(100)});
          plant.accept_tcp(*mill().spec.board->tcp, at, std::move(board));
          return std::move(master);
        },
        &plant.streams());
  }
  transports::CanBus& bus() { return plant.can_line_of(mill())->bus(); }
  std::unique_ptr<masters::CanopenStation> canopen_master(const masters::CanopenMasterSettings& settings = {}) {
    transports::CanNodeOptions node;
    node.name = "master";
    return std::make_unique<masters::CanopenStation>(scheduler, settings, bus().attach(now(), std::move(node)));
  }

  masters::Outcome tell(masters::Station& master, std::string_view protocol, masters::Order order,
                        Duration at_most = std::chrono::seconds(8)) {
    const masters::BoardProfile* profile = masters::find_profile("oi-fr-e5nco", protocol);
    VINV_CHECK(profile != nullptr);
    order.node = 5;
    master.begin(now(), *profile, order);
    std::optional<masters::Outcome> outcome;
    if (!wait([&] { return (outcome = master.poll()).has_value(); }, at_most))
      return Unexpected(std::string("no outcome"));
    return *std::move(outcome);
  }

  kernel::Scheduler scheduler;
  rig::Plant plant;
};

inline masters::Order order(masters::Word word, double value = 0) {
  masters::Order o;
  o.word = word;
  o.value = value;
  return o;
}
inline masters::Order parameter(std::uint16_t number, double increment) {
  masters::Order o;
  o.word = masters::Word::kReadParameter;
  o.parameter = number;
  o.increment = increment;
  return o;
}
inline masters::Order parameter(std::uint16_t number, double increment, double value) {
  masters::Order o = parameter(number, increment);
  o.word = masters::Word::kWriteParameter;
  o.value = value;
  return o;
}
inline masters::Order monitor(std::string name) {
  masters::Order o;
  o.word = masters::Word::kMonitor;
  o.monitor = std::move(name);
  return o;
}

}  // namespace vinv::test
