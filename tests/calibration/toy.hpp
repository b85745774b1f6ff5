#pragma once
/// \file
/// Simulators whose answers are known in closed form.

#include <atomic>
#include <cmath>
#include <stdexcept>

#include "calibration/problem.hpp"

namespace repose::calibration {

/// What a trial may run into.
enum class Trap : std::uint8_t { none, not_a_number, exception, breaks_off };

/// y = a exp(−b x) at given x, with derivatives; for b > trap_above it does what the trap says.
class Decay final : public Simulator {
 public:
  explicit Decay(std::vector<double> x, Trap trap = Trap::none, double trap_above = 3.0)
      : x_(std::move(x)),
        trap_(trap),
        trap_above_(trap_above) {}
  const std::vector<std::string>& inputs() const override {
    static const std::vector<std::string> names{"a", "b"};
    return names;
  }
  bool has_derivatives() const override { return true; }
  void simulate(std::span<const double> in, std::span<const int> wanted,
                Response& r) const override {
    ++calls;
    for (const double x : in) worst_input = std::max(worst_input, x);
    const double a = in[0], b = in[1];
    const bool trapped = trap_ != Trap::none && b > trap_above_;
    if (trapped && trap_ == Trap::exception) throw std::runtime_error("a trial that throws");
    const auto n = static_cast<Eigen::Index>(x_.size());
    r = {};
    // the further beyond, the earlier it breaks off
    const double share = trapped && trap_ == Trap::breaks_off ? 1.0 / (1.0 + b - trap_above_) : 1.0;
    const double end = share * x_.back();
    Eigen::Index done = 0;
    while (done < n && x_[static_cast<std::size_t>(done)] <= end) ++done;
    if (share == 1.0) done = n;
    r.x.resize(done);
    r.y.resize(done, 1);
    r.dx = Eigen::MatrixXd::Zero(done, static_cast<Eigen::Index>(wanted.size()));
    r.dy.assign(1, r.dx);
    for (Eigen::Index i = 0; i < done; ++i) {
      const double x = x_[static_cast<std::size_t>(i)], y = a * std::exp(-b * x);
      r.x[i] = x;
      r.y(i, 0) = trapped && trap_ == Trap::not_a_number ? std::nan("") : y;
      for (std::size_t k = 0; k < wanted.size(); ++k)
        r.dy[0](i, static_cast<Eigen::Index>(k)) = wanted[k] == 0 ? y / a : -x * y;
    }
    if (share < 1.0) {
      r.reason = "broke_off";
      r.finished = share;
      r.last.resize(1);
      r.last[0] = a * std::exp(-b * end);
    }
  }
  mutable std::atomic<long> calls{0};
  mutable double worst_input = 0.0;

 private:
  std::vector<double> x_;
  Trap trap_;
  double trap_above_;
};

/// y = a + b x
class Line final : public Simulator {
 public:
  explicit Line(std::vector<double> x) : x_(std::move(x)) {}
  const std::vector<std::string>& inputs() const override {
    static const std::vector<std::string> names{"a", "b"};
    return names;
  }
  bool has_derivatives() const override { return true; }
  void simulate(std::span<const double> in, std::span<const int> wanted,
                Response& r) const override {
    const auto n = static_cast<Eigen::Index>(x_.size());
    r = {};
    r.x = Eigen::Map<const Eigen::VectorXd>(x_.data(), n);
    r.y = (in[0] + in[1] * r.x.array()).matrix();
    r.dx = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(wanted.size()));
    r.dy.assign(1, r.dx);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const auto col = static_cast<Eigen::Index>(k);
      if (wanted[k] == 0)
        r.dy[0].col(col).setOnes();
      else
        r.dy[0].col(col) = r.x;
    }
  }

 private:
  std::vector<double> x_;
};

inline FreeParameter free_parameter(const char* name, double lower, double upper,
                                    Scale scale = Scale::linear) {
  FreeParameter p;
  p.name = name;
  p.lower = lower;
  p.upper = upper;
  p.scale = scale;
  return p;
}

/// Its curve with these a and b in x = 0.1 … 2 as what was measured, with errors added if there
/// are.
inline Target decay_target(std::shared_ptr<Decay> simulator, double a, double b,
                           const Eigen::VectorXd& errors = {}) {
  Target t;
  t.name = "decay";
  t.simulator = simulator;
  t.inputs = {1.0, 1.0};
  t.bindings = {{0, 0}, {1, 1}};
  Response r;
  const std::array<double, 2> truth{a, b};
  simulator->simulate(truth, {}, r);
  t.x = r.x;
  Eigen::VectorXd y = r.y.col(0);
  if (errors.size() > 0) y += errors;
  t.channels.push_back({"y", y, {}, 1.0});
  return t;
}
/// a exp(−b x), a = 2, b = 1.3, a in [0.1, 10] (log), b in [0.05, 6].
inline Problem decay_problem(std::shared_ptr<Decay> simulator) {
  return Problem(
      ParameterSpace({free_parameter("a", 0.1, 10.0, Scale::log), free_parameter("b", 0.05, 6.0)}),
      {decay_target(std::move(simulator), 2.0, 1.3)});
}

inline std::vector<double> decay_x() {
  std::vector<double> x;
  for (int i = 1; i <= 20; ++i) x.push_back(0.1 * i);
  return x;
}

}  // namespace repose::calibration
