#include "mpm/boundary/periodic.hpp"

#include <cmath>

#include "mpm/grid/numerical_failure.hpp"

namespace repose::mpm {
namespace {

constexpr int shared = 2;  ///< nodes on either side of an edge that a point beyond it can reach

struct Nodes {
  Grid::NodeRef at[2];  // left, right; either may be far from all material

  template <class F>
  void each(F&& f) const {
    for (const Grid::NodeRef& node : at)
      if (node.block != nullptr) f(*node.block, node.place);
  }
};

NodeSums sums_of(const Nodes& nodes) {
  NodeSums sums;
  nodes.each([&](const NodeBlock& b, std::size_t n) {
    const double m = b.mass[n];
    sums.before += 0.5 * m * (b.u[0][n] * b.u[0][n] + b.u[1][n] * b.u[1][n]);
    sums.after += 0.5 * m * (b.v[0][n] * b.v[0][n] + b.v[1][n] * b.v[1][n]);
    sums.impulse_work +=
        m * ((b.v[0][n] - b.u[0][n]) * b.u[0][n] + (b.v[1][n] - b.u[1][n]) * b.u[1][n]);
  });
  return sums;
}

void join(const Nodes& nodes) {
  double mass = 0.0;
  nodes.each([&](const NodeBlock& b, std::size_t n) { mass += b.mass[n]; });
  if (mass == 0.0) return;
  const auto average = [&](auto&& of) {
    double momentum = 0.0;
    nodes.each([&](NodeBlock& b, std::size_t n) { momentum += b.mass[n] * of(b)[n]; });
    nodes.each([&](NodeBlock& b, std::size_t n) { of(b)[n] = momentum / mass; });
  };
  for (std::size_t i = 0; i < 2; ++i) average([&](NodeBlock & b) -> auto& { return b.u[i]; });
  for (std::size_t i = 0; i < 2; ++i) average([&](NodeBlock & b) -> auto& { return b.v[i]; });
  average([](NodeBlock & b) -> auto& { return b.extra; });
  // the real masses stay apart, so that sums over nodes count each once
  nodes.each([&](NodeBlock& b, std::size_t n) { b.mirrored_mass[n] = mass; });
}

}  // namespace

NodeSums join_periodic_edges(Grid& grid) {
  NodeSums change;
  for (int j = -shared; j <= grid.ny() + shared; ++j)
    for (int i = -shared; i <= shared; ++i) {
      const Nodes nodes{{grid.node(i, j), grid.node(i + grid.nx(), j)}};
      const NodeSums apart = sums_of(nodes);
      join(nodes);
      const NodeSums joined = sums_of(nodes);
      change.before += joined.before - apart.before;
      change.after += joined.after - apart.after;
      change.impulse_work += joined.impulse_work - apart.impulse_work;
    }
  return change;
}

void transpose_periodic_edges(Grid& grid) {
  for (int j = -shared; j <= grid.ny() + shared; ++j)
    for (int i = shared; i >= -shared; --i) {
      const Nodes nodes{{grid.node(i, j), grid.node(i + grid.nx(), j)}};
      double mass = 0.0;
      nodes.each([&](const NodeBlock& b, std::size_t n) { mass += b.mass[n]; });
      if (mass == 0.0) continue;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        double sum = 0.0;
        nodes.each([&](const NodeBlock& b, std::size_t n) { sum += b.v[axis][n]; });
        nodes.each([&](NodeBlock& b, std::size_t n) { b.v[axis][n] = b.mass[n] / mass * sum; });
      }
    }
}

double wrap_points(PointSet& points, double width, double gravity_x) {
  double energy = 0.0;
  for (std::size_t s = 0; s < points.slots(); ++s) {
    if (points.id[s] < 0) continue;
    const double x = points[X][s];
    if (x >= 0.0 && x < width) continue;
    if (!std::isfinite(x))  // left by a failure; nothing to come back from
      throw NumericalFailure("point " + std::to_string(points.id[s]) + " has no finite position");
    const double inside = x - width * std::floor(x / width);
    points.set(X, s, inside < width ? inside : 0.0);  // −1e-17 + width is width
    energy -= points[MASS][s] * gravity_x * (points[X][s] - x);
  }
  return energy;
}

}  // namespace repose::mpm
