#pragma once
/// \file
/// A foreign UMAT as a law: its table of parameters and state, made when an input file names it,
/// and known to everything that takes a LawSpec from then on.

#include <optional>
#include <string>
#include <vector>

#include "models/registry.hpp"
#include "umat/in/host_process.hpp"

namespace repose::umat {

inline constexpr std::string_view law_name = "umat";
inline constexpr std::string_view law_doc =
    "a law in a shared library, by the interface of Abaqus/Standard";

/// State variables that repose keeps for a UMAT beside STATEV, behind it in the table of state.
enum OwnState : std::size_t {
  strain_xx,                ///< STRAN as tensor components in repose's order, six of them
  elapsed = strain_xx + 6,  ///< TIME [s]
  increments,               ///< KINC of the next call, less 1
  stored,                   ///< SSE [J/m³]
  spent,                    ///< SPD + SCD [J/m³]
  stiffness,  ///< ρc² of which the step size is made, from DDSDDE [Pa]; 0: not known yet
  own_state_count
};
inline constexpr std::size_t most_statev = most_state_variables - own_state_count;

/// What an input file says of a UMAT, but for the values of its parameters.
struct Description {
  Library library;
  std::vector<std::string> names;      ///< of PROPS; "" for one without: it is called prop_1, …
  std::vector<double> initial_statev;  ///< STATEV at the start, one value for each
  bool has_grain_density = false;      ///< rho_p is a parameter: the law knows a specific volume
  int void_ratio_statev = 0;  ///< the STATEV (from 1) that is the void ratio at the start; 0: none
};

/// Names of the parameters beside PROPS: the first of every UMAT, the second of those that have it.
inline constexpr std::string_view density_name = "rho_0";
inline constexpr std::string_view grain_density_name = "rho_p";
/// "phi_c", or "prop_3" where PROPS(3) has no name.
std::string prop_name(const Description& description, std::size_t i);

/// The library file: `text` as it stands if absolute, else within `folder`, else among the examples
/// that come with repose (../lib/repose/umat seen from the program). Throws InputError("library")
/// where it is none of these, with the file that may have been meant.
std::filesystem::path find_library(const std::string& text, const std::filesystem::path& folder);

/// A fingerprint of the file's bytes. Throws InputError("library").
std::string content_of(const std::filesystem::path& library);

/// Loads the library once, in a process, to see whether it can be. Throws InputError("library", or
/// "symbol").
void check_library(const Library& library);

/// Makes the law known; the LawSpec's option that stands for it (option key "library"). The same
/// description again is the same law. Throws InputError (a name twice, statev out of range).
std::string make_known(const Description& description);

/// The description behind a law; null if it is no UMAT.
const Description* description_of(const LawInfo& law);

/// What of the work of a step a UMAT does not store [J/m³]: what SPD and SCD say has been spent;
/// the rest of the work where they say nothing.
inline double spent_in_step(double spd_before, double spd_after, double sse_before,
                            double sse_after, double work) {
  return spd_after != 0.0 ? spd_after - spd_before : work - (sse_after - sse_before);
}

/// Parameters of a form, in order.
struct Layout {
  std::size_t nprops, nstatv;
  std::size_t rho_0() const { return nprops; }
  std::size_t rho_p() const { return nprops + 1; }             ///< if it has one
  std::size_t own(std::size_t i) const { return nstatv + i; }  ///< position in the table of state
};
inline Layout layout_of(const Description& d) { return {d.library.nprops, d.library.nstatv}; }

/// Stress, STATEV and density at rest. `theta` may hold NaN for rho_0; then the density is NaN
/// unless the conditions give it.
InitialPoint initial_point(const Description& description, std::span<const double> theta,
                           const InitialConditions& given);

}  // namespace repose::umat
