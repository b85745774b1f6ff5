#include "calibration/point_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <tbb/enumerable_thread_specific.h>

#include "calibration/path_derivatives.hpp"
#include "models/registry.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using point::Quantity;
using point::Status;

std::string number(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", x);
  return text.data();
}

/// One word per way to fail, by which failed trials are counted.
std::string_view word(const point::Outcome& outcome) {
  switch (outcome.status) {
    case Status::completed:
      return "";
    case Status::stopped:
      return "stopped";
    case Status::separated:
      return "separated";
    case Status::beyond_limit:
      return "beyond_limit";
    case Status::no_response:
      return "no_response";
    case Status::goal_not_met:
      return "goal_not_met";
    case Status::step_limit:
      return "step_limit";
    case Status::step_underflow:
      return "step_underflow";
    case Status::not_converged:
      return "not_converged";
    case Status::not_finite:
      return "not_finite";
    case Status::bad_initial:
      return "bad_initial";
    case Status::unsupported:
      return "unsupported";
    case Status::law_failed:
      return outcome.fault.empty() ? "law_failed" : outcome.fault;
  }
  return "unknown";
}

bool is_stress(Quantity q) {
  return q == Quantity::p || q == Quantity::q || q == Quantity::eta || q == Quantity::sigma_a ||
         q == Quantity::sigma_r || q == Quantity::tau;
}

/// x before the first leg; nullopt where that depends on what is fitted. Errors: InputError.
std::optional<double> x_at_start(const PointExperiment& e) {
  if (!is_stress(e.x)) return 0.0;
  if (e.start_moves) return std::nullopt;
  std::vector<double> theta = e.theta;
  complete_parameters(*e.law, theta);
  return point::start_value(*e.law, theta, e.test, e.x);
}

class PointSimulator final : public Simulator {
 public:
  explicit PointSimulator(PointExperiment experiment) : e_(std::move(experiment)) {
    for (const ParamInfo& p : e_.law->parameters) names_.emplace_back(p.name);
    for (const std::string_view name : initial_input_names) names_.emplace_back(name);
    quantities_ = e_.y;
    quantities_.insert(quantities_.begin(), e_.x);
    point::Settings& settings = e_.test.settings;
    settings.energy = false;
    const point::Method method = point::method_for(*e_.law, settings.method);
    if (settings.method == point::Method::automatic && method != point::Method::adaptive)
      settings.method = point::Method::implicit;
    else
      settings.method = method;
    exact_ =
        settings.method == point::Method::adaptive || settings.method == point::Method::implicit;
    if (e_.rows == Rows::at_data)
      e_.test.path =
          split_at(e_.test.path, e_.x, x_at_start(e_), e_.abscissae, e_.lines, leg_of_row_);
    if (e_.rows == Rows::leg_ends)
      for (std::size_t i = 0; i < e_.test.path.legs.size(); ++i)
        leg_of_row_.push_back(static_cast<int>(i));
  }

  const std::vector<std::string>& inputs() const override { return names_; }
  bool has_derivatives() const override { return exact_; }

  std::shared_ptr<const Simulator> with_abscissae_times(double factor) const override {
    if (e_.rows != Rows::at_data) return {};
    PointExperiment other = e_;
    for (double& x : other.abscissae) x *= factor;
    try {
      return std::make_shared<PointSimulator>(std::move(other));
    } catch (const InputError&) {  // not on the way of the test
      return {};
    }
  }

  std::shared_ptr<const Simulator> drawn(std::span<const std::string> channels) const override {
    if (e_.rows == Rows::leg_ends) return {};  // a flow curve has nothing between its rates
    PointExperiment other = e_;
    other.rows = Rows::along;
    other.y.clear();
    for (const std::string& name : channels) {
      const std::optional<Quantity> quantity = point::find_quantity(name);
      if (!quantity) return {};
      other.y.push_back(*quantity);
    }
    constexpr int rows = 400;  // of the picture, about; a leg has 2 to 20
    const auto legs = static_cast<int>(other.test.path.legs.size());
    const int points = std::clamp(rows / std::max(legs, 1), 2, 20);
    for (point::Leg& leg : other.test.path.legs) {
      point::LegSpec spec = leg.spec();
      spec.points = std::max(spec.points, points);
      leg = point::Leg(std::move(spec));
    }
    return std::make_shared<PointSimulator>(std::move(other));
  }

