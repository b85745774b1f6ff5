#include "calibration/point_simulator.hpp"

#include <cmath>
#include <cstdio>

#include <tbb/enumerable_thread_specific.h>

#include "calibration/path_derivatives.hpp"

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
std::string_view word(Status status) {
  switch (status) {
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
  }
  return "unknown";
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
          split_at(e_.test.path, e_.x, x_at_start(), e_.abscissae, e_.lines, leg_of_row_);
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

  double x_at_start() const {
    const InitialConditions& given = e_.test.initial;
    switch (e_.x) {
      case Quantity::p:
      case Quantity::sigma_a:
      case Quantity::sigma_r:
        if (given.p && !given.K0) return *given.p;
        if (given.sigma && e_.x == Quantity::sigma_a) return (*given.sigma)[1];
        return e_.abscissae.empty() ? 0.0 : e_.abscissae.front();
      default:
        return 0.0;
    }
  }

  void fill(const point::Outcome& outcome, const Scratch& scratch, Index wanted,
            Response& r) const {
    const bool complete = outcome.status == Status::completed;
    r.reason = complete ? "" : word(outcome.status);
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
      std::size_t row = 0;
      for (const int leg : leg_of_row_) {
        if (!complete && leg >= outcome.leg) break;
        while (row + 1 < scratch.legs.size() && scratch.legs[row + 1] <= leg) ++row;
        // the start (leg −1) is row 0, which carries leg 0 like the end of leg 0
        picked.push_back(leg < 0 ? 0 : static_cast<Index>(row));
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

point::Path split_at(const point::Path& path, Quantity x, double x_start,
                     std::span<const double> abscissae, std::span<const int> lines,
                     std::vector<int>& leg_of_row) {
  point::Path split = path;
  split.legs.clear();
  leg_of_row.clear();
  double size = std::abs(x_start);
  for (const double value : abscissae) size = std::max(size, std::abs(value));
  const double tolerance = 1e-9 * size;
  double now = x_start;
  std::size_t next = 0;
  int previous_leg = -1;
  const auto go_to = [&](const point::LegSpec& stage, double value) {
    if (std::abs(value - now) <= tolerance) return;
    point::LegSpec leg = stage;
    leg.goal->value = value;
    leg.points = 1;
    split.legs.emplace_back(std::move(leg));
    previous_leg = static_cast<int>(split.legs.size()) - 1;
    now = value;
  };
  for (const point::Leg& leg : path.legs) {
    const point::LegSpec& stage = leg.spec();
    const double end = stage.goal->value;
    const double towards = end >= now ? 1.0 : -1.0;
    while (next < abscissae.size()) {
      const double value = abscissae[next];
      if (towards * (value - now) < -tolerance || towards * (end - value) < -tolerance) break;
      go_to(stage, value);
      leg_of_row.push_back(previous_leg);
      ++next;
    }
    if (next == abscissae.size()) break;
    go_to(stage, end);
  }
  if (next < abscissae.size()) {
    const std::string line =
        next < lines.size() ? " (line " + std::to_string(lines[next]) + ")" : "";
    std::string ends;
    for (const point::Leg& leg : path.legs)
      ends += (ends.empty() ? "" : ", ") + number(leg.spec().goal->value);
    throw InputError("data", "the row at " + std::string(point::column_name(x)) + " = " +
                                 number(abscissae[next]) + line +
                                 " is not on the way of the test, which leads from " +
                                 number(x_start) + " to " + ends +
                                 ": rows must stand in the order of the test");
  }
  if (split.legs.empty())
    throw InputError("data", "the data have no row beyond the start of the test");
  return split;
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
