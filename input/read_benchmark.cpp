#include "input/read_benchmark.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "input/key_info.hpp"
#include "input/measured_columns.hpp"
#include "input/read_chart.hpp"
#include "input/read_keys.hpp"
#include "input/shipped_input.hpp"

namespace repose::input {
namespace {

namespace fs = std::filesystem;

/// Keys of [[law]] beside those of the law.
constexpr std::array<std::string_view, 3> beside_law{"column", "set", "parameters"};

fs::path beside(const InputFile& file, const std::string& name) {
  return fs::path(file.name()).parent_path() / name;
}

/// Reports a file that the case names and that is not there.
bool is_there(TomlReader& table, std::string_view key, const std::string& name) {
  const fs::path path = beside(table.file(), name);
  if (fs::is_regular_file(path)) return true;
  const std::string near = similar_file(path);
  table.report(key, fmt::format("there is no file {}{}", path.string(),
                                near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  return false;
}

bool is_shipped_name(const std::string& scene) {
  return scene.find_first_of("./") == std::string::npos;
}

void case_keys(Keys& keys, Benchmark& benchmark) {
  keys.text({"title", "-", "of the case", {}, required}, benchmark.title);
  keys.text({"source", "-", "who measured it, and where it is published", {}, required},
            benchmark.source);
  keys.text({"about",
             "-",
             "what was measured, where the parameters come from, what the band means",
             {},
             required},
            benchmark.about);
  keys.text({"scene", "-", "a file beside this one, or a scene that the program holds"},
            benchmark.scene);
  keys.text_list({"test", "-", "or point tests beside this file"}, benchmark.tests);
  TomlReader* const reader = keys.reader();
  if (reader != nullptr && benchmark.scene.empty() == benchmark.tests.empty())
    reader->report("", "[case] needs either scene, a scene, or test, one or several point tests");
  keys.number_list(
      Key{"cells", "m",
          "cell sizes h, coarse to fine; three of them, each half the one before, "
          "give an extrapolated value",
          positive, required}
          .only_if(benchmark.is_scene(), "cells belong to a scene; a point test has none"),
      benchmark.cells);
  if (reader == nullptr || !benchmark.is_scene()) return;
  if (!reader->has("cells")) reader->report("cells", "[case] needs cells, a list of sizes h (m)");
  if (!std::is_sorted(benchmark.cells.rbegin(), benchmark.cells.rend(), std::less_equal<>()))
    reader->report("cells", "case.cells must go from coarse to fine, each smaller than the last");
}

void benchmark_law_keys(Keys& keys, BenchmarkLaw& law) {
  keys.word({"column", "-", "of the page", {}, required}, benchmark_columns, law.column);
  keys.text_list({"set", "-", "overrides of the scene or test, as in [\"step.courant=0.4\"]"},
                 law.set);
  keys.text({"parameters", "-", "where they are from"}, law.parameters);
  if (keys.reader() != nullptr) keys.reader()->leave_out(beside_law);
  law_keys(keys, law.law);
}

/// A number, or "start".
void over_key(Keys& keys, const Key& key, BenchmarkFigure& figure) {
  KeyInfo any, number, start;
  any.kind = ValueKind::any_of;
  start.kind = ValueKind::word;
  start.words = {"start"};
  any.below = {number, start};
  keys.value(
      key,
      [&](TomlReader& table) {
        if (const toml::node* given = table.get("over"); given != nullptr && given->is_string()) {
          table.choice("over", {"start"}, 0);
          figure.over_start = true;
        } else {
          figure.over = table.number({"over", "-", key.doc, {}, 1.0});
        }
      },
      [&] { return figure.over_start ? "\"start\"" : fmt::format("{}", figure.over); }, any);
}

void number_keys(Keys& keys, BenchmarkFigure& figure) {
  constexpr std::string_view only = "only a figure with value, a number, has this key";
  const bool is = !figure.value.empty();
  keys.choice(Key{"take", "-", "of a column's values, which"}.only_if(is, only),
              benchmark_take_names, figure.take);
  keys.number(
      Key{"depth_m", "m", "of front_at_m, the least that counts", positive, required}.only_if(
          figure.value == front_at, "only value = \"front_at_m\" has a depth_m"),
      figure.depth);
  keys.number(Key{"minus", "-", "subtracted from the value, SI"}.only_if(is, only), figure.minus);
  over_key(
      keys,
      Key{"over", "-", "divides what is left, SI; or \"start\": the first value of the same column"}
          .only_if(is, only),
      figure);
  keys.number(Key{"measured", "-", "what was measured, in the figure's unit", {}, required}.only_if(
                  is, only),
              figure.measured);
  if (keys.reader() != nullptr && is && figure.over == 0.0)
    keys.reader()->report("over", "over divides: it must not be 0");
}

void curve_keys(Keys& keys, BenchmarkFigure& figure) {
  constexpr std::string_view only = "only a figure with curve has this key";
  const bool is = figure.is_curve();
  keys.text(Key{"x", "-", "column of the curve and of the table", {}, required}.only_if(is, only),
            figure.x);
  keys.text(Key{"y", "-", "column of the curve and of the table", {}, required}.only_if(is, only),
            figure.y);
  keys.number(
      Key{"threshold", "m", "of rest_line: a point that has moved less rests", positive, required}
          .only_if(figure.curve == BenchmarkCurve::rest_line,
                   "only curve = \"rest_line\" has a threshold"),
      figure.threshold);
  keys.text(Key{"table", "-", "a CSV file beside this one", {}, required}.only_if(is, only),
            figure.table);
  keys.number(Key{"x_scale", "-", "factor of the table's x"}.only_if(is, only), figure.x_scale);
  keys.number(Key{"x_shift", "-", "added to it, SI"}.only_if(is, only), figure.x_shift);
  keys.number(Key{"y_scale", "-", "factor of the table's y"}.only_if(is, only), figure.y_scale);
  keys.number(Key{"y_shift", "-", "added to it, SI"}.only_if(is, only), figure.y_shift);
  keys.choice(Key{"measure", "-", "of the distance", {}, required}.only_if(is, only),
              benchmark_measure_names, figure.measure);
  describe_table_keys(keys);
}

void figure_keys(Keys& keys, BenchmarkFigure& figure) {
  keys.text({"name", "-", "of the figure", {}, required}, figure.name);
  keys.text({"title", "-", "in words", {}, required}, figure.title);
  keys.text({"unit", "-", "of the figure, for the reader"}, figure.unit);
  keys.text({"value", "-",
             "a number: a column of series.csv or curve.csv at its end, a key of summary.json, or "
             "front_at_m, where the profile is first less deep than depth_m"},
            figure.value);
  keys.choice({"curve", "-", "or a curve, whose distance from a table is the figure"},
              benchmark_curve_names, figure.curve);
  keys.text({"test", "-", "of several point tests, which"}, figure.test);
  keys.integer({"stage", "-", "of a point test, the only one that counts"}, {1, 20'000},
               figure.stage);
  number_keys(keys, figure);
  curve_keys(keys, figure);
  keys.pair({"band",
             "-",
             "lower and upper end of what counts as right, in the figure's unit",
             {},
             required},
            figure.band);
  keys.text({"band_from", "-", "where the band is from", {}, required}, figure.band_from);
}

/// The curve's columns that can be told before anything has run; a run has those of series.csv.
std::vector<std::string_view> known_columns(BenchmarkCurve curve, bool of_x) {
  switch (curve) {
    case BenchmarkCurve::profile:
    case BenchmarkCurve::rest_line:
      return {of_x ? "x_m" : "depth_m"};
    case BenchmarkCurve::column:
      if (of_x) return {"y_m"};
      return {column_fields.begin(), column_fields.end()};
    case BenchmarkCurve::point: {
      std::vector<std::string_view> names;
      for (std::size_t k = 0; k < point::quantity_count; ++k)
        names.push_back(point::column_name(static_cast<point::Quantity>(k)));
      return names;
    }
    case BenchmarkCurve::series:
      break;
  }
  return {};
}

void check_column(TomlReader& reader, BenchmarkCurve curve, bool of_x, const std::string& name) {
  const std::vector<std::string_view> known = known_columns(curve, of_x);
  if (name.empty() || known.empty() || std::find(known.begin(), known.end(), name) != known.end())
    return;
  const std::string near = closest(name, known);
  reader.report(of_x ? "x" : "y",
                fmt::format("a curve of kind {} has no '{}': {}{}",
                            benchmark_curve_names[static_cast<std::size_t>(curve)], name,
                            fmt::join(known, ", "),
                            near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
}

void read_figure_table(TomlReader& reader, BenchmarkFigure& figure) {
  if (figure.table.empty() || !is_there(reader, "table", figure.table)) {
    for (const char* const key : {"columns", "where", "rows", "separator", "decimal", "header_row"})
      reader.expect(key);
    return;
  }
  MeasuredColumns measured(reader, "table", figure.table);
  const auto x = measured.read(figure.x, "x"), y = measured.read(figure.y, "y");
  measured.finish();
  if (!x || !y) return;
  for (std::size_t i = 0; i < x->values.size(); ++i) {
    const auto row = std::lower_bound(y->file_rows.begin(), y->file_rows.end(), x->file_rows[i]);
    if (row == y->file_rows.end() || *row != x->file_rows[i]) continue;
    const auto k = static_cast<std::size_t>(row - y->file_rows.begin());
    figure.table_x.push_back(figure.x_scale * x->values[i] + figure.x_shift);
    figure.table_y.push_back(figure.y_scale * y->values[k] + figure.y_shift);
  }
  if (figure.table_x.empty())
    reader.report("table",
                  fmt::format("{}: no row has both {} and {}", figure.table, figure.x, figure.y));
}

/// What no single key can tell.
void check_figure(TomlReader& reader, BenchmarkFigure& figure, const Benchmark& benchmark) {
  if (figure.value.empty() == !figure.is_curve()) {
    reader.report("", fmt::format("figure '{}' needs either value, a number, or curve, with a "
                                  "table to compare with",
                                  figure.name));
    return;
  }
  if (figure.band[0] > figure.band[1])
    reader.report("band", fmt::format("band = [{}, {}]: the lower end comes first", figure.band[0],
                                      figure.band[1]));
  const auto& tests = benchmark.tests;
  if (!figure.test.empty() && std::find(tests.begin(), tests.end(), figure.test) == tests.end())
    reader.report("test", fmt::format("'{}' is none of the tests of [case]: {}", figure.test,
                                      fmt::join(tests, ", ")));
  if (figure.stage && benchmark.is_scene())
    reader.report("stage", "a stage is of a point test, and this case is a scene");
  if (!figure.is_curve()) return;
  if ((figure.curve == BenchmarkCurve::point) == benchmark.is_scene())
    reader.report("curve", benchmark.is_scene()
                               ? "a scene has no curve of a point test: profile, series, "
                                 "rest_line or column"
                               : "a point test has one curve: curve = \"point\"");
  check_column(reader, *figure.curve, true, figure.x);
  check_column(reader, *figure.curve, false, figure.y);
  read_figure_table(reader, figure);
}

void absent_keys(Keys& keys, std::map<std::string, std::string>& absent) {
  for (const std::string_view column : benchmark_columns) {
    std::string reason;
    if (const auto known = absent.find(std::string(column)); known != absent.end())
      reason = known->second;
    keys.text({column, "-", "why the case has no law of this column"}, reason);
    if (!reason.empty()) absent[std::string(column)] = reason;
  }
}

/// Every column has a law or a reason, and not both.
void check_columns(InputFile& file, const Benchmark& benchmark) {
  if (!file.ok()) return;  // which columns there are is not known then
  for (std::size_t k = 0; k < benchmark_columns.size(); ++k) {
    const std::string column(benchmark_columns[k]);
    const bool absent = benchmark.absent.contains(column), present = benchmark.law_of(k) != nullptr;
    if (present && absent)
      file.report("absent." + column, column + " is a [[law]] and absent as well");
    if (!present && !absent)
      file.report("absent", fmt::format("column {} is neither a [[law]] nor in [absent], which "
                                        "says why there is none",
                                        column));
  }
}

/// What a case is run with, checked with every law and cell size before anything runs.
class Inputs {
 public:
  Inputs(InputFile& file, Benchmark& benchmark, std::span<const std::string> overrides)
      : file_(file),
        benchmark_(benchmark),
        overrides_(overrides) {}

  void read() {
    TomlReader root(file_);
    TomlReader about = root.table("case");
    if (benchmark_.is_scene()) {
      const std::string& scene = benchmark_.scene;
      if (!is_shipped_name(scene) && !is_there(about, "scene", scene)) return;
    }
    for (const std::string& test : benchmark_.tests)
      if (!is_there(about, "test", test)) return;
    for (std::size_t i = 0; i < benchmark_.laws.size(); ++i) {
      BenchmarkLaw& law = benchmark_.laws[i];
      const std::string key = fmt::format("law[{}]", i);
      if (benchmark_.is_scene())
        read_scenes(law, key, i);
      else
        read_tests(law, key, i);
    }
  }

 private:
  /// The law as an override takes it.
  std::string law_text(std::size_t i) const {
    toml::table law = *(*file_.root()["law"].as_array())[i].as_table();
    for (const std::string_view key : beside_law) law.erase(key);
    return value_text(law);
  }
  std::vector<std::string> overrides_of(const BenchmarkLaw& law,
                                        std::vector<std::string> of_law) const {
    of_law.insert(of_law.end(), law.set.begin(), law.set.end());
    of_law.insert(of_law.end(), overrides_.begin(), overrides_.end());
    return of_law;
  }
  /// Problems of another file stand where this one names it.
  template <class Read>
  void attempt(const std::string& key, const std::string& what, const Read& read) {
    try {
      read();
    } catch (const BadInput& error) {
      for (const std::string& problem : error.problems())
        file_.report(key, fmt::format("{}: {}", what, problem));
    }
  }

  void read_scenes(BenchmarkLaw& law, const std::string& key, std::size_t i) {
    const std::string& name = benchmark_.scene;
    const std::string path = is_shipped_name(name) ? name : beside(file_, name).string();
    const std::string_view column = benchmark_columns[law.column];
    for (const double h : benchmark_.cells)
      attempt(key, fmt::format("{} with cells of {:.4g} m", column, h), [&] {
        const InputFile scene = open_scene(path);
        const toml::array* bodies = scene.root()["body"].as_array();
        std::vector<std::string> sets;
        for (std::size_t body = 0; bodies != nullptr && body < bodies->size(); ++body)
          sets.push_back(fmt::format("body[{}].law={}", body, law_text(i)));
        sets = overrides_of(law, std::move(sets));
        sets.push_back(fmt::format("grid.h={}", h));
        InputFile with_law = scene.with(sets);
        SceneFile read = read_scene(with_law);
        read.scene.name = fmt::format("{}_h{:.4g}", column, h);
        law.scenes.push_back(std::move(read));
      });
  }
  void read_tests(BenchmarkLaw& law, const std::string& key, std::size_t i) {
    const std::string_view column = benchmark_columns[law.column];
    for (const std::string& name : benchmark_.tests)
      attempt(key, fmt::format("{} in {}", column, name), [&] {
        const std::vector<std::string> sets =
            overrides_of(law, {fmt::format("law={}", law_text(i))});
        InputFile test = InputFile::read(beside(file_, name), sets);
        law.tests.push_back(read_point_test(test));
        law.tests.back().name = fmt::format("{}_{}", column, fs::path(name).stem().string());
      });
  }

  InputFile& file_;
  Benchmark& benchmark_;
  std::span<const std::string> overrides_;
};

void refuse_twins(InputFile& file, const Benchmark& benchmark) {
  std::set<std::size_t> columns;
  for (std::size_t i = 0; i < benchmark.laws.size(); ++i)
    if (!columns.insert(benchmark.laws[i].column).second)
      file.report(fmt::format("law[{}].column", i),
                  fmt::format("there are two laws of column {}",
                              benchmark_columns[benchmark.laws[i].column]));
  std::set<std::string> names;
  for (std::size_t i = 0; i < benchmark.figures.size(); ++i)
    if (!names.insert(benchmark.figures[i].name).second)
      file.report(fmt::format("figure[{}].name", i),
                  fmt::format("there are two figures called '{}'", benchmark.figures[i].name));
}

}  // namespace

std::size_t benchmark_column(std::string_view name) {
  const auto found = std::find(benchmark_columns.begin(), benchmark_columns.end(), name);
  if (found != benchmark_columns.end())
    return static_cast<std::size_t>(found - benchmark_columns.begin());
  const std::string near = closest(name, {benchmark_columns.begin(), benchmark_columns.end()});
  throw BadInput({fmt::format("there is no column '{}' of laws: {}{}", name,
                              fmt::join(benchmark_columns, ", "),
                              near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
}

const BenchmarkLaw* Benchmark::law_of(std::size_t column) const {
  for (const BenchmarkLaw& law : laws)
    if (law.column == column) return &law;
  return nullptr;
}

std::size_t Benchmark::test_of(const BenchmarkFigure& figure) const {
  const auto found = std::find(tests.begin(), tests.end(), figure.test);
  return found == tests.end() ? 0 : static_cast<std::size_t>(found - tests.begin());
}

void benchmark_keys(Keys& keys, Benchmark& benchmark) {
  keys.table({"case", "-", "what was measured", {}, required},
             [&](Keys& below) { case_keys(below, benchmark); });
  keys.tables(
      {"law", "-", "a law, and the column it stands in", {}, required}, benchmark.laws.size(),
      [&](std::size_t count) { benchmark.laws.resize(count); },
      [&](Keys& below, std::size_t i) { benchmark_law_keys(below, benchmark.laws[i]); });
  keys.table({"absent", "-", "columns without a law"},
             [&](Keys& below) { absent_keys(below, benchmark.absent); });
  keys.tables(
      {"figure", "-", "a figure that was measured", {}, required}, benchmark.figures.size(),
      [&](std::size_t count) { benchmark.figures.resize(count); },
      [&](Keys& below, std::size_t i) {
        BenchmarkFigure& figure = benchmark.figures[i];
        figure_keys(below, figure);
        if (TomlReader* const reader = below.reader()) {
          figure.origin = reader->file().origin(reader->path());
          check_figure(*reader, figure, benchmark);
        }
      });
}

Benchmark read_benchmark(InputFile& file, std::span<const std::string> overrides) {
  Benchmark benchmark;
  benchmark.name = fs::absolute(file.name()).lexically_normal().parent_path().filename().string();
  ReadKeys keys{TomlReader(file)};
  benchmark_keys(keys, benchmark);
  check_columns(file, benchmark);
  refuse_twins(file, benchmark);
  if (file.ok()) Inputs(file, benchmark, overrides).read();
  file.throw_if_bad();
  return benchmark;
}

}  // namespace repose::input