  void simulate(std::span<const double> inputs, std::span<const int> wanted,
                Response& response) const override {
    Scratch& scratch = scratch_.local();
    point::Outcome outcome;
    if (wanted.empty()) {
      if (scratch.test.path.legs.empty()) scratch.test = e_.test;
      const PointInputs in = split_inputs(e_.law->parameters.size(), e_.test.initial, inputs);
      scratch.test.initial = in.initial;
      outcome = point::simulate(*e_.law, in.theta, scratch.test, scratch.curve);
      scratch.columns.resize(quantities_.size());
      scratch.legs.clear();
      for (const auto& row : scratch.curve.rows) scratch.legs.push_back(row.leg);
      for (std::size_t c = 0; c < quantities_.size(); ++c) {
        point::read_column(*e_.law, in.theta, scratch.test, scratch.curve, quantities_[c],
                           scratch.values);
        scratch.columns[c].value = Eigen::Map<const Eigen::VectorXd>(
            scratch.values.data(), static_cast<Index>(scratch.values.size()));
        scratch.columns[c].slope.resize(static_cast<Index>(scratch.values.size()), 0);
      }
    } else {
      outcome = simulate_with_derivatives(*e_.law, e_.test.initial, inputs, wanted, e_.test,
                                          quantities_, scratch.columns, scratch.legs);
    }
    fill(outcome, scratch, static_cast<Index>(wanted.size()), response);
  }

 private:
  struct Scratch {
    point::PointTest test;
    point::Curve curve;
    std::vector<Column> columns;
    std::vector<int> legs;
    std::vector<double> values;
  };

  void fill(const point::Outcome& outcome, const Scratch& scratch, Index wanted,
            Response& r) const {
    const bool complete = outcome.status == Status::completed;
    r.reason = complete ? "" : word(outcome);
    r.finished = complete ? 1.0 : outcome.fraction;
    const auto& columns = scratch.columns;
    const auto channels = static_cast<Index>(e_.y.size());
    // a path that broke off has its last state as an extra row
    const Index all = columns.empty() ? 0 : columns[0].value.size();
    const Index rows = complete || all == 0 ? all : all - 1;
    r.last.resize(0);
    if (!complete && all > 0 && outcome.status != Status::bad_initial) {
      r.last.resize(channels);
      for (Index c = 0; c < channels; ++c)
        r.last[c] = columns[static_cast<std::size_t>(c) + 1].value[all - 1];
    }
    std::vector<Index> picked;
    if (e_.rows == Rows::along) {
      for (Index i = 0; i < rows; ++i) picked.push_back(i);
    } else if (all > 0 && outcome.status != Status::bad_initial) {
      const auto& legs = scratch.legs;  // of each row, ascending
      for (const int leg : leg_of_row_) {
        if (!complete && leg >= outcome.leg) break;
        // the start (leg −1) is row 0, which carries leg 0 like the end of leg 0
        const auto after = std::upper_bound(legs.begin(), legs.end(), leg);
        picked.push_back(leg < 0 ? 0 : static_cast<Index>(after - legs.begin()) - 1);
      }
    }
    const auto n = static_cast<Index>(picked.size());
    r.x.resize(n);
    r.y.resize(n, channels);
    r.dx.resize(n, wanted);
    r.dy.assign(e_.y.size(), Eigen::MatrixXd(n, wanted));
    for (Index i = 0; i < n; ++i) {
      const Index from = picked[static_cast<std::size_t>(i)];
      r.x[i] = columns[0].value[from];
      if (wanted > 0) r.dx.row(i) = columns[0].slope.row(from);
      for (Index c = 0; c < channels; ++c) {
        const Column& column = columns[static_cast<std::size_t>(c) + 1];
        r.y(i, c) = column.value[from];
        if (wanted > 0) r.dy[static_cast<std::size_t>(c)].row(i) = column.slope.row(from);
      }
    }
    for (Index c = 0; c < channels; ++c)
      if (!r.y.col(c).allFinite() || (r.last.size() > 0 && !std::isfinite(r.last[c]))) {
        r.reason = "not_finite";
        r.finished = 0.0;
        r.last.resize(0);
        r.x.resize(0);
        r.y.resize(0, channels);
        return;
      }
  }

