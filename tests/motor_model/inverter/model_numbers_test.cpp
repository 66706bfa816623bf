// Every model with its motor and factory settings: a start, rated load, a stop, and what monitors and heat sink say.
#include <numbers>

#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

struct Model {
  std::string_view model;
  std::string_view machine;
  double scale = 1;  // of the machine's power, for models smaller than the smallest preset
  double rated_a_rms = 0;
};
std::ostream& operator<<(std::ostream& out, const Model& m) { return out << m.model; }

constexpr Model kModels[] = {
    {"FR-E520-0.1K", "iec4p_0k4kW_200V", 0.25, 0.8}, {"FR-E520-0.2K", "iec4p_0k4kW_200V", 0.5, 1.5},
    {"FR-E520-0.4K", "iec4p_0k4kW_200V", 1, 3},      {"FR-E520-0.75K", "iec4p_0k75kW_200V", 1, 5},
    {"FR-E520-1.5K", "iec4p_1k5kW_200V", 1, 8},      {"FR-E520-2.2K", "iec4p_2k2kW_200V", 1, 11},
    {"FR-E520-3.7K", "iec4p_3k7kW_200V", 1, 17.5},   {"FR-E520-5.5K", "iec4p_5k5kW_200V", 1, 24},
    {"FR-E520-7.5K", "iec4p_7k5kW_200V", 1, 33},     {"FR-E540-0.4K", "iec4p_0k4kW_400V", 1, 1.6},
    {"FR-E540-0.75K", "iec4p_0k75kW_400V", 1, 2.6},  {"FR-E540-1.5K", "iec4p_1k5kW_400V", 1, 4},
    {"FR-E540-2.2K", "iec4p_2k2kW_400V", 1, 6},      {"FR-E540-3.7K", "iec4p_3k7kW_400V", 1, 9.5},
    {"FR-E540-5.5K", "iec4p_5k5kW_400V", 1, 12},     {"FR-E540-7.5K", "iec4p_7k5kW_400V", 1, 17},
};

// A smaller motor of the same kind: the same voltages and slip, currents and inertia in proportion.
plant::MachineParameters scaled(plant::MachineParameters m, double k) {
  m.R_s_ohm /= k;
  m.R_r_ohm /= k;
  m.L_ls_h /= k;
  m.L_lr_h /= k;
  m.L_m_h /= k;
  m.inertia_kg_m2 *= k;
  m.rated_current_a_rms *= k;
  m.rated_power_w *= k;
  return m;
}

double rated_torque_nm(const plant::MachineParameters& m) {
  return m.rated_power_w / (m.rated_speed_rpm * std::numbers::pi / 30);
}

InverterConfig factory(const Model& m, double load_of_rated) {
  InverterConfig c = config_for(std::string(m.model), m.machine);
  c.motor = scaled(c.motor, m.scale);
  c.load.inertia_kg_m2 = 2 * c.motor.inertia_kg_m2;
  c.load.constant_nm = load_of_rated * rated_torque_nm(c.motor);
  return c;
}

class ModelNumbers : public testing::TestWithParam<Model> {};

TEST_P(ModelNumbers, StartRatedLoadAndStopArePlausibleWithFactorySettings) {
  const Model& model = GetParam();
  for (const double load : {0.0, 1.0}) {
    SCOPED_TRACE(testing::Message() << "load " << load);
    const InverterConfig config = factory(model, load);
    const plant::MachineParameters& motor = config.motor;
    const double class_v = motor.rated_voltage_v_rms;
    Bench b(config);
    b.preset("Pr.4", 50);
    b.power_on();
    b.terminal("RH");
    b.terminal("STF");
    const double begin_s = b.now_s();
    const double ramp_s = b->get_parameter("Pr.7").value();
    double highest_a = 0;
    bool overload = false;
    ASSERT_TRUE(b.run_until(
        [&] {
          highest_a = std::max(highest_a, b->plant().measurements().output_current_a_rms);
          overload = overload || b.port().status().overload;
          return b.output_hz() >= 50 || !b->alarm_name().empty();
        },
        12));
    ASSERT_EQ(b->alarm_name(), "") << b->alarm_cause();
    EXPECT_NEAR(b.now_s() - begin_s, ramp_s, 0.06 * ramp_s);
    // Breaking a full dry load away may just touch stall prevention where the drive has little to spare.
    EXPECT_TRUE(!overload || highest_a > 1.49 * model.rated_a_rms);
    EXPECT_LT(highest_a, 1.55 * model.rated_a_rms);
    EXPECT_LT(highest_a, 1.7 * motor.rated_current_a_rms);

    b.run(2);
    // What the user reads.
    EXPECT_EQ(b.output_hz(), 50);
    EXPECT_NEAR(b.output_v(), 0.95 * class_v, 0.01 * class_v);  // Pr.19 = 8888
    const double slip = 1 - b.signal("speed") / 1500;
    const double rated_slip = 1 - motor.rated_speed_rpm / 1500;
    const double current = b.output_a() / motor.rated_current_a_rms;
    if (load == 0) {
      EXPECT_GT(current, 0.4);
      EXPECT_LT(current, 0.7);
      EXPECT_LT(slip, 0.1 * rated_slip);
    } else {
      EXPECT_NEAR(current, 1, 0.04);
      EXPECT_NEAR(slip, rated_slip / 0.9, 0.1 * rated_slip);  // 5 % less voltage, 10 % more slip
      EXPECT_NEAR(b.signal("torque"), rated_torque_nm(motor), 0.04 * rated_torque_nm(motor));
      EXPECT_NEAR(b.signal("shaft_power"), motor.rated_power_w, 0.03 * motor.rated_power_w);
      const double motor_efficiency = b.signal("shaft_power") / b.signal("output_power");
      EXPECT_GT(motor_efficiency, 0.72);
      EXPECT_LT(motor_efficiency, 0.95);
      const double drive_efficiency = b.signal("output_power") / b.signal("input_power");
      EXPECT_GT(drive_efficiency, 0.75);  // the smallest ones live on their control supply
      EXPECT_LT(drive_efficiency, 0.98);
    }
    EXPECT_NEAR(b.signal("dc_link"), class_v * std::numbers::sqrt2, 0.04 * class_v * std::numbers::sqrt2);

    b.terminal("STF", false);
    ASSERT_TRUE(b.run_until([&] { return !b.port().status().running && std::abs(b.signal("speed")) < 1; }, 14));
    EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
  }
}

