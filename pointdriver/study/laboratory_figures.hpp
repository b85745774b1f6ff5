#pragma once
/// \file
/// What a report on a laboratory test quotes, read off its curve: strength, friction, stiffness,
/// and the branches of compression. Stresses effective and compression positive, angles in degrees;
/// what a test does not show is absent, or NaN.

#include <optional>
#include <span>
#include <vector>

#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// What becomes of a quantity after its largest value, in the leg (a stage, or half a cycle) that
/// has it.
enum class After : std::uint8_t {
  peak,     ///< it falls again, by more than 1 %
  plateau,  ///< it changes by less than 1 % over the last tenth of the rows
  rising,   ///< the leg ended on the way: the largest value is no strength
};

/// The largest shear stress carried at constant volume.
struct UndrainedStrength {
  int stage = 0;
  double S_u = 0.0;  ///< triaxial: |σ_a − σ_r|/2; simple shear: |τ|, in the sense of the shear [Pa]
  double strain = 0.0;  ///< there, from the start of the stage: ε_a, or γ [-]
  After after = After::rising;
  /// Skempton's A = (Δu − Δσ_3)/(Δσ_1 − Δσ_3) there, in total stresses with σ_r kept; NaN in shear.
  double A_f = 0.0;
};

/// Mobilised friction, sin φ′ = (σ′_1 − σ′_3)/(σ′_1 + σ′_3), in the sense of the shear.
struct Friction {
  int stage = 0;
  double peak = 0.0;    ///< the largest after the start of a shear stage [deg]
  double strain = 0.0;  ///< there, from the start of the stage: ε_a, or γ, or ε_q [-]
  After after = After::rising;
  double end = 0.0;      ///< in the last row; NaN in tension [deg]
  bool tension = false;  ///< σ′_3 fell below zero, where no angle is: `peak` is of the other rows
  /// Of the law's critical state (M, or √3 μ_0 of grains at rest) at this test's intermediate
  /// stress: b = 0 in triaxial compression, 1 in extension, 1/2 in plane strain; otherwise that of
  /// the last row. NaN for a law without one. [deg]
  double critical = 0.0;
  double b = 0.0;  ///< (σ′_2 − σ′_3)/(σ′_1 − σ′_3) that `critical` is for
  /// Simple shear: the largest τ/σ′_yy as an angle; NaN otherwise. [deg]
  double on_plane = 0.0;
};

/// Secant modulus from the start of a shear stage, of triaxial tests at constant σ_r (or volume),
/// of laws that remember their stress.
struct Stiffness {
  int stage = 0;       ///< with the largest change of q
  double E50 = 0.0;    ///< Δq/Δε_a where half of the largest change of q is reached [Pa]
  double eps_a = 0.0;  ///< Δε_a there [-]
};

struct SecantShear {
  int stage = 0;
  double gamma = 0.0;  ///< |γ| since the start of the stage (triaxial: ε_a − ε_r, logarithmic) [-]
  double G = 0.0;  ///< Δτ/Δγ (triaxial: Δq/2 over γ); NaN beyond the stage's own strains [Pa]
};

/// One way in compression: oedometer (x = σ′_a) or isotropic (x = p′).
struct CompressionBranch {
  enum class Way : std::uint8_t { virgin, unloading, reloading };
  int stage = 0;
  Way way = Way::virgin;
  double from = 0.0, to = 0.0;  ///< x where the branch begins and ends [Pa]
  /// −Δe/Δlog₁₀ x: of virgin compression over its last doubling of x, otherwise over the branch;
  /// NaN for a law without specific volume.
  double C = 0.0;
  double K0 = 0.0;  ///< σ′_r/σ′_a at its end [-]
  /// The largest x that the material has carried over x at the branch's end; NaN as long as that is
  /// not known (an oedometer whose start says ocr, of mean stresses, before it yields). [-]
  double OCR = 1.0;
  /// Δln p′/Δln x over the same rows as C: 1 if K0 stays as it is.
  double p_over_x = 1.0;
  /// −Δe/Δlog₁₀ x over κ ln 10 (times the mean v for lines in ln v); NaN without κ, or virgin.
  double C_over_kappa = 0.0;
};

struct LaboratoryFigures {
  std::optional<UndrainedStrength> undrained;
  std::optional<Friction> friction;
  std::optional<Stiffness> stiffness;
  std::vector<SecantShear> secants;
  std::vector<CompressionBranch> compression;
  bool oedometer = false;  ///< x of the branches is σ′_a
};

/// secants_at: shear strains at which each shear stage's secant modulus is wanted; the stage is
/// driven there once more, so that the rows of the curve do not matter.
LaboratoryFigures laboratory_figures(const LawInfo& law, std::span<const double> theta,
                                     const PointTest& test, const Curve& curve,
                                     std::span<const double> secants_at = {});

/// φ of a critical state q = M p at the intermediate stress b [deg]: with Δ = M p/√(1 − b + b²),
///     sin φ = Δ/(2p + Δ(1 − 2b)/3)
/// which is 3M/(6 + M) in compression, 3M/(6 − M) in extension and M/√3 for b = 1/2; NaN where no
/// such stress exists.
double critical_friction_angle(double M, double b);

}  // namespace repose::point
