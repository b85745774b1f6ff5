#pragma once
/// \file
/// One leg being driven, as every integrator sees it: how long it lasts, what may end it, and where
/// its rows go.

#include "pointdriver/integrate/flow.hpp"

namespace repose::point {

inline constexpr std::size_t max_events = 12;

/// What an integrator reports about a leg.
template <class T>
struct LegEnd {
  Status status = Status::completed;
  T elapsed{0.0};  ///< time in the leg [s]
  int stop = -1;
};

/// Things that end a smooth stretch. Each is a function that is < 0 while nothing happens.
enum class EventKind : std::uint8_t { branch, contact, goal, stop };
struct Event {
  EventKind kind = EventKind::branch;
  int index = 0;      ///< which stop
  double sign = 1.0;  ///< of (quantity − value) that counts as reached; 0: not armed yet
  Goal goal{};
};

template <class L, class T>
class LegRun {
 public:
  using F = Flow<L, T>;
  using Y = typename F::Y;

  LegRun(F& flow, const Readout<T>& readout, const Path& path, int leg_index, const T& start_time,
         const Y& start, std::vector<Row<T>>* rows)
      : flow_(flow),
        readout_(readout),
        path_(path),
        leg_(path.legs[static_cast<std::size_t>(leg_index)]),
        index_(leg_index),
        start_time_(start_time),
        start_(start),
        rows_(rows) {
    const LegSpec& spec = leg_.spec();
    bool forward = true;
    if (spec.goal) {
      flow_.use(leg_.control(true));  // read() may need a control for D; the sign is not known yet
      const T now = reached(*spec.goal, start);
      forward = value(now) <= spec.goal->value;
      if (spec.goal_is_event) {
        const double rate = spec.rows[static_cast<std::size_t>(spec.driver)].rate;
        duration_ = T(spec.strain_limit / rate);
      } else {
        duration_ =
            (forward ? T(spec.goal->value) - now : now - T(spec.goal->value)) / spec.goal_rate;
      }
      nothing_to_do_ = value(now) == spec.goal->value;
    } else {
      duration_ = T(spec.duration);
    }
    flow_.use(leg_.control(forward));
    flow_.begin_leg(start);
    add({EventKind::branch, 0, 1.0, {}});
    add({EventKind::contact, 0, 1.0, {}});
    if (spec.goal && spec.goal_is_event)
      add({EventKind::goal, 0, forward ? 1.0 : -1.0, *spec.goal});
    for (std::size_t i = 0; i < spec.stops.size(); ++i) {
      const double gap = value(reached(spec.stops[i], start)) - spec.stops[i].value;
      add({EventKind::stop, static_cast<int>(i), gap < 0.0 ? 1.0 : (gap > 0.0 ? -1.0 : 0.0),
           spec.stops[i]});
    }
  }

  F& flow() { return flow_; }
  const F& flow_const() const { return flow_; }
  const Y& start() const { return start_; }
  const T& duration() const { return duration_; }
  /// Drives for a time found before instead of to a goal on the way.
  void fix_duration(const T& duration) {
    duration_ = duration;
    for (int i = 0; i < n_events_; ++i)
      if (events_[static_cast<std::size_t>(i)].kind == EventKind::goal)
        events_[static_cast<std::size_t>(i)].sign = 0.0;
    timed_ = true;
  }
  /// Drives to a goal on the way for no longer than this.
  void bound_duration(const T& duration) { duration_ = duration; }
  bool nothing_to_do() const { return nothing_to_do_; }
  const LegSpec& spec() const { return leg_.spec(); }
  int event_count() const { return n_events_; }
  const Event& event(int i) const { return events_[static_cast<std::size_t>(i)]; }
  bool goal_is_event() const { return !timed_ && spec().goal && spec().goal_is_event; }

