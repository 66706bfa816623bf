#include "sim/rig/plant_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "sim/base/archive.hpp"
#include "sim/rig/ethernet_reader.hpp"
#include "sim/rig/motor_source.hpp"
#include "sim/rig/network_reader.hpp"
#include "sim/rig/node_plan.hpp"
#include "sim/rig/trace.hpp"
#include "sim/rig/words.hpp"
#include "sim/rig/yaml_map.hpp"

namespace vinv::rig {
namespace {

using Keys = std::vector<std::string_view>;

constexpr std::string_view kDefaultFamily = "fr-e500";
constexpr std::string_view kDefaultModel = "FR-E540-1.5K";
constexpr std::string_view kDefaultTcp = "127.0.0.1:1502";

std::string what_of(const std::string& file, const std::vector<Problem>& problems) {
  std::string out;
  for (const Problem& p : problems) {
    if (!out.empty()) out += '\n';
    out += file;
    if (p.at.line > 0) out += ":" + std::to_string(p.at.line) + ":" + std::to_string(p.at.column);
    out += ": " + p.message;
  }
  return out;
}

bool contains(const std::vector<std::string_view>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string stem(const std::string& path) {
  std::string s = path.substr(path.find_last_of('/') + 1);
  s = s.substr(0, s.find_first_of('.'));
  for (char& c : s)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') c = '_';
  return is_plant_word(s) ? s : "plant";
}

class Loader {
 public:
  Loader(const std::string& path, const Catalogue& catalogue) : catalogue_(catalogue) {
    file_.path = path;
    file_.name = stem(path);
  }

  PlantFile load(std::string_view text) {
    const auto root =
        read_document(text, "a plant file", "a plant needs at least \"drives:\" with one drive.", problems_);
    return load_node(root ? &*root : nullptr);
  }

  // nullptr: no document, which is a problem already.
  PlantFile load_node(const YAML::Node* root) {
    if (root != nullptr) plant(*root);
    if (!problems_.empty()) {
      auto list = problems_.take();
      std::stable_sort(list.begin(), list.end(), [](const Problem& a, const Problem& b) {
        return std::pair(a.at.line, a.at.column) < std::pair(b.at.line, b.at.column);
      });
      throw PlantFileError(file_.path, std::move(list));
    }
    if (root != nullptr) {
      YAML::Emitter said;
      said << YAML::Flow << *root;
      file_.checksum = snapshot_checksum({reinterpret_cast<const std::uint8_t*>(said.c_str()), said.size()});
    }
    return std::move(file_);
  }

 private:
  static const Keys& keys(const char* path) { return plant_file_keys().at(path); }

  void plant(const YAML::Node& root) {
    const YamlMap map(root, "the plant file", &keys(""), problems_);
    if (!map) return;
    if (const auto name = map.text("name")) {
      if (is_plant_word(*name))
        file_.name = *name;
      else
        bad_word(*map.find("name"), "name of the plant", *name);
    }
    if (const YAML::Node* node = map.find("networks")) networks_.read(*node);
    const YAML::Node* drives = map.find("drives");
    if (drives == nullptr) {
      if (std::none_of(map.entries().begin(), map.entries().end(), [](const auto& e) { return e.key == "drives"; }))
        problems_.add(map.at(), "\"drives\" is missing; a plant needs a list of at least one drive.");
      return;
    }
    if (!drives->IsSequence() || drives->size() == 0 || drives->size() > kMaxDrives) {
      problems_.add(*drives,
                    "drives is " +
                        (drives->IsSequence() ? "a list of " + std::to_string(drives->size()) : kind_of(*drives)) +
                        "; allowed: a list (- name: ...) of 1 to " + std::to_string(kMaxDrives) + " drives.");
      return;
    }
    for (const auto& node : *drives) drive(node);
    networks_.check();
    assign_nodes(file_, problems_);
    assign_addresses(file_, problems_);
  }

  void bad_word(const YAML::Node& node, const std::string& what, const std::string& word) {
    problems_.add(node, what + " is \"" + word + "\"; allowed: a letter, then letters, digits, _ and -, 64 in all.");
  }

  // --- drives ---

  void drive(const YAML::Node& node) {
    DriveSpec d;
    const std::string number = std::to_string(file_.drives.size() + 1);
    d.at = position_of(node);
    const YamlMap map(node, "drive " + number, &keys("drives[]"), problems_);
    d.name = "drive_" + number;
    if (const auto name = map ? map.text("name") : std::nullopt) {
      d.name = *name;
      if (!is_plant_word(*name)) bad_word(*map.find("name"), "name of drive " + number, *name);
    }
    const auto same =
        std::find_if(file_.drives.begin(), file_.drives.end(), [&](const DriveSpec& o) { return o.name == d.name; });
    if (same != file_.drives.end())
      problems_.add(map && map.has("name") ? position_of(*map.find("name")) : d.at,
                    "the name \"" + d.name + "\" is taken by the drive in line " + std::to_string(same->at.line) + ".");
    if (map) {
      const bool model_known = inverter(map, d);
      motor(map, d, model_known);
      load(map, d);
      surroundings(map, d);
      board(map, d);
      inputs(map, d);
      parameters(map, d);
    }
    file_.drives.push_back(std::move(d));
  }

  bool inverter(const YamlMap& map, DriveSpec& d) {
    d.family = kDefaultFamily;
    d.model = {std::string(kDefaultModel), d.at};
    const YAML::Node* node = map.find("inverter");
    if (node == nullptr) return true;
    const YamlMap inv(*node, "inverter of " + d.name, &keys("drives[].inverter"), problems_);
    if (!inv) return false;
    if (inv.has("family")) {
      const auto family = inv.word("family", catalogue_.families());
      if (!family) return false;
      d.family = *family;
    }
    std::vector<std::string_view> models;  // without a family the model says which one it is
    for (const std::string_view family : catalogue_.families()) {
      const auto of_family = catalogue_.models(family);
      if (family == d.family || !inv.has("family")) models.insert(models.end(), of_family.begin(), of_family.end());
    }
    if (!inv.has("model")) {
      if (!contains(models, d.model.value) && !models.empty()) d.model.value = models.front();
      return true;
    }
    const YAML::Node& written = *inv.find("model");
    const std::string_view family = written.IsScalar() ? family_of(written.Scalar()) : std::string_view{};
    if (!family.empty() && family != d.family && inv.has("family")) {
      problems_.add(written, written.Scalar() + " of " + d.name + " is a model of family " + std::string(family) +
                                 ", not " + d.family + ".");
      return false;
    }
    const auto model = inv.word("model", models);
    if (!model) return false;
    d.model = {*model, position_of(written)};
    d.family = family;
    return true;
  }

  // Empty: there is no such model.
  std::string_view family_of(std::string_view model) const {
    for (const std::string_view family : catalogue_.families())
      if (contains(catalogue_.models(family), model)) return family;
    return {};
  }

  void motor(const YamlMap& map, DriveSpec& d, bool model_known) {
    d.motor.at = d.model.at;
    if (model_known) d.motor.value = default_motor(d.model.value);
    const YAML::Node* node = map.find("motor");
    if (node == nullptr) return;
    const YamlMap m(*node, "motor of " + d.name, &keys("drives[].motor"), problems_);
    if (!m) return;
    d.motor.at = m.at();
    auto& motor = d.motor.value;
    bool from_preset = false;
    if (m.has("preset")) {
      const auto preset = m.word("preset", plant::machine_names());
      if (!preset) return;
      motor = *plant::find_machine(*preset);
      from_preset = true;
    } else if (m.entries().empty()) {
      return;
    } else {
      motor = {};
      motor.name = d.name + "_motor";
    }
    struct Field {
      const char* key;
      double plant::MachineParameters::*value;
      Range range;
      bool required;
    };
    static constexpr double kHuge = 1e9;
    static const std::array fields{
        Field{"R_s_ohm", &plant::MachineParameters::R_s_ohm, {0, 1e5, true}, true},
        Field{"R_r_ohm", &plant::MachineParameters::R_r_ohm, {0, 1e5, true}, true},
        Field{"L_ls_H", &plant::MachineParameters::L_ls_h, {0, 1e3, true}, true},
        Field{"L_lr_H", &plant::MachineParameters::L_lr_h, {0, 1e3, true}, true},
        Field{"L_m_H", &plant::MachineParameters::L_m_h, {0, 1e4, true}, true},
        Field{"inertia_kg_m2", &plant::MachineParameters::inertia_kg_m2, {0, 1e6, true}, true},
        Field{"rated_power_W", &plant::MachineParameters::rated_power_w, {0, kHuge, true}, true},
        Field{"rated_voltage_V", &plant::MachineParameters::rated_voltage_v_rms, {0, 1e5, true}, true},
        Field{"rated_frequency_Hz", &plant::MachineParameters::rated_frequency_hz, {0, 1000, true}, false},
        Field{"rated_current_A", &plant::MachineParameters::rated_current_a_rms, {0, 1e6, true}, true},
        Field{"rated_speed_rpm", &plant::MachineParameters::rated_speed_rpm, {0, 1e5, true}, true},
    };
    std::vector<std::string_view> missing;
    for (const Field& f : fields) {
      if (const auto v = m.number(f.key, f.range)) motor.*f.value = *v;
      if (f.required && !from_preset && !m.has(f.key)) missing.push_back(f.key);
    }
    if (const auto poles = m.integer("pole_pairs", 1, 50)) motor.pole_pairs = static_cast<int>(*poles);
    if (!missing.empty()) {
      problems_.add(m.at(), "motor of " + d.name + " lacks " + join(missing) +
                                "; give a preset, or all values of the equivalent circuit and the name plate.");
    } else if (const auto fine = plant::validate(motor); !fine && !any_bad(m)) {
      problems_.add(m.at(), "motor of " + d.name + " is refused: " + fine.error());
    }
  }

  // A value of this mapping is a problem already; what follows from it would only confuse.
  bool any_bad(const YamlMap& map) {
    auto list = problems_.take();
    const bool bad = std::any_of(list.begin(), list.end(), [&](const Problem& p) {
      return std::any_of(map.entries().begin(), map.entries().end(),
                         [&](const auto& e) { return p.at.line == e.at.line && p.at.column >= e.at.column; });
    });
    for (Problem& p : list) problems_.add(p.at, std::move(p.message));
    return bad;
  }

  static constexpr Range kTorque{-1e6, 1e6};
  static constexpr Range kTorqueFromZero{0, 1e6};

  void load(const YamlMap& map, DriveSpec& d) {
    d.load.at = d.at;
    d.load.value = default_load(d.motor.value);
    const YAML::Node* node = map.find("load");
    if (node == nullptr) return;
    const YamlMap l(*node, "load of " + d.name, &keys("drives[].load"), problems_);
    if (!l) return;
    d.load.at = l.at();
    auto& out = d.load.value;
    if (const auto inertia = l.number("inertia_kg_m2", {0, 1e6})) out.inertia_kg_m2 = *inertia;
    if (const YAML::Node* friction = l.find("friction")) {
      const YamlMap f(*friction, "friction of " + d.name, &keys("drives[].load.friction"), problems_);
      if (f) {
        d.friction.viscous_nm_s = f.number("viscous_Nm_s", {0, 1e6});
        d.friction.coulomb_nm = f.number("coulomb_Nm", {0, 1e6});
      }
    }
    if (const YAML::Node* torque = l.find("torque")) torque_terms(*torque, d);
    if (const auto fine = plant::validate(out); !fine && !any_bad(l))
      problems_.add(l.at(), "load of " + d.name + " is refused: " + fine.error());
  }

  void torque_terms(const YAML::Node& node, DriveSpec& d) {
    const YamlMap t(node, "torque of " + d.name, &keys("drives[].load.torque"), problems_);
    if (!t) return;
    auto& out = d.load.value;
    const double inertia = out.inertia_kg_m2;
    out = {};
    out.inertia_kg_m2 = inertia;
    const double rated_rad_s = d.motor.value.rated_speed_rpm * std::numbers::pi / 30;
    if (const auto v = t.number("constant_Nm", kTorqueFromZero)) out.constant_nm = *v;
    if (const auto v = t.number("linear_Nm_at_rated", kTorqueFromZero); v && rated_rad_s > 0)
      out.linear_nm_s = *v / rated_rad_s;
    if (const auto v = t.number("quadratic_Nm_at_rated", kTorqueFromZero); v && rated_rad_s > 0)
      out.quadratic_nm_s2 = *v / (rated_rad_s * rated_rad_s);
    if (const auto v = t.number("hoist_Nm", kTorque)) out.hoist_nm = *v;
    if (const YAML::Node* table = t.find("table")) torque_table(*table, d);
  }

  void torque_table(const YAML::Node& node, DriveSpec& d) {
    constexpr std::size_t kMaxPoints = 10000;
    if (!node.IsSequence() || node.size() == 0 || node.size() > kMaxPoints) {
      problems_.add(node, "table in torque of " + d.name + " is " +
                              (node.IsSequence() ? "empty or too long" : kind_of(node)) + "; allowed: a list of 1 to " +
                              std::to_string(kMaxPoints) + " points as {time_s: 1.5, torque_Nm: 4}.");
      return;
    }
    for (const auto& item : node) {
      const YamlMap p(item, "a point in table of " + d.name, &keys("drives[].load.torque.table[]"), problems_);
      if (!p) continue;
      const auto time_s = p.number("time_s", {0, 1e9});
      const auto torque_nm = p.number("torque_Nm", kTorque);
      if (!p.has("time_s") || !p.has("torque_Nm")) {
        problems_.add(p.at(), "a point in table of " + d.name + " needs both time_s and torque_Nm.");
        continue;
      }
      if (!time_s || !torque_nm) continue;
      if (!d.load.value.table.empty() && *time_s <= d.load.value.table.back().time_s) {
        problems_.add(*p.find("time_s"), "time_s in table of " + d.name + " is " + p.find("time_s")->Scalar() +
                                             "; allowed: more than that of the point before.");
        continue;
      }
      d.load.value.table.push_back({*time_s, *torque_nm});
    }
  }

  void surroundings(const YamlMap& map, DriveSpec& d) {
    if (const YAML::Node* node = map.find("mains")) {
      const YamlMap m(*node, "mains of " + d.name, &keys("drives[].mains"), problems_);
      if (m) {
        d.mains_v_rms = m.number("voltage_V", {0, 1000});
        d.source_resistance_ohm = m.number("source_resistance_ohm", {0, 100, true});
        if (const auto v = m.number("frequency_Hz", {40, 70})) d.mains_frequency_hz = *v;
        if (const auto v = m.number("phase_deg", {-360, 360})) d.mains_phase_rad = *v * std::numbers::pi / 180;
      }
    }
    if (const YAML::Node* file = map.find("voltage_table")) voltage_table(*file, d);
    if (const auto v = map.word("motor_source", kMotorSources)) {
      d.motor_source = *motor_source_of(*v);
      if (d.motor_source == plant::MotorSource::kTable && !map.has("voltage_table"))
        problems_.add(*map.find("motor_source"), "motor_source of " + d.name + " is table; add a voltage_table.");
    }
    if (const YAML::Node* node = map.find("losses")) {
      const YamlMap l(*node, "losses of " + d.name, &keys("drives[].losses"), problems_);
      if (l) {
        d.losses.iron_loss_w_at_rated = l.number("iron_W_at_rated", {0, 1e6});
        d.losses.inverter_loss_fraction = l.number("inverter_fraction", {0, 0.5});
        d.losses.standby_w = l.number("standby_W", {0, 1e4});
      }
    }
    if (const auto v = map.on_off("ideal")) d.ideal = *v;
    if (const auto v = map.number("brake_resistor_ohm", {0, 1e6})) d.brake_resistor_ohm = *v;
    if (const auto v = map.number("ambient_C", {-40, 100})) d.ambient_c = *v;
    if (const auto v = map.on_off("power")) d.power = *v;
    if (const auto v = map.word("solver", {"erk", "cvode_bdf", "rk4"}))
      d.solver = *v == "erk"         ? plant::SolverChoice::kErk
                 : *v == "cvode_bdf" ? plant::SolverChoice::kCvodeBdf
                                     : plant::SolverChoice::kRk4;
  }

  // time_s, alpha V, beta V: beside this file.
  void voltage_table(const YAML::Node& node, DriveSpec& d) {
    const auto name = read_text(node, "voltage_table of " + d.name, problems_);
    if (!name) return;
    const std::string path = (std::filesystem::path(file_.path).parent_path() / *name).lexically_normal().string();
    const auto refuse = [&](const std::string& why) { problems_.add(node, path + " " + why); };
    const auto table = load_trace(path);
    if (!table) return refuse(table.error());
    const Trace::Column* alpha = table->find("alpha");
    const Trace::Column* beta = table->find("beta");
    if (alpha == nullptr || beta == nullptr || table->columns.size() != 2 || alpha->unit != "V" || beta->unit != "V")
      return refuse("is no voltage table: its header must be time_s,alpha V,beta V.");
    for (std::size_t i = 0; i < table->time_s.size(); ++i)
      d.voltage_table.push_back({table->time_s[i], alpha->values[i], beta->values[i]});
    if (const auto fine = plant::validate(d.voltage_table); !fine) refuse("is refused: " + fine.error() + ".");
  }

  // --- boards ---

  void board(const YamlMap& map, DriveSpec& d) {
    BoardSpec b;
    b.type.at = d.at;
    b.node.at = d.at;
    for (const std::string_view type : catalogue_.board_types()) {
      const auto fits = catalogue_.board_families(type);
      if (std::find(fits.begin(), fits.end(), d.family) != fits.end() && b.type.value.empty()) b.type.value = type;
    }
    std::string rtu = "pty";
    std::string tcp{kDefaultTcp};
    const YAML::Node* rtu_node = nullptr;
    std::string can{kDefaultCanName};
    const YAML::Node* tcp_node = nullptr;
    const YAML::Node* can_node = nullptr;
    std::optional<YamlMap> m;
    if (const YAML::Node* node = map.find("board")) {
      if (node->IsScalar() && node->Scalar() == "none") return;
      m.emplace(*node, "board of " + d.name, &keys("drives[].board"), problems_);
      if (!*m) return;
      b.type.at = m->at();
      b.node.at = m->at();
      if (m->has("type")) {
        const auto type = m->word("type", catalogue_.board_types());
        if (!type) return;
        b.type = {*type, position_of(*m->find("type"))};
        const auto fits = catalogue_.board_families(*type);
        if (std::find(fits.begin(), fits.end(), d.family) == fits.end())
          problems_.add(b.type.at,
                        "board " + *type + " does not fit family " + d.family + "; it fits " + join(fits) + ".");
      }
      if (const auto v = m->integer("node", 1, 247)) {
        b.node = {static_cast<unsigned>(*v), position_of(*m->find("node"))};
      }
      if (const auto v = m->text("modbus_rtu")) rtu = *v, rtu_node = m->find("modbus_rtu");
      if (const auto v = m->text("modbus_tcp")) tcp = *v, tcp_node = m->find("modbus_tcp");
      if (const auto v = m->text("network")) can = *v, can_node = m->find("network");
    }
    if (b.type.value.empty()) return;
    const boards::BoardTraits traits = catalogue_.board_traits(b.type.value);
    if (m) wrong_keys(*m, b.type.value, traits);
    if (m && traits.connectors > 0)
      if (const auto v = m->integer("connector", 1, traits.connectors)) b.connector = static_cast<int>(*v);
    if (m)
      if (const auto v = m->word("contact", {"good", "bad"})) b.bad_contact = *v == "bad";
    if (traits.ethernet) b.ethernet = read_ethernet(m ? &*m : nullptr, d, problems_);
    if (traits.fieldbus) {
      b.serial = networks_.serial_line(rtu, rtu_node, d);
      b.tcp = networks_.tcp_port(tcp, tcp_node, d);
      b.can = networks_.can_bus(can, can_node, d);
      if (can_node != nullptr) b.can_at = position_of(*can_node);
    }
    d.board = b;
  }

  // Keys of other boards.
  void wrong_keys(const YamlMap& map, const std::string& type, const boards::BoardTraits& traits) {
    const auto refuse = [&](const Keys& keys, const char* what) {
      for (const std::string_view key : keys)
        if (map.has(key))
          problems_.add(map.key_position(key), std::string(key) + " in " + map.where() + " belongs to a board " + what +
                                                   "; " + type + " is none.");
    };
    if (!traits.ethernet) refuse(ethernet_keys(), "on Ethernet");
    if (!traits.fieldbus) refuse({"modbus_rtu", "modbus_tcp", "network"}, "on Modbus or CAN");
    if (traits.last_node == 0) refuse({"node"}, "with address switches");
    if (traits.connectors == 0) refuse({"connector"}, "of an inverter with several option connectors");
  }

  // --- inputs and parameters ---

  void inputs(const YamlMap& map, DriveSpec& d) {
    if (const YAML::Node* node = map.find("terminals")) {
      const YamlMap t(*node, "terminals of " + d.name, nullptr, problems_);
      for (const auto& e : t.entries())
        if (!e.empty)
          if (const auto on = read_switch(e.value, "terminal " + e.key + " of " + d.name, problems_))
            d.terminals.push_back({{e.key, e.at}, *on});
    }
    if (const YAML::Node* node = map.find("analog")) {
      const YamlMap a(*node, "analog of " + d.name, nullptr, problems_);
      for (const auto& e : a.entries())
        if (!e.empty)
          if (const auto value =
                  read_number(e.value, "analog terminal " + e.key + " of " + d.name, {-30, 30}, problems_))
            d.analog.push_back({{e.key.substr(e.key.starts_with("terminal_") ? 9 : 0), e.at}, *value});
    }
  }

  void parameters(const YamlMap& map, DriveSpec& d) {
    const YAML::Node* node = map.find("parameters");
    if (node == nullptr) return;
    const YamlMap p(*node, "parameters of " + d.name, nullptr, problems_);
    for (const auto& e : p.entries()) {
      if (e.empty) continue;
      const auto value = read_number(e.value, e.key + " of " + d.name, {-1e9, 1e9}, problems_);
      if (value) d.parameters.push_back({{e.key, e.at}, {*value, position_of(e.value)}});
    }
  }

  const Catalogue& catalogue_;
  PlantFile file_;
  Problems problems_;
  NetworkReader networks_{file_, problems_};
};

}  // namespace

PlantFileError::PlantFileError(const std::string& file, std::vector<Problem> problems)
    : std::runtime_error(what_of(file, problems)), problems_(std::move(problems)) {}

bool is_plant_word(std::string_view word) {
  if (word.empty() || word.size() > 64 || std::isalpha(static_cast<unsigned char>(word.front())) == 0) return false;
  return std::all_of(word.begin(), word.end(),
                     [](unsigned char c) { return c < 128 && (std::isalnum(c) || c == '_' || c == '-'); });
}

const std::map<std::string, std::vector<std::string_view>>& plant_file_keys() {
  static const std::map<std::string, Keys> all{
      {"", {"name", "networks", "drives"}},
      {"networks.*", {"serial", "modbus_tcp", "can", "bitrate", "socketcand", "slcan", "channel"}},
      {"drives[]",
       {"name", "inverter", "motor", "motor_source", "voltage_table", "load", "mains", "losses", "ideal",
        "brake_resistor_ohm", "ambient_C", "solver", "power", "board", "terminals", "analog", "parameters"}},
      {"drives[].inverter", {"family", "model"}},
      {"drives[].motor",
       {"preset", "R_s_ohm", "R_r_ohm", "L_ls_H", "L_lr_H", "L_m_H", "pole_pairs", "inertia_kg_m2", "rated_power_W",
        "rated_voltage_V", "rated_frequency_Hz", "rated_current_A", "rated_speed_rpm"}},
      {"drives[].load", {"inertia_kg_m2", "torque", "friction"}},
      {"drives[].load.torque", {"constant_Nm", "linear_Nm_at_rated", "quadratic_Nm_at_rated", "hoist_Nm", "table"}},
      {"drives[].load.torque.table[]", {"time_s", "torque_Nm"}},
      {"drives[].load.friction", {"viscous_Nm_s", "coulomb_Nm"}},
      {"drives[].mains", {"voltage_V", "source_resistance_ohm", "frequency_Hz", "phase_deg"}},
      {"drives[].losses", {"iron_W_at_rated", "inverter_fraction", "standby_W"}},
      {"drives[].board",
       {"type", "node", "modbus_rtu", "modbus_tcp", "network", "address", "bind", "lease", "link_partner", "flash",
        "timing", "connector", "contact"}},
      {"drives[].board.lease", {"address", "mask", "gateway", "name_server", "name_server_2", "domain"}},
      {"drives[].board.flash",
       {"dhcp", "address", "mask", "gateway", "name_server", "name_server_2", "domain", "host_name", "line"}},
  };
  return all;
}

PlantFile parse_plant_file(std::string_view text, const std::string& path, const Catalogue& catalogue) {
  return Loader(path, catalogue).load(text);
}

PlantFile parse_plant_node(const YAML::Node& node, const std::string& path, const Catalogue& catalogue) {
  return Loader(path, catalogue).load_node(&node);
}

PlantFile load_plant_file(const std::string& path, const Catalogue& catalogue) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw PlantFileError(path, {{{}, "is a folder; a plant file is a YAML text."}});
  std::ifstream in(path, std::ios::binary);
  if (!in) throw PlantFileError(path, {{{}, std::string("cannot be read: ") + std::strerror(errno) + "."}});
  // One byte too many is enough for a refusal; a device may never end.
  std::string text(kMaxPlantFileBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw PlantFileError(path, {{{}, "cannot be read: it is no ordinary file."}});
  text.resize(static_cast<std::size_t>(in.gcount()));
  return parse_plant_file(text, path, catalogue);
}

}  // namespace vinv::rig
