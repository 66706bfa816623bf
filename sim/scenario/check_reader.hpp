// Reads what a step checks: check, reached, ramp, trip, expect_frame.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>

#include "sim/rig/yaml_map.hpp"
#include "sim/scenario/expectation_reader.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/trial.hpp"

namespace vinv::scenario {

// Each gives nothing if there was a problem.
class CheckReader {
 public:
  CheckReader(Trial& trial, std::size_t drive, rig::Problems& problems)
      : trial_(trial), drive_(drive), problems_(problems), reader_(trial, drive, problems) {}

  std::optional<Step::What> check(const YAML::Node& value) const;
  std::optional<Step::What> reached(const YAML::Node& value) const;
  std::optional<Step::What> ramp(const YAML::Node& value) const;
  std::optional<Step::What> trip(const YAML::Node& value) const;
  std::optional<Step::What> expect_frame(const YAML::Node& value) const;

 private:
  Trial& trial_;
  std::size_t drive_;
  rig::Problems& problems_;
  ExpectationReader reader_;
};

}  // namespace vinv::scenario
