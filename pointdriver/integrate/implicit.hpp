#pragma once
/// \file
/// `implicit`: the law's own stress update (the one the Material Point Method uses), first order in
/// the step. The unknown strain increments of a mixed control are found by Newton's method with the
/// update's consistent tangent, which dual numbers give exactly; a step that does not converge is
/// halved. The prescription is met against the leg's start, so nothing accumulates.
///
/// The only method for laws whose stress follows the strain rate at once (has_stress_memory ==
/// false): there the update is algebraic in D and ρ.

#include <optional>

#include "pointdriver/integrate/bracketed_zero.hpp"
#include "pointdriver/integrate/leg_run.hpp"
#include "pointdriver/path/settings.hpp"

namespace repose::point {

/// How well the stress rows are met, relative: Newton goes on to `goal`, and takes what is no
/// larger than `enough` where round-off, or the noise of an update that cuts its own steps, lets it
/// come no closer. A law may have its own: `control_goal`, `control_enough`.
template <class L>
struct ControlTolerance {
  static constexpr double goal = [] {
    if constexpr (requires { L::control_goal; })
      return L::control_goal;
    else
      return 1e-15;
  }();
  static constexpr double enough = [] {
    if constexpr (requires { L::control_enough; })
      return L::control_enough;
    else
      return 1e-12;
  }();
};

template <class L, class T>
class Implicit {
 public:
  using F = Flow<L, T>;
  using Y = typename F::Y;
  using Run = LegRun<L, T>;
  static constexpr std::size_t m = F::m;

  Implicit(const Settings& settings, Counts& counts) : settings_(settings), counts_(counts) {}

  LegEnd<T> drive(Run& run, Y& y) {
    T t(0.0);
    if constexpr (may_break) L::begin_leg(run.flow().parameters());
    const int points = run.spec().points;
    const int count = points * std::max(1, settings_.substeps);
    const double nominal = value(run.duration()) / count;
    if (const Status s = first_guess(run, y); s != Status::completed) return {s, t, -1};
    for (int i = 1; i <= count; ++i) {
      const T target =
          i == count ? run.duration() : (static_cast<double>(i) / count) * run.duration();
      T dt = target - t;
      for (int cut = 0;;) {
        if (!(value(dt) > 0.0)) break;
        if (counts_.steps >= settings_.max_steps) return {Status::step_limit, t, -1};
        bool converged = step(run, y, t, dt);
        if (const int e = converged ? crossed(run, t + dt) : -1; e >= 0) {
          if (const std::optional<LegEnd<T>> end = end_at(run, y, t, dt, e)) {
            ++counts_.events;
            return *end;
          }
          converged = false;  // somewhere on the way to the event
        }
        if constexpr (may_break)
          if (!converged && L::broken(run.flow().parameters())) return {Status::law_failed, t, -1};
        if (!converged) {
          ++counts_.rejected;
          if (++cut > 30) return {Status::not_converged, t, -1};
          dt = T(0.5 * value(dt));
          guess_ = first_guess_;
          continue;
        }
        y = next_;
        t = t + dt;
        ++counts_.steps;
        if (value(target) - value(t) <= 1e-9 * nominal) {
          t = target;
          break;
        }
        dt = target - t;
        if (cut > 0) dt = T(std::min(value(dt), nominal * std::ldexp(1.0, -cut)));
        if (value(target) - value(t) - value(dt) <= 1e-9 * nominal) dt = target - t;
      }
      run.arm(y, t);
      if (i % std::max(1, settings_.substeps) == 0 && run.rows_left() > 0) run.write_row(y, t);
      for (std::size_t c = 0; c < 6; ++c)
        if (!(std::abs(value(y[F::i_strain + c])) < settings_.max_strain))
          return {Status::beyond_limit, t, -1};
    }
    if (run.goal_is_event()) return {Status::goal_not_met, t, -1};
    return {Status::completed, t, -1};
  }

 private:
  using Unknowns = std::array<double, 6>;
  /// A law whose update may break down for good, where no smaller step helps (a foreign one).
  static constexpr bool may_break = requires(const typename L::template Params<T>& P) {
    L::broken(P);
  };

