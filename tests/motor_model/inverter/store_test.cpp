// Parameter store: images, scaling, clears. Access rules: each rule and refusal (Pr.77, mode, running, groups).
#include <gtest/gtest.h>

#include <cmath>

#include "motor_model/inverter/access_rules.hpp"
#include "motor_model/inverter/e500/inverter.hpp"

namespace vinv::inverter {
namespace {

using port::OperationMode;
using port::Refusal;

ParameterStore make_store() {
  const auto& data = e500::family_data();
  return {data.parameters, *find_model(data.models, "FR-E540-1.5K")};
}
std::size_t row_of(unsigned number, unsigned sub = 0) {
  return *e500::family_data().parameters.index(
      port::ParameterId{static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(sub)});
}

TEST(ParameterStore, RamOnlyWritesAreGoneAfterReload) {
  auto store = make_store();
  store.write(row_of(7), 100, Storage::kRamOnly);
  store.write(row_of(8), 200, Storage::kRamAndEeprom);
  EXPECT_EQ(store.value(7), 10);
  store.load_ram_from_eeprom();
  EXPECT_EQ(store.value(7), 5);
  EXPECT_EQ(store.value(8), 20);
}

TEST(ParameterStore, AFactoryValueOfTheUnitOutlastsAllClearsAndALostEeprom) {
  auto store = make_store();
  store.set_factory(row_of(345), 5);
  EXPECT_EQ(store.value(345), 5);
  store.write(row_of(345), 12, Storage::kRamAndEeprom);
  store.clear(ClearKind::kAllClear);
  EXPECT_EQ(store.value(345), 5);
  store.write(row_of(345), 12, Storage::kRamAndEeprom);
  store.clear_to_factory();
  EXPECT_EQ(store.value(345), 5);
  EXPECT_EQ(store.eeprom_raw(row_of(345)), 5);
}

TEST(ParameterStore, SpecialsReadAsTheyArePrinted) {
  auto store = make_store();
  EXPECT_EQ(store.value(19), 8888);
  EXPECT_TRUE(store.is_9999(57));
  EXPECT_EQ(store.from_physical(row_of(57), 9999).value(), kRaw9999);
  EXPECT_EQ(store.from_physical(row_of(19), 8888).value(), kRaw8888);
  EXPECT_FALSE(store.from_physical(row_of(57), 8888).has_value());
  EXPECT_EQ(store.text(row_of(19), kRaw8888), "8888");
}

TEST(ParameterStore, ValuesOffTheIncrementOrRangeAreRefusedWithTheRange) {
  auto store = make_store();
  EXPECT_EQ(store.from_physical(row_of(7), 5.05).error(),
            "Pr.7 (Acceleration time) takes 0.0 to 3600.0 s in steps of 0.1");
  EXPECT_FALSE(store.from_physical(row_of(7), -0.1).has_value());
  EXPECT_FALSE(store.from_physical(row_of(7), 3600.1).has_value());
  EXPECT_FALSE(store.from_physical(row_of(7), std::nan("")).has_value());
  EXPECT_FALSE(store.from_physical(row_of(7), 1e300).has_value());
  EXPECT_EQ(store.from_physical(row_of(7), 0.3).value(), 3);
  // 655.35 Hz has the raw word of 9999, but is out of range.
  EXPECT_FALSE(store.from_physical(row_of(24), 655.35).has_value());
  EXPECT_EQ(store.from_physical(row_of(37), 65.535).value(), 65535);
}

TEST(ParameterStore, Pr21MakesTheStoredTimesTenTimesFiner) {
  auto store = make_store();
  EXPECT_EQ(store.value(7), 5.0);
  store.write(row_of(21), 1, Storage::kRamAndEeprom);
  for (unsigned number : {7u, 8u, 44u}) EXPECT_DOUBLE_EQ(store.value(number), 0.5) << number;
  EXPECT_DOUBLE_EQ(store.value(16), 0.05);
  EXPECT_EQ(store.value(45), 9999);
  EXPECT_EQ(store.from_physical(row_of(7), 360).value(), 36000);
  EXPECT_FALSE(store.from_physical(row_of(7), 360.01).has_value());
  EXPECT_EQ(store.from_physical(row_of(7), 0.05).value(), 5);
}

TEST(ParameterStore, PlainClearKeepsCommunicationAndCalibration) {
  auto store = make_store();
  const auto set = [&](unsigned number, std::int32_t raw, unsigned sub = 0) {
    store.write(row_of(number, sub), raw, Storage::kRamAndEeprom);
  };
  set(7, 77);
  set(75, 0);
  set(118, 48);
  set(340, 1);
  set(345, 9);
  set(347, 5);
  set(901, 900);
  set(903, 6000, 1);
  store.clear(ClearKind::kParameterClear);
  EXPECT_EQ(store.value(7), 5);
  EXPECT_EQ(store.value(75), 0);
  EXPECT_EQ(store.value(118), 48);
  EXPECT_EQ(store.value(340), 1);
  EXPECT_EQ(store.value(345), 9);
  EXPECT_EQ(store.value(347), 5);
  EXPECT_EQ(store.value(901), 90);
  EXPECT_EQ(store.value(903, 1), 60);
  store.clear(ClearKind::kAllClear);
  EXPECT_EQ(store.value(75), 0);  // kept by both, typical for the family
  EXPECT_EQ(store.value(118), 192);
  EXPECT_EQ(store.value(340), 0);
  EXPECT_EQ(store.value(345), 63);
  EXPECT_EQ(store.value(347), 4);
  EXPECT_EQ(store.value(903, 1), 50);
  store.load_ram_from_eeprom();
  EXPECT_EQ(store.value(7), 5);
}

// --- access rules ---

const ParameterRow& row(unsigned number) { return e500::family_data().parameters.rows()[row_of(number)]; }

AccessSituation network(WriteDisable disable = WriteDisable::kStopped, bool running = false) {
  return {Writer::kNetwork, OperationMode::kNetwork, disable, running, true};
}
AccessSituation panel(OperationMode mode, WriteDisable disable = WriteDisable::kStopped, bool running = false) {
  return {Writer::kPanel, mode, disable, running, true};
}

TEST(AccessRules, NetworkWritesNeedNetworkOperation) {
  for (auto mode :
       {OperationMode::kExternal, OperationMode::kPu, OperationMode::kCombined1, OperationMode::kCombined2}) {
    auto s = network();
    s.mode = mode;
    EXPECT_EQ(write_refusal(row(7), s), Refusal::kWrongMode);
    s.disable = WriteDisable::kAlways;
    EXPECT_EQ(write_refusal(row(7), s), std::nullopt);
  }
  EXPECT_EQ(write_refusal(row(7), network()), std::nullopt);
}

TEST(AccessRules, PanelWritesNeedPuOperationButForPr77AndPr79) {
  EXPECT_EQ(write_refusal(row(7), panel(OperationMode::kExternal)), Refusal::kWrongMode);
  EXPECT_EQ(write_refusal(row(7), panel(OperationMode::kNetwork)), Refusal::kWrongMode);
  EXPECT_EQ(write_refusal(row(7), panel(OperationMode::kPu)), std::nullopt);
  EXPECT_EQ(write_refusal(row(7), panel(OperationMode::kCombined1)), std::nullopt);
  EXPECT_EQ(write_refusal(row(7), panel(OperationMode::kExternal, WriteDisable::kAlways)), std::nullopt);
  EXPECT_EQ(write_refusal(row(79), panel(OperationMode::kExternal)), std::nullopt);
  EXPECT_EQ(write_refusal(row(77), panel(OperationMode::kNetwork)), std::nullopt);
}

TEST(AccessRules, WhileRunningEachRowFollowsItsOwnColumn) {
  for (const ParameterRow& r : e500::family_data().parameters.rows()) {
    if (r.kind == ParameterKind::kManufacturer) continue;
    EXPECT_EQ(write_refusal(r, network(WriteDisable::kStopped, true)).has_value(), !r.write_while_running) << r.label;
    EXPECT_EQ(write_refusal(r, network(WriteDisable::kAlways, true)).has_value(), !r.write_while_running_free)
        << r.label;
    EXPECT_EQ(write_refusal(r, network(WriteDisable::kStopped, false)), std::nullopt) << r.label;
  }
  EXPECT_EQ(write_refusal(row(7), network(WriteDisable::kStopped, true)), Refusal::kRunning);
  EXPECT_EQ(write_refusal(row(4), network(WriteDisable::kStopped, true)), std::nullopt);
  EXPECT_EQ(write_refusal(row(79), network(WriteDisable::kAlways, true)), Refusal::kRunning);
}

TEST(AccessRules, LockedLeavesFiveParameters) {
  std::vector<unsigned> open;
  for (const ParameterRow& r : e500::family_data().parameters.rows()) {
    const auto refusal = write_refusal(r, network(WriteDisable::kLocked));
    if (!refusal) {
      open.push_back(r.id.number);
    } else if (r.kind != ParameterKind::kManufacturer) {
      EXPECT_EQ(refusal, Refusal::kWriteDisabled) << r.label;
    }
  }
  EXPECT_EQ(open, (std::vector<unsigned>{22, 75, 77, 79, 160}));
}

TEST(AccessRules, ManufacturerSettingsAreReadOnly) {
  for (unsigned number : {146u, 168u, 169u}) {
    EXPECT_EQ(write_refusal(row(number), network(WriteDisable::kAlways)), Refusal::kReadOnly);
  }
}

TEST(AccessRules, UserGroupsHideRowsFromThePanel) {
  auto s = panel(OperationMode::kPu);
  s.in_user_group = false;
  EXPECT_EQ(write_refusal(row(7), s), Refusal::kWriteDisabled);
}

TEST(AccessRules, ClearsNeedAStoppedUnlockedInverterInTheRightMode) {
  EXPECT_EQ(clear_refusal(network()), std::nullopt);
  EXPECT_EQ(clear_refusal(network(WriteDisable::kLocked)), Refusal::kWriteDisabled);
  EXPECT_EQ(clear_refusal(network(WriteDisable::kAlways, true)), Refusal::kRunning);
  EXPECT_EQ(clear_refusal(panel(OperationMode::kExternal)), Refusal::kWrongMode);
}

}  // namespace
}  // namespace vinv::inverter
