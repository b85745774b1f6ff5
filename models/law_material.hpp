#pragma once
/// \file
/// The Material of a law: loads points into SIMD registers, calls the law, stores them.

#include "models/material.hpp"
#include "models/objective.hpp"

namespace repose {

template <ConstitutiveLaw L>
class LawMaterial final : public Material {
 public:
  using Theta = std::span<const double>;

  explicit LawMaterial(std::vector<double> theta) : Material(std::move(theta)) {
    plain_ = L::template Params<double>::from(this->theta());
    std::vector<Pack> wide;
    for (const double x : this->theta()) wide.emplace_back(x);
    packed_ = L::template Params<Pack>::from(std::span<const Pack>(wide));
  }

  static const LawInfo& info() {
    static constexpr LawInfo table{L::name,
                                   L::option_key,
                                   L::option,
                                   L::doc,
                                   std::span<const ParamInfo>(L::parameters),
                                   std::span<const StateField>(L::state),
                                   L::has_stress_memory};
    return table;
  }
  const LawInfo& law() const override { return info(); }
  const typename L::template Params<double>& params() const { return plain_; }

  UpdateReport update(const Batch& batch) const override {
    UpdateReport report;
    const auto P = packed_;  // a copy that no store can alias, so that it may stay in registers
    const Pack zero(0.0);
    const Pack dt(batch.dt);
    const Pack inv_dt(batch.dt > 0.0 ? 1.0 / batch.dt : 0.0);
    const auto bad_dt = !(dt >= zero);
    for (std::size_t i = 0; i < batch.count; i += pack_size) {
      Increment<Pack, 4> inc;
      inc.dt = dt;
      for (int k = 0; k < 4; ++k) inc.strain[k] = load(batch.strain[index(k)] + i);
      // ρ after the step: d ln ρ = −tr D dt, exact for a constant rate of logarithmic strain
      const Pack density_before = load(batch.density + i);
      inc.density = density_before * exp(-trace(inc.strain));
      const Point given = load_point(batch, i);
      Point point = given;
      if (batch.spin != nullptr)
        point.stress = rotated_in_plane(point.stress, load(batch.spin + i));
      const Sym<Pack, 4> before = point.stress;
      auto failed = L::update(P, inc, point.stress, point.state);
      failed = failed || bad_dt || !(inc.density > zero) || !finite(inc.density) ||
               !finite(contract(before, before));
      Pack work = Pack(0.5) * contract(before + point.stress, inc.strain);
      if (any(failed)) {
        note_failure(failed, i, batch.count, report);
        for (int k = 0; k < 4; ++k) {
          point.stress[k] = select(failed, given.stress[k], point.stress[k]);
          inc.strain[k] = select(failed, zero, inc.strain[k]);
        }
        for (std::size_t k = 0; k < L::state.size(); ++k)
          point.state[k] = select(failed, given.state[k], point.state[k]);
        inc.density = select(failed, density_before, inc.density);
        work = select(failed, zero, work);
      }
      store(batch, i, point, inc.density);
      if (batch.work != nullptr) work.store_unaligned(batch.work + i);
      if (batch.modulus != nullptr)
        L::modulus(P, point.stress, point.state, inc.density).store_unaligned(batch.modulus + i);
      if (batch.viscosity != nullptr)
        L::viscosity(P, point.stress, inc.density, inv_dt * inc.strain)
            .store_unaligned(batch.viscosity + i);
    }
    return report;
  }

  void stored_energy(const Batch& batch, double* energy) const override {
    for (std::size_t i = 0; i < batch.count; i += pack_size) {
      const Point point = load_point(batch, i);
      L::stored_energy(packed_, point.stress, point.state, load(batch.density + i))
          .store_unaligned(energy + i);
    }
  }

  void modulus(const Batch& batch, double* rho_c2) const override {
    for (std::size_t i = 0; i < batch.count; i += pack_size) {
      const Point point = load_point(batch, i);
      L::modulus(packed_, point.stress, point.state, load(batch.density + i))
          .store_unaligned(rho_c2 + i);
    }
  }

  void viscosity(const Batch& batch, double* eta, double* thinning) const override {
    // a central difference in ln γ̇: its error is δ²/6 of the third derivative, of order one
    const double delta = 1e-4;
    const Pack inv_dt(1.0 / batch.dt);
    for (std::size_t i = 0; i < batch.count; i += pack_size) {
      const Point point = load_point(batch, i);
      const Pack density = load(batch.density + i);
      Sym<Pack, 4> D;
      for (int k = 0; k < 4; ++k) D[k] = inv_dt * load(batch.strain[index(k)] + i);
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
  struct Point {
    Sym<Pack, 4> stress;
    typename L::template State<Pack> state;
  };

  static std::size_t index(int k) { return static_cast<std::size_t>(k); }
  static Pack load(const double* from) { return Pack::load_unaligned(from); }

  static Point load_point(const Batch& batch, std::size_t i) {
    Point point;
    for (int k = 0; k < 4; ++k) point.stress[k] = load(batch.stress[index(k)] + i);
    for (std::size_t k = 0; k < L::state.size(); ++k) point.state[k] = load(batch.state[k] + i);
    return point;
  }

  static void store(const Batch& batch, std::size_t i, const Point& point, const Pack& density) {
    for (int k = 0; k < 4; ++k) point.stress[k].store_unaligned(batch.stress[index(k)] + i);
    for (std::size_t k = 0; k < L::state.size(); ++k)
      point.state[k].store_unaligned(batch.state[k] + i);
    density.store_unaligned(batch.density + i);
  }

  static void note_failure(const Mask<Pack>& failed, std::size_t first, std::size_t count,
                           UpdateReport& report) {
    if (!report.ok()) return;
    std::array<double, pack_size> flag{};
    xsimd::select(failed, Pack(1.0), Pack(0.0)).store_unaligned(flag.data());
    for (std::size_t k = 0; k < pack_size && first + k < count; ++k) {
      if (flag[k] == 0.0) continue;
      report.failed = first + k;
      return;
    }
  }

  typename L::template Params<double> plain_;
  typename L::template Params<Pack> packed_;
};

}  // namespace repose
