/// The verbs of the command, of inputs that may be a program's own.
#include "app/command_line.hpp"
#include "app/commands/command.hpp"
#include "binding.hpp"
#include "io/interrupt.hpp"

namespace repose::python {
namespace {

app::CommonOptions options_of(const std::string& output, int threads, std::uint64_t seed,
                              bool resume, bool quiet, bool plot) {
  app::CommonOptions options;
  options.output = output;
  options.threads = threads;
  options.seed = seed;
  options.resume = resume;
  options.quiet = quiet;
  options.no_plot = !plot;
  return options;
}

/// Runs a verb without the interpreter's lock and returns its exit code. An interrupt is the verb's
/// from the start, also while it reads.
template <class F>
int without_lock(F&& verb) {
  const py::gil_scoped_release released;
  const io::InterruptGuard interrupt;
  return static_cast<int>(verb());
}

}  // namespace

void bind_verbs(py::module_& module) {
  const auto bind = [&](const char* name, auto verb, const char* doc) {
    module.def(
        name,
        [verb](const input::InputFile& input, const std::string& from, const std::string& output,
               int threads, std::uint64_t seed, bool resume, bool quiet, bool plot) {
          const app::CommonOptions options = options_of(output, threads, seed, resume, quiet, plot);
          return without_lock([&] { return verb(from, input, options); });
        },
        py::arg("input"), py::arg("source"), py::arg("output"), py::arg("threads"), py::arg("seed"),
        py::arg("resume"), py::arg("quiet"), py::arg("plot"), doc);
  };
  bind("run_scene", &app::run_scene, "`repose run`: returns the exit code.");
  bind("run_test", &app::run_test, "`repose point`: returns the exit code.");
  bind("run_sensitivity", &app::run_sensitivity, "`repose sensitivity`: returns the exit code.");
  bind(
      "run_fit",
      [](const std::string&, const input::InputFile& input, const app::CommonOptions& options) {
        return app::run_fit(input, {}, options);
      },
      "`repose fit`: returns the exit code.");
  module.def(
      "run_verb",
      [](const std::vector<std::string>& arguments) {
        return without_lock([&] { return app::run_verb(arguments); });
      },
      py::arg("arguments"), "A verb with its options as text; returns the exit code.");
  module.def(
      "command",
      [](const std::vector<std::string>& arguments) {
        std::vector<const char*> words;
        for (const std::string& word : arguments) words.push_back(word.c_str());
        return without_lock(
            [&] { return app::run_command_line(static_cast<int>(words.size()), words.data()); });
      },
      py::arg("arguments"), "The command line, its own name first; returns the exit code.");
}

}  // namespace repose::python
