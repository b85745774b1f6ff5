/// Fits in memory. (A fit that leaves a result folder is the verb: verbs.cpp.)
#include <optional>

#include <tbb/global_control.h>

#include "binding.hpp"
#include "input/file_kind.hpp"
#include "io/interrupt.hpp"
#include "study/fit/search.hpp"

namespace repose::python {
namespace {

py::dict solve_fit(const input::InputFile& given, std::uint64_t seed, int threads,
                   const std::string& cache, const py::object& progress) {
  input::require_kind(given, input::FileKind::fit, "fit");
  std::optional<py::error_already_set> thrown;
  std::atomic<bool> stop = false;
  input::FitFile file;
  study::SearchRequest request;
  study::Solution solution;
  std::string predictions;
  {
    // all of it without the lock: threads of the library may wait for it, in a law of Python
    const py::gil_scoped_release released;
    file = input::read_fit(given, seed, cache);
    calibration::Problem problem(calibration::ParameterSpace(file.free), file.targets,
                                 file.balance);
    const io::InterruptGuard interrupt;
    std::optional<tbb::global_control> limit;
    if (threads > 0)
      limit.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(threads));
    request.interrupted = [&] { return stop || interrupt.requested(); };
    request.after_start = [&](const calibration::StartResult& start) {
      const py::gil_scoped_acquire held;
      if (progress.is_none() || thrown) return;
      try {
        progress(start.index, file.options.starts, start.optimum.objective);
      } catch (py::error_already_set& error) {
        thrown.emplace(error);
        stop = true;
      }
    };
    solution = study::solve(file, problem, request);
    stop = stop || interrupt.requested();
    if (!stop && !solution.result.starts.empty())
      predictions = study::predictions_csv(file, problem, solution.result);
  }
  if (thrown) throw py::error_already_set(*thrown);
  if (stop) throw_interrupted();
  py::dict all;
  all["status"] = solution.status;
  all["notes"] = file.notes;
  all["name"] = file.name;
  if (solution.result.starts.empty()) return all;
  all["report"] = solution.report.dump();
  all["predictions"] = predictions;
  all["fitted_toml"] = study::fitted_toml(file, solution.result);
  return all;
}

}  // namespace

void bind_fit(py::module_& module) {
  module.def(
      "solve_fit", &solve_fit, py::arg("input"), py::arg("seed"), py::arg("threads"),
      py::arg("cache"), py::arg("progress"),
      "A fit as `repose fit` computes it: fit.json, predictions.csv and fitted.toml as text.");
}

}  // namespace repose::python