  /// Value of event i (branch excepted: see branch_value) at a state.
  T event_value(int i, const Y& y, const T& t) const {
    const Event& e = event(i);
    if (e.kind == EventKind::contact) {
      const T p = (y[0] + y[1] + y[2]) * T(-1.0 / 3.0);
      return T(flow_.contact_pressure()) - p;
    }
    return e.sign * (reached(e.goal, y, t) - T(e.goal.value));
  }

  /// The branch event: F in the elastic branch; in the plastic one unloading, −Ḟ of the elastic
  /// response, for a rate-dependent law also −F. Values only.
  double branch_value(const Y& y, const Y& dy) const {
    if constexpr (!L::has_stress_memory) {
      return -1.0;
    } else {
      if (flow_.branch == Branch::elastic) return value(flow_.yield(y));
      Sym<T, 6> D;
      for (std::size_t i = 0; i < 6; ++i) D.c[i] = dy[F::i_strain + i];
      const double unloads = -flow_.loading(y, D) - 1e-9;
      // flow ends where the stress is back within yield and the elastic response leads inwards: in
      // slow flow F itself is smaller than any tolerance
      if constexpr (is_rate_dependent<L>())
        return std::min(unloads, -value(flow_.yield(y)) / F::stress_scale(y));
      else
        return unloads;
    }
  }

  /// The strain rate of the last step, where an integrator knows it better than the rate form does.
  void note_rate(const Sym<T, 6>& D) {
    rate_ = D;
    has_rate_ = true;
  }

  /// Arms stop conditions that started exactly at their value.
  void arm(const Y& y, const T& t) {
    for (int i = 0; i < n_events_; ++i) {
      Event& e = events_[static_cast<std::size_t>(i)];
      if (e.sign != 0.0 || e.kind != EventKind::stop) continue;
      const double gap = value(reached(e.goal, y, t)) - e.goal.value;
      e.sign = gap < 0.0 ? 1.0 : (gap > 0.0 ? -1.0 : 0.0);
    }
  }

  /// The branch on which the state continues. completed: flow().branch is set.
  Status decide_branch(const Y& y) {
    if constexpr (!L::has_stress_memory) {
      flow_.branch = Branch::plastic;
      return Status::completed;
    } else {
      flow_.branch = Branch::elastic;
      const double f = value(flow_.yield(y));
      if (f < -1e-11 * F::stress_scale(y)) return Status::completed;
      Sym<T, 6> D, stress_rate;
      typename F::State state_rate{};
      const bool elastic_solves = flow_.respond(y, Branch::elastic, D, stress_rate, state_rate);
      if constexpr (is_rate_dependent<L>()) {
        // beyond yield there is flow whatever the rates; on it, if the elastic response leads out
        if (f > 1e-11 * F::stress_scale(y) || !elastic_solves || flow_.loading(y, D) > 0.0)
          flow_.branch = Branch::plastic;
        return Status::completed;
      } else {
        if (elastic_solves && !(flow_.loading(y, D) > 0.0)) return Status::completed;
        flow_.branch = Branch::plastic;
        if (!flow_.respond(y, Branch::plastic, D, stress_rate, state_rate))
          return Status::beyond_limit;
        return flow_.loading(y, D) > 0.0 ? Status::completed : Status::no_response;
      }
    }
  }

  /// The branch event has happened at y: takes the other branch. completed: it can go on.
  Status change_branch(Y& y) {
    if (flow_.branch == Branch::plastic) {
      flow_.branch = Branch::elastic;  // unloading
      return Status::completed;
    }
    flow_.branch = Branch::plastic;
    if constexpr (!is_rate_dependent<L>()) {
      flow_.return_to_surface(y);
      Sym<T, 6> D, stress_rate;
      typename F::State state_rate{};
      if (!flow_.respond(y, Branch::plastic, D, stress_rate, state_rate))
        return Status::beyond_limit;
      if (!(flow_.loading(y, D) > 0.0)) return Status::no_response;
    }
    return Status::completed;
  }

  // --- rows -------------------------------------------------------------------------------------

