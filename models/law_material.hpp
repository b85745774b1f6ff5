#pragma once
/// \file
/// The Material of a law: loads points into SIMD registers, calls the law, stores them.

#include "models/material.hpp"
#include "models/objective.hpp"
#include "models/scalar.hpp"

namespace repose {

template <ConstitutiveLaw L>
class LawMaterial final : public Material {
 public:
  using Theta = std::span<const double>;

  explicit LawMaterial(std::vector<double> theta)
      : Material(std::move(theta)),
        plain_(L::template Params<double>::from(this->theta())),
        packed_(parameters<Pack>()) {}

  static const LawInfo& info() {
    static constexpr LawInfo table{L::name,
                                   L::option_key,
                                   L::option,
                                   L::doc,
                                   std::span<const ParamInfo>(L::parameters),
                                   std::span<const StateField>(L::state),
                                   L::has_stress_memory,
                                   derived_fields<L>()};
    return table;
  }
  const LawInfo& law() const override { return info(); }
  const typename L::template Params<double>& params() const { return plain_; }

  UpdateReport update(const Batch& batch) const override { return update_all(batch); }
  UpdateReport update(const SpatialBatch& batch) const override { return update_all(batch); }

  void hold_volume(const Batch& batch, const double* denser) const override {
    hold_all(batch, denser);
  }
  void hold_volume(const SpatialBatch& batch, const double* denser) const override {
    hold_all(batch, denser);
  }

  void stored_energy(const Batch& batch, double* energy) const override {
    store_energy(batch, energy);
  }
  void stored_energy(const SpatialBatch& batch, double* energy) const override {
    store_energy(batch, energy);
  }

  void modulus(const Batch& batch, double* rho_c2) const override { store_modulus(batch, rho_c2); }
  void modulus(const SpatialBatch& batch, double* rho_c2) const override {
    store_modulus(batch, rho_c2);
  }

  void elastic_volume_strain(const Batch& batch, double* strain) const override {
    for (std::size_t i = 0; i < batch.count; i += Pack::size) {
      const auto point = load_point<Pack>(batch, i);
      L::elastic_volume_strain(packed_, point.stress, point.state, load<Pack>(batch.density + i))
          .store_unaligned(strain + i);
    }
  }

  void viscosity(const Batch& batch, double* eta, double* thinning) const override {
    // a central difference in ln γ̇: its error is δ²/6 of the third derivative, of order one
    const double delta = 1e-4;
    const Pack inv_dt(1.0 / batch.dt);
    for (std::size_t i = 0; i < batch.count; i += Pack::size) {
      const auto point = load_point<Pack>(batch, i);
      const Pack density = load<Pack>(batch.density + i);
      Sym<Pack, 4> D;
      for (int k = 0; k < 4; ++k) D[k] = inv_dt * load<Pack>(batch.strain[index(k)] + i);
      const auto at = [&](double factor) {
        return Pack(L::viscosity(packed_, point.stress, density, Pack(factor) * D));
      };
      const Pack here = at(1.0);
      const Pack change = at(1.0 + delta) - at(1.0 - delta);
      const auto none = here == Pack(0.0);
      here.store_unaligned(eta + i);
      select(none, Pack(0.0), Pack(-change / (select(none, Pack(1.0), here) * Pack(2.0 * delta))))
          .store_unaligned(thinning + i);
    }
  }

  InitialPoint initial(const InitialConditions& given) const override {
    return L::initial(plain_, given);
  }
  double density_at(double p, double ocr) const override { return L::density_at(plain_, p, ocr); }

 private:
  template <class T, int N>
  struct Point {
    Sym<T, N> stress;
    typename L::template State<T> state;
  };

  template <int N>
  UpdateReport update_all(const BatchOf<N>& batch) const {
    UpdateReport report;
    using T = std::conditional_t<L::iterates, Twin, Pack>;
    const auto P = parameters<T>();  // no store can alias it, so that it may stay in registers
    for (std::size_t i = 0; i < batch.count; i += T::size) update<T>(P, batch, i, report);
    return report;
  }

  template <int N>
  void hold_all([[maybe_unused]] const BatchOf<N>& batch,
                [[maybe_unused]] const double* denser) const {
    if constexpr (requires(typename L::template State<Pack> & at) {
                    L::hold_volume(packed_, Pack(1.0), at);
                  }) {
      for (std::size_t i = 0; i < batch.count; i += Pack::size) {
        auto point = load_point<Pack>(batch, i);
        L::hold_volume(packed_, load<Pack>(denser + i), point.state);
        for (std::size_t k = 0; k < L::state.size(); ++k)
          point.state[k].store_unaligned(batch.state[k] + i);
      }
    }
  }

  template <int N>
  void store_energy(const BatchOf<N>& batch, double* energy) const {
    for (std::size_t i = 0; i < batch.count; i += Pack::size) {
      const auto point = load_point<Pack>(batch, i);
      L::stored_energy(packed_, point.stress, point.state, load<Pack>(batch.density + i))
          .store_unaligned(energy + i);
    }
  }

