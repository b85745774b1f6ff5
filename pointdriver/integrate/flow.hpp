#pragma once
/// \file
/// The rate problem of an element under mixed control: given the state, the strain rates and stress
/// rates that satisfy both the law and the six constraints of the leg.

#include <bit>

#include "pointdriver/path/path.hpp"

namespace repose::point {

/// Does the plastic rate contain terms without D (viscous flow), so that a stress beyond yield is
/// possible? A law says so by a member `rate_dependent`; without one, a law that remembers stress
/// but hardens with nothing is taken as rate dependent.
template <class L>
constexpr bool is_rate_dependent() {
  if constexpr (requires { L::rate_dependent; }) {
    return L::rate_dependent;
  } else {
    return L::has_stress_memory && L::state.size() == 0;
  }
}

/// The variables of an element for output: state, then derived. `y` is its stress and state, and
/// what comes after.
template <class L, class T, std::size_t n>
std::array<T, max_state> variables(const typename L::template Params<T>& P,
                                   const std::array<T, n>& y) {
  constexpr std::size_t m = L::state.size();
  std::array<T, max_state> all{};
  for (std::size_t i = 0; i < std::min(m, max_state); ++i) all[i] = y[6 + i];
  if constexpr (!derived_fields<L>().empty()) {
    Sym<T, 6> stress;
    for (std::size_t i = 0; i < 6; ++i) stress.c[i] = y[i];
    typename L::template State<T> state{};
    for (std::size_t i = 0; i < m; ++i) state[i] = y[6 + i];
    const auto derived = L::derive(P, stress, state);
    for (std::size_t i = 0; i < derived.size(); ++i) all[m + i] = derived[i];
  }
  return all;
}

/// The state of an element as one vector, and its time derivative as a function of it.
///
///     y = (σ[6], state[m], ε[6], work, dissipated, hypoelastic)
///
/// Density follows from strain, ρ = ρ_0 exp(−tr ε). σ̇ is linear in D on a fixed branch, so with
/// D = D_p + Σ z_j N_j (control.hpp) the unknown z solve a system as small as the number of rows
/// that contain stress.
template <class L, class T>
class Flow {
 public:
  using Parameters = typename L::template Params<T>;
  using State = typename L::template State<T>;
  static constexpr std::size_t m = L::state.size();
  static constexpr std::size_t i_strain = 6 + m;
  static constexpr std::size_t i_work = i_strain + 6;
  static constexpr std::size_t size = i_work + 3;
  using Y = std::array<T, size>;
  static_assert(m + derived_fields<L>().size() <= max_state || derived_fields<L>().empty());

  Flow(const Parameters& P, const T& density_0, bool energy)
      : P_(P),
        density_0_(density_0),
        energy_(energy) {}

  void use(const Control& control) { control_ = &control; }
  const Control& control() const { return *control_; }
  const Parameters& parameters() const { return P_; }
  bool energy() const { return energy_; }
  const T& density_0() const { return density_0_; }
  Branch branch = Branch::elastic;
  mutable long rates = 0;

  static Sym<T, 6> stress(const Y& y) {
    Sym<T, 6> s;
    for (std::size_t i = 0; i < 6; ++i) s.c[i] = y[i];
    return s;
  }
  static Sym<T, 6> strain(const Y& y) {
    Sym<T, 6> e;
    for (std::size_t i = 0; i < 6; ++i) e.c[i] = y[i_strain + i];
    return e;
  }
  static State state(const Y& y) {
    State s{};
    for (std::size_t i = 0; i < m; ++i) s[i] = y[6 + i];
    return s;
  }

  /// ρ = ρ_0 exp(−tr ε)
  T density(const Y& y) const {
    using std::exp;
    return density_0_ * exp(-(y[i_strain] + y[i_strain + 1] + y[i_strain + 2]));
  }

  /// While a leg keeps the volume, ρ is computed once.
  void begin_leg(const Y& y) { density_at_start_ = density(y); }

