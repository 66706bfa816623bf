// vinverter: runs a plant of virtual inverters, and talks to one that runs.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "sim/rig/plant_file.hpp"
#include "sim/rig/words.hpp"
#include "tools/vinverter/subcommands.hpp"
#include "vinverter_data.hpp"

namespace {

constexpr const char* kFooter = R"(
Examples:
  vinverter run                                 the demo plant: conveyor, fan, centrifuge, mixer
  vinverter run my_plant.yaml --ready-file r    r appears when everything listens
  vinverter schema > plant.schema.json          the plant file's schema, for an editor
  vinverter ctl list                            drives of the running plant, and where they are reached
  vinverter ctl conveyor_1 terminal STF=on      switch a control terminal
  vinverter ctl conveyor_1 load torque 9 Nm     load the motor
  vinverter ctl conveyor_1 watch                its values, each second
  vinverter scenario run scenarios/fr-e500      scripted stories with checks, in virtual time
  vinverter campaign run FILE --shard 3/8       variations of a scenario, a part of them
  vinverter params fr-e500 brake                parameters whose number, name or effect says "brake"
  vinverter doctor                              what works on this machine

Start a motor over Modbus/TCP while the demo runs (drive at unit 5):
  mbpoll -m tcp -p 1502 -a 5 -0 -r 26000 -t 4 -1 127.0.0.1 1       NET mode on
  mbpoll -m tcp -p 1502 -a 5 -0 -r 24002 -t 4 -1 127.0.0.1 4000    40.00 Hz
  mbpoll -m tcp -p 1502 -a 5 -0 -r 24000 -t 4 -1 127.0.0.1 2       forward
  mbpoll -m tcp -p 1502 -a 5 -0 -r 23100 -c 1 -t 4 -1 127.0.0.1    output frequency, 0.01 Hz

Exit codes: 0 done; 1 the drive refuses, or something could not be saved; 2 wrong words, a mistake in the plant file,
a port in use, or no such plant.
)";

}  // namespace

int main(int argc, char** argv) {
  using namespace vinv;
  CLI::App app{
      "vinverter: virtual inverters with communication option boards. A motor and inverter model behind a board that\n"
      "speaks the real fieldbus, so that an unmodified master finds, runs, trips and resets a plausible motor.",
      "vinverter"};
  app.set_version_flag("--version", fmt::format("vinverter {} ({}), SUNDIALS {}", VINV_VERSION, VINV_GIT_DESCRIBE,
                                                VINV_SUNDIALS_VERSION));
  app.require_subcommand(1);
  app.footer(kFooter);
  int exit_code = tools::kDone;
  tools::add_run(app, exit_code);
  tools::add_ctl(app, exit_code);
  tools::add_scenario(app, exit_code);
  tools::add_campaign(app, exit_code);
  tools::add_doctor(app, exit_code);
  tools::add_params(app, exit_code);
  app.add_subcommand("schema", "Print the JSON Schema of plant files")->callback([] {
    std::fwrite(tools::data::PLANT_SCHEMA.data(), 1, tools::data::PLANT_SCHEMA.size(), stdout);
  });
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  if (argc > 1 && argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end()) {
    const std::vector<std::string_view> known(names.begin(), names.end());
    fmt::print(stderr, "vinverter: unknown command \"{}\"; {} `vinverter --help` explains them.\n", argv[1],
               rig::allowed_words(argv[1], known));
    return tools::kUnusable;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? tools::kDone : tools::kUnusable;
  } catch (const rig::PlantFileError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return tools::kUnusable;
  } catch (const std::exception& e) {
    fmt::print(stderr, "vinverter: {}\n", e.what());
    return tools::kUnusable;
  }
  return exit_code;
}
