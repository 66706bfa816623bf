// The rig with the product's own inverters and boards, in virtual time.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "option_boards/modbus/crc16.hpp"
#include "sim/rig/commands.hpp"
#include "sim/rig/plant.hpp"
#include "sim/transports/memory_link.hpp"

namespace vinv::rig {
namespace {

using std::chrono::milliseconds;

PlantFile shipped(const std::string& name) {
  return load_plant_file(VINV_SOURCE_DIR "/scenarios/plants/" + name, shipped_catalogue());
}

PlantOptions shipped_options() {
  PlantOptions options;
  options.catalogue = shipped_catalogue();
  return options;
}

Bytes write_frame(std::uint8_t unit, std::uint16_t address, std::uint16_t value) {
  Bytes f;
  f.push_back(unit);
  f.push_back(6);
  append_be16(f, address);
  append_be16(f, value);
  append_le16(f, modbus::crc16(f));
  return f;
}

double signal(Plant& plant, const std::string& drive, std::string_view name) {
  for (const auto& s : plant.find(drive)->inverter->signals())
    if (s.name == name) return s.value;
  ADD_FAILURE() << "no signal " << name;
  return 0;
}

struct Demo {
  Demo() : plant(shipped("demo.yaml"), scheduler, shipped_options()) {}
  void start() {
    plant.start();
    run_ms(1500);
  }
  void run_ms(int ms) { scheduler.run_until(scheduler.now() + milliseconds(ms)); }
  void command(const std::string& drive, const std::string& name, const Json& value) {
    const auto r = execute(plant, name, drive, value);
    EXPECT_TRUE(r) << name << ": " << r.error().message;
  }
  void wait_for(const std::function<bool()>& condition, int at_most_ms) {
    for (int i = 0; i < at_most_ms && !condition(); i += 10) run_ms(10);
    EXPECT_TRUE(condition());
  }
  kernel::Scheduler scheduler;
  Plant plant;
};

TEST(RealPlant, AnIdealDriveHasOnlyTheLossesThatAreNamed) {
  const char* const text =
      "drives:\n"
      "  - name: real\n"
      "  - { name: ideal, ideal: on }\n"
      "  - { name: named, ideal: on, losses: { standby_W: 12 }, load: { friction: { coulomb_Nm: 0.5 } } }\n";
  kernel::Scheduler scheduler;
  Plant plant(parse_plant_file(text, "p.yaml", shipped_catalogue()), scheduler, shipped_options());
  const auto losses = [&](const char* drive) { return plant.find(drive)->inverter->plant().config().losses; };
  for (const double loss : {losses("real").iron_loss_w_at_rated, losses("real").inverter_loss_fraction,
                            losses("real").standby_w, losses("real").viscous_nm_s, losses("real").coulomb_nm})
    EXPECT_GT(loss, 0);
  for (const char* drive : {"ideal", "named"}) {
    EXPECT_EQ(losses(drive).iron_loss_w_at_rated, 0);
    EXPECT_EQ(losses(drive).inverter_loss_fraction, 0);
    EXPECT_EQ(losses(drive).viscous_nm_s, 0);
  }
  EXPECT_EQ(losses("ideal").standby_w, 0);
  EXPECT_EQ(losses("ideal").coulomb_nm, 0);
  EXPECT_EQ(losses("named").standby_w, 12);
  EXPECT_EQ(losses("named").coulomb_nm, 0.5);
}

TEST(RealPlant, TheShippedPlantFilesStart) {
  for (const char* name : {"demo.yaml", "minimal.yaml"}) {
    kernel::Scheduler scheduler;
    Plant plant(shipped(name), scheduler, shipped_options());
    plant.start();
    EXPECT_FALSE(plant.settled());
    scheduler.run_until(scheduler.now() + milliseconds(3000));
    EXPECT_TRUE(plant.settled()) << name;
    for (const auto& d : plant.drives()) EXPECT_EQ(d->unit(), d->spec.board->node.value) << name;
  }
}

// Everything that can be seen: all signals of all drives each 10 ms, bit by bit, and each byte sent with its time.
std::string trace_of_a_stimulated_run() {
  Demo run;
  std::ostringstream trace;
  trace << std::hexfloat;
  auto [ours, theirs] = transports::make_memory_link(run.scheduler, {.delay = std::chrono::microseconds(150)});
  run.plant.connect_serial(*run.plant.find("conveyor_1")->spec.board->serial, std::move(ours));
  theirs->set_handlers(
      [&](Instant now, ByteView bytes, bool) {
        trace << "wire " << to_ns(now);
        for (const std::uint8_t b : bytes) trace << ' ' << int{b};
        trace << '\n';
      },
      {});
  run.plant.start();
  const auto at = [&](int ms, std::function<void()> act) {
    run.scheduler.schedule(run.scheduler.now() + milliseconds(ms), kernel::Priority::kStimulus,
                           [act = std::move(act)](Instant) { act(); });
  };
  const auto send = [&](std::uint16_t address, std::uint16_t value) {
    theirs->send(run.scheduler.now(), write_frame(5, address, value));
  };
  at(1500, [&] { send(26000, 1); });
  at(1600, [&] { send(24002, 4000); });
  at(1700, [&] { send(24000, 2); });
  at(2000, [&] { run.command("fan_1", "run", "forward"); });
  at(2600, [&] { run.command("conveyor_1", "load", {{"torque", "9 Nm"}}); });
  at(3100, [&] { run.command("conveyor_1", "mains", {{"dip", "15 %"}, {"for", "100 ms"}}); });
  run.scheduler.schedule_every(run.scheduler.now() + milliseconds(10), milliseconds(10), kernel::Priority::kObserver,
                               [&](Instant now) {
                                 trace << to_ns(now);
                                 for (const auto& d : run.plant.drives())
                                   for (const auto& s : d->inverter->signals()) trace << ' ' << s.value;
                                 trace << '\n';
                               });
  run.run_ms(4000);
  EXPECT_GT(signal(run.plant, "conveyor_1", "speed"), 100);
  return trace.str();
}

TEST(RealPlant, TwoRunsWithTheSameStimulusGiveTheSameTraceByteForByte) {
  const std::string first = trace_of_a_stimulated_run();
  EXPECT_NE(first.find("wire"), std::string::npos);
  EXPECT_EQ(first, trace_of_a_stimulated_run());
}

TEST(RealPlant, ADipThatEndsLeavesADriveThatRunsAgain) {
  Demo run;
  run.start();
  run.command("conveyor_1", "terminal", {{"RH", "on"}});
  run.command("conveyor_1", "run", "forward");
  run.run_ms(3000);
  EXPECT_GT(signal(run.plant, "conveyor_1", "speed"), 1400);
  run.command("conveyor_1", "mains", {{"dip", "100 %"}, {"for", "100 ms"}});
  run.run_ms(60);
  EXPECT_DOUBLE_EQ(signal(run.plant, "conveyor_1", "output_frequency"), 0);
  run.run_ms(2000);
  EXPECT_GT(signal(run.plant, "conveyor_1", "dc_link"), 500);
  EXPECT_EQ(run.plant.find("conveyor_1")->inverter->alarm_name(), "");
  run.command("conveyor_1", "stop", {});
  run.run_ms(100);
  run.command("conveyor_1", "run", "forward");
  run.run_ms(3000);
  EXPECT_GT(signal(run.plant, "conveyor_1", "speed"), 1400);
}

TEST(RealPlant, TheCentrifugeTripsOnOverVoltageAndResets) {
  Demo run;
  run.start();
  run.command("centrifuge_1", "terminal", {{"RH", "on"}});
  run.command("centrifuge_1", "run", "forward");
  run.run_ms(12000);
  EXPECT_GT(signal(run.plant, "centrifuge_1", "speed"), 1400);
  run.command("centrifuge_1", "stop", {});
  auto& inverter = *run.plant.find("centrifuge_1")->inverter;
  run.wait_for([&] { return inverter.alarm_name() == "E.OV3"; }, 1000);
  run.command("centrifuge_1", "reset", {});
  run.wait_for([&] { return inverter.alarm_name().empty() && run.plant.settled(); }, 3000);
}

TEST(RealPlant, APowerCycleKeepsParametersAndTheBoardComesBack) {
  Demo run;
  run.start();
  run.command("fan_1", "mode", "PU");
  run.command("fan_1", "parameter", {{"Pr.7", 3.5}});
  run.command("fan_1", "power", "cycle");
  run.run_ms(1000);
  EXPECT_EQ(run.plant.find("fan_1")->board->modbus_unit()->address(), 0);
  run.run_ms(3000);
  EXPECT_EQ(run.plant.find("fan_1")->board->modbus_unit()->address(), 6);
  EXPECT_DOUBLE_EQ(*run.plant.find("fan_1")->inverter->get_parameter("Pr.7"), 3.5);
}

TEST(RealPlant, EveryNameThatADriveTellsIsTaken) {
  Demo run;
  run.start();
  auto& inverter = *run.plant.find("conveyor_1")->inverter;
  for (const auto name : inverter.analog_terminals()) {
    const std::string unit(analog_unit(inverter.family(), name));
    run.command("conveyor_1", "analog", {{"terminal_" + std::string(name), "4 " + unit}});
  }
  run.command("conveyor_1", "terminal", {{"MRS", "on"}});
  run.command("conveyor_1", "terminal", {{"MRS", "off"}});
  // The drive may refuse a fault (an alarm is there already), but it knows all names that it tells.
  for (const auto fault : inverter.injectable_faults()) {
    for (const char* on : {"on", "off"}) {
      const auto r = execute(run.plant, "fault", "conveyor_1", {{std::string(fault), on}});
      if (!r) {
        EXPECT_EQ(r.error().code, CommandCode::kRefused) << fault << ": " << r.error().message;
      }
      run.run_ms(2);
    }
  }
  EXPECT_NE(inverter.alarm_name(), "");
}

TEST(RealPlant, WhatTheDriveRefusesOfTheFileIsToldWithItsPlace) {
  const auto told = [](const std::string& text) {
    kernel::Scheduler scheduler;
    try {
      const Plant plant(parse_plant_file(text, "p.yaml", shipped_catalogue()), scheduler, shipped_options());
    } catch (const PlantFileError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  const std::string drive = "drives:\n  - inverter: { model: FR-E540-0.4K }\n";
  EXPECT_EQ(told(drive), "accepted");
  EXPECT_TRUE(told(drive + "    parameters: { Pr.5000: 1 }\n").starts_with("p.yaml:3:19: drive_1: "));
  EXPECT_TRUE(told(drive + "    parameters: { Pr.7: -1 }\n").starts_with("p.yaml:3:19: drive_1: "));
  EXPECT_TRUE(told(drive + "    parameters: { acceleration: 1 }\n").starts_with("p.yaml:3:19: drive_1: "));
  EXPECT_TRUE(told(drive + "    terminals: { STG: on }\n").starts_with("p.yaml:3:18: drive_1: "));
  EXPECT_TRUE(told(drive + "    analog: { terminal_7: 1 }\n").starts_with("p.yaml:3:15: drive_1: "));
  EXPECT_TRUE(told(drive + "    board: { node: 120 }\n").starts_with("p.yaml:3:20: drive_1: "));
}

TEST(RealPlant, AllClearLeavesADriveAtTheNodeOfThePlantFile) {
  Demo demo;
  demo.start();
  demo.command("conveyor_1", "mode", "PU");
  demo.command("conveyor_1", "parameter", {{"Pr.345", 12}, {"Pr.7", 3}});
  demo.command("conveyor_1", "parameter", {{"ALLC", 1}});
  EXPECT_DOUBLE_EQ(*demo.plant.find("conveyor_1")->inverter->get_parameter("Pr.345"), 5);
  EXPECT_DOUBLE_EQ(*demo.plant.find("conveyor_1")->inverter->get_parameter("Pr.7"), 5);
}

}  // namespace
}  // namespace vinv::rig
