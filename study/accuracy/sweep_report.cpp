#include "study/accuracy/sweep_report.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "io/json.hpp"
#include "study/run/run_record.hpp"

namespace repose::study {
namespace {

using Json = io::Json;

/// Figures of summary.json that chart.csv passes on under their own names.
constexpr std::array<std::string_view, 17> copied{"points",
                                                  "steps",
                                                  "dt_min_s",
                                                  "dt_max_s",
                                                  "front_m",
                                                  "front_99_m",
                                                  "front_max_m",
                                                  "height_m",
                                                  "kinetic_J_per_m",
                                                  "peak_kinetic_J_per_m",
                                                  "angular_momentum",
                                                  "transfer_loss_J_per_m",
                                                  "wall_loss_J_per_m",
                                                  "energy_residual_J_per_m",
                                                  "energy_error",
                                                  "cpu_s",
                                                  "threads"};

/// Names of the plane as the runs' dimensions have them.
std::vector<std::string> in_dimensions(std::span<const std::string_view> names,
                                       std::span<const SweepRun> runs) {
  const std::size_t dimensions = runs.empty() ? 2 : runs.front().scene().dimensions();
  std::vector<std::string> all;
  for (const std::string_view name : names) all.push_back(named(name, dimensions));
  return all;
}

/// A cell of a table: empty where there is no number.
std::string cell(double x) { return std::isfinite(x) ? fmt::format("{:.10g}", x) : ""; }

/// A value of Sweep::vary as a cell; lists and tables have commas.
std::string quoted(const std::string& value) {
  std::string text;
  for (const char c : value) text += c == '"' ? std::string() : std::string(1, c);
  return text.find(',') == std::string::npos ? text : fmt::format("\"{}\"", text);
}

/// transfer,kernel,points_per_cell,h_m,courant,dt_s and the keys of Sweep::vary: which run a row
/// belongs to.
std::string key_cells(const SweepRun& run) {
  const mpm::Scene& scene = run.scene();
  std::string text =
      fmt::format("{},{},{},{},{},{}", mpm::name_of(scene.transfer), mpm::name_of(scene.kernel),
                  scene.points_per_cell, scene.h, scene.dt ? "" : cell(scene.courant),
                  scene.dt ? cell(*scene.dt) : "");
  for (const auto& [key, value] : run.varied) text += "," + quoted(value);
  return text;
}
std::string key_columns(std::span<const SweepRun> runs) {
  std::string text = "transfer,kernel,points_per_cell,h_m,courant,dt_s";
  if (!runs.empty())
    for (const auto& [key, value] : runs.front().varied) text += "," + key;
  return text;
}

Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json to_json(const std::optional<SweepChange>& change) {
  if (!change) return nullptr;
  return {{"front", change->front},
          {"front_99", change->front_99},
          {"height", change->height},
          {"profile_mean", change->profile_mean},
          {"profile_max", change->profile_max}};
}

bool within(const SweepChange& change, double limit) {
  return std::abs(change.front) < limit && std::abs(change.height) < limit &&
         change.profile_max < limit;
}

}  // namespace

std::string sweep_csv(std::span<const SweepRun> runs) {
  std::string text = fmt::format(
      "{},status,mean_dt_s,{},point_steps_per_cpu_s,bytes_per_point,front_change,front_99_change,"
      "height_change,"
      "profile_change_mean,profile_change_max\n",
      key_columns(runs), fmt::join(in_dimensions(copied, runs), ","));
  for (const SweepSeries& series : series_of(runs)) {
    const SweepRun* finest = series.finest();
    for (const SweepRun* run : series.runs) {
      if (run->status().empty()) continue;
      text += fmt::format("{},{},{}", key_cells(*run), run->status(), cell(run->mean_dt()));
      for (const std::string_view key : copied) text += "," + cell(run->figure(key));
      text += "," + cell(run->point_steps_per_cpu_s()) + "," + cell(run->bytes_per_point());
      const auto change = finest == nullptr ? std::nullopt : change_between(*run, *finest);
      text += change ? fmt::format(",{},{},{},{},{}\n", cell(change->front), cell(change->front_99),
                                   cell(change->height), cell(change->profile_mean),
                                   cell(change->profile_max))
                     : ",,,,,\n";
    }
  }
  return text;
}

std::string history_csv(std::span<const SweepRun> runs) {
  constexpr std::array<std::string_view, 10> columns{"time_s",
                                                     "front_m",
                                                     "front_99_m",
                                                     "front_max_m",
                                                     "height_m",
                                                     "kinetic_J_per_m",
                                                     "momentum_x",
                                                     "angular_momentum",
                                                     "transfer_loss_J_per_m",
                                                     "energy_residual_J_per_m"};
  std::string text =
      fmt::format("{},{}\n", key_columns(runs), fmt::join(in_dimensions(columns, runs), ","));
  for (const SweepRun& run : runs) {
    for (std::size_t i = 0; i < run.column("time_s").size(); ++i) {
      text += key_cells(run);
      for (const std::string_view name : columns) {
        const std::vector<double>& column = run.column(name);
        text += "," + (i < column.size() ? cell(column[i]) : std::string());
      }
      text += "\n";
    }
  }
  return text;
}

Json sweep_answer(const std::vector<SweepSeries>& series) {
  Json answer = Json::array();
  for (const SweepSeries& s : series) {
    const std::vector<const SweepRun*> runs = s.done_runs();
    Json line{{"name", s.name()},
              {"transfer", mpm::name_of(s.scene().transfer)},
              {"kernel", mpm::name_of(s.scene().kernel)},
              {"points_per_cell", s.scene().points_per_cell},
              {"h_m", s.scene().h},
              {"runs", s.runs.size()},
              {"done", runs.size()}};
    const auto both = [&](std::string_view name, auto&& figure) {
      line[named(name, s.scene().dimensions())] = {finite_or_null(figure(*runs.front())),
                                                   finite_or_null(figure(*runs.back()))};
    };
    if (!runs.empty()) {
      both("mean_dt_s", [](const SweepRun& r) { return r.mean_dt(); });
      for (const char* key : {"front_m", "front_99_m", "height_m", "kinetic_J_per_m",
                              "transfer_loss_J_per_m", "cpu_s"})
        both(key, [&](const SweepRun& r) { return r.figure(key); });
      line["change"] = to_json(change_between(*runs.front(), *runs.back()));
      const auto quartered = change_when_quartered(s);
      line["change_when_quartered"] = to_json(quartered);
      line["independent_of_step"] =
          quartered ? Json(within(*quartered, allowed_change)) : Json(nullptr);
    }
    answer.push_back(line);
  }
  return answer;
}

std::string answer_text(const Json& answer) {
  const auto number = [](const Json& x) { return x.is_number() ? x.get<double>() : std::nan(""); };
  const auto pair = [&](const Json& line, const char* key, double scale, const char* format) {
    return fmt::format("{} -> {}", fmt::format(fmt::runtime(format), scale * number(line[key][0])),
                       fmt::format(fmt::runtime(format), scale * number(line[key][1])));
  };
  const bool in_space = !answer.empty() && answer[0].contains("kinetic_J");
  std::string text =
      fmt::format("{:<22} {:<9} {:>7}  {:<14} {:<16} {:<16} {:<16} {:<18} {:<14} {}\n", "transfer",
                  "kernel", "h (mm)", "step (µs)", "front (m)", "99 % front (m)", "height (m)",
                  in_space ? "kinetic (J)" : "kinetic (J/m)", "CPU (s)",
                  "step/4: front, 99 %, height, profile");
  for (const Json& line : answer) {
    text += fmt::format("{:<22} {:<9} {:>7.4g}  ", line["name"].get<std::string>(),
                        line["kernel"].get<std::string>(), 1e3 * line["h_m"].get<double>());
    if (!line.contains("front_m")) {
      text += "no run came to its end\n";
      continue;
    }
    text +=
        fmt::format("{:<14} {:<16} {:<16} {:<16} {:<18} {:<14} ",
                    pair(line, "mean_dt_s", 1e6, "{:.4g}"), pair(line, "front_m", 1.0, "{:.4f}"),
                    pair(line, "front_99_m", 1.0, "{:.4f}"), pair(line, "height_m", 1.0, "{:.4f}"),
                    pair(line, in_space ? "kinetic_J" : "kinetic_J_per_m", 1.0, "{:.2g}"),
                    pair(line, "cpu_s", 1.0, "{:.2g}"));
    const Json& change = line["change_when_quartered"];
    if (change.is_object())
      text += fmt::format("{:.2f}, {:.2f}, {:.2f}, {:.2f} %{}", 100.0 * number(change["front"]),
                          100.0 * number(change["front_99"]), 100.0 * number(change["height"]),
                          100.0 * number(change["profile_max"]),
                          line["independent_of_step"] == true ? "  independent" : "");
    if (line["done"] != line["runs"])
      text +=
          fmt::format("  ({} of {} runs failed)", line["runs"].get<int>() - line["done"].get<int>(),
                      line["runs"].get<int>());
    text += "\n";
  }
  return text;
}

std::string errors_csv(std::span<const SweepRun> runs, const SweepReference& reference) {
  std::string text = key_columns(runs) + ",cpu_s";
  std::array<std::vector<bool>, quantity_count> fronts;
  for (std::size_t q = 0; q < quantity_count; ++q) {
    text += fmt::format(",{0}_error,{0}_pareto", quantity_names[q]);
    fronts[q] = pareto_front(runs, static_cast<Quantity>(q), reference);
  }
  text += ",energy_error\n";
  const double bin = common_bin(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].done()) continue;
    text += key_cells(runs[i]) + "," + cell(runs[i].figure("cpu_s"));
    for (std::size_t q = 0; q < quantity_count; ++q) {
      const double error = error_of(runs[i], static_cast<Quantity>(q), reference, bin);
      text += fmt::format(",{},{}", cell(error),
                          std::isfinite(error) ? (fronts[q][i] ? "1" : "0") : "");
    }
    text += "," + cell(runs[i].figure("energy_error")) + "\n";
  }
  return text;
}

