#pragma once
/// \file
/// Fits of several laws, or of one with several options, to the same tests: which predicts tests
/// that it has not seen, and what the criteria say. docs/comparison.md.

#include "calibration/unseen.hpp"
#include "study/fit/fit_record.hpp"

namespace repose::study {

/// One of the fits that are compared, at its end.
struct Contender {
  std::string name;  ///< its file's, without .toml
  const input::FitFile& file;
  calibration::Problem& problem;
  const FitResult& result;
};

/// A [[target]], the parts that its channels' blanks cut it into taken together.
struct ComparedTest {
  std::string name;
  std::vector<std::size_t> targets;
  bool held_out = false;
};
std::vector<ComparedTest> compared_tests(const input::FitFile& file);

/// What one fit comes to.
struct ScoredFit {
  std::string name;
  std::string law;                      ///< with its option
  std::vector<std::string> parameters;  ///< free ones
  calibration::Likelihood white, correlated;
  std::vector<calibration::LeftOut> tests;  ///< as Comparison::tests; held-out ones have no optimum
  /// Of the fitted tests, each left out in turn; of the held-out ones. NaN without any, or where a
  /// path broke off.
  double left_out_score = 0.0, held_out_score = 0.0;
  double left_out_error = 0.0, held_out_error = 0.0;  ///< r.m.s. over the ranges of the channels
};
struct Comparison {
  std::vector<ComparedTest> tests;
  std::vector<ScoredFit> fits;
  bool left_out = false;  ///< there are at least two fitted tests
  bool complete = true;   ///< false: interrupted
};

/// Errors: BadInput, telling what differs, if the files are not fits of the same data: targets,
/// rows, channels, noise, what is held out and how curves are compared; or if two have one name.
void check_same_data(const std::vector<input::FitFile>& files);

/// A fit left out by an earlier session, and who hears of new ones (one at a time).
struct LeftOutFit {
  std::string fit, test;
  calibration::Optimum optimum;
};
struct ComparisonRequest {
  std::vector<LeftOutFit> done;
  std::function<void(const LeftOutFit&)> after;
};
Comparison compare(const std::vector<Contender>& contenders, const ComparisonRequest& request);

/// "A_B": the folder of a comparison that is given no other name.
std::string comparison_name(const std::vector<input::FitFile>& files);

/// Where a comparison keeps its fits without a test (journal.hpp), and a line of it.
inline constexpr std::string_view left_out_name = "left_out.jsonl";
std::string journal_line(const LeftOutFit& fit);
/// Opens its folder: a resumed one's journal goes on, older results go. Errors: BadInput for a
/// journal of other fits; IoError.
std::vector<LeftOutFit> begin_comparison(const io::ResultFolder& folder,
                                         const std::vector<Contender>& contenders, bool resume);

}  // namespace repose::study
