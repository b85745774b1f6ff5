#pragma once
/// \file
/// What a fit leaves in words and figures: fit.json, fitted.toml, and the starts' journal that a
/// resumed or merged fit takes up.

#include "calibration/misfit_cause.hpp"
#include "calibration/uncertainty.hpp"
#include "input/read_fit.hpp"
#include "io/json.hpp"

namespace repose::study {

/// Everything known at the end of a fit.
struct FitResult {
  std::vector<calibration::StartResult> starts;
  calibration::Uncertainty uncertainty;
  std::vector<calibration::Profile> profiles;
  std::vector<calibration::StartResult> coarse;  ///< ends of the coarse search; empty without one
  Eigen::MatrixXd bootstrap;                     ///< repeats × parameters; empty if not asked for
  std::vector<calibration::Recommendation> quoted;  ///< the interval to quote, per parameter
  std::vector<calibration::MisfitCause> causes;     ///< of large misfits
  bool converged = true;                            ///< false: the limit of evaluations ended it
  std::vector<calibration::Cluster> clusters;
  const calibration::Optimum& best() const { return calibration::best_of(starts).optimum; }
};

/// The text of fit.json. status: "done", "not converged", "failed" or "interrupted". Values that
/// are not finite become null.
io::Json fit_report(const input::FitFile& file, const calibration::Problem& problem,
                    const FitResult& result, const std::string& status);

/// predictions.csv: measured and fitted value of every row that was compared or held out, in SI.
std::string predictions_csv(const input::FitFile& file, const calibration::Problem& problem,
                            const FitResult& result);

/// fitted.toml: a [law] table that `repose point` and `repose run` take, intervals in comments.
std::string fitted_toml(const input::FitFile& file, const FitResult& result);

/// Where the model does not follow the data, one sentence each, with the cause where trying found
/// one; empty if nowhere.
std::vector<std::string> discrepancies(const input::FitFile& file,
                                       const calibration::Problem& problem,
                                       const FitResult& result);

/// "0.93 to 1.04 Pa", "at most 0.031 (its bound is 0.005)", "the data do not determine it": the
/// recommended 95 % interval.
std::string quoted_words(const input::FitFile& file, const FitResult& result,
                         std::size_t parameter);

/// One line per finished start, and back (journal.hpp). A journal begins with the fit's
/// fingerprint.
std::string journal_head(const input::FitFile& file);
std::string journal_line(const calibration::StartResult& start);
/// Errors: BadInput if the journal belongs to another fit; IoError if it cannot be read. An absent
/// file is an empty journal.
std::vector<calibration::StartResult> read_starts(const std::filesystem::path& path,
                                                  const input::FitFile& file);
/// Errors: BadInput if there are other numbers for the same start.
void merge_into(std::vector<calibration::StartResult>& all,
                std::vector<calibration::StartResult> more, const std::string& from);

}  // namespace repose::study
