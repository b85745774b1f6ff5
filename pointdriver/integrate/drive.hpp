#pragma once
/// \file
/// Drives a law along a whole path with one integrator: leg after leg, rows into a curve.

#include "pointdriver/integrate/adaptive.hpp"
#include "pointdriver/integrate/implicit.hpp"
#include "pointdriver/integrate/sundials_drive.hpp"

namespace repose::point {

/// An element before the first leg.
template <class L, class T>
struct ElementStart {
  typename L::template Params<T> parameters;
  typename L::template Params<double> plain;
  std::array<T, 6 + L::state.size()> stress_and_state{};
  T density{0.0};
};

/// The method that `automatic` stands for.
template <class L>
constexpr Method chosen_method(Method method) {
  if (method == Method::automatic) {
    if (!L::has_stress_memory) return Method::implicit;
    return is_rate_dependent<L>() ? Method::cvode : Method::adaptive;
  }
  if (method == Method::adaptive && !L::has_stress_memory) return Method::implicit;
  return method;
}

template <class L, class T>
Readout<T> make_readout(const ElementStart<L, T>& start, Frame frame) {
  Readout<T> r;
  r.frame = frame;
  if constexpr (requires { start.parameters.rho_p; }) r.rho_p = start.parameters.rho_p;
  if constexpr (requires { start.parameters.d; }) r.d = start.parameters.d;
  find_variables(L::state, derived_fields<L>(), r);
  r.sigma_r_start = T(-0.5) * (start.stress_and_state[0] + start.stress_and_state[2]);
  return r;
}

namespace detail {

/// A leg whose last row is to meet its goal.
template <class T>
struct GridLength {
  T length;
  bool meets_goal;  ///< to round-off; else a leg of this length crosses it in its last step
};

/// The length of a leg whose last row is to meet its goal, when the steps depend on the length: the
/// goal's miss at the end of the leg, driven without rows, is brought to 0 from the time `found`
/// with other steps. (The adaptive methods miss by nothing.) Where a step is cut for convergence
/// the miss may jump over 0. Nothing: no length near `found` was seen to cross the goal.
template <class I, class L, class T>
std::optional<GridLength<T>> length_on_grid(I& integrator, Flow<L, T>& flow,
                                            const Readout<T>& readout, const Path& path, int index,
                                            const T& time, const typename Flow<L, T>::Y& start,
                                            const T& found) {
  if constexpr (!std::is_same_v<I, Implicit<L, T>>) {
    return GridLength<T>{found, true};
  } else {
    const Goal goal = *path.legs[static_cast<std::size_t>(index)].spec().goal;
    const T nan(std::numeric_limits<double>::quiet_NaN());
    LegRun<L, T> at_start(flow, readout, path, index, time, start, nullptr);
    const double begins_at = value(at_start.reached(goal, start, T(0.0)));
    const double sign = begins_at <= goal.value ? 1.0 : -1.0;
    const auto miss = [&](const T& length) {
      typename Flow<L, T>::Y y = start;
      LegRun<L, T> run(flow, readout, path, index, time, start, nullptr);
      run.fix_duration(length);
      const LegEnd<T> end = integrator.drive(run, y);
      return end.status == Status::completed
                 ? T(sign) * (run.reached(goal, y, end.elapsed) - T(goal.value))
                 : nan;
    };
    const auto g = [&](double length, bool&) { return value(miss(T(length))); };
    bool ok = true;
    const double first = value(found), g_first = g(first, ok);
    Bracket b{first, first, g_first, g_first};
    for (double away = 1e-6; away < 0.5 && !(b.g_before <= 0.0 && b.g_after > 0.0); away *= 8.0) {
      if (!(g_first > 0.0)) {
        b.before = b.after;
        b.g_before = b.g_after;
        b.after = first * (1.0 + away);
        b.g_after = g(b.after, ok);
      } else {
        b.after = b.before;
        b.g_after = b.g_before;
        b.before = first * (1.0 - away);
        b.g_before = g(b.before, ok);
      }
      if (std::isnan(b.g_before) || std::isnan(b.g_after)) return {};
    }
    if (!(b.g_before <= 0.0 && b.g_after > 0.0)) return {};
    if (!narrow(b, 1e-15 * first, g)) return {};
    const double length = -b.g_before <= b.g_after ? b.before : b.after;
    const double left = std::min(-b.g_before, b.g_after);
    // 1e-11: round-off of some hundred updates, each met to 1e-12 at worst
    if (!(left <= 1e-11 * std::max(std::abs(goal.value), std::abs(begins_at))))
      return GridLength<T>{T(b.after), false};
    if constexpr (std::is_same_v<T, double>) {
      return GridLength<T>{length, true};
    } else {  // the derivative of the length by that of the miss
      const double delta = 1e-6 * length;
      const double slope = (g(length + delta, ok) - g(length - delta, ok)) / (2.0 * delta);
      const T here = miss(T(length));
      if (!std::isfinite(slope) || slope == 0.0) return {};
      return GridLength<T>{T(length) - (here - T(value(here))) / T(slope), true};
    }
  }
}

/// One leg with the integrator `I`; a goal on the way is first looked for without rows, so that the
/// rows can then be spread evenly.
template <class I, class L, class T>
LegEnd<T> drive_leg(I& integrator, Flow<L, T>& flow, const Readout<T>& readout, const Path& path,
                    int index, const T& time, typename Flow<L, T>::Y& y, std::vector<Row<T>>& rows,
                    double& whole) {
  const LegSpec& spec = path.legs[static_cast<std::size_t>(index)].spec();
  if (spec.goal && spec.goal_is_event && spec.points > 1) {
    typename Flow<L, T>::Y probe = y;
    LegRun<L, T> scout(flow, readout, path, index, time, y, nullptr);
    if (scout.nothing_to_do()) return {};
    whole = value(scout.duration());
    const LegEnd<T> end = integrator.drive(scout, probe);
    if (end.status == Status::completed) {
      const auto grid =
          length_on_grid<I, L, T>(integrator, flow, readout, path, index, time, y, end.elapsed);
      LegRun<L, T> run(flow, readout, path, index, time, y, &rows);
      if (grid && grid->meets_goal) {
        run.fix_duration(grid->length);
        return integrator.drive(run, y);
      }
      // rows as even as may be, and the goal looked for again where they end
      if (grid) run.bound_duration(grid->length);
      const LegEnd<T> last = integrator.drive(run, y);
      run.write_final(y, last.elapsed);
      return last;
    }
  }
  LegRun<L, T> run(flow, readout, path, index, time, y, &rows);
  if (run.nothing_to_do()) return {};
  whole = value(run.duration());
  LegEnd<T> end = integrator.drive(run, y);
  // where a leg broke off, or met its goal on the way: the last row
  if (end.status != Status::completed || run.goal_is_event()) run.write_final(y, end.elapsed);
  return end;
}

template <class I, class L, class T>
Outcome drive_legs(I& integrator, const ElementStart<L, T>& start, const Path& path,
                   const Settings& settings, BasicCurve<T>& curve) {
  using F = Flow<L, T>;
  F flow(start.parameters, start.density, settings.energy);
  flow.set_plain(start.plain);
  typename F::Y y{};
  for (std::size_t i = 0; i < 6 + F::m; ++i) y[i] = start.stress_and_state[i];
  for (std::size_t i = F::i_strain; i < F::size; ++i) y[i] = T(0.0);
  if (settings.energy) flow.stored_at_start = flow.stored_energy(y);
  Readout<T> readout = make_readout(start, path.frame);
  Outcome& outcome = curve.outcome;
  {  // the start itself is the first row
    LegRun<L, T> first(flow, readout, path, 0, T(0.0), y, &curve.rows);
    first.decide_branch(y);
    first.write_final(y, T(0.0));
  }
  T time(0.0);
  const int count = static_cast<int>(path.legs.size());
  for (int i = 0; i < count; ++i) {
    outcome.leg = i;
    double whole = 0.0;
    if (!path.legs[static_cast<std::size_t>(i)].spec().continues)
      readout.stage_strain = F::strain(y);
    const LegEnd<T> end =
        drive_leg<I, L, T>(integrator, flow, readout, path, i, time, y, curve.rows, whole);
    time = time + end.elapsed;
    outcome.status = end.status;
    outcome.stop = end.stop;
    if (end.status == Status::completed) continue;
    const double share = whole > 0.0 ? std::min(1.0, value(end.elapsed) / whole) : 0.0;
    outcome.fraction = (i + share) / count;
    outcome.time = value(time);
    return outcome;
  }
  outcome.fraction = 1.0;
  outcome.time = value(time);
  return outcome;
}

}  // namespace detail

/// Drives the path. The curve's rows are replaced (its memory is reused). Never throws for numbers:
/// whatever happens is in the outcome, with the rows done so far and the state where it ended as
/// the last row.
template <class L, class T>
Outcome drive_path(const ElementStart<L, T>& start, const Path& path, const Settings& settings,
                   BasicCurve<T>& curve) {
  curve.rows.clear();
  curve.rows.reserve(path.row_count());
  curve.outcome = {};
  Counts& counts = curve.outcome.counts;
  switch (chosen_method<L>(settings.method)) {
    case Method::implicit: {
      Implicit<L, T> integrator(settings, counts);
      return detail::drive_legs<Implicit<L, T>, L, T>(integrator, start, path, settings, curve);
    }
    case Method::adaptive:
      if constexpr (L::has_stress_memory) {
        Adaptive<L, T> integrator(settings, counts);
        return detail::drive_legs<Adaptive<L, T>, L, T>(integrator, start, path, settings, curve);
      }
      break;
    case Method::cvode:
    case Method::arkode:
    case Method::ida:
      if constexpr (std::is_same_v<T, double>) {
        if constexpr (L::has_stress_memory) {
          SundialsDrive<L> integrator(settings, counts, chosen_method<L>(settings.method));
          return detail::drive_legs<SundialsDrive<L>, L, T>(integrator, start, path, settings,
                                                            curve);
        }
      }
      break;
    case Method::automatic:
      break;
  }
  curve.outcome.status = Status::unsupported;
  return curve.outcome;
}

}  // namespace repose::point
