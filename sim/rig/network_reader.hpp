// The networks of a plant file: those that it names, and those that boards name by address or leave to the default.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/rig/plant_file.hpp"
#include "sim/rig/yaml_map.hpp"

namespace vinv::rig {

class NetworkReader {
 public:
  // Both outlive the reader; networks are added to file.
  NetworkReader(PlantFile& file, Problems& problems) : file_(file), problems_(problems) {}

  // The mapping `networks`.
  void read(const YAML::Node& node);

  // What a board's key names. node: where it stands, nullptr for a default. Empty: none, or a problem was added.
  std::optional<std::size_t> serial_line(const std::string& text, const YAML::Node* node, const DriveSpec& drive);
  std::optional<std::size_t> tcp_port(const std::string& text, const YAML::Node* node, const DriveSpec& drive);
  std::optional<std::size_t> can_bus(const std::string& text, const YAML::Node* node, const DriveSpec& drive);

  // After all drives: networks that cannot be told apart.
  void check() { check_can_endpoints(); }

 private:
  enum class Kind { kSerial, kModbusTcp, kCan };
  struct Named {
    std::string name;
    Kind kind = Kind::kSerial;
    std::size_t index = 0;
  };
  static std::string_view words(Kind kind);

  void serial(const YamlMap& net, const std::string& name, const std::string& device);
  void modbus_tcp(const YamlMap& net, const std::string& name, const std::string& address);
  void can(const YamlMap& net, const std::string& name, const std::string& way);
  std::optional<TcpNetwork> address(const YAML::Node& node, const std::string& what, const std::string& text,
                                    std::string_view example);
  std::string other_kind(const Named& named, std::string_view key, const DriveSpec& drive) const;
  std::vector<std::string_view> names(Kind kind) const;
  const Named* find(std::string_view name) const;
  void check_can_endpoints();

  PlantFile& file_;
  Problems& problems_;
  std::vector<Named> named_;
};

}  // namespace vinv::rig
