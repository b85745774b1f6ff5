#pragma once
/// \file
/// `adaptive`: Dormand & Prince 5(4) on the elastoplastic rate (J. Comput. Appl. Math. 6, 1980),
/// continuous extension of order 4 (Hairer, Nørsett & Wanner, Solving ODEs I, II.6) for rows and
/// events. Every change of branch and every end is located and stepped to; the drift from the yield
/// surface is removed through the hardening variable, so that the prescribed stresses stay as they
/// are (Runge-Kutta methods keep linear constraints to round-off).
///
/// With T a dual number the steps are chosen by values and the event times carry derivatives, so
/// the kink at yield is differentiated too.

#include "pointdriver/integrate/bracketed_zero.hpp"
#include "pointdriver/integrate/leg_run.hpp"
#include "pointdriver/path/settings.hpp"

namespace repose::point {

template <class L, class T>
class Adaptive {
 public:
  using F = Flow<L, T>;
  using Y = typename F::Y;
  using Run = LegRun<L, T>;
  static constexpr std::size_t n = F::size;

  Adaptive(const Settings& settings, Counts& counts) : settings_(settings), counts_(counts) {}

  /// Drives the leg from y, which ends as the state where the leg ended.
  LegEnd<T> drive(Run& run, Y& y) {
    F& flow = run.flow();
    T t(0.0);
    if (const Status s = run.decide_branch(y); s != Status::completed) return {s, t, -1};
    if (flow.branch == Branch::plastic) flow.return_to_surface(y);
    if (!flow.rate(y, k_[0])) return {Status::beyond_limit, t, -1};
    double h = first_step(run, y);
    double error_before = 1e-4;
    int events = 0;
    bool rejected_before = false;
    for (long step = 0;; ++step) {
      if (step >= settings_.max_steps) return {Status::step_limit, t, -1};
      const T remaining = run.duration() - t;
      const double left = value(remaining);
      if (!(left > 0.0)) break;
      if (h < 1e-14 * std::abs(value(run.duration()))) return {Status::step_underflow, t, -1};
      const bool last = h >= left * (1.0 - 1e-9);
      // a step is taken with a plain number; only one that ends at a time with derivatives needs T
      const double error = last ? attempt(flow, y, remaining) : attempt(flow, y, T_or(h));
      if (!(error <= 1.0)) {
        ++counts_.rejected;
        h = (last ? left : h) * (std::isfinite(error) ? shrink(error) : 0.2);
        rejected_before = true;
        continue;
      }
      T taken = last ? remaining : T(h);
      const Located found = first_event(run, y, t, taken);
      if (found.event >= 0) {
        ++counts_.events;
        if (++events > max_events_per_leg) return {Status::step_limit, t, -1};
        taken = step_to(run, y, t, found, value(taken));
      }
      write_rows(run, y, t, taken, found.event < 0 && last);
      t = found.event < 0 && last ? run.duration() : t + taken;
      y = next_;
      std::swap(k_[0], k_[6]);  // first same as last
      ++counts_.steps;
      if (found.event >= 0) {
        switch (run.event(found.event).kind) {
          case EventKind::contact:
            return {Status::separated, t, -1};
          case EventKind::stop:
            return {Status::stopped, t, run.event(found.event).index};
          case EventKind::goal:
            return {Status::completed, t, -1};
          case EventKind::branch:
            if (const Status s = run.change_branch(y); s != Status::completed) return {s, t, -1};
            if (!flow.rate(y, k_[0])) return {Status::beyond_limit, t, -1};
            h = std::min(h, left);
            continue;
        }
      }
      if (flow.branch == Branch::plastic) flow.return_to_surface(y);
      run.arm(y, t);
      if (excessive(y)) return {Status::beyond_limit, t, -1};
      if (!last) {
        // PI controller (Gustafsson), β = 0.04
        const double e = std::max(error, 1e-8);
        double factor = 0.9 * std::pow(e, -0.17) * std::pow(error_before, 0.04);
        factor = std::min(rejected_before ? 1.0 : 8.0, std::max(0.2, factor));
        error_before = std::max(error, 1e-4);
        h *= factor;
        rejected_before = false;
      }
    }
    if (run.goal_is_event()) return {Status::goal_not_met, t, -1};
    return {Status::completed, t, -1};
  }

