#include "report/picture/sweep_picture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/core.h>

#include "study/accuracy/quantity.hpp"

namespace repose::report {
namespace {

using Figure_of = std::function<double(const study::SweepRun&)>;

/// Seven colours, then the same seven with another marker.
Style style_number(std::size_t k) {
  constexpr std::array markers{Marker::circle, Marker::open_square, Marker::triangle};
  Style style;
  style.colour = cycle_colour(k);
  style.marker = markers[k / 7 % markers.size()];
  style.marker_px = 5.5;
  return style;
}

/// A transfer has its own style in every picture, unless something else than the transfer, the
/// kernel, the cells and the step is varied: then every name has.
class Styles {
 public:
  explicit Styles(const std::vector<study::SweepSeries>& series) {
    for (const study::SweepSeries& s : series) {
      if (s.name() != mpm::name_of(s.scene().transfer)) by_name_ = true;
      if (std::find(names_.begin(), names_.end(), s.name()) == names_.end())
        names_.push_back(s.name());
    }
  }
  Style operator()(const study::SweepSeries& s) const {
    if (!by_name_) return style_number(static_cast<std::size_t>(s.scene().transfer));
    const auto at = std::find(names_.begin(), names_.end(), s.name());
    return style_number(static_cast<std::size_t>(at - names_.begin()));
  }

 private:
  bool by_name_ = false;
  std::vector<std::string> names_;
};

Style without_marker(Style style) {
  style.marker.reset();
  return style;
}

/// What one column of panels shows: series of the same cell size and kernel.
struct Column {
  std::string title;
  std::vector<const study::SweepSeries*> series;
};

std::vector<Column> columns_of(const std::vector<study::SweepSeries>& series) {
  const auto several_kernels =
      std::any_of(series.begin(), series.end(), [&](const study::SweepSeries& s) {
        return s.scene().kernel != series.front().scene().kernel;
      });
  std::vector<Column> columns;
  for (const study::SweepSeries& s : series) {
    if (s.done_runs().empty()) continue;
    std::string title = fmt::format("h = {:.4g} mm", 1e3 * s.scene().h);
    if (several_kernels) title += fmt::format(", {}", mpm::name_of(s.scene().kernel));
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [&](const Column& c) { return c.title == title; });
    (found == columns.end() ? columns.emplace_back(Column{title, {}}) : *found)
        .series.push_back(&s);
  }
  return columns;
}

std::string_view energy_unit(const std::vector<study::SweepSeries>& series) {
  return study::unit_of(study::Quantity::kinetic,
                        series.empty() ? 2 : series.front().scene().dimensions());
}

/// The range of a figure over all runs, so that panels side by side share their axis.
void share_range(Axis& axis, const std::vector<double>& values) {
  double lower = HUGE_VAL, upper = -HUGE_VAL;
  for (const double x : values)
    if (std::isfinite(x) && (axis.scale == AxisScale::linear || x > 0.0)) {
      lower = std::min(lower, x);
      upper = std::max(upper, x);
    }
  if (!(lower <= upper)) return;
  if (axis.scale == AxisScale::logarithmic) {
    axis.lower = lower / 1.6;
    axis.upper = upper * 1.6;
  } else {
    const double room = std::max(0.06 * (upper - lower), 1e-3 * std::abs(upper));
    axis.lower = lower - room;
    axis.upper = upper + room;
  }
}

/// Names that the panel beside the legend does not have: a point outside its range each, so that
/// they stand in the legend all the same. `inside` is an x within the panel.
void name_the_others(Axes& axes, const std::vector<Column>& columns, const Column& column,
                     const Styles& style, double inside, bool markers) {
  if (!axes.y.upper || axes.legend != Legend::right) return;
  const double outside = 10.0 * std::abs(*axes.y.upper);
  std::vector<std::string> known;
  for (const study::SweepSeries* s : column.series) known.push_back(s->name());
  for (const Column& other : columns)
    for (const study::SweepSeries* s : other.series) {
      if (std::find(known.begin(), known.end(), s->name()) != known.end()) continue;
      known.push_back(s->name());
      axes.line(s->name(), std::array{inside}, std::array{outside},
                markers ? style(*s) : without_marker(style(*s)));
    }
}

/// The legend stands once, beside the last panel of the first row.
void place_legend(Axes& axes, std::size_t row, std::size_t column, std::size_t columns) {
  axes.legend = row == 0 && column + 1 == columns ? Legend::right : Legend::none;
}

struct Curve {
  std::vector<double> x, y;
};

Curve curve_of(const std::vector<const study::SweepRun*>& runs, const Figure_of& x,
               const Figure_of& y) {
  Curve curve;
  for (const study::SweepRun* run : runs) {
    const double a = x(*run), b = y(*run);
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    curve.x.push_back(a);
    curve.y.push_back(b);
  }
  return curve;
}

}  // namespace

