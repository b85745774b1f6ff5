#include "models/modified_cam_clay.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace repose {
namespace {

// positions in ModifiedCamClay::parameters
constexpr std::size_t i_lambda = 1, i_kappa = 2, i_Gamma = 4, i_N = 5;

template <Compression compression>
using Law = ModifiedCamClay<compression>;

/// v on the line through p_c with swelling back to p (MCC-5).
template <Compression compression>
double volume_on_lines(const typename Law<compression>::template Params<double>& P, double p,
                       double p_c) {
  const double drop = P.lambda * std::log(p_c / P.p_ref) - P.kappa * std::log(p_c / p);
  return compression == Compression::ln_v_ln_p ? P.N * std::exp(-drop) : P.N - drop;
}

/// ln of v(p_ref)/v, or v(p_ref) − v: the distance down the lines to a known v.
template <Compression compression>
double drop_to(const typename Law<compression>::template Params<double>& P, double v) {
  return compression == Compression::ln_v_ln_p ? std::log(P.N / v) : P.N - v;
}

std::string digits(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", x);
  return text.data();
}

/// p_c of the yield surface through the stress under the greatest vertical stress, ocr_v times the
/// present one, with the ratio K0_nc or else that of the present stress.
template <Compression compression>
double greatest_p_c(const typename Law<compression>::template Params<double>& P,
                    const InitialConditions& given, const Sym<double, 6>& stress) {
  const double vertical = -stress[1];
  const double K0 = given.K0_nc.value_or(0.5 * (stress[0] + stress[2]) / stress[1]);
  const double greatest = *given.ocr_v * vertical;
  const double p = greatest * (1.0 + 2.0 * K0) / 3.0 + P.p_shift;
  const double third = greatest * (1.0 - K0) / 3.0;  // a fall of the horizontal stress
  const Sym<double, 6> s{{third, -2.0 * third, third}};
  return p + square(greatest * (1.0 - K0) / P.slope(s)) / p;
}

}  // namespace

template <Compression compression>
void ModifiedCamClay<compression>::complete(std::vector<double>& t) {
  const double lambda = t[i_lambda];
  const double kappa = t[i_kappa];
  if (!(kappa < lambda))
    throw InputError("kappa", "kappa must be < lambda: swelling is stiffer than compression");
  if (compression == Compression::ln_v_ln_p && !(kappa < 1.0))
    throw InputError("kappa",
                     "kappa must be < 1 for ln_v-ln_p: beyond it, unloading to p = 0 would release "
                     "infinite energy");
  double& Gamma = t[i_Gamma];
  double& N = t[i_N];
  const double distance = (lambda - kappa) * std::numbers::ln2;
  const auto N_of = [&](double G) {
    return compression == Compression::ln_v_ln_p ? G * std::exp(distance) : G + distance;
  };
  if (!std::isnan(Gamma) && !std::isnan(N)) {
    if (std::abs(N - N_of(Gamma)) > 1e-9 * N)
      throw InputError("N",
                       "give Gamma or N, not both: one follows from the other (N - Gamma is fixed "
                       "by lambda - kappa)");
  } else if (!std::isnan(Gamma)) {
    N = N_of(Gamma);
  } else if (!std::isnan(N)) {
    Gamma = compression == Compression::ln_v_ln_p ? N * std::exp(-distance) : N - distance;
  }
}

template <Compression compression>
double ModifiedCamClay<compression>::density_at(const Params<double>& P, double p, double ocr) {
  if (std::isnan(P.N))
    throw InputError("Gamma",
                     "the density under a given pressure needs Gamma (or N), v or density");
  const double effective = std::max(p + P.p_shift, contact_pressure(P));
  const double v = volume_on_lines<compression>(P, effective, ocr * effective);
  if (!(v > 1.0))
    throw InputError(
        "Gamma",
        "the compression line gives a specific volume <= 1 (no voids) at the initial pressure");
  return P.rho_p / v;
}

