// The subcommands of vinverter. Each registers its options and returns its exit code when it runs.
#pragma once

#include <CLI/CLI.hpp>

namespace vinv::tools {

// Exit codes of all subcommands; the footer of --help lists them.
inline constexpr int kDone = 0;
inline constexpr int kRefused = 1;   // the running plant refuses, or something could not be saved
inline constexpr int kUnusable = 2;  // wrong words, a mistake in the plant file, a port in use, no such plant

void add_run(CLI::App& app, int& exit_code);
void add_ctl(CLI::App& app, int& exit_code);
void add_doctor(CLI::App& app, int& exit_code);
void add_params(CLI::App& app, int& exit_code);
void add_scenario(CLI::App& app, int& exit_code);
void add_campaign(CLI::App& app, int& exit_code);

}  // namespace vinv::tools
