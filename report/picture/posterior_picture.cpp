#include "report/picture/posterior_picture.hpp"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "report/picture/fit_axes.hpp"

namespace repose::report {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Share of draws in cells of equal width, as a staircase from cell to cell.
void histogram(Axes& axes, const VectorXd& draws, double lower, double upper) {
  constexpr int cells = 30;
  std::array<double, cells> share{};
  for (const double x : draws) {
    const int k = std::clamp(static_cast<int>((x - lower) / (upper - lower) * cells), 0, cells - 1);
    share[static_cast<std::size_t>(k)] += 1.0 / static_cast<double>(draws.size());
  }
  std::vector<double> x, y;
  for (int k = 0; k < cells; ++k)
    for (const int side : {0, 1}) {
      x.push_back(lower + (upper - lower) * (k + side) / cells);
      y.push_back(100.0 * share[static_cast<std::size_t>(k)]);
    }
  axes.band("", x, std::vector<double>(x.size(), 0.0), y, {Colour::blue});
  axes.line("", x, y, {Colour::blue, 1.2});
}

}  // namespace

Figure posterior_bands_picture(const input::FitFile& file, const study::PosteriorResult& result) {
  Figure figure(file.name,
                fmt::format("{} {}: 90 % of the curves (dark) and of their repetitions (light), "
                            "{} draws of {} chains",
                            file.law.name, file.info->option, result.kept, result.chains));
  figure.columns = 2;
  figure.panel_height_px = 220.0;
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    const calibration::Target& t = file.targets[k];
    const calibration::PredictiveBand& band = result.bands[k];
    const auto [x_label, x_factor] = column_label(t.x_name, file.about[k].strain);
    const auto x = scaled(t.x, x_factor);
    // loading and unloading would fold a band: there its edges are drawn
    const bool ordered = std::is_sorted(x.begin(), x.end());
    for (std::size_t c = 0; c < t.channels.size(); ++c) {
      const auto column = static_cast<Index>(c);
      const auto [y_label, factor] = column_label(t.channels[c].name, file.about[k].strain);
      Axes& axes = figure.add_axes();
      axes.title =
          fmt::format("{}{}: {:.0f} % of {} rows inside", t.name, t.held_out ? " (held out)" : "",
                      100.0 * calibration::share_inside(t.channels[c], band, column), t.rows());
      axes.x = {x_label, scale_over(t)};
      axes.y.label = y_label;
      const auto between = [&](const VectorXd& lower, const VectorXd& upper, Colour colour) {
        const auto low = scaled(lower, factor), high = scaled(upper, factor);
        if (ordered) {
          axes.band("", x, low, high, {colour});
        } else {
          axes.line("", x, low, {colour, 0.8});
          axes.line("", x, high, {colour, 0.8});
        }
      };
      between(band.lower.col(column), band.upper.col(column), Colour::sky);
      between(band.curve_lower.col(column), band.curve_upper.col(column), Colour::blue);
      axes.points("measured", x, scaled(t.channels[c].observed, factor),
                  {Colour::black, 1.0, Marker::ring, 5.0});
      axes.line(t.held_out ? "predicted" : "median", x, scaled(band.median.col(column), factor),
                {Colour::blue});
    }
  }
  return figure;
}

Figure posterior_corner_picture(const input::FitFile& file, const study::PosteriorResult& result) {
  const auto n = file.free.size();
  Figure figure(file.name + ": what the data leave of the parameters",
                fmt::format("{} draws of {} chains{}", result.kept, result.chains,
                            result.converged ? "" : "; not converged"));
  figure.columns = n;
  figure.panel_width_px = figure.panel_height_px = n > 5 ? 130.0 : 170.0;
  std::vector<std::array<double, 2>> range;
  for (std::size_t i = 0; i < n; ++i) {
    const VectorXd draws = result.quantities.col(static_cast<Index>(i));
    const double low = draws.minCoeff(), high = draws.maxCoeff();
    const double room = high > low ? 0.03 * (high - low) : 1e-6 * std::max(1.0, std::abs(low));
    range.push_back({low - room, high + room});
  }
  // enough points to see a shape by
  constexpr Index most_points = 1000;
  const Index step = (result.quantities.rows() + most_points - 1) / most_points;
  const auto some = [&](std::size_t i) {
    std::vector<double> list;
    for (Index d = 0; d < result.quantities.rows(); d += step)
      list.push_back(result.quantities(d, static_cast<Index>(i)));
    return list;
  };
  const auto name = [&](std::size_t i) {
    const std::string& unit = file.free[i].unit;
    return unit == "-" ? file.free[i].name : fmt::format("{} ({})", file.free[i].name, unit);
  };
  for (std::size_t row = 0; row < n; ++row)
    for (std::size_t column = 0; column < n; ++column) {
      Axes& axes = figure.add_axes();
      const auto [low, high] = range[column];
      axes.x = {row + 1 == n || row <= column ? name(column) : "", AxisScale::linear, low, high};
      axes.legend = Legend::none;
      if (row == column) {
        axes.y = {"draws (%)", AxisScale::linear, 0.0, {}};
        histogram(axes, result.quantities.col(static_cast<Index>(row)), low, high);
        continue;
      }
      axes.y = {name(row), AxisScale::linear, range[row][0], range[row][1]};
      if (row > column) {
        axes.points("", some(column), some(row), {Colour::blue, 1.0, Marker::circle, 1.5});
      } else {
        axes.label({0.5 * (low + high), 0.5 * (range[row][0] + range[row][1]),
                    fmt::format("{:.2f}", result.correlation(static_cast<Index>(row),
                                                             static_cast<Index>(column)))});
      }
    }
  return figure;
}

}  // namespace repose::report
