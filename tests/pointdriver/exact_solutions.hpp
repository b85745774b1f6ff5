#pragma once
/// \file
/// Closed-form responses of modified Cam-Clay (physics.md, exact solutions), as functions of what
/// is prescribed, so that they can be compared at equal strain. Compression positive.

#include <cmath>
#include <utility>

namespace repose::exact {

struct CamClay {
  double M, lambda, kappa, nu;
  bool v_ln_p;  ///< lines straight in v - ln p; otherwise in ln v - ln p
  double Lambda() const { return (lambda - kappa) / lambda; }
  double alpha() const { return 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu); }  ///< G/K
};

struct Point {
  double p, q, eps_v, eps_q;
};

/// F₂(η) = (1/M)[ln|(M+η)/(M−η)| − 2 atan(η/M)]
inline double F2(double M, double eta) {
  return (std::log(std::abs((M + eta) / (M - eta))) - 2.0 * std::atan(eta / M)) / M;
}

/// F₁(η) = −ln|M−η|/(3−M) − ln(M+η)/(3+M) + 6 ln(3−η)/(9−M²)
inline double F1(double M, double eta) {
  return -std::log(std::abs(M - eta)) / (3.0 - M) - std::log(M + eta) / (3.0 + M) +
         6.0 * std::log(3.0 - eta) / (9.0 - M * M);
}

/// Root of a monotone f between a and b (f changes sign) by bisection to the last digit.
template <class F>
double bisect(double a, double b, const F& f) {
  const bool rising = f(b) > 0.0;
  for (int i = 0; i < 200; ++i) {
    const double m = 0.5 * (a + b);
    if (m == a || m == b) break;
    ((f(m) > 0.0) == rising ? b : a) = m;
  }
  return 0.5 * (a + b);
}

/// Undrained triaxial compression at deviatoric (= axial) strain eps_q, from p0 isotropic with
/// p_c0 = R p0 and specific volume v0, which stays.
inline Point undrained(const CamClay& c, double p0, double R, double v0, double eps_q) {
  const double v = c.v_ln_p ? v0 : 1.0;
  const double a = c.alpha();
  const double eta_i = c.M * std::sqrt(R - 1.0);
  const double yield_strain = c.kappa * eta_i / (3.0 * a * v);
  if (eps_q <= yield_strain) return {p0, 3.0 * a * v * eps_q / c.kappa * p0, 0.0, eps_q};
  const double L = c.Lambda();
  const double F2_i = F2(c.M, eta_i), atan_i = std::atan(eta_i / c.M);
  const auto strain = [&](double eta) {
    return yield_strain + c.kappa * L / v * (F2(c.M, eta) - F2_i) +
           c.kappa / (3.0 * a * v) *
               ((1.0 - 2.0 * L) * (eta - eta_i) + 2.0 * L * c.M * (std::atan(eta / c.M) - atan_i));
  };
  const double eta = bisect(eta_i, c.M, [&](double x) { return strain(x) - eps_q; });
  const double p = p0 * std::pow((c.M * c.M + eta_i * eta_i) / (c.M * c.M + eta * eta), L);
  return {p, eta * p, 0.0, eps_q};
}

/// Drained triaxial compression (σ_r constant) at axial strain eps_a. Exact for ln v - ln p lines
/// (v = 1 in the formulas).
inline Point drained(const CamClay& c, double p0, double R, double eps_a) {
  const double a = c.alpha();
  const double p_c0 = R * p0;
  const auto elastic = [&](double p) {
    return Point{p, 3.0 * (p - p0), c.kappa * std::log(p / p0), c.kappa / a * std::log(p / p0)};
  };
  const auto axial = [](const Point& x) { return x.eps_q + x.eps_v / 3.0; };
  // yield: 9(p − p0)² = M² p (p_c − p)
  const double M2 = c.M * c.M;
  const double A = 9.0 + M2, B = -(18.0 * p0 + M2 * p_c0), C = 9.0 * p0 * p0;
  const double p_y = (-B + std::sqrt(B * B - 4.0 * A * C)) / (2.0 * A);
  const Point y = elastic(p_y);
  if (eps_a <= axial(y)) {
    const double p = bisect(p0, p_y, [&](double x) { return axial(elastic(x)) - eps_a; });
    return elastic(p);
  }
  const double eta_y = y.q / y.p;
  const double F_y = F1(c.M, eta_y) + F2(c.M, eta_y);
  const auto plastic = [&](double eta) {
    const double p = 3.0 * p0 / (3.0 - eta);
    const double eps_v = c.kappa * std::log(p / p0) +
                         (c.lambda - c.kappa) * std::log(p * (1.0 + eta * eta / M2) / p_c0);
    const double eps_q =
        (c.lambda - c.kappa) * (F1(c.M, eta) + F2(c.M, eta) - F_y) + c.kappa / a * std::log(p / p0);
    return Point{p, eta * p, eps_v, eps_q};
  };
  const double eta = bisect(eta_y, c.M, [&](double x) { return axial(plastic(x)) - eps_a; });
  return plastic(eta);
}

/// The stress ratio η of one-dimensional normal compression:
/// (1+ν)(1−Λ)η/(3(1−2ν)) + 3Λη/(M²−η²) = 1.
inline double one_dimensional_ratio(const CamClay& c) {
  const double L = c.Lambda();
  return bisect(0.0, c.M * (1.0 - 1e-12), [&](double eta) {
    return (1.0 + c.nu) * (1.0 - L) * eta / (3.0 * (1.0 - 2.0 * c.nu)) +
           3.0 * L * eta / (c.M * c.M - eta * eta) - 1.0;
  });
}
inline double K0(double eta) { return (3.0 - eta) / (3.0 + 2.0 * eta); }

/// Isotropic state after loading to the largest pressure p_max ≥ p_c0 and now at p: change of ln v
/// (or of v), compression positive.
inline double isotropic_compression(const CamClay& c, double p0, double p_c0, double p_max,
                                    double p) {
  const double p_c = std::max(p_c0, p_max);
  return c.lambda * std::log(p_c / p_c0) + c.kappa * std::log(p_c0 / p0) -
         c.kappa * std::log(p_c / p);
}

}  // namespace repose::exact
