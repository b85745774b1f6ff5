// A law of one's own: a power-law fluid (Ostwald 1925), s = 2 k g^(n-1) D' with g^2 = 2 D':D', and
// p = K (rho/rho_0 - 1). It is written once, for T = double, a SIMD register of points or a dual
// number, then registered and known by name to the point driver, fits and the Material Point
// Method.
#include <cmath>
#include <cstdio>

#include <repose/mpm/step/simulation.hpp>
#include <repose/pointdriver/integrate/register_law.hpp>

using namespace repose;

struct PowerLawFluid : LawDefaults {  // LawDefaults: one form, no state variables, no yield
  static constexpr std::string_view name = "power_law_fluid";
  static constexpr std::string_view doc = "fluid whose viscosity is a power of the shear rate";
  static constexpr bool has_stress_memory = false;  // the stress follows the strain rate at once
  static constexpr std::array<ParamInfo, 4> parameters{
      {{"k", "k", "Pa s^n", "consistency", Need::required, 0.0, positive, Scale::log},
       {"n", "n", "-", "1: Newtonian; < 1: thins", Need::defaulted, 1.0, Range{0.1, 2.0}},
       {"K", "K", "Pa", "bulk modulus", Need::required, 0.0, positive, Scale::log},
       {"rho_0", "rho_0", "kg/m3", "density at p = 0", Need::required, 0.0, positive, Scale::log}}};
  template <class T>
  struct Params {  // the parameter vector by name
    T k, n, K, rho_0;
    static Params from(std::span<const T> t) { return {t[0], t[1], t[2], t[3]}; }
  };

  template <class T, int N>
  static T viscosity(const Params<T>& P, const Sym<T, N>&, const T&, const Sym<T, N>& D) {
    using std::exp, std::log;
    const T g2 = T(2.0) * contract(deviator(D), deviator(D)) + T(1e-12);  // finite at rest
    return P.k * exp(T(0.5) * (P.n - T(1.0)) * log(g2));
  }
  template <class T, int N>  // one step, in place; returns where it failed (select() instead of if)
  static Mask<T> update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& s, State<T>&,
                        StepWork<T>* spent = nullptr) {
    const T per_dt = select(inc.dt > T(0.0), T(T(1.0) / inc.dt), T(0.0));
    const Sym<T, N> D = per_dt * deviator(inc.strain);
    const Sym<T, N> before = deviator(s);
    s = T(2.0) * viscosity(P, s, inc.density, D) * D;
    if (spent != nullptr)  // where the work goes that is not stored
      spent->viscous = T(0.5) * contract(before + s, inc.strain);
    for (int i = 0; i < 3; ++i) s[i] = s[i] - P.K * (inc.density / P.rho_0 - T(1.0));
    return !repose::finite(T(contract(s, s)));
  }
  template <class T, int N>
  static void rate(const Params<T>& P, const Sym<T, N>&, const State<T>&, const T& rho,
                   const Sym<T, N>& D, Branch, Sym<T, N>& ds, State<T>&) {
    ds = Sym<T, N>::isotropic(P.K * rho / P.rho_0 * trace(D));
  }
  template <class T, int N>  // rho c^2, which an explicit step respects
  static T modulus(const Params<T>& P, const Sym<T, N>&, const State<T>&, const T& rho) {
    return P.K * rho / P.rho_0;
  }
  template <class T, int N>  // rho times the integral of p/rho^2
  static T stored_energy(const Params<T>& P, const Sym<T, N>&, const State<T>&, const T& rho) {
    using std::log;
    const T r = rho / P.rho_0;
    return P.K * (r * log(r) - r + T(1.0));
  }
  template <class T, int N>
  static T elastic_volume_strain(const Params<T>& P, const Sym<T, N>&, const State<T>&,
                                 const T& rho) {
    using std::log;
    return log(P.rho_0 / rho);
  }
  static double density_at(const Params<double>& P, double p, double) {
    return P.rho_0 * (1 + p / P.K);
  }
  static InitialPoint initial(const Params<double>& P, const InitialConditions& given) {
    reject_unused(name, given, false, false);  // no ocr, no specific volume
    const Sym<double, 6> stress = initial_stress(given, 0.0);
    return {stress, {}, density_at(P, pressure(stress), 1.0)};
  }
};

int main() {
  point::register_law<PowerLawFluid>();
  const LawSpec syrup{
      "power_law_fluid", {}, {{"k", 3.0}, {"n", 0.5}, {"K", 1e5}, {"rho_0", 1000.0}}};

  // Sheared at constant volume at 0.1, 1, 10 and 100 per second: the stress must be k g^n.
  point::Stage shear;
  shear.kind = point::Kind::simple_shear;
  shear.condition = point::Condition::constant_volume;
  point::PointTest test;
  test.path = point::path_of(point::rate_sweep(shear, 0.1, 100.0, 4, 1.0));
  point::Curve curve;
  const std::vector<double> theta = checked_parameters(syrup);
  point::simulate(find_law(syrup), theta, test, curve);
  std::vector<double> tau;
  point::read_column(find_law(syrup), theta, test, curve, point::Quantity::tau, tau);
  double worst = 0.0;
  for (std::size_t i = 1; i < tau.size(); ++i) {
    const double exact = 3.0 * std::sqrt(0.1 * std::pow(10.0, double(i - 1)));
    worst = std::max(worst, std::abs(tau[i] / exact - 1.0));
    std::printf("tau = %8.4f Pa, k g^n = %8.4f Pa\n", tau[i], exact);
  }

  // And a dam of it breaks.
  mpm::Scene dam;
  dam.domain = {0.5, 0.3, 0.0};
  dam.h = 0.0125;
  mpm::Body body;
  body.name = "dam";
  body.size = {0.1, 0.2, 0.0};
  body.law = syrup;
  dam.bodies = {body};
  mpm::Simulation simulation(dam);
  while (simulation.time() < 0.2) simulation.step(0.2);
  std::printf("after 0.2 s its front is at %.4f m\n", simulation.diagnostics().front_99_m);
  return worst < 1e-6 && tau.size() == 5 && simulation.diagnostics().front_99_m > 0.1 ? 0 : 1;
}
