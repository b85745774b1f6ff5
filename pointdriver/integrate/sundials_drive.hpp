#pragma once
/// \file
/// `cvode`, `ida`, `arkode`: the same legs, rates and events as `adaptive`, integrated by SUNDIALS.
/// The branch is fixed while a solver runs; yield, unloading and stops are roots, after which it is
/// started again on the new branch. (A right-hand side that switches branch by itself costs the
/// solver hundreds of thousands of calls.)

#include "pointdriver/integrate/leg_run.hpp"
#include "pointdriver/integrate/sundials_solver.hpp"

namespace repose::point {

/// A leg as SUNDIALS sees it. For ida the unknown strain rates z of the mixed control are part of
/// the vector, (y, z), and the rows that contain stress are their algebraic equations:
///     σ̇ = σ̇(D), state′ = …, ε′ = D = D_p + Σ z_j N_j,   0 = A·D + B·σ̇(D) − c
template <class L>
class LegSystem final : public SmoothSystem {
 public:
  using F = Flow<L, double>;
  using Y = typename F::Y;
  static constexpr int n = static_cast<int>(F::size);

  LegSystem(LegRun<L, double>& run, bool algebraic)
      : run_(run),
        algebraic_(algebraic ? run.flow().control().unknowns() : 0) {}

  int size() const override { return n + algebraic_; }
  int event_count() const override { return run_.event_count(); }
  bool differential(int i) const override { return i < n; }

  bool rate(const double* y, double* dy) override {
    Y rates;
    if (!run_.flow().rate(copy(y), rates)) return false;
    std::copy(rates.begin(), rates.end(), dy);
    return true;
  }

  bool residual(const double* y, const double* dy, double* r) override {
    F& flow = run_.flow();
    const Control& control = flow.control();
    const Y state = copy(y);
    Sym<double, 6> D = control.prescribed();
    for (int j = 0; j < algebraic_; ++j) D = D + y[n + j] * control.direction(j);
    Y rates;
    if (!flow.rate_of(state, D, rates)) return false;
    for (int i = 0; i < n; ++i) r[i] = dy[i] - rates[static_cast<std::size_t>(i)];
    for (int j = 0; j < algebraic_; ++j) {
      const Control::StressRow& row = control.stress_row(j);
      double sum = -row.rate;
      double scale = 0.0;
      for (std::size_t i = 0; i < 6; ++i) {
        sum += row.strain[i] * D.c[i] + row.stress[i] * rates[i];
        scale = std::max(scale, std::abs(row.stress[i]));
      }
      r[n + j] = sum / (scale * stiffness_);
    }
    return true;
  }

  /// Consistent derivatives, and z from D, at a start. False if there are none.
  bool consistent(const Y& y, std::vector<double>& extended, std::vector<double>& rates) {
    extended.assign(static_cast<std::size_t>(size()), 0.0);
    rates.assign(static_cast<std::size_t>(size()), 0.0);
    Y dy;
    if (!run_.flow().rate(y, dy)) return false;
    std::copy(y.begin(), y.end(), extended.begin());
    std::copy(dy.begin(), dy.end(), rates.begin());
    if (algebraic_ == 0) return true;
    const Control& control = run_.flow().control();
    double K = 0.0, two_G = 0.0;
    run_.flow().elastic_moduli(y, run_.flow().density(y), K, two_G);
    stiffness_ = K > 0.0 ? K : 1.0;
    for (int j = 0; j < algebraic_; ++j)
      extended[static_cast<std::size_t>(n + j)] =
          dy[F::i_strain + static_cast<std::size_t>(control.free_component(j))];
    rate_size_ = 1e-300;
    for (std::size_t i = 0; i < 6; ++i)
      rate_size_ = std::max(rate_size_, std::abs(dy[F::i_strain + i]));
    return true;
  }

  void sizes(const double* y, double* size) const override {
    const double p = std::max(std::abs(y[0] + y[1] + y[2]) / 3.0, 1e-300);
    double strain = 1e-3;
    for (std::size_t i = 0; i < 6; ++i) strain = std::max(strain, std::abs(y[F::i_strain + i]));
    for (std::size_t i = 0; i < 6; ++i) {
      size[i] = p;
      size[F::i_strain + i] = strain;
    }
    for (std::size_t i = 0; i < F::m; ++i) size[6 + i] = std::max(std::abs(y[6 + i]), 1e-9 * p);
    for (std::size_t i = F::i_work; i < F::size; ++i) size[i] = p * strain;
    double rate = rate_size_;
    for (int j = 0; j < algebraic_; ++j) rate = std::max(rate, std::abs(y[n + j]));
    for (int j = 0; j < algebraic_; ++j) size[n + j] = rate;
  }

