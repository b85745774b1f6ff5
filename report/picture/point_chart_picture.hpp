#pragma once
/// \file
/// The pictures of `repose chart point`.

#include "report/plot/figure.hpp"
#include "study/chart/point_chart.hpp"

namespace repose::report {

/// Time over error: a panel per path, a line per method, bars between the quartiles.
Figure work_figure(const std::vector<point::WorkPoint>& points);

/// log10 of the error over (Δε_v, Δε_q), a panel per start.
Figure error_map_figure(const std::vector<study::ErrorMap>& maps);

/// Taylor's remainder over the perturbation, a line per law, and the slope of second order.
Figure tangent_figure(const std::vector<point::TangentTest>& tests);

}  // namespace repose::report
