#include "study/validation/curve_distance.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace repose::study {
namespace {

/// With x from small to large.
PlainCurve in_order(PlainCurve curve) {
  if (curve.x.size() < 2) throw NoFigure("the curve has no two points");
  if (curve.x.front() > curve.x.back()) {
    std::reverse(curve.x.begin(), curve.x.end());
    std::reverse(curve.y.begin(), curve.y.end());
  }
  if (!std::is_sorted(curve.x.begin(), curve.x.end()))
    throw NoFigure("x goes back and forth along the curve; stage = N takes one stage of a test");
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    if (!std::isfinite(curve.x[i]) || !std::isfinite(curve.y[i]))
      throw NoFigure("the curve has no number in some of its rows");
  return curve;
}

}  // namespace

std::vector<double> curve_at(const PlainCurve& given, const std::vector<double>& x, double reach) {
  const PlainCurve curve = in_order(given);
  const std::vector<double>&xs = curve.x, &ys = curve.y;
  const std::size_t n = xs.size();
  const double rounding = 1e-6 * (xs.back() - xs.front());
  const double lowest = xs.front() - reach * (xs[1] - xs[0]) - rounding;
  const double highest = xs.back() + reach * (xs[n - 1] - xs[n - 2]) + rounding;
  std::vector<double> y;
  for (const double at : x) {
    if (!(at >= lowest && at <= highest))
      throw NoFigure(
          fmt::format("the curve goes from x = {:.6g} to {:.6g}, and the table has {:.6g}",
                      xs.front(), xs.back(), at));
    const auto above =
        static_cast<std::size_t>(std::upper_bound(xs.begin(), xs.end(), at) - xs.begin());
    const std::size_t right = std::clamp<std::size_t>(above, 1, n - 1), left = right - 1;
    const double length = xs[right] - xs[left];
    const double share = length > 0.0 ? (at - xs[left]) / length : 1.0;
    y.push_back(ys[left] + share * (ys[right] - ys[left]));
  }
  return y;
}

double distance(const PlainCurve& curve, const input::BenchmarkFigure& figure) {
  using input::BenchmarkCurve;
  // means over rows of points and columns of cells stand half a cell within the ends
  const bool of_rows =
      figure.curve == BenchmarkCurve::column || figure.curve == BenchmarkCurve::rest_line;
  const std::vector<double> y = curve_at(curve, figure.table_x, of_rows ? 1.0 : 0.0);
  double squares = 0.0, largest = 0.0, sum = 0.0, size = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double difference = std::abs(y[i] - figure.table_y[i]);
    squares += difference * difference;
    largest = std::max(largest, difference);
    sum += difference;
    size += std::abs(figure.table_y[i]);
  }
  switch (figure.measure) {
    case input::BenchmarkMeasure::rms:
      return std::sqrt(squares / static_cast<double>(y.size()));
    case input::BenchmarkMeasure::max:
      return largest;
    case input::BenchmarkMeasure::relative:
      break;
  }
  if (!(size > 0.0)) throw NoFigure("the table is 0 throughout, so no distance is relative to it");
  return sum / size;
}

}  // namespace repose::study