  /// Newton starts from the rates at the leg's start (a law at rest has no tangent: it keeps its
  /// stress); later from those of the step before.
  Status first_guess(Run& run, const Y& y) {
    F& flow = run.flow();
    const Control& control = flow.control();
    first_guess_ = {};
    for (int j = 0; j < control.unknowns(); ++j)  // anything but rest
      first_guess_[at(j)] = 1e-9 / value(run.duration());
    if constexpr (L::has_stress_memory) {
      if (const Status s = run.decide_branch(y); s != Status::completed) return s;
      Sym<T, 6> D, stress_rate;
      typename F::State state_rate{};
      if (flow.respond(y, flow.branch, D, stress_rate, state_rate))
        for (int j = 0; j < control.unknowns(); ++j)
          if (const double z = value(D[control.free_component(j)]); std::isfinite(z) && z != 0.0)
            first_guess_[at(j)] = z;
    }
    flow.branch = Branch::plastic;
    guess_ = first_guess_;
    return Status::completed;
  }

  /// One update from y over dt to next_, with the control met at t + dt. False: no convergence.
  bool step(Run& run, const Y& y, const T& t, const T& dt) {
    const Control& control = run.flow().control();
    const int k = control.unknowns();
    Unknowns zeta{};
    std::array<T, 6> zeta_T{};
    if (k > 0) {
      bool solved = false;
      if (k == 1)
        solved = solve<1>(run, y, value(t), value(dt), zeta);
      else if (k == 2)
        solved = solve<2>(run, y, value(t), value(dt), zeta);
      else
        solved = solve<6>(run, y, value(t), value(dt), zeta);
      if (!solved) return false;
      for (int j = 0; j < k; ++j) {
        guess_[at(j)] = zeta[at(j)] / value(dt);
        zeta_T[at(j)] = T(zeta[at(j)]);
      }
    }
    if constexpr (!std::is_same_v<T, double>) {
      if (k > 0) {  // the converged root differentiated: one more Newton step in T
        if (!apply(run.flow(), run.flow().parameters(), y, dt, zeta_T, next_)) return false;
        std::array<T, 6> r{};
        residual(run, next_, t + dt, r);
        for (int j = 0; j < k; ++j) r[at(j)] = r[at(j)] - T(value(r[at(j)]));
        std::array<std::array<T, 6>, 6> J;
        for (int i = 0; i < k; ++i)
          for (int j = 0; j < k; ++j) J[at(i)][at(j)] = T(jacobian_[at(i)][at(j)]);
        if (!solve_small(k, J, r)) return false;
        for (int j = 0; j < k; ++j) zeta_T[at(j)] = zeta_T[at(j)] - r[at(j)];
      }
    }
    StepWork<T> spent;
    if (!apply(run.flow(), run.flow().parameters(), y, dt, zeta_T, next_, &spent)) return false;
    if (run.flow().energy()) account(run.flow(), y, spent, next_);
    Sym<T, 6> D;
    for (std::size_t i = 0; i < 6; ++i) D.c[i] = (next_[F::i_strain + i] - y[F::i_strain + i]) / dt;
    run.note_rate(D);
    return true;
  }

  /// Newton on the k stress rows in plain numbers; jacobian_ holds ∂r/∂ζ at the root.
  template <int K>
  bool solve(Run& run, const Y& y, double t, double dt, Unknowns& zeta) {
    using D = Dual<K>;
    const Control& control = run.flow().control();
    const int k = control.unknowns();
    for (int j = 0; j < k; ++j) zeta[at(j)] = guess_[at(j)] * dt;
    const typename L::template Params<D> P = lifted<D>(run.flow().plain());
    typename Flow<L, D>::Y start, end;
    for (std::size_t i = 0; i < F::size; ++i) start[i] = D(value(y[i]));
    double best = std::numeric_limits<double>::infinity();
    Unknowns last{}, move{};
    int halvings = 0;
    for (int iteration = 0; iteration < 60; ++iteration) {
      std::array<D, 6> unknown{};
      for (int j = 0; j < k; ++j) unknown[at(j)] = D(zeta[at(j)], j);
      std::array<D, 6> r{};
      double size = std::numeric_limits<double>::infinity();
      if (apply(run.flow(), P, start, D(dt), unknown, end)) {
        residual(run, end, D(t + dt), r);
        size = 0.0;
        for (int i = 0; i < k; ++i) {
          const double x = std::abs(r[at(i)].a);
          if (!(x <= size)) size = x;
        }
      }
      if (!(size < best) && iteration > 0) {
        if (best < ControlTolerance<L>::enough) {  // round-off reached one step before
          zeta = last;
          return true;
        }
        if (++halvings > 25) return false;
        for (int j = 0; j < k; ++j) {
          move[at(j)] *= 0.5;
          zeta[at(j)] = last[at(j)] - move[at(j)];
        }
        continue;
      }
      if (!std::isfinite(size)) return false;
      best = size;
      last = zeta;
      halvings = 0;
      Unknowns step{};
      std::array<std::array<double, 6>, 6> J{};
      for (int i = 0; i < k; ++i) {
        step[at(i)] = r[at(i)].a;
        for (int j = 0; j < k; ++j) J[at(i)][at(j)] = r[at(i)].v[j];
      }
      jacobian_ = J;
      if (size < ControlTolerance<L>::goal) return true;
      if (!solve_small(k, J, step)) return false;
      move = step;
      for (int j = 0; j < k; ++j) zeta[at(j)] -= move[at(j)];
    }
    return best < ControlTolerance<L>::enough;
  }