  PointExperiment e_;
  std::vector<std::string> names_;
  std::vector<Quantity> quantities_;
  std::vector<int> leg_of_row_;
  bool exact_ = false;
  mutable tbb::enumerable_thread_specific<Scratch> scratch_;
};

}  // namespace

bool leads_along(const point::Path& path, Quantity x) {
  if (path.legs.empty()) return false;
  for (const point::Leg& leg : path.legs) {
    const point::LegSpec& spec = leg.spec();
    if (!spec.goal || spec.goal_is_event || spec.goal->quantity != x) return false;
  }
  return true;
}

namespace {

/// Splits the stages of a path one by one at the rows of a table.
class Splitter {
 public:
  Splitter(const point::Path& path, std::optional<double> x_start, std::span<const double> x,
           std::vector<int>& leg_of_row)
      : path_(path),
        x_(x),
        leg_of_row_(leg_of_row),
        split_(path) {
    split_.legs.clear();
    if (path.undrained && path.first_undrained > 0)  // unless the rows lead that far
      split_.first_undrained = std::numeric_limits<int>::max();
    leg_of_row.assign(x.size(), -1);
    double size = std::abs(x_start.value_or(0.0)), low = x_start.value_or(x[0]), high = low;
    for (const double value : x) {
      size = std::max(size, std::abs(value));
      low = std::min(low, value);
      high = std::max(high, value);
    }
    tolerance_ = 1e-9 * size;
    scatter_ = 0.01 * (high - low);
    now_ = stage_start_ = x_start.value_or(std::numeric_limits<double>::quiet_NaN());
  }

  /// The number of rows that the stages pass.
  std::size_t run() {
    std::size_t next = 0;
    for (std::size_t i = 0; i < path_.legs.size() && next < x_.size(); ++i) {
      if (static_cast<int>(i) == path_.first_undrained)
        split_.first_undrained = static_cast<int>(split_.legs.size());
      const point::LegSpec& stage = path_.legs[i].spec();
      if (!stage.continues) stage_start_ = now_;
      const double end = stage.goal->value + (stage.goal->of_stage ? stage_start_ : 0.0);
      const double from = std::isnan(now_) ? x_[next] : now_;
      const double towards = end >= from ? 1.0 : -1.0;
      const std::size_t first = next;
      next = last_of_stage(i, next, from, end, towards);
      fresh_ = !stage.continues;
      visit(stage, first, next, from, towards);
      if (next < x_.size()) go_to(stage, end);
    }
    return next;
  }

  point::Path take() { return std::move(split_); }

 private:
  /// One past the last of the rows from `next` on that belong to stage i.
  std::size_t last_of_stage(std::size_t i, std::size_t next, double from, double end,
                            double towards) const {
    double furthest = from;
    const bool another = i + 1 < path_.legs.size();
    for (; next < x_.size(); ++next) {
      const double back = towards * (furthest - x_[next]);
      if (towards * (end - x_[next]) < -tolerance_) break;
      if (back > tolerance_ && (back > scatter_ || (another && !goes_on(next, furthest, towards))))
        break;
      furthest = towards * std::max(towards * furthest, towards * x_[next]);
    }
    return next;
  }

  /// Do the rows after this one, which steps back, pass the furthest so far again before they fall
  /// behind it for good?
  bool goes_on(std::size_t row, double furthest, double towards) const {
    for (std::size_t k = row + 1; k < x_.size(); ++k) {
      const double ahead = towards * (x_[k] - furthest);
      if (ahead >= -tolerance_) return true;
      if (ahead < -scatter_) return false;
    }
    return false;
  }

