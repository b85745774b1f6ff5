#include "bench/mpm_cost.hpp"

#include "bench/counted.hpp"
#include "models/all_laws.hpp"
#include "models/objective.hpp"
#include "mpm/grid/grid.hpp"

namespace repose::bench {
namespace {

using mpm::Kernel;
using mpm::Transfer;

/// What a transfer does with a point, beyond weights.
struct TransferKind {
  bool affine;  ///< the affine velocity goes to the grid
  bool keeps;   ///< the point keeps some of its own velocity: the grid is read before and after
  bool apart;   ///< ... and of an affine velocity of its own, four more fields
};

std::optional<TransferKind> kind_of(std::string_view transfer) {
  if (transfer == "pic") return TransferKind{false, false, false};
  if (transfer == "flip") return TransferKind{false, true, false};
  if (transfer == "apic") return TransferKind{true, false, false};
  if (transfer == "aflip") return TransferKind{true, true, false};
  if (transfer == "relaxed") return TransferKind{true, true, true};
  return {};
}

}  // namespace

// Operations of one point-step: what the formulas of mpm/step/transfer.hpp, separable in x and y,
// take with every common factor taken out once. n nodes lie in a stencil row, n² in a stencil. Idle
// lanes, addresses, comparisons and copies do not count; + − × ÷ √ count as 1 each.
//
//   stage                              operations                       cubic   quadratic
//   weights, both directions           2(2 + n(2·degree) + n)              60          34
//   distances d h, w d h               3n                                  12           9
//   P2G columns: mass, momentum        n + 2n    affine: n + 6n + 2n    12|36        9|27
//   P2G columns: force                 6n, and 3 for −V/D                  27          21
//   P2G nodes: mass, momentum          n²(2 + 4) affine: n²(2 + 8)     96|160       54|90
//   P2G nodes: force                   8n²                                128          72
//   G2P, per field read (1, keeps: 2)  8n² + 6n + 6(n − 1) + 4            174         106
//   keep, velocity | affine            3 per component                   6|12        6|12
//   move                               4                                    4           4
//   strain (ln(I + A)), spin, det(I + A)  25                               25          25
//   ledger and signals                 46, viscous law 48                  46          46
//
// The grid: every tile hands 5 channels of 13 × 13 nodes to the nodes (one addition each), every
// node takes 30 (velocities before and after forces, three sums of the ledger).
//
// Bytes: what two sweeps over the points load and store, each field once per sweep, and what the
// tiles and nodes hand on; without write allocation, as the triad that it is compared with.
//   P2G loads   x, v, σ (3), ρ, m: 9 doubles; affine: 4 more
//   G2P and law load x, σ (4), ρ, m, state: 8 + s; keeps: v, 2 more; apart: 4 more
//               store x, v, L, σ, ρ, state: 13 + s; apart: 4 more
//   a tile is cleared (5 × 208), read (5 × 169), and filled again from the nodes (2 × 169, keeps 4)
//   a block of nodes (6 × 64) is stored
std::optional<Work> transfer_work(Kernel kernel, Transfer transfer, std::size_t states,
                                  bool viscous, double tiles_per_point,
                                  double node_blocks_per_point) {
  const auto kind = kind_of(mpm::name_of(transfer));
  if (!kind) return {};
  const double n = kernel == Kernel::cubic ? 4.0 : 3.0;
  const double degree = kernel == Kernel::cubic ? 3.0 : 2.0;
  const double reads = kind->keeps ? 2.0 : 1.0;
  const double weights = 2.0 * (2.0 + n * 2.0 * degree + n) + 3.0 * n;
  const double to_grid = weights + (kind->affine ? 9.0 : 3.0) * n + 6.0 * n + 3.0 +
                         n * n * ((kind->affine ? 10.0 : 6.0) + 8.0);
  const double from_grid = weights + reads * (8.0 * n * n + 6.0 * n + 6.0 * (n - 1.0) + 4.0) +
                           (kind->keeps ? 6.0 : 0.0) + (kind->apart ? 12.0 : 0.0);
  const double used_tile = (mpm::block_nx + 5.0) * mpm::tile_rows;
  Work work;
  work.flops = to_grid + from_grid + 4.0 + 25.0 + (viscous ? 48.0 : 46.0) +
               tiles_per_point * 5.0 * used_tile + node_blocks_per_point * 30.0 * mpm::block_nodes;
  const double s = static_cast<double>(states);
  const double points = (kind->affine ? 13.0 : 9.0) + (8.0 + s) + (13.0 + s) +
                        (kind->keeps ? 2.0 : 0.0) + (kind->apart ? 8.0 : 0.0);
  const double tiles =
      5.0 * mpm::tile_nodes + 5.0 * used_tile + (kind->keeps ? 4.0 : 2.0) * used_tile;
  work.bytes =
      8.0 * (points + tiles_per_point * tiles + node_blocks_per_point * 6.0 * mpm::block_nodes);
  return work;
}

double law_flops(const LawSpec& law, const mpm::MidCollapse::Sample& points) {
  const std::vector<double> theta = checked_parameters(law);
  const std::vector<Counted> counted_theta(theta.begin(), theta.end());
  const double before = Counted::flops;
  visit_law(find_law(law), [&]<class L>(L) {
    const auto P = L::template Params<Counted>::from(std::span<const Counted>(counted_theta));
    // the body of LawMaterial::update, for one point
    for (std::size_t i = 0; i < points.density.size(); ++i) {
      Increment<Counted, 4> inc;
      Sym<Counted, 4> stress;
      typename L::template State<Counted> state;
      for (std::size_t k = 0; k < 4; ++k) {
        inc.strain.c[k] = Counted(points.strain[i][k]);
        stress.c[k] = Counted(points.stress[i][k]);
      }
      for (std::size_t k = 0; k < L::state.size(); ++k) state[k] = Counted(points.state[i][k]);
      inc.dt = Counted(points.dt);
      inc.density = Counted(points.density[i]) * exp(-trace(inc.strain));
      stress = rotated_in_plane(stress, Counted(points.spin[i]));
      const Sym<Counted, 4> old = stress;
      L::update(P, inc, stress, state);
      static_cast<void>(Counted(0.5) * contract(old + stress, inc.strain));
      static_cast<void>(L::modulus(P, stress, state, inc.density));
      if (!L::has_stress_memory)
        static_cast<void>(
            L::viscosity(P, stress, inc.density, Counted(1.0 / points.dt) * inc.strain));
    }
  });
  return (Counted::flops - before) / static_cast<double>(points.density.size());
}

}  // namespace repose::bench
