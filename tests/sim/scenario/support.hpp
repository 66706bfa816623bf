// Scenarios as text, read and run with the product's own catalogue.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "sim/scenario/runner.hpp"
#include "sim/scenario/scenario_file.hpp"
#include "sim/scenario/virtual_run.hpp"

namespace vinv::scenario::testing {

inline LoadOptions load_options() {
  LoadOptions options;
  options.catalogue = rig::shipped_catalogue();
  return options;
}

// A small drive whose ramps take half a second.
inline const char* const kHead =
    "# A test.\n"
    "plant:\n"
    "  drives:\n"
    "    - inverter: { model: FR-E540-0.75K }\n"
    "      load: { inertia_kg_m2: 0.002, torque: { constant_Nm: 0.5 } }\n"
    "      parameters: { Pr.7: 0.5, Pr.8: 0.5 }\n"
    "limit: 20 s\n";

// The drive runs at 20 Hz after these.
inline const char* const kRunning =
    "steps:\n"
    "  - { when: ready, reference: 20 Hz }\n"
    "  - { after: 200 ms, run: forward }\n"
    "  - { when: at_reference, within: 2 s }\n";

inline Scenario read(const std::string& text, const LoadOptions& options = load_options()) {
  return parse_scenario(text, "test.yaml", options);
}

inline RunResult run(const std::string& text, RunOptions options = {}) {
  const Scenario s = read(text);
  return run_virtual(s, rig::shipped_catalogue(), options);
}

// Further steps of the running drive, one per line.
inline RunResult run_steps(const std::string& steps) { return run(std::string(kHead) + kRunning + steps); }

inline std::string failures(const RunResult& r) {
  std::string out = r.reason;
  for (const CheckResult& c : r.checks)
    if (!c.passed) out += failure_text(r, c);
  return out;
}

inline const CheckResult& only_failure(const RunResult& r) {
  static const CheckResult none{};
  const CheckResult* found = nullptr;
  for (const CheckResult& c : r.checks)
    if (!c.passed) {
      EXPECT_EQ(found, nullptr) << failures(r);
      found = &c;
    }
  EXPECT_NE(found, nullptr);
  return found == nullptr ? none : *found;
}

}  // namespace vinv::scenario::testing