Figure step_figure(const std::vector<study::SweepSeries>& series, const std::string& name) {
  Figure figure("Does the run-out depend on the step?",
                name + "; the change of the profile is that from the shortest step");
  const std::vector<Column> columns = columns_of(series);
  const Styles style(series);
  figure.columns = std::max<std::size_t>(1, columns.size());
  figure.panel_width_px = 380.0;
  figure.panel_height_px = 230.0;
  const Figure_of dt = [](const study::SweepRun& r) { return 1e6 * r.mean_dt(); };
  const auto named = [](const char* key) {
    return [key](const study::SweepRun& r) { return r.figure(key); };
  };
  struct Row {
    Axis x, y;
    Figure_of x_of, y_of;
  };
  const Axis step{"mean step (µs)", AxisScale::logarithmic};
  const auto change = [&](const study::SweepRun& run) {
    for (const study::SweepSeries& s : series)
      if (std::find(s.runs.begin(), s.runs.end(), &run) != s.runs.end() && s.finest() != nullptr &&
          s.finest() != &run)
        if (const auto c = study::change_between(run, *s.finest())) return 100.0 * c->profile_max;
    return std::nan("");
  };
  const std::string_view energy = energy_unit(series);
  std::vector<Row> rows{
      {step, {"front at the end (m)"}, dt, named("front_m")},
      {step, {"front of 99 % of the mass (m)"}, dt, named("front_99_m")},
      {step, {"height at the wall (m)"}, dt, named("height_m")},
      {step,
       {fmt::format("kinetic energy at the end ({})", energy), AxisScale::logarithmic},
       dt,
       named("kinetic_J_per_m")},
      {{"CPU time (s)", AxisScale::logarithmic},
       {"largest change of depth (% of H_{0})", AxisScale::logarithmic},
       named("cpu_s"),
       change}};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Row& row = rows[r];
    std::vector<double> ys;
    for (const Column& column : columns)
      for (const study::SweepSeries* s : column.series)
        for (const study::SweepRun* run : s->done_runs()) ys.push_back(row.y_of(*run));
    share_range(row.y, ys);
    if (std::none_of(ys.begin(), ys.end(), [](double y) { return std::isfinite(y); })) continue;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      Axes& axes = figure.add_axes();
      if (r == 0) axes.title = columns[c].title;
      axes.x = row.x;
      axes.y = row.y;
      place_legend(axes, r, c, columns.size());
      for (const study::SweepSeries* s : columns[c].series) {
        const Curve curve = curve_of(s->done_runs(), row.x_of, row.y_of);
        axes.line(s->name(), curve.x, curve.y, style(*s));
      }
      const Curve first = curve_of(columns[c].series.front()->done_runs(), row.x_of, row.y_of);
      if (!first.x.empty())
        name_the_others(axes, columns, columns[c], style, first.x.front(), true);
    }
  }
  return figure;
}

Figure history_figure(const std::vector<study::SweepSeries>& series, const std::string& name) {
  Figure figure("Collapses with long and short steps",
                name + "; solid: the shortest step, dashed: the longest");
  const std::vector<Column> columns = columns_of(series);
  const Styles style(series);
  figure.columns = std::max<std::size_t>(1, columns.size());
  figure.panel_width_px = 380.0;
  figure.panel_height_px = 260.0;
  const std::array<std::pair<const char*, Axis>, 3> rows{
      std::pair{"front_m", Axis{"front (m)"}},
      {"front_99_m", Axis{"front of 99 % of the mass (m)"}},
      {"kinetic_J_per_m",
       Axis{fmt::format("kinetic energy ({})", energy_unit(series)), AxisScale::logarithmic}}};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto& [key, axis] = rows[r];
    std::vector<double> all;
    for (const Column& column : columns)
      for (const study::SweepSeries* s : column.series)
        for (const study::SweepRun* run : s->done_runs()) {
          const std::vector<double>& y = run->column(key);
          all.insert(all.end(), y.begin() + 1, y.end());  // the first row is rest
        }
    for (std::size_t c = 0; c < columns.size(); ++c) {
      Axes& axes = figure.add_axes();
      if (r == 0) axes.title = columns[c].title;
      axes.x.label = "time (s)";
      axes.y = axis;
      share_range(axes.y, all);
      place_legend(axes, r, c, columns.size());
      for (const study::SweepSeries* s : columns[c].series) {
        const std::vector<const study::SweepRun*> runs = s->done_runs();
        const Style plain = without_marker(style(*s));
        const auto curve = [&](const study::SweepRun& run, const char* column) {
          return std::span(run.column(column)).subspan(1);
        };
        axes.line(s->name(), curve(*runs.back(), "time_s"), curve(*runs.back(), key), plain);
        if (runs.size() > 1)
          axes.dashed("", curve(*runs.front(), "time_s"), curve(*runs.front(), key), plain);
      }
      name_the_others(axes, columns, columns[c], style, 0.0, false);
    }
  }
  return figure;
}

