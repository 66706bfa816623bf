// The contactors of the commercial switch-over under arbitrary signals.
#include <gtest/gtest.h>

#include <random>

#include "motor_model/inverter/a700/commercial_switch.hpp"

namespace vinv::inverter::a700 {
namespace {

TEST(CommercialSwitch, MotorContactorsAreNeverClosedWithinTheInterlockOfEachOther) {
  constexpr double kInterlock_s = 0.05;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto chance = [&](unsigned one_in) { return random() % one_in == 0; };
    CommercialSwitch::Settings settings;
    settings.interlock_s = kInterlock_s;
    settings.start_wait_s = 0.02;
    settings.mains_at_alarm = chance(2);
    if (chance(2)) settings.automatic_hz = 45;
    if (chance(2)) settings.back_below_hz = 5;
    CommercialSwitch s;
    CommercialSwitch::Input input;
    double since_mc2_s = 1, since_mc3_s = 1;
    int on_mains = 0, on_inverter = 0;
    for (int i = 0; i < 20000; ++i) {
      if (chance(150)) input.enabled = !chance(4);
      if (chance(150)) input.inverter_wanted = chance(2);
      if (chance(150)) input.start_on = chance(2);
      if (chance(150)) input.alarm = chance(4);
      if (chance(150)) input.alarm_keeps_off = chance(2);
      if (chance(50)) input.output_hz = random() % 60;
      if (chance(50)) input.set_hz = random() % 60;
      input.running = s.output_permitted() && (input.start_on || s.catches_to_stop());
      s.step(0.001, settings, input);
      ASSERT_FALSE(s.mc2() && s.mc3());
      if (s.mc2()) {
        ASSERT_GE(since_mc3_s, kInterlock_s) << seed << " " << i;
      }
      if (s.mc3()) {
        ASSERT_GE(since_mc2_s, kInterlock_s) << seed << " " << i;
      }
      ASSERT_TRUE(s.mc3() || !s.output_permitted());
      ASSERT_EQ(s.mc1(), !input.alarm);
      since_mc2_s = s.mc2() ? 0 : since_mc2_s + 0.001;
      since_mc3_s = s.mc3() ? 0 : since_mc3_s + 0.001;
      on_mains += s.mc2() ? 1 : 0;
      on_inverter += s.output_permitted() ? 1 : 0;
    }
    EXPECT_GT(on_mains, 500) << seed;
    EXPECT_GT(on_inverter, 500) << seed;
  }
}

}  // namespace
}  // namespace vinv::inverter::a700
