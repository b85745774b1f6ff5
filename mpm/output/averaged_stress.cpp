#include "mpm/output/averaged_stress.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "models/sym.hpp"

namespace repose::mpm {
namespace {

/// The four cubic B-splines that reach a place at the share t of its cell, from the node before the
/// cell on.
std::array<double, 4> spline_weights(double t) {
  const double s = 1.0 - t;
  return {s * s * s / 6.0, 2.0 / 3.0 - t * t * (1.0 - 0.5 * t), 2.0 / 3.0 - s * s * (1.0 - 0.5 * s),
          t * t * t / 6.0};
}

/// Which nodes the points reach: those of a row along x lie side by side in the list of nodes.
template <int dim>
class Neighbourhood {
 public:
  static constexpr std::size_t rows = dim == 2 ? 4 : 16;

  Neighbourhood(const Simulation::Snapshot& points, double h, std::vector<std::size_t> members)
      : points_(points),
        h_(h),
        members_(std::move(members)) {
    std::vector<Key> cells;
    for (const std::size_t p : members_) cells.push_back(cell_of(p));
    std::vector<std::size_t> order(members_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return cells[a] != cells[b] ? cells[a] < cells[b] : members_[a] < members_[b];
    });
    std::vector<std::size_t> sorted;
    for (const std::size_t k : order) {
      sorted.push_back(members_[k]);
      if (cells_.empty() || cells_.back() != cells[k]) {
        cells_.push_back(cells[k]);
        first_.push_back(sorted.size() - 1);
      }
    }
    first_.push_back(sorted.size());
    members_ = std::move(sorted);
    list_nodes();
  }

  /// f(point, weight, node) for every point and the nodes that it reaches.
  template <class F>
  void each(F&& f) const {
    for (std::size_t c = 0; c < cells_.size(); ++c)
      for (std::size_t k = first_[c]; k < first_[c + 1]; ++k) {
        const std::size_t p = members_[k];
        std::array<std::array<double, 4>, 3> w{};
        w[2] = {1.0, 0.0, 0.0, 0.0};
        for (std::size_t a = 0; a < dim; ++a) {
          const double x = place(p, a) / h_;
          w[a] = spline_weights(x - std::floor(x));
        }
        for (std::size_t r = 0; r < rows; ++r) {
          const double across = w[1][r % 4] * w[2][r / 4];
          for (std::size_t i = 0; i < 4; ++i) f(p, across * w[0][i], node_[c * rows + r] + i);
        }
      }
  }

  std::size_t nodes() const { return nodes_.size(); }

 private:
  /// z, y and x of a cell or a node, in the order in which they lie in the list.
  using Key = std::array<std::int64_t, 3>;

  double place(std::size_t p, std::size_t axis) const {
    return axis == 0 ? points_.x_m[p] : axis == 1 ? points_.y_m[p] : points_.z_m[p];
  }
  Key cell_of(std::size_t p) const {
    Key key{};
    for (std::size_t a = 0; a < dim; ++a)
      key[2 - a] = static_cast<std::int64_t>(std::floor(place(p, a) / h_));
    return key;
  }
  static Key first_of_row(const Key& cell, std::size_t r) {
    Key key{cell[0], cell[1] - 1 + static_cast<std::int64_t>(r % 4), cell[2] - 1};
    if constexpr (dim == 3) key[0] += static_cast<std::int64_t>(r / 4) - 1;
    return key;
  }

  void list_nodes() {
    for (const Key& cell : cells_)
      for (std::size_t r = 0; r < rows; ++r) {
        Key key = first_of_row(cell, r);
        for (int i = 0; i < 4; ++i, ++key[2]) nodes_.push_back(key);
      }
    std::sort(nodes_.begin(), nodes_.end());
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    for (const Key& cell : cells_)
      for (std::size_t r = 0; r < rows; ++r) {
        const auto at = std::lower_bound(nodes_.begin(), nodes_.end(), first_of_row(cell, r));
        node_.push_back(static_cast<std::size_t>(at - nodes_.begin()));
      }
  }

  const Simulation::Snapshot& points_;
  double h_;
  std::vector<std::size_t> members_;  ///< points, cell by cell
  std::vector<Key> cells_;            ///< that hold points, in order
  std::vector<std::size_t> first_;    ///< of a cell in members_, and the end
  std::vector<Key> nodes_;
  std::vector<std::size_t> node_;  ///< the first of every row of every cell
};

template <int dim>
void average(Simulation::Snapshot& points, double h) {
  constexpr int components = dim == 2 ? 4 : 6;
  using Stress = Sym<double, components>;
  const auto columns = [&] {
    if constexpr (dim == 2)
      return std::array{&points.sxx, &points.syy, &points.szz, &points.sxy};
    else
      return std::array{&points.sxx, &points.syy, &points.szz,
                        &points.sxy, &points.syz, &points.szx};
  }();
  std::int32_t bodies = 0;
  for (const std::int32_t b : points.body) bodies = std::max(bodies, b + 1);
  std::vector<std::vector<std::size_t>> members(static_cast<std::size_t>(bodies));
  for (std::size_t p = 0; p < points.body.size(); ++p)
    members[static_cast<std::size_t>(points.body[p])].push_back(p);
  for (std::vector<std::size_t>& of_body : members) {
    const std::vector<std::size_t> own = of_body;
    const Neighbourhood<dim> around(points, h, std::move(of_body));
    struct Node {
      double mass = 0.0;
      Stress stress{};
    };
    for (int pass = 0; pass < 2; ++pass) {
      std::vector<Node> nodes(around.nodes());
      around.each([&](std::size_t p, double w, std::size_t n) {
        const double m = w * points.mass[p];
        nodes[n].mass += m;
        for (std::size_t c = 0; c < components; ++c) nodes[n].stress.c[c] += m * (*columns[c])[p];
      });
      for (Node& node : nodes)
        if (node.mass > 0.0)
          for (double& c : node.stress.c) c /= node.mass;
      for (const std::size_t p : own)
        for (auto* column : columns) (*column)[p] = 0.0;
      around.each([&](std::size_t p, double w, std::size_t n) {
        for (std::size_t c = 0; c < components; ++c) (*columns[c])[p] += w * nodes[n].stress.c[c];
      });
    }
    for (const std::size_t p : own) {
      Stress mean;
      for (std::size_t c = 0; c < components; ++c) mean.c[c] = (*columns[c])[p];
      points.pressure_Pa[p] = pressure(mean);
      points.mises_Pa[p] = mises(mean);
    }
  }
}

}  // namespace

void average_stress(Simulation::Snapshot& points, double h) {
  points.z_m.empty() ? average<2>(points, h) : average<3>(points, h);
}

}  // namespace repose::mpm
