#include "sim/rig/commands.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <utility>

#include "sim/rig/can_commands.hpp"
#include "sim/rig/command_values.hpp"
#include "sim/rig/flow_value.hpp"
#include "sim/rig/motor_source.hpp"
#include "sim/rig/wire_commands.hpp"
#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

using inverter::PanelKey;
using port::OperationMode;

struct Key {
  std::string_view word;
  PanelKey key;
};
constexpr std::array kKeys{Key{"FWD", PanelKey::kFwd},        Key{"REV", PanelKey::kRev},
                           Key{"STOP", PanelKey::kStopReset}, Key{"PU/EXT", PanelKey::kPuExt},
                           Key{"UP", PanelKey::kUp},          Key{"DOWN", PanelKey::kDown},
                           Key{"MODE", PanelKey::kMode},      Key{"SET", PanelKey::kSet}};

struct Context {
  Plant& plant;
  DriveUnit& drive;
  const Json& value;
  inverter::Inverter& inverter() const { return *drive.inverter; }
};

// --- supply ---

Json power(const Context& c) {
  const std::string word =
      c.value.is_boolean() ? (c.value.get<bool>() ? "on" : "off") : word_of(c.value, {"on", "off", "cycle"}, "power");
  auto& scheduler = c.plant.scheduler();
  if (c.drive.power_returns != 0) scheduler.cancel(std::exchange(c.drive.power_returns, 0));
  if (word != "cycle") {
    c.plant.set_power(c.drive, word == "on");
    return word;
  }
  // Long enough for the control supply to be gone for good.
  constexpr Duration kOffTime = std::chrono::seconds(2);
  c.plant.set_power(c.drive, false);
  c.drive.power_returns =
      scheduler.schedule(c.plant.now() + kOffTime, kernel::Priority::kStimulus,
                         [&plant = c.plant, &drive = c.drive](Instant) { plant.return_power(drive); });
  return "off for 2 s";
}

Json mains(const Context& c) {
  const Json& map = map_of(c.value, {"voltage", "dip", "for"}, "mains", "{voltage: 380 V} or {dip: 40 %, for: 200 ms}");
  if (map.contains("dip") != map.contains("for"))
    invalid("mains: dip and for belong together, as {dip: 40 %, for: 200 ms}.");
  if (map.contains("voltage"))
    c.drive.mains.voltage_v_rms =
        quantity_within(map["voltage"], Dimension::kVoltage, "voltage", 0, 1000, "0 to 1000 V");
  if (map.contains("dip")) {
    const double depth =
        quantity_within(map["dip"], Dimension::kFraction, "dip", 0, 1, "0 to 100 % (by how much the voltage falls)");
    const double seconds = quantity_within(map["for"], Dimension::kTime, "for", 1e-3, 3600, "1 ms to 60 min");
    auto& scheduler = c.plant.scheduler();
    if (c.drive.dip_ends != 0) scheduler.cancel(c.drive.dip_ends);
    c.drive.dip_fraction = depth;
    c.drive.dip_ends = scheduler.schedule(c.plant.now() + seconds_to_duration(seconds), kernel::Priority::kStimulus,
                                          [&drive = c.drive](Instant) { drive.end_dip(); });
  }
  c.drive.apply_mains();
  return Json{{"voltage_V", c.drive.mains.voltage_v_rms * (1 - c.drive.dip_fraction)}};
}

Json phase_loss(const Context& c) {
  const std::string word = word_of(c.value, {"L1", "L2", "L3", "none"}, "phase_loss");
  c.drive.mains.phase_present = {word != "L1", word != "L2", word != "L3"};
  c.drive.apply_mains();
  return word;
}

Json ambient(const Context& c) {
  const double celsius = quantity_within(c.value, Dimension::kTemperature, "ambient", -40, 100, "-40 to 100 C");
  c.inverter().set_ambient(celsius);
  return celsius;
}

// --- panel and terminals ---

Json key(const Context& c) {
  Words names;
  for (const Key& k : kKeys) names.push_back(k.word);
  const std::string word = word_of(c.value, names, "key");
  for (const Key& k : kKeys)
    if (k.word == word) demand(c.inverter().press_key(k.key));
  return c.inverter().display();
}

