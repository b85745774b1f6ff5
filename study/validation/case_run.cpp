#include "study/validation/case_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/interrupt.hpp"
#include "study/accuracy/sweep.hpp"
#include "study/run/run_record.hpp"
#include "study/validation/figure_values.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;
using input::BenchmarkFigure;
using input::BenchmarkLaw;

void fail(LawResult& law, const std::string& reason) {
  for (FigureResult& figure : law.figures) {
    figure.verdict = Verdict::failed;
    figure.reason = reason;
  }
}

/// The figures that every run of the law has a value of, judged. estimate: what the values tend to.
template <class Estimate>
void judge_figures(const CaseResult& result, LawResult& law, std::string_view without_bar,
                   const Estimate& estimate) {
  for (std::size_t i = 0; i < law.figures.size(); ++i) {
    FigureResult& figure = law.figures[i];
    const BenchmarkFigure& asked = result.benchmark.figures[i];
    if (figure.verdict == Verdict::failed) continue;
    figure.estimated = estimate(figure.values);
    // what is extrapolated from distances may come to less than none
    if (asked.is_curve()) figure.estimated.value = std::max(0.0, figure.estimated.value);
    figure.verdict = judge(figure.estimated, asked.band, asked.is_curve() ? 0.0 : -HUGE_VAL);
    if (figure.verdict == Verdict::failed)
      figure.reason = "the value is not finite";
    else if (!std::isfinite(figure.estimated.error))
      figure.reason = without_bar;
  }
}

/// Adds a run's value of every figure; `value` gives it, and the curve where it is one.
template <class Value>
void take_values(const CaseResult& result, LawResult& law, const std::string& what,
                 const Value& value) {
  for (std::size_t i = 0; i < law.figures.size(); ++i) {
    FigureResult& figure = law.figures[i];
    if (figure.verdict == Verdict::failed) continue;
    try {
      figure.values.push_back(value(result.benchmark.figures[i], figure.curve));
    } catch (const NoFigure& error) {
      figure.verdict = Verdict::failed;
      figure.reason = fmt::format("{}: {}", what, error.what());
    }
  }
}

/// The runs of one law of a scene. A frame is written at the start and at the end where a figure is
/// read off points.
io::ExitCode run_scenes(const CaseResult& result, const BenchmarkLaw& given, LawResult& law,
                        const fs::path& runs, const ValidationOptions& options) {
  const input::Benchmark& benchmark = result.benchmark;
  const bool of_points = std::any_of(benchmark.figures.begin(), benchmark.figures.end(),
                                     [](const BenchmarkFigure& figure) {
                                       return figure.curve == input::BenchmarkCurve::rest_line ||
                                              figure.curve == input::BenchmarkCurve::column;
                                     });
  const std::size_t sizes = options.coarse ? 1 : benchmark.cells.size();
  for (std::size_t k = 0; k < sizes; ++k) {
    const std::string what = fmt::format("cells of {:.4g} m", benchmark.cells[k]);
    SweepRun run{given.scenes[k], {}, {}, {}, {}, {}};
    run.file.scene.frame_interval = of_points ? run.scene().end_time : 0.0;
    try {
      const io::ExitCode code = carry_out(run, runs, options.threads, options.resume);
      if (code == io::ExitCode::interrupted) return code;
    } catch (const InputError& error) {
      fail(law, fmt::format("{}: {}", what, error.what()));
      return io::ExitCode::done;
    }
    law.cpu_s += run.figure("cpu_s");
    if (!run.done()) {
      fail(law, fmt::format("{}: {}", what, run.summary.reason));
      return io::ExitCode::done;
    }
    take_values(result, law, what, [&](const BenchmarkFigure& figure, PlainCurve& curve) {
      return scene_value(figure, run, runs / run.scene().name, curve);
    });
  }
  judge_figures(result, law,
                options.coarse ? "coarsest cells alone: no error bar" : "one size: no error bar",
                [&](const std::vector<double>& values) {
                  return estimate_of_sizes(benchmark.cells, values);
                });
  return io::ExitCode::done;
}