  void visit(const point::LegSpec& stage, std::size_t first, std::size_t last, double from,
             double towards) {
    std::vector<std::size_t> order;
    for (std::size_t k = first; k < last; ++k) order.push_back(k);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return towards * x_[a] < towards * x_[b];
    });
    for (const std::size_t k : order) {
      if (towards * (x_[k] - from) >= -tolerance_) go_to(stage, x_[k]);
      leg_of_row_[k] = previous_leg_;
    }
  }

  void go_to(const point::LegSpec& stage, double value) {
    if (std::abs(value - now_) <= tolerance_) return;
    point::LegSpec leg = stage;
    leg.goal->value = value;
    leg.goal->of_stage = false;
    leg.points = 1;
    leg.continues = !fresh_;
    fresh_ = false;
    split_.legs.emplace_back(std::move(leg));
    previous_leg_ = static_cast<int>(split_.legs.size()) - 1;
    now_ = value;
  }

  const point::Path& path_;
  std::span<const double> x_;
  std::vector<int>& leg_of_row_;
  point::Path split_;
  double tolerance_ = 0.0, scatter_ = 0.0;
  double now_ = 0.0, stage_start_ = 0.0;
  bool fresh_ = true;
  int previous_leg_ = -1;
};

/// "0, 0.1, 0.08": where the stages lead, from the start of the test.
std::string ends_of(const point::Path& path, std::optional<double> x_start) {
  std::string ends;
  double now = x_start.value_or(0.0), stage_start = now;
  for (const point::Leg& leg : path.legs) {
    if (!leg.spec().continues) stage_start = now;
    now = leg.spec().goal->value + (leg.spec().goal->of_stage ? stage_start : 0.0);
    ends += (ends.empty() ? "" : ", ") + number(now);
  }
  return ends;
}

}  // namespace

point::Path split_at(const point::Path& path, Quantity x, std::optional<double> x_start,
                     std::span<const double> abscissae, std::span<const int> lines,
                     std::vector<int>& leg_of_row) {
  if (abscissae.empty()) throw InputError("data", "the data have no row");
  Splitter splitter(path, x_start, abscissae, leg_of_row);
  const std::size_t passed = splitter.run();
  if (passed < abscissae.size()) {
    const std::string line =
        passed < lines.size() ? " (line " + std::to_string(lines[passed]) + ")" : "";
    bool of_stage = false;
    for (std::size_t i = 1; i < path.legs.size(); ++i)
      of_stage = of_stage || path.legs[i].spec().goal->of_stage;
    throw InputError(
        "data", "the row at " + std::string(point::column_name(x)) + " = " +
                    number(abscissae[passed]) + line +
                    " is not on the way of the test, which leads" +
                    (x_start ? " from " + number(*x_start) : "") + " to " + ends_of(path, x_start) +
                    ": rows must stand in the order of the test" +
                    (of_stage ? "; a stage's strain counts from the start of the stage, one of the "
                                "whole test is spelt ..._total"
                              : "; leave the test's end out to drive it to the last row"));
  }
  point::Path split = splitter.take();
  if (split.legs.empty())
    throw InputError("data", "the data have no row beyond the start of the test");
  return split;
}

bool take_stage_strains_as_totals(PointExperiment& e) {
  point::Path totals = e.test.path;
  totals.legs.clear();
  bool any = false;
  for (const point::Leg& leg : e.test.path.legs) {
    point::LegSpec spec = leg.spec();
    any = any || (spec.goal && spec.goal->of_stage && !totals.legs.empty());
    if (spec.goal) spec.goal->of_stage = false;
    totals.legs.emplace_back(std::move(spec));
  }
  if (!any || e.rows != Rows::at_data || !leads_along(e.test.path, e.x)) return false;
  const std::optional<double> start = x_at_start(e);
  std::vector<int> rows;
  const auto passes = [&](const point::Path& path) {
    return Splitter(path, start, e.abscissae, rows).run() == e.abscissae.size();
  };
  if (passes(e.test.path) || !passes(totals)) return false;
  e.test.path = std::move(totals);
  return true;
}

point::Path flow_curve_path(std::span<const double> shear_rates, point::Condition condition,
                            double strain) {
  std::vector<point::Stage> stages;
  for (std::size_t i = 0; i < shear_rates.size(); ++i) {
    point::Stage stage;
    stage.kind = point::Kind::simple_shear;
    stage.condition = condition;
    stage.rate = shear_rates[i];
    stage.goal = point::Goal{Quantity::gamma, static_cast<double>(i + 1) * strain};
    stage.points = 1;
    stages.push_back(stage);
  }
  return point::path_of(stages);
}

std::unique_ptr<Simulator> make_point_simulator(PointExperiment experiment) {
  return std::make_unique<PointSimulator>(std::move(experiment));
}

}  // namespace repose::calibration