 private:
  static constexpr int max_events_per_leg = 1000;
  struct Located {
    int event = -1;
    double theta = 1.0;
  };

  static double T_or(double h) { return h; }
  static double shrink(double error) { return std::max(0.2, 0.9 * std::pow(error, -0.2)); }

  // Dormand & Prince (1980), table 2
  static constexpr double a21 = 1.0 / 5.0;
  static constexpr double a31 = 3.0 / 40.0, a32 = 9.0 / 40.0;
  static constexpr double a41 = 44.0 / 45.0, a42 = -56.0 / 15.0, a43 = 32.0 / 9.0;
  static constexpr double a51 = 19372.0 / 6561.0, a52 = -25360.0 / 2187.0, a53 = 64448.0 / 6561.0,
                          a54 = -212.0 / 729.0;
  static constexpr double a61 = 9017.0 / 3168.0, a62 = -355.0 / 33.0, a63 = 46732.0 / 5247.0,
                          a64 = 49.0 / 176.0, a65 = -5103.0 / 18656.0;
  static constexpr double b1 = 35.0 / 384.0, b3 = 500.0 / 1113.0, b4 = 125.0 / 192.0,
                          b5 = -2187.0 / 6784.0, b6 = 11.0 / 84.0;
  static constexpr double e1 = 71.0 / 57600.0, e3 = -71.0 / 16695.0, e4 = 71.0 / 1920.0,
                          e5 = -17253.0 / 339200.0, e6 = 22.0 / 525.0, e7 = -1.0 / 40.0;
  // continuous extension, Hairer et al. (dopri5)
  static constexpr double d1 = -12715105075.0 / 11282082432.0, d3 = 87487479700.0 / 32700410799.0,
                          d4 = -10690763975.0 / 1880347072.0, d5 = 701980252875.0 / 199316789632.0,
                          d6 = -1453857185.0 / 822651844.0, d7 = 69997945.0 / 29380423.0;

  /// One step of h from y (k_[0] holds its rate) to next_ with rate k_[6]. Returns the error over
  /// the tolerance, or NaN if the law gave no number on the way.
  template <class H>
  double attempt(F& flow, const Y& y, const H& h) {
    const double bad = std::numeric_limits<double>::quiet_NaN();
    Y s;
    for (std::size_t i = 0; i < n; ++i) s[i] = y[i] + h * (a21 * k_[0][i]);
    if (!flow.rate(s, k_[1])) return bad;
    for (std::size_t i = 0; i < n; ++i) s[i] = y[i] + h * (a31 * k_[0][i] + a32 * k_[1][i]);
    if (!flow.rate(s, k_[2])) return bad;
    for (std::size_t i = 0; i < n; ++i)
      s[i] = y[i] + h * (a41 * k_[0][i] + a42 * k_[1][i] + a43 * k_[2][i]);
    if (!flow.rate(s, k_[3])) return bad;
    for (std::size_t i = 0; i < n; ++i)
      s[i] = y[i] + h * (a51 * k_[0][i] + a52 * k_[1][i] + a53 * k_[2][i] + a54 * k_[3][i]);
    if (!flow.rate(s, k_[4])) return bad;
    for (std::size_t i = 0; i < n; ++i)
      s[i] = y[i] + h * (a61 * k_[0][i] + a62 * k_[1][i] + a63 * k_[2][i] + a64 * k_[3][i] +
                         a65 * k_[4][i]);
    if (!flow.rate(s, k_[5])) return bad;
    for (std::size_t i = 0; i < n; ++i)
      next_[i] = y[i] + h * (b1 * k_[0][i] + b3 * k_[2][i] + b4 * k_[3][i] + b5 * k_[4][i] +
                             b6 * k_[5][i]);
    if (!flow.rate(next_, k_[6])) return bad;
    counts_.rates += 6;
    return error_size(y, value(h));
  }

