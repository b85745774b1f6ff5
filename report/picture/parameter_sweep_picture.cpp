#include "report/picture/parameter_sweep_picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/run/finished_result.hpp"

namespace repose::report {
namespace {

constexpr std::size_t most_names = 14;    ///< with more, the legend would be the picture
constexpr std::size_t most_curves = 200;  ///< with more, evenly chosen ones

struct Panel {
  std::string title, x_column, y_column, x_label, y_label;
  double x_factor = 1.0, y_factor = 1.0;
  AxisScale x_scale = AxisScale::linear;
  bool y_over_x = false;  ///< y is the ratio of the two columns
};

std::vector<Panel> panels_of(point::Kind kind, bool has_v, const std::string& strain) {
  switch (kind) {
    case point::Kind::simple_shear:
      return {{"shear stress", "gamma", "tau_Pa", "γ (%)", "τ (kPa)", 100.0, 1e-3},
              {"stress path on the horizontal plane", "sigma_a_Pa", "tau_Pa", "σ′_{yy} (kPa)",
               "τ (kPa)", 1e-3, 1e-3}};
    case point::Kind::oedometer:
    case point::Kind::isotropic: {
      const bool oedometer = kind == point::Kind::oedometer;
      const std::string x = oedometer ? "sigma_a_Pa" : "p_Pa";
      const std::string x_label = oedometer ? "σ′_{a} (kPa)" : "p′ (kPa)";
      std::vector<Panel> list;
      if (has_v)
        list.push_back(
            {"compression", x, "v", x_label, "v = 1 + e", 1e-3, 1.0, AxisScale::logarithmic});
      else
        list.push_back({"compression", x, "eps_v", x_label, fmt::format("ε_{{v}} ({}, %)", strain),
                        1e-3, 100.0, AxisScale::logarithmic});
      if (oedometer)
        list.push_back({"horizontal stress", x, "sigma_r_Pa", x_label, "K_{0} = σ′_{r}/σ′_{a}",
                        1e-3, 1.0, AxisScale::logarithmic, true});
      return list;
    }
    case point::Kind::triaxial:
    case point::Kind::custom:
      break;
  }
  return {{"stress and strain", "eps_a", "q_Pa", fmt::format("ε_{{a}} ({}, %)", strain), "q (kPa)",
           100.0, 1e-3},
          {"stress path", "p_Pa", "q_Pa", "p′ (kPa)", "q (kPa)", 1e-3, 1e-3}};
}

/// "initial.ocr = 4, law.M = 0.9"
std::string values_text(const std::vector<std::string>& keys,
                        const std::vector<std::string>& values) {
  std::string text;
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (!values[k].empty())
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", keys[k], values[k]);
  return text;
}

/// One run's curve: as long as there are few, solid in seven colours and then dashed.
void curve(Axes& axes, const std::string& name, std::size_t k, bool few,
           const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t colours = 7;  // until they start again
  const Style style{cycle_colour(k), few ? 1.8 : 0.8};
  if (few && k >= colours)
    axes.dashed(name, x, y, style);
  else
    axes.line(name, x, y, style);
}

}  // namespace

Figure point_sweep_picture(const study::PointSweep& sweep, const std::string& name,
                           const std::filesystem::path& curves) {
  const study::NumberTable columns = study::read_numbers(curves);
  const std::vector<double>& run_of_row = columns.at("run");
  const auto first = std::find_if(sweep.cases().begin(), sweep.cases().end(),
                                  [](const study::PointCase& one) { return one.test.has_value(); });
  const auto& legs = first->test->test.path.legs;
  Figure figure(
      name, fmt::format("{} runs over {}", sweep.finished().size(), fmt::join(sweep.keys(), ", ")));
  figure.columns = 2;
  const std::size_t step = (sweep.runs() + most_curves - 1) / most_curves;
  for (const Panel& panel :
       panels_of(legs.back().spec().kind, columns.contains("v"),
                 std::string(point::name_of(first->test->test.path.measure)))) {
    Axes& axes = figure.add_axes();
    axes.title = panel.title;
    axes.x = {panel.x_label, panel.x_scale};
    axes.y.label = panel.y_label;
    const std::vector<double>&x = columns.at(panel.x_column), &y = columns.at(panel.y_column);
    for (std::size_t row = 0, end = 0; row < run_of_row.size(); row = end) {
      while (end < run_of_row.size() && run_of_row[end] == run_of_row[row]) ++end;
      const auto run = static_cast<std::size_t>(run_of_row[row]) - 1;
      if (run % step != 0) continue;
      std::vector<double> xs, ys;
      for (std::size_t i = row; i < end; ++i) {
        xs.push_back(panel.x_factor * x[i]);
        ys.push_back(panel.y_over_x ? y[i] / x[i] : panel.y_factor * y[i]);
      }
      const bool few = sweep.runs() <= most_names;
      const bool named = few && &axes == figure.panels().front().get();
      curve(axes, named ? values_text(sweep.keys(), sweep.cases()[run].values) : "", run / step,
            few, xs, ys);
    }
  }
  return figure;
}

Figure scene_sweep_picture(const study::SceneSweep& sweep, const std::string& name,
                           const std::filesystem::path& runs) {
  Figure figure(
      name, fmt::format("{} runs over {}", sweep.cases().size(), fmt::join(sweep.keys(), ", ")));
  figure.columns = 2;
  struct Panel {
    const char *file, *x, *y, *title, *x_label, *y_label;
  };
  constexpr std::array<Panel, 3> panels{
      Panel{"series.csv", "time_s", "front_99_m", "front of 99 % of the mass", "t (s)", "x (m)"},
      Panel{"series.csv", "time_s", "height_m", "height", "t (s)", "y (m)"},
      Panel{"profile.csv", "x_m", "depth_m", "depth at the end", "x (m)", "depth (m)"}};
  const std::size_t step = (sweep.cases().size() + most_curves - 1) / most_curves;
  for (const Panel& panel : panels) {
    Axes& axes = figure.add_axes();
    axes.title = panel.title;
    axes.x.label = panel.x_label;
    axes.y.label = panel.y_label;
    for (std::size_t k = 0; k < sweep.cases().size(); k += step) {
      const study::SceneCase& one = sweep.cases()[k];
      if (one.summary.status != "done") continue;
      const study::NumberTable table =
          study::read_numbers(runs / study::SceneSweep::folder_name(k + 1) / panel.file);
      const auto x = table.find(panel.x), y = table.find(panel.y);
      if (x == table.end() || y == table.end()) continue;
      const bool few = sweep.cases().size() <= most_names;
      const bool named = few && &axes == figure.panels().front().get();
      curve(axes, named ? values_text(sweep.keys(), one.values) : "", k / step, few, x->second,
            y->second);
    }
  }
  return figure;
}

}  // namespace repose::report