Json panel_frequency(const Context& c) {
  const double hz = quantity_of(c.value, Dimension::kFrequency, "frequency");
  demand(c.inverter().set_panel_frequency(hz));
  return hz;
}

Json reference(const Context& c) {
  std::string text = c.value.is_string() ? c.value.get<std::string>() : std::string{};
  double hz = 0;
  if (const auto rpm = parse_quantity(text, Dimension::kSpeed); rpm)
    hz = *rpm * c.drive.spec.motor.value.pole_pairs / 60;  // synchronous: the load's slip comes off
  else
    hz = quantity_of(c.value, Dimension::kFrequency, "reference");
  demand(c.inverter().set_reference(hz));
  return hz;
}

Json mode(const Context& c) {
  if (c.value.is_string() && c.value.get<std::string>() == "NET")
    invalid("mode NET is set by the network master (OI-FR-E5NCO: write 1 to address 26000); allowed here: PU, EXT.");
  const std::string word = word_of(c.value, {"PU", "EXT"}, "mode");
  const OperationMode wanted = word == "PU" ? OperationMode::kPu : OperationMode::kExternal;
  if (c.inverter().port().operation_mode() != wanted) demand(c.inverter().press_key(PanelKey::kPuExt));
  return word;
}

void set_terminal(const Context& c, std::string_view name, bool on) {
  const auto outcome = c.inverter().set_terminal(name, on);
  if (outcome) return;
  Words known;
  for (const auto& t : c.inverter().terminals()) known.push_back(t.first);
  refused(sentence(outcome.error()) + suggestion(name, known));
}

Json terminal(const Context& c) {
  const Json& map = map_of(c.value, {}, "terminal", "{STF: on}");
  const auto before = c.inverter().terminals();
  std::vector<std::pair<std::string, bool>> wanted;
  for (const auto& [name, on] : map.items()) wanted.emplace_back(name, switch_of(on, "terminal " + name));
  try {
    for (const auto& [name, on] : wanted) set_terminal(c, name, on);
  } catch (const Refuse&) {
    // All of them or none; only inputs can have been set.
    for (const auto& [name, on] : before) static_cast<void>(c.inverter().set_terminal(name, on));
    throw;
  }
  return map;
}

Json analog(const Context& c) {
  const Words terminals = c.inverter().analog_terminals();
  const Json& map = map_of(c.value, {}, "analog", "{terminal_2: 5 V}, with one of the terminals " + join(terminals));
  for (const auto& [name, value] : map.items()) {
    const std::string_view terminal = std::string_view(name).substr(name.starts_with("terminal_") ? 9 : 0);
    if (std::find(terminals.begin(), terminals.end(), terminal) == terminals.end())
      invalid("there is no analog terminal \"" + name + "\"; " + allowed_words(terminal, terminals));
    const bool current = analog_unit(c.inverter().family(), terminal) == "mA";
    demand(c.inverter().set_analog(terminal, quantity_of(value, current ? Dimension::kCurrent : Dimension::kVoltage,
                                                         "analog terminal " + std::string(terminal))));
  }
  return map;
}

// Start commands go the way that the operation mode listens to.
bool keys_start(OperationMode mode) { return mode == OperationMode::kPu || mode == OperationMode::kCombined2; }

Json run(const Context& c) {
  const std::string word = word_of(c.value, {"forward", "reverse"}, "run");
  const bool forward = word == "forward";
  const OperationMode mode = c.inverter().port().operation_mode();
  if (mode == OperationMode::kNetwork)
    refused("the drive is in NET mode: its network master starts it. `mode EXT` or the master's command leaves NET.");
  if (keys_start(mode)) {
    demand(c.inverter().press_key(forward ? PanelKey::kFwd : PanelKey::kRev));
    return "by the panel key";
  }
  set_terminal(c, forward ? "STR" : "STF", false);
  set_terminal(c, forward ? "STF" : "STR", true);
  return forward ? "by terminal STF" : "by terminal STR";
}

