// Distances, verdicts and error bars of `repose validate`, and curves that are read off points.
#include <gtest/gtest.h>

#include "study/validation/case_run.hpp"
#include "study/validation/figure_values.hpp"
#include "study/validation/layer_curves.hpp"
#include "study/validation/validation_record.hpp"

namespace repose::study {
namespace {

using input::BenchmarkCurve;
using input::BenchmarkFigure;
using input::BenchmarkMeasure;

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const NoFigure& error) {
    return error.what();
  }
  return "";
}

TEST(Verdict, TheBarDecides) {
  const std::array<double, 2> band{1.0, 2.0};
  EXPECT_EQ(judge({1.5, 0.25}, band), Verdict::inside);
  EXPECT_EQ(judge({1.5, 0.5}, band), Verdict::inside);  // to the very ends
  EXPECT_EQ(judge({1.5, 0.6}, band), Verdict::undecided);
  EXPECT_EQ(judge({0.9, 0.2}, band), Verdict::undecided);
  EXPECT_EQ(judge({0.7, 0.2}, band), Verdict::outside);
  EXPECT_EQ(judge({2.5, 0.25}, band), Verdict::outside);
  EXPECT_EQ(judge({1.0}, band), Verdict::inside);  // no bar: by the value alone
  EXPECT_EQ(judge({2.1}, band), Verdict::outside);
  EXPECT_EQ(judge({std::nan(""), 0.1}, band), Verdict::failed);
}

TEST(Verdict, NoBarOfADistanceReachesBelowNone) {
  EXPECT_EQ(judge({0.01, 0.02}, {0.0, 0.05}), Verdict::undecided);
  EXPECT_EQ(judge({0.01, 0.02}, {0.0, 0.05}, 0.0), Verdict::inside);
}

// u = u* + c h: of order 1 the extrapolation is exact. Its bar is half of what is extrapolated,
// c h_f, since the other parts vanish, and twice that of the first three sizes.
TEST(EstimateOfSizes, HalvedThreeTimesIsThatOfOwnRuns) {
  for (const double u : {1.0, 0.0, -3.0}) {
    const Estimated e =
        estimate_of_sizes(std::array{0.4, 0.2, 0.1}, std::array{u + 0.08, u + 0.04, u + 0.02});
    EXPECT_NEAR(e.value, u, 1e-12);
    EXPECT_NEAR(e.error, 2.0 * 0.5 * 0.02, 1e-12);
  }
}

// Sizes by √2: extrapolated by w = 1/(√2 − 1) times the last change, which is c (h_m − h_f), so
// that w times it is c h_f again.
TEST(EstimateOfSizes, CloserOnesHaveAnOrderAsWell) {
  const double r = std::sqrt(2.0);
  const Estimated e =
      estimate_of_sizes(std::array{0.2, 0.2 / r, 0.1}, std::array{1.04, 1.0 + 0.04 / r, 1.02});
  EXPECT_NEAR(e.value, 1.0, 1e-9);
  EXPECT_NEAR(e.error, 0.5 * 0.02, 1e-9);
}

TEST(EstimateOfSizes, TwoSizesGiveTheFinestWithThreeTimesTheChange) {
  const Estimated e = estimate_of_sizes(std::array{0.2, 0.1}, std::array{1.04, 1.02});
  EXPECT_DOUBLE_EQ(e.value, 1.02);
  EXPECT_NEAR(e.error, 3.0 * 0.02, 1e-12);  // times 1/(2 − 1)
}

TEST(EstimateOfSizes, OneSizeHasNoBar) {
  const Estimated e = estimate_of_sizes(std::array{0.2}, std::array{1.04});
  EXPECT_EQ(e.value, 1.04);
  EXPECT_TRUE(std::isnan(e.error));
}

