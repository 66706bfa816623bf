// The tables of the tree against an independent copy of the reference rows (data/*_reference.csv), and their loaders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "motor_model/inverter/csv.hpp"
#include "motor_model/inverter/e500/inverter.hpp"
#include "tests/motor_model/inverter/reference_rows.hpp"

namespace vinv::inverter {
namespace {

using testing::HasSubstr;

TEST(ParameterTable, EveryReferenceRowIsCarriedWithRangeDefaultAndAccess) {
  const CsvTable table = reference("e500_parameters_reference.csv");
  const auto& parameters = e500::family_data().parameters;
  const ModelRow* model = find_model(e500::family_data().models, "FR-E540-0.4K");  // the reference unit
  ASSERT_NE(model, nullptr);
  const ParameterStore store(parameters, *model);
  CsvReader in(table);
  for (std::size_t i = 0; i < in.size(); ++i) {
    in.select(i);
    const auto row = parameters.index(
        port::ParameterId{static_cast<std::uint16_t>(in.integer("pr")), static_cast<std::uint8_t>(in.integer("sub"))});
    ASSERT_TRUE(row.has_value()) << in.text("pr");
    const ParameterRow& r = parameters.rows()[*row];
    SCOPED_TRACE(r.label);
    EXPECT_EQ(r.name, in.text("name"));
    EXPECT_EQ(r.source, in.text("source"));
    EXPECT_EQ(r.confidence, in.text("confidence"));
    EXPECT_FALSE(r.effect.empty());
    EXPECT_EQ(r.read_only, in.text("access") == "RO");
    if (in.text("min").empty()) {
      // The reference has no range: manufacturer settings, and Pr.901 whose gain is chosen here.
      EXPECT_TRUE(r.kind == ParameterKind::kManufacturer || r.id.number == 901);
      continue;
    }
    EXPECT_EQ(r.unit, in.text("unit"));
    EXPECT_EQ(raw_to_text(1, r.decimals), in.text("increment"));
    EXPECT_EQ(r.raw_minimum, text_to_raw(in.text("min"), r.decimals));
    EXPECT_EQ(r.raw_maximum, text_to_raw(in.text("max"), r.decimals));
    EXPECT_EQ(r.special_text, in.text("special"));
    EXPECT_EQ(r.write_while_running, in.text("write_while_running") == "yes");
    EXPECT_EQ(r.write_while_running_free, in.text("write_while_running_pr77_2") == "yes");
    EXPECT_DOUBLE_EQ(store.physical(*row, store.factory_raw(*row)), in.number("default"));
    // The reference prints the set of values in its notes: "allowed set: 0-3,14-17".
    const std::string& notes = in.text("notes");
    if (const auto at = notes.find("allowed set: "); at != std::string::npos) {
      std::string allowed = notes.substr(at + 13, notes.find(';') - at - 13);
      if (r.has_9999) allowed.erase(allowed.find(",8888"));  // the specials have a column of their own
      EXPECT_EQ(r.allowed_text, allowed);
    }
  }
  EXPECT_EQ(parameters.rows().size(), in.size());
}

TEST(ParameterTable, EveryFactoryValueOfEveryModelIsAccepted) {
  const auto& data = e500::family_data();
  for (const ModelRow& model : data.models) {
    const auto defaults = data.parameters.defaults(model);
    for (std::size_t i = 0; i < defaults.size(); ++i) {
      const ParameterRow& r = data.parameters.rows()[i];
      if (r.kind == ParameterKind::kManufacturer) continue;
      EXPECT_TRUE(r.accepts(defaults[i])) << model.model << " " << r.label;
    }
  }
}

TEST(ParameterTable, DefaultsFollowTheModel) {
  const auto& data = e500::family_data();
  const auto value = [&](std::string_view model, unsigned number) {
    return ParameterStore(data.parameters, *find_model(data.models, model)).value(number);
  };
  EXPECT_EQ(value("FR-E540-0.4K", 0), 6);
  EXPECT_EQ(value("FR-E540-1.5K", 0), 4);
  EXPECT_EQ(value("FR-E540-7.5K", 0), 3);
  EXPECT_EQ(value("FR-E540-3.7K", 7), 5);
  EXPECT_EQ(value("FR-E540-5.5K", 7), 10);
  EXPECT_EQ(value("FR-E540-1.5K", 9), 4.0);
  EXPECT_EQ(value("FR-E520-7.5K", 9), 33.0);
  EXPECT_EQ(value("FR-E520-7.5K", 83), 200);
  EXPECT_EQ(value("FR-E540-7.5K", 83), 400);
}

TEST(ParameterTable, RowsWithoutEffectSayWhy) {
  std::set<unsigned> idle;
  for (const ParameterRow& r : e500::family_data().parameters.rows()) {
    if (r.acts) continue;
    idle.insert(r.id.number);
    EXPECT_THAT(r.effect, HasSubstr("Nothing: ")) << r.label;
  }
  EXPECT_EQ(idle, (std::set<unsigned>{117, 118, 119, 120, 121, 122, 123, 124, 145, 146, 168, 169, 240, 990, 991}));
}

TEST(ParameterTable, AllowedSetsHaveHoles) {
  const auto& table = e500::family_data().parameters;
  const auto accepts = [&](unsigned number, std::int64_t raw) {
    return table.rows()[*table.index(port::ParameterId{static_cast<std::uint16_t>(number), 0})].accepts(raw);
  };
  for (int v : {0, 3, 14, 17}) EXPECT_TRUE(accepts(75, v)) << v;
  for (int v : {-1, 4, 13, 18}) EXPECT_FALSE(accepts(75, v)) << v;
  EXPECT_FALSE(accepts(79, 5));
  EXPECT_TRUE(accepts(79, 8));
  EXPECT_FALSE(accepts(17, 1));
  EXPECT_TRUE(accepts(250, 10000));  // 1000.0 s
  EXPECT_FALSE(accepts(250, 1001));  // 100.1 s
  EXPECT_TRUE(accepts(250, kRaw8888));
  EXPECT_TRUE(accepts(250, kRaw9999));
  EXPECT_FALSE(accepts(250, 9999));
  EXPECT_FALSE(accepts(7, kRaw9999));
}

TEST(ParameterTable, IsFoundByNumberAndByName) {
  const auto& table = e500::family_data().parameters;
  EXPECT_EQ(table.rows()[*table.index("Pr.7")].id.number, 7);
  EXPECT_EQ(table.rows()[*table.index("7")].id.number, 7);
  EXPECT_EQ(table.rows()[*table.index("Pr.902.2")].id.sub, 2);
  for (std::string_view bad : {"", "Pr.", "Pr.28", "Pr.1000", "Pr.902", "Pr.902.3", "Pr.7.1", "7x", "Pr.-1"}) {
    EXPECT_FALSE(table.index(bad).has_value()) << bad;
  }
  EXPECT_TRUE(table.has_number(905));
  EXPECT_FALSE(table.has_number(28));
  EXPECT_FALSE(table.has_number(70000));
}

// A table with one row in which one field is wrong.
std::string table_with(const std::string& column, const std::string& value) {
  std::vector<std::pair<std::string, std::string>> fields{{"pr", "7"},
                                                          {"sub", "0"},
                                                          {"name", "Acceleration time"},
                                                          {"min", "0"},
                                                          {"max", "3600"},
                                                          {"special", ""},
                                                          {"allowed", ""},
                                                          {"increment", "0.1"},
                                                          {"fine_increment", ""},
                                                          {"unit", "s"},
                                                          {"default", "5"},
                                                          {"model_default", ""},
                                                          {"write_while_running", "no"},
                                                          {"write_while_running_pr77_2", "yes"},
                                                          {"write_when_locked", "no"},
                                                          {"panel_any_mode", "no"},
                                                          {"access", "RW"},
                                                          {"kind", "ordinary"},
                                                          {"clear", ""},
                                                          {"source", "x"},
                                                          {"confidence", "high"},
                                                          {"notes", ""},
                                                          {"acts", "yes"},
                                                          {"effect", "x"}};
  std::string header;
  std::string row;
  for (auto& [name, text] : fields) {
    header += (header.empty() ? "" : ",") + name;
    row += (row.empty() ? "" : ",") + ("\"" + (name == column ? value : text) + "\"");
  }
  return header + "\n" + row + "\n";
}

TEST(ParameterTable, LoaderRefusesWrongFieldsWithLineAndColumn) {
  ASSERT_TRUE(ParameterTable::load(table_with("", "")).has_value());
  const std::pair<std::string, std::string> wrong[] = {{"pr", "1000"},
                                                       {"pr", "x"},
                                                       {"sub", "3"},
                                                       {"sub", "2"},
                                                       {"min", "4000"},
                                                       {"max", ""},
                                                       {"special", "7777"},
                                                       {"allowed", "3-1"},
                                                       {"allowed", "a"},
                                                       {"increment", "0.2"},
                                                       {"fine_increment", "21"},
                                                       {"fine_increment", "21=1:0.01"},
                                                       {"default", "4000"},
                                                       {"default", "9999"},
                                                       {"write_while_running", "maybe"},
                                                       {"access", "X"},
                                                       {"kind", "odd"},
                                                       {"clear", "odd"},
                                                       {"acts", ""},
                                                       {"effect", ""},
                                                       {"name", ""}};
  for (const auto& [column, value] : wrong) {
    const auto loaded = ParameterTable::load(table_with(column, value));
    ASSERT_FALSE(loaded.has_value()) << column << "=" << value;
    EXPECT_FALSE(loaded.error().empty());
  }
  EXPECT_THAT(ParameterTable::load(table_with("increment", "0.2")).error(), HasSubstr("line 2, increment"));
}

TEST(Decimals, TextAndRawAreExact) {
  EXPECT_EQ(raw_to_text(5, 0), "5");
  EXPECT_EQ(raw_to_text(5, 2), "0.05");
  EXPECT_EQ(raw_to_text(12345, 2), "123.45");
  EXPECT_EQ(text_to_raw("5", 1), 50);
  EXPECT_EQ(text_to_raw("5.0", 1), 50);
  EXPECT_EQ(text_to_raw("5.00", 1), 50);
  EXPECT_EQ(text_to_raw("0.05", 2), 5);
  for (const char* bad : {"", ".", "5.", ".5", "5.01", "-1", "5 ", "1e3", "0x5", "9999999999"}) {
    EXPECT_FALSE(text_to_raw(bad, 1).has_value()) << bad;
  }
}

TEST(AlarmTable, EveryReferenceRowIsCarried) {
  const CsvTable table = reference("e500_alarms_reference.csv");
  const AlarmTable& alarms = e500::family_data().alarms;
  CsvReader in(table);
  for (std::size_t i = 0; i < in.size(); ++i) {
    in.select(i);
    const auto row = alarms.by_name(in.text("name"));
    ASSERT_TRUE(row.has_value()) << in.text("name");
    const AlarmRow& r = alarms.rows()[*row];
    SCOPED_TRACE(r.name);
    EXPECT_EQ(r.code, in.integer("data_code_hex", 16));
    EXPECT_EQ(r.emergency_code, in.integer("canopen_emcy_code_hex", 16));
    EXPECT_EQ(r.error_register, in.integer("error_register_1001h_value_hex", 16));
    std::uint32_t settings = 0;
    for (std::string_view s : split(in.text("retry_allowed_e500_pr65"), '|')) {
      if (s != "none") settings |= 1u << (s[0] - '0') & 0xFu;  // Pr.65 goes to 3
    }
    EXPECT_EQ(r.retry_settings & 0xFu, settings);
  }
  EXPECT_EQ(alarms.rows().size(), in.size());
}

TEST(AlarmHistory, NewestComesFirstAndTheOldestFallsOff) {
  port::AlarmHistory history{};
  for (std::uint8_t code = 1; code <= 9; ++code) push_alarm(history, code);
  EXPECT_EQ(history, (port::AlarmHistory{9, 8, 7, 6, 5, 4, 3, 2}));
}

TEST(SignalMap, HasTheFunctionsOfTheFamily) {
  const SignalMap& map = e500::family_data().signals;
  EXPECT_EQ(map.input(3), InputSignal::kRt);
  EXPECT_EQ(map.input(18), InputSignal::kX18);
  EXPECT_FALSE(map.input(9).has_value());
  EXPECT_EQ(map.output(0)->signal, OutputSignal::kRun);
  EXPECT_EQ(map.output(99)->signal, OutputSignal::kAbc);
  EXPECT_FALSE(map.output(-1).has_value());
}

TEST(Models, AreThoseOfTheFamilies) {
  EXPECT_EQ(models("fr-e500").size(), 16u);
  EXPECT_EQ(models("fr-a700").size(), 34u);
  EXPECT_EQ(models("fr-x").size(), 0u);
  EXPECT_THAT(families(), testing::ElementsAre("fr-e500", "fr-a700"));
}

TEST(Csv, QuotesCommasAndMistakes) {
  const auto table = parse_csv("a,b\n1,\"x, \"\"y\"\"\"\n");
  ASSERT_TRUE(table.has_value());
  EXPECT_EQ(table->rows[0][1], "x, \"y\"");
  EXPECT_EQ(parse_csv("a,b\n1\n").error(), "line 2: 1 fields, the header has 2");
  EXPECT_EQ(parse_csv("a,b\n1,\"x\n").error(), "line 2: quotes do not match");
  EXPECT_EQ(parse_csv("").error(), "no header line");
}

}  // namespace
}  // namespace vinv::inverter
