#pragma once
/// \file
/// Points of a law in batches, for the tests of its Material in plane strain and in space.

#include <cstring>

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

/// A law with N tensor components.
template <class L, int N>
struct Case {
  using Law = L;
  static constexpr int components = N;
};
template <class>
struct CasesOf;
template <class... L>
struct CasesOf<std::tuple<L...>> {
  using Types = ::testing::Types<Case<L, 4>..., Case<L, 6>...>;
};
struct CaseName {
  template <class C>
  static std::string GetName(int k) {  // NOLINT: the name GoogleTest asks for
    return LawName::GetName<typename C::Law>(k) + (C::components == 4 ? "_plane" : "_space");
  }
};

/// Structure-of-arrays points with outputs, and a margin behind them that nobody may touch.
template <class C>
struct Columns {
  using L = typename C::Law;
  using Batch = BatchOf<C::components>;
  static constexpr std::size_t components = Batch::components;
  static constexpr std::size_t margin = 8;
  static constexpr double canary = -77.0;
  std::size_t count;
  std::array<std::vector<double>, components> strain, stress;
  std::array<std::vector<double>, L::state.size()> state;
  std::array<std::vector<double>, 3> spin;
  std::vector<double> density, modulus, viscosity, work, plastic, viscous, hypoelastic, separation;

  template <class F>
  void each_input(F&& f) {
    for (auto& column : strain) f(column);
    for (auto& column : stress) f(column);
    for (auto& column : state) f(column);
    for (auto& column : spin) f(column);
    f(density);
  }
  explicit Columns(std::size_t n) : count(n) {
    const auto fill = [&](std::vector<double>& column) {
      column.assign(padded(n) + margin, canary);
    };
    each_input(fill);
    for (auto* column :
         {&modulus, &viscosity, &work, &plastic, &viscous, &hypoelastic, &separation})
      fill(*column);
  }
  void set(std::size_t i, const LawPoint<L>& point, const Sym<double, 6>& e,
           const std::array<double, 3>& angles) {
    for (std::size_t k = 0; k < components; ++k) {
      strain[k][i] = e.c[k];
      stress[k][i] = point.stress.c[k];
    }
    for (std::size_t k = 0; k < state.size(); ++k) state[k][i] = point.state[k];
    for (std::size_t k = 0; k < 3; ++k) spin[k][i] = angles[k];
    density[i] = point.density;
  }
  /// The slots between count and padded(count) take copies of the last point.
  void pad() {
    each_input([&](std::vector<double>& column) {
      std::fill_n(column.begin() + static_cast<std::ptrdiff_t>(count), padded(count) - count,
                  column[count - 1]);
    });
  }
  Batch batch(double dt) {
    Batch b;
    b.count = count;
    b.dt = dt;
    for (std::size_t k = 0; k < components; ++k) {
      b.strain[k] = strain[k].data();
      b.stress[k] = stress[k].data();
    }
    for (std::size_t k = 0; k < state.size(); ++k) b.state[k] = state[k].data();
    if constexpr (C::components == 4)
      b.spin = {spin[2].data()};
    else
      b.spin = {spin[0].data(), spin[1].data(), spin[2].data()};
    b.density = density.data();
    b.modulus = modulus.data();
    b.viscosity = viscosity.data();
    b.work = work.data();
    b.plastic = plastic.data();
    b.viscous = viscous.data();
    b.hypoelastic = hypoelastic.data();
    b.separation = separation.data();
    return b;
  }
  LawPoint<L> point(std::size_t i) const {
    LawPoint<L> r{Sym<double, 6>::isotropic(0.0), {}, density[i]};
    for (std::size_t k = 0; k < components; ++k) r.stress.c[k] = stress[k][i];
    for (std::size_t k = 0; k < L::state.size(); ++k) r.state[k] = state[k][i];
    return r;
  }
  /// Everything update() writes for point i.
  std::vector<double> written(std::size_t i) const {
    std::vector<double> all{density[i], modulus[i], viscosity[i],   work[i],
                            plastic[i], viscous[i], hypoelastic[i], separation[i]};
    for (const auto& column : stress) all.push_back(column[i]);
    for (std::size_t k = 0; k < L::state.size(); ++k) all.push_back(state[k][i]);
    return all;
  }
};

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// A point, its increment and its spin, wild enough to take every branch: elastic, plastic, torn,
/// apart, rejoining.
template <class C>
struct Task {
  using L = typename C::Law;
  static constexpr bool plane = C::components == 4;
  LawPoint<L> point;
  Sym<double, 6> strain;
  std::array<double, 3> spin;  // plane strain: about z, the last

  static Task random(const LawExample& example, const typename L::template Params<double>& P,
                     Random& random) {
    Task task{random_point<L>(example, P, random, plane),
              random.tensor(example.strain * random.decade(-3.0, 1.0), plane),
              {random(-0.1, 0.1), random(-0.1, 0.1), random(-0.1, 0.1)}};
    if (random(0.0, 1.0) < 0.2) {
      // part it: dilate until the stress is gone, and offer it compression
      const double step = random(0.05, 0.5);
      task.point.step(P, Sym<double, 6>::isotropic(step), example.time);
      task.strain = task.strain - Sym<double, 6>::isotropic(step * random(0.0, 2.0));
    }
    return task;
  }
};

}  // namespace
}  // namespace repose
