#include "study/propagate/propagation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "input/read_law.hpp"
#include "io/atomic_file.hpp"
#include "io/fingerprint.hpp"
#include "io/number_text.hpp"
#include "io/raw_table.hpp"
#include "study/fit/journal.hpp"
#include "study/run/finished_result.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Json = io::Json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Json json_in(const fs::path& file) {
  const std::string text = text_of(file);
  try {
    return Json::parse(text);
  } catch (const std::exception&) {
    throw io::IoError(file, "is not what a fit writes there");
  }
}

/// The columns of these names, a row per line.
MatrixXd columns_in(const fs::path& file, const std::vector<std::string>& names) {
  const io::RawTable table = io::load_table(file);
  MatrixXd values(static_cast<Index>(table.rows()), static_cast<Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& headers = table.headers();
    const auto header = std::find_if(headers.begin(), headers.end(),
                                     [&](const auto& one) { return one.text == names[i]; });
    if (header == headers.end())
      throw io::IoError(file, fmt::format("has no column \"{}\"", names[i]));
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::string_view cell =
          table.cell(row, static_cast<std::size_t>(header - headers.begin()));
      double& x = values(static_cast<Index>(row), static_cast<Index>(i));
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
      if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(x))
        throw io::IoError(file,
                          fmt::format("row {}: \"{}\" is no number", table.file_row(row), cell));
    }
  }
  return values;
}

/// n of `count` places, evenly spaced, none twice.
std::vector<Index> spread(Index count, Index n) {
  std::vector<Index> places;
  for (Index k = 0; k < n; ++k) places.push_back((2 * k + 1) * count / (2 * n));
  return places;
}

/// The depth of a run at places, 0 beyond its table; NaN if it has none.
VectorXd depth_at(const fs::path& run, const std::vector<double>& x) {
  VectorXd depth = VectorXd::Constant(static_cast<Index>(x.size()), nan);
  const NumberTable profile = read_numbers(run / "profile.csv");
  const auto at = profile.find("x_m"), d = profile.find("depth_m");
  if (at == profile.end() || d == profile.end() || at->second.size() < 2) return depth;
  const std::vector<double>&xs = at->second, &ds = d->second;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto above = std::lower_bound(xs.begin(), xs.end(), x[i]);
    double& value = depth[static_cast<Index>(i)];
    if (above == xs.end()) {
      value = x[i] > xs.back() ? 0.0 : ds.back();
    } else if (above == xs.begin()) {
      value = ds.front();
    } else {
      const auto k = static_cast<std::size_t>(above - xs.begin());
      const double part = (x[i] - xs[k - 1]) / (xs[k] - xs[k - 1]);
      value = ds[k - 1] + part * (ds[k] - ds[k - 1]);
    }
  }
  return depth;
}

bool is_done(const SceneSweep& sweep, std::size_t run) {
  return sweep.cases()[run].summary.status == "done";
}

DepthBand depth_band(const PropagationPlan& plan, const SceneSweep& coarse_runs,
                     const SceneSweep& fine_runs, const fs::path& coarse, const fs::path& fine) {
  DepthBand band;
  const auto folder = [](const fs::path& runs, std::size_t run) {
    return runs / SceneSweep::folder_name(run + 1);
  };
  for (std::size_t run = 0; run < fine_runs.cases().size() && band.x.empty(); ++run) {
    if (!is_done(fine_runs, run)) continue;
    const NumberTable profile = read_numbers(folder(fine, run) / "profile.csv");
    if (profile.contains("z_m") || !profile.contains("depth_m")) return band;  // in space
    band.x = profile.find("x_m")->second;
  }
  const auto depths = [&](const SceneSweep& sweep, const fs::path& runs) {
    MatrixXd all = MatrixXd::Constant(static_cast<Index>(sweep.cases().size()),
                                      static_cast<Index>(band.x.size()), nan);
    for (std::size_t run = 0; run < sweep.cases().size(); ++run)
      if (is_done(sweep, run))
        all.row(static_cast<Index>(run)) = depth_at(folder(runs, run), band.x).transpose();
    return all;
  };
  const MatrixXd of_coarse = depths(coarse_runs, coarse), of_fine = depths(fine_runs, fine);
  for (Index i = 0; i < of_coarse.cols(); ++i) {
    const Propagated p = propagated(of_coarse.col(i), plan.fine, of_fine.col(i));
    // what is added to depths of nothing may be less than nothing
    band.lower.push_back(std::max(0.0, p.interval_90[0]));
    band.median.push_back(std::max(0.0, p.median));
    band.upper.push_back(std::max(0.0, p.interval_90[1]));
  }
  return band;
}