template <Compression compression>
InitialPoint ModifiedCamClay<compression>::initial(const Params<double>& P,
                                                   const InitialConditions& given,
                                                   std::string_view law) {
  reject_unused(law, given, true, true);
  if (given.v && given.density)
    throw InputError("v", "give either v or density: v = rho_p/density");
  if (given.ocr && given.ocr_v)
    throw InputError("ocr_v",
                     "give either ocr = p_c/p or ocr_v = sigma_v,max/sigma_v (vertical stresses)");
  if (given.ocr && !(*given.ocr >= 1.0 && std::isfinite(*given.ocr)))
    throw InputError("ocr", "ocr = p_c/p must be >= 1");
  if (given.ocr_v && !(*given.ocr_v >= 1.0 && std::isfinite(*given.ocr_v)))
    throw InputError("ocr_v", "ocr_v = sigma_v,max/sigma_v must be >= 1");
  if (given.K0_nc && !given.ocr_v)
    throw InputError("K0_nc",
                     "K0_nc is the stress ratio at the greatest vertical stress and belongs "
                     "to ocr_v, which is not given");
  if (given.K0_nc && !(*given.K0_nc > 0.0 && std::isfinite(*given.K0_nc)))
    throw InputError("K0_nc", "K0_nc = sigma_horizontal/sigma_vertical must be > 0");
  std::optional<double> v = given.v;
  if (given.density) v = P.rho_p / *given.density;
  if (v && !(*v > 1.0 && std::isfinite(*v)))
    throw InputError(given.v ? "v" : "density",
                     "the specific volume v = rho_p/density must be > 1");
  const bool has_line = !std::isnan(P.N);

  InitialPoint point;
  double p_c = 0.0;
  if (!states_stress(given)) {
    // v and ocr on the compression line give p
    if (!v) throw InputError("p", std::string(law) + " needs an initial p, sigma, v or density");
    if (!has_line) throw InputError("Gamma", "finding p from the specific volume needs Gamma or N");
    if (given.ocr_v && P.p_shift > 0.0)
      throw InputError("ocr_v", "with p_shift, ocr_v needs an initial p, sigma_v or sigma");
    double ocr = given.ocr.value_or(1.0);
    if (given.ocr_v) {
      // all stresses grow alike, so p_c/p is that of any p
      InitialConditions unit = given;
      unit.p = 1.0;
      const Sym<double, 6> at = initial_stress(unit, 0.0);
      ocr = greatest_p_c<compression>(P, given, at) / pressure(at);
    }
    p_c = P.p_ref * std::exp((drop_to<compression>(P, *v) + P.kappa * std::log(ocr)) / P.lambda);
    InitialConditions derived = given;
    derived.p = p_c / ocr - P.p_shift;
    point.stress = initial_stress(derived, 0.0);
  } else {
    point.stress = initial_stress(given, 0.0);
  }
  const double p = pressure(point.stress) + P.p_shift;
  if (!(p > contact_pressure(P)))
    throw InputError(stress_key(given),
                     "the initial p must be > p_sep, and compression is positive: below it the "
                     "point carries no stress");
  const double q = mises(point.stress);
  const double p_c_yield =
      p + square(q / P.slope(deviator(point.stress))) / p;  // F = 0 solved for p_c (MCC-1)
  const bool volume_is_free = p_c == 0.0;
  if (volume_is_free) {
    if (given.ocr) {
      p_c = *given.ocr * p;
    } else if (given.ocr_v) {
      p_c = greatest_p_c<compression>(P, given, point.stress);
    } else if (v && has_line) {
      // (v, p): ln v = ln N − λ ln(p_c/p_ref) + κ ln(p_c/p), or the same in v
      const double drop = drop_to<compression>(P, *v);
      p_c = P.p_ref * std::exp((drop - P.kappa * std::log(p / P.p_ref)) / (P.lambda - P.kappa));
    } else {
      p_c = p_c_yield;
    }
  }
  if (p_c < p_c_yield * (1.0 - 1e-12))
    throw InputError(
        given.ocr ? "ocr" : (given.ocr_v ? "ocr_v" : (given.K0 ? "K0" : stress_key(given))),
        "the initial stress lies outside the yield surface: p_c = " + std::to_string(p_c) +
            " Pa, and this stress needs p_c >= " + std::to_string(p_c_yield) + " Pa" +
            (given.ocr && given.K0 ? "; ocr is p_c/p, of mean stresses: the ratio of vertical "
                                     "stresses sigma_v,max/sigma_v is ocr_v"
                                   : ""));
  if (volume_is_free && v && has_line && (given.ocr || given.ocr_v)) {
    const double on_lines = volume_on_lines<compression>(P, p, p_c);
    if (!(std::abs(*v - on_lines) <= 0.005 * on_lines))
      throw InputError(given.v ? "v" : "density",
                       "the initial state contradicts itself: v is " + digits(*v) +
                           ", and at p = " + digits(p - P.p_shift) + " Pa with p_c = " +
                           digits(p_c) + " Pa the compression line (Gamma or N) says " +
                           digits(on_lines) + "; leave out v, ocr or p, or Gamma and N");
  }
  point.density = v ? P.rho_p / *v : P.rho_p / [&] {
    if (!has_line)
      throw InputError("Gamma", "the initial specific volume needs Gamma (or N), v or density");
    const double on_lines = volume_on_lines<compression>(P, p, p_c);
    if (!(on_lines > 1.0))
      throw InputError(
          "Gamma",
          "the compression line gives a specific volume <= 1 (no voids) at the initial pressure");
    return on_lines;
  }();
  point.state = {p_c, 0.0};
  return point;
}

template struct ModifiedCamClay<Compression::ln_v_ln_p>;
template struct ModifiedCamClay<Compression::v_ln_p>;

}  // namespace repose
