#include "models/critical_state_mu_i.hpp"

#include <cmath>

namespace repose {
namespace {

// positions in CriticalStateMuI::parameters; those of the law at rest come first
constexpr std::size_t i_M = 0, i_M_inf = 9;

}  // namespace

void CriticalStateMuI::complete(std::vector<double>& t) {
  Clay::complete(t);
  if (!(t[i_M_inf] >= t[i_M]))
    throw InputError("M_inf", "M_inf must be >= M: friction grows with the inertial number");
}

double CriticalStateMuI::density_at(const Params<double>& P, double p, double ocr) {
  return Clay::density_at(P.clay(), p, ocr);
}

InitialPoint CriticalStateMuI::initial(const Params<double>& P, const InitialConditions& given) {
  InitialPoint point = Clay::initial(P.clay(), given, name);
  const double p_c = point.state[Clay::i_p_c];
  point.state[i_ln_p_c] = std::log(p_c);
  if (std::isnan(P.N)) return point;
  // CSM-2 at I = 0: what rounding, or a v that agrees with the line to some digits, has left open
  const double p = pressure(point.stress);
  const double on_lines = Clay::density_at(P.clay(), p, p_c / p);
  if (!(std::abs(point.density / on_lines - 1.0) <= 1e-6))
    throw InputError(
        given.v ? "v" : "density",
        "the initial state says p, p_c and v, and any two of them give the third: v = " +
            std::to_string(P.rho_p / point.density) + ", and on the law's lines it is " +
            std::to_string(P.rho_p / on_lines) + "; leave out v, or ocr, or p");
  point.density = on_lines;
  return point;
}

}  // namespace repose
