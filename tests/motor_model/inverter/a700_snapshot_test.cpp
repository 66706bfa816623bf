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

void compare(Bench& original) {
  original.run(0.1 - std::fmod(original.now_s(), 0.1) + 0.001);
  Bytes bytes;
  while (!original->on_snapshot_grid()) original.tick();
  ASSERT_TRUE(original->save(bytes).has_value());
  Bench copy(config_a700(), "fr-a700");
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
