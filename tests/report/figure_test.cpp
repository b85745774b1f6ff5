#include "report/plot/figure.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include <gtest/gtest.h>
#include <unistd.h>

#include "io/atomic_file.hpp"
#include "report/picture/heap_picture.hpp"
#include "report/plot/gnuplot.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::report {
namespace {

namespace fs = std::filesystem;
using Values = std::vector<double>;

class FigureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      run_gnuplot("");
    } catch (const PlotError& error) {
      GTEST_SKIP() << error.what();
    }
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

using HeapPictureTest = FigureTest;
using GnuplotTest = FigureTest;

/// Sets an environment variable while in scope.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { ::setenv(name_, before_.c_str(), 1); }

 private:
  const char* name_;
  std::string before_;
};

std::size_t count(std::string_view text, std::string_view piece) {
  std::size_t found = 0;
  for (std::size_t at = text.find(piece); at != std::string_view::npos;
       at = text.find(piece, at + piece.size()))
    ++found;
  return found;
}

bool contains(std::string_view text, std::string_view piece) { return count(text, piece) > 0; }

/// The dots of a picture in the order drawn: a cloud or points with the marker `circle`.
struct Dot {
  double x = 0.0, y = 0.0, radius = 0.0;
  std::string colour;
};

std::vector<Dot> dots(const std::string& svg) {
  std::vector<Dot> out;
  const std::string_view begin = "<circle cx='";
  for (std::size_t at = svg.find(begin); at != std::string::npos; at = svg.find(begin, at + 1)) {
    Dot dot;
    std::array<char, 8> colour{};
    if (std::sscanf(svg.substr(at, 100).c_str(), "<circle cx='%lf' cy='%lf' r='%lf' fill='%7s",
                    &dot.x, &dot.y, &dot.radius, colour.data()) == 4) {
      dot.colour = colour.data();
      out.push_back(dot);
    }
  }
  return out;
}

Style unlike_the_cycle() {
  Style style;
  style.colour = Colour::grey;
  return style;
}

TEST(GnuplotText, LeavesNothingThatGnuplotWouldAct) {
  EXPECT_EQ(gnuplot_text("von Mises (kPa)"), "'von Mises (kPa)'");
  EXPECT_EQ(gnuplot_text("it's"), "'it''s'");
  EXPECT_EQ(gnuplot_text("a_b^c{d}@e&f~g\\h"), R"('a\_b\^c\{d\}\@e\&f\~g\\h')");
  EXPECT_EQ(gnuplot_text("one\ntwo\t\x01"), "'one two  '");
  EXPECT_EQ(gnuplot_text("ε_{a} 10^{-3}"), "'ε_{a} 10^{-3}'");
  EXPECT_EQ(gnuplot_text("x_{a{b}"), R"('x_{a\{b}')");
  EXPECT_EQ(gnuplot_text("x_{open"), R"('x\_\{open')");
  EXPECT_EQ(gnuplot_text("T", true), "'{/:Bold T}'");
  // Broken UTF-8: a lone continuation, a cut sequence, an overlong slash, a surrogate.
  EXPECT_EQ(gnuplot_text("a\x80z"), "'a\uFFFDz'");
  EXPECT_EQ(gnuplot_text("a\xce"), "'a\uFFFD'");
  EXPECT_EQ(gnuplot_text("\xc0\xaf"), "'\uFFFD\uFFFD'");
  EXPECT_EQ(gnuplot_text("\xed\xa0\x80"), "'\uFFFD\uFFFD\uFFFD'");
}

TEST_F(GnuplotTest, FailureCarriesItsMessage) {
  try {
    run_gnuplot("set nonsense 3\n");
    FAIL() << "no exception";
  } catch (const PlotError& error) {
    EXPECT_TRUE(contains(error.gnuplot_messages(), "set nonsense 3")) << error.gnuplot_messages();
    EXPECT_TRUE(contains(error.what(), "gnuplot failed: "));
  }
}

TEST_F(GnuplotTest, AnotherProgramOfThatNameFailsInTheSameWay) {
  std::ofstream(folder_ / "gnuplot") << "#!/bin/sh\necho 'no licence' >&2\nexit 3\n";
  fs::permissions(folder_ / "gnuplot", fs::perms::owner_all);
  const Environment path("PATH", folder_.string() + ":" + std::getenv("PATH"));
  try {
    run_gnuplot("plot x\n");
    FAIL() << "no exception";
  } catch (const PlotError& error) {
    EXPECT_EQ(error.gnuplot_messages(), "no licence\n");
  }
}

