#pragma once
/// \file
/// What `repose fit` computes: the search from every start, first with coarse scenes where the fit
/// has some, and what the best end says of the parameters.

#include <functional>

#include "study/fit/fit_record.hpp"

namespace repose::study {

struct SearchRequest {
  std::vector<calibration::StartResult> done;  ///< starts that need no repetition
  bool merged = false;                         ///< `done` is all there is to know of the starts
  std::function<bool()> interrupted;
  /// Hears of every start that ended, one at a time.
  std::function<void(const calibration::StartResult&)> after_start;
};

/// Fills FitResult::starts, and FitResult::coarse where the fit has coarse scenes: all starts with
/// those, then the best of them with the fine ones. Starts that were interrupted before their first
/// point are left out, so that there may be none.
FitResult search(const input::FitFile& file, calibration::Problem& problem, SearchRequest request);

/// Intervals and distinct optima of the starts, of which there must be one; profiles and bootstrap
/// as the file asks for, unless `brief`. Notes in the file what the intervals hold. An error of
/// resolution is what the residuals change by from the coarse scenes to the fine ones.
void analyse(input::FitFile& file, const calibration::Problem& problem, bool brief,
             FitResult& result);

/// What a fit comes to.
struct Solution {
  FitResult result;
  /// "done", "not converged", "failed" or "interrupted"
  std::string status;
  io::Json report;  ///< fit_report(); null where no start came to an end
};

/// search(), settled priors, analyse() (briefly if it was interrupted) and rows_beyond(), which it
/// notes in the file.
Solution solve(input::FitFile& file, calibration::Problem& problem, const SearchRequest& request);

/// A note for every target some of whose rows the curve at z does not reach.
std::vector<std::string> rows_beyond(const input::FitFile& file,
                                     const calibration::Problem& problem, const Eigen::VectorXd& z);

}  // namespace repose::study