  template <int N>
  void store_modulus(const BatchOf<N>& batch, double* rho_c2) const {
    for (std::size_t i = 0; i < batch.count; i += Pack::size) {
      const auto point = load_point<Pack>(batch, i);
      L::modulus(packed_, point.stress, point.state, load<Pack>(batch.density + i))
          .store_unaligned(rho_c2 + i);
    }
  }

  template <class T>
  typename L::template Params<T> parameters() const {
    std::array<T, L::parameters.size()> wide;
    for (std::size_t k = 0; k < wide.size(); ++k) wide[k] = T(theta()[k]);
    return L::template Params<T>::from(std::span<const T>(wide));
  }

  static std::size_t index(int k) { return static_cast<std::size_t>(k); }
  template <class T>
  static T load(const double* from) {
    return T::load_unaligned(from);
  }

  template <class T, int N>
  static Point<T, N> load_point(const BatchOf<N>& batch, std::size_t i) {
    Point<T, N> point;
    for (int k = 0; k < N; ++k) point.stress[k] = load<T>(batch.stress[index(k)] + i);
    for (std::size_t k = 0; k < L::state.size(); ++k) point.state[k] = load<T>(batch.state[k] + i);
    return point;
  }

  /// Updates the points i … i + T::size − 1 of a batch.
  template <class T, int N>
  [[gnu::always_inline]] static void update(const typename L::template Params<T>& P,
                                            const BatchOf<N>& batch, std::size_t i,
                                            UpdateReport& report) {
    const T zero(0.0);
    Increment<T, N> inc;
    inc.dt = T(batch.dt);
    for (int k = 0; k < N; ++k) inc.strain[k] = load<T>(batch.strain[index(k)] + i);
    // ρ after the step: d ln ρ = −tr D dt, exact for a constant rate of logarithmic strain
    const T density_before = load<T>(batch.density + i);
    inc.density = density_before * exp_pair(T(-trace(inc.strain))).whole;
    const Point<T, N> given = load_point<T>(batch, i);
    Point<T, N> point = given;
    if (batch.spin[0] != nullptr) {
      if constexpr (N == 4)
        point.stress = rotated_in_plane(point.stress, load<T>(batch.spin[0] + i));
      else
        point.stress = rotated(
            point.stress,
            {load<T>(batch.spin[0] + i), load<T>(batch.spin[1] + i), load<T>(batch.spin[2] + i)});
    }
    const Sym<T, N> before = point.stress;
    StepWork<T> spent;
    auto failed = L::update(P, inc, point.stress, point.state, &spent);
    failed = failed || negated(inc.dt >= zero && inc.density > zero && finite(inc.density) &&
                               finite(contract(before, before)));
    T work = T(0.5) * contract(before + point.stress, inc.strain);
    if (any(failed)) {
      note_failure<T>(failed, i, batch.count, report);
      for (int k = 0; k < N; ++k) {
        point.stress[k] = select(failed, given.stress[k], point.stress[k]);
        inc.strain[k] = select(failed, zero, inc.strain[k]);
      }
      for (std::size_t k = 0; k < L::state.size(); ++k)
        point.state[k] = select(failed, given.state[k], point.state[k]);
      inc.density = select(failed, density_before, inc.density);
      for (T* const energy :
           {&work, &spent.plastic, &spent.viscous, &spent.hypoelastic, &spent.separation})
        *energy = select(failed, zero, *energy);
    }
    for (int k = 0; k < N; ++k) point.stress[k].store_unaligned(batch.stress[index(k)] + i);
    for (std::size_t k = 0; k < L::state.size(); ++k)
      point.state[k].store_unaligned(batch.state[k] + i);
    inc.density.store_unaligned(batch.density + i);
    // where the law can have but one of the two, the batch has no room for the other
    if constexpr (L::has_stress_memory)
      spent.plastic = spent.plastic + spent.viscous;
    else
      spent.viscous = spent.viscous + spent.plastic;
    if (batch.work != nullptr) work.store_unaligned(batch.work + i);
    if (batch.plastic != nullptr) spent.plastic.store_unaligned(batch.plastic + i);
    if (batch.viscous != nullptr) spent.viscous.store_unaligned(batch.viscous + i);
    if (batch.hypoelastic != nullptr) spent.hypoelastic.store_unaligned(batch.hypoelastic + i);
    if (batch.separation != nullptr) spent.separation.store_unaligned(batch.separation + i);
    if (batch.modulus != nullptr)
      L::modulus(P, point.stress, point.state, inc.density).store_unaligned(batch.modulus + i);
    if (batch.viscosity != nullptr)
      L::viscosity(P, point.stress, inc.density,
                   T(batch.dt > 0.0 ? 1.0 / batch.dt : 0.0) * inc.strain)
          .store_unaligned(batch.viscosity + i);
  }

  template <class T>
  static void note_failure(const Mask<T>& failed, std::size_t first, std::size_t count,
                           UpdateReport& report) {
    if (!report.ok()) return;
    std::array<double, T::size> flag{};
    select(failed, T(1.0), T(0.0)).store_unaligned(flag.data());
    for (std::size_t k = 0; k < T::size && first + k < count; ++k) {
      if (flag[k] == 0.0) continue;
      report.failed = first + k;
      return;
    }
  }

  typename L::template Params<double> plain_;
  typename L::template Params<Pack> packed_;
};

}  // namespace repose
