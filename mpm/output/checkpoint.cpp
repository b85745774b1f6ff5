/// The whole state of a simulation in one HDF5 file. Everything that the bits of the following
/// steps depend on is in it, the order of the points included.

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include <fmt/core.h>

#include "mpm/grid/kernel.hpp"
#include "mpm/output/hdf5_arrays.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

constexpr std::int64_t format_version = 8;

/// Every scalar that a run carries along, in one fixed order for both directions.
template <class Impl, class Real, class Whole>
void each_scalar(Impl& s, Real&& real, Whole&& whole) {
  real(s.time);
  real(s.last_dt);
  real(s.dt_min);
  real(s.dt_max);
  real(s.drift);
  real(s.fixed_step_excess);
  real(s.viscous_step_excess);
  real(s.first_dt);
  real(s.signals.speed);
  real(s.signals.signal);
  real(s.signals.viscous_rate);
  real(s.node_share);
  real(s.ledger.start);
  real(s.ledger.start_elastic);
  real(s.ledger.stress_work);
  real(s.ledger.plastic);
  real(s.ledger.viscous);
  real(s.ledger.hypoelastic);
  real(s.ledger.separation);
  real(s.ledger.averaging);
  real(s.ledger.density_floor);
  real(s.ledger.transfer_loss);
  real(s.ledger.wall_loss);
  real(s.ledger.surface_work);
  real(s.ledger.outflow);
  real(s.ledger.outflow_elastic);
  real(s.ledger.outflow_mass);
  real(s.ledger.inflow);
  real(s.ledger.inflow_elastic);
  real(s.ledger.inflow_mass);
  real(s.ledger.kinetic);
  real(s.ledger.power);
  real(s.highest_energy);
  whole(s.steps);
  whole(s.point_steps);
  whole(s.sorts);
  whole(s.wall_corrections);
  whole(s.newton_iterations);
  whole(s.cg_iterations);
  whole(s.points_held);
  whole(s.most_points_held);
  whole(s.point_steps_held);
  whole(s.next_id);
  for (auto& entry : s.entries) whole(entry.rows);
}

/// What the steps rely on without asking, of the points of a body: finite numbers, mass, and every
/// slot in the range of one block, its stencil within the nodes that the block touches. Throws
/// std::runtime_error with what is wrong: a checkpoint may be whole and yet be another scene's, or
/// that of a program with a fault. Points that wait to be sorted (`moved`) may be anywhere that
/// their walls let them go.
template <int dim>
void require_sound(const PointsOf<dim>& points, std::size_t body,
                   const std::vector<PointBlockOf<dim>>& blocks, const GridOf<dim>& grid,
                   const Walls& walls, Kernel kernel, bool moved) {
  using F = Layout<dim>;
  const bool cubic = kernel == Kernel::cubic;
  const double offset = cubic ? CubicKernel::anchor_offset : QuadraticKernel::anchor_offset;
  const int after = (cubic ? CubicKernel::rows : QuadraticKernel::rows) - 2;  // the anchor
  const auto fail = [](const char* why) { throw std::runtime_error(why); };
  std::vector<char> taken(points.slots(), 0);
  for (const PointBlockOf<dim>& pb : blocks) {
    const SlotRange& range = pb.range[body];
    const std::size_t slots = points.slots();
    if (range.begin % pack_size != 0 || range.count > slots || range.begin > slots ||
        padded(range.count) > slots - range.begin)
      fail("its blocks name points that are not there");
    for (std::size_t s = range.begin; s < range.begin + padded(range.count); ++s) {
      if (taken[s] != 0) fail("two of its blocks share points");
      taken[s] = s < range.begin + range.count ? 2 : 1;
      for (std::size_t f = 0; f < points.fields; ++f)
        if (!std::isfinite(points[f][s])) fail("a point has a number that is not finite");
      if (!(points[F::mass][s] > 0.0) || !(points[F::rho][s] > 0.0)) fail("a point has no mass");
      for (std::size_t a = 0; a < dim; ++a) {
        const double cell = std::floor(points[F::x + a][s] / grid.h());
        const int first = GridOf<dim>::first(a, pb.at[a]);
        const auto closed = [](const Wall& wall) {
          return wall.kind != Wall::Kind::open && wall.kind != Wall::Kind::periodic &&
                 std::none_of(wall.parts.begin(), wall.parts.end(),
                              [](const Wall::Part& part) { return part.kind == Wall::Kind::open; });
        };
        const bool inside = (cell >= 0.0 || !closed(walls.low(a))) &&
                            (cell <= grid.cells()[a] || !closed(walls.high(a)));
        const double anchor =
            std::floor(points[F::x + a][s] / grid.h() + offset) - first + Shape<dim>::margin[a];
        const bool at_home =
            anchor - 1.0 >= pb.touched[a].begin && anchor + after < pb.touched[a].end;
        const bool padding = s >= range.begin + range.count;
        if (!(at_home || (moved && (padding || inside)))) fail("a point lies outside of its block");
      }
    }
  }
  for (std::size_t s = 0; s < points.slots(); ++s)
    if (points.id[s] >= 0 && taken[s] != 2) fail("a point belongs to no block");
}

}  // namespace

