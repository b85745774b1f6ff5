#pragma once
/// \file
/// What the tables of a fit say, before they become a problem (read_fit.hpp).

#include <optional>
#include <string>
#include <vector>

#include "calibration/target.hpp"
#include "input/keys.hpp"
#include "input/read_fit.hpp"

namespace repose::input {

/// A free parameter: [fit] M = { lower = 0.5, upper = 1.5 }.
struct EntryTable {
  std::string of;  ///< another free parameter, to which this one is a ratio
  double lower = 0.0, upper = 0.0;
  std::optional<Scale> scale;
  std::optional<double> start;
  bool has_prior = false;
  double mean = 0.0;
  std::optional<double> sd, relative_sd;
};
/// bounds: of both limits; of a ratio they are [0, 1e6].
void entry_keys(Keys& keys, EntryTable& entry, std::string_view name, std::string_view unit,
                std::string_view doc, const Range& bounds);

/// [[target]], what concerns its table and how it is compared.
struct TargetTable {
  std::string name, data, x;
  std::vector<std::string> y;
  double weight = 1.0;
  bool held_out = false;
  calibration::Compare compare = calibration::Compare::rows;
  std::optional<double> from, to;
  double x_shift = 0.0;
  std::string scene;
  std::vector<std::string> set, coarse;
};
void target_keys(Keys& keys, TargetTable& target);

/// [[candidate]], what concerns the rows that would be measured.
struct CandidateTable {
  std::string name, x;
  std::vector<std::string> y;
  double from = 0.0, to = 0.0;
  int rows = 20;
};
void candidate_keys(Keys& keys, CandidateTable& candidate);

/// Standard deviation of one channel: a number, or parts of it.
struct NoiseParts {
  std::optional<double> absolute, relative;
};
void noise_part_keys(Keys& keys, NoiseParts& parts);

void solver_keys(Keys& keys, FitFile& fit);
void uncertainty_keys(Keys& keys, FitFile& fit);
void posterior_keys(Keys& keys, calibration::PosteriorOptions& posterior);

}  // namespace repose::input
