#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/plot/axis_ticks.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// Sizes of the lettering in pixels.
inline constexpr double title_px = 17.0, panel_title_px = 14.0, text_px = 13.0;
/// From one line of running text to the next, in its own size.
inline constexpr double line_height = 1.45;
/// White around everything, in pixels.
inline constexpr double edge = 16.0;

/// The letters of a text, not its bytes, and without its markup.
std::size_t letters_in(std::string_view text);

/// About as wide as sans-serif text comes out, in pixels.
double text_width(std::string_view text, double size_px);

/// Can a value be shown? What is not finite cannot, nor what is not positive on a logarithmic axis,
/// nor what lies beyond 1e±300.
bool drawable(double value, AxisScale scale);

/// An axis with everything that Axis leaves open decided.
struct AxisView {
  double lower = 0.0, upper = 1.0;
  bool by_fraction = false;  // gnuplot is given places from 0 to 1 instead of values
  AxisScale scale = AxisScale::linear;
  std::string label;
  std::vector<Tick> ticks;

  /// Where a value stands between the two ends, 0 to 1.
  double fraction(double value) const;
};

/// A rectangle in pixels from the picture's upper left corner.
struct Rect {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
};

/// Where a text stands, by its middle.
struct Spot {
  double x = 0.0, y = 0.0;
};

struct PanelView {
  Rect area;  // the plotting area
  AxisView x, y;
  Spot x_label, y_label;
  std::optional<AxisView> colours;
  Rect bar;  // of the colours, if there are any
  Spot bar_label;
  bool bar_below = false;
  std::optional<Rect> legend;
  std::size_t legend_letters = 0;  // of its longest name
  bool legend_beside = false;
};

struct FigureView {
  double width = 0.0, height = 0.0;
  std::vector<std::string> title_lines, subtitle_lines;
  std::vector<PanelView> panels;
};

/// Decides ranges, ticks, legends and where everything stands. notes: sentences for the subtitle.
/// Errors: std::logic_error as Figure::svg().
FigureView lay_out(const Figure& figure, const std::vector<std::string>& notes);

}  // namespace repose::report