Json stop(const Context& c) {
  const OperationMode mode = c.inverter().port().operation_mode();
  if (keys_start(mode) || mode == OperationMode::kNetwork) {
    demand(c.inverter().press_key(PanelKey::kStopReset));
    return "by the STOP key";
  }
  set_terminal(c, "STF", false);
  set_terminal(c, "STR", false);
  return "by terminals STF and STR";
}

Json reset(const Context& c) {
  constexpr Duration kResetPulse = std::chrono::milliseconds(100);
  auto& scheduler = c.plant.scheduler();
  set_terminal(c, "RES", true);
  if (c.drive.reset_released != 0) scheduler.cancel(c.drive.reset_released);
  c.drive.reset_released = scheduler.schedule(c.plant.now() + kResetPulse, kernel::Priority::kStimulus,
                                              [&drive = c.drive](Instant) { drive.release_reset(); });
  return "by terminal RES for 100 ms";
}

Json board_switch(const Context& c) {
  if (!c.drive.board) refused("the drive has no option board.");
  const Json& map = map_of(c.value, {}, "switch", "{SW1: 2}");
  for (const auto& [name, value] : map.items()) {
    const double v = number_of(value, "switch " + name);
    if (v < 0 || v > 255 || v != static_cast<unsigned>(v))
      invalid("switch " + name + " is " + shown(value) + "; allowed: a whole number from 0.");
    const auto outcome = c.drive.board->set_switch(name, static_cast<unsigned>(v));
    if (!outcome) refused(outcome.error());
  }
  return map;
}

// --- machine ---

// A change of the constant torque that takes its time, and torque by a table: both are the load's table, which counts
// from the plant's start, so that the equations see a line and no stairs.
std::vector<plant::LoadPoint> load_table(const Json& value, double now_s) {
  constexpr std::size_t kMaxPoints = 10000;
  constexpr std::string_view kForm =
      "a list as [{at: 0 s, torque: 2 Nm}, {at: 5 s, torque: 8 Nm}], at counted from now";
  if (!value.is_array() || value.empty() || value.size() > kMaxPoints)
    invalid("table is " + shown(value) + "; it takes " + std::string(kForm) + ".");
  std::vector<plant::LoadPoint> out;
  for (const Json& point : value) {
    map_of(point, {"at", "torque"}, "table", kForm);
    if (!point.contains("at") || !point.contains("torque")) invalid("a point of table needs at and torque.");
    const double at_s = now_s + quantity_within(point["at"], Dimension::kTime, "at", 0, 1e6, "0 to 1000000 s");
    if (!out.empty() && at_s <= out.back().time_s) invalid("at of a point in table is not after the point before it.");
    out.push_back(
        {at_s, quantity_within(point["torque"], Dimension::kTorque, "torque", -1e6, 1e6, "-1000 to 1000 kNm")});
  }
  return out;
}

