#include "mpm/step/viscous_operator.hpp"

#include <cmath>

#include "mpm/grid/tile_exchange.hpp"

namespace repose::mpm {
namespace {

/// Calls f with the kernel's number of rows as a constant.
template <class F>
void with_rows(Kernel kernel, F&& f) {
  if (kernel == Kernel::cubic)
    f(std::integral_constant<int, CubicKernel::rows>{});
  else
    f(std::integral_constant<int, QuadraticKernel::rows>{});
}

/// D′ and its norm from D = (xx, yy, 2xy) with D_zz = 0.
struct Deviator {
  double xx, yy, xy, norm;
  explicit Deviator(const std::array<double, 3>& D) {
    const double m = (D[0] + D[1]) / 3.0;
    xx = D[0] - m;
    yy = D[1] - m;
    xy = 0.5 * D[2];
    norm = std::sqrt(xx * xx + yy * yy + m * m + 2.0 * xy * xy);
  }
};

double norm_of(const std::array<double, 3>& s) {
  const double zz = s[0] + s[1];
  return std::sqrt(s[0] * s[0] + s[1] * s[1] + zz * zz + 2.0 * s[2] * s[2]);
}

}  // namespace

// --- points ---

void ViscousOperator::prepare(Grid& grid, std::vector<PointSet>& bodies, const Walls& walls,
                              Kernel kernel, double dt, tbb::task_arena& arena) {
  arena_ = &arena;
  grid_ = &grid;
  kernel_ = kernel;
  dt_ = dt;
  mirror_.connect(grid, walls);
  live_.clear();
  for (std::size_t k = 0; k < grid.node_blocks.size(); ++k) {
    const auto& mass = grid.node_blocks[k].mass;
    if (std::any_of(mass.begin(), mass.end(), [](double m) { return m > 0.0; })) live_.push_back(k);
  }
  bodies_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies_[b].points = bodies[b].splits_stress() ? &bodies[b] : nullptr;
    if (bodies_[b].points != nullptr) bodies_[b].data.resize(bodies[b].slots());
  }
  tiles_.resize(grid.point_blocks.size());
  for_each_block(*arena_, grid.point_blocks.size(), [&](std::size_t k) {
    kernel == Kernel::cubic ? place_points<CubicKernel>(k) : place_points<QuadraticKernel>(k);
  });
}

template <class K>
void ViscousOperator::place_points(std::size_t block) {
  const PointBlock& pb = grid_->point_blocks[block];
  const std::array<int, 2> origin = tile_origin(pb);
  const double h = grid_->h();
  const double inv_h = 1.0 / h;
  const double slope = K::inverse_moment * inv_h;  // w d h D⁻¹, D = h²/inverse_moment
  for (BodyPoints& body : bodies_) {
    if (body.points == nullptr) continue;
    const PointSet& points = *body.points;
    const SlotRange& range = pb.range[body_index(body)];
    for (std::size_t s = range.begin; s < range.begin + range.count; ++s) {
      PointData& point = body.data[s];
      const double x = points[X][s] * inv_h;
      const double y = points[Y][s] * inv_h;
      const double anchor_x = K::anchor(x);
      const double anchor_y = K::anchor(y);
      const Weights at = K::of_point(x - anchor_x, y - anchor_y);
      at.w.x().store_unaligned(point.weights.data());
      (at.w.x() * at.d.x() * Row(slope)).store_unaligned(point.weights.data() + 4);
      at.w.y().store_unaligned(point.weights.data() + 8);
      (at.w.y() * at.d.y() * Row(slope)).store_unaligned(point.weights.data() + 12);
      point.place = static_cast<std::uint32_t>((anchor_y - 1.0 - origin[1]) * tile_stride +
                                               anchor_x - 1.0 - origin[0]);
      const double mean_stress = points[points.force_stress[0]][s];
      point.stress = {points[SXX][s] - mean_stress, points[SYY][s] - mean_stress, points[SXY][s]};
      point.volume_dt = dt_ * points[MASS][s] / points[RHO][s];
    }
  }
}

void ViscousOperator::gather(const NodeVector& v, std::size_t block, VectorTile& tile) const {
  const PointBlock& pb = grid_->point_blocks[block];
  fill_tile(pb, tile.x, [&](std::size_t k) { return v[k].x.data(); });
  fill_tile(pb, tile.y, [&](std::size_t k) { return v[k].y.data(); });
}

