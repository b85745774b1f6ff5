#pragma once
/// \file
/// What the contract tests need to know of each law: parameter sets (the published ones first), and
/// admissible points reached by random histories.

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "models/all_laws.hpp"
#include "models/law_material.hpp"
#include "models/registry.hpp"

namespace repose {

/// A parameter set with the sizes of its world.
struct LawExample {
  std::string label;
  LawSpec spec;
  double pressure;  ///< typical pressure [Pa]
  double strain;    ///< strain that brings such a point well into yield, or compresses it visibly
  double time;      ///< typical duration of a step [s]
};

/// The examples of one form of a law (of all_laws()).
inline std::vector<LawExample> examples_of(const LawInfo& law) {
  using Values = std::map<std::string, double>;
  const std::string name(law.name);
  const std::string option(law.option);
  const auto spec = [&](const Values& values) {
    LawSpec s{name, {}, values};
    if (!law.option_key.empty()) s.options[std::string(law.option_key)] = option;
    return s;
  };
  const auto with_cone = [](Values values) {
    values["shape"] = 1.0;  // matsuoka_nakai
    return values;
  };
  std::vector<LawExample> list;
  if (name == "modified_cam_clay") {
    // the published column collapse; CSL through φ = 0.648 at 1 Pa
    const Values column{{"M", 0.6614},  {"lambda", 0.0186},     {"kappa", 0.001}, {"nu", 0.3},
                        {"p_ref", 1.0}, {"Gamma", 1.0 / 0.648}, {"rho_p", 2000.0}};
    const Values kaolin{{"M", 0.888}, {"lambda", 0.161}, {"kappa", 0.062},
                        {"nu", 0.3},  {"Gamma", 2.759},  {"p_ref", 1e3}};
    Values shifted = column;
    shifted["p_shift"] = 50.0;
    if (option == "ln_v-ln_p") {
      list.push_back({"column", spec(column), 1e3, 1e-3, 1e-4});
      list.push_back({"column_shifted", spec(shifted), 1e3, 1e-3, 1e-4});
      Values sand = kaolin;  // the same compressibility, read on the other axes
      sand["lambda"] /= 2.2;
      sand["kappa"] /= 2.2;
      list.push_back({"kaolin_in_ln_v", spec(sand), 1e5, 2e-2, 1.0});
      list.push_back({"kaolin_in_ln_v_cone", spec(with_cone(sand)), 1e5, 2e-2, 1.0});
      list.push_back({"column_cone", spec(with_cone(shifted)), 1e3, 1e-3, 1e-4});
    } else {
      list.push_back({"kaolin", spec(kaolin), 1e5, 2e-2, 1.0});
      list.push_back({"kaolin_cone", spec(with_cone(kaolin)), 1e5, 2e-2, 1.0});
      list.push_back({"column_in_v", spec(column), 1e3, 1e-3, 1e-4});
    }
  } else if (name == "mu_i") {
    Values column{{"mu_0", 0.3819},  {"mu_d", 0.5718},  {"I_0", 0.279}, {"d", 0.0053},
                  {"rho_p", 2000.0}, {"rho_0", 1300.0}, {"K", 254800.0}};
    list.push_back({"column", spec(column), 1e3, 5e-3, 1e-4});
    // (it yields, and flows steadily, after less strain)
    list.push_back({"column_cone", spec(with_cone(column)), 1e3, 4e-3, 1e-4});
    column["K"] = 26000.0;
    list.push_back({"soft_column", spec(column), 1e3, 2e-2, 1e-4});
    if (option == "elastoviscoplastic") {
      column["mu_d"] = column["mu_0"];
      list.push_back({"constant_friction", spec(column), 1e3, 2e-2, 1e-4});
      list.push_back({"constant_friction_cone", spec(with_cone(column)), 1e3, 2e-2, 1e-4});
    }
  } else if (name == "newtonian") {
    list.push_back(
        {"column", spec({{"eta", 0.002}, {"K", 26000.0}, {"rho_0", 1300.0}}), 1e3, 1e-2, 1e-4});
    list.push_back({"linear_pressure",
                    spec({{"eta", 10.0}, {"K", 26000.0}, {"rho_0", 1300.0}, {"alpha", 1.0}}), 1e3,
                    1e-2, 1e-4});
  }
  if (name == "critical_state_mu_i") {
    // the column's clay at rest and its grains in flow: M_∞ = √3 μ_d, I_M = I_0/√3
    Values grains{{"M", 0.6614},  {"lambda", 0.0186},     {"kappa", 0.001},  {"nu", 0.3},
                  {"p_ref", 1.0}, {"Gamma", 1.0 / 0.648}, {"rho_p", 2000.0}, {"d", 0.0053},
                  {"I_v", 0.5},   {"M_inf", 0.9904},      {"I_M", 0.1611}};
    list.push_back({"column", spec(grains), 1e3, 1e-3, 1e-4});
    list.push_back({"column_cone", spec(with_cone(grains)), 1e3, 1e-3, 1e-4});
    grains.erase("I_v");
    list.push_back({"column_of_one_volume", spec(grains), 1e3, 1e-3, 1e-4});
    const Values kaolin{{"M", 0.888},  {"lambda", 0.161 / 2.2}, {"kappa", 0.062 / 2.2},
                        {"nu", 0.3},   {"Gamma", 2.759},        {"p_ref", 1e3},
                        {"d", 1e-6},   {"M_inf", 1.3 * 0.888},  {"I_M", 1e-11},
                        {"I_v", 3e-10}};
    list.push_back({"kaolin", spec(kaolin), 1e5, 2e-2, 1e3});
  }
  if (name == "neo_hookean") {
    list.push_back({"rubber", spec({{"E", 1e7}, {"nu", 0.3}, {"rho_0", 1000.0}}), 1e5, 2e-2, 1e-4});
    list.push_back({"cork", spec({{"E", 1e5}, {"nu", 0.0}, {"rho_0", 200.0}}), 3e3, 0.05, 1e-3});
  }
  if (list.empty()) ADD_FAILURE() << "no example for law " << name << " " << option;
  return list;
}

template <class L>
std::vector<LawExample> examples_of() {
  return examples_of(LawMaterial<L>::info());
}

template <class L>
typename L::template Params<double> parameters_of(const LawExample& example) {
  return L::template Params<double>::from(checked_parameters(example.spec));
}

/// One material point of law L and the step it is about to take.
template <class L>
struct LawPoint {
  Sym<double, 6> stress;
  typename L::template State<double> state{};
  double density = 0.0;