Json load(const Context& c) {
  const Json& map =
      map_of(c.value, {"torque", "linear", "quadratic", "hoist", "inertia", "over", "table"}, "load",
             "{torque: 12 Nm}, over: 2 s with torque, linear and quadratic (Nm at rated speed), hoist (Nm), "
             "inertia (kg m2), table");
  plant::LoadSettings load = c.inverter().plant().load();
  const double rated_rad_s = c.drive.spec.motor.value.rated_speed_rpm * std::numbers::pi / 30;
  const auto torque = [&](const char* key, double low) {
    return quantity_within(map[key], Dimension::kTorque, key, low, 1e6,
                           low < 0 ? "-1000 to 1000 kNm" : "0 to 1000 kNm");
  };
  if (map.contains("over") && (!map.contains("torque") || map.contains("table")))
    invalid("load: over is the time that torque takes to get there, as {torque: 12 Nm, over: 2 s}.");
  const double before_nm = load.constant_nm;
  if (map.contains("torque")) load.constant_nm = torque("torque", 0);
  if (map.contains("linear")) load.linear_nm_s = torque("linear", 0) / rated_rad_s;
  if (map.contains("quadratic")) load.quadratic_nm_s2 = torque("quadratic", 0) / (rated_rad_s * rated_rad_s);
  if (map.contains("hoist")) load.hoist_nm = torque("hoist", -1e6);
  if (map.contains("inertia"))
    load.inertia_kg_m2 = quantity_within(map["inertia"], Dimension::kInertia, "inertia", 0, 1e6, "0 to 1000000 kg m2");
  const double now_s = to_seconds(c.inverter().plant().time());
  if (map.contains("table")) load.table = load_table(map["table"], now_s);
  std::optional<double> ramp_s;
  if (map.contains("over"))
    ramp_s = quantity_within(map["over"], Dimension::kTime, "over", 1e-3, 1e6, "1 ms to 1000000 s");
  const double target_nm = load.constant_nm;
  if (ramp_s) {
    const double low_nm = std::min(before_nm, target_nm);
    load.constant_nm = low_nm;
    load.table = {{now_s, before_nm - low_nm}, {now_s + *ramp_s, target_nm - low_nm}};
  }
  if (const auto fine = plant::validate(load); !fine) invalid("load: " + fine.error());
  auto& scheduler = c.plant.scheduler();
  if (c.drive.load_ramp_ends != 0) scheduler.cancel(std::exchange(c.drive.load_ramp_ends, 0));
  c.inverter().set_load(load);
  if (ramp_s) {
    c.drive.load_ramp_nm = target_nm;
    c.drive.load_ramp_ends =
        scheduler.schedule(c.plant.now() + seconds_to_duration(*ramp_s), kernel::Priority::kStimulus,
                           [&drive = c.drive](Instant) { drive.end_load_ramp(); });
  }
  return Json{{"torque_Nm", target_nm},
              {"linear_Nm_at_rated", load.linear_nm_s * rated_rad_s},
              {"quadratic_Nm_at_rated", load.quadratic_nm_s2 * rated_rad_s * rated_rad_s},
              {"hoist_Nm", load.hoist_nm},
              {"inertia_kg_m2", load.inertia_kg_m2}};
}

Json shaft(const Context& c) {
  const std::string word = word_of(c.value, {"locked", "free"}, "shaft");
  c.inverter().set_shaft_locked(word == "locked");
  return word;
}

Json motor(const Context& c) {
  const std::string word = word_of(c.value, kMotorSources, "motor");
  if (word == "table" && c.drive.spec.voltage_table.empty())
    invalid("motor is \"table\"; the plant file has no voltage_table for this drive.");
  demand(c.inverter().set_motor_source(*motor_source_of(word)));
  return word;
}

constexpr std::string_view kBoardFault = "option_failure";

Words faults_of(const DriveUnit& drive) {
  Words words = drive.inverter->injectable_faults();
  if (drive.board && drive.board->can_fail()) words.push_back(kBoardFault);
  return words;
}

Json fault(const Context& c) {
  const Words known = faults_of(c.drive);
  Json map = c.value;
  if (map.is_string()) map = Json{{map.get<std::string>(), "on"}};
  map_of(map, known, "fault", "{E.PE: on} or a cause as {earth_fault: on}");
  for (const auto& [name, value] : map.items()) {
    const bool on = switch_of(value, "fault " + name);
    if (name == kBoardFault)
      c.drive.board->set_failed(c.plant.now(), on);
    else
      demand(c.inverter().inject_fault(name, on));
  }
  return map;
}

// --- parameters ---

Json parameter_row(const inverter::Inverter& inverter, const std::string& name) {
  const auto value = inverter.get_parameter(name);
  if (!value) refused(value.error());
  return *value;
}

Json parameter(const Context& c) {
  Json out = Json::object();
  if (c.value.is_string())
    return Json{{c.value.get<std::string>(), parameter_row(c.inverter(), c.value.get<std::string>())}};
  if (c.value.is_array() && !c.value.empty()) {
    for (const auto& name : c.value) {
      if (!name.is_string()) invalid("parameter name is " + shown(name) + "; allowed: a name as \"Pr.7\".");
      out[name.get<std::string>()] = parameter_row(c.inverter(), name.get<std::string>());
    }
    return out;
  }
  const Json& map = map_of(c.value, {}, "parameter", "a name to read (Pr.7), or {Pr.7: 2} to write");
  for (const auto& [name, value] : map.items()) {
    const double written = number_of(value, name);
    demand(c.inverter().set_parameter(name, written));
    // The clears (ALLC, ...) are written like parameters and cannot be read.
    out[name] = c.inverter().get_parameter(name).value_or(written);
  }
  return out;
}

