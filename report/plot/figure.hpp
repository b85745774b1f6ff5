#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace repose::report {

enum class AxisScale { linear, logarithmic };

/// An axis or a colour scale. What is not given is taken from the data, with a little room around
/// them; a linear axis begins at zero if the data come near it from one side.
/// label: with its unit, "q (kPa)". Texts of a figure are plain, except that _{...} is a subscript
/// and ^{...} a superscript.
struct Axis {
  std::string label;
  AxisScale scale = AxisScale::linear;
  std::optional<double> lower{}, upper{};
};

/// Where the names of the series stand. best: the emptiest corner. right: beside the panel.
enum class Legend { best, top_left, top_right, bottom_left, bottom_right, right, none };

/// The palette of Okabe & Ito (2008), told apart with every kind of colour blindness; its yellow,
/// too pale for a line on white, is left out. automatic: the next one that the panel has not used.
enum class Colour { automatic, blue, vermillion, green, purple, orange, sky, black, grey };

/// The k-th of the colours that `automatic` goes through, starting again after the last.
Colour cycle_colour(std::size_t k);

enum class Marker {
  circle,
  ring,
  square,
  open_square,
  triangle,
  open_triangle,
  diamond,
  open_diamond,
  cross,
  plus
};

struct Style {
  Colour colour = Colour::automatic;
  double width_px = 1.8;             // of a line
  std::optional<Marker> marker{};    // on a line: none unless given; for points: circle
  double marker_px = 7.0;            // diameter
  std::optional<double> diameter{};  // of points: as a length on the x-axis instead
};

/// How large a point of a scatter is drawn: in pixels, or as a length on the x-axis.
struct ScatterStyle {
  double marker_px = 5.0;
  std::optional<double> diameter{};
};

enum class SeriesKind { line, dashed, points, band, area, scatter, shade };

/// One series as it is kept by Axes; the last two are empty where the kind has no use for them.
struct Series {
  SeriesKind kind = SeriesKind::line;
  std::string name;
  Style style;
  ScatterStyle scatter_style;
  std::vector<double> x, y, upper, value;
};

struct Arrow {
  double from_x = 0.0, from_y = 0.0, to_x = 0.0, to_y = 0.0;
  std::string label;  // beside its tail
};

/// A text beside a place: on its right, on its left where that is near the right end of the panel.
struct Label {
  double x = 0.0, y = 0.0;
  std::string text;
};

/// One panel. Series are drawn in the order given, shades and then bands and areas before all
/// others, arrows and labels upon them. A name that is empty keeps a series out of the legend.
/// Lines break where a value is not finite, or not positive on a logarithmic axis, and points are
/// left out; the figure's subtitle then says how many. Every adder throws std::invalid_argument if
/// its arrays differ in length.
class Axes {
 public:
  std::string title;
  Axis x, y;
  bool equal_aspect = false;  // one unit is as long on both axes (linear ones only)
  Legend legend = Legend::best;

  Axes& line(std::string name, std::span<const double> xs, std::span<const double> ys,
             Style style = {});
  Axes& dashed(std::string name, std::span<const double> xs, std::span<const double> ys,
               Style style = {});
  Axes& points(std::string name, std::span<const double> xs, std::span<const double> ys,
               Style style = {});
  /// A tinted area between two curves over the same xs.
  Axes& band(std::string name, std::span<const double> xs, std::span<const double> lower,
             std::span<const double> upper, Style style = {});
  /// What a closed curve surrounds, tinted.
  Axes& area(std::string name, std::span<const double> xs, std::span<const double> ys,
             Style style = {});
  /// Points coloured by value (viridis) with a colour bar. One per panel: a second throws
  /// std::logic_error. Points without a finite value are drawn as crosses and counted in the
  /// legend.
  Axes& scatter(std::span<const double> xs, std::span<const double> ys,
                std::span<const double> values, Axis colours, ScatterStyle style = {});
  /// A grey picture below everything else, on cells of a lattice that (xs, ys) are the middles of,
  /// row by row; 0 is black, 1 white.
  Axes& shade(std::span<const double> xs, std::span<const double> ys,
              std::span<const double> greys);
  Axes& arrow(Arrow arrow);
  Axes& label(Label label);

  const std::vector<Series>& series() const { return series_; }
  const std::vector<Arrow>& arrows() const { return arrows_; }
  const std::vector<Label>& labels() const { return labels_; }
  const std::optional<Axis>& colours() const { return colours_; }

 private:
  Axes& add(SeriesKind kind, std::string name, std::span<const double> xs,
            std::span<const double> ys, Style style);

  std::vector<Series> series_;
  std::vector<Arrow> arrows_;
  std::vector<Label> labels_;
  std::optional<Axis> colours_;
};

/// Panels in a grid, drawn by gnuplot as SVG. The same figure gives the same bytes.
/// Clouds of more than `point_limit` points are thinned evenly, which the subtitle tells.
class Figure {
 public:
  static constexpr std::size_t point_limit = 20'000;

  explicit Figure(std::string figure_title = {}, std::string figure_subtitle = {});

  std::string title, subtitle;
  std::size_t columns = 0;         // 0: as square as possible
  double panel_width_px = 420.0;   // of the plotting area alone; with equal aspect the area is
  double panel_height_px = 300.0;  // the largest that fits into these

  /// Adds a panel, row by row; the reference stays valid as long as the figure.
  Axes& add_axes();
  const std::vector<std::unique_ptr<Axes>>& panels() const { return panels_; }

  /// The picture. Errors: PlotError (gnuplot.hpp) if gnuplot is missing or fails; std::logic_error
  /// for a figure without panels, an empty or non-finite range, equal aspect on a logarithmic axis.
  std::string svg() const;

  /// svg() into a file, whole or not at all. Errors: as svg(); IoError.
  void render_svg(const std::filesystem::path& path) const;

 private:
  std::vector<std::unique_ptr<Axes>> panels_;
};

}  // namespace repose::report
