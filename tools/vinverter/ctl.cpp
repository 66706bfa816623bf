// vinverter ctl: what a person does at a drive, by words.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "sim/rig/folders.hpp"
#include "tools/vinverter/control_client.hpp"
#include "tools/vinverter/subcommands.hpp"

namespace vinv::tools {
namespace {

using rig::Json;

struct CtlOptions {
  std::string socket;
  std::string plant;
  bool json = false;
  std::vector<std::string> words;
};

std::string socket_of(const CtlOptions& options) {
  if (!options.socket.empty()) return options.socket;
  if (!options.plant.empty()) return rig::default_runtime_folder(options.plant) + "/" + rig::kControlSocketName;
  const auto running = running_plants();
  if (running.size() == 1) return running.front();
  if (running.empty())
    throw std::runtime_error("no plant is running; `vinverter run` starts one (or name its socket with --socket).");
  std::string names;
  for (const std::string& path : running)
    names += (names.empty() ? "" : ", ") + std::filesystem::path(path).parent_path().filename().string();
  throw std::runtime_error("several plants are running; choose one with --plant: " + names + ".");
}

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

// Signals that `watch` shows if the drive has them, and the width of their column.
void print_signals(const Json& signals) {
  for (const auto& [name, signal] : signals.items())
    fmt::print("  {:<28} {:>12} {}\n", name,
               signal["value"].is_number() ? fmt::format("{:.2f}", signal["value"].get<double>()) : "-",
               signal["unit"].get<std::string>());
}

void print_status(const Json& s) {
  fmt::print("{}  {} {}  mode {}  display {}{}\n", text_of(s["name"]), text_of(s["family"]), text_of(s["model"]),
             text_of(s["mode"]), text_of(s["display"]), s["powered"].get<bool>() ? "" : "  (no power)");
  if (s["motor_source"] != "inverter") fmt::print("  the motor hangs on: {}\n", text_of(s["motor_source"]));
  if (!s["alarm"].is_null()) fmt::print("  alarm {}: {}\n", text_of(s["alarm"]["name"]), text_of(s["alarm"]["cause"]));
  if (!s["alarm_history"].empty()) {
    fmt::print("  alarm history (newest first):");
    for (const auto& code : s["alarm_history"]) fmt::print(" {:02X}H", code.get<unsigned>());
    fmt::print("\n");
  }
  print_signals(s["signals"]);
  fmt::print("  terminals:");
  for (const auto& [name, on] : s["terminals"].items()) fmt::print(" {}={}", name, on.get<bool>() ? "on" : "off");
  fmt::print("\n");
  if (s.contains("led")) fmt::print("  LED: {}\n", text_of(s["led"]));
  if (!s.contains("can")) return;
  const Json& can = s["can"];
  fmt::print("  CAN {} node {}: {}, TEC {} REC {}, {} sent, {} received, {} lost; bus load {} %\n",
             text_of(can["network"]), text_of(can["node"]), text_of(can["state"]), text_of(can["tec"]),
             text_of(can["rec"]), text_of(can["sent"]), text_of(can["received"]), text_of(can["lost"]),
             text_of(can["bus_load_percent"]));
}

void print_bus(const Json& bus) {
  fmt::print("{}  {}  {} bit/s  load {} % (peak {} %)  {} frames, {} error frames  {} nodes\n", text_of(bus["name"]),
             text_of(bus["can"]), text_of(bus["bitrate"]), text_of(bus["load_percent"]),
             text_of(bus["peak_load_percent"]), text_of(bus["frames"]), text_of(bus["error_frames"]),
             text_of(bus["nodes"]));
  if (bus.contains("outside")) fmt::print("  elsewhere: {}\n", text_of(bus["outside"]["state"]));
  for (const auto& d : bus["drives"])
    fmt::print("  {}  node {}  {}\n", text_of(d["name"]), text_of(d["node"]), text_of(d["state"]));
  for (const auto& fault : bus["faults"]) fmt::print("  fault {}\n", fault.dump());
}

// modbus-tcp  host 127.0.0.1  port 1502  unit 5
void print_endpoints(const Json& endpoints) {
  for (const auto& e : endpoints) {
    fmt::print("  {}", text_of(e["protocol"]));
    for (const auto& [key, value] : e.items())
      if (key != "protocol") fmt::print("  {} {}", key, text_of(value));
    fmt::print("\n");
  }
}

void print_result(const std::string& command, const Json& result) {
  if (command == "status") return print_status(result);
  if (command == "buses") {
    for (const auto& bus : result) print_bus(bus);
    return;
  }
  if (command == "list") {
    for (const auto& d : result) {
      fmt::print("{}  {} {}  motor {}  display {}\n", text_of(d["name"]), text_of(d["family"]), text_of(d["model"]),
                 text_of(d["motor"]), text_of(d["display"]));
      print_endpoints(d["endpoints"]);
    }
  } else if (command == "commands") {
    for (const auto& c : result)
      fmt::print("{:<11} {:<60} {}\n{:<11}   vinverter ctl {}\n", text_of(c["command"]), text_of(c["value"]),
                 text_of(c["meaning"]), "", text_of(c["example"]));
  } else if (command == "parameters") {
    for (const auto& p : result)
      fmt::print("{:<9} {:>10} {:<6} {}\n", text_of(p["parameter"]), text_of(p["value"]), text_of(p["unit"]),
                 text_of(p["name"]));
  } else if (result.is_object()) {
    for (const auto& [key, value] : result.items()) {
      std::string shown = value.is_array() ? "" : text_of(value);
      if (value.is_array())
        for (const auto& item : value) shown += (shown.empty() ? "" : ", ") + text_of(item);
      fmt::print("{}: {}\n", key, shown);
    }
  } else {
    fmt::print("{}\n", text_of(result));
  }
}

// One line per second: a header of names first, and again after each screenful.
int watch(ControlClient& client, const std::string& drive, bool json) {
  constexpr int kScreenful = 20;
  std::vector<std::string> names;
  for (int line = 0;; ++line) {
    const Json answer = client.call("status", {{"drive", drive}});
    if (answer.contains("error")) {
      fmt::print(stderr, "vinverter: {}\n", text_of(answer["error"]["message"]));
      return kRefused;
    }
    const Json& s = answer["result"];
    if (json) {
      fmt::print("{}\n", s.dump());
    } else {
      if (line % kScreenful == 0) {
        names.clear();
        fmt::print("{:>9} {:<8} {:<6}", "time s", "display", "mode");
        for (const auto& [name, signal] : s["signals"].items()) {
          constexpr std::size_t kColumns = 8;
          if (names.size() >= kColumns) break;
          names.push_back(name);
          const std::string title = name + " " + text_of(signal["unit"]);
          fmt::print(" {:>{}}", title, std::max<std::size_t>(title.size(), 9));
        }
        fmt::print("\n");
      }
      fmt::print("{:>9.1f} {:<8} {:<6}", s["time_s"].get<double>(), text_of(s["display"]), text_of(s["mode"]));
      for (const std::string& name : names) {
        const Json& signal = s["signals"][name];
        const std::string title = name + " " + text_of(signal["unit"]);
        fmt::print(" {:>{}.2f}", signal["value"].is_number() ? signal["value"].get<double>() : 0.0,
                   std::max<std::size_t>(title.size(), 9));
      }
      if (!s["alarm"].is_null()) fmt::print("  {}", text_of(s["alarm"]["name"]));
      fmt::print("\n");
    }
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
}

bool for_the_plant(const std::string& word) {
  return std::any_of(rig::commands().begin(), rig::commands().end(),
                     [&](const rig::CommandInfo& c) { return c.name == word && !c.for_drive; });
}

int ctl(const CtlOptions& options) {
  auto words = options.words;
  std::string drive;
  if (!for_the_plant(words.front())) {
    drive = words.front();
    words.erase(words.begin());
    if (words.empty()) words.push_back("status");
  }
  const std::string command = words.front();
  words.erase(words.begin());
  ControlClient client(socket_of(options));
  if (command == "watch") return watch(client, drive, options.json);
  Json params = Json::object();
  if (!drive.empty()) params["drive"] = drive;
  if (!words.empty()) params["words"] = words;
  const Json answer = client.call(command, params);
  if (answer.contains("error")) {
    if (options.json) fmt::print("{}\n", answer["error"].dump());
    fmt::print(stderr, "vinverter: {}\n", text_of(answer["error"]["message"]));
    return answer["error"]["code"] == static_cast<int>(rig::CommandCode::kRefused) ? kRefused : kUnusable;
  }
  if (options.json)
    fmt::print("{}\n", answer["result"].dump());
  else
    print_result(command, answer["result"]);
  return kDone;
}

}  // namespace

void add_ctl(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CtlOptions>();
  CLI::App* sub = app.add_subcommand("ctl", "Do at a drive of the running plant what a person does at a real one");
  sub->add_option("--socket", options->socket, "Control socket of the plant; the ready file names it");
  sub->add_option("--plant", options->plant, "Name of the plant; default: the one that is running")
      ->excludes("--socket");
  sub->add_flag("--json", options->json, "Print the answer as JSON");
  sub->add_option("WORDS", options->words, "list | commands | DRIVE COMMAND ...; DRIVE watch shows values each second")
      ->required();
  sub->positionals_at_end();
  std::string footer = "\nCommands:\n";
  for (const rig::CommandInfo& c : rig::commands())
    footer +=
        fmt::format("  {}{:<11} {}\n  {:<17} {}\n", c.for_drive ? "DRIVE " : "      ", c.name, c.value, "", c.meaning);
  footer += "  DRIVE watch\n                    values each second, until Ctrl-C\n";
  sub->footer(footer + "\nExit codes: 0 done; 1 the drive refuses; 2 wrong words, or no such plant.");
  sub->callback([options, &exit_code] { exit_code = ctl(*options); });
}

}  // namespace vinv::tools
