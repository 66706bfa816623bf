// Variables in a part of a scenario file.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/variables.hpp"

namespace vinv::scenario {

// Replaces variables in the scalars below a node, and puts the texts as written back at the end of its life, so that
// the same nodes can be read again with other values. Positions stay those of the file.
class Substitution {
 public:
  // skip: keys whose values are not touched.
  Substitution(const YAML::Node& node, const Variables& variables, rig::Problems& problems,
               const std::vector<std::string_view>& skip = {});
  ~Substitution();
  Substitution(const Substitution&) = delete;
  Substitution& operator=(const Substitution&) = delete;
  void keep() { undo_.clear(); }
  // A variable could not be replaced, which is a problem already.
  bool failed() const { return failed_; }

 private:
  void visit(YAML::Node node, const Variables& variables, rig::Problems& problems,
             const std::vector<std::string_view>& skip);
  std::vector<std::pair<YAML::Node, std::string>> undo_;
  bool failed_ = false;
};

}  // namespace vinv::scenario
