// Reads lists of steps into a flat program: bodies of `repeat` and `during` stand between their begin and end.
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/expectation_reader.hpp"
#include "sim/scenario/scenario_file.hpp"
#include "sim/scenario/trial.hpp"

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

// A time within [minimum, maximum] of the given ones.
std::optional<Duration> read_duration(const YAML::Node& node, const std::string& what, Duration minimum,
                                      rig::Problems& problems);

class StepReader {
 public:
  // folder: files that steps name are relative to it.
  StepReader(Trial& trial, const LoadOptions& options, rig::Problems& problems, std::string folder)
      : trial_(trial), options_(options), problems_(problems), folder_(std::move(folder)) {}

  Track track(const std::string& name, const YAML::Node& list, const Variables& variables);
  std::size_t watches() const { return watches_; }

 private:
  struct StepMap;  // one step's keys

  void steps(const YAML::Node& list, const std::string& where, const Variables& variables, int depth,
             std::vector<Step>& out);
  void step(const YAML::Node& node, const Variables& variables, int depth, std::vector<Step>& out);
  bool pace(const StepMap& map, Step& step, const ExpectationReader& reader);
  void action(const StepMap& map, const YAML::Node& value, Step& step);
  void repeat(const YAML::Node& value, Step step, const Variables& variables, int depth, std::vector<Step>& out);
  void watch(const StepMap& map, const YAML::Node& value, Step step, const Variables& variables, int depth,
             std::vector<Step>& out);
  bool follows(const YAML::Node& value, const ExpectationReader& reader, Watch& w);
  std::optional<Step::What> check(const StepMap& map, const YAML::Node& value, const ExpectationReader& reader);
  std::optional<Step::What> reached(const YAML::Node& value, const ExpectationReader& reader);
  std::optional<Step::What> ramp(const YAML::Node& value, const ExpectationReader& reader);
  std::optional<Step::What> trip(const YAML::Node& value, const ExpectationReader& reader, std::size_t drive);
  std::optional<Step::What> frame(const std::string& word, const YAML::Node& value, const Step& step);

  Trial& trial_;
  const LoadOptions& options_;
  rig::Problems& problems_;
  std::string folder_;
  std::size_t watches_ = 0;
  std::size_t count_ = 0;
  bool too_many_ = false;
};

}  // namespace vinv::scenario
