#pragma once
/// \file
/// Collapses of cylinders of grains, and what Lube, Huppert, Sparks & Hallworth (2004) measured.

#include "tests/mpm/scenes.hpp"

namespace repose::mpm {

/// A quarter of a cylinder of height aspect · radius, `cells` of them in its radius, on a rough
/// floor in a box that the deposit leaves free. K = 50 ρ g H.
inline Scene granular_cylinder(double aspect, int cells, double friction = 0.3819) {
  const double radius = 0.1, h = radius / cells;
  Scene scene = empty_box((aspect < 1.5   ? 3.0
                           : aspect < 3.0 ? 4.5
                                          : 6.0) *
                              radius,
                          std::ceil((cells + 1) * aspect) * h, h);
  scene.domain[2] = scene.domain[0];
  scene.points_per_cell = 8;
  scene.gravity = 9.8;
  scene.floor = {Wall::Kind::no_slip};
  scene.transfer = Transfer::relaxed;
  scene.courant = 0.65;
  LawSpec sand = mpm::mu_i(50.0 * 1300.0 * 9.8 * aspect * radius);
  sand.values["d"] = 0.001;
  sand.values["mu_0"] = friction;
  sand.values["mu_d"] = friction + 0.19;
  scene.bodies.push_back(block(0.0, 0.0, 0.0, 0.0, sand));
  set_cylinder(scene.bodies[0], {{0.0, 0.0}, radius, 0.0}, 0.0, aspect * radius);
  scene.end_time = 5.0 * std::sqrt(aspect * radius / scene.gravity);  // it stops at 3 √(H/g)
  return scene;
}

struct Lube {
  double run_out, height;  ///< (R − R_0)/R_0 and H/R_0 of the deposit
};
inline Lube lube(double aspect) {
  return {aspect < 1.7 ? 1.24 * aspect : 1.6 * std::sqrt(aspect),
          aspect < 1.0 ? aspect : 0.88 * std::pow(aspect, 1.0 / 6.0)};
}

}  // namespace repose::mpm
