// The plant file: YAML that names networks, drives, motors, loads and boards. docs/plant-file.md is its reference,
// docs/plant.schema.json its schema. Loading is strict: an unknown key, a wrong type or a value out of range is
// refused with file, line, column, what is allowed, and the nearest known word.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motor_model/plant/power_plant.hpp"
#include "sim/rig/catalogue.hpp"
#include "sim/rig/networks.hpp"

namespace vinv::rig {

template <class T>
struct Located {
  T value{};
  Position at;
};

struct Problem {
  Position at;
  std::string message;
};

// Everything that is wrong with a file, in the order of its lines. what() is one line per problem,
// "demo.yaml:7:13: unknown key ...", as editors and compilers like it.
class PlantFileError : public std::runtime_error {
 public:
  PlantFileError(const std::string& file, std::vector<Problem> problems);
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

// Of a board on Ethernet.
struct EthernetSpec {
  std::uint32_t address = 0;  // where masters reach it; 0: the lowest free one of 127.0.0.2 and up
  bool any_address = false;   // live: its sockets are bound to 0.0.0.0
  boards::EthernetSurroundings surroundings;
  bool fast = false;
  Position at;
};

struct BoardSpec {
  Located<std::string> type;
  Located<unsigned> node;
  std::optional<std::size_t> serial;  // index into PlantFile::serial
  std::optional<std::size_t> tcp;     // index into PlantFile::tcp
  std::optional<std::size_t> can;     // index into PlantFile::can
  Position can_at;                    // where `network` stands; line 0: it is the default
  std::optional<EthernetSpec> ethernet;
  std::optional<int> connector;  // it is not in its own one
  bool bad_contact = false;
};

struct FrictionSpec {
  std::optional<double> viscous_nm_s;
  std::optional<double> coulomb_nm;
};

struct LossSpec {
  std::optional<double> iron_loss_w_at_rated;
  std::optional<double> inverter_loss_fraction;
  std::optional<double> standby_w;
};

struct DriveSpec {
  std::string name;
  Position at;
  std::string family;
  Located<std::string> model;
  Located<plant::MachineParameters> motor;
  Located<plant::LoadSettings> load;
  FrictionSpec friction;
  LossSpec losses;
  bool ideal = false;  // no losses and no friction but those that are named
  std::optional<double> mains_v_rms;
  std::optional<double> source_resistance_ohm;
  double mains_frequency_hz = 50;
  double mains_phase_rad = 0;
  plant::MotorSource motor_source = plant::MotorSource::kInverter;  // at start
  std::vector<plant::VoltagePoint> voltage_table;
  double brake_resistor_ohm = 0;
  double ambient_c = 25;
  plant::SolverChoice solver = plant::SolverChoice::kErk;
  bool power = true;
  std::optional<BoardSpec> board;
  std::vector<std::pair<Located<std::string>, bool>> terminals;
  std::vector<std::pair<Located<std::string>, double>> analog;
  std::vector<std::pair<Located<std::string>, Located<double>>> parameters;
};

struct PlantFile {
  std::string path;  // as errors name it
  std::string name;  // of the plant: `name:`, or the file's name without folder and ending
  std::vector<SerialNetwork> serial;
  std::vector<TcpNetwork> tcp;
  std::vector<CanNetwork> can;
  std::vector<DriveSpec> drives;
  std::uint64_t checksum = 0;  // of what the file says, without comments and line breaks
};

inline constexpr std::size_t kMaxPlantFileBytes = 4 * 1024 * 1024;
inline constexpr std::size_t kMaxDrives = 4096;

// text is the content of the file at path. Throws PlantFileError.
PlantFile parse_plant_file(std::string_view text, const std::string& path, const Catalogue& catalogue);
// Reads the file first; a file that cannot be read is a PlantFileError too.
PlantFile load_plant_file(const std::string& path, const Catalogue& catalogue);

// Keys that the loader knows, by the path of the mapping that holds them ("", "drives[]", "drives[].load" ...).
const std::map<std::string, std::vector<std::string_view>>& plant_file_keys();

// A name that can be a file name, a terminal-safe word and part of a path: letters, digits, _ and -, at most 64.
bool is_plant_word(std::string_view word);

}  // namespace vinv::rig
