#pragma once
/// \file
/// What a fit leaves in words and figures: fit.json, fitted.toml, and the starts' journal that a
/// resumed or merged fit takes up.

#include "calibration/design.hpp"
#include "calibration/misfit_cause.hpp"
#include "calibration/uncertainty.hpp"
#include "input/read_fit.hpp"
#include "io/json.hpp"
#include "study/run/run_record.hpp"

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
  calibration::Design design;  ///< of the file's candidates
  const calibration::Optimum& best() const { return calibration::best_of(starts).optimum; }
};

/// The text of fit.json. status: "done", "not converged", "failed" or "interrupted". Values that
/// are not finite become null.
io::Json fit_report(const input::FitFile& file, const calibration::Problem& problem,
                    const FitResult& result, const std::string& status);

/// predictions.csv: measured and fitted value of every row that was compared or held out, in SI,
/// and the weight of the fitted ones.
std::string predictions_csv(const input::FitFile& file, const calibration::Problem& problem,
                            const FitResult& result);

/// fitted.toml: a [law] table that `repose point` and `repose run` take, intervals in comments.
std::string fitted_toml(const input::FitFile& file, const FitResult& result);

/// Rows of a channel whose weight is below a quarter of that of a row without a residual: with
/// residuals = "huber" those beyond 5.4 scales, with "student" beyond 3.5.
struct Outliers {
  std::size_t target = 0, channel = 0;
  std::vector<std::size_t> rows;
};
std::vector<Outliers> outliers(const calibration::Problem& problem, const FitResult& result);

/// Where the model does not follow the data, one sentence each, with the cause where trying found
/// one; empty if nowhere.
std::vector<std::string> discrepancies(const input::FitFile& file,
                                       const calibration::Problem& problem,
                                       const FitResult& result);

/// What `repose fit` tells of a fit, line by line: values with their intervals, what is worst
/// determined, where the model does not follow the data, other optima.
std::vector<std::string> fit_words(const input::FitFile& file, const calibration::Problem& problem,
                                   const FitResult& result);

/// "0.93 to 1.04 Pa", "at most 0.031 (its bound is 0.005)", "the data do not determine it": the
/// recommended 95 % interval.
std::string quoted_words(const input::FitFile& file, const FitResult& result,
                         std::size_t parameter);

/// design.csv: a line per candidate and one per test of the best sequence; empty without
/// candidates.
std::string design_csv(const input::FitFile& file, const FitResult& result);

/// fit.json (`report`), fitted.toml, predictions.csv and, with candidates, design.csv.
void write_fit(const io::ResultFolder& folder, const input::FitFile& file,
               const calibration::Problem& problem, const FitResult& result,
               const io::Json& report);

/// The text of summary.json; before: the usage when the fit began.
io::Json fit_summary(const input::FitFile& file, const std::string& status, const Usage& before,
                     const io::Json& report);

/// An optimum as an entry of a journal, and back. Errors: Json::Error.
io::Json json_of(const calibration::Optimum& optimum);
calibration::Optimum optimum_of(const io::Json& json);

/// Leaves a share of the starts to be run, all from `from` if `to` is −1. Errors: BadInput for a
/// share that there is not.
void share_starts(input::FitFile& file, int from, int to);

/// Where a fit keeps its starts.
inline constexpr std::string_view starts_name = "starts.jsonl";
/// Opens the folder of a fit: the starts that these folders, and its own if it is resumed, hold go
/// into its journal, older results go, and input.toml is written. Errors: BadInput, IoError.
std::vector<calibration::StartResult> begin_fit(const io::ResultFolder& folder,
                                                const input::FitFile& file,
                                                const std::string& source,
                                                const std::vector<std::string>& merge, bool resume);

/// The journal of starts (journal.hpp): its head names the fit, then a line per finished start.
std::string starts_journal(const input::FitFile& file,
                           const std::vector<calibration::StartResult>& starts);
std::string journal_line(const calibration::StartResult& start);
/// The starts of several journals by index, absent ones being empty. Errors: BadInput if one
/// belongs to another fit, or the same start ended elsewhere in two of them; IoError if one cannot
/// be read.
std::vector<calibration::StartResult> read_starts(
    const std::vector<std::filesystem::path>& journals, const input::FitFile& file);

}  // namespace repose::study
