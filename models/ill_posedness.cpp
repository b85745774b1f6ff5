#include "models/ill_posedness.hpp"

#include <cmath>

#include "models/all_laws.hpp"
#include "models/registry.hpp"
#include "models/shear_response.hpp"

namespace repose {

double ill_posedness(const ShearResponse& response) {
  return response.slope * response.slope - 4.0 * response.chi * (1.0 - response.chi);
}

double growth_of_direction(const ShearResponse& response, double beta) {
  return (1.0 - response.chi) * (1.0 - beta * beta) / (1.0 - response.slope * beta) - 1.0;
}

double fastest_direction(const ShearResponse& response) {
  const double m = response.slope;
  return m / (1.0 + std::sqrt(1.0 - m * m));  // (1 − √(1 − m²))/m without cancellation
}

double lower_neutral_inertial_number(double mu_0, double mu_d, double I_0) {
  // in x = I/(I_0 + I): μ = μ_0 + Δμ x, χ = Δμ x(1 − x)/μ
  const auto C = [&](double x) {
    const double mu = mu_0 + (mu_d - mu_0) * x;
    const double chi = (mu_d - mu_0) * x * (1.0 - x) / mu;
    return ill_posedness({mu, chi, mu * (1.0 - 0.5 * chi)});
  };
  // C > 0 at x = 0, where χ = 0; the first interval of a fine walk in which it falls below 0
  constexpr int steps = 1000;
  for (int i = 1; i <= steps; ++i) {
    if (C(static_cast<double>(i) / steps) > 0.0) continue;
    double low = static_cast<double>(i - 1) / steps, high = static_cast<double>(i) / steps;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (C(middle) > 0.0 ? low : high) = middle;
    }
    return I_0 * high / (1.0 - high);
  }
  return std::nan("");
}

std::optional<ShearResponse> shear_response(const Material& material, double p, double gamma_dot) {
  if (!(p > 0.0) || !(gamma_dot > 0.0)) return {};
  using Response = std::optional<ShearResponse>;
  const LawInfo& law = material.law();
  return visit_law(
      law,
      [&]<class L>(L) -> Response {
        if constexpr (HasSteadyShear<L>)
          return shear_response<L>(material.theta(), p, gamma_dot);
        else
          return std::nullopt;
      },
      [&]() -> Response {
        const OutsideLaw* outside = find_outside(law);
        if (outside->shear_response == nullptr) return std::nullopt;
        return outside->shear_response(material.theta(), p, gamma_dot);
      });
}

}  // namespace repose