/// Each run had a core to itself; cpu_s is that of all that go on side by side.
double seconds_of(const SceneSweep& sweep) {
  double seconds = 0.0;
  for (const SceneCase& one : sweep.cases())
    if (const auto wall = one.summary.figures.find("wall_s"); wall != one.summary.figures.end())
      seconds += wall->second;
  return seconds;
}

/// What a cell of zero width would still move, by Richardson with an error in proportion to h: the
/// change from coarse to fine is (coarsen − 1) times it.
double left_to_move(const PropagationPlan& plan, const Propagated& p) {
  return p.change / (plan.asked.coarsen - 1.0);
}

std::string propagation_csv(const PropagationPlan& plan, const PropagationResult& result) {
  std::string text =
      "output,mean,standard_error_of_mean,sd,p5,p50,p95,coarse_mean,change_of_mean,left_to_move,"
      "correlation,draws,pairs\n";
  for (std::size_t k = 0; k < result.outputs.size(); ++k) {
    const Propagated& p = result.outputs[k];
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", plan.asked.outputs[k], p.mean,
                        p.standard_error, p.deviation, p.interval_90[0], p.median, p.interval_90[1],
                        p.coarse_mean, p.change, left_to_move(plan, p), p.correlation, p.draws,
                        p.pairs);
  }
  return text;
}

std::string propagated_draws_csv(const FittedPosterior& posterior, const PropagationPlan& plan,
                                 const PropagationResult& result) {
  std::string text = "run,draw";
  for (const std::string& name : posterior.parameters) text += "," + io::csv_cell(name);
  for (const std::string& name : plan.asked.outputs)
    text += fmt::format(",{0}_coarse,{0}_fine", name);
  text += "\n";
  const auto cell = [](double x) { return std::isfinite(x) ? fmt::format(",{}", x) : ","; };
  for (std::size_t run = 0; run < plan.draws.size(); ++run) {
    text += fmt::format("{},{}", run + 1, plan.draws[run] + 1);
    for (Index i = 0; i < posterior.draws.cols(); ++i)
      text += cell(posterior.draws(plan.draws[run], i));
    const auto fine = std::find(plan.fine.begin(), plan.fine.end(), static_cast<Index>(run));
    for (Index k = 0; k < result.coarse.cols(); ++k) {
      text += cell(result.coarse(static_cast<Index>(run), k));
      text += fine == plan.fine.end() ? "," : cell(result.fine(fine - plan.fine.begin(), k));
    }
    text += "\n";
  }
  return text;
}

std::string depth_bands_csv(const PropagationResult& result) {
  const DepthBand& band = result.depth;
  std::string text = "x_m,depth_p5_m,depth_p50_m,depth_p95_m\n";
  for (std::size_t i = 0; i < band.x.size(); ++i)
    text += fmt::format("{},{},{},{}\n", band.x[i], band.lower[i], band.median[i], band.upper[i]);
  return text;
}

}  // namespace

FittedPosterior read_posterior(const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw input::BadInput({fmt::format("{}: no folder of a fit", folder.string())});
  if (!fs::exists(folder / "fit.json"))
    throw input::BadInput({fmt::format(
        "{}: no result of a fit (it has no fit.json); repose fit FIT.toml --posterior -o FOLDER "
        "makes one",
        folder.string())});
  if (!fs::exists(folder / "posterior.csv"))
    throw input::BadInput(
        {fmt::format("{0}: the fit has no posterior; repose fit {0}/input.toml --posterior -o {0} "
                     "--resume draws "
                     "it",
                     folder.string())});
  FittedPosterior p;
  const Json fit = json_in(folder / "fit.json"), report = json_in(folder / "posterior.json");
  input::InputFile fitted = input::InputFile::read(folder / "fitted.toml");
  p.law = input::read_law(input::TomlReader(fitted).table("law"));
  fitted.throw_if_bad();
  try {
    p.name = fit.at("name").get<std::string>();
    p.converged = report.at("status").get<std::string>() == "done";
    for (const Json::Member& one : fit.at("parameters").items())
      (p.law.values.contains(one.key) ? p.parameters : p.others).push_back(one.key);
  } catch (const std::exception&) {
    throw io::IoError(folder / "fit.json", "is not what a fit writes there");
  }
  const fs::path table = folder / "posterior.csv";
  p.draws = columns_in(table, p.parameters);
  p.fingerprint = io::fingerprint_of(text_of(table));
  if (p.parameters.empty())
    throw input::BadInput(
        {fmt::format("{}: no parameter of {} was free", folder.string(), p.law.name)});
  return p;
}