std::string curve_csv(const Eigen::VectorXd& shares, Quantity q, const mpm::Scene& scene,
                      double bin) {
  const QuantityCurve curve = curve_of(shares, q, scene, bin);
  std::string text = fmt::format("{},{}\n", q == Quantity::profile ? "x_m" : "time_s",
                                 column_of(q, scene.dimensions()));
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    text += fmt::format("{:.10g},{:.10g}\n", curve.x[i], curve.y[i]);
  return text;
}

Json errors_answer(std::span<const SweepRun> runs, const SweepReference& reference) {
  const std::vector<SweepFamily> families = families_of(runs);
  const double bin = common_bin(runs);
  Json answer{{"from", reference.name(families)}};
  if (!reference.exact) {
    answer["cells_m"] = reference.cells;
    answer["steps"] = reference.steps;
  }
  for (std::size_t q = 0; q < quantity_count; ++q) {
    const auto& value = reference.values[q];
    if (!value) continue;
    Json& entry = answer["reference"][std::string(quantity_names[q])];
    entry = {{"error_bar", value->error}};
    if (!reference.exact) {
      entry["order_observed"] = finite_or_null(value->observed);
      entry["order_used"] = value->order;
    }
    if (!is_curve(static_cast<Quantity>(q))) entry["value"] = value->value[0];
  }
  Json& list = answer["families"] = Json::array();
  for (const SweepFamily& family : families) {
    if (family.cells().size() < 2) continue;
    for (std::size_t k = 0; k < quantity_count; ++k) {
      const auto q = static_cast<Quantity>(k);
      if (!reference.values[k]) continue;
      const auto levels = family.levels(q, bin);
      Json orders = Json::array(), errors = Json::array();
      for (const auto& level : levels)
        errors.push_back(relative_distance(level.mean(), reference.values[k]->value));
      if (reference.exact)  // two errors make an order, where the limit is known
        for (std::size_t i = 0; i + 1 < levels.size(); ++i)
          orders.push_back(
              finite_or_null(std::log(errors[i].get<double>() / errors[i + 1].get<double>()) /
                             std::log(levels[i].h / levels[i + 1].h)));
      else
        for (std::size_t i = 0; i + 2 < levels.size(); ++i)
          orders.push_back(finite_or_null(observed_order(levels[i], levels[i + 1], levels[i + 2])));
      const ShownErrors shown =
          reference.exact ? ShownErrors{} : shown_errors(family, q, reference, bin);
      list.push_back({{"family", family.name()},
                      {"law", family.scene().bodies.front().law.name},
                      {"kernel", mpm::name_of(family.scene().kernel)},
                      {"transfer", mpm::name_of(family.scene().transfer)},
                      {"points_per_cell", family.scene().points_per_cell},
                      {"quantity", quantity_names[k]},
                      {"cells_m", family.cells()},
                      {"errors", errors},
                      {"orders", orders},
                      {"bias", shown.bias},
                      {"motion", shown.motion},
                      {"irregularity", finite_or_null(shown.irregularity)},
                      {"scatter", shown.scatter}});
    }
  }
  return answer;
}