Figure cost_figure(const std::vector<study::SweepSeries>& series, const std::string& name) {
  Figure figure("Cost of a scene", name + "; the longest step of each");
  figure.columns = 3;
  figure.panel_width_px = 330.0;
  figure.panel_height_px = 280.0;
  // the longest step of every name and kernel, over the cell sizes
  struct Line {
    const study::SweepSeries* first;
    std::vector<const study::SweepRun*> runs;
    mpm::Kernel kernel() const { return first->scene().kernel; }
  };
  const Styles style_of(series);
  std::vector<Line> lines;
  for (const study::SweepSeries& s : series) {
    if (s.done_runs().empty()) continue;
    const auto found = std::find_if(lines.begin(), lines.end(), [&](const Line& l) {
      return l.first->name() == s.name() && l.kernel() == s.scene().kernel;
    });
    (found == lines.end() ? lines.emplace_back(Line{&s, {}}) : *found)
        .runs.push_back(s.done_runs().front());
  }
  const bool several_kernels = std::any_of(lines.begin(), lines.end(), [&](const Line& l) {
    return l.kernel() != lines.front().kernel();
  });
  struct Panel {
    Axis x, y;
    Figure_of x_of, y_of;
  };
  const Axis points{"points", AxisScale::logarithmic};
  const Figure_of points_of = [](const study::SweepRun& r) { return r.figure("points"); };
  std::vector<Panel> panels{
      {{"h (mm)", AxisScale::logarithmic},
       {"CPU time (s)", AxisScale::logarithmic},
       [](const study::SweepRun& r) { return 1e3 * r.scene().h; },
       [](const study::SweepRun& r) { return r.figure("cpu_s"); }},
      {points,
       {"10^{6} point-steps per CPU second"},
       points_of,
       [](const study::SweepRun& r) { return 1e-6 * r.point_steps_per_cpu_s(); }},
      {points, {"bytes of points and grid per point"}, points_of, [](const study::SweepRun& r) {
         return r.bytes_per_point();
       }}};
  for (std::size_t p = 0; p < panels.size(); ++p) {
    Axes& axes = figure.add_axes();
    axes.x = panels[p].x;
    axes.y = panels[p].y;
    if (axes.y.scale == AxisScale::linear) axes.y.lower = 0.0;
    axes.legend = p + 1 == panels.size() ? Legend::right : Legend::none;
    for (const Line& line : lines) {
      const Curve curve = curve_of(line.runs, panels[p].x_of, panels[p].y_of);
      std::string label = line.first->name();
      if (several_kernels) label += fmt::format(", {}", mpm::name_of(line.kernel()));
      const Style style = style_of(*line.first);
      if (line.kernel() == mpm::Kernel::cubic || !several_kernels)
        axes.line(label, curve.x, curve.y, style);
      else
        axes.dashed(label, curve.x, curve.y, style);
    }
    if (p == 0 && !lines.empty()) {
      // twice the cells each way and twice the steps: h^-3, through the first line's finest run
      const Curve first = curve_of(lines.front().runs, panels[p].x_of, panels[p].y_of);
      std::vector<double> y;
      for (const double h : first.x)
        y.push_back(first.y.back() * std::pow(h / first.x.back(), -3.0));
      Style style;
      style.colour = Colour::grey;
      axes.dashed("", first.x, y, style);
      axes.title = "grey: h^{-3}";
    }
  }
  return figure;
}

}  // namespace repose::report
