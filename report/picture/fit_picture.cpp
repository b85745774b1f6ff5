#include "report/picture/fit_picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "calibration/dense.hpp"
#include "report/picture/fit_axes.hpp"

namespace repose::report {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Standard deviation of every simulated value, from the covariance of the parameters: two
/// simulations per parameter direction.
MatrixXd prediction_sd(const calibration::Problem& problem, const study::FitResult& result,
                       std::size_t target) {
  const auto& u = result.uncertainty;
  const VectorXd z = result.best().z;
  const MatrixXd at = problem.predict(target, z).simulated;
  const auto n = z.size();
  const MatrixXd inverse = calibration::inverse(problem.space().slopes(z));
  VectorXd se(n);
  for (Index i = 0; i < n; ++i)
    se[i] = std::isfinite(u.standard_error[i]) ? u.standard_error[i] : 0.0;
  const MatrixXd cov_z =
      inverse * se.asDiagonal() * u.correlation * se.asDiagonal() * inverse.transpose();
  std::vector<MatrixXd> slope;
  for (Index j = 0; j < n; ++j) {
    const double h = 1e-4;
    VectorXd up = z, down = z;
    up[j] = std::min(1.0, z[j] + h);
    down[j] = std::max(0.0, z[j] - h);
    slope.push_back(
        (problem.predict(target, up).simulated - problem.predict(target, down).simulated) /
        (up[j] - down[j]));
  }
  MatrixXd variance = MatrixXd::Zero(at.rows(), at.cols());
  for (Index a = 0; a < n; ++a)
    for (Index b = 0; b < n; ++b)
      variance += cov_z(a, b) * slope[static_cast<std::size_t>(a)].cwiseProduct(
                                    slope[static_cast<std::size_t>(b)]);
  return variance.cwiseMax(0.0).cwiseSqrt();
}

/// y(x) between rows in order of x, and the end values beyond them.
VectorXd interpolated(const VectorXd& x, const VectorXd& y, const VectorXd& at) {
  VectorXd out(at.size());
  for (Index i = 0; i < at.size(); ++i) {
    const auto upper = std::upper_bound(x.begin(), x.end(), at[i]) - x.begin();
    const Index right = std::clamp<Index>(upper, 0, x.size() - 1),
                left = std::max<Index>(right - 1, 0);
    const double span = x[right] - x[left];
    const double share = span > 0.0 ? std::clamp((at[i] - x[left]) / span, 0.0, 1.0) : 1.0;
    out[i] = y[left] + share * (y[right] - y[left]);
  }
  return out;
}

/// q over p′ of a triaxial target: what is fitted along its whole way, and what is measured where
/// the data tell p′ (themselves, or undrained by u: p′ = p′_0 + q/3 − u).
void stress_path(Figure& figure, const calibration::Target& t, const calibration::Response& path) {
  constexpr double kPa = 1e-3;
  const auto channel = [&](std::string_view name) -> const VectorXd* {
    for (const calibration::Channel& c : t.channels)
      if (c.name == name) return &c.observed;
    return nullptr;
  };
  const VectorXd *q = channel("q_Pa"), *p = channel("p_Pa"), *u = channel("u_Pa");
  Axes& axes = figure.add_axes();
  axes.title = t.name + ": stress path";
  axes.x.label = "p′ (kPa)";
  axes.x.lower = 0.0;  // a path that hardly moves must not fill the picture
  axes.y.label = "q (kPa)";
  const Style ring{Colour::black, 1.0, Marker::ring, 5.0};
  if (q != nullptr && p != nullptr) {
    axes.points("measured", scaled(*p, kPa), scaled(*q, kPa), ring);
  } else if (q != nullptr && u != nullptr) {
    const VectorXd from_u = ((path.y(0, 0) + q->array() / 3.0) - u->array()).matrix();
    axes.points("measured (from u)", scaled(from_u, kPa), scaled(*q, kPa), ring);
  }
  axes.line(t.held_out ? "predicted" : "fitted", scaled(path.y.col(0), kPa),
            scaled(path.y.col(1), kPa), {Colour::blue});
}

/// "correlation: lambda and Gamma 0.95 at most"
std::string strongest_correlation(const input::FitFile& file, const study::FitResult& result) {
  const MatrixXd& r = result.uncertainty.correlation;
  Index row = 0, column = 0;
  for (Index i = 0; i < r.rows(); ++i)
    for (Index j = 0; j < i; ++j)
      if (std::isfinite(r(i, j)) &&
          (row == column || std::abs(r(i, j)) > std::abs(r(row, column)))) {
        row = i;
        column = j;
      }
  if (row == column) return "correlation";
  const auto name = [&](Index i) { return file.free[static_cast<std::size_t>(i)].name; };
  return fmt::format("correlation: strongest {} and {}, {:.2f}", name(column), name(row),
                     r(row, column));
}

}  // namespace