  template <int N>
  bool step(const typename L::template Params<double>& P, const Sym<double, N>& strain, double dt) {
    Increment<double, N> inc{strain, dt, density * std::exp(-trace(strain))};
    Sym<double, N> now = truncated<N>(stress);
    const bool failed = L::update(P, inc, now, state);
    for (int k = 0; k < N; ++k) stress[k] = now[k];
    if (!failed) density = inc.density;
    return failed;
  }
  template <int N, class T>
  static Sym<T, N> truncated(const Sym<T, 6>& full) {
    Sym<T, N> r;
    for (int k = 0; k < N; ++k) r[k] = full[k];
    return r;
  }
  bool apart() const {
    if constexpr (L::state.size() == 2) return state[1] > 0.0;
    return false;
  }
};

/// Every number of two points alike to the last bit (NaN included).
template <class L>
bool same_bits(const LawPoint<L>& a, const LawPoint<L>& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  bool all = same(a.density, b.density);
  for (int k = 0; k < 6; ++k) all = all && same(a.stress[k], b.stress[k]);
  for (std::size_t k = 0; k < L::state.size(); ++k) all = all && same(a.state[k], b.state[k]);
  return all;
}

/// Laws without a yield surface: elastic, or viscous at once.
template <class L>
constexpr bool yields = L::name != "newtonian" && L::name != "neo_hookean";

/// Does the point stay as it is while nothing moves? (A stress beyond yield, if a law lets it be,
/// relaxes.)
template <class L>
bool rests(const typename L::template Params<double>& P, const LawPoint<L>& point) {
  if constexpr (requires { L::rate_dependent; })
    return L::yield(P, point.stress, point.state, point.density, Sym<double, 6>{}) <= 0.0;
  return true;
}

/// Laws whose pressure may be negative.
template <class L>
constexpr bool carries_tension = L::name == "neo_hookean" ||
                                 (L::name == "newtonian" && L::option == "false");

/// Seeded, so that a failure repeats.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  /// 10^[low, high]
  double decade(double low, double high) { return std::pow(10.0, (*this)(low, high)); }
  /// Components of the given size, `plane`: yz = zx = 0.
  Sym<double, 6> tensor(double size, bool plane = false) {
    Sym<double, 6> r;
    for (int k = 0; k < 6; ++k) r[k] = size * (*this)(-1.0, 1.0);
    if (plane) r[4] = r[5] = 0.0;
    return r;
  }