TEST_F(GnuplotTest, ItsAbsenceSaysWhatToInstall) {
  const Environment path("PATH", folder_.string());
  Figure figure;
  figure.add_axes().line("", Values{0, 1}, Values{0, 1});
  try {
    figure.render_svg(folder_ / "a.svg");
    FAIL() << "no exception";
  } catch (const PlotError& error) {
    EXPECT_STREQ(error.what(), "gnuplot is not installed (Debian: apt-get install gnuplot-nox)");
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(GnuplotTest, UserStartUpFilesAreNotRead) {
  std::ofstream(folder_ / ".gnuplot") << "set nonsense\n";
  const Environment home("HOME", folder_.string());
  EXPECT_EQ(run_gnuplot("print 1\n"), "");
}

TEST_F(FigureTest, SameFigureSameBytes) {
  Figure figure("title", "subtitle");
  for (int k = 0; k < 3; ++k) {
    Axes& axes = figure.add_axes();
    axes.line("a", Values{0, 1, 2}, Values{0, 1, 4})
        .band("b", Values{0, 2}, Values{0, 1}, Values{1, 2});
    if (k == 2) axes.scatter(Values{0, 1}, Values{1, 2}, Values{3, 4}, {.label = "c"});
  }
  figure.render_svg(folder_ / "a.svg");
  const std::string svg = content_of(folder_ / "a.svg");
  EXPECT_EQ(svg, figure.svg());
  EXPECT_FALSE(contains(svg, "Produced by"));  // nothing that tells gnuplot versions apart
}

TEST_F(FigureTest, TextsAreShownAndNeverExecuted) {
  const fs::path mark = folder_ / "executed";
  const std::string touch = "touch " + mark.string();
  const std::string evil = "`" + touch + "` '; system('" + touch + "') #\n!" + touch + "\n<b>&amp;";
  Figure figure(evil, evil);
  Axes& axes = figure.add_axes();
  axes.title = axes.x.label = axes.y.label = evil;
  axes.line(evil, Values{0, 1}, Values{0, 1});
  axes.scatter(Values{0, 1}, Values{1, 2}, Values{3, 4}, {.label = evil});
  axes.arrow({0, 0, 1, 1, evil});
  const std::string svg = figure.svg();
  EXPECT_FALSE(fs::exists(mark));
  EXPECT_FALSE(contains(svg, "<b>"));
  EXPECT_TRUE(contains(svg, "`" + touch + "`"));
  // The document's title, the figure's (wrapped), subtitle, panel, three axes, arrow and legend.
  EXPECT_GE(count(svg, "&lt;b>"), 8u);
}

TEST_F(FigureTest, LinearAndLogarithmicPlaces) {
  Figure figure;
  figure.panel_width_px = 400.0;
  figure.panel_height_px = 300.0;
  Axes& axes = figure.add_axes();
  axes.x = {.label = "x", .scale = AxisScale::logarithmic, .lower = 1.0, .upper = 1e4};
  axes.y = {.label = "y", .lower = 0.0, .upper = 3.0};
  axes.points("", Values{10, 100, 1000}, Values{1, 2, 2.5}, unlike_the_cycle());
  const auto found = dots(figure.svg());
  ASSERT_EQ(found.size(), 3u);
  // A decade is 400/4 px wide, one unit of y 300/3 px high; gnuplot counts tenths of pixels.
  constexpr double rounding = 0.2;
  EXPECT_NEAR(found[1].x - found[0].x, 100.0, rounding);
  EXPECT_NEAR(found[2].x - found[1].x, 100.0, rounding);
  EXPECT_NEAR(found[0].y - found[1].y, 100.0, rounding);
  EXPECT_NEAR(found[1].y - found[2].y, 50.0, rounding);
  EXPECT_NEAR(found[0].radius, 3.5, 0.01);  // the default marker of 7 px
  EXPECT_EQ(found[0].colour, "#8c8c8c");
}

TEST_F(FigureTest, ColoursFollowTheValues) {
  Figure figure;
  Axes& axes = figure.add_axes();
  axes.scatter(Values{0, 1, 2, 3}, Values{0, 1, 0, 1}, Values{5, 6, 7, std::nan("")},
               {.label = "value (Pa)"});
  const std::string svg = figure.svg();
  const auto found = dots(svg);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].colour, "#440154");  // viridis begins,
  EXPECT_EQ(found[2].colour, "#fde725");  // ends,
  EXPECT_EQ(found[1].colour, "#21908c");  // and has its middle here
  EXPECT_TRUE(contains(svg, "value (Pa)"));
  EXPECT_TRUE(contains(svg, "without a value: 1"));  // and not hidden
  EXPECT_THROW(axes.scatter(Values{0}, Values{0}, Values{0}, {}), std::logic_error);
}

