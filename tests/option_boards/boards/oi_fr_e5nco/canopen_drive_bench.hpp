// The board on CANopen in front of a real FR-E500 model with its motor, without any wire. Node 5, ticks of 1 ms.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "motor_model/inverter/inverter.hpp"
#include "option_boards/boards/make_board.hpp"
#include "sim/base/check.hpp"
#include "tests/option_boards/canopen/can_text.hpp"

namespace vinv::test {

using namespace std::chrono_literals;

class CanopenDriveBench : public ::testing::Test {
 protected:
  CanopenDriveBench() {
    inverter::InverterConfig config;
    config.model = "FR-E540-1.5K";
    config.motor = *plant::find_machine("iec4p_1k5kW_400V");
    inverter_ = std::move(inverter::make_inverter("fr-e500", config)).value();
    preset("Pr.7", 1.0);
    preset("Pr.8", 1.0);
    preset("Pr.345", 5);
    preset("Pr.340", 1);
    preset("Pr.180", 3);
    preset("Pr.45", 0.2);
    board_ = std::move(boards::make_board({"oi-fr-e5nco", 5}, inverter_->port())).value();
    inverter_->set_power(true);
    run(1s);
    EXPECT_EQ(taken(), "705#00");
    tell("000#0105");
    run(5ms);
  }
  void preset(const std::string& name, double value) { ASSERT_TRUE(inverter_->preset_parameter(name, value)); }
  boards::CanChannel& bus() {
    boards::CanChannel* channel = board_->can_channel();
    VINV_CHECK(channel != nullptr);
    return *channel;
  }
  void drain() {
    while (const auto frame = bus().poll_transmit(now_)) sent_ += (sent_.empty() ? "" : " ") + text_of(*frame);
  }
  // Ticks of 1 ms; the board's deadlines in between.
  void run(Duration time) {
    const Instant end = now_ + time;
    while (now_ < end) {
      if (const auto at = board_->next_deadline(); at && *at <= now_) {
        board_->handle_timeout(now_);
        drain();
      }
      inverter_->tick(now_);
      if (inverter_->powered() != powered_) {
        powered_ = inverter_->powered();
        board_->handle_power(now_, powered_);
      }
      board_->handle_drive_tick(now_);
      drain();
      now_ += inverter::Inverter::kControlPeriod;
    }
  }
  std::string tell(std::string_view text) {
    bus().handle_frame(now_, can(text));
    drain();
    return taken();
  }
  std::string taken() { return std::exchange(sent_, {}); }
  std::string write(std::string_view request) {
    sent_ = tell(request);
    run(5ms);
    return taken();
  }
  // A write of a whole object, and its acknowledgement.
  void download(unsigned index, unsigned sub, std::uint32_t value, unsigned bytes) {
    char request[32], answer[32];
    std::snprintf(request, sizeof request, "605#%02X%02X%02X%02X%02X%02X%02X%02X", 0x23 | (4 - bytes) << 2,
                  index & 0xff, index >> 8, sub, value & 0xff, value >> 8 & 0xff, value >> 16 & 0xff, value >> 24);
    std::snprintf(answer, sizeof answer, "585#60%02X%02X%02X00000000", index & 0xff, index >> 8, sub);
    EXPECT_EQ(write(request), answer);
  }
  // Velocity mode, as far as operation enabled.
  void enable(std::int16_t rpm) {
    download(0x6042, 0, static_cast<std::uint16_t>(rpm), 2);
    for (const std::uint32_t word : {0x06u, 0x07u, 0x0fu}) download(0x6040, 0, word, 2);
  }
  // Seconds until the output frequency is there.
  double seconds_to(double target_hz, double within_s) {
    const bool up = hz() < target_hz;
    const Instant from = now_;
    while (up ? hz() < target_hz : hz() > target_hz) {
      if (to_seconds(now_ - from) > within_s) {
        ADD_FAILURE() << hz() << " Hz after " << within_s << " s, alarm " << inverter_->alarm_name();
        break;
      }
      run(1ms);
    }
    return to_seconds(now_ - from);
  }
  double shaft_rpm() {
    for (const auto& signal : inverter_->signals()) {
      if (signal.name == "speed") return signal.value;
    }
    return 0;
  }
  port::OperationMode mode() { return inverter_->port().operation_mode(); }
  double hz() { return inverter_->port().read_monitor(1).value_or(std::uint16_t{0}) / 100.0; }
  bool running() { return inverter_->port().status().running; }

  std::unique_ptr<inverter::Inverter> inverter_;
  std::unique_ptr<boards::OptionBoard> board_;
  Instant now_ = instant_from_ns(2'000'000'000);
  bool powered_ = false;
  std::string sent_;
};

}  // namespace vinv::test