 private:
  std::mt19937_64 engine_;
};

/// A point with a history: from rest through a few random steps, elastic, yielding, unloading.
template <class L>
LawPoint<L> random_point(const LawExample& example, const typename L::template Params<double>& P,
                         Random& random, bool plane = false) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    InitialConditions given;
    given.p = example.pressure * random.decade(-0.5, 0.5);
    if (L::state.size() > 0) given.ocr = random.decade(0.0, 0.8);
    const InitialPoint start = L::initial(P, given);
    LawPoint<L> point{start.stress, {}, start.density};
    for (std::size_t k = 0; k < start.state.size(); ++k) point.state[k] = start.state[k];
    bool usable = true;
    for (int step = 0; step < 6 && usable; ++step)
      usable = !point.step(P, random.tensor(example.strain * random.decade(-2.0, 0.0), plane),
                           example.time);
    if (usable && !point.apart() && pressure(point.stress) > 0.0) return point;
  }
  ADD_FAILURE() << example.label << ": no admissible point found";
  return {};
}

inline double largest(const Sym<double, 6>& a) {
  double m = 0.0;
  for (int k = 0; k < 6; ++k) m = std::max(m, std::abs(a[k]));
  return m;
}

/// What a stress after a step is known to, in units of ε: the stresses themselves, a strain known
/// to ε (its modulus times its size), and for a pressure that follows from density a ρ known to ε.
template <class L>
double stress_scale(const typename L::template Params<double>& P, const LawPoint<L>& before,
                    const LawPoint<L>& after, const Sym<double, 6>& strain) {
  const double modulus = std::max(L::modulus(P, before.stress, before.state, before.density),
                                  L::modulus(P, after.stress, after.state, after.density));
  const bool follows_density = L::state.size() == 0;
  // p of a law that adds to ln p is known to ε of the stresses that it is the mean of
  const double p_before = pressure(before.stress);
  const double of_mean = !follows_density && p_before > 0.0
                             ? largest(before.stress) / p_before * largest(after.stress)
                             : 0.0;
  return largest(before.stress) + largest(after.stress) + of_mean +
         modulus * (largest(strain) + (follows_density ? 1.0 : 0.0));
}

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// AllLaws as a list of types for TYPED_TEST_SUITE, and the names of its entries.
template <class>
struct TypesOf;
template <class... L>
struct TypesOf<std::tuple<L...>> {
  using Types = ::testing::Types<L...>;
};
using LawTypes = TypesOf<AllLaws>::Types;
struct LawName {
  template <class L>
  static std::string GetName(int) {  // NOLINT: the name GoogleTest asks for
    std::string name = std::string(L::name) + "_" + std::string(L::option);
    for (char& c : name)
      if (c == '-') c = '_';
    return name;
  }
};

}  // namespace repose
