#include "pointdriver/study/tangent_convergence.hpp"

#include <cmath>

#include "models/all_laws.hpp"
#include "models/dual.hpp"

namespace repose::point {
namespace {

/// A law, where it starts and the step that it takes.
struct Case {
  LawSpec spec;
  double p;       ///< at the start [Pa]
  double strain;  ///< size of the step [-]
  double dt;      ///< [s]
};

std::vector<Case> cases() {
  using Values = std::map<std::string, double>;
  const Values clay{{"M", 0.888},
                    {"lambda", 0.161},
                    {"kappa", 0.062},
                    {"nu", 0.3},
                    {"Gamma", 2.759}};  // London clay, Schofield & Wroth 1968; nu assumed
  Values other_clay = clay;             // as compressible at v = 2.2
  for (const char* name : {"lambda", "kappa"}) other_clay[name] /= 2.2;
  const Values grains{{"mu_0", 0.3819},  {"mu_d", 0.5718},  {"I_0", 0.279}, {"d", 0.0053},
                      {"rho_p", 2000.0}, {"rho_0", 1300.0}, {"K", 254800.0}};
  const Values fluid{{"eta", 0.002}, {"K", 26000.0}, {"alpha", 7.0}, {"rho_0", 1300.0}};
  std::vector<Case> list;
  for (const LawInfo& law : library_laws()) {
    Case one{{std::string(law.name), {}, grains}, 1e3, 5e-3, 1e-3};
    if (!law.option_key.empty())
      one.spec.options[std::string(law.option_key)] = std::string(law.option);
    if (law.name == "modified_cam_clay")
      one = {{one.spec.name, one.spec.options, law.option == "v-ln_p" ? clay : other_clay},
             1e5,
             2e-2,
             1.0};
    else if (law.name == "critical_state_mu_i") {
      one = {{one.spec.name, {}, other_clay}, 1e5, 2e-2, 1e3};
      one.spec.values.insert({{"M_inf", 1.154}, {"I_M", 1e-11}, {"I_v", 3e-10}, {"d", 1e-6}});
    } else if (law.name == "newtonian")
      one.spec.values = fluid;
    else if (law.name == "neo_hookean")
      one = {{one.spec.name, {}, {{"E", 1e6}, {"nu", 0.3}, {"rho_0", 1000.0}}}, 1e3, 2e-2, 1e-3};
    list.push_back(std::move(one));
  }
  return list;
}

template <class L>
TangentTest test_of(const Case& c) {
  using D = Dual<6>;
  const std::vector<double> theta = checked_parameters(c.spec);
  const auto P = L::template Params<double>::from(theta);
  const std::vector<D> constant(theta.begin(), theta.end());
  const auto P_dual = L::template Params<D>::from(std::span<const D>(constant));
  InitialConditions given;
  given.p = c.p;
  const InitialPoint start = L::initial(P, given);
  // compression and shear in all planes; the direction of the perturbation is another
  Sym<double, 6> step, direction;
  const std::array<double, 6> shape{-0.5, -0.7, 0.3, 0.6, -0.4, 0.2};
  const std::array<double, 6> other{0.3, -0.4, -0.3, 0.5, 0.4, -0.5};
  for (std::size_t k = 0; k < 6; ++k) {
    step.c[k] = c.strain * shape[k];
    direction.c[k] = other[k];
  }

  Increment<D, 6> inc;
  Sym<D, 6> stress;
  typename L::template State<D> state{};
  for (int k = 0; k < 6; ++k) {
    inc.strain[k] = D(step[k], k);
    stress[k] = D(start.stress[k]);
  }
  for (std::size_t k = 0; k < L::state.size(); ++k) state[k] = D(start.state[k]);
  inc.dt = D(c.dt);
  inc.density = D(start.density) * exp(-trace(inc.strain));
  L::update(P_dual, inc, stress, state);
  Sym<double, 6> end, change;  // σ and C:d
  for (int k = 0; k < 6; ++k) {
    end[k] = stress[k].a;
    change[k] = 0.0;
    for (int j = 0; j < 6; ++j) change[k] += stress[k].v[j] * direction[j];
  }

  const auto stress_at = [&](double h) {
    Sym<double, 6> strain = step, sigma = start.stress;
    for (int k = 0; k < 6; ++k) strain[k] += h * c.strain * direction[k];
    typename L::template State<double> s{};
    for (std::size_t k = 0; k < L::state.size(); ++k) s[k] = start.state[k];
    const Increment<double, 6> i{strain, c.dt, start.density * std::exp(-trace(strain))};
    L::update(P, i, sigma, s);
    return sigma;
  };
  TangentTest test;
  test.name = L::option_key[0] == 0 ? std::string(L::name)
                                    : std::string(L::name) + ", " + std::string(L::option);
  const double scale = c.strain * norm(change);
  for (int i = 0; i <= 25; ++i) {
    const double h = std::pow(10.0, -1.0 - 0.2 * i);
    const Sym<double, 6> miss = stress_at(h) - end - h * c.strain * change;
    test.points.push_back({h, norm(miss) / scale});
  }
  // round-off of the stresses themselves, against the remainder
  const double noise = 100.0 * std::numeric_limits<double>::epsilon() * norm(end) / scale;
  std::size_t last = 0;
  while (last + 1 < test.points.size() && test.points[last + 1].remainder > 100.0 * noise) ++last;
  const TangentPoint &a = test.points.front(), &b = test.points[last];
  test.order = std::log(a.remainder / b.remainder) / std::log(a.h / b.h);
  return test;
}

}  // namespace

std::vector<TangentTest> tangent_convergence() {
  std::vector<TangentTest> tests;
  for (const Case& c : cases())
    tests.push_back(
        visit_law(find_law(c.spec), [&](auto law) { return test_of<decltype(law)>(c); }));
  return tests;
}

}  // namespace repose::point
