#include "sim/scenario/batch.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>

#include "sim/rig/words.hpp"
#include "sim/scenario/virtual_run.hpp"

namespace vinv::scenario {
namespace {

namespace fs = std::filesystem;

// By its top-level keys, so that a scenario with mistakes is still one.
bool is_scenario(const fs::path& path) {
  if (path.extension() != ".yaml" && path.extension() != ".yml") return false;
  std::ifstream in(path);
  bool other_file = false;  // of a plant, of a campaign
  for (std::string line; std::getline(in, line);) {
    for (const char* key : {"plant:", "steps:", "tracks:"})
      if (line.starts_with(key)) return true;
    other_file = other_file || line.starts_with("drives:") || line.starts_with("variations:");
  }
  return !other_file;
}

struct Slot {
  std::optional<Scenario> scenario;
  RunResult result;
  bool done = false;
};

void run_file(const std::string& file, const BatchOptions& options, Slot& slot) {
  try {
    slot.scenario = load_scenario(file, options.load);
    slot.result = options.run_one ? options.run_one(*slot.scenario)
                                  : run_virtual(*slot.scenario, options.load.catalogue, options.run);
  } catch (const std::exception& e) {
    slot.result.path = file;
    slot.result.name = fs::path(file).stem().string();
    slot.result.title = scenario_title(file);
    slot.result.reason = e.what();
  }
}

}  // namespace

std::vector<std::string> find_scenarios(const std::vector<std::string>& paths, const std::string& filter) {
  std::vector<std::string> out;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!fs::exists(path, error)) throw std::runtime_error("there is no file or folder " + path + ".");
    if (!fs::is_directory(path, error)) {
      out.push_back(path);
      continue;
    }
    std::vector<std::string> found;
    auto it = fs::recursive_directory_iterator(path, fs::directory_options::skip_permission_denied, error);
    for (const auto end = fs::end(it); !error && it != end; it.increment(error))
      if (it->is_regular_file(error) && is_scenario(it->path())) found.push_back(it->path().string());
    if (error) throw std::runtime_error("the folder " + path + " cannot be read: " + error.message() + ".");
    std::sort(found.begin(), found.end());
    out.insert(out.end(), found.begin(), found.end());
  }
  std::erase_if(out, [&](const std::string& file) {
    return file.find(filter) == std::string::npos && scenario_title(file).find(filter) == std::string::npos;
  });
  return out;
}

BatchResult run_batch(const std::vector<std::string>& files, const BatchOptions& options,
                      const std::vector<std::unique_ptr<ReportWriter>>& writers) {
  std::vector<Slot> slots(files.size());
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t next = 0;
  std::size_t handed_out = 0;
  const std::size_t jobs = std::clamp<std::size_t>(options.jobs, 1, std::max<std::size_t>(files.size(), 1));
  // Results wait for their turn with all they recorded: a slow run does not let the others run far ahead.
  const std::size_t ahead = 4 * jobs;
  const auto work = [&] {
    for (;;) {
      std::size_t mine = 0;
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return next >= files.size() || next < handed_out + ahead; });
        if (next >= files.size()) return;
        mine = next++;
      }
      Slot slot;
      run_file(files[mine], options, slot);
      const std::lock_guard lock(mutex);
      slots[mine] = std::move(slot);
      slots[mine].done = true;
      changed.notify_all();
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < jobs; ++i) threads.emplace_back(work);

  BatchResult batch;
  const auto guarded = [&](const std::function<void()>& act) {
    try {
      act();
    } catch (const std::exception& e) {
      ++batch.not_written;
      if (options.on_trouble) options.on_trouble(rig::sentence(e.what()));
    }
  };
  for (std::size_t i = 0; i < files.size(); ++i) {
    Slot slot;
    {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return slots[i].done; });
      slot = std::move(slots[i]);
      ++handed_out;
      changed.notify_all();
    }
    switch (slot.result.verdict) {
      case Verdict::kPassed: ++batch.passed; break;
      case Verdict::kFailed: ++batch.failed; break;
      case Verdict::kNotRun: ++batch.not_run; break;
    }
    if (options.on_result) options.on_result(i + 1, slot.result);
    for (const auto& writer : writers)
      guarded([&] { writer->write(slot.scenario ? &*slot.scenario : nullptr, slot.result); });
  }
  for (std::thread& t : threads) t.join();
  for (const auto& writer : writers) guarded([&] { writer->finish(); });
  return batch;
}

}  // namespace vinv::scenario