std::string errors_text(const Json& answer) {
  const auto numbers = [](const Json& list, double scale, const char* format) {
    std::string text;
    for (const Json& x : list)
      text += (text.empty() ? "" : ", ") +
              (x.is_number() ? fmt::format(fmt::runtime(format), scale * x.get<double>()) : "-");
    return text;
  };
  const bool extrapolated = answer.contains("cells_m");
  std::string text =
      extrapolated
          ? fmt::format("\nreference: {}, extrapolated from cells of {} mm, {} steps each\n",
                        answer["from"].get<std::string>(),
                        numbers(answer["cells_m"], 1e3, "{:.4g}"),
                        answer["steps"].get<std::size_t>())
          : fmt::format("\nreference: {}\n", answer["from"].get<std::string>());
  for (const auto& [name, entry] : answer["reference"].items()) {
    if (!extrapolated) continue;
    text +=
        fmt::format("  {:<9} {:<11} ± {:.2g} %   order {}\n", name,
                    entry.contains("value") ? fmt::format("{:.4f} m", entry["value"].get<double>())
                                            : std::string("a curve"),
                    100.0 * entry["error_bar"].get<double>(),
                    entry["order_observed"].is_number()
                        ? fmt::format("{:.2f}", entry["order_observed"].get<double>())
                        : std::string("not observed, 1 taken"));
  }
  text += fmt::format("{:<34} {:<9} {:<34} {}\n", "errors from it", "", "coarse to fine (%)",
                      "observed orders");
  for (const Json& line : answer["families"])
    text +=
        fmt::format("{:<34} {:<9} {:<34} {}\n", line["family"].get<std::string>(),
                    line["quantity"].get<std::string>(), numbers(line["errors"], 100.0, "{:.2g}"),
                    numbers(line["orders"], 1.0, "{:.2f}"));
  return text;
}

std::vector<std::pair<std::string, std::string>> outcome_tables(
    std::span<const SweepRun> runs, const std::optional<SweepReference>& reference) {
  std::vector<std::pair<std::string, std::string>> tables{{"history.csv", history_csv(runs)}};
  if (!reference) return tables;
  tables.emplace_back("errors.csv", errors_csv(runs, *reference));
  for (const Quantity q : {Quantity::profile, Quantity::kinetic, Quantity::momentum}) {
    const auto& value = reference->values[static_cast<std::size_t>(q)];
    if (value)
      tables.emplace_back(fmt::format("reference_{}.csv", name_of(q)),
                          curve_csv(value->value, q, runs.front().scene(), common_bin(runs)));
  }
  return tables;
}

std::vector<std::string> warnings_of(std::span<const SweepRun> runs) {
  std::vector<std::string> list;
  for (const SweepRun& run : runs) {
    if (run.status().empty()) continue;
    for (const std::string& warning : run.summary.warnings)
      list.push_back(fmt::format("{}: {}", run.scene().name, warning));
    if (run.status() == "failed")
      list.push_back(fmt::format("{}: failed: {}", run.scene().name, run.summary.reason));
  }
  return list;
}

}  // namespace repose::study
