#pragma once
/// \file
/// A verb of `repose`: one file each in this folder, listed in command_line.cpp.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/exit_code.hpp"

namespace repose::app {

/// Options that several verbs share; a verb takes those it has a use for.
struct CommonOptions {
  std::string output;             ///< -o; empty: results/NAME
  std::vector<std::string> sets;  ///< --set key=value
  int threads = 0;                ///< 0: all cores
  std::uint64_t seed = 0;
  bool resume = false;
  bool quiet = false;
  bool json = false;
};

void add_set(CLI::App& verb, CommonOptions& options);
void add_threads(CLI::App& verb, CommonOptions& options);
void add_quiet(CLI::App& verb, CommonOptions& options);
/// -o, --seed, --resume, --json and the three above.
void add_run_options(CLI::App& verb, CommonOptions& options);

/// "From data/scenes/flat_mu_i.toml with --set grid.h=0.0125": where a resolved input comes from.
std::string origin_line(const std::string& path, const CommonOptions& options);

struct Command {
  CLI::App* verb;
  std::shared_ptr<const CommonOptions> options;
  std::function<ExitCode()> run;
};

Command add_run(CLI::App& root);
Command add_check(CLI::App& root);
Command add_models(CLI::App& root);
Command add_point(CLI::App& root);
Command add_fit(CLI::App& root);
Command add_chart(CLI::App& root);
Command add_report(CLI::App& root);

}  // namespace repose::app
