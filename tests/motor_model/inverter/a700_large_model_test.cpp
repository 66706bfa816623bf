// Models of 75K and up: currents in 0.1 A and powers in 0.1 kW, at the port, in the parameters and through the option
// board. FR-A7NE manual 7.2.1 (note 1), 7.4, 7.6.
#include "a700_bench.hpp"
#include "option_boards/boards/fr_a7ne/cip_unit.hpp"

namespace vinv::inverter::test {
namespace {

// Five motors of 15 kW side by side make one of 75 kW.
InverterConfig config_75k() {
  InverterConfig c = config_for("FR-A740-75K", "iec4p_15kW_400V");
  c.motor.name = "75 kW";
  for (double* value : {&c.motor.R_s_ohm, &c.motor.R_r_ohm, &c.motor.L_ls_h, &c.motor.L_lr_h, &c.motor.L_m_h})
    *value /= 5;
  for (double* value : {&c.motor.inertia_kg_m2, &c.motor.rated_power_w, &c.motor.rated_current_a_rms}) *value *= 5;
  c.load.constant_nm = 200;
  return c;
}
const Settings kRamps{{"Pr.7", 2}};

TEST(A700LargeModel, FactsTellTheVoltageClassAndTheUnits) {
  const auto facts = [](const char* model, const char* motor) {
    Bench b(config_for(model, motor), "fr-a700");
    return b.port().facts();
  };
  EXPECT_EQ(facts("FR-A740-1.5K", "iec4p_1k5kW_400V").voltage_class_v, 400);
  EXPECT_EQ(facts("FR-A720-1.5K", "iec4p_1k5kW_200V").voltage_class_v, 200);
  EXPECT_FALSE(facts("FR-A740-55K", "iec4p_15kW_400V").coarse);
  EXPECT_TRUE(facts("FR-A740-75K", "iec4p_15kW_400V").coarse);
  EXPECT_TRUE(facts("FR-A720-75K", "iec4p_15kW_200V").coarse);
  Bench e500(config_for("FR-E520-0.4K", "iec4p_0k4kW_200V"));
  EXPECT_EQ(e500.port().facts().voltage_class_v, 200);
  EXPECT_FALSE(e500.port().facts().coarse);
}

TEST(A700LargeModel, MonitorsCountCurrentsAndPowersInTenths) {
  Bench b = a700_running(40, kRamps, config_75k());
  b.run(2);
  EXPECT_NEAR(monitor(b, 2) / 10, b.signal("output_current"), 0.5);
  EXPECT_GT(b.signal("output_current"), 40);
  EXPECT_NEAR(monitor(b, 13) * 100, b.signal("input_power"), 400);
  EXPECT_NEAR(monitor(b, 14) * 100, b.signal("output_power"), 400);
  EXPECT_GE(monitor(b, 11), monitor(b, 2));
  EXPECT_LT(monitor(b, 11), 3000);
  EXPECT_NEAR(monitor(b, 18) / 10, 66, 20);
  EXPECT_NEAR(monitor(b, 3) / 10, b.signal("output_voltage"), 3);  // volts as ever
}

TEST(A700LargeModel, ParametersOfCurrentsTravelInTenths) {
  Bench b = a700_with({{"Pr.340", 1}}, config_75k());
  EXPECT_EQ(b.raw(9), 1440u);
  EXPECT_EQ(b.raw(56), 1440u);
  EXPECT_EQ(b.raw(893), 750u);
  ASSERT_TRUE(b.write_parameter(9, 1305).has_value());
  EXPECT_EQ(b->get_parameter("Pr.9").value_or(0), 130.5);
  EXPECT_TRUE(refused(b.write_parameter(9, 36001), port::Refusal::kOutOfRange));
}

// Class 0x28 attribute 6 (rated current, 0.1 A) and class 0x2A attributes 9 (0.1 A) and 15 (W) are the same for all.
TEST(A700LargeModel, TheOptionBoardScalesBySize) {
  const auto attribute = [](Bench& b, std::uint16_t class_id, std::uint16_t number) {
    boards::fr_a7ne::CipUnitConfig config;
    config.ethernet.mac = {2, 0, 0, 0, 0, 9};
    config.ethernet.lease.address = 0x7F000002;
    config.ethernet.lease.mask = 0xFF000000;
    boards::fr_a7ne::CipUnit unit(b.port(), config);
    unit.handle_power(b.now(), true);
    for (int i = 0; i < 10; ++i) {
      b.tick();
      unit.handle_drive_tick(b.now());
      unit.handle_timeout(b.now());
    }
    Bytes request{0x0E, 3, 0x20, static_cast<std::uint8_t>(class_id), 0x24, 1, 0x30, static_cast<std::uint8_t>(number)};
    const auto parsed = cip::parse_request(request);
    EXPECT_TRUE(parsed.request.has_value());
    cip::Reply reply;
    EXPECT_FALSE(unit.router().handle(b.now(), *parsed.request, reply));
    EXPECT_EQ(static_cast<int>(reply.status.general), 0);
    EXPECT_GE(reply.data.size(), 2u);
    return reply.data.size() < 2 ? 0 : reply.data[0] + 256 * reply.data[1];
  };
  Bench large = a700_running(40, kRamps, config_75k());
  large.run(2);
  EXPECT_EQ(attribute(large, 0x28, 6), 1440);
  EXPECT_EQ(attribute(large, 0x28, 7), 400);
  EXPECT_NEAR(attribute(large, 0x2A, 9), large.signal("output_current") * 10, 5);
  EXPECT_NEAR(attribute(large, 0x2A, 15), large.signal("output_power"), 400);
  Bench small = a700_running(40, {}, loaded(0, 6, config_a700()));
  small.run(2);
  EXPECT_EQ(attribute(small, 0x28, 6), 40);
  EXPECT_NEAR(attribute(small, 0x2A, 9), small.signal("output_current") * 10, 1);
  EXPECT_NEAR(attribute(small, 0x2A, 15), small.signal("output_power"), 40);
}

}  // namespace
}  // namespace vinv::inverter::test
