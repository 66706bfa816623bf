// Reads lists of steps into a flat program: bodies of `repeat` and `during` stand between their begin and end.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/check_reader.hpp"
#include "sim/scenario/expectation_reader.hpp"
#include "sim/scenario/scenario_file.hpp"
#include "sim/scenario/trial.hpp"

namespace vinv::scenario {

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
  std::vector<std::string_view> masters_of(std::size_t drive) const;
  void repeat(const YAML::Node& value, Step step, const Variables& variables, int depth, std::vector<Step>& out);
  void watch(const StepMap& map, const YAML::Node& value, Step step, const Variables& variables, int depth,
             std::vector<Step>& out);
  std::optional<Step::What> frame(const std::string& word, const YAML::Node& value, const Step& step,
                                  const CheckReader& checks);

  Trial& trial_;
  const LoadOptions& options_;
  rig::Problems& problems_;
  std::string folder_;
  std::size_t watches_ = 0;
  std::size_t count_ = 0;
  bool too_many_ = false;
};

}  // namespace vinv::scenario
