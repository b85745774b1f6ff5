#include "mpm/scene/height_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace repose::mpm {
namespace {

/// Keys (1981), a = −1/2: what the four nodes around a place give to it, and to the slope there.
struct Taps {
  std::array<double, 4> value, slope;
};
Taps taps(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {{-0.5 * t3 + t2 - 0.5 * t, 1.5 * t3 - 2.5 * t2 + 1.0, -1.5 * t3 + 2.0 * t2 + 0.5 * t,
           0.5 * t3 - 0.5 * t2},
          {-1.5 * t2 + 2.0 * t - 0.5, 4.5 * t2 - 5.0 * t, -4.5 * t2 + 4.0 * t + 0.5, 1.5 * t2 - t}};
}

/// Where a place lies among nodes 0 to count − 1 of which it needs one before and two after.
struct Cell {
  std::size_t first;  ///< of the four
  double part;
  bool level;  ///< beyond the map
};
Cell cell_of(double xi, std::size_t count) {
  const double last = static_cast<double>(count) - 2.0;
  const double held = std::clamp(xi, 1.0, last);
  const double cell = std::min(std::floor(held), last - 1.0);
  return {static_cast<std::size_t>(cell) - 1, held - cell, xi != held};
}

}  // namespace

HeightMap::HeightMap(std::array<double, 2> first, double spacing, std::size_t columns,
                     std::size_t rows, std::vector<double> heights)
    : first_{first[0] - 2.0 * spacing, first[1] - 2.0 * spacing},
      spacing_(spacing),
      columns_(columns + 4),
      rows_(rows + 4),
      heights_(columns_ * rows_) {
  const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
  lowest_ = *lowest;
  highest_ = *highest;
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t i = 0; i < columns; ++i)
      heights_[(k + 2) * columns_ + i + 2] = heights[k * columns + i];
  /// Two nodes on either side of a line of `count` that begins at `start`: straight on, then level.
  const auto extend = [&](std::size_t start, std::size_t count, std::size_t stride) {
    const auto node = [&](std::size_t i) -> double& { return heights_[start + i * stride]; };
    const std::size_t end = count + 1;  // the last given
    node(1) = count > 1 ? 2.0 * node(2) - node(3) : node(2);
    node(0) = node(1);
    node(end + 1) = count > 1 ? 2.0 * node(end) - node(end - 1) : node(end);
    node(end + 2) = node(end + 1);
  };
  for (std::size_t k = 2; k < rows + 2; ++k) extend(k * columns_, columns, 1);
  for (std::size_t i = 0; i < columns_; ++i) extend(i, rows, columns_);
  double along_x = 0.0, along_z = 0.0;
  for (std::size_t n = 0; n < heights_.size(); ++n) {
    if (n % columns_ > 0) along_x = std::max(along_x, std::abs(heights_[n] - heights_[n - 1]));
    if (n >= columns_) along_z = std::max(along_z, std::abs(heights_[n] - heights_[n - columns_]));
  }
  steepest_ = 1.5 * 1.25 * std::hypot(along_x, along_z) / spacing;
}

HeightMap::Sample HeightMap::at(double x, double z) const {
  const Cell along = cell_of((x - first_[0]) / spacing_, columns_);
  const Cell across = cell_of((z - first_[1]) / spacing_, rows_);
  const Taps u = taps(along.part), w = taps(across.part);
  Sample sample;
  for (std::size_t k = 0; k < 4; ++k) {
    const double* const row = heights_.data() + (across.first + k) * columns_ + along.first;
    double value = 0.0, slope = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      value += u.value[i] * row[i];
      slope += u.slope[i] * row[i];
    }
    sample.height += w.value[k] * value;
    sample.gradient[0] += w.value[k] * slope;
    sample.gradient[1] += w.slope[k] * value;
  }
  sample.gradient[0] = along.level ? 0.0 : sample.gradient[0] / spacing_;
  sample.gradient[1] = across.level ? 0.0 : sample.gradient[1] / spacing_;
  return sample;
}

double HeightMap::height(double x, double z) const {
  const Cell along = cell_of((x - first_[0]) / spacing_, columns_);
  const Cell across = cell_of((z - first_[1]) / spacing_, rows_);
  const std::array<double, 4> u = taps(along.part).value, w = taps(across.part).value;
  double height = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double* const row = heights_.data() + (across.first + k) * columns_ + along.first;
    height += w[k] * (u[0] * row[0] + u[1] * row[1] + u[2] * row[2] + u[3] * row[3]);
  }
  return height;
}

}  // namespace repose::mpm
