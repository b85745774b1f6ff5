#pragma once
/// \file
/// The one mechanism behind every laboratory test: six linear constraints on the twelve rates.
///
///     Σ_i A_i ε̇_i + Σ_i B_i σ̇_i = c            i = xx, yy, zz, xy, yz, zx
///
/// Six such rows with the law's σ̇ = C·ε̇ + b determine both rates. Drained, undrained, plane strain
/// with a free σ_zz, constant b: all are only different rows.

#include <array>
#include <span>
#include <string>

#include "models/sym.hpp"

namespace repose::point {

/// One row in a user's signs: normal components COMPRESSION positive, shear components (tensor
/// components, ε_xy = γ/2) positive in the sense of γ. Strain rates in 1/s, stress rates in Pa/s.
struct Constraint {
  std::array<double, 6> strain{};
  std::array<double, 6> stress{};
  double rate = 0.0;
};

/// "xx", "yy", ... and their index, -1 if unknown.
inline constexpr std::array<const char*, 6> component_names{"xx", "yy", "zz", "xy", "yz", "zx"};
int component_index(const std::string& name);

/// A component as a subscript.
inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Rows most tests are made of. The control is prepared for the law in Control.
Constraint strain_rate(int component, double rate);
Constraint stress_rate(int component, double rate);
Constraint equal_strain(int a, int b);  ///< ε̇_a = ε̇_b
Constraint equal_stress(int a, int b);  ///< σ̇_a = σ̇_b

/// Six rows made ready: constraints on strain alone are eliminated beforehand,
///     D = D_p + Σ_j z_j N_j,   j < unknowns,
/// so that only the rows that contain stress remain to be solved with the law's tangent: none for
/// an undrained triaxial test, one for a drained one. Tension positive, as the laws are.
class Control {
 public:
  Control() = default;
  /// Errors: InputError("constraints", …) if rows repeat or contradict each other, hold values that
  /// are not finite, or leave the rates undetermined whatever the law.
  explicit Control(const std::array<Constraint, 6>& rows);

  int unknowns() const { return unknowns_; }
  const Sym<double, 6>& prescribed() const { return prescribed_; }  ///< D_p
  bool prescribes_strain() const { return prescribes_strain_; }     ///< D_p ≠ 0
  const Sym<double, 6>& direction(int j) const { return direction_[static_cast<std::size_t>(j)]; }
  /// The component in which z_j shows itself: D there is z_j.
  int free_component(int j) const { return free_[static_cast<std::size_t>(j)]; }
  bool keeps_volume() const { return keeps_volume_; }  ///< tr D = 0 for every z

  /// A row that contains stress; coefficients multiply tensor components one by one (plain sum).
  struct StressRow {
    std::array<double, 6> strain{}, stress{};
    double rate = 0.0;
  };
  const StressRow& stress_row(int j) const { return rows_[static_cast<std::size_t>(j)]; }

  /// All six rows, tension positive, to check the integrated path against.
  const std::array<StressRow, 6>& all_rows() const { return all_; }

  /// Largest relative violation of the integrated rows A·Δε + B·Δσ = c t: each row's residual over
  /// the largest stress (strain) that its coefficients multiply. [-]
  double residual(const Sym<double, 6>& strain_change, const Sym<double, 6>& stress_change,
                  const Sym<double, 6>& stress, double time) const;

 private:
  int unknowns_ = 0;
  bool prescribes_strain_ = false;
  bool keeps_volume_ = false;
  Sym<double, 6> prescribed_;
  std::array<Sym<double, 6>, 6> direction_{};
  std::array<int, 6> free_{};
  std::array<StressRow, 6> rows_{};
  std::array<StressRow, 6> all_{};
};

/// Solves the n×n system a x = b (n ≤ 6, row by row in a) in place by elimination with partial
/// pivoting after row scaling; x is left in b. False if a pivot is below 1e-13 of its row: the
/// system is singular.
template <class T>
bool solve_small(int n, std::array<std::array<T, 6>, 6>& a, std::array<T, 6>& b) {
  using std::abs;
  std::array<double, 6> scale{};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j)
      scale[at(i)] = std::max(scale[at(i)], std::abs(value(a[at(i)][at(j)])));
    if (!(scale[at(i)] > 0.0)) return false;
  }
  for (int col = 0; col < n; ++col) {
    int pivot = col;
    double best = 0.0;
    for (int i = col; i < n; ++i) {
      const double size = std::abs(value(a[at(i)][at(col)])) / scale[at(i)];
      if (size > best) {
        best = size;
        pivot = i;
      }
    }
    if (!(best > 1e-13)) return false;
    std::swap(a[at(pivot)], a[at(col)]);
    std::swap(b[at(pivot)], b[at(col)]);
    std::swap(scale[at(pivot)], scale[at(col)]);
    for (int i = col + 1; i < n; ++i) {
      const T factor = a[at(i)][at(col)] / a[at(col)][at(col)];
      for (int j = col + 1; j < n; ++j)
        a[at(i)][at(j)] = a[at(i)][at(j)] - factor * a[at(col)][at(j)];
      b[at(i)] = b[at(i)] - factor * b[at(col)];
    }
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int j = i + 1; j < n; ++j) b[at(i)] = b[at(i)] - a[at(i)][at(j)] * b[at(j)];
    b[at(i)] = b[at(i)] / a[at(i)][at(i)];
  }
  return true;
}

}  // namespace repose::point
