#pragma once
/// \file
/// A computed curve against a table: how far it is from the table's rows.

#include <stdexcept>
#include <string>
#include <vector>

#include "input/read_benchmark.hpp"

namespace repose::study {

/// Points of a curve in its own order, SI.
struct PlainCurve {
  std::vector<double> x, y;
};

/// A figure that a result does not have; what() says why.
class NoFigure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The curve's y at each x, straight between its points. Beyond an end by no more than `reach`
/// times the length of the curve's last piece there, along that piece. Errors: NoFigure where x
/// goes back and forth along the curve, or is beyond its reach.
std::vector<double> curve_at(const PlainCurve& curve, const std::vector<double>& x, double reach);

/// The distance of a curve from the table of a figure, by its measure.
double distance(const PlainCurve& curve, const input::BenchmarkFigure& figure);

}  // namespace repose::study
