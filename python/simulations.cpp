/// Simulations of scenes, step by step.
#include <fmt/format.h>

#include "binding.hpp"
#include "input/file_kind.hpp"
#include "input/read_scene.hpp"
#include "input/resolved_scene.hpp"
#include "input/toml_reader.hpp"
#include "io/interrupt.hpp"
#include "mpm/study/estimate.hpp"
#include "report/picture/heap_picture.hpp"
#include "study/run/run_record.hpp"
#include "study/run/terrain_result.hpp"

namespace repose::python {
namespace {

py::ssize_t size(std::size_t n) { return static_cast<py::ssize_t>(n); }

class Simulation {
 public:
  Simulation(input::InputFile file, int threads) {
    input::require_kind(file, input::FileKind::scene, "run");
    file_ = input::read_scene(file);
    reading(file, [&] {
      const py::gil_scoped_release released;
      simulation_ = std::make_unique<mpm::Simulation>(file_.scene, threads);
    });
  }

  const mpm::Simulation& state() const { return *simulation_; }
  const input::SceneFile& file() const { return file_; }

  /// To a moment, or by so many steps; Ctrl-C stops it between two.
  void advance(double until, std::int64_t most_steps) {
    require_whole();
    bool interrupted = false;
    try {
      const py::gil_scoped_release released;
      const io::InterruptGuard interrupt;
      for (std::int64_t k = 0; k < most_steps && simulation_->time() < until; ++k) {
        simulation_->step(until);
        interrupted = interrupt.requested();
        if (interrupted || simulation_->point_count() == 0) break;
      }
    } catch (const std::exception& error) {
      fault_ = error.what();
      throw;
    }
    if (interrupted) throw_interrupted();
  }

  py::dict points() const {
    const mpm::Simulation::PointFields f = [&] {
      const py::gil_scoped_release released;
      return simulation_->point_fields();
    }();
    const py::ssize_t n = size(f.id.size()), d = size(f.dimensions);
    py::dict all;
    all["id"] = array_of(f.id);
    all["body"] = array_of(f.body);
    all["position"] = array_of(f.position, {n, d});
    all["velocity"] = array_of(f.velocity, {n, d});
    all["velocity_gradient"] = array_of(f.velocity_gradient, {n, d, d});
    all["stress"] = array_of(f.stress, {n, size(f.components)});
    all["density"] = array_of(f.density);
    all["mass"] = array_of(f.mass);
    all["state"] = array_of(f.state, {n, size(f.state_width)});
    return all;
  }

  py::dict nodes() const {
    const mpm::Simulation::NodeFields f = [&] {
      const py::gil_scoped_release released;
      return simulation_->node_fields();
    }();
    std::vector<py::ssize_t> shape, vectors;
    for (const std::size_t n : f.nodes) shape.push_back(size(n));
    vectors = shape;
    vectors.push_back(size(f.nodes.size()));
    py::dict all;
    all["mass"] = array_of(f.mass, shape);
    all["velocity"] = array_of(f.velocity, vectors);
    return all;
  }

  py::dict diagnostics() const {
    const std::vector<std::string> names = study::series_columns(simulation_->scene());
    const std::vector<double> values = [&] {
      const py::gil_scoped_release released;
      return study::series_values(simulation_->diagnostics(), *simulation_);
    }();
    py::dict row;
    for (std::size_t k = 0; k < names.size(); ++k) row[py::str(names[k])] = values[k];
    return row;
  }

  py::tuple profile() const {
    mpm::Simulation::Profile p = simulation_->profile();
    return py::make_tuple(array_of(std::move(p.x_m)), array_of(std::move(p.depth_m)));
  }

  py::dict maps() const {
    const study::TerrainMaps maps = [&] {
      const py::gil_scoped_release released;
      return study::terrain_maps(*simulation_);
    }();
    const std::string& crs = simulation_->scene().terrain->crs;
    py::dict all;
    all["largest_depth"] = raster_of(maps.largest_depth_m, crs);
    all["largest_speed"] = raster_of(maps.largest_speed, crs);
    all["arrival_time"] = raster_of(maps.arrival_s, crs);
    all["deposit"] = raster_of(maps.deposit_m, crs);
    return all;
  }

  void set_gravity(double gravity, double tilt_deg) {
    require_whole();
    const py::gil_scoped_release released;
    simulation_->set_gravity(gravity, tilt_deg);
  }

