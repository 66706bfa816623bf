// Regeneration avoidance, energy saving and what follows the load of the FR-A700, snapshots of all of it. Typical for
// the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/saving_monitor.hpp"

namespace vinv::inverter::test {
namespace {

// --- regeneration avoidance ---

struct Regenerated {
  double highest_v = 0;
  double highest_hz = 0;
  double seconds = 0;
  bool overload = false;
  std::string alarm;
};

// At 40 Hz the driven machine pushes for a moment.
Regenerated pushed(Settings settings) {
  settings.emplace_back("Pr.4", 40);
  Bench b = a700_with(settings, loaded(0.02, 1, config_a700()));
  b.terminal("STF");
  b.terminal("RH");
  EXPECT_TRUE(b.run_until([&] { return b.output_hz() > 39.99; }, 10));
  b.run(0.3);
  Regenerated r;
  plant::LoadSettings load;
  load.inertia_kg_m2 = 0.02;
  load.hoist_nm = -8;  // forward
  b->set_load(load);
  load.hoist_nm = 1;
  for (int i = 0; i < 400; ++i) {
    if (i == 60) b->set_load(load);
    b.tick();
    r.highest_v = std::max(r.highest_v, b.signal("dc_link"));
    r.highest_hz = std::max(r.highest_hz, b.output_hz());
    r.overload = r.overload || b.port().status().overload;
  }
  r.alarm = b->alarm_name();
  return r;
}

// From 50 Hz down in a second with a flywheel.
Regenerated stopped(Settings settings) {
  settings.insert(settings.begin(), {{"Pr.4", 50}, {"Pr.7", 3}, {"Pr.8", 1}});
  Bench b = a700_with(settings, loaded(0.05, 0.5, config_a700()));
  b.terminal("STF");
  b.terminal("RH");
  EXPECT_TRUE(b.run_until([&] { return b.output_hz() > 49.99; }, 10));
  b.run(0.3);
  b.terminal("STF", false);
  Regenerated r;
  const double from = b.now_s();
  while (b.now_s() < from + 20 && (b.port().status().running || b.now_s() < from + 0.1) && b->alarm_name().empty()) {
    b.tick();
    r.highest_v = std::max(r.highest_v, b.signal("dc_link"));
    r.overload = r.overload || b.port().status().overload;
  }
  r.seconds = b.now_s() - from;
  r.alarm = b->alarm_name();
  return r;
}

TEST(A700Regeneration, Pr882RaisesTheFrequencyInsteadOfTripping) {
  EXPECT_EQ(pushed({}).alarm, "E.OV2");
  for (double pr882 : {1.0, 2.0}) {
    const Regenerated r = pushed({{"Pr.882", pr882}});
    EXPECT_EQ(r.alarm, "") << pr882;
    EXPECT_GT(r.highest_hz, 40.3);
    EXPECT_LE(r.highest_hz, 46.02);
    EXPECT_TRUE(r.overload) << "oL";
  }
}

TEST(A700Regeneration, ADecelerationWaitsWithPr882Is1Only) {
  EXPECT_EQ(stopped({}).alarm, "E.OV3");
  EXPECT_EQ(stopped({{"Pr.882", 2}}).alarm, "E.OV3") << "at constant speed only";
  const Regenerated r = stopped({{"Pr.882", 1}, {"Pr.883", 730}});
  EXPECT_EQ(r.alarm, "");
  EXPECT_GT(r.seconds, 1.5);
  EXPECT_TRUE(r.overload);
}

TEST(A700Regeneration, Pr883IsTheLevelAndPr885TheMostThatTheFrequencyRises) {
  EXPECT_LT(stopped({{"Pr.882", 1}, {"Pr.883", 700}}).highest_v,
            stopped({{"Pr.882", 1}, {"Pr.883", 770}}).highest_v - 30);
  const double most = pushed({{"Pr.882", 1}, {"Pr.883", 640}}).highest_hz;
  EXPECT_LE(pushed({{"Pr.882", 1}, {"Pr.883", 640}, {"Pr.885", 1}}).highest_hz, 41.02);
  EXPECT_GT(most, 41.5);
  EXPECT_GE(pushed({{"Pr.882", 1}, {"Pr.883", 640}, {"Pr.885", 9999}}).highest_hz, most);
}

TEST(A700Regeneration, Pr884LooksAtTheRiseOfTheLinkToo) {
  const Regenerated level = stopped({{"Pr.882", 1}});
  const Regenerated rise = stopped({{"Pr.882", 1}, {"Pr.884", 5}});
  EXPECT_EQ(rise.alarm, "");
  EXPECT_LT(rise.highest_v, level.highest_v);
}

TEST(A700Regeneration, Pr886AndPr665AreTheGains) {
  for (const char* gain : {"Pr.886", "Pr.665"}) {
    EXPECT_EQ(pushed({{"Pr.882", 1}, {gain, 0}}).alarm, "E.OV2") << gain;
    EXPECT_LT(pushed({{"Pr.882", 1}, {"Pr.883", 640}, {gain, 100}}).highest_v,
              pushed({{"Pr.882", 1}, {"Pr.883", 640}, {gain, 20}}).highest_v - 3)
        << gain;
  }
}

// --- energy saving ---

TEST(A700Saving, Pr60Is4LowersTheVoltageOfAnIdleMotor) {
  const auto after = [](const Settings& settings, double nm) {
    Bench b = a700_running(50, settings, loaded(0, nm, config_a700()));
    b.run(20);
    return b;
  };
  Bench full = after({}, 1);
  Bench saves = after({{"Pr.60", 4}, {"Pr.8", 5}}, 1);
  EXPECT_LT(saves.output_v(), full.output_v() * 0.8);
  EXPECT_LT(saves.signal("output_power"), full.signal("output_power") * 0.95);
  EXPECT_NEAR(saves.output_hz(), 50, 0.01);
  // A loaded motor needs its voltage.
  EXPECT_GT(after({{"Pr.60", 4}}, 9).output_v(), 330);
  // Not with vector control.
  Bench vector = after({{"Pr.60", 4}, {"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}}, 1);
  EXPECT_GT(vector.output_v(), full.output_v() * 0.95);
  // A change of speed has the full voltage again.
  ASSERT_TRUE(saves.frequency(45).has_value());
  saves.run(0.3);
  EXPECT_LT(saves.output_hz(), 49);
  EXPECT_NEAR(saves.output_v(), full.output_v() * saves.output_hz() / 50, 10);
}

TEST(A700Saving, ShareOnTheCommercialSupplyEndsAtTheRatedPower) {
  using a700::Throttling;
  for (Throttling t : {Throttling::kDischargeDamper, Throttling::kInletDamper, Throttling::kValve, Throttling::kNone}) {
    EXPECT_DOUBLE_EQ(a700::commercial_power_share(t, 1), 1);
    EXPECT_DOUBLE_EQ(a700::commercial_power_share(t, 1.5), 1);
    EXPECT_LE(a700::commercial_power_share(t, 0.4), a700::commercial_power_share(t, 0.8));
    EXPECT_GE(a700::commercial_power_share(t, 0), 0.5);
  }
}

// Running at 25 of 50 Hz with Pr.893 = 1.5 kW.
double saving_monitor(Settings settings, double seconds = 1, unsigned code = 50) {
  Bench b = a700_running(25, std::move(settings), loaded(0, 2, config_a700()));
  b.run(seconds);
  return monitor(b, code);
}

TEST(A700Saving, Pr892ToPr895MakeTheSavingOfPower) {
  Bench b = a700_running(25, {{"Pr.894", 3}}, loaded(0, 2, config_a700()));
  b.run(1);
  EXPECT_NEAR(monitor(b, 50), 150 - b.signal("input_power") / 10, 3);  // 0.01 kW
  const double input = monitor(b, 13);
  EXPECT_NEAR(saving_monitor({{"Pr.894", 3}, {"Pr.892", 50}}), 75 - input, 3);
  EXPECT_NEAR(saving_monitor({{"Pr.894", 3}, {"Pr.893", 3}}), 300 - input, 3);
  EXPECT_NEAR(saving_monitor({{"Pr.894", 2}}), 0.8 * 150 - input, 3);
  EXPECT_NEAR(saving_monitor({{"Pr.894", 1}}),
              150 * a700::commercial_power_share(a700::Throttling::kInletDamper, 0.5) - input, 3);
  EXPECT_NEAR(saving_monitor({{"Pr.894", 0}}),
              150 * a700::commercial_power_share(a700::Throttling::kDischargeDamper, 0.5) - input, 3);
  // In 0.1 %: of the commercial power, or of Pr.893.
  EXPECT_NEAR(saving_monitor({{"Pr.894", 2}, {"Pr.895", 0}}), (120 - input) / 120 * 1000, 25);
  EXPECT_NEAR(saving_monitor({{"Pr.894", 2}, {"Pr.895", 1}}), (120 - input) / 150 * 1000, 25);
  ASSERT_TRUE(b.command({}).has_value());
  b.run(3);
  EXPECT_EQ(monitor(b, 50), 0) << "stopped";
}

TEST(A700Saving, Pr896AndPr897AreAverageAndCostAndY92TellsOfEachNewOne) {
  Bench b = a700_running(25, {{"Pr.894", 3}, {"Pr.897", 0}, {"Pr.192", 92}}, loaded(0, 2, config_a700()));
  b.run(1700);
  EXPECT_EQ(monitor(b, 50), 0) << "no half-hour is over";
  EXPECT_FALSE(b.output("IPF"));
  b.run(120);
  const double average = monitor(b, 50);
  EXPECT_NEAR(average, 150 - monitor(b, 13), 5);
  EXPECT_TRUE(b.output("IPF"));
  b.preset("Pr.896", 2);
  EXPECT_NEAR(monitor(b, 50), 2 * average, 2);
  b.preset("Pr.896", 9999);
  b.preset("Pr.895", 1);
  EXPECT_NEAR(monitor(b, 50), average / 150 * 1000, 10) << "not averaged before Pr.895 was set: of the whole";
}

TEST(A700Saving, TheSumIsKeptAndPr898And899And896ShowItOtherwise) {
  // 1.1 kW for 30 h in one go would be long: the record has the sum.
  Bench b = a700_running(25, {{"Pr.894", 3}, {"Pr.893", 55}}, loaded(0, 2, config_a700()));
  b.run(400);
  const double kwh = 55 * 400.0 / 3600;
  EXPECT_NEAR(monitor(b, 51), kwh, 1);
  b.preset("Pr.896", 10);
  EXPECT_NEAR(monitor(b, 51), 10 * kwh, 3);
  b.preset("Pr.891", 1);
  EXPECT_NEAR(monitor(b, 51), kwh, 1);
  b.preset("Pr.891", 9999);
  b.preset("Pr.896", 9999);
  b.preset("Pr.899", 10);
  EXPECT_NEAR(monitor(b, 51), 55 * 8760 * 0.1, 55 * 8760 * 0.1 * 0.03);
  b.preset("Pr.898", 10);
  EXPECT_EQ(monitor(b, 51), 9999);
  EXPECT_EQ(b.raw(898), 10u);
  b.preset("Pr.898", 9999);
  b.preset("Pr.899", 9999);
  b.preset("Pr.898", 1);
  const double held = monitor(b, 51);
  b.run(200);
  EXPECT_EQ(monitor(b, 51), held);
  b.preset("Pr.898", 9999);
  b.power_cycle();
  EXPECT_NEAR(monitor(b, 51), held, 1);
  b.preset("Pr.898", 0);
  EXPECT_EQ(monitor(b, 51), 0);
}

// --- load torque high-speed frequency ---

// Where it settles, with X19 at RT.
double speed_by_load(Settings settings, double nm, bool x19 = true) {
  settings.insert(
      settings.begin(),
      {{"Pr.183", 19}, {"Pr.270", 2}, {"Pr.4", 60}, {"Pr.5", 30}, {"Pr.271", 50}, {"Pr.272", 100}, {"Pr.7", 3}});
  Bench b = a700_with(settings, loaded(0.002, nm, config_a700()));
  if (x19) b.terminal("RT");
  b.terminal("RM");
  b.terminal("STF");
  b.run(8);
  EXPECT_EQ(b->alarm_name(), "");
  return b.output_hz();
}

TEST(A700LoadSpeed, Pr270To272LetALightLoadGoFaster) {
  EXPECT_NEAR(speed_by_load({{"Pr.271", 90}}, 1), 60, 0.02);
  EXPECT_NEAR(speed_by_load({{"Pr.271", 5}, {"Pr.272", 20}}, 1), 30, 0.02);
  const double half = speed_by_load({{"Pr.271", 5}, {"Pr.272", 120}}, 1);
  EXPECT_GT(half, 32);
  EXPECT_LT(half, 58);
  EXPECT_LT(speed_by_load({{"Pr.271", 5}, {"Pr.272", 120}}, 8), half - 3) << "more load";
  EXPECT_NEAR(speed_by_load({{"Pr.271", 90}}, 1, false), 30, 0.02) << "X19 off";
  EXPECT_NEAR(speed_by_load({{"Pr.271", 90}, {"Pr.270", 1}}, 1), 30, 0.02);
}

TEST(A700LoadSpeed, Pr273AndPr274AreTheAverage) {
  const Settings between{{"Pr.271", 5}, {"Pr.272", 120}};
  const auto with = [&](const char* name, double value) {
    Settings s = between;
    s.emplace_back(name, value);
    return speed_by_load(s, 4);
  };
  const double by_pr5 = speed_by_load(between, 4);
  EXPECT_NEAR(with("Pr.273", 30), by_pr5, 0.01);
  EXPECT_GT(std::abs(with("Pr.273", 6) - by_pr5), 0.2);
  EXPECT_GT(with("Pr.274", 4000), by_pr5 + 3) << "a slow filter has not seen the current yet";
}

// --- stop-on-contact ---

Bench contact(Settings settings, bool locked) {
  settings.insert(settings.begin(), {{"Pr.270", 1},
                                     {"Pr.44", 0.5},
                                     {"Pr.80", 1.5},
                                     {"Pr.81", 4},
                                     {"Pr.84", 50},
                                     {"Pr.6", 5},
                                     {"Pr.48", 80},
                                     {"Pr.156", 0}});
  Bench b = a700_with(settings);
  b->set_shaft_locked(locked);
  b.terminal("RL");
  b.terminal("RT");
  b.terminal("STF");
  b.run(2);
  return b;
}

TEST(A700Contact, Pr48IsTheHoldingCurrentWithPr270) {
  const double low = contact({{"Pr.48", 70}}, true).signal("output_current");
  const double high = contact({{"Pr.48", 130}}, true).signal("output_current");
  EXPECT_NEAR(low, 0.7 * 4, 0.5);
  EXPECT_NEAR(high, 1.3 * 4, 0.8);
  EXPECT_GT(contact({{"Pr.48", 70}, {"Pr.270", 0}}, true).signal("output_current"), low + 1) << "Pr.22";
  EXPECT_GT(contact({{"Pr.48", 70}, {"Pr.80", 9999}}, true).signal("output_current"), low + 1) << "vector control only";
}

TEST(A700Contact, Pr6IsTheSpeedUpTo30Hz) {
  EXPECT_NEAR(contact({{"Pr.6", 12}, {"Pr.48", 150}}, false).output_hz(), 12, 0.6);
  EXPECT_NEAR(contact({{"Pr.6", 50}, {"Pr.48", 150}}, false).output_hz(), 30, 0.6);
  EXPECT_NEAR(contact({{"Pr.6", 50}, {"Pr.48", 150}, {"Pr.270", 0}}, false).output_hz(), 50, 0.6);
}

TEST(A700Contact, Pr275ExcitesMoreAndPr276IsTheCarrierAtLowSpeed) {
  const double plain = contact({{"Pr.48", 150}}, false).signal("output_voltage");
  EXPECT_GT(contact({{"Pr.48", 150}, {"Pr.275", 150}}, false).signal("output_voltage"), plain * 1.3);
  EXPECT_EQ(contact({{"Pr.6", 2}, {"Pr.276", 5}}, false).signal("carrier"), 5000);
  EXPECT_EQ(contact({{"Pr.6", 2}}, false).signal("carrier"), 2000);
  EXPECT_EQ(contact({{"Pr.6", 8}, {"Pr.276", 5}}, false).signal("carrier"), 2000) << "above 3 Hz";
}

// --- snapshots ---

std::string seen(Bench& b) {
  std::string out = b->display() + " " + b->alarm_name() + "\n" + b->eeprom_text();
  for (const auto& [name, on] : b->terminals()) out += std::string(name) + (on ? " on\n" : " off\n");
  for (const SignalValue& s : b->signals()) out += std::string(s.name) + " " + std::to_string(s.value) + "\n";
  for (unsigned code = 1; code <= 60; ++code)
    out += std::to_string(b.port().read_monitor(code).value_or(std::uint16_t{0})) + " ";
  return out;
}

void compare(Bench& original, const InverterConfig& config, const std::function<void(Bench&)>& later) {
  while (!original->on_snapshot_grid()) original.tick();
  Bytes bytes;
  ASSERT_TRUE(original->save(bytes).has_value());
  Bench copy(config, "fr-a700");
  const auto loaded_ok = copy->load(bytes);
  ASSERT_TRUE(loaded_ok.has_value()) << loaded_ok.error();
  copy.set_now(original.now());
  EXPECT_EQ(seen(copy), seen(original));
  later(original);
  later(copy);
  for (int i = 0; i < 15; ++i) {
    original.run(0.1);
    copy.run(0.1);
    ASSERT_EQ(seen(copy), seen(original)) << i;
  }
}

TEST(A700SupplySnapshot, InTheMiddleOfASwitchOver) {
  const InverterConfig config = loaded(0.02, 2, config_a700());
  Bench b = a700_with(
      {{"Pr.135", 1}, {"Pr.136", 0.5}, {"Pr.57", 0.1}, {"Pr.191", 17}, {"Pr.192", 18}, {"Pr.193", 19}, {"Pr.4", 40}},
      config);
  for (const char* t : {"MRS", "CS", "STF", "RH"}) b.terminal(t);
  b.run(3);
  b.terminal("CS", false);
  b.run(0.2);
  compare(b, config, [](Bench&) {});
  compare(b, config, [](Bench& one) { one.terminal("CS"); });
}

TEST(A700SupplySnapshot, InTheMiddleOfAPowerFailureAndOfARestart) {
  const InverterConfig config = loaded(0.1, 2, config_a700());
  Bench b = a700_with(
      {{"Pr.261", 12}, {"Pr.264", 5}, {"Pr.7", 3}, {"Pr.4", 50}, {"Pr.57", 0.1}, {"Pr.186", 9999}, {"Pr.58", 1}},
      config);
  b.terminal("STF");
  b.terminal("RH");
  b.run(4);
  b->set_mains({.voltage_v_rms = 0});
  b.run(0.2);
  compare(b, config, [](Bench& one) { one->set_mains({.voltage_v_rms = 400}); });
}

TEST(A700SupplySnapshot, WhileSavingAndWhileTheLoadDecidesTheSpeed) {
  const InverterConfig config = loaded(0.01, 1, config_a700());
  Bench b = a700_with({{"Pr.60", 4}, {"Pr.4", 50}, {"Pr.897", 0}, {"Pr.882", 1}}, config);
  b.terminal("STF");
  b.terminal("RH");
  b.run(5);
  compare(b, config, [](Bench& one) { one.terminal("RH", false); });
  Bench by_load = a700_with({{"Pr.183", 19}, {"Pr.270", 2}, {"Pr.7", 3}}, config);
  by_load.terminal("RT");
  by_load.terminal("STF");
  by_load.run(1.2);
  compare(by_load, config, [](Bench&) {});
}

}  // namespace
}  // namespace vinv::inverter::test