Figure fit_picture(const input::FitFile& file, const calibration::Problem& problem,
                   const study::FitResult& result) {
  Figure figure(file.name,
                fmt::format("{} {}, objective {:.4g}; bands: 95 % from the parameters' covariance",
                            file.law.name, file.info->option, result.best().objective));
  figure.columns = 2;
  figure.panel_height_px = 220.0;
  const std::vector<study::Outliers> outliers = study::outliers(problem, result);
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    const auto& t = file.targets[k];
    const MatrixXd sd = prediction_sd(problem, result, k);
    const MatrixXd simulated = problem.predict(k, result.best().z).simulated;
    const auto [x_label, x_factor] = column_label(t.x_name, file.about[k].strain);
    const AxisScale scale = scale_over(t);
    const auto x = scaled(t.x, x_factor);
    std::vector<std::string> names;
    for (const calibration::Channel& c : t.channels) names.push_back(c.name);
    const calibration::Response drawn = problem.drawn(k, result.best().z, names);
    // a band needs x in order; loading and unloading would fold it
    const bool ordered = std::is_sorted(x.begin(), x.end());
    for (std::size_t c = 0; c < t.channels.size(); ++c) {
      const auto col = static_cast<Index>(c);
      const auto [y_label, factor] = column_label(t.channels[c].name, file.about[k].strain);
      const VectorXd s = simulated.col(col), b = result.uncertainty.quantile * sd.col(col);
      Axes& axes = figure.add_axes();
      axes.title = t.name + (t.held_out ? " (held out, predicted)" : "");
      axes.x = {x_label, scale};
      axes.y.label = y_label;
      // between the rows as well, where the simulation has something there
      const bool between = drawn.x.size() > t.x.size();
      const VectorXd curve = between ? VectorXd(drawn.y.col(col)) : s;
      const VectorXd half_band = between ? interpolated(t.x, b, drawn.x) : b;
      const auto curve_x = between ? scaled(drawn.x, x_factor) : x;
      if (ordered)
        axes.band("", curve_x, scaled(curve - half_band, factor), scaled(curve + half_band, factor),
                  {Colour::blue});
      axes.points("measured", x, scaled(t.channels[c].observed, factor),
                  {Colour::black, 1.0, Marker::ring, 5.0});
      for (const study::Outliers& found : outliers) {
        if (found.target != k || found.channel != c) continue;
        std::vector<double> out_x, out_y;
        for (const std::size_t row : found.rows) {
          out_x.push_back(x[row]);
          out_y.push_back(factor * t.channels[c].observed[static_cast<Index>(row)]);
        }
        axes.points("outliers", out_x, out_y, {Colour::vermillion, 1.0, Marker::cross, 7.0});
      }
      axes.line(t.held_out ? "predicted" : "fitted", curve_x, scaled(curve, factor),
                {Colour::blue});
      Axes& residuals = figure.add_axes();
      residuals.title = "simulated - measured";
      residuals.x = {x_label, scale};
      residuals.y.label = y_label;
      const std::vector<double> zero(x.size(), 0.0);
      residuals.line("", x, zero, {Colour::grey, 1.0});
      residuals.points("", x, scaled(s - t.channels[c].observed, factor),
                       {Colour::vermillion, 1.0, Marker::circle, 5.0});
    }
  }
  constexpr std::array<const char*, 2> path_channels{"p_Pa", "q_Pa"};
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    if (!file.about[k].triaxial) continue;
    const calibration::Response path = problem.drawn(
        k, result.best().z, std::vector<std::string>(path_channels.begin(), path_channels.end()));
    if (path.x.size() > 1) stress_path(figure, file.targets[k], path);
  }
  return figure;
}

Figure fit_diagnostics(const input::FitFile& file, const study::FitResult& result) {
  Figure figure(file.name + ": how well the data determine the parameters",
                fmt::format("{} start{}, {} distinct {}", result.starts.size(),
                            result.starts.size() == 1 ? "" : "s", result.clusters.size(),
                            result.clusters.size() == 1 ? "optimum" : "optima"));
  figure.columns = 3;
  figure.panel_width_px = 300.0;
  figure.panel_height_px = 220.0;
  Axes& convergence = figure.add_axes();
  convergence.title = "convergence";
  convergence.x.label = "evaluations with and without gradient";
  convergence.y = {"objective", AxisScale::logarithmic};
  for (const auto& s : result.starts) {
    std::vector<double> x, y;
    for (const auto& t : s.optimum.trace) {
      x.push_back(static_cast<double>(t.evaluations + t.gradients));
      y.push_back(t.objective);
    }
    convergence.line("", x, y, {Colour::blue, 0.8});
  }
  // parameter i against j, coloured by correlation: a table that is read at a glance
  Axes& correlation = figure.add_axes();
  correlation.title = strongest_correlation(file, result);
  std::vector<double> a, b, r;
  const Index n = result.uncertainty.correlation.rows();
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      a.push_back(static_cast<double>(j + 1));
      b.push_back(static_cast<double>(i + 1));
      r.push_back(result.uncertainty.correlation(i, j));
    }
  const double edge = static_cast<double>(n) + 0.5;
  std::string names;
  for (std::size_t i = 0; i < file.free.size(); ++i)
    names += fmt::format("{}{} {}", i == 0 ? "" : ", ", i + 1, file.free[i].name);
  constexpr std::size_t widest = 44;  // characters below a panel
  if (names.size() > widest) names = "parameter, in the order of fit.json";
  correlation.x = {names, AxisScale::linear, 0.5, edge};
  correlation.y = {"parameter", AxisScale::linear, 0.5, edge};
  correlation.scatter(a, b, r, {"correlation", AxisScale::linear, -1.0, 1.0}, {18.0, {}});
  for (const auto& profile : result.profiles) {
    const auto i = static_cast<std::size_t>(profile.parameter);
    Axes& axes = figure.add_axes();
    axes.title = "profile of " + file.free[i].name;
    axes.x.label = fmt::format("{} ({})", file.free[i].name, file.free[i].unit);
    axes.y = {"excess (95 % at 3.84)", AxisScale::linear, 0.0, 8.0};
    axes.line("", profile.value, profile.excess, {Colour::blue, 1.8, Marker::circle, 4.0});
    constexpr double limit = 3.841458821;  // the scale of Profile::excess
    const std::array<double, 2> ends{profile.value.front(), profile.value.back()};
    const std::array<double, 2> level{limit, limit};
    if (ends[0] < ends[1]) axes.dashed("", ends, level, {Colour::grey, 1.0});
  }
  return figure;
}

}  // namespace repose::report