TEST(CurveAt, IsStraightBetweenPointsInEitherOrder) {
  const std::vector<double> x{0.0, 0.25, 1.5, 2.0};
  const std::vector<double> wanted{1.0, 1.5, 2.0, 1.0};
  EXPECT_EQ(curve_at({{0.0, 1.0, 2.0}, {1.0, 3.0, 1.0}}, x, 0.0), wanted);
  EXPECT_EQ(curve_at({{2.0, 1.0, 0.0}, {1.0, 3.0, 1.0}}, x, 0.0), wanted);
}

TEST(CurveAt, ReachesNoFurtherThanItMay) {
  const PlainCurve rows{{0.5, 1.5}, {10.0, 30.0}};
  EXPECT_EQ(curve_at(rows, {0.0, 2.0}, 1.0), (std::vector<double>{0.0, 40.0}));
  EXPECT_EQ(refusal([&] { curve_at(rows, {2.0}, 0.0); }),
            "the curve goes from x = 0.5 to 1.5, and the table has 2");
  EXPECT_NE(refusal([] { curve_at({{0.0, 1.0, 0.5}, {0.0, 1.0, 2.0}}, {0.2}, 0.0); }), "");
  EXPECT_NE(refusal([] { curve_at({{0.0}, {0.0}}, {0.0}, 0.0); }), "");
}

// Off by 3, −4 and 0 at three places: √(25/3), 4, 7 over Σ|table| = 60.
TEST(Distance, ByEachMeasure) {
  BenchmarkFigure figure;
  figure.curve = BenchmarkCurve::profile;
  figure.table_x = {0.0, 1.0, 2.0};
  figure.table_y = {10.0, 20.0, 30.0};
  const PlainCurve curve{{0.0, 1.0, 2.0}, {13.0, 16.0, 30.0}};
  EXPECT_DOUBLE_EQ(distance(curve, figure), std::sqrt(25.0 / 3.0));
  figure.measure = BenchmarkMeasure::max;
  EXPECT_DOUBLE_EQ(distance(curve, figure), 4.0);
  figure.measure = BenchmarkMeasure::relative;
  EXPECT_DOUBLE_EQ(distance(curve, figure), 7.0 / 60.0);
  figure.table_y = {0.0, 0.0, 0.0};
  EXPECT_NE(refusal([&] { distance(curve, figure); }), "");
}

/// Three points in two columns of width 1: one that stays, one above it that moves, one beside.
RunFrames frames() {
  io::Frame first;
  first.points = 3;
  first.position_m = {0.5, 0.4, 0.0, 0.5, 0.9, 0.0, 1.5, 0.3, 0.0};
  io::Frame last = first;
  last.position_m = {0.5, 0.4, 0.0, 0.7, 0.9, 0.0, 1.5, 0.35, 0.0};
  last.fields = {{"pressure_Pa", 1, {5.0, 1.0, 7.0}},
                 {"stress_Pa", 6, {-1, -2, -3, 4, 0, 0, -5, -6, -7, 8, 0, 0, -9, -8, -7, 6, 0, 0}},
                 {"velocity_m_per_s", 3, {1, 9, 9, 2, 9, 9, 4, 9, 9}}};
  return {first, last};
}

TEST(RestLine, IsTheHighestPointThatHasHardlyMoved) {
  const PlainCurve line = rest_line(frames(), 1.0, 2.0, 0.1);
  EXPECT_EQ(line.x, (std::vector<double>{0.5, 1.5}));
  EXPECT_EQ(line.y, (std::vector<double>{0.4, 0.35}));
  EXPECT_EQ(rest_line(frames(), 1.0, 2.0, 0.01).y, (std::vector<double>{0.4, 0.0}));
  EXPECT_EQ(rest_line(frames(), 1.0, 2.0, 1.0).y, (std::vector<double>{0.9, 0.35}));
  RunFrames fewer = frames();
  fewer.last.points = 2;
  EXPECT_NE(refusal([&] { rest_line(fewer, 1.0, 2.0, 0.1); }), "");
}

