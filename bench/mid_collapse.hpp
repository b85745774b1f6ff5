#pragma once
/// \file
/// The column of the paper in the middle of its collapse, at any resolution for the price of a
/// coarse one: a run with 12.5 mm cells to 0.25 s, whose points are then divided.

#include <filesystem>

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

class MidCollapse {
 public:
  static constexpr double coarse_h = 0.0125;  ///< [m]
  static constexpr double moment = 0.25;      ///< [s]

  /// `scene` is one of the flat columns with no more than one body. Every point of the coarse run
  /// becomes division² points of cells of coarse_h/division, with its stress, state and velocity
  /// field. Coarse runs are kept: one per scene name.
  MidCollapse(Scene scene, Kernel kernel, Transfer transfer, int division, int threads);
  ~MidCollapse();

  void step();
  /// Back to where the first step() began.
  void restore();

  std::int64_t points() const;
  std::int64_t sorts() const;  ///< since the last restore()
  /// Of points and grid [bytes].
  double bytes() const;
  double tiles_per_point() const;
  double node_blocks_per_point() const;

  /// Up to `most` points evenly drawn, as the law of the next step would meet them.
  struct Sample {
    double dt;
    std::vector<std::array<double, 4>> strain, stress;  ///< increments; xx, yy, zz, xy [-, Pa]
    std::vector<double> spin, density;                  ///< at the step's start
    std::vector<std::vector<double>> state;
  };
  Sample sample(std::size_t most) const;

 private:
  struct State;
  std::unique_ptr<State> now_;
};

}  // namespace repose::mpm