std::string model_name(const testing::TestParamInfo<Model>& of) {
  std::string name(of.param.model);
  for (char& c : name) {
    if (c == '-' || c == '.') c = c == '-' ? 'X' : 'p';
  }
  return name;
}
INSTANTIATE_TEST_SUITE_P(Table, ModelNumbers, testing::ValuesIn(kModels), model_name);

// --- carrier and fan ---

// At the 40 degC up to which drives carry their rated current, for three time constants of the heat sink.
TEST(Cooling, AHighCarrierCostsRatedCurrentInAWarmPlace) {
  const auto end_of_load = [](double carrier) {
    InverterConfig c = factory(kModels[11], 1.2);  // 1.2: up to the inverter's own rated current
    c.ambient_c = 40;
    Bench b(c);
    b.preset("Pr.72", carrier);
    b.preset("Pr.4", 50);
    b.power_on();
    b.terminal("RH");
    b.terminal("STF");
    b.run_until([&] { return !b->alarm_name().empty(); }, 900);
    return std::pair{b->alarm_name(), b.signal("heat_sink")};
  };
  const auto [default_alarm, default_c] = end_of_load(1);
  EXPECT_EQ(default_alarm, "");
  EXPECT_LT(default_c, 80);
  const auto [high_alarm, high_c] = end_of_load(15);
  EXPECT_EQ(high_alarm, "E.FIN");
  EXPECT_GE(high_c, 94.9);
}

TEST(Cooling, TheCarrierIsPartOfTheLossesAtOnce) {
  InverterConfig c = factory(kModels[11], 1);
  Bench b(c);
  b.preset("Pr.4", 50);
  b.power_on();
  b.terminal("RH");
  b.terminal("STF");
  b.run(8);
  const double input_w = b.signal("input_power");
  b.terminal("STF", false);
  b.run(8);
  b.pu();
  ASSERT_TRUE(b->set_parameter("Pr.72", 15).has_value());
  b.key(PanelKey::kPuExt);
  b.terminal("STF");
  b.run(8);
  const double more_w = b.signal("input_power") - input_w;
  const double apparent_w = std::sqrt(3) * b.signal("output_voltage") * b.signal("output_current");
  EXPECT_NEAR(more_w, 0.03 * 0.1 * 13.5 * apparent_w, 0.1 * more_w);
  EXPECT_EQ(b.signal("carrier"), 14'500);
}

TEST(Cooling, TheFanMayRestWhileTheDriveDoes) {
  InverterConfig c = factory(kModels[11], 1.2);
  c.ambient_c = 40;
  Bench b(c);
  b.preset("Pr.244", 1);
  b.preset("Pr.72", 15);
  b.preset("Pr.4", 50);
  b.power_on();
  EXPECT_EQ(b.signal("fan"), 0);
  b.terminal("RH");
  b.terminal("STF");
  b.run(1);
  EXPECT_EQ(b.signal("fan"), 1);
  ASSERT_TRUE(b.run_until([&] { return b.signal("heat_sink") > 61; }, 300));
  b.terminal("STF", false);
  b.run(10);
  EXPECT_EQ(b.signal("fan"), 1);  // still hot
  ASSERT_TRUE(b.run_until([&] { return b.signal("fan") == 0; }, 400));
  EXPECT_NEAR(b.signal("heat_sink"), 50, 0.1);
  // In still air the time constant of 300 s is three times as long.
  b.run(90);
  EXPECT_NEAR(b.signal("heat_sink"), 40 + 10 * std::exp(-0.1), 0.1);
}

TEST(Cooling, WithPr244At0TheFanAlwaysRuns) {
  Bench b(factory(kModels[11], 0));
  b.power_on();
  EXPECT_EQ(b.signal("fan"), 1);
}

}  // namespace
}  // namespace vinv::inverter::test