  bool events(double t, const double* y, double* g) override {
    const Y state = copy(y);
    Y dy{};
    for (int i = 0; i < run_.event_count(); ++i) {
      const Event& e = run_.event(i);
      if (e.kind != EventKind::branch) {
        g[i] = e.sign == 0.0 ? -1.0 : run_.event_value(i, state, t);
        continue;
      }
      g[i] = -1.0;
      if (run_.flow().branch == Branch::plastic && !run_.flow().rate(state, dy)) continue;
      const double branch = run_.branch_value(state, dy);
      if (std::isfinite(branch)) g[i] = branch;
    }
    return true;
  }

  static Y copy(const double* y) {
    Y r;
    std::copy(y, y + n, r.begin());
    return r;
  }

 private:
  LegRun<L, double>& run_;
  int algebraic_;
  double rate_size_ = 1e-300;  ///< of the strain rates at the start
  double stiffness_ = 1.0;     ///< brings the algebraic rows to the size of strain rates
};

template <class L>
class SundialsDrive {
 public:
  using F = Flow<L, double>;
  using Y = typename F::Y;
  using Run = LegRun<L, double>;

  SundialsDrive(const Settings& settings, Counts& counts, Method method)
      : settings_(settings),
        counts_(counts),
        method_(method) {}

  LegEnd<double> drive(Run& run, Y& y) {
    F& flow = run.flow();
    if (const Status s = run.decide_branch(y); s != Status::completed) return {s, 0.0, -1};
    flow.return_to_surface(y);
    LegSystem<L> system(run, method_ == Method::ida);
    const auto solver = make_solver(method_, system, settings_.tolerance, settings_.max_steps,
                                    is_rate_dependent<L>());
    const LegEnd<double> end = advance(run, system, *solver, y);
    counts_.steps += solver->steps();
    counts_.rates += solver->evaluations();
    return end;
  }

 private:
  static constexpr int max_events_per_leg = 1000;

  LegEnd<double> advance(Run& run, LegSystem<L>& system, SundialsSolver& solver, Y& y) {
    std::vector<double> x, dx;
    double t = 0.0;
    const double end = run.duration();
    if (!system.consistent(y, x, dx)) return {Status::beyond_limit, t, -1};
    solver.start(t, end, x.data(), dx.data());
    bool armed = false;
    for (int events = 0; events <= max_events_per_leg;) {
      const double target = run.rows_left() > 1 ? run.next_row_time() : end;
      if (target <= t * (1.0 + 1e-15) && target < end) {  // a row right at an event
        run.write_row(y, target);
        continue;
      }
      const double before = t;
      const Advance got = solver.advance(target, t, x.data());
      y = LegSystem<L>::copy(x.data());
      if (!armed) run.arm(y, t);
      armed = true;
      for (std::size_t i = 0; i < 6; ++i)
        if (!(std::abs(y[F::i_strain + i]) < settings_.max_strain))
          return {Status::beyond_limit, t, -1};
      switch (got.kind) {
        case Advance::Kind::reached:
          if (run.rows_left() > 0) run.write_row(y, target);
          if (target == end)
            return {run.goal_is_event() ? Status::goal_not_met : Status::completed, end, -1};
          continue;
        case Advance::Kind::step_limit:
          return {Status::step_limit, t, -1};
        case Advance::Kind::underflow:
          return {Status::step_underflow, t, -1};
        case Advance::Kind::no_convergence:
          return {Status::not_converged, t, -1};
        case Advance::Kind::no_rate:
          return {Status::beyond_limit, t, -1};
        case Advance::Kind::event:
          break;
      }
      ++counts_.events;
      ++events;
      if (got.event < 0) return {Status::not_converged, before, -1};
      switch (run.event(got.event).kind) {
        case EventKind::contact:
          return {Status::separated, t, -1};
        case EventKind::stop:
          return {Status::stopped, t, run.event(got.event).index};
        case EventKind::goal:
          return {Status::completed, t, -1};
        case EventKind::branch:
          break;
      }
      if (const Status s = run.change_branch(y); s != Status::completed) return {s, t, -1};
      if (!(end - t > 1e-14 * end)) {
        if (run.rows_left() > 0) run.write_row(y, end);
        return {run.goal_is_event() ? Status::goal_not_met : Status::completed, end, -1};
      }
      if (!system.consistent(y, x, dx)) return {Status::beyond_limit, t, -1};
      solver.start(t, end, x.data(), dx.data());
    }
    return {Status::step_limit, t, -1};
  }

  const Settings& settings_;
  Counts& counts_;
  Method method_;
};

}  // namespace repose::point
