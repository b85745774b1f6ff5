#pragma once
/// \file
/// Ground given by its height at the nodes of a square lattice.

#include <array>
#include <cstddef>
#include <vector>

namespace repose::mpm {

/// Heights y(x, z) through all nodes, continuous with their slope: cubic convolution with a = −1/2
/// (Keys 1981), of third order. One cell beyond the outermost nodes it goes on straight, and from
/// there level.
class HeightMap {
 public:
  HeightMap() = default;
  /// The first node at (x, z), `columns` of them along x and `rows` along z; heights row by row,
  /// finite [m].
  HeightMap(std::array<double, 2> first, double spacing, std::size_t columns, std::size_t rows,
            std::vector<double> heights);

  struct Sample {
    double height = 0.0;               ///< [m]
    std::array<double, 2> gradient{};  ///< along x and z [-]
  };
  Sample at(double x, double z) const;
  double height(double x, double z) const;

  double lowest() const { return lowest_; }    ///< of the nodes [m]
  double highest() const { return highest_; }  ///< [m]
  /// A bound on the gradient's length [-]: that between neighbouring nodes times 1.5, the most that
  /// cubic convolution makes of a slope along a row, and 1.25, the most that it makes of rows.
  double steepest() const { return steepest_; }

 private:
  std::array<double, 2> first_{};
  double spacing_ = 1.0;
  std::size_t columns_ = 0, rows_ = 0;  ///< with two nodes around the map
  std::vector<double> heights_;
  double lowest_ = 0.0, highest_ = 0.0, steepest_ = 0.0;
};

}  // namespace repose::mpm
