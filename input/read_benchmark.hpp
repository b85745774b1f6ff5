#pragma once
/// \file
/// A validation case: a folder with case.toml, the scene or the point tests that it names and the
/// tables that were measured (docs/validate.md).

#include <limits>
#include <map>

#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"

namespace repose::input {

/// The columns of the page that `repose validate` writes: a law each; "mn" has the yield surface of
/// Matsuoka & Nakai in place of a cone.
constexpr std::array<std::string_view, 8> benchmark_columns{
    "mu_i", "mu_i_mn", "mcc", "mcc_mn", "cs", "cs_mn", "newtonian", "neo_hookean"};

/// The position of a column. Errors: BadInput with the names that there are.
std::size_t benchmark_column(std::string_view name);

/// What a curve of a figure is taken from.
enum class BenchmarkCurve : std::uint8_t {
  profile,    ///< profile.csv, at the end
  series,     ///< series.csv
  rest_line,  ///< the highest points that have hardly moved, over x
  column,     ///< means over the rows of points of a layer at the end
  point,      ///< curve.csv
};
/// Their names, in the same order.
constexpr std::array<std::string_view, 5> benchmark_curve_names{"profile", "series", "rest_line",
                                                                "column", "point"};
/// The fields of BenchmarkCurve::column.
constexpr std::array<std::string_view, 8> column_fields{
    "p_Pa",      "sigma_v_Pa",  "sigma_h_Pa",        "sigma_z_Pa",
    "tau_xy_Pa", "v_x_m_per_s", "density_kg_per_m3", "mises_Pa"};

/// How far a curve is from a table, over the table's rows.
enum class BenchmarkMeasure : std::uint8_t {
  rms,       ///< √(mean of squares), in the unit of y
  max,       ///< largest difference, in the unit of y
  relative,  ///< Σ|difference|/Σ|table|
};
constexpr std::array<std::string_view, 3> benchmark_measure_names{"rms", "max", "relative"};

/// Which of a column's values a number is.
enum class BenchmarkTake : std::uint8_t { last, largest, least };
constexpr std::array<std::string_view, 3> benchmark_take_names{"last", "largest", "least"};

/// The place where the profile at the end, followed from x = 0, is first less than depth_m deep.
inline constexpr std::string_view front_at = "front_at_m";

/// A figure that is compared with what was measured: a number of a result, or the distance of a
/// curve from a table.
struct BenchmarkFigure {
  std::string name, title, unit = "-";
  std::string value;   ///< of a number: a column of series.csv or curve.csv, a key of
                       ///< summary.json, or front_at
  double depth = 0.0;  ///< of front_at [m]
  BenchmarkTake take = BenchmarkTake::last;
  double minus = 0.0, over = 1.0;  ///< the figure is (value − minus)/over
  bool over_start = false;         ///< over being the first value of the same column
  double measured = std::numeric_limits<double>::quiet_NaN();
  std::optional<BenchmarkCurve> curve;  ///< or the kind of curve
  std::string x, y;                     ///< its columns
  std::string test;                     ///< of several point tests, which; "": the first
  std::optional<std::int64_t> stage;    ///< of a point test, the only one that counts, from 1
  double threshold = 0.0;               ///< of rest_line: the motion below which a point rests [m]
  std::string table;
  double x_scale = 1.0, x_shift = 0.0, y_scale = 1.0, y_shift = 0.0;  ///< of the table
  BenchmarkMeasure measure = BenchmarkMeasure::rms;
  std::array<double, 2> band{};  ///< of what counts as right, in the figure's unit
  std::string band_from;
  std::vector<double> table_x, table_y;  ///< SI, scaled and shifted
  Origin origin;

  bool is_curve() const { return curve.has_value(); }
};

/// A law of a case, and what is run with it.
struct BenchmarkLaw {
  std::size_t column = 0;  ///< of benchmark_columns
  LawSpec law;
  std::vector<std::string> set;   ///< overrides of the scene or the tests
  std::string parameters;         ///< where they are from
  std::vector<SceneFile> scenes;  ///< one per cell size, coarse to fine
  std::vector<PointTestFile> tests;
};

struct Benchmark {
  std::string name;  ///< of its folder
  std::string title, source, about;
  std::string scene;               ///< a file, or a scene that the program holds; "": point tests
  std::vector<std::string> tests;  ///< files
  std::vector<double> cells;       ///< h, coarse to fine [m]
  std::vector<BenchmarkLaw> laws;
  std::map<std::string, std::string> absent;  ///< columns without a law, and why
  std::vector<BenchmarkFigure> figures;

  bool is_scene() const { return !scene.empty(); }
  /// The law of a column; null if it is absent.
  const BenchmarkLaw* law_of(std::size_t column) const;
  /// The test that a figure is of.
  std::size_t test_of(const BenchmarkFigure& figure) const;
};

/// The keys of a case.toml.
void benchmark_keys(Keys& keys, Benchmark& benchmark);

/// Reads a case with everything that it names: each scene with each law and cell size, each test
/// with each law, the tables. overrides: of every scene and test. Throws BadInput with everything
/// that is wrong.
Benchmark read_benchmark(InputFile& file, std::span<const std::string> overrides = {});

}  // namespace repose::input