template <int dim>
void Simulation::Impl<dim>::save(const std::filesystem::path& path) const {
  const hdf5::Quiet quiet;
  const Impl& s = *this;
  // the arrays below, and a little for what HDF5 adds: beyond it, its memory doubles
  std::size_t bytes = (std::size_t{4} << 20) + s.grid.point_blocks.size() *
                                                   (3 * dim + 2 * s.bodies.size()) *
                                                   sizeof(std::int64_t);
  for (const PointsOf<dim>& points : s.bodies)
    bytes += points.slots() * (sizeof(std::int64_t) + points.fields * sizeof(double));
  const hdf5::NewFile file(bytes);

  std::vector<double> reals;
  std::vector<std::int64_t> wholes{format_version, s.must_sort ? 1 : 0,
                                   static_cast<std::int64_t>(pack_size)};
  each_scalar(
      s, [&](double x) { reals.push_back(x); }, [&](std::int64_t x) { wholes.push_back(x); });
  hdf5::write(file, "reals", reals);
  hdf5::write(file, "wholes", wholes);

  std::vector<std::int64_t> blocks;
  for (const PointBlockOf<dim>& pb : s.grid.point_blocks) {
    blocks.insert(blocks.end(), pb.at.begin(), pb.at.end());
    for (const TileRows& rows : pb.touched) {
      blocks.push_back(rows.begin);
      blocks.push_back(rows.end);
    }
    for (const SlotRange& range : pb.range) {
      blocks.push_back(static_cast<std::int64_t>(range.begin));
      blocks.push_back(static_cast<std::int64_t>(range.count));
    }
  }
  hdf5::write(file, "blocks", blocks);
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const PointsOf<dim>& points = s.bodies[b];
    hdf5::write(file, fmt::format("body{}_id", b), points.id);
    for (std::size_t f = 0; f < points.fields; ++f) {
      const std::string name = fmt::format("body{}_field{}", b, f);
      points.single ? hdf5::write(file, name, points.values(f))
                    : hdf5::write(file, name, points.field[f]);
    }
  }
  if (s.maps) {
    hdf5::write(file, "maps_gone", std::vector<double>{s.maps->gone});
    hdf5::write(file, "maps_depth_max", s.maps->depth_max);
    hdf5::write(file, "maps_speed_max", s.maps->speed_max);
    hdf5::write(file, "maps_arrival", s.maps->arrival);
  }
  file.save(path);
}

