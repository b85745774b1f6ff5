#pragma once
/// \file
/// A figure of a validation case read off one result.

#include "study/accuracy/sweep.hpp"
#include "study/point/test_result.hpp"
#include "study/validation/curve_distance.hpp"

namespace repose::study {

/// A figure of a finished run of a scene: a number, or the distance of a curve, which `curve` then
/// holds. folder: of the run. Errors: NoFigure, IoError.
double scene_value(const input::BenchmarkFigure& figure, const SweepRun& run,
                   const std::filesystem::path& folder, PlainCurve& curve);

/// The same of a point test.
double test_value(const input::BenchmarkFigure& figure, const input::PointTestFile& test,
                  const TestResult& result, PlainCurve& curve);

/// The test at a hundredth of its tolerance (a hundred times as much where that would be
/// round-off), or, by the law's own update, with four times the substeps.
input::PointTestFile refined(input::PointTestFile test);

}  // namespace repose::study