TEST(ColumnMeans, AreOfRowsOfPointsCompressionPositive) {
  const io::Frame last = frames().last;  // rows [0, 0.5): points 0 and 2; [0.5, 1): point 1
  EXPECT_EQ(column_means(last, 0.5, "p_Pa").x, (std::vector<double>{0.25, 0.75}));
  EXPECT_EQ(column_means(last, 0.5, "p_Pa").y, (std::vector<double>{6.0, 1.0}));
  EXPECT_EQ(column_means(last, 0.5, "sigma_h_Pa").y, (std::vector<double>{5.0, 5.0}));
  EXPECT_EQ(column_means(last, 0.5, "sigma_v_Pa").y, (std::vector<double>{5.0, 6.0}));
  EXPECT_EQ(column_means(last, 0.5, "tau_xy_Pa").y, (std::vector<double>{5.0, 8.0}));
  EXPECT_EQ(column_means(last, 0.5, "v_x_m_per_s").y, (std::vector<double>{2.5, 2.0}));
  EXPECT_NE(refusal([&] { column_means(last, 0.5, "mises_Pa"); }), "");
}

TEST(SceneValue, TheFrontIsWhereTheProfileFirstLacksDepth) {
  SweepRun run{};
  run.x_m = {0.0, 1.0, 2.0, 3.0};
  run.depth_m = {1.0, 0.8, 0.2, 0.9};
  BenchmarkFigure figure;
  figure.value = input::front_at;
  figure.depth = 0.5;
  figure.minus = 0.5;
  figure.over = 2.0;
  PlainCurve curve;
  EXPECT_DOUBLE_EQ(scene_value(figure, run, "", curve), (1.5 - 0.5) / 2.0);
  figure.depth = 0.1;
  EXPECT_NE(refusal([&] { scene_value(figure, run, "", curve); }), "");
}

TEST(SceneValue, IsOfTheSeriesOrTheSummary) {
  SweepRun run{};
  run.series = {{"time_s", {0.0, 1.0, 2.0}}, {"front_m", {1.0, 5.0, 3.0}}};
  run.summary.figures = {{"steps", 70.0}};
  BenchmarkFigure figure;
  PlainCurve curve;
  const auto value = [&](const char* name) {
    figure.value = name;
    return scene_value(figure, run, "", curve);
  };
  EXPECT_EQ(value("front_m"), 3.0);
  EXPECT_EQ(value("steps"), 70.0);
  figure.take = input::BenchmarkTake::largest;
  EXPECT_EQ(value("front_m"), 5.0);
  figure.take = input::BenchmarkTake::least;
  EXPECT_EQ(value("front_m"), 1.0);
  figure.take = input::BenchmarkTake::last;
  figure.over_start = true;
  run.series["front_m"].front() = 0.5;
  EXPECT_EQ(value("front_m"), 6.0);
  EXPECT_NE(refusal([&] { value("time_s"); }), "");  // from 0
  EXPECT_NE(refusal([&] { value("steps"); }), "");   // no column
  figure.over_start = false;
  EXPECT_EQ(refusal([&] { value("frnt_m"); }),
            "there is no 'frnt_m' in the result; did you mean 'front_m'?");
}

TEST(VerdictWords, CountWhatIsThere) {
  LawResult law;
  for (const Verdict verdict :
       {Verdict::inside, Verdict::inside, Verdict::outside, Verdict::undecided})
    law.figures.push_back({verdict, "", {}, {}, {}});
  EXPECT_EQ(verdict_words(law), "2 of 4 inside, 1 undecided");
  law.figures.back().verdict = Verdict::failed;
  EXPECT_EQ(verdict_words(law), "2 of 4 inside, 1 failed");
  law.figures = {{Verdict::absent, "no slope", {}, {}, {}}};
  EXPECT_EQ(verdict_words(law), "absent");
  law.figures = {{Verdict::not_run, "", {}, {}, {}}};
  EXPECT_EQ(verdict_words(law), "not run");
}

}  // namespace
}  // namespace repose::study
