// EEPROM text: round trip, and no damage ever passes; the inverter's own handling of it (E.PE, hour meter, groups).
#include "bench.hpp"
#include "motor_model/inverter/e500/inverter.hpp"
#include "motor_model/inverter/eeprom_text.hpp"

namespace vinv::inverter::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr EepromIdentity kIdentity{"fr-e500", "FR-E540-1.5K"};

ParameterStore make_store() {
  const auto& data = e500::family_data();
  return {data.parameters, *find_model(data.models, "FR-E540-1.5K")};
}

EepromRecord sample_record() {
  EepromRecord r;
  r.panel_frequency = 3000;
  r.remote_frequency = 120;
  r.operating_seconds = 7200;
  r.retry_count = 3;
  r.groups[0].add(7);
  r.groups[0].add(902);
  r.alarms = {0x22, 0xA3};
  return r;
}

std::string sample_text() {
  auto store = make_store();
  store.write(*store.table().index("Pr.7"), 123, Storage::kRamAndEeprom);
  store.write(*store.table().index("Pr.8"), 321, Storage::kRamOnly);
  return emit_eeprom(kIdentity, store, e500::family_data().alarms, sample_record());
}

Result<EepromContents, std::string> parse(std::string_view text) {
  const auto store = make_store();
  return parse_eeprom(text, kIdentity, store, e500::family_data().alarms);
}

TEST(EepromText, RoundTripKeepsEverythingStored) {
  const std::string text = sample_text();
  const auto contents = parse(text);
  ASSERT_TRUE(contents.has_value()) << contents.error();
  auto store = make_store();
  EXPECT_EQ(contents->parameters[*store.table().index("Pr.7")], 123);
  EXPECT_EQ(contents->parameters[*store.table().index("Pr.8")], 50);  // was in RAM only
  EXPECT_EQ(contents->record, sample_record());
  store.set_eeprom(contents->parameters);
  EXPECT_EQ(emit_eeprom(kIdentity, store, e500::family_data().alarms, contents->record), text);
}

TEST(EepromText, IsReadable) {
  const std::string text = sample_text();
  EXPECT_THAT(
      text,
      StartsWith(
          "vinverter eeprom, version 1\nfamily = fr-e500\nmodel = FR-E540-1.5K\nPr.0 = 4.0  # Torque boost, %\n"));
  EXPECT_THAT(text, HasSubstr("\nPr.7 = 12.3  # Acceleration time, s\n"));
  EXPECT_THAT(text, HasSubstr("\nPr.19 = 8888  # Base frequency voltage, V\n"));
  EXPECT_THAT(text, HasSubstr("\nuser_group_1 = 7 902\n"));
  EXPECT_THAT(text, HasSubstr("\nalarm_1 = E.OV3\nalarm_2 = E.OP3\nalarm_3 = none\n"));
}

TEST(EepromText, FineTimesSurviveWhateverThePositionOfPr21) {
  auto store = make_store();
  store.write(*store.table().index("Pr.21"), 1, Storage::kRamAndEeprom);
  store.write(*store.table().index("Pr.7"), 123, Storage::kRamAndEeprom);
  const std::string text = emit_eeprom(kIdentity, store, e500::family_data().alarms, {});
  EXPECT_THAT(text, HasSubstr("\nPr.7 = 1.23  #"));
  const auto contents = parse(text);
  ASSERT_TRUE(contents.has_value()) << contents.error();
  EXPECT_EQ(contents->parameters[*store.table().index("Pr.7")], 123);
}

TEST(EepromText, EveryFlippedBitIsRefused) {
  const std::string text = sample_text();
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int bit = static_cast<int>(i % 8);
    std::string damaged = text;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
    const auto contents = parse(damaged);
    ASSERT_FALSE(contents.has_value()) << "byte " << i << " bit " << bit;
    ASSERT_THAT(contents.error(), StartsWith("line "));
  }
}

TEST(EepromText, EveryTruncationIsRefused) {
  const std::string text = sample_text();
  for (std::size_t size = 0; size < text.size(); size += 7) {
    ASSERT_FALSE(parse(std::string_view(text).substr(0, size)).has_value()) << size;
  }
  EXPECT_FALSE(parse(std::string_view(text).substr(0, text.size() - 1)).has_value());
  EXPECT_FALSE(parse(text + "x\n").has_value());
}

// A changed value with a checksum that fits: what a person could do.
std::string resealed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  text.resize(text.rfind("checksum"));
  char line[32];
  std::snprintf(line, sizeof line, "checksum = %08x\n", crc32(text));
  return text + line;
}

TEST(EepromText, WrongLinesAreNamed) {
  const std::string text = sample_text();
  const auto error = [&](const std::string& from, const std::string& to) {
    const auto contents = parse(resealed(text, from, to));
    return contents ? "accepted" : contents.error();
  };
  EXPECT_EQ(error("Pr.7 = 12.3", "Pr.7 = 12.4"), "accepted");
  EXPECT_EQ(error("Pr.7 = 12.3", "Pr.7 = 3600.1"), "line 11: Pr.7 = 3600.1: takes 0.0 to 3600.0 s in steps of 0.1");
  EXPECT_EQ(error("Pr.7 = 12.3", "Pr.7 = 12.34"), "line 11: Pr.7 = 12.34: takes 0.0 to 3600.0 s in steps of 0.1");
  EXPECT_EQ(error("Pr.7 = ", "Pr.9 = "), "line 11: expected 'Pr.7 = ...'");
  EXPECT_EQ(error("version 1", "version 2"), "line 1: not 'vinverter eeprom, version 1'");
  EXPECT_EQ(error("FR-E540-1.5K", "FR-E540-0.4K"), "line 3: this is the EEPROM of a FR-E540-0.4K, not FR-E540-1.5K");
  EXPECT_THAT(error("alarm_1 = E.OV3", "alarm_1 = E.XYZ"), HasSubstr("is not an alarm of this family"));
  EXPECT_THAT(error("user_group_1 = 7 902", "user_group_1 = 7 28"), HasSubstr("user_group_1 takes"));
  EXPECT_THAT(error("retry_count = 3", "retry_count = -3"), HasSubstr("retry_count takes 0 to 65535"));
}