Json parameters(const Context& c) {
  if (!c.value.is_null() && !c.value.is_string()) invalid("parameters takes nothing, or a text to look for.");
  const std::string filter = c.value.is_string() ? c.value.get<std::string>() : std::string{};
  const auto lower = [](std::string s) {
    std::transform(s.begin(), s.end(), s.begin(), [](unsigned char ch) { return std::tolower(ch); });
    return s;
  };
  Json out = Json::array();
  for (const auto& p : c.inverter().parameters()) {
    std::string name = "Pr." + std::to_string(p.id.number);
    if (p.id.sub != 0) name += "." + std::to_string(p.id.sub);
    if (!filter.empty() && lower(name + " " + std::string(p.name)).find(lower(filter)) == std::string::npos) continue;
    const auto value = c.inverter().get_parameter(name);
    out.push_back({{"parameter", name},
                   {"value", value ? Json(*value) : Json()},
                   {"unit", p.unit},
                   {"default", p.factory_default},
                   {"name", p.name}});
  }
  return out;
}

// --- watching ---

Json status(const Context& c) {
  const inverter::Inverter& inv = c.inverter();
  port::DrivePort& drive_port = c.inverter().port();
  Json out;
  out["name"] = c.drive.spec.name;
  out["family"] = inv.family();
  out["model"] = inv.model();
  out["time_s"] = to_seconds(c.plant.now());
  out["powered"] = inv.powered();
  out["motor_source"] = kMotorSources[static_cast<std::size_t>(inv.plant().motor_source())];
  out["ready"] = drive_port.ready();
  out["mode"] = mode_name(drive_port.operation_mode());
  out["display"] = inv.display();
  const std::string alarm = inv.alarm_name();
  out["alarm"] = alarm.empty() ? Json() : Json{{"name", alarm}, {"cause", inv.alarm_cause()}};
  Json history = Json::array();
  for (const std::uint8_t code : drive_port.alarm_history()) {
    if (code == 0) break;
    history.push_back(code);
  }
  out["alarm_history"] = history;
  out["signals"] = Json::object();
  for (const auto& s : inv.signals()) out["signals"][std::string(s.name)] = {{"value", s.value}, {"unit", s.unit}};
  out["terminals"] = Json::object();
  for (const auto& [name, on] : inv.terminals()) out["terminals"][std::string(name)] = on;
  if (c.drive.board && !c.drive.board->status_led().empty()) out["led"] = c.drive.board->status_led();
  if (c.drive.controller) out["can"] = can_json(c.plant, c.drive);
  out["endpoints"] = endpoints_json(c.drive);
  return out;
}

Json wire(const Context& c) { return wire_faults(c.plant, c.drive, c.value); }

Json led(const Context& c) {
  if (!c.drive.board) refused("the drive has no option board.");
  const std::string_view shown_now = c.drive.board->status_led();
  if (shown_now.empty()) refused("board " + std::string(c.drive.board->type()) + " has no status LED.");
  const auto all = c.drive.board->leds();
  if (all.empty()) return shown_now;
  Json out = Json::object();
  for (const boards::Led& l : all) out[std::string(l.name)] = l.state;
  return out;
}

Json link(const Context& c) {
  if (c.drive.station == nullptr) refused("the drive has no option board on Ethernet.");
  if (!c.value.is_null()) {
    const std::string word = word_of(c.value, {"up", "down"}, "link");
    c.plant.plug_ethernet(c.drive, word == "up");
  }
  return c.drive.station->has_link() ? "up" : "down";
}

Json list(Plant& plant) {
  Json out = Json::array();
  for (const auto& d : plant.drives())
    out.push_back({{"name", d->spec.name},
                   {"family", d->inverter->family()},
                   {"model", d->inverter->model()},
                   {"motor", d->spec.motor.value.name},
                   {"board", d->board ? Json(d->board->type()) : Json()},
                   {"powered", d->inverter->powered()},
                   {"display", d->inverter->display()},
                   {"endpoints", endpoints_json(*d)}});
  return out;
}

