/// What another scene can start from: the points of a run, in the order of their memory.

#include <cmath>
#include <numeric>

#include "mpm/output/hdf5_arrays.hpp"
#include "mpm/scene/fill.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

constexpr std::int64_t format_version = 1;

/// What must be the same of a body: its name, law, and variables of state.
std::string signature(const std::string& name, const LawInfo& law) {
  std::string text = fmt::format("{}\n{}\n{}", name, law.name, law.option);
  for (const StateField& field : law.state) text += fmt::format("\n{}", field.name);
  return text;
}
std::vector<std::int64_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }
std::string text_of(const std::vector<std::int64_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

template <int dim>
void Simulation::Impl<dim>::save_final_state(const std::filesystem::path& path) const {
  using F = Layout<dim>;
  const hdf5::Quiet quiet;
  std::size_t bytes = std::size_t{1} << 20;
  for (const PointsOf<dim>& points : bodies)
    bytes += points.count * (sizeof(std::int64_t) + points.fields * sizeof(double));
  const hdf5::NewFile file(bytes);
  hdf5::write(
      file, "wholes",
      std::vector<std::int64_t>{format_version, dim, static_cast<std::int64_t>(bodies.size())});
  hdf5::write(file, "reals", std::vector<double>{initial_height});
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const PointsOf<dim>& points = bodies[b];
    const auto name = [&](const char* what) { return fmt::format("body{}_{}", b, what); };
    std::vector<std::size_t> slots;
    for (std::size_t s = 0; s < points.slots(); ++s)
      if (points.id[s] >= 0) slots.push_back(s);
    std::vector<std::int64_t> ids;
    for (const std::size_t s : slots) ids.push_back(points.id[s]);
    const auto put = [&](const std::string& as, std::size_t f) {
      std::vector<double> values;
      for (const std::size_t s : slots) values.push_back(points[f][s]);
      hdf5::write(file, as, values);
    };
    hdf5::write(file, name("is"), bytes_of(signature(body_names[b], points.material->law())));
    hdf5::write(file, name("rho_0"), std::vector<double>{points.rho_0});
    hdf5::write(file, name("id"), ids);
    for (std::size_t f = 0; f < F::state + points.material->law().state.size(); ++f)
      put(fmt::format("body{}_field{}", b, f), f);
    for (std::size_t k = 0; k < F::gradient; ++k)
      put(fmt::format("body{}_affine{}", b, k), points.affine + k);
    for (std::size_t k = 0; k < points.force_stress.size(); ++k)
      put(fmt::format("body{}_force{}", b, k), points.force_stress[k]);
    if (points.shear_strain != 0) put(name("shear_strain"), points.shear_strain);
  }
  file.save(path);
}