/// Owners sum what the tiles around put on their nodes, always in the same order.
void ViscousOperator::sum_tiles(NodeVector& f) {
  for_each_block(*arena_, live_.size(), [&](std::size_t l) {
    const NodeBlock& nb = grid_->node_blocks[live_[l]];
    NodeField& sum = f[live_[l]];
    sum.x.fill(0.0);
    sum.y.fill(0.0);
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const std::int32_t source = nb.point_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
        if (source < 0) continue;
        const VectorTile& tile = tiles_[static_cast<std::size_t>(source)];
        for_each_shared_row<2>({dx, dy}, [&](std::size_t node, std::size_t entry, auto columns) {
          for (std::size_t i = 0; i < columns; ++i) {
            sum.x[node + i] += tile.x[entry + i];
            sum.y[node + i] += tile.y[entry + i];
          }
        });
      }
  });
}

namespace {

/// D = (xx, yy, 2xy) at a point: affine gradient of a field whose stencil begins at vx, vy.
template <int rows>
std::array<double, 3> strain_at(const double* weights, const double* vx, const double* vy) {
  Row ax(0.0), bx(0.0), ay(0.0), by(0.0);
#pragma GCC unroll 4
  for (std::size_t j = 0; j < rows; ++j) {
    const Row w(weights[8 + j]), g(weights[12 + j]);
    const Row row_x = Row::load_unaligned(vx + j * tile_stride);
    const Row row_y = Row::load_unaligned(vy + j * tile_stride);
    ax = fma(w, row_x, ax);
    bx = fma(g, row_x, bx);
    ay = fma(w, row_y, ay);
    by = fma(g, row_y, by);
  }
  const Row w = Row::load_unaligned(weights), g = Row::load_unaligned(weights + 4);
  const std::array<Row, 4> terms{g * ax, w * by, fma(w, bx, g * ay), Row(0.0)};
  alignas(Row) std::array<double, 4> sum;
  sums_of(terms).store_aligned(sum.data());
  return {sum[0], sum[1], sum[2]};
}

/// Sums of a stencil kept in registers while consecutive points share it.
template <int rows>
class StencilSum {
 public:
  StencilSum(double* x, double* y) : x_(x), y_(y) { clear(); }
  ~StencilSum() { flush(); }
  StencilSum(const StencilSum&) = delete;
  StencilSum& operator=(const StencilSum&) = delete;

  /// Adds Bᵀ s for a point.
  void add(const double* weights, std::uint32_t place, const std::array<double, 3>& s) {
    if (place != place_) {
      flush();
      clear();
      place_ = place;
    }
    const Row w = Row::load_unaligned(weights), g = Row::load_unaligned(weights + 4);
    const Row x_w = g * Row(s[0]), x_g = w * Row(s[2]);
    const Row y_w = g * Row(s[2]), y_g = w * Row(s[1]);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < rows; ++j) {
      const Row wy(weights[8 + j]), gy(weights[12 + j]);
      sum_x_[j] = fma(wy, x_w, fma(gy, x_g, sum_x_[j]));
      sum_y_[j] = fma(wy, y_w, fma(gy, y_g, sum_y_[j]));
    }
  }

 private:
  static constexpr std::uint32_t nowhere = static_cast<std::uint32_t>(-1);
  void clear() {
    for (std::size_t j = 0; j < rows; ++j) sum_x_[j] = sum_y_[j] = Row(0.0);
  }
  void flush() {
    if (place_ == nowhere) return;
    for (std::size_t j = 0; j < rows; ++j) {
      double* x = x_ + place_ + j * tile_stride;
      double* y = y_ + place_ + j * tile_stride;
      (Row::load_unaligned(x) + sum_x_[j]).store_unaligned(x);
      (Row::load_unaligned(y) + sum_y_[j]).store_unaligned(y);
    }
  }

  double *x_, *y_;
  std::uint32_t place_ = nowhere;
  Row sum_x_[rows], sum_y_[rows];
};

}  // namespace

template <int rows>
void ViscousOperator::stress_to_tile(std::size_t block) {
  VectorTile& tile = tiles_[block];
  tile.x.fill(0.0);
  tile.y.fill(0.0);
  StencilSum<rows> sum(tile.x.data(), tile.y.data());
  for_points(block, [&](const PointData& point) {
    sum.add(point.weights.data(), point.place, point.load);
  });
}