  T density_in_leg(const Y& y) const {
    return control_->keeps_volume() ? density_at_start_ : density(y);
  }

  /// The pressure at which the material parts [Pa].
  double contact_pressure() const {
    if constexpr (requires { P_.p_sep; })
      return value(P_.p_sep);
    else if constexpr (requires { P_.K; })
      return 1e-9 * value(P_.K);
    else
      return 0.0;
  }

  /// dy/dt on the present branch. False if the control equations are singular or no number comes
  /// out.
  bool rate(const Y& y, Y& dy) const {
    Sym<T, 6> D, stress_rate;
    State state_rate{};
    if (!respond(y, branch, D, stress_rate, state_rate)) return false;
    pack(y, D, stress_rate, state_rate, dy);
    return finite(T(contract(D, D) + contract(stress_rate, stress_rate)));
  }

  /// dy/dt for a given D, whatever the control says.
  bool rate_of(const Y& y, const Sym<T, 6>& D, Y& dy) const {
    ++rates;
    Sym<T, 6> stress_rate;
    State state_rate{};
    L::rate(P_, stress(y), state(y), density_in_leg(y), D, branch, stress_rate, state_rate);
    pack(y, D, stress_rate, state_rate, dy);
    return finite(T(contract(D, D) + contract(stress_rate, stress_rate)));
  }

  /// D, σ̇ and the state's rate that satisfy law and control on the given branch.
  bool respond(const Y& y, Branch on, Sym<T, 6>& D, Sym<T, 6>& stress_rate,
               State& state_rate) const {
    ++rates;
    const Sym<T, 6> sigma = stress(y);
    const State at = state(y);
    const T rho = density_in_leg(y);
    const int k = control_->unknowns();
    D = constant(control_->prescribed());
    if (k == 0 || control_->prescribes_strain() || is_rate_dependent<L>()) {
      L::rate(P_, sigma, at, rho, D, on, stress_rate, state_rate);
      if (k == 0) return true;
    } else {
      stress_rate = Sym<T, 6>::isotropic(T(0.0));
      for (std::size_t i = 0; i < m; ++i) state_rate[i] = T(0.0);
    }
    Sym<T, 6> still_stress = Sym<T, 6>::isotropic(T(0.0));
    State still_state{};
    if constexpr (is_rate_dependent<L>()) {
      const Sym<T, 6> zero = Sym<T, 6>::isotropic(T(0.0));
      L::rate(P_, sigma, at, rho, zero, on, still_stress, still_state);
    } else {
      for (std::size_t i = 0; i < m; ++i) still_state[i] = T(0.0);
    }
    std::array<Sym<T, 6>, 6> column;
    std::array<State, 6> state_column{};
    for (int j = 0; j < k; ++j) {
      const auto J = static_cast<std::size_t>(j);
      L::rate(P_, sigma, at, rho, constant(control_->direction(j)), on, column[J], state_column[J]);
      if constexpr (is_rate_dependent<L>()) {
        column[J] = column[J] - still_stress;
        for (std::size_t i = 0; i < m; ++i)
          state_column[J][i] = state_column[J][i] - still_state[i];
      }
    }
    std::array<T, 6> z{};
    std::array<std::array<T, 6>, 6> matrix;
    for (int r = 0; r < k; ++r) {
      const Control::StressRow& row = control_->stress_row(r);
      T right(row.rate);
      for (std::size_t i = 0; i < 6; ++i) {
        if (row.strain[i] != 0.0) right = right - row.strain[i] * D.c[i];
        if (row.stress[i] != 0.0) right = right - row.stress[i] * stress_rate.c[i];
      }
      z[static_cast<std::size_t>(r)] = right;
      for (int j = 0; j < k; ++j) {
        const auto J = static_cast<std::size_t>(j);
        T sum(0.0);
        for (std::size_t i = 0; i < 6; ++i) {
          if (row.stress[i] != 0.0) sum = sum + row.stress[i] * column[J].c[i];
          if (row.strain[i] != 0.0) sum = sum + T(row.strain[i] * control_->direction(j).c[i]);
        }
        matrix[static_cast<std::size_t>(r)][J] = sum;
      }
    }
    if (k == 1) {
      if (value(matrix[0][0]) == 0.0) return false;
      z[0] = z[0] / matrix[0][0];
    } else if (!solve_small(k, matrix, z)) {
      return false;
    }
    for (int j = 0; j < k; ++j) {
      const auto J = static_cast<std::size_t>(j);
      const Sym<double, 6>& N = control_->direction(j);
      for (std::size_t i = 0; i < 6; ++i) {
        if (N.c[i] != 0.0) D.c[i] = D.c[i] + N.c[i] * z[J];
        stress_rate.c[i] = stress_rate.c[i] + z[J] * column[J].c[i];
      }
      for (std::size_t i = 0; i < m; ++i) state_rate[i] = state_rate[i] + z[J] * state_column[J][i];
    }
    return true;
  }