/// The tests of one law, each as it is and refined.
io::ExitCode run_tests(const CaseResult& result, const BenchmarkLaw& given, LawResult& law,
                       const fs::path& runs, const ValidationOptions& options) {
  for (const bool refine : {false, true}) {
    if (refine && options.coarse) break;
    std::vector<TestResult> results;
    for (const input::PointTestFile& test : given.tests) {
      const double before = usage().cpu_s;
      results.push_back(drive(refine ? refined(test) : test));
      law.cpu_s += usage().cpu_s - before;
      if (!refine && !results.back().curve.rows.empty())
        io::ResultFolder(runs / test.name)
            .write_file("curve.csv", curve_csv(test, results.back()), io::Outlives::kill);
    }
    take_values(result, law, refine ? "refined" : "as it is",
                [&](const BenchmarkFigure& figure, PlainCurve& curve) {
                  const std::size_t k = result.benchmark.test_of(figure);
                  return test_value(figure, given.tests[k], results[k], curve);
                });
  }
  judge_figures(result, law, "not refined: no error bar", [](const std::vector<double>& values) {
    return values.size() < 2 ? Estimated{values.front()}
                             : Estimated{values.front(), std::abs(values.front() - values.back())};
  });
  return io::ExitCode::done;
}

}  // namespace

std::size_t LawResult::count(Verdict verdict) const {
  return static_cast<std::size_t>(
      std::count_if(figures.begin(), figures.end(),
                    [&](const FigureResult& figure) { return figure.verdict == verdict; }));
}

CaseResult::CaseResult(input::Benchmark the_case, const ValidationOptions& options)
    : benchmark(std::move(the_case)) {
  for (std::size_t column = 0; column < laws.size(); ++column) {
    laws[column].figures.resize(benchmark.figures.size());
    const auto absent = benchmark.absent.find(std::string(input::benchmark_columns[column]));
    const bool asked =
        options.columns.empty() ||
        std::find(options.columns.begin(), options.columns.end(), column) != options.columns.end();
    for (FigureResult& figure : laws[column].figures) {
      if (absent != benchmark.absent.end()) {
        figure.verdict = Verdict::absent;
        figure.reason = absent->second;
      } else if (!asked) {
        figure.reason = "this law was not asked for";
      }
    }
  }
}

std::vector<std::string> CaseResult::sizes() const {
  if (!benchmark.is_scene()) return {"as_it_is", "refined"};
  std::vector<std::string> names;
  for (const double h : benchmark.cells) names.push_back(fmt::format("h_{:.4g}_m", h));
  return names;
}

std::size_t CaseResult::count(Verdict verdict) const {
  std::size_t sum = 0;
  for (const LawResult& law : laws) sum += law.count(verdict);
  return sum;
}

double CaseResult::cpu_s() const {
  double sum = 0.0;
  for (const LawResult& law : laws) sum += law.cpu_s;
  return sum;
}

io::ExitCode run_case(CaseResult& result, const fs::path& folder, const ValidationOptions& options,
                      const std::function<void(std::size_t column)>& told) {
  const io::InterruptGuard interrupt;
  for (std::size_t column = 0; column < result.laws.size(); ++column) {
    const BenchmarkLaw* const given = result.benchmark.law_of(column);
    LawResult& law = result.laws[column];
    const bool asked =
        options.columns.empty() ||
        std::find(options.columns.begin(), options.columns.end(), column) != options.columns.end();
    if (given == nullptr || !asked) continue;
    if (interrupt.requested()) return io::ExitCode::interrupted;
    LawResult done = law;
    const io::ExitCode code = result.benchmark.is_scene()
                                  ? run_scenes(result, *given, done, folder / "runs", options)
                                  : run_tests(result, *given, done, folder / "runs", options);
    if (code == io::ExitCode::interrupted) return code;
    law = std::move(done);
    told(column);
  }
  return io::ExitCode::done;
}

}  // namespace repose::study
