// The pure pieces of the FR-E500 personality: operation modes (OI-FR-E5NCO manual 4.2), start signals, 15 speeds, and
// which parameter reaches which setting of the control core.
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/e500/settings.hpp"
#include "motor_model/inverter/mitsubishi/multi_speed.hpp"
#include "motor_model/inverter/mitsubishi/run_command.hpp"

namespace vinv::inverter::e500 {
using namespace mitsubishi;

namespace {

using drive::RunDirection;
using port::OperationMode;
using port::Refusal;

// --- operation modes ---

TEST(OperationMode, AtPowerOnFollowsPr79AndPr340) {
  const auto start = [](int pr79, int pr340, bool mrs = false, bool x16 = false) {
    return start_mode({.raw_pr79 = pr79, .raw_pr340 = pr340, .interlock_off = mrs, .x16 = x16});
  };
  for (int pr340 : {0, 1, 2}) {
    const auto net_or_ext = pr340 == 0 ? OperationMode::kExternal : OperationMode::kNetwork;
    EXPECT_EQ(start(0, pr340), net_or_ext);
    EXPECT_EQ(start(1, pr340), OperationMode::kPu);
    EXPECT_EQ(start(2, pr340), net_or_ext);
    EXPECT_EQ(start(3, pr340), OperationMode::kCombined1);
    EXPECT_EQ(start(4, pr340), OperationMode::kCombined2);
    EXPECT_EQ(start(6, pr340), net_or_ext);
    EXPECT_EQ(start(7, pr340, true), net_or_ext);
    EXPECT_EQ(start(7, pr340, false), OperationMode::kExternal);
    EXPECT_EQ(start(8, pr340, false, true), OperationMode::kExternal);
    EXPECT_EQ(start(8, pr340, false, false), OperationMode::kPu);
  }
  EXPECT_EQ(start_mode({.raw_pr79 = 0, .raw_pr340 = 1, .option_fitted = false}), OperationMode::kExternal);
}

TEST(OperationMode, EachRequestFromEachModeAtStandstill) {
  struct Case {
    OperationMode from;
    ModeRequest request;
    std::optional<OperationMode> to;  // empty: refused
  };
  const auto E = OperationMode::kExternal;
  const auto P = OperationMode::kPu;
  const auto N = OperationMode::kNetwork;
  const Case cases[] = {
      {E, ModeRequest::kNetworkOn, N},
      {E, ModeRequest::kNetworkOff, E},
      {E, ModeRequest::kPanelKey, P},
      {P, ModeRequest::kNetworkOn, std::nullopt},
      {P, ModeRequest::kNetworkOff, P},
      {P, ModeRequest::kPanelKey, E},
      {N, ModeRequest::kNetworkOn, N},
      {N, ModeRequest::kNetworkOff, E},
      {N, ModeRequest::kPanelKey, std::nullopt},
      {OperationMode::kCombined1, ModeRequest::kNetworkOn, std::nullopt},
      {OperationMode::kCombined2, ModeRequest::kPanelKey, std::nullopt},
  };
  for (const Case& c : cases) {
    const auto result = request_mode(c.from, c.request, {});
    SCOPED_TRACE(static_cast<int>(c.from) * 10 + static_cast<int>(c.request));
    if (c.to) {
      ASSERT_TRUE(result.has_value());
      EXPECT_EQ(*result, *c.to);
    } else {
      ASSERT_FALSE(result.has_value());
      EXPECT_EQ(result.error(), Refusal::kModeChangeRefused);
    }
  }
}

TEST(OperationMode, WhatPr79LeavesOpen) {
  const auto reach = [](int pr79, ModeRequest request, bool mrs = false) {
    return request_mode(OperationMode::kExternal, request, {.raw_pr79 = pr79, .interlock_off = mrs}).has_value();
  };
  for (int pr79 : {0, 2, 6}) EXPECT_TRUE(reach(pr79, ModeRequest::kNetworkOn)) << pr79;
  for (int pr79 : {1, 3, 4, 8}) EXPECT_FALSE(reach(pr79, ModeRequest::kNetworkOn)) << pr79;
  for (int pr79 : {0, 6}) EXPECT_TRUE(reach(pr79, ModeRequest::kPanelKey)) << pr79;
  for (int pr79 : {1, 2, 3, 4, 8}) EXPECT_FALSE(reach(pr79, ModeRequest::kPanelKey)) << pr79;
  for (auto request : {ModeRequest::kNetworkOn, ModeRequest::kPanelKey}) {
    EXPECT_TRUE(reach(7, request, true));
    EXPECT_FALSE(reach(7, request, false));
  }
}

TEST(OperationMode, RunningOrAStartSignalRefusesEveryChangeButWithPr79Is6) {
  for (int pr79 : {0, 2, 6}) {
    const bool free = pr79 == 6;
    ModeSituation s{.raw_pr79 = pr79};
    s.stopped = false;
    EXPECT_EQ(request_mode(OperationMode::kExternal, ModeRequest::kNetworkOn, s).has_value(), free);
    EXPECT_EQ(request_mode(OperationMode::kNetwork, ModeRequest::kNetworkOff, s).has_value(), free);
    s.stopped = true;
    s.start_signal = true;
    EXPECT_EQ(request_mode(OperationMode::kExternal, ModeRequest::kNetworkOn, s).has_value(), free);
    EXPECT_EQ(request_mode(OperationMode::kNetwork, ModeRequest::kNetworkOff, s).has_value(), free);
  }
}

TEST(OperationMode, ANewPr79TakesHoldAtStandstill) {
  const auto follow = [](OperationMode now, int pr79, bool stopped, bool mrs = false, bool x16 = false) {
    return follow_settings(now, {.raw_pr79 = pr79, .interlock_off = mrs, .x16 = x16, .stopped = stopped});
  };
  EXPECT_EQ(follow(OperationMode::kExternal, 1, false), OperationMode::kExternal);
  EXPECT_EQ(follow(OperationMode::kExternal, 1, true), OperationMode::kPu);
  EXPECT_EQ(follow(OperationMode::kPu, 2, true), OperationMode::kExternal);
  EXPECT_EQ(follow(OperationMode::kNetwork, 2, true), OperationMode::kNetwork);
  EXPECT_EQ(follow(OperationMode::kNetwork, 3, true), OperationMode::kCombined1);
  EXPECT_EQ(follow(OperationMode::kExternal, 4, true), OperationMode::kCombined2);
  EXPECT_EQ(follow(OperationMode::kCombined1, 0, true), OperationMode::kExternal);
  EXPECT_EQ(follow(OperationMode::kPu, 0, true), OperationMode::kPu);
  EXPECT_EQ(follow(OperationMode::kExternal, 8, true, false, false), OperationMode::kPu);
  EXPECT_EQ(follow(OperationMode::kPu, 8, true, false, true), OperationMode::kExternal);
  // The interlock ends PU operation at once.
  EXPECT_EQ(follow(OperationMode::kPu, 7, false, false), OperationMode::kExternal);
  EXPECT_EQ(follow(OperationMode::kPu, 7, false, true), OperationMode::kPu);
}

// --- start signals ---

TEST(RunCommand, Pr250ReadsStfAndStr) {
  EXPECT_FALSE(stop_selection(9999).coasting);
  EXPECT_FALSE(stop_selection(9999).str_is_direction);
  EXPECT_TRUE(stop_selection(8888).str_is_direction);
  EXPECT_FALSE(stop_selection(8888).coasting);
  EXPECT_TRUE(stop_selection(1.5).coasting);
  EXPECT_EQ(stop_selection(1.5).coast_delay_s, 1.5);
  EXPECT_FALSE(stop_selection(1.5).str_is_direction);
  EXPECT_EQ(stop_selection(1002).coast_delay_s, 2);
  EXPECT_TRUE(stop_selection(1002).str_is_direction);
}

TEST(RunCommand, LevelsAndBothTogether) {
  StartLatch latch;
  EXPECT_EQ(latch.step({.stf = true}, false), RunDirection::kForward);
  EXPECT_EQ(latch.step({.str = true}, false), RunDirection::kReverse);
  EXPECT_EQ(latch.step({.stf = true, .str = true}, false), RunDirection::kStop);
  EXPECT_EQ(latch.step({}, false), RunDirection::kStop);
  EXPECT_EQ(latch.step({.str = true}, true), RunDirection::kStop);
  EXPECT_EQ(latch.step({.stf = true}, true), RunDirection::kForward);
  EXPECT_EQ(latch.step({.stf = true, .str = true}, true), RunDirection::kReverse);
}

TEST(RunCommand, StopHoldsPulsesUntilItGoesOff) {
  StartLatch latch;
  EXPECT_EQ(latch.step({.stop_hold = true}, false), RunDirection::kStop);
  EXPECT_EQ(latch.step({.stf = true, .stop_hold = true}, false), RunDirection::kForward);
  EXPECT_EQ(latch.step({.stop_hold = true}, false), RunDirection::kForward);
  EXPECT_EQ(latch.step({.str = true, .stop_hold = true}, false), RunDirection::kReverse);
  EXPECT_EQ(latch.step({.stop_hold = true}, false), RunDirection::kReverse);
  EXPECT_EQ(latch.step({.stf = true, .str = true, .stop_hold = true}, false), RunDirection::kStop);
  EXPECT_EQ(latch.step({.stop_hold = true}, false), RunDirection::kStop);
  EXPECT_EQ(latch.step({.stf = true, .stop_hold = true}, false), RunDirection::kForward);
  EXPECT_EQ(latch.step({}, false), RunDirection::kStop);
}

TEST(RunCommand, Pr78ForbidsADirection) {
  EXPECT_EQ(permitted(RunDirection::kReverse, 0), RunDirection::kReverse);
  EXPECT_EQ(permitted(RunDirection::kReverse, 1), RunDirection::kStop);
  EXPECT_EQ(permitted(RunDirection::kForward, 1), RunDirection::kForward);
  EXPECT_EQ(permitted(RunDirection::kForward, 2), RunDirection::kStop);
}

// --- 15 speeds ---

ParameterStore make_store(std::string_view model = "FR-E540-1.5K") {
  const auto& data = family_data();
  return {data.parameters, *find_model(data.models, model)};
}
void set(ParameterStore& store, const std::string& name, double value) {
  const auto row = store.table().index(name);
  ASSERT_TRUE(row.has_value()) << name;
  const auto raw = store.from_physical(*row, value);
  ASSERT_TRUE(raw.has_value()) << raw.error();
  store.write(*row, *raw, Storage::kRamOnly);
}
InputSignals signals(std::initializer_list<InputSignal> on) {
  InputSignals s;
  for (InputSignal i : on) s.set(i, true);
  return s;
}
constexpr auto RL = InputSignal::kRl;
constexpr auto RM = InputSignal::kRm;
constexpr auto RH = InputSignal::kRh;
constexpr auto REX = InputSignal::kRex;

TEST(MultiSpeed, EachCombinationHasItsParameter) {
  auto store = make_store();
  const std::pair<std::string, InputSignals> cases[] = {{"Pr.4", signals({RH})},
                                                        {"Pr.5", signals({RM})},
                                                        {"Pr.6", signals({RL})},
                                                        {"Pr.24", signals({RM, RL})},
                                                        {"Pr.25", signals({RH, RL})},
                                                        {"Pr.26", signals({RH, RM})},
                                                        {"Pr.27", signals({RH, RM, RL})},
                                                        {"Pr.232", signals({REX})},
                                                        {"Pr.233", signals({REX, RL})},
                                                        {"Pr.234", signals({REX, RM})},
                                                        {"Pr.235", signals({REX, RM, RL})},
                                                        {"Pr.236", signals({REX, RH})},
                                                        {"Pr.237", signals({REX, RH, RL})},
                                                        {"Pr.238", signals({REX, RH, RM})},
                                                        {"Pr.239", signals({REX, RH, RM, RL})}};
  double hz = 1;
  for (const auto& [name, on] : cases) set(store, name, hz++);
  hz = 1;
  for (const auto& [name, on] : cases) EXPECT_EQ(multi_speed_hz(store, on), hz++) << name;
  EXPECT_EQ(multi_speed_hz(store, {}), std::nullopt);
}

TEST(MultiSpeed, ACombinationWithoutSettingTakesTheLowestOfItsSignals) {
  const auto store = make_store();
  EXPECT_EQ(multi_speed_hz(store, signals({RH, RM, RL})), 10);
  EXPECT_EQ(multi_speed_hz(store, signals({RH, RM})), 30);
  EXPECT_EQ(multi_speed_hz(store, signals({REX})), std::nullopt);
  EXPECT_EQ(multi_speed_hz(store, signals({REX, RH})), 50);
}

// --- parameters to settings ---

drive::DriveSettings settings(const ParameterStore& store, const SettingsSelection& selection = {},
                              bool resistor = true) {
  const auto& data = family_data();
  return make_settings(store, selection, {find_model(data.models, "FR-E540-1.5K"), &data.models, 400, resistor});
}

// One parameter at one value, and what of the settings it must have set.
struct Effect {
  std::string name;
  double value;
  std::function<double(const drive::DriveSettings&)> of;
  double expected;
  std::vector<std::pair<std::string, double>> with = {};
  SettingsSelection selection = {};
};

const SettingsSelection kSecond{.second = true};
const SettingsSelection kJog{.jog = true};

std::vector<Effect> effects() {
  using S = drive::DriveSettings;
  const auto d = [](auto member) { return [member](const S& s) { return static_cast<double>(s.*member); }; };
  std::vector<Effect> e{
      {"Pr.0", 10, d(&S::torque_boost_percent), 10},
      {"Pr.1", 60, d(&S::max_frequency_hz), 60},
      {"Pr.2", 5, d(&S::min_frequency_hz), 5},
      {"Pr.3", 60, d(&S::base_frequency_hz), 60},
      {"Pr.3", 60, d(&S::cushion_pattern_base_hz), 60},
      {"Pr.7", 2.5, d(&S::acceleration_s), 2.5},
      {"Pr.8", 2.5, d(&S::deceleration_s), 2.5},
      {"Pr.9", 3.3, d(&S::electronic_thermal_a_rms), 3.3},
      {"Pr.10", 5, d(&S::dc_brake_frequency_hz), 5},
      {"Pr.11", 1.5, d(&S::dc_brake_s), 1.5},
      {"Pr.12", 8, d(&S::dc_brake_voltage_percent), 8},
      {"Pr.13", 2, d(&S::start_frequency_hz), 2},
      {"Pr.14", 1, d(&S::load_pattern), static_cast<double>(drive::LoadPattern::kVariableTorque)},
      {"Pr.14", 2, d(&S::load_pattern), static_cast<double>(drive::LoadPattern::kHoistBoostForward)},
      {"Pr.14", 3, d(&S::load_pattern), static_cast<double>(drive::LoadPattern::kHoistBoostReverse)},
      {"Pr.16", 1.5, d(&S::acceleration_s), 1.5, {}, kJog},
      {"Pr.16", 1.5, d(&S::deceleration_s), 1.5, {}, kJog},
      {"Pr.18", 200, d(&S::max_frequency_hz), 200},
      {"Pr.19", 300, d(&S::base_voltage_v_rms), 300},
      {"Pr.19", 9999, d(&S::base_voltage_v_rms), 400},
      {"Pr.19", 8888, d(&S::base_voltage_v_rms), 380},
      {"Pr.20", 60, d(&S::ramp_reference_hz), 60},
      {"Pr.21", 1, d(&S::acceleration_s), 0.5},
      {"Pr.22", 120, d(&S::stall_level_percent), 120},
      {"Pr.22", 0, d(&S::fast_current_limit), 0},
      {"Pr.23", 80, d(&S::stall_level_double_speed_percent), 80},
      {"Pr.23", 80, d(&S::stall_compensated), 1},
      {"Pr.23", 9999, d(&S::stall_compensated), 0},
      {"Pr.29", 1, d(&S::ramp_pattern), static_cast<double>(drive::RampPattern::kSCurveA)},
      {"Pr.29", 2, d(&S::ramp_pattern), static_cast<double>(drive::RampPattern::kSCurveB)},
      {"Pr.30", 1, d(&S::chopper_duty_percent), 0},
      {"Pr.70", 12, d(&S::chopper_duty_percent), 12, {{"Pr.30", 1}}},
      {"Pr.70", 12, d(&S::chopper_duty_percent), 3},
      {"Pr.41", 20, d(&S::up_to_frequency_percent), 20},
      {"Pr.42", 20, d(&S::detect_forward_hz), 20},
      {"Pr.42", 20, d(&S::detect_reverse_hz), 20},
      {"Pr.43", 15, d(&S::detect_reverse_hz), 15},
      {"Pr.44", 7, d(&S::acceleration_s), 7, {}, kSecond},
      {"Pr.44", 7, d(&S::deceleration_s), 7, {}, kSecond},
      {"Pr.45", 8, d(&S::deceleration_s), 8, {}, kSecond},
      {"Pr.46", 9, d(&S::torque_boost_percent), 9, {}, kSecond},
      {"Pr.46", 9, d(&S::torque_boost_percent), 4},
      {"Pr.47", 87, d(&S::base_frequency_hz), 87, {}, kSecond},
      {"Pr.48", 2.2, d(&S::electronic_thermal_a_rms), 2.2, {}, kSecond},
      {"Pr.57", 9999, d(&S::restart_enabled), 0},
      {"Pr.57", 0, d(&S::restart_coast_s), 0.5},
      {"Pr.57", 2, d(&S::restart_coast_s), 2},
      {"Pr.57", 2, d(&S::restart_enabled), 1},
      {"Pr.58", 3, d(&S::restart_cushion_s), 3},
      {"Pr.60", 1, d(&S::shortest_acceleration), 1},
      {"Pr.60", 1, d(&S::shortest_current_acceleration_a_rms), 6},
      {"Pr.60", 12, d(&S::shortest_current_deceleration_a_rms), 7.2},
      {"Pr.61", 2, d(&S::shortest_current_acceleration_a_rms), 3, {{"Pr.60", 11}}},
      {"Pr.62", 100, d(&S::shortest_current_acceleration_a_rms), 4, {{"Pr.60", 1}}},
      {"Pr.63", 120, d(&S::shortest_current_deceleration_a_rms), 4.8, {{"Pr.60", 1}}},
      {"Pr.66", 60, d(&S::stall_reduction_start_hz), 60},
      {"Pr.71", 0, d(&S::motor_forced_cooling), 0},
      {"Pr.71", 1, d(&S::motor_forced_cooling), 1},
      {"Pr.71", 13, d(&S::motor_forced_cooling), 1},
      {"Pr.71", 100, d(&S::motor_forced_cooling), 0},
      {"Pr.71", 100, d(&S::motor_forced_cooling), 1, {}, kSecond},
      {"Pr.72", 0, d(&S::carrier_hz), 700},
      {"Pr.72", 10, d(&S::carrier_hz), 10000},
      {"Pr.72", 15, d(&S::carrier_hz), 14500},
      {"Pr.80", 1.5, d(&S::stator_resistance_compensation_ohm), 3.655},  // the standard motor's
      {"Pr.80", 1.5, d(&S::torque_boost_percent), 0},
      {"Pr.80", 1.5, d(&S::stator_resistance_compensation_ohm), 0, {}, {.vf_by_x18 = true}},
      {"Pr.82", 1.7, d(&S::motor_no_load_current_a_rms), 1.7},
      {"Pr.83", 380, d(&S::base_voltage_v_rms), 380, {{"Pr.80", 1.5}}},
      {"Pr.84", 60, d(&S::base_frequency_hz), 60, {{"Pr.80", 1.5}}},
      {"Pr.90", 2.5, d(&S::stator_resistance_compensation_ohm), 2.5, {{"Pr.80", 1.5}}},
      {"Pr.90", 2.5, d(&S::stator_resistance_compensation_ohm), 0},
      {"Pr.150", 110, d(&S::current_detect_percent), 110},
      {"Pr.151", 2, d(&S::current_detect_s), 2},
      {"Pr.152", 7, d(&S::zero_current_percent), 7},
      {"Pr.153", 0.9, d(&S::zero_current_s), 0.9},
      {"Pr.156", 1, d(&S::fast_current_limit), 0},
      {"Pr.156", 2, d(&S::stall_in_acceleration), 0},
      {"Pr.156", 4, d(&S::stall_at_constant), 0},
      {"Pr.156", 8, d(&S::stall_in_deceleration), 0},
      {"Pr.156", 16, d(&S::stall_trips_at_once), 1},
      {"Pr.156", 100, d(&S::stall_in_deceleration), 0},
      {"Pr.156", 100, d(&S::stall_in_acceleration), 1},
      {"Pr.245", 4, d(&S::rated_slip_hz), 2},
      {"Pr.245", 9999, d(&S::rated_slip_hz), 0},
      {"Pr.246", 2, d(&S::slip_response_s), 2},
      {"Pr.247", 0, d(&S::slip_in_constant_output), 0},
      {"Pr.247", 9999, d(&S::slip_in_constant_output), 1},
      {"Pr.250", 1.5, d(&S::stop_by_coasting), 1},
      {"Pr.250", 1002, d(&S::coast_delay_s), 2},
      {"Pr.250", 8888, d(&S::stop_by_coasting), 0},
      {"Pr.251", 0, d(&S::output_phase_loss_protection), 0},
  };
  return e;
}

TEST(Settings, EachParameterReachesItsSetting) {
  for (const Effect& e : effects()) {
    SCOPED_TRACE(e.name + " = " + std::to_string(e.value));
    auto store = make_store();
    for (const auto& [name, value] : e.with) set(store, name, value);
    set(store, e.name, e.value);
    EXPECT_NEAR(e.of(settings(store, e.selection)), e.expected, 1e-9);
  }
}

TEST(Settings, JumpBandsTakeTheAValue) {
  auto store = make_store();
  EXPECT_LE(settings(store).jump_bands[0].high_hz, settings(store).jump_bands[0].low_hz);
  set(store, "Pr.31", 30);
  set(store, "Pr.32", 35);
  set(store, "Pr.33", 45);
  set(store, "Pr.34", 40);
  set(store, "Pr.35", 10);
  const auto s = settings(store);
  EXPECT_EQ(s.jump_bands[0].jump_to_hz, 30);
  EXPECT_EQ(s.jump_bands[1].low_hz, 40);
  EXPECT_EQ(s.jump_bands[1].high_hz, 45);
  EXPECT_EQ(s.jump_bands[1].jump_to_hz, 45);
  EXPECT_LE(s.jump_bands[2].high_hz, s.jump_bands[2].low_hz);  // half set: off
  set(store, "Pr.36", 12);
  EXPECT_EQ(settings(store).jump_bands[2].high_hz, 12);
}

TEST(Settings, EarthFaultTestAtStartIsOptionalInThe200VClass) {
  const auto& data = family_data();
  const auto* model = find_model(data.models, "FR-E520-1.5K");
  auto store = make_store("FR-E520-1.5K");
  const SettingsSurroundings around{model, &data.models, 200, false};
  EXPECT_FALSE(make_settings(store, {}, around).earth_fault_detection);
  set(store, "Pr.249", 1);
  EXPECT_TRUE(make_settings(store, {}, around).earth_fault_detection);
  EXPECT_TRUE(settings(make_store()).earth_fault_detection);
}

TEST(Settings, TheStandardMotorIsThatOfPr80) {
  auto store = make_store();
  set(store, "Pr.80", 0.75);
  EXPECT_NEAR(settings(store).stator_resistance_compensation_ohm, 8.205, 1e-9);
}

}  // namespace
}  // namespace vinv::inverter::e500