template <int dim>
void Simulation::Impl<dim>::load(const std::filesystem::path& path) {
  const hdf5::Quiet quiet;
  Impl& s = *this;
  const auto reject = [&](const std::string& why) { throw io::IoError(path, why); };
  try {
    const hdf5::SealedFile file(path);
    const std::vector<double> reals = hdf5::read<double>(file, "reals");
    const std::vector<std::int64_t> wholes = hdf5::read<std::int64_t>(file, "wholes");
    if (wholes.size() < 3 || wholes[0] != format_version)
      reject("it is a checkpoint of another version of repose");
    if (wholes[2] != static_cast<std::int64_t>(pack_size))
      reject("it was saved by a build for another width of vectors");
    s.tiles_are_current = false;
    s.contact_sorts_ = -1;
    std::size_t next_real = 0;
    std::size_t next_whole = 3;
    s.must_sort = wholes[1] != 0;
    std::size_t scalars = 0, counts = 3;
    each_scalar(
        s, [&](double&) { ++scalars; }, [&](std::int64_t&) { ++counts; });
    if (reals.size() != scalars || wholes.size() != counts)
      reject("it has another number of scalars");
    each_scalar(
        s, [&](double& x) { x = reals[next_real++]; },
        [&](std::int64_t& x) { x = wholes[next_whole++]; });
    const bool moments = std::isfinite(s.time) && s.time >= 0.0 && std::isfinite(s.last_dt) &&
                         s.last_dt >= 0.0 && std::isfinite(s.drift) && s.drift >= 0.0 &&
                         s.steps >= 0;
    const bool speeds = std::isfinite(s.signals.speed) && s.signals.speed >= 0.0 &&
                        std::isfinite(s.signals.signal) && s.signals.signal >= 0.0 &&
                        std::isfinite(s.signals.viscous_rate) && s.signals.viscous_rate >= 0.0;
    if (!moments || !speeds) reject("its times or speeds are none");

    s.walls = s.walls_now();

    for (std::size_t b = 0; b < s.bodies.size(); ++b) {
      PointsOf<dim>& points = s.bodies[b];
      points.id = hdf5::read<std::int64_t>(file, fmt::format("body{}_id", b));
      for (std::size_t f = 0; f < points.fields; ++f) {
        const auto values = hdf5::read<double>(file, fmt::format("body{}_field{}", b, f));
        if (values.size() != points.id.size()) reject("its arrays differ in length");
        points.assign(f, values);
      }
      points.count = 0;
      for (const std::int64_t id : points.id) points.count += id >= 0 ? 1 : 0;
    }

    if (s.maps) {
      const auto restore = [&](const char* name, std::vector<double>& map) {
        std::vector<double> values = hdf5::read<double>(file, name);
        if (values.size() != map.size()) reject("its maps are of another size");
        map = std::move(values);
      };
      std::vector<double> gone{s.maps->gone};
      restore("maps_gone", gone);
      s.maps->gone = gone[0];
      restore("maps_depth_max", s.maps->depth_max);
      restore("maps_speed_max", s.maps->speed_max);
      restore("maps_arrival", s.maps->arrival);
    }

    const std::vector<std::int64_t> blocks = hdf5::read<std::int64_t>(file, "blocks");
    const std::size_t width = 3 * dim + 2 * s.bodies.size();
    if (blocks.size() % width != 0) reject("it holds another number of bodies");
    std::vector<PointBlockOf<dim>> restored(blocks.size() / width);
    for (std::size_t k = 0; k < restored.size(); ++k) {
      const std::int64_t* row = blocks.data() + k * width;
      for (std::size_t i = 0; i < dim; ++i) {
        restored[k].at[i] = static_cast<int>(row[i]);
        restored[k].touched[i] = {static_cast<int>(row[dim + 2 * i]),
                                  static_cast<int>(row[dim + 2 * i + 1])};
      }
      for (std::size_t b = 0; b < s.bodies.size(); ++b)
        restored[k].range.push_back({static_cast<std::size_t>(row[3 * dim + 2 * b]),
                                     static_cast<std::size_t>(row[3 * dim + 2 * b + 1])});
    }
    std::set<std::array<int, dim>> places;
    for (std::size_t k = 0; k < restored.size(); ++k) {
      const std::int64_t* row = blocks.data() + k * width;
      for (std::size_t a = 0; a < dim; ++a)
        if (row[a] < 1 || row[a] > GridOf<dim>::block_of_cell(a, s.grid.cells()[a]))
          reject("a block lies outside of the box");
      for (std::size_t a = 0; a < dim; ++a)
        if (row[dim + 2 * a] < 0 || row[dim + 2 * a + 1] > Shape<dim>::tile[a])
          reject("a block touches nodes that are not there");
      if (!places.insert(restored[k].at).second) reject("two of its blocks are one");
    }
    for (std::size_t b = 0; b < s.bodies.size(); ++b)
      require_sound(s.bodies[b], b, restored, s.grid, s.walls, s.scene.kernel,
                    s.must_sort || s.drift >= s.reach());
    s.grid.restore(std::move(restored));
    s.gravity = s.gravity_now();
  } catch (const io::IoError&) {
    throw;
  } catch (const std::exception& e) {
    reject(e.what());
  }
}

void Simulation::save(const std::filesystem::path& path) const {
  visit([&](const auto& s) { s.save(path); });
}
void Simulation::load(const std::filesystem::path& path) {
  visit([&](auto& s) { s.load(path); });
}

}  // namespace repose::mpm
