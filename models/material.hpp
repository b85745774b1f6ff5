#pragma once
/// \file
/// The boundary between a law and everything that moves material points: one virtual call per batch
/// of points in structure-of-arrays form, never one per point.

#include <cstddef>
#include <memory>
#include <string>

#include "models/law.hpp"
#include "models/padding.hpp"

namespace repose {

/// Room for the state variables of a law: those of the library need no more than four, a foreign
/// one (umat/in) brings its own.
inline constexpr std::size_t most_state_variables = 64;

/// A run of material points with N tensor components (sym.hpp). Every array has room for
/// padded(count) entries (padding.hpp), and the entries behind `count` hold copies of valid points.
template <int N>
struct BatchOf {
  static constexpr auto components = static_cast<std::size_t>(N);
  std::size_t count = 0;
  double dt = 0.0;                                 ///< [s]
  std::array<const double*, components> strain{};  ///< Δε = sym(L) Δt, tension positive
  /// The step's rotation vector, ½ rot v Δt: about z in plane strain, about x, y and z in three
  /// dimensions [rad]; null for none
  std::array<const double*, N == 4 ? 1 : 3> spin{};
  double* density = nullptr;  ///< in: at the start of the step; out: its end [kg/m³]
  std::array<double*, components> stress{};  ///< Cauchy, tension positive [Pa]; updated in place
  /// State variables in table order; updated in place
  std::array<double*, most_state_variables> state{};
  double* modulus = nullptr;    ///< out, optional: ρc² [Pa]
  double* viscosity = nullptr;  ///< out, optional: shear viscosity limiting the step [Pa s]
  double* work = nullptr;  ///< out, optional: ½(σ_n + σ_{n+1}):Δε, energy per mean volume [J/m³]
  /// Out, optional: what of it the law does not store (StepWork, law.hpp) [J/m³]. What a law that
  /// remembers its stress dissipates is plastic, else viscous; the other two are filled as well.
  double* plastic = nullptr;
  double* viscous = nullptr;
  double* hypoelastic = nullptr;
  double* separation = nullptr;
};
using Batch = BatchOf<4>;         ///< plane strain
using SpatialBatch = BatchOf<6>;  ///< three dimensions

/// What a law is called and made of, for help texts and readers of input files.
struct LawInfo {
  std::string_view name;        ///< "mu_i"
  std::string_view option_key;  ///< "form"; empty if the law has one form only
  std::string_view option;      ///< "regularised"
  std::string_view doc;
  std::span<const ParamInfo> parameters;
  std::span<const StateField> state;
  bool has_stress_memory;                 ///< the stress at the start of a step matters
  std::span<const StateField> derived{};  ///< variables that follow from the state, for output
};

/// The outcome of a batch: all points advanced, or the first one that could not be.
struct UpdateReport {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t failed = none;
  std::string reason{};  ///< what the law itself says of it; empty where the numbers say all
  bool ok() const { return failed == none; }
};

/// A law with its parameters.
class Material {
 public:
  virtual ~Material();
  Material(const Material&) = delete;
  Material& operator=(const Material&) = delete;

  virtual const LawInfo& law() const = 0;
  /// Parameters in table order, derived ones filled in; NaN for optional ones that stay absent.
  std::span<const double> theta() const { return theta_; }
  double parameter(std::string_view parameter_name) const;

  /// Rotates, strains and updates the points of a batch. A point that cannot be updated (an input
  /// that is not a number, a step beyond any stress) keeps its stress, state and density to the
  /// last bit, does no work, and is reported.
  virtual UpdateReport update(const Batch& batch) const = 0;
  virtual UpdateReport update(const SpatialBatch& batch) const = 0;

  /// Tells points that the solver has not let dilate as far as their strain said, at `denser` >= 1
  /// times the density that the update left: where a state says the volume, it follows.
  virtual void hold_volume(const Batch& /*batch*/, const double* /*denser*/) const {}
  virtual void hold_volume(const SpatialBatch& /*batch*/, const double* /*denser*/) const {}

  /// Recoverable energy per current volume of each point [J/m³].
  virtual void stored_energy(const Batch& batch, double* energy) const = 0;
  virtual void stored_energy(const SpatialBatch& batch, double* energy) const = 0;

  /// ρc² [Pa] of each point as it is.
  virtual void modulus(const Batch& batch, double* rho_c2) const = 0;
  virtual void modulus(const SpatialBatch& batch, double* rho_c2) const = 0;

  /// Elastic volume strain of each point, extension positive, −∫dp/K from where it carries no
  /// pressure [-]; 0 for one that carries none.
  virtual void elastic_volume_strain(const Batch& batch, double* strain) const = 0;

  /// Shear viscosity η [Pa s] of each point at the batch's density and strain rate strain/dt, and
  /// how it thins, −d ln η/d ln γ̇ (0 where η = 0). For laws without stress memory: s = 2ηD′.
  virtual void viscosity(const Batch& batch, double* eta, double* thinning) const = 0;

  /// Throws InputError if the law cannot start from these conditions.
  virtual InitialPoint initial(const InitialConditions& given) const = 0;

  /// Density at rest under mean pressure p [Pa] (p_c = ocr p where the law knows it) [kg/m³].
  virtual double density_at(double p, double ocr) const = 0;

 protected:
  explicit Material(std::vector<double> theta) : theta_(std::move(theta)) {}

 private:
  std::vector<double> theta_;
};

}  // namespace repose