  double error_size(const Y& y, double h) const {
    const auto e = [&](std::size_t i) {
      return h * (e1 * value(k_[0][i]) + e3 * value(k_[2][i]) + e4 * value(k_[3][i]) +
                  e5 * value(k_[4][i]) + e6 * value(k_[5][i]) + e7 * value(k_[6][i]));
    };
    const double stress_size = std::max(F::stress_scale(next_), 1e-300);
    double worst = 0.0;
    double strain_size = 1e-3;  // strains below 0.1 % are resolved to tol × 0.1 %
    for (std::size_t i = 0; i < 6; ++i)
      strain_size = std::max(strain_size, std::abs(value(next_[F::i_strain + i])));
    for (std::size_t i = 0; i < 6; ++i) {
      worst = larger(worst, std::abs(e(i)) / stress_size);
      worst = larger(worst, std::abs(e(F::i_strain + i)) / strain_size);
    }
    for (std::size_t i = 0; i < F::m; ++i) {
      const double size = std::abs(value(next_[6 + i]));
      if (size > 0.0) worst = larger(worst, std::abs(e(6 + i)) / size);
    }
    (void)y;
    return worst / settings_.tolerance;
  }
  /// max that lets a NaN through
  static double larger(double a, double b) { return b <= a ? a : b; }

  double first_step(const Run& run, const Y& y) const {
    // a tenth of the distance over which the state doubles, by the first rate
    double rate = 0.0;
    const double p = std::max(F::stress_scale(y), 1e-300);
    for (std::size_t i = 0; i < 6; ++i) {
      rate = std::max(rate, std::abs(value(k_[0][i])) / p);
      rate = std::max(rate, std::abs(value(k_[0][F::i_strain + i])) * 10.0);
    }
    const double whole = value(run.duration());
    if (!(rate > 0.0)) return whole;
    return std::min(whole, 0.1 * std::pow(settings_.tolerance / 1e-6, 0.2) / rate);
  }

  /// y(t + θh) of the step just taken; θ may be a dual number.
  template <class S>
  Y dense(const Y& y, const T& h, const S& theta) const {
    const S one_minus = S(1.0) - theta;
    Y r;
    for (std::size_t i = 0; i < n; ++i) {
      const T difference = next_[i] - y[i];
      const T bulge = h * k_[0][i] - difference;
      r[i] = y[i] +
             theta * (difference + one_minus * (bulge + theta * (difference - h * k_[6][i] - bulge +
                                                                 one_minus * (h * fifth_[i]))));
    }
    return r;
  }
  void prepare_dense() {
    for (std::size_t i = 0; i < n; ++i)
      fifth_[i] = d1 * k_[0][i] + d3 * k_[2][i] + d4 * k_[3][i] + d5 * k_[4][i] + d6 * k_[5][i] +
                  d7 * k_[6][i];
  }

  double probe(Run& run, int event, const Y& y, const Y& dy, const T& t) const {
    return run.event(event).kind == EventKind::branch ? run.branch_value(y, dy)
                                                      : value(run.event_value(event, y, t));
  }

  /// The earliest event inside the step just taken (θ in (0, 1]), by its sign at the end, and for
  /// yield also half way, where a path may cut a corner of the surface.
  Located first_event(Run& run, const Y& y, const T& t, const T& h) {
    Located found;
    bool prepared = false;
    for (int i = 0; i < run.event_count(); ++i) {
      if (run.event(i).sign == 0.0) continue;
      double high = 1.0;
      double end = probe(run, i, next_, k_[6], t + h);
      const bool yields =
          run.event(i).kind == EventKind::branch && run.flow().branch == Branch::elastic;
      const double scale = yields ? F::stress_scale(next_) : 0.0;
      if (yields && !(end > 1e-13 * scale) && L::has_stress_memory) {
        if (!prepared) prepare_dense();
        prepared = true;
        end = probe(run, i, dense(y, h, 0.5), k_[6], t + 0.5 * h);
        high = 0.5;
      }
      if (!(end > 1e-13 * scale)) continue;
      if (!prepared) prepare_dense();
      prepared = true;
      const double theta = locate(run, i, y, t, h, high, end);
      if (found.event < 0 || theta < found.theta) found = {i, theta};
    }
    return found;
  }

