#pragma once
/// \file
/// What a comparison of fits leaves: comparison.json, comparison.csv, unseen.csv and its words.

#include "io/result_folder.hpp"
#include "study/fit/comparison.hpp"

namespace repose::study {

/// comparison.json. Values that are not finite become null.
io::Json comparison_report(const Comparison& comparison);

/// comparison.csv: a line per fit, the criteria with white and with correlated errors.
std::string comparison_csv(const Comparison& comparison);

/// unseen.csv: a line per fit and channel of a test that was held out or left out in turn.
std::string unseen_csv(const Comparison& comparison);

/// All three into the folder of the comparison.
void write_comparison(const io::ResultFolder& folder, const Comparison& comparison);

/// Which fit predicts better, whether the criteria agree, and what they are worth.
std::string verdict(const Comparison& comparison);

/// The table and the verdict, line by line, as `repose fit --compare` tells them.
std::vector<std::string> comparison_words(const Comparison& comparison);

}  // namespace repose::study