  /// The update over D_p dt + Σ ζ_j N_j, in any scalar.
  template <class S>
  static bool apply(const F& flow, const typename L::template Params<S>& P,
                    const typename Flow<L, S>::Y& y, const S& dt, const std::array<S, 6>& zeta,
                    typename Flow<L, S>::Y& next, StepWork<S>* spent = nullptr) {
    using std::exp;
    const Control& control = flow.control();
    Increment<S, 6> inc;
    inc.dt = dt;
    for (std::size_t i = 0; i < 6; ++i) inc.strain.c[i] = control.prescribed().c[i] * dt;
    for (int j = 0; j < control.unknowns(); ++j)
      for (std::size_t i = 0; i < 6; ++i)
        if (const double N = control.direction(j).c[i]; N != 0.0)
          inc.strain.c[i] = inc.strain.c[i] + N * zeta[at(j)];
    next = y;
    for (std::size_t i = 0; i < 6; ++i)
      next[F::i_strain + i] = y[F::i_strain + i] + inc.strain.c[i];
    S rho_0;
    if constexpr (std::is_same_v<S, T>)
      rho_0 = flow.density_0();
    else
      rho_0 = S(value(flow.density_0()));
    inc.density = rho_0 * exp(-(next[F::i_strain] + next[F::i_strain + 1] + next[F::i_strain + 2]));
    Sym<S, 6> stress = Flow<L, S>::stress(y);
    auto state = Flow<L, S>::state(y);
    if (L::update(P, inc, stress, state, spent)) return false;
    for (std::size_t i = 0; i < 6; ++i) next[i] = stress.c[i];
    for (std::size_t i = 0; i < m; ++i) next[6 + i] = state[i];
    return true;
  }

  /// Residual of the stress rows against the leg's start, each over the stress (strain) it is made
  /// of.
  template <class S>
  static void residual(const Run& run, const typename Flow<L, S>::Y& y, const S& t,
                       std::array<S, 6>& r) {
    const Control& control = run.flow_const().control();
    const Y& start = run.start();
    double stress_size = 1e-300;
    for (std::size_t i = 0; i < 6; ++i)
      stress_size = std::max({stress_size, std::abs(value(y[i])), std::abs(value(start[i]))});
    for (int j = 0; j < control.unknowns(); ++j) {
      const Control::StressRow& row = control.stress_row(j);
      S sum = -row.rate * t;
      double scale = 0.0;
      for (std::size_t i = 0; i < 6; ++i) {
        if (row.stress[i] != 0.0) {
          sum = sum + row.stress[i] * (y[i] - in<S>(start[i]));
          scale = std::max(scale, std::abs(row.stress[i]) * stress_size);
        }
        if (row.strain[i] != 0.0) {
          sum = sum + row.strain[i] * (y[F::i_strain + i] - in<S>(start[F::i_strain + i]));
          scale = std::max(scale, std::abs(row.strain[i] * value(y[F::i_strain + i])));
        }
      }
      r[at(j)] = sum / scale;
    }
  }
  template <class S>
  static S in(const T& x) {
    if constexpr (std::is_same_v<S, T>)
      return x;
    else
      return S(value(x));
  }