void ViscousOperator::evaluate_law(std::size_t block) {
  static thread_local std::vector<double> scratch;
  for (BodyPoints& body : bodies_) {
    if (body.points == nullptr) continue;
    const SlotRange& range = grid_->point_blocks[block].range[body_index(body)];
    if (range.count == 0) continue;
    const std::size_t n = padded(range.count);
    scratch.assign(6 * n, 0.0);
    double* const D[4] = {scratch.data(), scratch.data() + n, scratch.data() + 2 * n,
                          scratch.data() + 3 * n};
    double* const eta = scratch.data() + 4 * n;
    double* const thinning = scratch.data() + 5 * n;
    for (std::size_t k = 0; k < range.count; ++k) {
      const Plane& strain = body.data[range.begin + k].strain;
      D[0][k] = strain[0];
      D[1][k] = strain[1];
      D[3][k] = 0.5 * strain[2];
    }
    body.points->read(range, [&](PointSet& points, const SlotRange& there) {
      Batch batch = points.batch(there);
      batch.dt = 1.0;
      batch.strain = {D[0], D[1], D[2], D[3]};
      points.material->viscosity(batch, eta, thinning);
    });
    for (std::size_t k = 0; k < range.count; ++k) {
      body.data[range.begin + k].eta = eta[k];
      body.data[range.begin + k].thinning = thinning[k];
    }
  }
}

void ViscousOperator::impulse(const NodeVector& v, NodeVector& f) {
  with_rows(kernel_, [&](auto rows) {
    for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
      VectorTile tile;
      gather(v, k, tile);
      for_points(k, [&](PointData& point) {
        point.strain = strain_at<rows>(point.weights.data(), tile.x.data() + point.place,
                                       tile.y.data() + point.place);
      });
      evaluate_law(k);
      for_points(k, [&](PointData& point) {
        const Deviator D(point.strain);
        const double factor = 2.0 * point.eta * point.volume_dt;
        point.load = {factor * D.xx, factor * D.yy, factor * D.xy};
      });
      stress_to_tile<rows>(k);
    });
  });
  sum_tiles(f);
  mirror_.fold(f);
}

void ViscousOperator::state_of_points() {
  for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
    for (BodyPoints& body : bodies_) {
      if (body.points == nullptr) continue;
      const PointSet& points = *body.points;
      const SlotRange& range = grid_->point_blocks[k].range[body_index(body)];
      for (std::size_t s = range.begin; s < range.begin + range.count; ++s)
        body.data[s].strain = {points[LXX][s], points[LYY][s], points[LXY][s] + points[LYX][s]};
    }
    evaluate_law(k);
  });
}

void ViscousOperator::linear_impulse(const NodeVector& v, NodeVector& f) {
  with_rows(kernel_, [&](auto rows) {
    for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
      VectorTile tile;
      gather(v, k, tile);
      for_points(k, [&](PointData& point) {
        Plane e = strain_at<rows>(point.weights.data(), tile.x.data() + point.place,
                                  tile.y.data() + point.place);
        for (std::size_t c = 0; c < 3; ++c) e[c] -= point.strain[c];
        const Deviator D(point.strain);
        const double factor = 2.0 * point.eta * point.volume_dt;
        const std::array<double, 6>& C = point.tangent;
        point.load = {factor * D.xx + C[0] * e[0] + C[1] * e[1] + C[2] * e[2],
                      factor * D.yy + C[1] * e[0] + C[3] * e[1] + C[4] * e[2],
                      factor * D.xy + C[2] * e[0] + C[4] * e[1] + C[5] * e[2]};
      });
      stress_to_tile<rows>(k);
    });
  });
  sum_tiles(f);
  mirror_.fold(f);
}

