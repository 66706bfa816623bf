// A plant that never runs: what a scenario's words are tried on before the run, so that `check` knows every terminal,
// parameter, fault and signal of the drives that the file names, and says what the control socket would say.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/kernel/scheduler.hpp"
#include "sim/rig/catalogue.hpp"
#include "sim/rig/commands.hpp"
#include "sim/rig/plant.hpp"
#include "sim/scenario/observation.hpp"

namespace vinv::scenario {

class Trial {
 public:
  // Throws PlantFileError if the plant cannot be built.
  Trial(const rig::PlantFile& plant, const rig::Catalogue& catalogue);

  const Observer& observer(std::size_t drive) const { return *observers_[drive]; }
  std::vector<std::string_view> drive_names() const;
  bool has_parameter(std::size_t drive, std::string_view name);

  // Why this can never work on this drive, as a sentence; empty if it can. What depends on the drive's mode or state
  // then is the run's business.
  std::optional<std::string> objection(std::size_t drive, std::string_view command, const rig::Json& value);

 private:
  std::optional<std::string> parameter_objection(std::size_t drive, const rig::Json& value);
  void start_up();

  kernel::Scheduler scheduler_;
  std::unique_ptr<rig::Plant> plant_;
  std::vector<std::unique_ptr<Observer>> observers_;
  bool started_ = false;
};

}  // namespace vinv::scenario