TEST(Crc32, HasItsCheckValue) { EXPECT_EQ(crc32("123456789"), 0xCBF43926u); }

// --- the inverter's EEPROM ---

TEST(Eeprom, ParametersPanelFrequencyAndHistorySurviveAPowerCycle) {
  Bench b;
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.write_parameter(7, 100));
  EXPECT_TRUE(b->take_eeprom_changed());
  EXPECT_FALSE(b->take_eeprom_changed());
  ASSERT_TRUE(b.write_parameter(342, 1));
  ASSERT_TRUE(b.write_parameter(8, 200));  // RAM only now
  EXPECT_EQ(b.raw(8), 200u);
  ASSERT_TRUE(b->inject_fault("E.OV1", true).has_value());
  const std::string stored = b->eeprom_text();
  b.power_cycle();
  EXPECT_EQ(b.raw(7), 100u);
  EXPECT_EQ(b.raw(8), 50u);
  EXPECT_EQ(b.port().alarm_history()[0], 0x20);
  // A new process: another inverter with the stored text.
  Bench c;
  ASSERT_TRUE(c->load_eeprom(stored).has_value());
  c.power_on();
  EXPECT_EQ(c.raw(7), 100u);
  EXPECT_EQ(c.port().alarm_history()[0], 0x20);
  EXPECT_EQ(c->alarm_name(), "");
}

TEST(Eeprom, ADamagedTextGivesEpeAndFactoryValues) {
  Bench b;
  b.preset("Pr.7", 9);
  std::string text = b->eeprom_text();
  text[text.find("Pr.7 = 9") + 7] = '8';
  (void)b->take_eeprom_changed();
  const auto loaded = b->load_eeprom(text);
  ASSERT_FALSE(loaded.has_value());
  EXPECT_THAT(loaded.error(), HasSubstr("checksum"));
  b->set_power(true);
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_EQ(b->alarm_name(), "E.PE");
  EXPECT_EQ(b.port().active_alarm(), 0xB0);
  EXPECT_EQ(b.raw(7), 50u);
  // Not by reset, only by a power cycle.
  EXPECT_FALSE(b->press_key(PanelKey::kStopReset).has_value());
  ASSERT_TRUE(b.net());
  EXPECT_TRUE(refused(b.reset(), port::Refusal::kFaulted));
  b.power_cycle();
  EXPECT_EQ(b->alarm_name(), "");
  EXPECT_TRUE(b->take_eeprom_changed());
}

TEST(Eeprom, AWriteThatFailsRaisesEpeAndIsGoneAfterPowerOff) {
  Bench b;
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b->inject_fault("eeprom_write", true).has_value());
  ASSERT_TRUE(b.write_parameter(7, 100));
  EXPECT_EQ(b->alarm_name(), "E.PE");
  EXPECT_EQ(b.raw(7), 100u);
  ASSERT_TRUE(b->inject_fault("eeprom_write", false).has_value());
  b.power_cycle();
  EXPECT_EQ(b.raw(7), 50u);
  EXPECT_EQ(b->alarm_name(), "");
}

TEST(Eeprom, HourMeterCountsOutputTimeAndPr171ClearsIt) {
  Bench b;
  b.preset("Pr.7", 0.1);
  b.preset("Pr.77", 2);
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(10));
  ASSERT_TRUE(b.command({port::NetTerminal::kStf}));
  b.run(10);
  EXPECT_NEAR(b.signal("operating_hours") * 3600, 10, 0.1);
  EXPECT_THAT(b->eeprom_text(), HasSubstr("operating_seconds = 1"));
  ASSERT_TRUE(b.command({}));
  b.run(2);
  EXPECT_TRUE(refused(b.write_parameter(171, 1), port::Refusal::kOutOfRange));
  ASSERT_TRUE(b.write_parameter(171, 0));
  EXPECT_NEAR(b.signal("operating_hours"), 0, 1e-6);
}

TEST(Eeprom, UserGroupsLimitThePanelOnly) {
  Bench b;
  b.preset("Pr.173", 7);
  b.preset("Pr.160", 1);
  b.power_on();
  b.pu();
  EXPECT_TRUE(b->set_parameter("Pr.7", 6).has_value());
  EXPECT_EQ(b->set_parameter("Pr.8", 6).error(), "Pr.8 is not in the user group that Pr.160 selects");
  EXPECT_TRUE(b->set_parameter("Pr.160", 0).has_value());
  EXPECT_TRUE(b->set_parameter("Pr.8", 6).has_value());
  EXPECT_FALSE(b->set_parameter("Pr.173", 28).has_value());
  EXPECT_TRUE(b->set_parameter("Pr.174", 9999).has_value());
  EXPECT_THAT(b->eeprom_text(), HasSubstr("user_group_1 = none"));
}

}  // namespace
}  // namespace vinv::inverter::test
