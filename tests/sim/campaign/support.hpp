// Campaigns as text, and folders that vanish.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "sim/campaign/campaign_file.hpp"
#include "sim/campaign/campaign_run.hpp"
#include "tests/support/read_file.hpp"

namespace vinv::campaign {

namespace fs = std::filesystem;

namespace testing {

inline scenario::LoadOptions load_options() {
  scenario::LoadOptions options;
  options.catalogue = rig::shipped_catalogue();
  return options;
}

// The check fails above 10 Hz.
inline const char* const kScenario =
    "scenario:\n"
    "  plant:\n"
    "    drives:\n"
    "      - name: pump\n"
    "        inverter: { model: FR-E540-0.75K }\n"
    "        load: { inertia_kg_m2: 0.002, torque: { constant_Nm: 0.5 } }\n"
    "        parameters: { Pr.7: 0.1, Pr.8: 0.1 }\n"
    "  limit: 5 s\n"
    "  variables: { speed: 5 Hz, pause: 100 ms }\n"
    "  steps:\n"
    "    - { when: ready, reference: $speed }\n"
    "    - { after: $pause, run: forward }\n"
    "    - { when: at_reference, within: 2 s }\n"
    "    - check: { output_frequency: below 10.2 Hz }\n";

inline std::string file(const std::string& variations) {
  return std::string("# A test.\n") + kScenario + "variations:\n" + variations;
}

inline Campaign read(const std::string& variations) {
  return parse_campaign(file(variations), "test.yaml", load_options());
}

// Everything that is wrong with a file, as a user sees it.
inline std::string mistakes(const std::string& text) {
  try {
    parse_campaign(text, "test.yaml", load_options());
  } catch (const CampaignFileError& e) {
    return e.what();
  }
  return "none";
}

struct Folder {
  fs::path path;
  explicit Folder(const std::string& name)
      : path(fs::temp_directory_path() / ("vinv-campaign-" + name + "-" + std::to_string(::getpid()))) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
};

inline std::string content(const std::string& path) { return vinv::test::read_file(path); }

inline CampaignRunOptions run_options(const Folder& folder) {
  CampaignRunOptions options;
  options.load = load_options();
  options.folder = folder.path.string();
  options.build = "test build";
  options.on_trouble = [](const std::string& s) { ADD_FAILURE() << s; };
  return options;
}

}  // namespace testing
}  // namespace vinv::campaign