Json help() {
  Json out = Json::array();
  for (const CommandInfo& i : commands())
    out.push_back({{"command", i.name},
                   {"for_drive", i.for_drive},
                   {"value", i.value},
                   {"meaning", i.meaning},
                   {"example", i.example}});
  return out;
}

// What a drive offers to faults, switches and terminals, so that a person can find the names.
Json names(const Context& c) {
  Json out;
  for (const auto& [name, on] : c.inverter().terminals()) out["terminals"].push_back(name);
  for (const auto name : c.inverter().analog_terminals())
    out["analog"].push_back(std::string(name) + " (" + std::string(analog_unit(c.inverter().family(), name)) + ")");
  for (const auto name : faults_of(c.drive)) out["faults"].push_back(name);
  for (const Key& k : kKeys) out["keys"].push_back(k.word);
  return out;
}

struct Row {
  CommandInfo info;
  Json (*act)(const Context&);
  // Words of a command line without "=": entries begin at these, or (first) at the first word; none: one value.
  Words keys;
  bool first_is_key = false;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> all{
      {{"list", false, "", "drives of the plant and where they are reached", "list"}, nullptr, {}, false},
      {{"buses", false, "", "CAN buses: bit rate, load, errors, controllers", "buses"}, nullptr, {}, false},
      {{"commands", false, "", "this table", "commands"}, nullptr, {}, false},
      {{"status", true, "", "all signals, terminals, mode and alarm", "conveyor_1 status"}, status, {}, false},
      {{"names", true, "", "names of terminals, keys and faults", "conveyor_1 names"}, names, {}, false},
      {{"power", true, "on | off | cycle", "the drive's own breaker; cycle is off for 2 s", "conveyor_1 power cycle"},
       power,
       {},
       false},
      {{"key", true, "FWD | REV | STOP | PU/EXT | UP | DOWN | MODE | SET", "press a key of the panel",
        "conveyor_1 key PU/EXT"},
       key,
       {},
       false},
      {{"frequency", true, "<f> Hz", "set frequency of the panel", "conveyor_1 frequency 40 Hz"},
       panel_frequency,
       {},
       false},
      {{"reference", true, "<f> Hz | <n> rpm", "set frequency, at the panel or analog input as the mode wants it",
        "conveyor_1 reference 40 Hz"},
       reference,
       {},
       false},
      {{"mode", true, "PU | EXT", "operation mode, by the PU/EXT key", "conveyor_1 mode PU"}, mode, {}, false},
      {{"terminal", true, "<terminal>: on | off", "control terminals", "conveyor_1 terminal STF=on RH=on"},
       terminal,
       {},
       true},
      {{"analog", true, "terminal_<n>: <u> V | <i> mA", "analog inputs", "conveyor_1 analog terminal_2=5V"},
       analog,
       {},
       true},
      {{"run", true, "forward | reverse", "start, by terminal or panel key as the mode wants it",
        "conveyor_1 run forward"},
       run,
       {},
       false},
      {{"stop", true, "", "stop, by the same way", "conveyor_1 stop"}, stop, {}, false},
      {{"reset", true, "", "reset the inverter, by terminal RES", "conveyor_1 reset"}, reset, {}, false},
      {{"parameter", true, "Pr.<n> | Pr.<n>: <value>", "read or write a parameter, as from the panel",
        "conveyor_1 parameter Pr.7=2.5"},
       parameter,
       {},
       false},
      {{"parameters", true, "[<text>]", "all parameters, or those whose name holds the text",
        "conveyor_1 parameters brake"},
       parameters,
       {},
       false},
      {{"load", true, "torque, linear, quadratic, hoist: <t> Nm; inertia: <j> kg m2; over: <t> s",
        "the driven machine; what is not named stays; torque may take its time", "conveyor_1 load torque 12 Nm"},
       load,
       {"torque", "linear", "quadratic", "hoist", "inertia", "over"},
       false},
      {{"shaft", true, "locked | free", "block or free the shaft", "conveyor_1 shaft locked"}, shaft, {}, false},
      {{"motor", true, "inverter | mains | open | table",
        "what the motor hangs on: contactors outside of the drive; table is the plant file's voltage_table",
        "conveyor_1 motor mains"},
       motor,
       {},
       false},
      {{"mains", true, "voltage: <u> V; dip: <d> % with for: <t> ms", "supply voltage; a dip lowers it by d for a time",
        "conveyor_1 mains dip 100 % for 200 ms"},
       mains,
       {"voltage", "dip", "for"},
       false},
      {{"phase_loss", true, "L1 | L2 | L3 | none", "lose a mains phase", "conveyor_1 phase_loss L2"},
       phase_loss,
       {},
       false},
      {{"ambient", true, "<t> C", "temperature around the drive", "conveyor_1 ambient 45 C"}, ambient, {}, false},
      {{"fault", true, "<fault>: on | off", "inject an alarm (E.PE) or a cause (earth_fault); `names` lists them",
        "conveyor_1 fault earth_fault=on"},
       fault,
       {},
       true},
      {{"switch", true, "<switch>: <n>", "switches of the option board", "conveyor_1 switch SW1=2"},
       board_switch,
       {},
       true},
      {{"led", true, "", "the option board's status LED", "conveyor_1 led"}, led, {}, false},
      {{"link", true, "up | down", "plug or pull the Ethernet cable of the option board", "mixer_1 link down"},
       link,
       {},
       false},
      {{"wire", true,
        "drop, duplicate, corrupt, error_frame, bus_off, silence, duplicate_node: <p> % | on; delay, reorder, split: "
        "<t> ms; "
        "truncate: <n>; share: <p> %; nth, every, times: <n>; for: <t> s; id: <hex>; of: own | master | all; "
        "port: can | serial | tcp | udp; error_frame | bus_off | unplugged | plugged | half_open | none",
        "faults on the wires of the drive; they last until none", "conveyor_1 wire drop 10 % id 185"},
       wire,
       wire_words(),
       false},
  };
  return all;
}

