// A real FR-A700 model with its motor behind the FR-A7NE and its adapter; masters write bytes. Ticks of 1 ms.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "motor_model/inverter/inverter.hpp"
#include "option_boards/boards/fr_a7ne/cip_unit.hpp"
#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::test {

using Settings = std::vector<std::pair<std::string, double>>;

struct A700Holder {
  explicit A700Holder(const Settings& settings) {
    inverter::InverterConfig config;
    config.model = "FR-A740-1.5K";
    config.motor = *plant::find_machine("iec4p_1k5kW_400V");
    inverter = std::move(inverter::make_inverter("fr-a700", config)).value();
    for (const auto& [name, value] : Settings{{"Pr.3", 50}, {"Pr.20", 50}, {"Pr.7", 0.5}, {"Pr.8", 0.5}})
      EXPECT_TRUE(inverter->preset_parameter(name, value));
    for (const auto& [name, value] : settings) EXPECT_TRUE(inverter->preset_parameter(name, value)) << name;
    boards::fr_a7ne::CipUnitConfig board;
    board.ethernet.lease.address = ipv4(127, 0, 0, 5);
    unit = std::make_unique<boards::fr_a7ne::CipUnit>(inverter->port(), board);
  }
  std::unique_ptr<inverter::Inverter> inverter;
  std::unique_ptr<boards::fr_a7ne::CipUnit> unit;
};

class A700OnEthernetIp : public A700Holder, public AdapterRun {
 public:
  // Powered, started and with a session; Pr.340 = 10 unless the settings say otherwise.
  explicit A700OnEthernetIp(Settings settings = {}) : A700Holder(with_net(std::move(settings))), AdapterRun(*unit) {
    now = instant_from_ns(0);
    adapter.stop();
    inverter->set_power(true);
    run(1500ms);
    scanner.connect();
    scanner.register_session();
    EXPECT_NE(scanner.session, 0u);
  }

  void run(Duration time) {
    for (const Instant end = now + time; now < end; now += 1ms) {
      inverter->tick(now);
      if (inverter->powered() != std::exchange(powered_, inverter->powered())) unit->handle_power(now, powered_);
      unit->handle_drive_tick(now);
      if (const auto at = unit->next_deadline(); at && *at <= now) unit->handle_timeout(now);
      if (unit->take_restart()) adapter.stop();
      if (unit->on_network() && !adapter.is_started()) adapter.start(kAddress);
      if (feeding && now >= next_feed_) feed();
      adapter.handle_timeout(now);
      poll();
    }
  }
  // Of another pair of six bytes each: 126/176 or 129/179.
  void choose_long_pair(std::string_view path) {
    wish.path = path;
    wish.o2t = 0x4800 | 12;
    wish.t2o = 0x4800 | 8;
    data.assign(6, 0);
  }
  // The owner of 21/71, or of what was chosen, at 10 ms, time-out after 40 ms; what it says until told otherwise.
  std::string own() {
    const std::string status = scanner.open_status(wish);
    if (status == "00") {
      const ByteView reply = ByteView(scanner.last).subspan(40);
      id = read_le32(reply, 4);
      sequence_ = 0;
      feeding = true;
    }
    return status;
  }
  void say(std::string_view hex) {
    data = from_hex(hex);
    run(20ms);
  }
  // The newest input data.
  std::string input() {
    run(20ms);
    const auto packets = take(ethernet_ip::Channel::kIo);
    return packets.empty() ? "" : to_hex(ByteView(packets.back().bytes).last(data.size()));
  }
  // Status and data of an unconnected request's answer, however late.
  std::string ask(std::string_view hex) {
    Bytes reply = scanner.request(from_hex(hex));
    for (int i = 0; reply.empty() && i < 7000; ++i) {
      run(1ms);
      for (const SentPacket& p : take(ethernet_ip::Channel::kTcp))
        if (p.connection == scanner.tcp && p.bytes.size() > 40) reply.assign(p.bytes.begin() + 40, p.bytes.end());
    }
    return reply.size() < 4 ? ""
                            : to_hex(ByteView(reply).subspan(2, 1)) + (reply.size() > 4 ? " " : "") +
                                  to_hex(ByteView(reply).subspan(4));
  }
  std::string mode(std::string_view value) { return ask("10 03 20 2A 24 01 30 78 " + std::string(value) + " 00"); }
  double hz() const { return signal("output_frequency"); }
  double signal(std::string_view name) const {
    for (const auto& s : inverter->signals())
      if (s.name == name) return s.value;
    ADD_FAILURE() << name;
    return 0;
  }
  bool running() { return inverter->port().status().running; }
  std::string alarm() const { return inverter->alarm_name(); }
  unsigned history(std::size_t i) { return inverter->port().alarm_history()[i]; }

  Master scanner{*this};
  OpenWish wish;
  std::uint32_t id = 0;
  bool feeding = false;
  Bytes data{0, 0, 0, 0};
  bool run_bit = true;

 private:
  static Settings with_net(Settings settings) {
    for (const auto& s : settings)
      if (s.first == "Pr.340") return settings;
    settings.emplace_back("Pr.340", 10);
    return settings;
  }
  void feed() {
    next_feed_ = now + 10ms;
    ++sequence_;
    scanner.send_io(id, sequence_, sequence_, to_hex(data), run_bit);
  }
  bool powered_ = false;
  Instant next_feed_{};
  std::uint32_t sequence_ = 0;
};

}  // namespace vinv::test
