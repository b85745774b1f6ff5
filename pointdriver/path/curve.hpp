#pragma once
/// \file
/// A curve: the element's state row by row, and the laboratory quantities read from it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/material.hpp"
#include "pointdriver/path/status.hpp"

namespace repose::point {

/// Variables of a law that a row carries: state, then derived; of a foreign law with more state the
/// first.
inline constexpr std::size_t max_state = 4;

/// The element at one instant. Tensors tension positive; strains logarithmic, zero at the start.
template <class T>
struct Row {
  T time{0.0};              ///< [s]
  Sym<T, 6> strain{};       ///< [-]
  Sym<T, 6> stress{};       ///< [Pa]
  Sym<T, 6> strain_rate{};  ///< [1/s]; only where the test asks for it
  std::array<T, max_state> state{};
  T density{0.0};     ///< [kg/m³]
  T work{0.0};        ///< ∫ J σ:D dt, per initial volume [J/m³]
  T stored{0.0};      ///< recoverable energy since the start, per initial volume [J/m³]
  T dissipated{0.0};  ///< ∫ J σ:D^p dt, viscous flow included, per initial volume [J/m³]
  /// Elastic work that no potential stores (StepWork, models/law.hpp), per initial volume [J/m³]
  T hypoelastic{0.0};
  double residual = 0.0;  ///< relative violation of the prescription (Control::residual) [-]
  int leg = 0;
};

template <class T>
struct BasicCurve {
  std::vector<Row<T>> rows;
  Outcome outcome;
  std::string said;  ///< what the law says of its own failure (Status::law_failed)
};
using Curve = BasicCurve<double>;

/// Which strains and stresses the laboratory calls axial, radial, shear.
enum class Frame : std::uint8_t {
  axisymmetric,  ///< axis y: ε_a = ε_yy, ε_r = mean of xx and zz, q = σ_a − σ_r (signed)
  shear,         ///< shear in xy: γ = 2ε_xy, τ = σ_xy, q ≥ 0
  general,       ///< q = √(3/2 s:s), ε_q = √(2/3 e:e)
};

/// How a strain is measured. Inside, all are logarithmic; where a path or a table counts in
/// engineering strains, ε = 1 − exp(−ε_log): change of length over the length at the start of the
/// test (of the stage, for a stage's own strain), change of volume over the volume there.
enum class StrainMeasure : std::uint8_t { logarithmic, engineering };

/// Columns of curve.csv. Compression positive; units as in the names.
enum class Quantity : std::uint8_t {
  time,
  eps_a,
  eps_r,
  eps_v,
  eps_q,
  gamma,
  p,
  q,
  eta,
  sigma_a,
  sigma_r,
  tau,
  u,
  v,
  p_c,
  I,
  mu,
  density,
  shear_rate,
};
inline constexpr std::size_t quantity_count = 19;

std::string_view name_of(StrainMeasure measure);

/// The logarithmic strain of an engineering one, −ln(1 − ε), for eps_a, eps_r and eps_v; a shear
/// strain γ is the same in both. NaN where a compression of 100 % or more is asked for.
double logarithmic_strain(Quantity quantity, double engineering);

/// "eps_a", "p_Pa", ...: the column's name in curve.csv.
std::string_view column_name(Quantity quantity);
/// The quantity of a column name; a missing unit suffix is accepted ("q" for "q_Pa").
std::optional<Quantity> find_quantity(std::string_view column);

/// What is needed, besides the row, to read quantities: constants of the law and of the start.
template <class T>
struct Readout {
  Frame frame = Frame::general;
  T rho_p{std::numeric_limits<double>::quiet_NaN()};  ///< grain density, NaN if the law has none
  T d{std::numeric_limits<double>::quiet_NaN()};      ///< grain size, NaN if the law has none
  int p_c_index = -1;                                 ///< variable "p_c", -1 if none
  int I_index = -1;         ///< variable "I", -1 if none: I is then that of the strain rate
  T sigma_r_start{0.0};     ///< radial stress where u is 0 [Pa]
  int first_undrained = 0;  ///< before this leg u is 0
  StrainMeasure measure = StrainMeasure::logarithmic;  ///< of ε_a, ε_r, ε_v and, with an axis, ε_q
  Sym<T, 6> stage_strain{};  ///< where the strains of the present stage count from (log.)
};

/// A normal or volume strain (compression positive) as the readout measures it.
template <class T>
T measured(const T& logarithmic, const Readout<T>& readout) {
  using std::exp;
  return readout.measure == StrainMeasure::logarithmic ? logarithmic
                                                       : T(T(1.0) - exp(-logarithmic));
}

/// Value of a quantity in a row; NaN where the law or the test has no such quantity.
template <class T>
T read(Quantity quantity, const Row<T>& row, const Readout<T>& readout) {
  using std::abs;
  using std::sqrt;
  const Sym<T, 6>& e = row.strain;
  const Sym<T, 6>& s = row.stress;
  const T nan(std::numeric_limits<double>::quiet_NaN());
  switch (quantity) {
    case Quantity::time:
      return row.time;
    case Quantity::eps_a:
      return measured(T(-e[1]), readout);
    case Quantity::eps_r:
      return measured(T(T(-0.5) * (e[0] + e[2])), readout);
    case Quantity::eps_v:
      return measured(T(-trace(e)), readout);
    case Quantity::eps_q:
      // engineering: what a laboratory plots, from the measured ε_a and ε_v
      if (readout.frame == Frame::axisymmetric && readout.measure == StrainMeasure::engineering)
        return read(Quantity::eps_a, row, readout) -
               T(1.0 / 3.0) * read(Quantity::eps_v, row, readout);
      if (readout.frame == Frame::axisymmetric)
        return T(2.0 / 3.0) * (T(0.5) * (e[0] + e[2]) - e[1]);
      return T(2.0 / std::sqrt(3.0)) * shear_norm(deviator(e));  // √(2/3 e:e)
    case Quantity::gamma:
      return T(2.0) * e[3];
    case Quantity::p:
      return pressure(s);
    case Quantity::q:
      if (readout.frame == Frame::axisymmetric) return T(0.5) * (s[0] + s[2]) - s[1];
      return mises(s);
    case Quantity::eta:
      return read(Quantity::q, row, readout) / pressure(s);
    case Quantity::sigma_a:
      return -s[1];
    case Quantity::sigma_r:
      return T(-0.5) * (s[0] + s[2]);
    case Quantity::tau:
      return s[3];
    case Quantity::u:
      if (row.leg < readout.first_undrained) return T(0.0);
      // the total radial stress is constant, so what the skeleton loses the water takes
      return readout.sigma_r_start + T(0.5) * (s[0] + s[2]);
    case Quantity::v:
      return readout.rho_p / row.density;
    case Quantity::p_c:
      return readout.p_c_index < 0 ? nan : row.state[static_cast<std::size_t>(readout.p_c_index)];
    case Quantity::density:
      return row.density;
    case Quantity::shear_rate:
      return T(2.0) * shear_norm(deviator(row.strain_rate));  // γ̇ = √(2D′:D′)
    case Quantity::I: {
      if (readout.I_index >= 0) return row.state[static_cast<std::size_t>(readout.I_index)];
      const T p = pressure(s);
      if (!(value(p) > 0.0)) return nan;
      return read(Quantity::shear_rate, row, readout) * readout.d *
             sqrt(readout.rho_p / p);  // MUI-2
    }
    case Quantity::mu: {
      const T p = pressure(s);
      if (!(value(p) > 0.0)) return nan;
      return shear_norm(deviator(s)) / p;
    }
  }
  return nan;
}

/// Sets where the excess pore pressure starts: the last row before the first undrained leg.
template <class T>
void set_pore_pressure_datum(const std::vector<Row<T>>& rows, int first_undrained,
                             Readout<T>& readout) {
  readout.first_undrained = first_undrained;
  const Row<T>* datum = rows.empty() ? nullptr : &rows.front();
  for (const Row<T>& row : rows)
    if (row.leg < first_undrained) datum = &row;
  if (datum != nullptr) readout.sigma_r_start = T(-0.5) * (datum->stress[0] + datum->stress[2]);
}

/// Index of a parameter in a law's table, -1 if it has none of that name.
int parameter_index(std::span<const ParamInfo> table, std::string_view name);
/// Index in Row::state of a state variable or derived one, -1 if it carries none of that name.
int variable_index(std::span<const StateField> state, std::span<const StateField> derived,
                   std::string_view name);
inline int variable_index(const LawInfo& law, std::string_view name) {
  return variable_index(law.state, law.derived, name);
}
template <class T>
void find_variables(std::span<const StateField> state, std::span<const StateField> derived,
                    Readout<T>& readout) {
  readout.p_c_index = variable_index(state, derived, "p_c");
  readout.I_index = variable_index(state, derived, "I");
}

}  // namespace repose::point