void ViscousOperator::linearise() {
  for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
    for_points(k, [&](PointData& point) {
      const double two_eta = 2.0 * point.eta * point.volume_dt;
      std::array<double, 6>& C = point.tangent;
      C = {two_eta * (2.0 / 3.0), two_eta * (-1.0 / 3.0), 0.0, two_eta * (2.0 / 3.0), 0.0,
           two_eta * 0.5};
      const Deviator D(point.strain);
      if (!(D.norm > 0.0) || !(point.eta > 0.0)) return;
      const Plane n{D.xx / D.norm, D.yy / D.norm, D.xy / D.norm};
      // the dual stress may not exceed the law's own: |w| <= 1
      const double bound = 2.0 * point.eta * D.norm;
      const double share = 1.0 / std::max(bound, norm_of(point.stress));
      const Plane w{point.stress[0] * share, point.stress[1] * share, point.stress[2] * share};
      for (std::size_t c = 0; c < 3; ++c) point.stress[c] = bound * w[c];
      const double f = 0.5 * two_eta * point.thinning;
      C[0] -= f * 2.0 * w[0] * n[0];
      C[1] -= f * (w[0] * n[1] + n[0] * w[1]);
      C[2] -= f * (w[0] * n[2] + n[0] * w[2]);
      C[3] -= f * 2.0 * w[1] * n[1];
      C[4] -= f * (w[1] * n[2] + n[1] * w[2]);
      C[5] -= f * 2.0 * w[2] * n[2];
    });
  });
}

void ViscousOperator::apply(const NodeVector& p, NodeVector& q) {
  with_rows(kernel_, [&](auto rows) {
    for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
      VectorTile from;
      gather(p, k, from);
      VectorTile& tile = tiles_[k];
      tile.x.fill(0.0);
      tile.y.fill(0.0);
      StencilSum<rows> sum(tile.x.data(), tile.y.data());
      for_points(k, [&](const PointData& point) {
        if (point.eta == 0.0) return;  // bears no pressure
        const Plane e = strain_at<rows>(point.weights.data(), from.x.data() + point.place,
                                        from.y.data() + point.place);
        const std::array<double, 6>& C = point.tangent;
        sum.add(point.weights.data(), point.place,
                {C[0] * e[0] + C[1] * e[1] + C[2] * e[2], C[1] * e[0] + C[3] * e[1] + C[4] * e[2],
                 C[2] * e[0] + C[4] * e[1] + C[5] * e[2]});
      });
    });
  });
  sum_tiles(q);
  mirror_.fold(q);
}

void ViscousOperator::diagonal(NodeVector& d) {
  const std::size_t rows = kernel_ == Kernel::cubic ? CubicKernel::rows : QuadraticKernel::rows;
  for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
    VectorTile& tile = tiles_[k];
    tile.x.fill(0.0);
    tile.y.fill(0.0);
    for_points(k, [&](const PointData& point) {
      const std::array<double, 16>& w = point.weights;
      const std::array<double, 6>& C = point.tangent;
      for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t i = 0; i < stencil_width; ++i) {
          const double bx = w[4 + i] * w[8 + j];  // Bᵀ: ∂/∂x, ∂/∂y
          const double by = w[i] * w[12 + j];
          const std::size_t at = point.place + j * tile_stride + i;
          tile.x[at] += C[0] * bx * bx + 2.0 * C[2] * bx * by + C[5] * by * by;
          tile.y[at] += C[5] * bx * bx + 2.0 * C[4] * bx * by + C[3] * by * by;
        }
    });
  });
  sum_tiles(d);
  mirror_.fold_diagonal(d);
}

void ViscousOperator::step_stress(const NodeVector& step) {
  with_rows(kernel_, [&](auto rows) {
    for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
      VectorTile tile;
      gather(step, k, tile);
      for_points(k, [&](PointData& point) {
        const Plane change = strain_at<rows>(point.weights.data(), tile.x.data() + point.place,
                                             tile.y.data() + point.place);
        const Deviator D(point.strain), dD(change);
        // s + δs = 2η(D′ + δD′) − θ s (n:δD′)/|D′|;  n:δD′ = n:δD, as n is a deviator
        const double n_dD =
            D.norm > 0.0
                ? (D.xx * change[0] + D.yy * change[1] + D.xy * change[2]) / (D.norm * D.norm)
                : 0.0;
        const double keep = -1.0 - point.thinning * n_dD;
        const double two_eta = 2.0 * point.eta;
        point.stress_step = {two_eta * (D.xx + dD.xx) + keep * point.stress[0],
                             two_eta * (D.yy + dD.yy) + keep * point.stress[1],
                             two_eta * (D.xy + dD.xy) + keep * point.stress[2]};
      });
    });
  });
}

void ViscousOperator::take_stress_step(double a) {
  for_each_block(*arena_, grid_->point_blocks.size(), [&](std::size_t k) {
    for_points(k, [&](PointData& point) {
      for (std::size_t c = 0; c < 3; ++c) point.stress[c] += a * point.stress_step[c];
    });
  });
}

}  // namespace repose::mpm
