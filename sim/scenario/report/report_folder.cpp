#include "sim/scenario/report/report_folder.hpp"

#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "sim/rig/eeprom_store.hpp"
#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/wire_report.hpp"

namespace vinv::scenario {
namespace {

std::string_view text_of(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// Why the folder cannot be made; empty: it is there.
std::string make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && !std::filesystem::is_directory(folder)) error = std::make_error_code(std::errc::not_a_directory);
  return error ? "folder " + folder + " cannot be made: " + error.message() + "." : "";
}

}  // namespace

ReportFolder::ReportFolder(std::string folder, std::string build)
    : folder_(std::move(folder)), build_(std::move(build)) {}

// The runner's name for the run, or that name with a number where two runs share it.
std::string ReportFolder::free_stem(const RunResult& result) {
  const std::string stem = report_stem(result);
  std::string found = stem;
  for (int n = 2; !stems_.insert(found).second; ++n) found = stem + "-" + std::to_string(n);
  return found;
}

void ReportFolder::write(const Scenario* scenario, const RunResult& result) {
  const std::string stem = free_stem(result);
  if (const std::string trouble = make_folder(folder_); !trouble.empty()) {
    if (++lost_runs_ == 1) throw std::runtime_error("the report " + trouble);
    return;
  }
  IndexEntry entry = index_entry(result);
  const auto store = [&](const std::string& name, std::string_view content) {
    try {
      rig::write_whole_file(folder_ + "/" + name, content, rig::FileSync::kNo);
      return true;
    } catch (const std::runtime_error& e) {
      entry.unwritten.emplace_back(e.what());
      return false;
    }
  };
  const auto add = [&](const std::string& label, const std::string& ending, std::string_view content) {
    if (!content.empty() && store(stem + ending, content)) entry.files.push_back({label, stem + ending});
  };
  if (result.verdict != Verdict::kNotRun || !result.recording.times.empty()) {
    add("signals", ".csv", signals_csv(result.recording));
    add("states", ".states.csv", states_csv(result.recording));
    add("events", ".events.csv", events_csv(result));
    add("candump", ".candump.log", candump_log(result.recording));
    add("pcapng", ".pcapng", text_of(wire_pcapng(result.recording)));
  }
  if (store(stem + ".html", html_report(scenario, result, build_, entry.files))) entry.page = stem + ".html";
  std::string failure;
  for (const std::string& sentence : entry.unwritten) failure += (failure.empty() ? "" : "\n") + sentence;
  entries_.push_back(std::move(entry));
  if (!failure.empty()) throw std::runtime_error(failure);
}

void ReportFolder::finish() {
  const std::string trouble = make_folder(folder_);
  if (!trouble.empty()) throw std::runtime_error(std::to_string(lost_runs_) + " runs have no report: the " + trouble);
  rig::write_whole_file(folder_ + "/index.html", index_page(entries_, build_), rig::FileSync::kNo);
}

}  // namespace vinv::scenario