  /// Root of the event on the continuous extension, on its far side.
  double locate(Run& run, int event, const Y& y, const T& t, const T& h, double high,
                double g_high) {
    // it may start on its boundary and leave it
    const double g_low = std::min(probe(run, event, y, k_[0], t), -1e-300);
    const bool needs_rate =
        run.event(event).kind == EventKind::branch && run.flow().branch == Branch::plastic;
    Y dy = k_[6];
    Bracket found{0.0, high, g_low, g_high};
    narrow(found, 1e-14, [&](double theta, bool& ok) {
      const Y here = dense(y, h, theta);
      ok = !needs_rate || run.flow().rate(here, dy);
      return ok ? probe(run, event, here, dy, t + theta * h) : 0.0;
    });
    return found.g_before == 0.0 ? found.before : found.after;
  }

  /// Repeats the step so that it ends at the event, to the method's order and with the derivative
  /// of the event's time: h* = h − g/ġ, Newton on steps of full order. Returns the step in T.
  T step_to(Run& run, const Y& y, const T& t, const Located& found, double h) {
    double target = found.theta * h;
    const Event& event = run.event(found.event);
    if (event.kind == EventKind::branch && run.flow().branch == Branch::plastic) {
      attempt(run.flow(), y, T_or(target));  // unloading: rates are continuous, the time is free
      return T(target);
    }
    const auto g = [&](const Y& at, const T& dt) {
      return event.kind == EventKind::branch ? run.flow().yield(at)
                                             : run.event_value(found.event, at, t + dt);
    };
    T step(target);
    for (int i = 0; i < 4; ++i) {
      if (std::isnan(attempt(run.flow(), y, T_or(target)))) break;
      const T here = g(next_, T(target));
      const double slope = slope_along(g, T(target));
      if (!(std::abs(slope) > 0.0)) break;
      step = T(target) - here / T(slope);
      const double move = value(step) - target;
      if (!(value(step) > 0.0) || std::abs(move) > 0.1 * h) {
        step = T(target);
        break;
      }
      target = value(step);
      if (std::abs(move) < 1e-15 * h) break;
    }
    attempt(run.flow(), y, step);
    return step;
  }
  template <class G>
  double slope_along(const G& g, const T& dt) const {
    double size = 0.0;
    for (std::size_t i = 0; i < 6; ++i) size = std::max(size, std::abs(value(k_[6][i])));
    for (std::size_t i = 0; i < 6; ++i)
      size = std::max(size, std::abs(value(k_[6][F::i_strain + i])) * F::stress_scale(next_));
    if (!(size > 0.0)) return 0.0;
    const double delta = 1e-5 * F::stress_scale(next_) / size;
    Y ahead = next_, behind = next_;
    for (std::size_t i = 0; i < n; ++i) {
      ahead[i] = ahead[i] + delta * k_[6][i];
      behind[i] = behind[i] - delta * k_[6][i];
    }
    return value(T(g(ahead, dt + T(delta)) - g(behind, dt - T(delta)))) / (2.0 * delta);
  }

  bool excessive(const Y& y) const {
    for (std::size_t i = 0; i < 6; ++i)
      if (!(std::abs(value(y[F::i_strain + i])) < settings_.max_strain)) return true;
    return false;
  }

  void write_rows(Run& run, const Y& y, const T& t, const T& h, bool reaches_end) {
    bool prepared = false;
    const double end = value(t) + value(h);
    while (run.rows_left() > 0) {
      if (run.rows_left() == 1) {
        if (reaches_end) run.write_row(next_, run.duration());
        return;
      }
      const T at = run.next_row_time();
      if (!(value(at) <= end)) return;
      if (!prepared) prepare_dense();
      prepared = true;
      run.write_row(dense(y, h, T((at - t) / h)), at);
    }
  }

  const Settings& settings_;
  Counts& counts_;
  std::array<Y, 7> k_;
  Y next_{};
  Y fifth_{};
};

}  // namespace repose::point
