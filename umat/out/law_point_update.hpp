#pragma once
/// \file
/// The PointUpdate of a law: its update() in plain numbers, as everything in the library that moves
/// points has it, and once more in dual numbers, whose derivatives are the consistent tangent
/// (Simo & Taylor 1985: that of the discrete update, which keeps Newton's method quadratic).

#include "models/point_tangent.hpp"
#include "umat/out/point_update.hpp"

namespace repose::umat {

template <ConstitutiveLaw L>
class LawPointUpdate final : public PointUpdate {
 public:
  explicit LawPointUpdate(std::span<const double> theta)
      : plain_(L::template Params<double>::from(theta)),
        plane_(lifted<4>(theta)),
        space_(lifted<6>(theta)) {}

  InitialPoint initial(const InitialConditions& given) const override {
    return L::initial(plain_, given);
  }

  bool advance(const Sym<double, 4>& strain, double dt, Point<4>& point, std::span<double> state,
               std::span<double> derived, Tangent<4>& tangent) const override {
    return advance_with(plane_, strain, dt, point, state, derived, tangent);
  }
  bool advance(const Sym<double, 6>& strain, double dt, Point<6>& point, std::span<double> state,
               std::span<double> derived, Tangent<6>& tangent) const override {
    return advance_with(space_, strain, dt, point, state, derived, tangent);
  }

 private:
  template <class T>
  using Params = typename L::template Params<T>;
  template <class T>
  using State = typename L::template State<T>;

  template <int n>
  static Params<Dual<n>> lifted(std::span<const double> theta) {
    const std::vector<Dual<n>> constants(theta.begin(), theta.end());
    return Params<Dual<n>>::from(std::span<const Dual<n>>(constants));
  }

  template <int N>
  bool advance_with(const Params<Dual<N>>& P, const Sym<double, N>& strain, double dt,
                    Point<N>& point, std::span<double> state, std::span<double> derived,
                    Tangent<N>& tangent) const {
    const double volume = exp_pair(trace(strain)).whole;  // after over before
    const Increment<double, N> inc{strain, dt, point.density / volume};
    Sym<double, N> stress = point.stress;
    State<double> now{};
    for (std::size_t k = 0; k < L::state.size(); ++k) now[k] = state[k];
    StepWork<double> spent;
    // a law need not look at what it does not use: the same checks as LawMaterial's
    if (L::update(plain_, inc, stress, now, &spent) || !(dt >= 0.0) || !(inc.density > 0.0) ||
        !finite(inc.density) || !finite(contract(point.stress, point.stress)))
      return false;
    if (!point_tangent<L, N>(P, strain, dt, point.density, point.stress, state, tangent))
      return false;
    for (const double x : {spent.plastic, spent.viscous})
      if (!finite(x)) return false;

    // work is per mean volume of the step, the energies of the point per the volume of the moment
    const double half = exp_pair(0.5 * trace(strain)).whole;
    point.plastic = (point.plastic + spent.plastic * half) / volume;
    point.viscous = (point.viscous + spent.viscous * half) / volume;
    point.stored = L::stored_energy(plain_, stress, now, inc.density);
    point.stress = stress;
    point.density = inc.density;
    for (std::size_t k = 0; k < L::state.size(); ++k) state[k] = now[k];
    if constexpr (derived_fields<L>().size() > 0) {
      if (!derived.empty()) {
        const auto values = L::derive(plain_, stress, now);
        for (std::size_t k = 0; k < derived.size(); ++k) derived[k] = values[k];
      }
    }
    return true;
  }

  Params<double> plain_;
  Params<Dual<4>> plane_;
  Params<Dual<6>> space_;
};

}  // namespace repose::umat
