#pragma once
/// \file
/// What every constitutive law provides. A law is a struct without data members; its physics is
/// templated on the scalar type (see scalar.hpp) and on the number N of tensor components
/// (sym.hpp).
///
/// Signs inside a law: stress and strain tension positive; p = −tr(σ)/3 compression positive.
/// Density is kinematics, not state: it is handed in, so a law that needs the specific volume takes
/// v = ρ_p/ρ. Finite rotation is taken care of outside (objective.hpp).

#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "models/parameter.hpp"
#include "models/sym.hpp"

namespace repose {

/// The motion of a material point over one step.
template <class T, int N>
struct Increment {
  Sym<T, N> strain;  ///< Δε = D Δt, logarithmic, tension positive [-]
  T dt;              ///< Δt [s]
  T density;         ///< ρ at the end of the step [kg/m³]; at its start it was ρ exp(tr Δε)
};

/// Where the work of a step goes that no state function holds, per mean volume of the step [J/m³]:
///   ½(σ_n + σ_{n+1}):Δε = change of the stored energy + plastic + viscous + hypoelastic +
///   separation
/// up to the error of the step. Each is an integral of its own, from what the law's update has
/// found, by the rule by which the work itself is counted: the mean of the stresses before and
/// after. Derived in physics.md, "Where the work goes".
template <class T>
struct StepWork {
  T plastic = T(0.0);  ///< ½(σ_n + σ_{n+1}):Δε^p with the Δε^p of the update's own flow rule
  T viscous = T(0.0);  ///< ½(s_n + s_{n+1}):Δe of a viscous stress s = 2ηD′
  /// Elastic work that has no potential, ∫ ψ_s (d ln G + dε_v) + …; may have either sign
  T hypoelastic = T(0.0);
  /// What a step that makes or loses contact does without: work of the mean stress over the part of
  /// the strain that meets none, and stored energy that is dropped with the stress. Either sign
  T separation = T(0.0);
};

/// Which branch of an elastoplastic rate is meant. The integrator decides, never the law, so that a
/// right-hand side is smooth between two located yield events.
enum class Branch : std::uint8_t { elastic, plastic };

/// Starting conditions in a user's terms; a law takes what it understands and rejects the rest.
struct InitialConditions {
  std::optional<double> p;        ///< mean pressure [Pa]
  std::optional<double> sigma_v;  ///< vertical stress, with K0, in place of p [Pa]
  std::optional<double> ocr;      ///< p_c/p [-]
  std::optional<double> ocr_v;    ///< greatest vertical stress over the present one [-]
  std::optional<double> K0_nc;    ///< σ_h/σ_v at the greatest one, if not K0 [-]
  std::optional<double> v;        ///< specific volume [-]
  std::optional<double> density;  ///< [kg/m³]
  std::optional<double> K0;       ///< σ_horizontal/σ_vertical, vertical = y [-]
  std::optional<std::array<double, 6>> sigma;  ///< xx,yy,zz,xy,yz,zx, COMPRESSION positive [Pa]
};

/// A material point at rest: Cauchy stress (tension positive), state variables in table order, ρ.
struct InitialPoint {
  Sym<double, 6> stress;
  std::vector<double> state;
  double density = 0.0;
};

/// Is the stress given, and not left to follow from volume?
inline bool states_stress(const InitialConditions& given) {
  return given.p || given.sigma || given.sigma_v;
}

/// The key under which it is given, for messages.
inline const char* stress_key(const InitialConditions& given) {
  return given.sigma ? "sigma" : given.sigma_v ? "sigma_v" : "p";
}

/// The stress of an initial condition: from sigma, from p and K0 (vertical = y), or from sigma_v
/// and K0. p defaults to `default_p`. Throws InputError where two are given or a value is out of
/// range.
Sym<double, 6> initial_stress(const InitialConditions& given, double default_p);

/// Throws InputError if a condition that the law has no use for is given.
void reject_unused(std::string_view law, const InitialConditions& given, bool takes_ocr,
                   bool takes_v);

/// The requirements on a law L. `theta` is a parameter vector in the order of L::parameters.
///
///   name, option_key, option, doc    strings; the option selects among the forms of one name
///                                    ("form", "compression"; empty where a law has one form only)
///   has_stress_memory                the stress at the start of a step matters
///   iterates                         update() runs a loop; batches then go through it two packs at
///                                    a time
///   parameters, state                constexpr tables
///   complete(theta)                  derives absent optional values, checks conditions between
///                                    parameters (κ < λ); throws InputError
///   Params<T>::from(span<T>)         parameter vector → named values: those of the table in its
///                                    order, and nothing else
///   State<T>                         state variables, convertible to and from an array
///   update(P, increment, σ, state, spent)  advances one step in place; returns the mask of points
///                                    that could not be integrated (they are left as they were).
///                                    `spent`, a StepWork of zeros, is null where nobody asks
///   rate(P, σ, state, ρ, D, branch, dσ/dt, dstate/dt)
///   hypoelastic_power(P, σ, state, ρ, D, dσ/dt)  rate of StepWork::hypoelastic [W/m³]
///   yield(P, σ, state, ρ, D)         < 0 elastic, 0 at yield [Pa]; −∞ where a law has no yield
///   modulus(P, σ, state, ρ)          P-wave modulus ρc² [Pa]
///   viscosity(P, σ, ρ, D)            shear viscosity that limits an explicit step [Pa·s]
///   stored_energy(P, σ, state, ρ)    recoverable energy per current volume [J/m³]
///   elastic_volume_strain(P, σ, state, ρ)  −∫dp/K from p = 0 (or where contact is made) [-]
///   density_at(P, p, ocr)            ρ at rest under pressure p [kg/m³]
///   initial(P, conditions)           InitialPoint; throws InputError
/// A law may say more:
///   derived, derive(P, σ, state)     table and values of variables that follow from the state, for
///                                    output (derived_fields())
///   hold_volume(P, denser, state)    for a state that says the volume: a point is held at `denser`
///   >= 1
///                                    times its density
///   rate_dependent                   the plastic rate has terms without D: stress beyond yield
///   flows steady_shear_stress(P, p, γ̇)     τ of steady shear (shear_response.hpp)
/// LawDefaults answers what a simple law has no more to say about.
template <class L>
concept ConstitutiveLaw = requires(const typename L::template Params<double>& P,
                                   const Increment<double, 4>& inc, Sym<double, 4>& stress,
                                   typename L::template State<double>& state, double x,
                                   StepWork<double>* spent, std::vector<double>& theta,
                                   const InitialConditions& given) {
  { L::name } -> std::convertible_to<std::string_view>;
  { L::option_key } -> std::convertible_to<std::string_view>;
  { L::option } -> std::convertible_to<std::string_view>;
  { L::doc } -> std::convertible_to<std::string_view>;
  {std::span<const ParamInfo>(L::parameters)};
  {std::span<const StateField>(L::state)};
  { L::has_stress_memory } -> std::convertible_to<bool>;
  { L::iterates } -> std::convertible_to<bool>;
  {L::complete(theta)};
  { L::update(P, inc, stress, state) } -> std::same_as<bool>;
  { L::update(P, inc, stress, state, spent) } -> std::same_as<bool>;
  {L::rate(P, stress, state, x, stress, Branch::elastic, stress, state)};
  { L::hypoelastic_power(P, stress, state, x, stress, stress) } -> std::same_as<double>;
  { L::yield(P, stress, state, x, stress) } -> std::same_as<double>;
  { L::modulus(P, stress, state, x) } -> std::same_as<double>;
  { L::viscosity(P, stress, x, stress) } -> std::same_as<double>;
  { L::stored_energy(P, stress, state, x) } -> std::same_as<double>;
  { L::elastic_volume_strain(P, stress, state, x) } -> std::same_as<double>;
  { L::density_at(P, x, x) } -> std::same_as<double>;
  { L::initial(P, given) } -> std::same_as<InitialPoint>;
};

/// The table of a law's derived variables; empty for most.
template <class L>
constexpr std::span<const StateField> derived_fields() {
  if constexpr (requires { L::derived; })
    return L::derived;
  else
    return {};
}

/// For a law to inherit: one form, no state variables, no condition between parameters, no yield,
/// and all elastic work stored.
struct LawDefaults {
  static constexpr std::string_view option_key = "";
  static constexpr std::string_view option = "";
  static constexpr bool iterates = false;
  static constexpr std::array<StateField, 0> state{};
  template <class T>
  using State = std::array<T, 0>;
  static void complete(std::vector<double>&) {}
  template <class P, class T, class S, int N>
  static T hypoelastic_power(const P&, const Sym<T, N>&, const S&, const T&, const Sym<T, N>&,
                             const Sym<T, N>&) {
    return T(0.0);
  }
  template <class P, class T, class S, int N>
  static T yield(const P&, const Sym<T, N>&, const S&, const T&, const Sym<T, N>&) {
    return T(-std::numeric_limits<double>::infinity());
  }
};

}  // namespace repose