template <int dim>
void Simulation::Impl<dim>::start_from(const std::filesystem::path& folder) {
  using F = Layout<dim>;
  const hdf5::Quiet quiet;
  const std::filesystem::path path = folder / "final_state.h5";
  const auto reject = [&](const std::string& why) {
    throw InputError("scene.start_from", fmt::format("{}: {}", folder.string(), why));
  };
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    reject(std::filesystem::is_directory(folder, ignored)
               ? "the result holds no final_state.h5, which a run writes with output.final_state = "
                 "true"
               : "there is no such result folder");
  try {
    const hdf5::SealedFile file(path);
    const std::vector<std::int64_t> wholes = hdf5::read<std::int64_t>(file, "wholes");
    if (wholes.size() != 3 || wholes[0] != format_version)
      reject("its final state is of another version of repose");
    if (wholes[1] != dim)
      reject(dim == 2 ? "it is of three dimensions, this scene of the plane"
                      : "it is of the plane, this scene of three dimensions");
    initial_height = hdf5::read<double>(file, "reals").at(0);
    std::vector<std::string> there;
    for (std::int64_t b = 0; b < wholes[2]; ++b)
      there.push_back(text_of(hdf5::read<std::int64_t>(file, fmt::format("body{}_is", b))));
    if (there.size() != scene.bodies.size())
      reject(fmt::format("it has {} bodies, this scene has {}", there.size(), scene.bodies.size()));
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      PointsOf<dim> points = without_points<dim>(scene.bodies[b], scene);
      const LawInfo& law = points.material->law();
      const std::string wanted = signature(body_names[b], law);
      const auto found = std::find(there.begin(), there.end(), wanted);
      if (found == there.end()) {
        std::string others;
        for (const std::string& other : there) {
          const std::size_t end = other.find('\n');
          others += fmt::format("{}\"{}\" of {}", others.empty() ? "" : ", ", other.substr(0, end),
                                other.substr(end + 1, other.find('\n', end + 1) - end - 1));
        }
        reject(fmt::format("it has no body \"{}\" of this form of {}; it has {}", body_names[b],
                           law.name, others));
      }
      const auto of = found - there.begin();
      const auto array = [&](const std::string& what) {
        return hdf5::read<double>(file, fmt::format("body{}_{}", of, what));
      };
      points.rho_0 = array("rho_0").at(0);
      points.id = hdf5::read<std::int64_t>(file, fmt::format("body{}_id", of));
      points.count = points.id.size();
      if (points.count == 0) reject(fmt::format("body \"{}\" has no points left", body_names[b]));
      const auto take = [&](std::size_t f, const std::vector<double>& values) {
        if (values.size() != points.id.size()) reject("its arrays differ in length");
        for (const double x : values)
          if (!std::isfinite(x)) reject("a point has a number that is not finite");
        points.assign(f, values);
      };
      for (std::size_t f = 0; f < F::state + law.state.size(); ++f)
        take(f, array(fmt::format("field{}", f)));
      for (std::size_t k = 0; k < F::gradient; ++k)
        if (points.affine != F::L) take(points.affine + k, array(fmt::format("affine{}", k)));
      if (points.shear_strain != 0) {
        const bool kept =
            H5Lexists(file, fmt::format("body{}_shear_strain", of).c_str(), H5P_DEFAULT) > 0;
        take(points.shear_strain,
             kept ? array("shear_strain") : std::vector<double>(points.count, 0.0));
      }
      if (points.force_stress[0] != F::stress)
        for (std::size_t k = 0; k < points.force_stress.size(); ++k)
          take(points.force_stress[k], array(fmt::format("force{}", k)));
      require_room(points, b);
      bodies.push_back(std::move(points));
    }
    // names without gaps, in the order of those they had
    std::vector<std::pair<std::int64_t, std::int64_t*>> all;
    for (PointsOf<dim>& points : bodies)
      for (std::int64_t& id : points.id) all.emplace_back(id, &id);
    std::sort(all.begin(), all.end());
    for (std::size_t k = 0; k < all.size(); ++k) *all[k].second = static_cast<std::int64_t>(k);
    next_id = static_cast<std::int64_t>(all.size());
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    reject(e.what());
  }
}

/// Throws InputError where points lie outside of the box or behind a surface.
template <int dim>
void Simulation::Impl<dim>::require_room(const PointsOf<dim>& points, std::size_t body) const {
  using F = Layout<dim>;
  const std::vector<Surface> surfaces = rigid_surfaces(scene);
  for (std::size_t s = 0; s < points.slots(); ++s) {
    Position x{};
    bool inside = true;
    for (std::size_t i = 0; i < dim; ++i) {
      x[i] = points[F::x + i][s];
      const double size = grid.h() * grid.cells()[i];
      // behind periodic edges they wait to be brought back
      const double beyond = i == 0 && walls.periodic() ? grid.h() : 0.0;
      inside = inside && x[i] >= -beyond && x[i] <= size + beyond;
    }
    const auto at = [&] {
      return fmt::format("a point of \"{}\" at x = {:.6g}, y = {:.6g} m", body_names[body], x[0],
                         x[1]);
    };
    if (!inside)
      throw InputError("domain.size", fmt::format("the box does not hold what the scene starts "
                                                  "from: {} lies outside",
                                                  at()));
    for (std::size_t k = 0; k < surfaces.size(); ++k)
      if (surfaces[k].holds_at(0.0, x))
        throw InputError(
            k < scene.surfaces.size() ? fmt::format("surface[{}]", k) : "terrain.ground",
            fmt::format("what the scene starts from is in its way: {} lies in it", at()));
  }
}

void Simulation::save_final_state(const std::filesystem::path& file) const {
  visit([&](const auto& s) { s.save_final_state(file); });
}

template void Simulation::Impl<2>::start_from(const std::filesystem::path&);
template void Simulation::Impl<3>::start_from(const std::filesystem::path&);

}  // namespace repose::mpm
