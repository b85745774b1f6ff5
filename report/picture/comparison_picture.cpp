#include "report/picture/comparison_picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace repose::report {
namespace {

using study::Comparison;
using study::ScoredFit;

/// "1 mcc, 2 mcc_nu": what the places of an axis stand for.
template <class List>
std::string places(const List& list) {
  std::string text;
  for (std::size_t k = 0; k < list.size(); ++k)
    text += fmt::format("{}{} {}", k == 0 ? "" : ", ", k + 1, list[k].name);
  return text;
}

Axis place_axis(std::string label, std::size_t count) {
  return {std::move(label), AxisScale::linear, 0.5, static_cast<double>(count) + 0.5};
}

/// What BIC and AIC of each fit lie above the least.
void criteria(Axes& axes, const Comparison& comparison) {
  axes.title = "criteria above the least";
  axes.x = place_axis("fit: " + places(comparison.fits), comparison.fits.size());
  axes.y.label = "difference";
  const auto series = [&](const char* name, calibration::Likelihood ScoredFit::*errors,
                          double (calibration::Likelihood::*criterion)() const, Style style) {
    std::vector<double> x, y;
    for (std::size_t k = 0; k < comparison.fits.size(); ++k) {
      x.push_back(static_cast<double>(k + 1));
      y.push_back(((comparison.fits[k].*errors).*criterion)());
    }
    const double least = *std::min_element(y.begin(), y.end());
    for (double& v : y) v -= least;
    axes.points(name, x, y, style);
  };
  using calibration::Likelihood;
  series("BIC, correlated errors", &ScoredFit::correlated, &Likelihood::bic,
         {Colour::blue, 1.0, Marker::circle});
  series("AIC, correlated errors", &ScoredFit::correlated, &Likelihood::aic,
         {Colour::blue, 1.0, Marker::ring});
  series("BIC, white errors", &ScoredFit::white, &Likelihood::bic,
         {Colour::orange, 1.0, Marker::square});
  series("AIC, white errors", &ScoredFit::white, &Likelihood::aic,
         {Colour::orange, 1.0, Marker::open_square});
}

/// A figure of every unseen test, fit by fit.
template <class Value>
void unseen(Axes& axes, const Comparison& comparison, const Value& value) {
  axes.x = place_axis("test: " + places(comparison.tests), comparison.tests.size());
  for (const ScoredFit& fit : comparison.fits) {
    std::vector<double> x, y;
    for (std::size_t t = 0; t < comparison.tests.size(); ++t) {
      if (fit.tests[t].test.channels.empty() || fit.tests[t].test.failed) continue;
      x.push_back(static_cast<double>(t + 1));
      y.push_back(value(fit, t));
    }
    axes.points(fit.name, x, y);
  }
}

}  // namespace

Figure comparison_picture(const Comparison& comparison) {
  Figure figure("which fit", comparison.left_out
                                 ? "every fitted test left out in turn; held-out tests as they are"
                                 : "held-out tests as they are");
  figure.columns = 1;
  figure.panel_width_px = 640.0;
  figure.panel_height_px = 200.0;
  criteria(figure.add_axes(), comparison);
  const bool any = std::any_of(comparison.tests.begin(), comparison.tests.end(),
                               [&](const auto& t) { return t.held_out || comparison.left_out; });
  if (!any) return figure;
  Axes& errors = figure.add_axes();
  errors.title = "error of unseen tests";
  errors.y.label = "r.m.s. over the range (%)";
  unseen(errors, comparison, [](const ScoredFit& fit, std::size_t t) {
    const calibration::UnseenTest& test = fit.tests[t].test;
    double squares = 0.0;
    for (const auto& c : test.channels) squares += c.relative_rms * c.relative_rms;
    return 100.0 * std::sqrt(squares / static_cast<double>(test.channels.size()));
  });
  Axes& scores = figure.add_axes();
  scores.title = "log score of unseen tests, relative to the first fit";
  scores.y.label = "difference";
  unseen(scores, comparison, [&](const ScoredFit& fit, std::size_t t) {
    return fit.tests[t].test.log_score - comparison.fits.front().tests[t].test.log_score;
  });
  return figure;
}

}  // namespace repose::report