PropagationPlan plan_propagation(const FittedPosterior& posterior, const input::SceneFile& scene,
                                 PropagationOptions options) {
  PropagationPlan plan;
  std::vector<std::string> problems;
  if (options.fine < fewest_pairs)
    problems.push_back(fmt::format("--fine {}: at least {} runs with fine cells are needed",
                                   options.fine, fewest_pairs));
  if (options.fine > options.runs)
    problems.push_back(
        fmt::format("--fine {}: more than the {} draws of --runs", options.fine, options.runs));
  if (options.runs > posterior.draws.rows())
    problems.push_back(
        fmt::format("--runs {}: the posterior has {} draws", options.runs, posterior.draws.rows()));
  if (!(options.coarsen > 1.0) || !std::isfinite(options.coarsen))
    problems.push_back(fmt::format("--coarsen {}: must be more than 1", options.coarsen));
  std::vector<std::string> bodies;  // the keys of their laws
  std::string laws;
  const std::vector<mpm::Body>& all = scene.scene.bodies;
  for (std::size_t b = 0; b < all.size(); ++b) {
    laws += (laws.empty() ? "" : ", ") + all[b].law.name;
    if (all[b].law.name == posterior.law.name) bodies.push_back(fmt::format("body[{}].law", b));
  }
  if (bodies.empty())
    problems.push_back(fmt::format("no body of {} follows {}, the law of the fit {}; it has {}",
                                   scene.scene.name, posterior.law.name, posterior.name, laws));
  if (!problems.empty()) throw input::BadInput(problems);

  if (options.outputs.empty())
    options.outputs = scene.scene.terrain ? std::vector<std::string>{"runout_99_m", "reached_m2"}
                                          : std::vector<std::string>{"front_99_m", "height_m"};
  plan.asked = std::move(options);
  plan.h = scene.scene.h;
  plan.draws = spread(posterior.draws.rows(), plan.asked.runs);
  plan.fine = spread(plan.asked.runs, plan.asked.fine);
  input::ParameterSets& fine = plan.fine_sets;
  input::ParameterSets& coarse = plan.coarse_sets;
  for (const std::string& body : bodies)
    for (const std::string& name : posterior.parameters) fine.keys.push_back(body + "." + name);
  coarse.keys = fine.keys;
  coarse.keys.emplace_back("grid.h");
  const auto values_of = [&](Index draw) {
    std::vector<std::string> values;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (Index i = 0; i < posterior.draws.cols(); ++i)
        values.push_back(fmt::format("{}", posterior.draws(draw, i)));
    return values;
  };
  for (const Index draw : plan.draws) {
    coarse.values.push_back(values_of(draw));
    coarse.values.back().push_back(fmt::format("{}", plan.asked.coarsen * plan.h));
  }
  for (const Index place : plan.fine)
    fine.values.push_back(values_of(plan.draws[static_cast<std::size_t>(place)]));

  if (!posterior.converged)
    plan.warnings.emplace_back("the chains of the posterior have not converged");
  if (!posterior.others.empty())
    plan.warnings.push_back(
        fmt::format("{}: of the tests of the fit, not of the law; the scene's own "
                    "state stays",
                    fmt::join(posterior.others, ", ")));
  for (std::size_t b = 0; b < all.size(); ++b) {
    const LawSpec& law = all[b].law;
    if (law.name != posterior.law.name) continue;
    for (const auto& [key, value] : posterior.law.options)
      if (const auto there = law.options.find(key);
          there != law.options.end() && there->second != value)
        plan.warnings.push_back(fmt::format("{}: {} = \"{}\" in the scene, \"{}\" in the fit",
                                            all[b].name, key, there->second, value));
    for (const auto& [key, value] : posterior.law.values)
      if (const auto there = law.values.find(key);
          there != law.values.end() && there->second != value &&
          std::find(posterior.parameters.begin(), posterior.parameters.end(), key) ==
              posterior.parameters.end())
        plan.warnings.push_back(fmt::format("{}: {} = {:g} in the scene, {:g} in the fit",
                                            all[b].name, key, there->second, value));
  }
  return plan;
}

