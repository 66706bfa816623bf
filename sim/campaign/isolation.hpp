// Work in processes of its own: what crashes takes nothing else with it.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace vinv::campaign {

struct Answer {
  enum class Kind {
    kDone,
    kCrashed,  // the process died of what it did
    kStopped,  // something outside ended it
  };
  Kind kind = Kind::kDone;
  std::string text;  // kDone: what the work gave; otherwise how the process ended, as a sentence
};

// Runs work(next()) in that many processes until next() is empty, and hands out answers as they come, with the number
// of the task, from 0. The work sees this process as it was at the call. done returns false to begin nothing more; what
// has begun still ends. The calling process has one thread. Throws std::runtime_error if no process can be made.
void run_isolated(std::size_t processes, const std::function<std::optional<std::string>()>& next,
                  const std::function<std::string(const std::string& task)>& work,
                  const std::function<bool(std::size_t task, const Answer& answer)>& done);

}  // namespace vinv::campaign
