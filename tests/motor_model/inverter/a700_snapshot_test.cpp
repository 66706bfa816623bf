// Snapshots of an FR-A700 (docs/decisions/0005-snapshots.md): a copy goes on byte for byte.
#include "a700_bench.hpp"

namespace vinv::inverter::test {
namespace {

// Everything that can be seen of one.
std::string seen(Bench& b) {
  std::string out = b->display() + " " + b->alarm_name() + "\n" + b->eeprom_text();
  for (const SignalValue& s : b->signals()) out += std::string(s.name) + " " + std::to_string(s.value) + "\n";
  for (unsigned code = 1; code <= 60; ++code)
    out += std::to_string(b.port().read_monitor(code).value_or(std::uint16_t{0})) + " ";
  return out;
}

void compare(Bench& original, const InverterConfig& config = config_a700()) {
  original.run(0.1 - std::fmod(original.now_s(), 0.1) + 0.001);
  Bytes bytes;
  while (!original->on_snapshot_grid()) original.tick();
  ASSERT_TRUE(original->save(bytes).has_value());
  Bench copy(config, "fr-a700");
  const auto loaded_ok = copy->load(bytes);
  ASSERT_TRUE(loaded_ok.has_value()) << loaded_ok.error();
  copy.set_now(original.now());
  EXPECT_EQ(seen(copy), seen(original));
  for (int i = 0; i < 20; ++i) {
    original.run(0.1);
    copy.run(0.1);
    ASSERT_EQ(seen(copy), seen(original)) << i;
  }
}

TEST(A700Snapshot, InTheMiddleOfALineError) {
  Bench b = a700_running(30, {{"Pr.502", 2}, {"Pr.8", 2}, {"Pr.500", 0.3}});
  b.port().set_communication_lost(true);
  b.run(0.5);
  compare(b);
}

TEST(A700Snapshot, InTheTraverseAndUnderPidControl) {
  Bench b = a700_with({{"Pr.592", 1}, {"Pr.593", 20}, {"Pr.4", 30}, {"Pr.29", 4}, {"Pr.380", 50}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(3);
  compare(b);
  Bench pid = a700_with({{"Pr.183", 14}, {"Pr.128", 20}, {"Pr.133", 50}, {"Pr.575", 1}});
  pid.terminal("STF");
  pid.terminal("RT");
  pid.run(1);
  compare(pid);
}

TEST(A700Snapshot, InARampOfSpeedControlAndUnderTorqueControl) {
  const InverterConfig config = loaded(0.02, 3, config_a700());
  Settings vector{{"Pr.80", 1.5}, {"Pr.81", 4},    {"Pr.84", 50}, {"Pr.877", 1},
                  {"Pr.881", 50}, {"Pr.822", 0.1}, {"Pr.4", 30}};
  Settings torque = vector;
  vector.emplace_back("Pr.800", 10);
  torque.insert(torque.end(), {{"Pr.800", 11}, {"Pr.804", 1}, {"Pr.806", 1060}});
  for (const Settings& settings : {vector, torque}) {
    Bench b = a700_with(settings, config);
    b.terminal("RH");
    b.terminal("STF");
    b.run(0.3);
    compare(b, config);
    b.terminal("STF", false);
    b.run(0.2);
    compare(b, config);
  }
}

TEST(A700Snapshot, WhileTheBrakeOpensAndWhileItCloses) {
  Bench b = a700_with({{"Pr.80", 1.5},
                       {"Pr.81", 4},
                       {"Pr.84", 50},
                       {"Pr.292", 8},
                       {"Pr.279", 10},
                       {"Pr.281", 1},
                       {"Pr.283", 1},
                       {"Pr.4", 30}});
  b.terminal("RH");
  b.terminal("STF");
  b.run(0.6);
  compare(b);
  b.terminal("STF", false);
  b.run(0.6);
  compare(b);
}

TEST(A700Snapshot, OfAnotherFamilyOrConnectorIsRefused) {
  Bench b = a700_with();
  while (!b->on_snapshot_grid()) b.tick();
  Bytes bytes;
  ASSERT_TRUE(b->save(bytes).has_value());
  Bench e500;
  EXPECT_FALSE(e500->load(bytes).has_value());
  InverterConfig other = config_a700();
  other.option_connector = 2;
  Bench connector(other, "fr-a700");
  EXPECT_FALSE(connector->load(bytes).has_value());
}

}  // namespace
}  // namespace vinv::inverter::test