const Row* find_row(std::string_view command) {
  const auto it = std::find_if(rows().begin(), rows().end(), [&](const Row& r) { return r.info.name == command; });
  return it == rows().end() ? nullptr : &*it;
}

std::string joined(const std::vector<std::string>& words, std::size_t from = 0) {
  std::string out;
  for (std::size_t i = from; i < words.size(); ++i) out += (i > from ? " " : "") + words[i];
  return out;
}

bool has_colon(const std::string& word) { return word.size() > 1 && word.back() == ':'; }

// Entries begin at "key=", "key:" or one of the row's keys; other words go on with the value before.
Json entries_of(const Row& row, const std::vector<std::string>& words) {
  Json out = Json::object();
  std::string key;
  for (const std::string& written : words) {
    // As a scenario has them: torque: 12 Nm, over: 2 s
    const bool comma = written.size() > 1 && written.back() == ',';
    const std::string word = comma ? written.substr(0, written.size() - 1) : written;
    const std::size_t equals = word.find('=');
    const bool named = std::find(row.keys.begin(), row.keys.end(), word) != row.keys.end();
    if (equals != std::string::npos && equals > 0) {
      key = word.substr(0, equals);
      out[key] = word.substr(equals + 1);
    } else if (named || has_colon(word)) {
      key = named ? word : word.substr(0, word.size() - 1);
      out[key] = "";
    } else if (key.empty()) {
      invalid("\"" + word + "\" belongs to nothing; " + std::string(row.info.name) + " takes " +
              std::string(row.info.value) + ", as in: vinverter ctl " + std::string(row.info.example) + ".");
    } else {
      std::string value = out[key];
      out[key] = value.empty() ? word : value + " " + word;
    }
  }
  return out;
}

Json value_of(const Row& row, const std::vector<std::string>& words) {
  if (words.empty()) return {};
  if (words[0].starts_with('{') || words[0].starts_with('[')) return parse_flow(joined(words));
  const bool pairs = std::any_of(words.begin(), words.end(),
                                 [](const auto& w) { return w.find('=') != std::string::npos || has_colon(w); });
  if (pairs || !row.keys.empty()) return entries_of(row, words);
  if (row.first_is_key && words.size() > 1) return Json{{words[0], joined(words, 1)}};
  if (row.info.name == "parameter" && words.size() > 1) {
    double number = 0;
    if (words.size() == 2 && parse_number(words[1], number)) return Json{{words[0], number}};
    return Json(words);
  }
  return joined(words);
}