PropagationResult propagation(const PropagationPlan& plan, const SceneSweep& coarse_runs,
                              const SceneSweep& fine_runs, const fs::path& coarse,
                              const fs::path& fine) {
  PropagationResult result;
  result.coarse = outputs_of(coarse_runs, plan.asked.outputs, coarse);
  result.fine = outputs_of(fine_runs, plan.asked.outputs, fine);
  for (Index k = 0; k < result.coarse.cols(); ++k) {
    std::vector<double> values;
    result.outputs.push_back(
        propagated(result.coarse.col(k), plan.fine, result.fine.col(k), &values));
    result.values.push_back(std::move(values));
  }
  result.depth = depth_band(plan, coarse_runs, fine_runs, coarse, fine);
  result.coarse_s = seconds_of(coarse_runs);
  result.fine_s = seconds_of(fine_runs);
  return result;
}

Json propagation_json(const PropagationPlan& plan, const PropagationResult& result) {
  Json outputs;
  for (std::size_t k = 0; k < result.outputs.size(); ++k) {
    const Propagated& p = result.outputs[k];
    Json j;
    j["mean"] = number(p.mean);
    j["standard_error_of_mean"] = number(p.standard_error);
    j["sd"] = number(p.deviation);
    j["median"] = number(p.median);
    j["interval_90"] = {number(p.interval_90[0]), number(p.interval_90[1])};
    j["discretisation"] = {{"coarse_h_m", plan.asked.coarsen * plan.h},
                           {"fine_h_m", plan.h},
                           {"coarse_mean", number(p.coarse_mean)},
                           {"change_of_mean", number(p.change)},
                           {"left_to_move", number(left_to_move(plan, p))}};
    j["draws"] = p.draws;
    j["pairs"] = p.pairs;
    j["correlation"] = number(p.correlation);
    j["worth_fine_runs"] = number(p.worth);
    outputs[plan.asked.outputs[k]] = std::move(j);
  }
  return outputs;
}

void write_propagation(const io::ResultFolder& folder, const FittedPosterior& posterior,
                       const PropagationPlan& plan, const PropagationResult& result) {
  folder.write_file("propagation.json", propagation_json(plan, result).dump(2) + "\n");
  folder.write_file("propagation.csv", propagation_csv(plan, result));
  folder.write_file("draws.csv", propagated_draws_csv(posterior, plan, result));
  if (!result.depth.x.empty()) folder.write_file("depth_bands.csv", depth_bands_csv(result));
}

std::vector<std::string> propagation_words(const PropagationPlan& plan,
                                           const PropagationResult& result) {
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < result.outputs.size(); ++k) {
    const Propagated& p = result.outputs[k];
    const std::string& name = plan.asked.outputs[k];
    if (p.pairs < fewest_pairs) {
      lines.push_back(
          fmt::format("{}: not shown: {} draws have it with both cells, and {} are needed", name,
                      p.pairs, fewest_pairs));
      continue;
    }
    lines.push_back(fmt::format("{}: {:.4g}, 90 % of what the fit leaves open: {:.4g} to {:.4g}",
                                name, p.median, p.interval_90[0], p.interval_90[1]));
    const double left = left_to_move(plan, p), open = 0.5 * (p.interval_90[1] - p.interval_90[0]);
    lines.push_back(fmt::format(
        "  discretisation: cells of {:.4g} m moved the mean by {:+.2g} from those of {:.4g} m; an "
        "error in proportion to the cells leaves {:+.2g}{}",
        plan.h, p.change, plan.asked.coarsen * plan.h, left,
        std::abs(left) > open ? ", more than the fit leaves open: finer cells tell more" : ""));
    lines.push_back(
        fmt::format("  sampling: mean {:.5g} give or take {:.2g}, as from {:.0f} fine runs; coarse "
                    "and fine ones "
                    "correlate by {:.3f}",
                    p.mean, p.standard_error, p.worth, p.correlation));
  }
  lines.push_back(fmt::format("{} coarse runs took {:.0f} s of one core, {} fine ones {:.0f} s",
                              result.coarse.rows(), result.coarse_s, result.fine.rows(),
                              result.fine_s));
  return lines;
}

}  // namespace repose::study