  /// Parameters as constants of another scalar type.
  template <class S>
  static typename L::template Params<S> lifted(const typename L::template Params<double>& P) {
    if constexpr (requires { L::template lifted<S>(P); }) {
      return L::template lifted<S>(P);
    } else {
      constexpr std::size_t count = sizeof(P) / sizeof(double);
      static_assert(count == L::parameters.size(),
                    "Params<T> holds the parameters and nothing else");
      const auto plain = std::bit_cast<std::array<double, count>>(P);
      std::array<S, count> wide;
      for (std::size_t i = 0; i < count; ++i) wide[i] = S(plain[i]);
      return L::template Params<S>::from(std::span<const S>(wide));
    }
  }

  /// Work by the trapezoidal rule, and what the law's update says of it, over the volume half way.
  static void account(const F& flow, const Y& y, const StepWork<T>& spent, Y& next) {
    Y middle;
    for (std::size_t i = 0; i < F::size; ++i) middle[i] = 0.5 * (y[i] + next[i]);
    const T J = flow.density_0() / flow.density(middle);
    const Sym<T, 6> strain = F::strain(next) - F::strain(y);
    next[F::i_work] = y[F::i_work] + J * contract(F::stress(middle), strain);
    next[F::i_work + 1] = y[F::i_work + 1] + J * (spent.plastic + spent.viscous);
    next[F::i_work + 2] = y[F::i_work + 2] + J * spent.hypoelastic;
  }

  /// The first event (in table order) that has happened at next_; the branch is the update's own
  /// business.
  int crossed(const Run& run, const T& t) const {
    for (int i = 0; i < run.event_count(); ++i) {
      const Event& e = run.event(i);
      if (e.kind == EventKind::branch || e.sign == 0.0) continue;
      if (e.kind == EventKind::contact && !L::has_stress_memory) continue;
      if (value(run.event_value(i, next_, t)) > 0.0) return i;
    }
    return -1;
  }

  /// Shortens the step until it ends at event e, on its near side; nothing where an update on the
  /// way does not converge.
  std::optional<LegEnd<T>> end_at(Run& run, Y& y, const T& t, const T& whole, int e) {
    const auto g = [&](double dt, bool& ok) {
      ok = step(run, y, t, T(dt));
      return ok ? value(run.event_value(e, next_, t + T(dt))) : 0.0;
    };
    // it may start on its value and leave it
    const double at_start = std::min(value(run.event_value(e, y, t)), -1e-300);
    Bracket found{0.0, value(whole), at_start, value(run.event_value(e, next_, t + whole))};
    if (!narrow(found, 1e-13 * value(whole), g)) return {};
    T dt(found.before > 0.0 ? found.before : found.after);
    if constexpr (!std::is_same_v<T, double>) {
      // dt = dt − (dg)/ġ for the derivative of the event's time; ġ by central differences, whose
      // error is 1e-12 of it by the step's curvature and 1e-10 by round-off
      const double delta = 1e-6 * value(whole);
      const double ahead = value(dt) + delta, behind = std::max(value(dt) - delta, 0.5 * value(dt));
      bool ok_ahead = true, ok_behind = true;
      const double slope = (g(ahead, ok_ahead) - g(behind, ok_behind)) / (ahead - behind);
      if (!ok_ahead || !ok_behind || !step(run, y, t, dt)) return {};
      if (slope != 0.0) {
        const T here = run.event_value(e, next_, t + dt);
        dt = dt - (here - T(value(here))) / T(slope);
      }
    }
    if (!step(run, y, t, dt)) return {};
    y = next_;
    ++counts_.steps;
    const T end = t + dt;
    switch (run.event(e).kind) {
      case EventKind::contact:
        return LegEnd<T>{Status::separated, end, -1};
      case EventKind::stop:
        return LegEnd<T>{Status::stopped, end, run.event(e).index};
      default:
        return LegEnd<T>{Status::completed, end, -1};
    }
  }

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  const Settings& settings_;
  Counts& counts_;
  Y next_{};
  Unknowns first_guess_{}, guess_{};  // ζ̇ at the leg's start, and of the step before
  std::array<std::array<double, 6>, 6> jacobian_{};
};

}  // namespace repose::point
