#pragma once
/// \file
/// A verb of `repose`: one file each in this folder, listed in command_line.cpp.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/exit_code.hpp"

namespace repose::input {
class InputFile;
}

namespace CLI {
class App;
}

namespace repose::app {

/// A verb's part of the command line. Only command_line.cpp sees CLI11 itself, which takes seconds
/// to compile.
class Verb {
 public:
  Verb(CLI::App& root, const std::string& name, const std::string& doc);

  /// What follows the options in the help: examples, and what is written where.
  void footer(const std::string& text);
  /// `name`: "--output", "-o,--output", or without dashes an argument by its place. `type`: what
  /// the help calls the value.
  void option(const std::string& name, std::string& value, const std::string& doc,
              const std::string& type);
  void required(const std::string& name, std::string& value, const std::string& doc,
                const std::string& type);
  void option(const std::string& name, std::optional<double>& value, const std::string& doc,
              const std::string& type);
  /// One or several values in a row.
  void option(const std::string& name, std::vector<std::string>& values, const std::string& doc,
              const std::string& type);
  void required(const std::string& name, std::vector<std::string>& values, const std::string& doc,
                const std::string& type);
  /// One value each time; may be repeated.
  void repeated(const std::string& name, std::vector<std::string>& values, const std::string& doc,
                const std::string& type);
  /// An integer from `lower` to `upper`.
  void integer(const std::string& name, int& value, int lower, int upper, const std::string& doc,
               const std::string& type);
  void integer(const std::string& name, std::optional<long>& value, long lower, long upper,
               const std::string& doc, const std::string& type);
  /// An integer >= 0.
  void count(const std::string& name, std::uint64_t& value, const std::string& doc,
             const std::string& type);
  void flag(const std::string& name, bool& value, const std::string& doc);

  CLI::App* app() const { return app_; }

 private:
  CLI::App* app_;
};

/// Options that several verbs share; a verb takes those it has a use for.
struct CommonOptions {
  std::string output;             ///< -o; empty: results/NAME
  std::vector<std::string> sets;  ///< --set key=value
  int threads = 0;                ///< 0: all cores
  std::uint64_t seed = 0;
  bool resume = false;
  bool quiet = false;
  bool json = false;
  bool no_plot = false;  ///< --no-plot
};

void add_set(Verb& verb, CommonOptions& options);
void add_threads(Verb& verb, CommonOptions& options);
void add_quiet(Verb& verb, CommonOptions& options);
void add_no_plot(Verb& verb, CommonOptions& options);
/// -o, --seed, --resume, --json and the four above.
void add_run_options(Verb& verb, CommonOptions& options);

/// "From data/scenes/flat_mu_i.toml with --set grid.h=0.0125": where a resolved input comes from.
std::string origin_line(const std::string& path, const CommonOptions& options);

struct Command {
  CLI::App* verb;  ///< Verb::app()
  std::shared_ptr<const CommonOptions> options;
  std::function<io::ExitCode()> run;
};

// Verbs of an input that was opened already, its overrides applied; `from` says where it is from,
// in words. With a [sweep] they are those of run_point_sweep() and run_scene_sweep(). They throw
// BadInput, InputError and IoError as the command turns them into messages.
io::ExitCode run_test(const std::string& from, const input::InputFile& given,
                      const CommonOptions& options);
io::ExitCode run_scene(const std::string& from, const input::InputFile& given,
                       const CommonOptions& options);
/// Of either kind of input, with a [sensitivity].
io::ExitCode run_sensitivity(const std::string& from, const input::InputFile& given,
                             const CommonOptions& options);
/// What `repose fit` takes beyond the common options.
struct FitArguments {
  int starts_from = 0;
  int starts_to = -1;
  std::vector<std::string> merge;
  bool compare = false;
  bool strict = false;
  bool posterior = false;  ///< also where the file has no [posterior]
  int chains_from = 0;
  int chains_to = -1;
};
io::ExitCode run_fit(const input::InputFile& given, const FitArguments& arguments,
                     const CommonOptions& options);

Command add_run(CLI::App& root);
Command add_check(CLI::App& root);
Command add_models(CLI::App& root);
Command add_point(CLI::App& root);
Command add_schema(CLI::App& root);
Command add_fit(CLI::App& root);
Command add_chart(CLI::App& root);
Command add_stability(CLI::App& root);
Command add_report(CLI::App& root);
Command add_validate(CLI::App& root);
Command add_sensitivity(CLI::App& root);
Command add_propagate(CLI::App& root);

}  // namespace repose::app