CommandResult dispatch(Plant& plant, const Row& row, std::string_view drive, const Json& value) {
  if (!row.info.for_drive) {
    if (!value.is_null()) invalid(std::string(row.info.name) + " takes no value.");
    return row.info.name == "list" ? list(plant) : row.info.name == "buses" ? buses_json(plant) : help();
  }
  DriveUnit* unit = plant.find(drive);
  if (unit == nullptr) {
    Words known;
    for (const auto& d : plant.drives()) known.push_back(d->spec.name);
    invalid((drive.empty() ? "the drive is missing; " : "there is no drive \"" + std::string(drive) + "\"; ") +
            allowed_words(drive, known));
  }
  if (row.info.value.empty() && !value.is_null()) invalid(std::string(row.info.name) + " takes no value.");
  return row.act({plant, *unit, value});
}

template <class MakeValue>
CommandResult guarded(Plant& plant, std::string_view command, std::string_view drive, const MakeValue& make_value) {
  const Row* row = find_row(command);
  if (row == nullptr) {
    Words known;
    for (const Row& r : rows()) known.push_back(r.info.name);
    return Unexpected(CommandError{CommandCode::kUnknownCommand, "unknown command \"" + std::string(command) + "\"; " +
                                                                     allowed_words(command, known)});
  }
  try {
    return dispatch(plant, *row, drive, make_value(*row));
  } catch (const Refuse& r) {
    return Unexpected(r.error);
  }
}

}  // namespace

const std::vector<CommandInfo>& commands() {
  static const std::vector<CommandInfo> all = [] {
    std::vector<CommandInfo> out;
    for (const Row& r : rows()) out.push_back(r.info);
    return out;
  }();
  return all;
}

CommandResult execute(Plant& plant, std::string_view command, std::string_view drive, const Json& value) {
  return guarded(plant, command, drive, [&](const Row&) { return value; });
}

CommandResult execute_words(Plant& plant, std::string_view command, std::string_view drive,
                            const std::vector<std::string>& words) {
  return guarded(plant, command, drive, [&](const Row& row) { return value_of(row, words); });
}

std::string_view mode_name(port::OperationMode mode) {
  switch (mode) {
    case OperationMode::kExternal: return "EXT";
    case OperationMode::kPu: return "PU";
    case OperationMode::kNetwork: return "NET";
    case OperationMode::kCombined1: return "EXT/PU combined 1";
    case OperationMode::kCombined2: return "EXT/PU combined 2";
  }
  return "";
}

Json endpoints_json(const DriveUnit& drive) {
  Json out = Json::array();
  if (drive.tcp)
    out.push_back(
        {{"protocol", "modbus-tcp"}, {"host", drive.tcp->host}, {"port", drive.tcp->port}, {"unit", drive.unit()}});
  if (drive.serial) out.push_back({{"protocol", "modbus-rtu"}, {"path", drive.serial->path}, {"unit", drive.unit()}});
  if (drive.ethernet_ip)
    out.push_back({{"protocol", "ethernet-ip"},
                   {"host", drive.ethernet_ip->host},
                   {"tcp", drive.ethernet_ip->tcp},
                   {"udp_io", drive.ethernet_ip->udp_io}});
  if (drive.can) {
    Json can{{"protocol", "canopen"}, {"node", drive.can_node()}, {"bitrate", drive.can->bitrate}};
    const auto put = [&](const char* key, const std::string& value) {
      if (!value.empty()) can[key] = value;
    };
    put("socketcan", drive.can->socketcan);
    put("socketcand", drive.can->socketcand);
    put("slcan", drive.can->slcan);
    put("udp_multicast", drive.can->udp_multicast);
    put("channel", drive.can->channel);
    out.push_back(std::move(can));
  }
  return out;
}

}  // namespace vinv::rig