  /// F of a state vector, with the strain rate D where the law wants one [Pa].
  T yield(const Y& y) const {
    return L::yield(P_, stress(y), state(y), density_in_leg(y), Sym<T, 6>::isotropic(T(0.0)));
  }

  /// Would the elastic response to D carry the stress beyond yield? Ḟ of the elastic rate over its
  /// stress rate, [-]. Where it vanishes (shearing at the tip of the ellipse) the next order
  /// decides. F is probed symmetrically along σ̇ by 1e-4 of the stress: exact for a quadratic F.
  double loading(const Y& y, const Sym<T, 6>& D) const {
    Sym<double, 6> sigma, D_value, elastic;
    for (std::size_t i = 0; i < 6; ++i) {
      sigma.c[i] = value(y[i]);
      D_value.c[i] = value(D.c[i]);
    }
    typename L::template State<double> at{}, ignored{};
    for (std::size_t i = 0; i < m; ++i) at[i] = value(y[6 + i]);
    const double rho = value(density_in_leg(y));
    L::rate(plain(), sigma, at, rho, D_value, Branch::elastic, elastic, ignored);
    const double rate_size = std::sqrt(contract(elastic, elastic));
    const double stress_size = std::sqrt(contract(sigma, sigma));
    if (!(rate_size > 0.0) || !(stress_size > 0.0)) return 0.0;
    const double delta = 1e-4 * stress_size / rate_size;
    const auto F = [&](double along) {
      return L::yield(plain(), sigma + (along * delta) * elastic, at, rho, D_value);
    };
    const double ahead = F(1.0), here = F(0.0), behind = F(-1.0);
    const double first = 0.5 * (ahead - behind) / (1e-4 * stress_size);
    if (std::abs(first) > 1e-9) return first;
    const double second = (ahead - 2.0 * here + behind) / (1e-4 * stress_size);
    // second order: tiny but positive means that the stress leaves the surface tangentially
    return second > 1e-9 ? 1e-9 : 0.0;
  }

  /// Recoverable energy per initial volume [J/m³].
  T stored_energy(const Y& y) const {
    const T rho = density(y);
    return density_0_ / rho * L::stored_energy(P_, stress(y), state(y), rho);
  }
  T stored_at_start{0.0};

  /// Elastic moduli at a state, from the elastic rate: D = −I/3 gives K, D = I_xy gives 2G [Pa].
  void elastic_moduli(const Y& y, const T& rho, T& K, T& two_G) const {
    const Sym<T, 6> sigma = stress(y);
    const State at = state(y);
    State ignored{};
    Sym<T, 6> unit = Sym<T, 6>::isotropic(T(-1.0 / 3.0)), answer;
    L::rate(P_, sigma, at, rho, unit, Branch::elastic, answer, ignored);
    K = pressure(answer);
    unit = Sym<T, 6>::isotropic(T(0.0));
    unit[3] = T(1.0);
    L::rate(P_, sigma, at, rho, unit, Branch::elastic, answer, ignored);
    two_G = answer[3];
  }

