#include "pointdriver/path/control.hpp"

#include <algorithm>
#include <cmath>

#include "models/parameter.hpp"

namespace repose::point {
namespace {

/// user sign → tension positive: normal components turn round
double sign(int component) { return component < 3 ? -1.0 : 1.0; }

bool is_zero(const std::array<double, 6>& row) {
  return std::all_of(row.begin(), row.end(), [](double x) { return x == 0.0; });
}

[[noreturn]] void dependent(int row) {
  throw InputError("constraints", "constraint " + std::to_string(row + 1) +
                                      " repeats or contradicts the others: six independent rows "
                                      "are needed");
}

/// Rank of the six rows over all twelve rates; the index of the first dependent row, or -1.
int dependent_row(std::array<std::array<double, 12>, 6> m) {
  for (int i = 0; i < 6; ++i) {
    // rows are normalised apart in strain and stress, so that Pa do not drown strains
    std::size_t best = 0;
    double size = 0.0;
    for (std::size_t j = 0; j < 12; ++j)
      if (std::abs(m[at(i)][j]) > size) {
        size = std::abs(m[at(i)][j]);
        best = j;
      }
    if (!(size > 1e-10)) return i;
    for (int r = i + 1; r < 6; ++r) {
      const double factor = m[at(r)][best] / m[at(i)][best];
      for (std::size_t j = 0; j < 12; ++j) m[at(r)][j] -= factor * m[at(i)][j];
    }
  }
  return -1;
}

/// tr D = 0 to the round-off of the elimination
bool isochoric(const Sym<double, 6>& D) {
  return std::abs(trace(D)) <= 1e-14 * (std::abs(D[0]) + std::abs(D[1]) + std::abs(D[2]));
}

}  // namespace

int component_index(const std::string& name) {
  for (int i = 0; i < 6; ++i)
    if (name == component_names[at(i)]) return i;
  return -1;
}

Constraint strain_rate(int component, double rate) {
  Constraint row;
  row.strain[at(component)] = 1.0;
  row.rate = rate;
  return row;
}

Constraint stress_rate(int component, double rate) {
  Constraint row;
  row.stress[at(component)] = 1.0;
  row.rate = rate;
  return row;
}

Constraint equal_strain(int a, int b) {
  Constraint row;
  row.strain[at(a)] = 1.0;
  row.strain[at(b)] = -1.0;
  return row;
}

Constraint equal_stress(int a, int b) {
  Constraint row;
  row.stress[at(a)] = 1.0;
  row.stress[at(b)] = -1.0;
  return row;
}

Control::Control(const std::array<Constraint, 6>& rows) {
  std::array<std::array<double, 12>, 6> all{};
  int n_strain = 0;
  std::array<std::array<double, 7>, 6> m{};  // rows on strain alone: A | c
  std::array<int, 6> origin{};
  for (int r = 0; r < 6; ++r) {
    const Constraint& row = rows[at(r)];
    StressRow signed_row;
    signed_row.rate = row.rate;
    double strain_size = 0.0, stress_size = 0.0;
    for (int i = 0; i < 6; ++i) {
      signed_row.strain[at(i)] = sign(i) * row.strain[at(i)];
      signed_row.stress[at(i)] = sign(i) * row.stress[at(i)];
      strain_size = std::max(strain_size, std::abs(row.strain[at(i)]));
      stress_size = std::max(stress_size, std::abs(row.stress[at(i)]));
    }
    if (!std::isfinite(row.rate) || !std::isfinite(strain_size) || !std::isfinite(stress_size))
      throw InputError("constraints",
                       "constraint " + std::to_string(r + 1) + " holds a value that is not finite");
    for (int i = 0; i < 6; ++i) {
      all[at(r)][at(i)] = strain_size > 0.0 ? signed_row.strain[at(i)] / strain_size : 0.0;
      all[at(r)][at(6 + i)] = stress_size > 0.0 ? signed_row.stress[at(i)] / stress_size : 0.0;
    }
    all_[at(r)] = signed_row;
    if (is_zero(row.stress)) {
      for (int i = 0; i < 6; ++i) m[at(n_strain)][at(i)] = signed_row.strain[at(i)];
      m[at(n_strain)][6] = row.rate;
      origin[at(n_strain)] = r;
      ++n_strain;
    } else {
      rows_[at(unknowns_++)] = signed_row;
    }
  }
  if (const int r = dependent_row(all); r >= 0) dependent(r);

  // Reduced row echelon form of the strain rows with complete pivoting: pivot components follow,
  // the other components are free and become the unknowns z.
  std::array<int, 6> pivot_of_row{};
  std::array<bool, 6> is_pivot{};
  for (int r = 0; r < n_strain; ++r) {
    int row = r, col = -1;
    double size = 0.0;
    for (int i = r; i < n_strain; ++i)
      for (int j = 0; j < 6; ++j)
        if (!is_pivot[at(j)] && std::abs(m[at(i)][at(j)]) > size * (1.0 + 1e-12)) {
          size = std::abs(m[at(i)][at(j)]);
          row = i;
          col = j;
        }
    if (col < 0 || !(size > 1e-12)) dependent(origin[at(r)]);
    std::swap(m[at(r)], m[at(row)]);
    std::swap(origin[at(r)], origin[at(row)]);
    const double inverse = 1.0 / m[at(r)][at(col)];
    for (double& x : m[at(r)]) x *= inverse;
    for (int i = 0; i < n_strain; ++i) {
      if (i == r) continue;
      const double factor = m[at(i)][at(col)];
      if (factor == 0.0) continue;
      for (std::size_t j = 0; j < 7; ++j) m[at(i)][j] -= factor * m[at(r)][j];
    }
    pivot_of_row[at(r)] = col;
    is_pivot[at(col)] = true;
  }
  for (int r = 0; r < n_strain; ++r) prescribed_[pivot_of_row[at(r)]] = m[at(r)][6];
  int j = 0;
  for (int free = 0; free < 6; ++free) {
    if (is_pivot[at(free)]) continue;
    free_[at(j)] = free;
    Sym<double, 6>& N = direction_[at(j++)];
    N[free] = 1.0;
    for (int r = 0; r < n_strain; ++r) N[pivot_of_row[at(r)]] = -m[at(r)][at(free)];
  }
  keeps_volume_ = isochoric(prescribed_);
  for (int k = 0; k < unknowns_; ++k) keeps_volume_ = keeps_volume_ && isochoric(direction_[at(k)]);
  for (int i = 0; i < 6; ++i) prescribes_strain_ = prescribes_strain_ || prescribed_[i] != 0.0;
}

double Control::residual(const Sym<double, 6>& strain_change, const Sym<double, 6>& stress_change,
                         const Sym<double, 6>& stress, double time) const {
  double worst = 0.0;
  double stress_size = 0.0, strain_size = 0.0;
  for (int i = 0; i < 6; ++i) {
    stress_size = std::max(stress_size, std::abs(stress[i]) + std::abs(stress_change[i]));
    strain_size = std::max(strain_size, std::abs(strain_change[i]));
  }
  for (const StressRow& row : all_) {
    double r = -row.rate * time;
    double scale = 0.0;
    for (int i = 0; i < 6; ++i) {
      r += row.strain[at(i)] * strain_change[i] + row.stress[at(i)] * stress_change[i];
      scale = std::max(scale, std::abs(row.strain[at(i)]) * strain_size +
                                  std::abs(row.stress[at(i)]) * stress_size);
    }
    if (scale > 0.0) worst = std::max(worst, std::abs(r) / scale);
  }
  return worst;
}

}  // namespace repose::point