TEST_F(FigureTest, WhatCannotBeDrawnIsCounted) {
  Figure figure("t", "given");
  Axes& axes = figure.add_axes();
  axes.y.scale = AxisScale::logarithmic;
  axes.line("", Values{0, 1, 2, 3, 4, 5}, Values{1, 2, 0, std::nan(""), 3, 4});
  const std::string svg = figure.svg();
  EXPECT_TRUE(contains(svg, "given; 2 values cannot be drawn"));
  Figure without;
  without.add_axes().line("", Values{0, 1}, Values{std::nan(""), std::nan("")});
  EXPECT_TRUE(contains(without.svg(), "2 values cannot be drawn"));
}

/// Seconds that a picture of these values takes, on any scales.
double seconds_for(const Values& x, const Values& y) {
  const auto begin = std::chrono::steady_clock::now();
  for (const AxisScale scale : {AxisScale::linear, AxisScale::logarithmic}) {
    Figure figure("t");
    Axes& axes = figure.add_axes();
    axes.x.scale = axes.y.scale = scale;
    axes.line("a line", x, y);
    axes.points("points", x, y);
    EXPECT_TRUE(contains(figure.svg(), "</svg>"));
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Constant but for round-off, empty, one row, not finite, of any size: a picture, and soon. Two
// pictures take 0.1 s here; a loaded machine is given a hundred times that.
TEST_F(FigureTest, EveryCurveIsDrawn) {
  const double tiny = 1.4e-11;
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const std::vector<std::pair<Values, Values>> curves{
      {{}, {}},
      {{1.0}, {2.0}},
      {{0.0, 0.1, 0.2}, {100.0, 100.0, 100.0}},
      {{0.0, 0.1, 0.2}, {100.0, 100.0 + tiny, 100.0 - tiny}},
      {{100.0, 100.0 + tiny, 100.0 - tiny}, {0.0, 0.1, 0.2}},
      {{5.0, 5.0}, {0.0, 0.0}},
      {{0.0, 1.0}, {1.0, 1.0 + 1e-8}},
      {{nan, inf, -inf}, {1.0, 2.0, 3.0}},
      {{0.0, 1.0, 2.0}, {nan, nan, nan}},
      {{0.0, 1e-300}, {0.0, 1e300}},
      {{1e-300, 1e300}, {1e300, 1e-300}},
      {{-1e300, 1e300}, {-1e-300, 1e-300}},
      {{0.0, 1.7e308}, {-1.7e308, 1.7e308}},
      {{0.0, 5e-324}, {0.0, 1.0}},
      {{1.0, 1.0 + 2e-16}, {1.0, 2.0}}};
  for (const auto& [x, y] : curves)
    EXPECT_LT(seconds_for(x, y), 10.0)
        << testing::PrintToString(x) << " " << testing::PrintToString(y);
}

TEST_F(FigureTest, ALineOfOnePointIsSeen) {
  Figure figure("t");
  figure.add_axes().line("", Values{1.0}, Values{2.0}, unlike_the_cycle());
  EXPECT_EQ(dots(figure.svg()).size(), 1u);
}

TEST_F(FigureTest, TinyAndHugeValuesStandAtTheirPlaces) {
  const auto places = [](double x_unit, double y_unit) {
    Figure figure("t");
    figure.add_axes().points("", Values{0.0, 0.5 * x_unit, x_unit},
                             Values{0.0, 0.25 * y_unit, y_unit});
    return dots(figure.svg());
  };
  const auto usual = places(1.0, 1.0);
  const auto odd = places(1e-280, 1e280);
  ASSERT_EQ(usual.size(), 3u);
  ASSERT_EQ(odd.size(), 3u);
  // the plotting areas differ by the width of the ticks' numbers; shares of them do not
  const auto share = [](const std::vector<Dot>& d) {
    return std::array{(d[1].x - d[0].x) / (d[2].x - d[0].x), (d[1].y - d[0].y) / (d[2].y - d[0].y)};
  };
  EXPECT_NEAR(share(odd)[0], share(usual)[0], 0.01);  // gnuplot's tenth of a pixel
  EXPECT_NEAR(share(odd)[1], share(usual)[1], 0.01);
}

TEST_F(GnuplotTest, OneThatDoesNotEndIsStopped) {
  std::ofstream(folder_ / "gnuplot") << "#!/bin/sh\nexec sleep 100\n";
  fs::permissions(folder_ / "gnuplot", fs::perms::owner_all);
  const Environment path("PATH", folder_.string() + ":" + std::getenv("PATH"));
  const auto begin = std::chrono::steady_clock::now();
  try {
    run_gnuplot("plot x\n", std::chrono::milliseconds(1000));
    FAIL() << "no exception";
  } catch (const PlotError& error) {
    EXPECT_STREQ(error.what(), "gnuplot was not done after 1 s and has been stopped");
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(FigureTest, LargeCloudsAreThinnedAndSaySo) {
  constexpr std::size_t n = 50'000;
  Values x(n), y(n), value(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = static_cast<double>(i % 250);
    y[i] = static_cast<double>(i / 250);
    value[i] = x[i];
  }
  Figure figure;
  ScatterStyle style;
  style.marker_px = 2.0;
  figure.add_axes().scatter(x, y, value, {.label = "v"}, style);
  const std::string svg = figure.svg();
  const auto found = dots(svg);
  EXPECT_EQ(found.size(), Figure::point_limit);
  EXPECT_TRUE(contains(svg, "20 000 of 50 000 points shown"));
  EXPECT_NEAR(found[0].radius, std::sqrt(2.5), 0.01);  // 2.5 times the area for each that is left
  // Even: the left half keeps half of the points. Each stretch of 2.5 points draws independently
  // one of its places, a variance of at most 1/4 each: 5 deviations are 5·√(20000/4) < 360.
  const double middle =
      0.5 *
      (std::min_element(found.begin(), found.end(), [](auto& a, auto& b) { return a.x < b.x; })->x +
       std::max_element(found.begin(), found.end(), [](auto& a, auto& b) { return a.x < b.x; })->x);
  const auto left =
      std::count_if(found.begin(), found.end(), [&](auto& d) { return d.x < middle; });
  EXPECT_NEAR(static_cast<double>(left), 10'000.0, 360.0);
}

TEST_F(FigureTest, TheLegendAvoidsTheCurves) {
  // Rising to the upper right: the legend stands at the upper left, its text left of the middle.
  const auto legend_x = [](const Values& x, const Values& y) {
    Figure figure;
    figure.add_axes().line("NAME", x, y);
    const std::string svg = figure.svg();
    const std::size_t text = svg.rfind(">NAME<");
    double at = -1.0;
    std::sscanf(svg.c_str() + svg.rfind("translate(", text), "translate(%lf", &at);
    return at;
  };
  EXPECT_LT(legend_x(Values{0, 1}, Values{0, 1}), 230.0);  // plotting area: about 50 to 470 px
  EXPECT_GT(legend_x(Values{0, 1}, Values{1, 0}), 230.0);
  // A curve that fills the panel leaves it no place inside.
  Values x, y;
  for (int k = 0; k <= 60; ++k) {
    x.push_back(k);
    y.push_back(k % 2);
  }
  EXPECT_GT(legend_x(x, y), 470.0);
}

TEST_F(FigureTest, BadInputIsRefused) {
  Axes axes;
  EXPECT_THROW(axes.line("a", Values{1}, Values{1, 2}), std::invalid_argument);
  EXPECT_THROW(axes.band("a", Values{1}, Values{1}, Values{}), std::invalid_argument);
  EXPECT_THROW(axes.scatter(Values{1}, Values{1}, Values{}, {}), std::invalid_argument);
  EXPECT_TRUE(axes.series().empty());
  EXPECT_THROW(Figure().svg(), std::logic_error);
  Figure equal;
  equal.add_axes().equal_aspect = true;
  equal.add_axes().x.scale = AxisScale::logarithmic;
  equal.panels().back()->equal_aspect = true;
  EXPECT_THROW(equal.svg(), std::logic_error);
  Figure reversed;
  reversed.add_axes().x = {.label = "p", .lower = 2.0, .upper = 1.0};
  EXPECT_THROW(reversed.svg(), std::logic_error);
  Figure unwritable;
  unwritable.add_axes().line("", Values{0, 1}, Values{0, 1});
  EXPECT_THROW(unwritable.render_svg(folder_ / "no" / "a.svg"), io::IoError);
}

HeapPicture heap(const Values& x, const Values& y, const Values& value) {
  HeapPicture picture;
  picture.title = "Column collapse";
  picture.scene.domain = {1.2, 0.56, 0.0};
  picture.scene.h = 0.02;  // points 0.01 m apart
  picture.x_m = x;
  picture.y_m = y;
  picture.value = value;
  picture.value_label = "von Mises stress (kPa)";
  return picture;
}

TEST_F(FigureTest, PointsMayHaveALengthForDiameter) {
  Figure figure;
  Axes& axes = figure.add_axes();
  axes.x = {.label = "x", .lower = 0.0, .upper = 1.0};
  Style style = unlike_the_cycle();
  style.diameter = 0.01;
  axes.points("dots", Values{0.25, 0.75}, Values{1.0, 1.0}, style);
  const auto found = dots(figure.svg());
  ASSERT_EQ(found.size(), 3u) << "two points and the sample of the legend";
  std::vector<double> radii;
  for (const Dot& dot : found) radii.push_back(dot.radius);
  std::sort(radii.begin(), radii.end());
  // a hundredth of the panel's 420 px across, and 7 px to be seen in the legend; gnuplot writes
  // radii to 0.01 px
  EXPECT_NEAR(radii[0], 0.5 * 0.01 * 420.0, 0.01);
  EXPECT_NEAR(radii[1], 0.5 * 0.01 * 420.0, 0.01);
  EXPECT_NEAR(radii[2], 0.5 * 7.0, 0.01);
}

TEST_F(FigureTest, LabelsStayInThePanel) {
  Figure figure;
  Axes& axes = figure.add_axes();
  axes.x = {.label = "x", .lower = 0.0, .upper = 1.0};
  axes.line("", Values{0.0, 1.0}, Values{0.0, 1.0});
  axes.label({0.1, 0.5, "on its right"}).label({0.9, 0.5, "on its left"});
  const std::string svg = figure.svg();
  const auto anchor = [&](const std::string& text) {
    const std::size_t at = svg.find(text), from = svg.rfind("text-anchor=\"", at) + 13;
    return svg.substr(from, svg.find('"', from) - from);
  };
  ASSERT_TRUE(contains(svg, "on its right") && contains(svg, "on its left"));
  EXPECT_EQ(anchor("on its right"), "start");
  EXPECT_EQ(anchor("on its left"), "end");
}

TEST_F(HeapPictureTest, IsToScale) {
  const Values x{0.0, 1.2, 0.0, 1.2}, y{0.0, 0.0, 0.5, 0.5}, value{1, 2, 3, 4};
  HeapPicture picture = heap(x, y, value);
  picture.scene.tilt_deg = 21.0;
  write_heap_picture(folder_ / "final.svg", picture);
  const std::string svg = content_of(folder_ / "final.svg");
  const auto found = dots(svg);
  ASSERT_EQ(found.size(), 4u);
  const double scale_x = (found[1].x - found[0].x) / 1.2, scale_y = (found[0].y - found[2].y) / 0.5;
  EXPECT_NEAR(scale_x / scale_y, 1.0, 2e-3);  // a pixel's tenth, twice, over the shorter 350 px
  EXPECT_NEAR(2.0 * found[0].radius, 1.7 * 0.01 * scale_x, 0.02);  // spacing, 1.7 times
  EXPECT_TRUE(contains(svg, "von Mises stress (kPa)"));
  EXPECT_TRUE(contains(svg, "gravity, tilt 21°"));
  EXPECT_FALSE(contains(svg, "colours span"));
}

TEST_F(HeapPictureTest, AnOutlierDoesNotTakeTheColours) {
  Values x, y, value;
  for (int k = 0; k < 1000; ++k) {
    x.push_back(0.001 * k);
    y.push_back(0.1);
    value.push_back(0.001 * k);
  }
  value[500] = 50.0;
  write_heap_picture(folder_ / "final.svg", heap(x, y, value));
  EXPECT_TRUE(contains(content_of(folder_ / "final.svg"),
                       "colours span 99 % of the points, values reach from 0 to 50"));
}

TEST_F(HeapPictureTest, AnyShapeOfBoxIsDrawn) {
  const Values x{0.1, 0.2}, y{0.1, 0.2}, value{1.0, 1.0};
  for (const auto& [width, height] : {std::pair{20.0, 0.5}, std::pair{0.3, 3.0}}) {
    HeapPicture picture = heap(x, y, value);
    picture.scene.domain = {width, height, 0.0};
    write_heap_picture(folder_ / "final.svg", picture);
    EXPECT_EQ(dots(content_of(folder_ / "final.svg")).size(), 2u);
  }
  HeapPicture picture = heap(x, y, value);
  picture.scene.domain[1] = 0.0;
  EXPECT_THROW(write_heap_picture(folder_ / "bad.svg", picture), std::invalid_argument);
  picture = heap(x, y, Values{});
  EXPECT_THROW(write_heap_picture(folder_ / "bad.svg", picture), std::invalid_argument);
}

}  // namespace
}  // namespace repose::report