  /// Stress-like size for tolerances [Pa].
  static double stress_scale(const Y& y) {
    return std::abs(value(y[0]) + value(y[1]) + value(y[2])) / 3.0;
  }

  /// F = 0 again, if the branch is plastic and F is to vanish there, by Newton steps in the
  /// hardening variable that moves F most: the stresses stay as prescribed.
  void return_to_surface(Y& y) const {
    if constexpr (m > 0 && !is_rate_dependent<L>()) {
      if (branch != Branch::plastic) return;
      for (int pass = 0; pass < 3; ++pass) {
        const T f = yield(y);
        if (pass > 0 && std::abs(value(f)) < 1e-14 * stress_scale(y)) return;
        double best = 0.0, slope = 0.0;
        std::size_t at = 0;
        for (std::size_t i = 0; i < m; ++i) {
          const double x = value(y[6 + i]);
          if (x == 0.0) continue;
          Y moved = y;
          const double delta = 1e-5 * x;
          moved[6 + i] = y[6 + i] + delta;
          const double up = value(yield(moved));
          moved[6 + i] = y[6 + i] - delta;
          const double s = (up - value(yield(moved))) / (2.0 * delta);
          if (std::abs(s * x) > best) {
            best = std::abs(s * x);
            at = i;
            slope = s;
          }
        }
        if (!(best > 0.0)) return;
        y[6 + at] = y[6 + at] - f / T(slope);
      }
    }
  }

  void set_plain(const typename L::template Params<double>& plain) { plain_ = &plain; }
  const typename L::template Params<double>& plain() const { return *plain_; }

 private:
  static Sym<T, 6> constant(const Sym<double, 6>& a) {
    if constexpr (std::is_same_v<T, double>) {
      return a;
    } else {
      Sym<T, 6> r;
      for (std::size_t i = 0; i < 6; ++i) r.c[i] = T(a.c[i]);
      return r;
    }
  }

  void pack(const Y& y, const Sym<T, 6>& D, const Sym<T, 6>& stress_rate, const State& state_rate,
            Y& dy) const {
    for (std::size_t i = 0; i < 6; ++i) {
      dy[i] = stress_rate.c[i];
      dy[i_strain + i] = D.c[i];
    }
    for (std::size_t i = 0; i < m; ++i) dy[6 + i] = state_rate[i];
    dy[i_work] = T(0.0);
    dy[i_work + 1] = T(0.0);
    dy[i_work + 2] = T(0.0);
    if (energy_) powers(y, D, stress_rate, dy);
  }

  /// Work input J σ:D and dissipation J(σ:D − σ:D^e), J = ρ_0/ρ. D^e is what the isotropic elastic
  /// law needs for σ̇: σ:D^e = p ṗ/K + s:ṡ/(2G), of which the law says what no potential stores.
  void powers(const Y& y, const Sym<T, 6>& D, const Sym<T, 6>& stress_rate, Y& dy) const {
    const Sym<T, 6> sigma = stress(y);
    const T rho = density_in_leg(y);
    const T J = density_0_ / rho;
    const T power = contract(sigma, D);
    dy[i_work] = J * power;
    dy[i_work + 2] = J * L::hypoelastic_power(P_, sigma, state(y), rho, D, stress_rate);
    if (branch == Branch::elastic) return;
    T K, two_G;
    elastic_moduli(y, rho, K, two_G);
    const Sym<T, 6> s = deviator(sigma);
    const T elastic =
        pressure(sigma) * pressure(stress_rate) / K + contract(s, deviator(stress_rate)) / two_G;
    dy[i_work + 1] = J * (power - elastic);
  }

  const Parameters& P_;
  const typename L::template Params<double>* plain_ = nullptr;
  T density_0_;
  T density_at_start_{0.0};
  bool energy_;
  const Control* control_ = nullptr;
};

}  // namespace repose::point
