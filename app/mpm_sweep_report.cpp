#include "app/mpm_sweep_report.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

namespace repose::app {
namespace {

using Json = nlohmann::ordered_json;

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

/// A cell of a table: empty where there is no number.
std::string cell(double x) { return std::isfinite(x) ? fmt::format("{:.10g}", x) : ""; }

/// transfer,kernel,h_m,courant,dt_s: which run a row belongs to.
std::string key_cells(const mpm::Scene& scene) {
  return fmt::format("{},{},{},{},{}", mpm::name_of(scene.transfer), mpm::name_of(scene.kernel),
                     scene.h, scene.dt ? "" : cell(scene.courant), scene.dt ? cell(*scene.dt) : "");
}
constexpr std::string_view key_columns = "transfer,kernel,h_m,courant,dt_s";

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
      key_columns, fmt::join(copied, ","));
  for (const SweepSeries& series : series_of(runs)) {
    const SweepRun* finest = series.finest();
    for (const SweepRun* run : series.runs) {
      if (run->status().empty()) continue;
      text += fmt::format("{},{},{}", key_cells(run->scene()), run->status(), cell(run->mean_dt()));
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
  constexpr std::array<std::string_view, 9> columns{"time_s",
                                                    "front_m",
                                                    "front_99_m",
                                                    "front_max_m",
                                                    "height_m",
                                                    "kinetic_J_per_m",
                                                    "angular_momentum",
                                                    "transfer_loss_J_per_m",
                                                    "energy_residual_J_per_m"};
  std::string text = fmt::format("{},{}\n", key_columns, fmt::join(columns, ","));
  for (const SweepRun& run : runs) {
    const auto time = run.series.find("time_s");
    if (time == run.series.end()) continue;
    for (std::size_t i = 0; i < time->second.size(); ++i) {
      text += key_cells(run.scene());
      for (const std::string_view column : columns)
        text += "," + cell(run.series.find(column)->second[i]);
      text += "\n";
    }
  }
  return text;
}

Json sweep_answer(const std::vector<SweepSeries>& series) {
  Json answer = Json::array();
  for (const SweepSeries& s : series) {
    const std::vector<const SweepRun*> runs = s.done_runs();
    Json line{{"transfer", mpm::name_of(s.scene().transfer)},
              {"kernel", mpm::name_of(s.scene().kernel)},
              {"h_m", s.scene().h},
              {"runs", s.runs.size()},
              {"done", runs.size()}};
    const auto both = [&](std::string_view name, auto&& figure) {
      line[std::string(name)] = {finite_or_null(figure(*runs.front())),
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
  std::string text =
      fmt::format("{:<9} {:<9} {:>7}  {:<14} {:<16} {:<16} {:<16} {:<18} {:<14} {}\n", "transfer",
                  "kernel", "h (mm)", "step (µs)", "front (m)", "99 % front (m)", "height (m)",
                  "kinetic (J/m)", "CPU (s)", "step/4: front, 99 %, height, profile");
  for (const Json& line : answer) {
    text += fmt::format("{:<9} {:<9} {:>7.4g}  ", line["transfer"].get<std::string>(),
                        line["kernel"].get<std::string>(), 1e3 * line["h_m"].get<double>());
    if (!line.contains("front_m")) {
      text += "no run came to its end\n";
      continue;
    }
    text += fmt::format(
        "{:<14} {:<16} {:<16} {:<16} {:<18} {:<14} ", pair(line, "mean_dt_s", 1e6, "{:.4g}"),
        pair(line, "front_m", 1.0, "{:.4f}"), pair(line, "front_99_m", 1.0, "{:.4f}"),
        pair(line, "height_m", 1.0, "{:.4f}"), pair(line, "kinetic_J_per_m", 1.0, "{:.2g}"),
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

}  // namespace repose::app
