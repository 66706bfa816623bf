// A scenario in real time: the plant's wires are open to real masters, its control socket answers, and the file's
// tolerance applies. Its EEPROMs live in a folder of the run's own: a scenario starts from its own file and leaves
// nothing.
#pragma once

#include <functional>
#include <string>

#include "sim/rig/catalogue.hpp"
#include "sim/scenario/runner.hpp"

namespace vinv::scenario {

// notice: what a person should know meanwhile, one or more lines. Never throws: what goes wrong is in the result.
RunResult run_live(const Scenario& scenario, const rig::Catalogue& catalogue, const RunOptions& options,
                   const std::function<void(const std::string& text)>& notice);

}  // namespace vinv::scenario