  bool writes() const { return rows_ != nullptr; }
  /// Time in the leg of the next row, as long as rows_left(). The last row is the leg's end.
  int rows_left() const { return writes() ? spec().points - written_ : 0; }
  T next_row_time() const {
    const double share = static_cast<double>(written_ + 1) / static_cast<double>(spec().points);
    return share * duration_;
  }
  void write_row(const Y& y, const T& t) {
    write_final(y, t);
    ++written_;
  }
  /// A row outside the regular ones: where a leg broke off.
  void write_final(const Y& y, const T& t) {
    if (!writes()) return;
    rows_->push_back(make_row(y, t));
  }

  Row<T> make_row(const Y& y, const T& t) const {
    Row<T> row = sample(y, t);
    row.density = flow_.density(y);
    const Sym<T, 6> change = row.strain - F::strain(start_);
    row.residual = residual(change, row.stress, value(t));
    row.work = y[F::i_work];
    row.dissipated = y[F::i_work + 1];
    row.hypoelastic = y[F::i_work + 2];
    if (flow_.energy()) row.stored = flow_.stored_energy(y) - flow_.stored_at_start;
    if (has_rate_) {
      row.strain_rate = rate_;
    } else if (path_.wants_strain_rate) {
      Sym<T, 6> D, stress_rate;
      typename F::State state_rate{};
      if (flow_.respond(y, flow_.branch, D, stress_rate, state_rate)) row.strain_rate = D;
    }
    return row;
  }

  /// What a goal compares with its value: a strain may count from the start of the stage.
  T reached(const Goal& goal, const Y& y, const T& t = T(0.0)) const {
    if (!goal.of_stage && goal.measure == StrainMeasure::logarithmic)
      return quantity(goal.quantity, y, t);
    Row<T> row = sample(y, t);
    if (goal.of_stage) row.strain = row.strain - readout_.stage_strain;
    Readout<T> readout = readout_;
    readout.measure = goal.measure;
    return read(goal.quantity, row, readout);
  }

  T quantity(Quantity q, const Y& y, const T& t = T(0.0)) const {
    Row<T> row = sample(y, t);
    if (q == Quantity::v || q == Quantity::density) row.density = flow_.density(y);
    if (has_rate_) {
      row.strain_rate = rate_;
    } else if (q == Quantity::shear_rate || (q == Quantity::I && readout_.I_index < 0)) {
      Sym<T, 6> stress_rate;
      typename F::State state_rate{};
      flow_.respond(y, flow_.branch, row.strain_rate, stress_rate, state_rate);
    }
    return read(q, row, readout_);
  }

 private:
  void add(const Event& e) {
    if (static_cast<std::size_t>(n_events_) < max_events)
      events_[static_cast<std::size_t>(n_events_++)] = e;
  }

  Row<T> sample(const Y& y, const T& t) const {
    Row<T> row;
    row.time = start_time_ + t;
    row.leg = index_;
    row.stress = F::stress(y);
    row.strain = F::strain(y);
    row.state = variables<L>(flow_.parameters(), y);
    return row;
  }

  double residual(const Sym<T, 6>& strain_change, const Sym<T, 6>& stress, double t) const {
    Sym<double, 6> e, ds, s;
    for (std::size_t i = 0; i < 6; ++i) {
      e.c[i] = value(strain_change.c[i]);
      s.c[i] = value(stress.c[i]);
      ds.c[i] = s.c[i] - value(start_[i]);
    }
    return flow_.control().residual(e, ds, s, t);
  }

  F& flow_;
  const Readout<T>& readout_;
  const Path& path_;
  const Leg& leg_;
  int index_;
  T start_time_;
  Y start_;
  T duration_{0.0};
  bool nothing_to_do_ = false;
  bool timed_ = false;
  bool has_rate_ = false;
  Sym<T, 6> rate_{};
  std::array<Event, max_events> events_{};
  int n_events_ = 0;
  std::vector<Row<T>>* rows_;
  int written_ = 0;
};

}  // namespace repose::point
