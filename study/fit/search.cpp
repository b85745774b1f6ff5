#include "study/fit/search.hpp"

#include <fmt/core.h>

#include "calibration/optimise.hpp"

namespace repose::study {
namespace {

void leave_out_pointless(std::vector<calibration::StartResult>& starts) {
  // an interrupted start with no point at all tells nothing
  std::erase_if(starts, [](const auto& s) { return s.optimum.z.size() == 0; });
}

/// All starts with the coarse scenes, then the best of them with the fine ones.
FitResult coarse_to_fine(const input::FitFile& file, calibration::Problem& problem,
                         const SearchRequest& request) {
  FitResult result;
  calibration::Problem coarse(problem.space(), file.coarse, file.balance, file.loss);
  coarse.interrupt_by(request.interrupted);
  // merged shares are refined again, from the best of all
  auto starts = request.merged ? request.done
                               : calibration::run_starts(coarse, file.options, request.done,
                                                         request.after_start);
  leave_out_pointless(starts);
  if (starts.empty()) return result;
  result.coarse = starts;
  calibration::StartResult fine;
  fine.global = calibration::best_of(starts).optimum;
  fine.from = fine.global.z;
  calibration::OptimiseOptions options;
  options.max_evaluations = file.fine_evaluations;
  options.x_tolerance = file.options.x_tolerance;
  options.seed = file.options.seed;
  fine.optimum = calibration::optimise(
      problem, file.options.local == "none" ? "LN_BOBYQA" : file.options.local, fine.from, options);
  result.starts = {fine};
  return result;
}

/// What the residuals change by from the coarse scenes to the fine ones at z, as a measure of the
/// error that the fine ones still have; empty if there are none or a run broke off.
Eigen::VectorXd resolution_error(input::FitFile& file, const calibration::Problem& problem,
                                 const Eigen::VectorXd& z) {
  if (file.coarse.empty() || !(file.resolution_error > 0.0)) return {};
  const calibration::Problem coarse(problem.space(), file.coarse, file.balance);
  calibration::Evaluation there, here;
  coarse.evaluate(z, false, there);
  problem.with_loss({}).evaluate(z, false, here);
  if (there.failed || here.failed) {
    file.notes.push_back("the intervals leave out the error of resolution: a run broke off");
    return {};
  }
  file.notes.push_back(
      fmt::format("the intervals hold an error of resolution of {:.3g} times the change from "
                  "coarse to fine",
                  file.resolution_error));
  return file.resolution_error * (here.r - there.r);
}

}  // namespace

FitResult search(const input::FitFile& file, calibration::Problem& problem, SearchRequest request) {
  problem.interrupt_by(request.interrupted);
  FitResult result;
  if (!file.coarse.empty())
    result = coarse_to_fine(file, problem, request);
  else if (!request.merged)
    result.starts =
        calibration::run_starts(problem, file.options, request.done, request.after_start);
  else
    result.starts = std::move(request.done);
  leave_out_pointless(result.starts);
  return result;
}

void analyse(input::FitFile& file, const calibration::Problem& problem, bool brief,
             FitResult& result) {
  const auto& best = result.best();
  const Eigen::VectorXd error = resolution_error(file, problem, best.z);
  result.uncertainty = calibration::uncertainty(problem, best.z, error);
  result.clusters = calibration::clusters(problem, result.starts);
  result.converged = calibration::converged(problem, result.starts);
  const bool whole = !brief && !best.failed;
  if (whole && file.profiles)
    for (std::size_t i = 0; i < file.free.size(); ++i)
      result.profiles.push_back(
          calibration::profile(problem, result.uncertainty, best.z, static_cast<int>(i)));
  result.quoted = calibration::recommend(problem, result.uncertainty, result.profiles);
  if (whole && file.bootstrap > 0)
    result.bootstrap = calibration::bootstrap(problem, result.uncertainty, best.z, file.bootstrap,
                                              file.options.seed, error);
  if (whole)
    result.design = calibration::design(problem, result.uncertainty, best.z, file.candidates);
  if (!brief) result.causes = calibration::misfit_causes(problem, best.z);
}

std::vector<std::string> rows_beyond(const input::FitFile& file,
                                     const calibration::Problem& problem,
                                     const Eigen::VectorXd& z) {
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    if (!file.targets[k].continues) continue;
    const auto beyond = problem.predict(k, z).beyond;
    if (beyond == 0) continue;
    notes.push_back(
        fmt::format("{}: {} of {} rows lie beyond the end of the fitted curve "
                    "and are compared with its straight continuation",
                    file.targets[k].name, beyond, file.targets[k].rows()));
  }
  return notes;
}

Solution solve(input::FitFile& file, calibration::Problem& problem, const SearchRequest& request) {
  Solution solution;
  FitResult& result = solution.result;
  result = search(file, problem, request);
  const bool interrupted = request.interrupted && request.interrupted();
  if (result.starts.empty()) {
    solution.status = interrupted ? "interrupted" : "failed";
    return solution;
  }
  if (interrupted)
    problem.interrupt_by({});
  else
    calibration::settle(problem, file.options, result.starts);
  analyse(file, problem, interrupted, result);
  for (std::string& note : rows_beyond(file, problem, result.best().z))
    file.notes.push_back(std::move(note));
  solution.status = interrupted            ? "interrupted"
                    : result.best().failed ? "failed"
                    : result.converged     ? "done"
                                           : "not converged";
  solution.report = fit_report(file, problem, result, solution.status);
  return solution;
}

}  // namespace repose::study
