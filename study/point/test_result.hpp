#pragma once
/// \file
/// A point test driven: its curve and what is read off it.

#include "input/read_point_test.hpp"
#include "io/json.hpp"
#include "pointdriver/study/laboratory_figures.hpp"

namespace repose::study {

struct TestResult {
  const LawInfo* law = nullptr;
  std::vector<double> theta;
  point::Curve curve;
  std::string reason;  ///< the outcome in words
  point::LaboratoryFigures figures;
  double wall_s = 0.0;  ///< of driving alone

  bool failed() const { return point::is_failure(curve.outcome.status); }
};

/// Drives it. Never throws for numbers: see TestResult::failed.
TestResult drive(const input::PointTestFile& file);

/// What a curve shows that its user should know before reading it (a warning each): flow of a
/// critical-state law so fast that it leaves what the law is for (physics.md, CSM-9, CSM-10).
std::vector<std::string> remarks(const input::PointTestFile& file, const TestResult& result);

/// The columns of curve.csv beside the quantities of point::columns_of.
struct StageColumns {
  bool stage = false;  ///< the test has several
  bool cycle = false;  ///< a stage has cycles
};
StageColumns stage_columns(const point::Path& path);

/// The rows of a curve, column by column in the order of `quantities`: NaN where the law or the
/// test has none.
std::vector<std::vector<double>> columns_of(const input::PointTestFile& file,
                                            const TestResult& result,
                                            std::span<const point::Quantity> quantities);

/// curve.csv.
std::string curve_csv(const input::PointTestFile& file, const TestResult& result);

}  // namespace repose::study