  /// wall: an input with a table [domain] that has the edge.
  void set_wall(const std::string& edge, input::InputFile wall) {
    require_whole();
    input::TomlReader domain = input::TomlReader(wall).table("domain");
    domain.expect(edge);
    const mpm::Wall read = input::read_wall(domain, edge, {});
    wall.throw_if_bad();
    simulation_->set_wall(edge, read);
  }

  void save(const std::string& path) const {
    require_whole();
    const py::gil_scoped_release released;
    simulation_->save(path);
  }
  void load(const std::string& path) {
    const py::gil_scoped_release released;
    try {
      simulation_->load(path);
      fault_.clear();
    } catch (...) {
      fault_ = "a checkpoint could not be loaded into it";
      throw;
    }
  }

  /// The scene as it is now, edges and gravity included, with every default.
  std::string resolved(const std::string& origin) const {
    input::SceneFile now = file_;
    now.scene = simulation_->scene();
    return input::resolved_input(now, origin);
  }

  bool picture(const std::string& path) const {
    return report::draw_final_picture(file_, *simulation_, path);
  }

 private:
  /// After a failure in the middle of a step the points are neither before nor after it.
  void require_whole() const {
    if (!fault_.empty())
      throw std::runtime_error(
          fmt::format("this simulation ended with a failure and cannot go on: {}", fault_));
  }

  input::SceneFile file_;
  std::unique_ptr<mpm::Simulation> simulation_;
  std::string fault_;
};

py::dict estimate(input::InputFile file) {
  input::require_kind(file, input::FileKind::scene, "check");
  const input::SceneFile scene = input::read_scene(file);
  const mpm::Estimate e = reading(file, [&] {
    const py::gil_scoped_release released;
    return mpm::count_estimate(scene.scene);
  });
  py::dict all;
  all["points"] = e.points;
  all["live_cells"] = e.live_cells;
  all["first_dt_s"] = e.first_dt_s;
  all["steps"] = e.steps;
  all["memory_MB"] = e.memory_MB;
  all["wall_s"] = e.seconds;
  return all;
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<Simulation>(module, "Simulation", "A scene that is stepped; `repose.Simulation`.")
      .def(py::init<input::InputFile, int>(), py::arg("input"), py::arg("threads"))
      .def("advance", &Simulation::advance, py::arg("until"), py::arg("most_steps"))
      .def_property_readonly("time", [](const Simulation& s) { return s.state().time(); })
      .def_property_readonly("steps", [](const Simulation& s) { return s.state().steps(); })
      .def_property_readonly("next_dt", [](const Simulation& s) { return s.state().next_dt(); })
      .def_property_readonly("point_count",
                             [](const Simulation& s) { return s.state().point_count(); })
      .def_property_readonly("name", [](const Simulation& s) { return s.file().scene.name; })
      .def_property_readonly("end_time",
                             [](const Simulation& s) { return s.file().scene.end_time; })
      .def_property_readonly("dimensions",
                             [](const Simulation& s) { return s.state().scene().dimensions(); })
      .def_property_readonly("h", [](const Simulation& s) { return s.state().scene().h; })
      .def_property_readonly("domain",
                             [](const Simulation& s) {
                               std::vector<double> box(s.state().scene().domain.begin(),
                                                       s.state().scene().domain.end());
                               box.resize(s.state().scene().dimensions());
                               return box;
                             })
      .def_property_readonly("gravity",
                             [](const Simulation& s) { return s.state().scene().gravity; })
      .def_property_readonly("tilt_deg",
                             [](const Simulation& s) { return s.state().scene().tilt_deg; })
      .def_property_readonly("notes", [](const Simulation& s) { return s.file().notes; })
      .def_property_readonly("warnings", [](const Simulation& s) { return s.state().warnings(); })
      .def("points", &Simulation::points)
      .def("nodes", &Simulation::nodes)
      .def("diagnostics", &Simulation::diagnostics)
      .def("profile", &Simulation::profile)
      .def("maps", &Simulation::maps)
      .def("set_gravity", &Simulation::set_gravity, py::arg("gravity"), py::arg("tilt_deg"))
      .def("set_wall", &Simulation::set_wall, py::arg("edge"), py::arg("input"))
      .def("save", &Simulation::save, py::arg("path"))
      .def("load", &Simulation::load, py::arg("path"))
      .def("resolved", &Simulation::resolved, py::arg("origin"))
      .def("picture", &Simulation::picture, py::arg("path"), "Draws final.svg with gnuplot.");
  module.def("estimate", &estimate, py::arg("input"),
             "What `repose check` says of a scene: points, steps, memory, seconds.");
}

}  // namespace repose::python
