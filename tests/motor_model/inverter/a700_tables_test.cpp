// The tables of the FR-A700 against an independent copy of the reference rows (data/a700_*_reference.csv).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "motor_model/inverter/a700/tables.hpp"
#include "motor_model/inverter/access_rules.hpp"
#include "motor_model/inverter/csv.hpp"
#include "motor_model/inverter/parameter_store.hpp"
#include "tests/motor_model/inverter/reference_rows.hpp"

namespace vinv::inverter {
namespace {

using testing::HasSubstr;

const ParameterTable& table() { return a700::family_data().parameters; }
const ParameterRow& row(unsigned number, unsigned sub = 0) {
  return table()
      .rows()[*table().index(port::ParameterId{static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(sub)})];
}
// Models of 75K and up have a table of their own.
const ParameterTable& table_of(const ModelRow& model) {
  return a700::family_data(model.motor_kw >= a700::kLarge_kw).parameters;
}
ParameterStore store_of(std::string_view name) {
  const ModelRow& model = *find_model(a700::family_data().models, name);
  return {table_of(model), model};
}

TEST(A700Parameters, EveryReferenceRowIsCarriedWithRangeDefaultAndAccess) {
  const CsvTable rows = reference("a700_parameters_reference.csv");
  const ParameterStore store = store_of("FR-A740-1.5K");  // the reference unit
  CsvReader in(rows);
  ASSERT_EQ(table().rows().size(), in.size());
  for (std::size_t i = 0; i < in.size(); ++i) {
    in.select(i);
    const ParameterRow& r = table().rows()[i];
    SCOPED_TRACE(r.label);
    EXPECT_EQ(r.id.number, in.integer("pr"));
    EXPECT_EQ(r.name, in.text("name"));
    EXPECT_EQ(r.confidence, in.text("confidence"));
    if (in.text("label").substr(0, 1) == "C") {
      EXPECT_EQ(table().index(in.text("label")), i);
    }
    // Get in classes 0x66 to 0x79, which the option sees to; class 0x29, 140 and 141, writes it (FR-A7NE manual 7.5).
    constexpr std::uint16_t kAssemblySelection = 346;
    EXPECT_EQ(r.network_read_only, in.text("access") == "R" && r.id.number != kAssemblySelection);
    if (in.text("min").empty()) {
      // The reference has no range: manufacturer settings, and the two meters whose gain is chosen here.
      EXPECT_TRUE(r.kind == ParameterKind::kManufacturer || r.id.number == 900 || r.id.number == 901);
      continue;
    }
    EXPECT_EQ(r.unit, in.text("unit"));
    EXPECT_EQ(raw_to_text(1, r.decimals), in.text("increment"));
    EXPECT_EQ(r.raw_minimum, text_to_raw(in.text("min"), r.decimals));
    EXPECT_EQ(r.raw_maximum, text_to_raw(in.text("max"), r.decimals));
    EXPECT_EQ(r.special_text, in.text("special"));
    EXPECT_EQ(r.write_while_running, in.text("write_while_running") == "yes");
    EXPECT_EQ(r.write_while_running_free, in.text("write_while_running_pr77_2") == "yes");
    EXPECT_DOUBLE_EQ(store.physical(i, store.factory_raw(i)), in.number("default"));
  }
}

// Every value of every row travels in one word of its own scale, so no wire scale beyond the increment is needed:
// Pr.37 counts whole units up to 9998, times of 3600 s count 0.1 s.
TEST(A700Parameters, EveryRangeFitsOneWord) {
  for (const ParameterRow& r : table().rows()) {
    EXPECT_GE(r.raw_minimum, 0) << r.label;
    EXPECT_LE(r.raw_maximum, 65535) << r.label;
  }
  EXPECT_EQ(row(37).raw_maximum, 9998);
  EXPECT_EQ(row(37).decimals, 0);
  EXPECT_EQ(row(7).raw_maximum, 36000);
}

TEST(A700Parameters, EveryFactoryValueOfEveryModelIsAccepted) {
  for (const ModelRow& model : a700::family_data().models) {
    const auto defaults = table_of(model).defaults(model);
    for (std::size_t i = 0; i < defaults.size(); ++i) {
      const ParameterRow& r = table_of(model).rows()[i];
      if (r.kind == ParameterKind::kManufacturer) continue;
      EXPECT_TRUE(r.accepts(defaults[i])) << model.model << " " << r.label << " " << defaults[i];
    }
  }
}

TEST(A700Parameters, DefaultsFollowTheModel) {
  const auto value = [](std::string_view model, unsigned number) { return store_of(model).value(number); };
  EXPECT_EQ(value("FR-A740-0.4K", 0), 6);
  EXPECT_EQ(value("FR-A740-11K", 0), 2);
  EXPECT_EQ(value("FR-A740-7.5K", 7), 5);
  EXPECT_EQ(value("FR-A740-11K", 8), 15);
  EXPECT_DOUBLE_EQ(value("FR-A740-0.75K", 9), 2.13);  // 85 % of 2.5 A
  EXPECT_EQ(value("FR-A740-15K", 9), 31.0);
  EXPECT_EQ(value("FR-A720-15K", 56), 61.0);
  EXPECT_EQ(value("FR-A720-15K", 83), 200);
  EXPECT_EQ(value("FR-A720-15K", 883), 380);
  EXPECT_EQ(value("FR-A740-15K", 883), 760);
  EXPECT_EQ(value("FR-A740-15K", 893), 15);
  EXPECT_EQ(value("FR-A740-15K", 12), 2);
  EXPECT_EQ(value("FR-A740-55K", 9), 110);
  EXPECT_EQ(value("FR-A740-55K", 1), 120);
  EXPECT_EQ(value("FR-A740-75K", 0), 1);
  EXPECT_EQ(value("FR-A740-75K", 1), 60);
  EXPECT_EQ(value("FR-A740-75K", 7), 15);
  EXPECT_EQ(value("FR-A740-75K", 9), 144);
  EXPECT_EQ(value("FR-A740-75K", 12), 1);
  EXPECT_EQ(value("FR-A740-75K", 18), 60);
  EXPECT_EQ(value("FR-A740-75K", 611), 15);
  EXPECT_EQ(value("FR-A740-75K", 893), 75);
}

TEST(A700Parameters, LargeModelsCountCurrentsAndPowersInTenths) {
  const ParameterTable& large = a700::family_data(true).parameters;
  const auto at = [&](unsigned number) {
    return large.rows()[*large.index(port::ParameterId{static_cast<std::uint16_t>(number), 0})];
  };
  for (unsigned number : {9u, 51u, 56u, 61u, 80u, 82u, 453u, 455u, 557u, 859u, 860u, 893u}) {
    EXPECT_EQ(at(number).decimals, 1) << number;
    EXPECT_EQ(at(number).raw_maximum, 36000) << number;
    EXPECT_EQ(row(number).decimals, 2) << number;
  }
  EXPECT_EQ(at(57).raw_maximum, 300);
  EXPECT_EQ(at(70).raw_maximum, 100);
  EXPECT_EQ(at(276).raw_maximum, 4);
  EXPECT_TRUE(at(72).accepts(25));
  EXPECT_FALSE(at(72).accepts(7));
  EXPECT_FALSE(row(72).accepts(25));
  ParameterTable copy = table();
  EXPECT_FALSE(copy.take_ranges("pr,increment,min,max,allowed\n9,0.3,0,1,\n").has_value());
  EXPECT_FALSE(copy.take_ranges("pr,increment,min,max,allowed\n999,1,0,1,\n").has_value());
  EXPECT_FALSE(copy.take_ranges("pr,increment,min,max,allowed\n9,1,5,1,\n").has_value());
  EXPECT_FALSE(copy.take_ranges("pr,increment,min,max,allowed\n9,1,5,6,\n").has_value()) << "default outside";
  EXPECT_FALSE(copy.take_ranges("pr,increment,min,max,allowed\n72,1,0,9,x\n").has_value());
}

TEST(A700Parameters, AllowedSetsHaveHoles) {
  for (int v : {0, 3, 14, 17}) EXPECT_TRUE(row(75).accepts(v)) << v;
  for (int v : {4, 13, 18}) EXPECT_FALSE(row(75).accepts(v)) << v;
  EXPECT_FALSE(row(79).accepts(5));
  for (int v : {0, 1, 2, 10, 12}) EXPECT_TRUE(row(340).accepts(v)) << v;
  for (int v : {3, 9, 11, 13}) EXPECT_FALSE(row(340).accepts(v)) << v;
  // STF and STR may be given to their own terminals only, PTC to AU only.
  EXPECT_TRUE(row(178).accepts(60));
  EXPECT_FALSE(row(179).accepts(60));
  EXPECT_FALSE(row(180).accepts(61));
  EXPECT_TRUE(row(184).accepts(63));
  EXPECT_FALSE(row(183).accepts(63));
  EXPECT_TRUE(row(190).accepts(92));
  EXPECT_FALSE(row(195).accepts(92));
  EXPECT_TRUE(row(195).accepts(199));
  EXPECT_FALSE(row(190).accepts(9));
  EXPECT_TRUE(row(67).accepts(110));
  EXPECT_FALSE(row(67).accepts(11));
  EXPECT_TRUE(row(250).accepts(kRaw8888));
}

TEST(A700Parameters, CalibrationsAreFoundByTheirPanelNames) {
  EXPECT_EQ(row(902, 2).alias, "C3");
  EXPECT_EQ(table().index("C3"), table().index("Pr.902.2"));
  EXPECT_EQ(table().index("C5"), table().index("Pr.904.1"));
  EXPECT_FALSE(table().index("C99").has_value());
}

// FR-A7NE manual 7.10: these are Get only; the panel writes them.
TEST(A700Parameters, TheNetworkMayNotWriteWhatTheManualMarksAsGet) {
  AccessSituation net{.writer = Writer::kNetwork, .mode = port::OperationMode::kNetwork};
  AccessSituation panel{.writer = Writer::kPanel, .mode = port::OperationMode::kPu};
  for (unsigned number : {77u, 79u, 173u, 174u, 345u}) {
    EXPECT_EQ(write_refusal(row(number), net), port::Refusal::kReadOnly) << number;
    EXPECT_EQ(write_refusal(row(number), panel), std::nullopt) << number;
  }
  for (unsigned number : {255u, 256u, 257u, 258u, 563u, 564u}) {
    EXPECT_EQ(write_refusal(row(number), panel), port::Refusal::kReadOnly) << number;
  }
  EXPECT_EQ(write_refusal(row(259), panel), std::nullopt);
  // The option's classes 0x66 to 0x79 refuse it; 140 and 141 of class 0x29 write it (7.5.1).
  EXPECT_EQ(write_refusal(row(346), net), std::nullopt);
}

TEST(A700Parameters, Pr340IsWrittenFromThePanelInEveryMode) {
  for (auto mode : {port::OperationMode::kExternal, port::OperationMode::kPu, port::OperationMode::kNetwork}) {
    AccessSituation s{.writer = Writer::kPanel, .mode = mode};
    EXPECT_EQ(write_refusal(row(340), s), std::nullopt);
    EXPECT_EQ(write_refusal(row(7), s).has_value(), mode != port::OperationMode::kPu);
  }
}

TEST(A700Parameters, CommunicationAndCalibrationAreMarkedForTheClears) {
  for (unsigned number : {117u, 339u, 434u, 445u, 500u, 540u, 550u}) EXPECT_TRUE(row(number).communication) << number;
  for (unsigned number : {0u, 79u, 178u, 505u, 888u}) EXPECT_FALSE(row(number).communication) << number;
  EXPECT_EQ(row(902, 1).clear, ClearRule::kAllClearOnly);
  EXPECT_EQ(row(75).clear, ClearRule::kNever);
  EXPECT_TRUE(row(805).ram_only);
  EXPECT_FALSE(row(806).ram_only);
}

TEST(A700Parameters, RowsWithoutEffectSayWhy) {
  for (const ParameterRow& r : table().rows()) {
    EXPECT_EQ(r.acts, r.effect.substr(0, 9) != "Nothing: ") << r.label;
  }
}

TEST(A700Parameters, LoaderRefusesWrongFieldsOfTheWiderFormat) {
  const auto load = [](std::string_view access, std::string_view communication, std::string_view storage,
                       std::string_view rule) {
    return ParameterTable::load(
        "pr,sub,alias,name,min,max,special,allowed,increment,fine_increment,unit,default,model_default,"
        "write_while_running,write_while_running_pr77_2,write_when_locked,panel_any_mode,access,network_access,kind,"
        "clear,communication,storage,source,confidence,notes,acts,effect\n"
        "7,0,,x,0,10,,,1,,s,5," +
        std::string(rule) + ",no,yes,no,no,RW," + std::string(access) + ",ordinary,," + std::string(communication) +
        "," + std::string(storage) + ",x,high,,yes,x\n");
  };
  EXPECT_TRUE(load("RW", "no", "", "").has_value());
  EXPECT_THAT(load("X", "no", "", "").error(), HasSubstr("line 2, network_access"));
  EXPECT_THAT(load("R", "maybe", "", "").error(), HasSubstr("line 2, communication"));
  EXPECT_THAT(load("R", "no", "disk", "").error(), HasSubstr("line 2, storage"));
}

TEST(A700Alarms, EveryReferenceRowIsCarried) {
  const CsvTable rows = reference("a700_alarms_reference.csv");
  const AlarmTable& alarms = a700::family_data().alarms;
  CsvReader in(rows);
  ASSERT_EQ(alarms.rows().size(), in.size());
  for (std::size_t i = 0; i < in.size(); ++i) {
    in.select(i);
    const auto at = alarms.by_name(in.text("name"));
    ASSERT_TRUE(at.has_value()) << in.text("name");
    const AlarmRow& r = alarms.rows()[*at];
    SCOPED_TRACE(r.name);
    EXPECT_EQ(r.code, in.integer("data_code_hex", 16));
    std::uint32_t settings = 0;
    for (std::string_view s : split(in.text("retry_pr65"), '|')) settings |= 1u << (s[0] - '0');
    EXPECT_EQ(r.retry_settings, settings);
    EXPECT_FALSE(r.cause.empty());
    // Four digits; the point belongs to the first.
    EXPECT_EQ(r.display.size(), 5u);
  }
  EXPECT_EQ(alarms.rows()[*alarms.by_name("E.3")].display, "E.  3");
  EXPECT_EQ(alarms.rows()[*alarms.by_name("E.OC1")].display, "E.OC1");
}

TEST(A700Terminals, HaveTheFunctionsOfTheFamilyInBothSenses) {
  const SignalMap& map = a700::family_data().signals;
  EXPECT_EQ(map.inputs().size(), 45u);
  EXPECT_EQ(map.outputs().size(), 53u);
  EXPECT_EQ(map.input(60), InputSignal::kStf);
  EXPECT_EQ(map.input(24), InputSignal::kMrs);
  EXPECT_FALSE(map.input(21).has_value());
  EXPECT_EQ(map.output(99)->signal, OutputSignal::kAbc);
  EXPECT_FALSE(map.output(99)->inverted);
  EXPECT_EQ(map.output(199)->signal, OutputSignal::kAbc);
  EXPECT_TRUE(map.output(199)->inverted);
  EXPECT_FALSE(map.output(117).has_value());  // MC1 has no negative logic
}

TEST(A700Terminals, EveryFunctionIsAllowedForItsParameters) {
  const SignalMap& map = a700::family_data().signals;
  for (const TerminalFunction& f : map.inputs()) {
    const unsigned of = f.number == 60 ? 178 : f.number == 61 ? 179 : 184;
    EXPECT_TRUE(row(of).accepts(f.number)) << f.signal;
  }
  for (const TerminalFunction& f : map.outputs()) EXPECT_TRUE(row(190).accepts(f.number)) << f.signal;
}

TEST(A700Monitors, AreThoseOfTheManual) {
  std::set<unsigned> codes;
  for (const a700::MonitorRow& m : a700::monitors()) codes.insert(m.code);
  EXPECT_EQ(codes, (std::set<unsigned>{1,  2,  3,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16, 17, 18, 19,
                                       20, 22, 23, 24, 25, 32, 33, 34, 35, 50, 51, 52, 53, 54, 58, 59, 60}));
  EXPECT_FALSE(a700::load_monitors("code,name,unit,increment\n1,x,Hz,0.5\n").has_value());
  EXPECT_FALSE(a700::load_monitors("code,name,unit,increment\n1,x,Hz,1\n1,y,Hz,1\n").has_value());
  EXPECT_FALSE(a700::load_monitors("code,name,unit,increment\n0,x,Hz,1\n").has_value());
}

TEST(A700Models, AreThoseOfTheFamilyWithCircuitsThatGrow) {
  const auto& models = a700::family_data().models;
  ASSERT_EQ(models.size(), 34u);
  for (std::size_t i = 1; i < models.size(); ++i) {
    if (models[i].voltage_class_v != models[i - 1].voltage_class_v) continue;
    EXPECT_GT(models[i].rated_current_a_rms, models[i - 1].rated_current_a_rms) << models[i].model;
    EXPECT_GT(models[i].dc_link_capacitance_f, models[i - 1].dc_link_capacitance_f) << models[i].model;
    EXPECT_LT(models[i].heat_sink_k_per_w, models[i - 1].heat_sink_k_per_w) << models[i].model;
  }
}

}  // namespace
}  // namespace vinv::inverter
