/// Laws by name, and one with its parameters that updates points.
#include <fmt/format.h>

#include "batches.hpp"
#include "input/read_law.hpp"
#include "input/read_point_test.hpp"
#include "input/toml_text.hpp"
#include "models/registry.hpp"
#include "models/tangent.hpp"
#include "mpm/grid/numerical_failure.hpp"

namespace repose::python {
namespace {

py::dict about(const LawInfo& info) {
  py::dict law;
  law["name"] = std::string(info.name);
  law["option_key"] = std::string(info.option_key);
  law["option"] = std::string(info.option);
  law["doc"] = std::string(info.doc);
  law["has_stress_memory"] = info.has_stress_memory;
  py::list parameters;
  for (const ParamInfo& p : info.parameters) {
    py::dict entry;
    entry["name"] = std::string(p.name);
    entry["symbol"] = std::string(p.symbol);
    entry["unit"] = std::string(p.unit);
    entry["doc"] = std::string(p.doc);
    entry["need"] = p.need == Need::required    ? "required"
                    : p.need == Need::defaulted ? "defaulted"
                                                : "optional";
    entry["default"] = p.need == Need::defaulted ? py::object(py::float_(p.value)) : py::none();
    entry["range"] = to_string(p.range);
    entry["angle"] = std::string(p.angle.name);
    entry["words"] = std::vector<std::string>(p.words.begin(), p.words.end());
    parameters.append(entry);
  }
  law["parameters"] = parameters;
  const auto fields = [](std::span<const StateField> table) {
    py::list list;
    for (const StateField& f : table) {
      py::dict entry;
      entry["name"] = std::string(f.name);
      entry["symbol"] = std::string(f.symbol);
      entry["unit"] = std::string(f.unit);
      entry["doc"] = std::string(f.doc);
      list.append(entry);
    }
    return list;
  };
  law["state"] = fields(info.state);
  law["derived"] = fields(info.derived);
  return law;
}

/// A law with its parameters.
class Law {
 public:
  explicit Law(input::InputFile file) {
    input::TomlReader root(file);
    spec_ = input::read_law(root.table("law"));
    file.throw_if_bad();
    material_ = make_material(spec_);
  }

  const Material& material() const { return *material_; }
  const LawSpec& spec() const { return spec_; }
  std::size_t variables() const { return material_->law().state.size(); }

  /// Every parameter by name, derived ones included; None where an optional one stays absent.
  py::dict parameters() const {
    py::dict all;
    const auto table = material_->law().parameters;
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double x = material_->theta()[i];
      if (std::isnan(x))
        all[py::str(std::string(table[i].name))] = py::none();
      else if (!table[i].words.empty())
        all[py::str(std::string(table[i].name))] = input::word_of(table[i], x);
      else
        all[py::str(std::string(table[i].name))] = x;
    }
    return all;
  }

  /// The lines of a [law] table that makes this law again.
  std::string toml() const { return input::law_lines(spec_); }

  py::tuple initial(input::InputFile file) const {
    input::TomlReader root(file);
    const InitialConditions given = input::read_initial_conditions(root.table("initial"));
    file.throw_if_bad();
    try {
      const InitialPoint point = material_->initial(given);
      return py::make_tuple(
          array_of(std::vector<double>(point.stress.c.begin(), point.stress.c.end())),
          array_of(point.state), point.density);
    } catch (const InputError& error) {
      file.report(error, "initial");
      file.throw_if_bad();
      throw;
    }
  }

 private:
  LawSpec spec_;
  std::unique_ptr<Material> material_;
};

/// A batch around arrays that outlive it, and what was copied for it.
template <int N>
struct BoundBatch {
  static constexpr auto n = static_cast<std::size_t>(N);
  BatchOf<N> batch;
  std::vector<ReadColumns> read;

  /// Only to be read by what gets it: stress, state and density.
  void look_at(const Law& law, std::size_t points, const py::object& stress,
               const py::object& state, const py::object& density) {
    batch.count = points;
    keep(ReadColumns(stress, "stress", points, n));
    for (std::size_t k = 0; k < n; ++k) batch.stress[k] = const_cast<double*>(read.back()[k]);
    keep(ReadColumns(state, "state", points, law.variables()));
    for (std::size_t k = 0; k < law.variables(); ++k)
      batch.state[k] = const_cast<double*>(read.back()[k]);
    keep(ReadColumns(density, "density", points, flat));
    batch.density = const_cast<double*>(read.back()[0]);
  }
  void step(const py::object& strain, double dt, const py::object& spin) {
    if (!(dt >= 0.0) || !std::isfinite(dt))
      throw InputError("dt", fmt::format("dt = {} must be a finite number >= 0 s", dt));
    batch.dt = dt;
    keep(ReadColumns(strain, "strain", batch.count, n));
    for (std::size_t k = 0; k < n; ++k) batch.strain[k] = read.back()[k];
    if (spin.is_none()) return;
    keep(ReadColumns(spin, "spin", batch.count, N == 4 ? flat : 3));
    for (std::size_t k = 0; k < batch.spin.size(); ++k) batch.spin[k] = read.back()[k];
  }
  void keep(ReadColumns columns) { read.push_back(std::move(columns)); }
};

[[noreturn]] void refuse(const UpdateReport& report, const Law& law) {
  throw mpm::NumericalFailure(
      fmt::format("{}: point {} cannot be advanced over this step (an input that is no number, or "
                  "a step beyond any stress)",
                  law.material().law().name, report.failed));
}

template <int N>
py::tuple update(const Law& law, std::size_t points, const py::object& stress,
                 const py::object& state, const py::object& density, const py::object& strain,
                 double dt, const py::object& spin, bool in_place) {
  const std::size_t m = law.variables();
  constexpr auto n = static_cast<std::size_t>(N);
  const auto target = [&](const py::object& given, const char* what, std::size_t columns) {
    if (!in_place) return batch_copy(given, what, points, columns);
    if (!py::isinstance<Array>(given))
      throw InputError(
          what, fmt::format("{} cannot be updated in place: it is no array of float64", what));
    return py::cast<Array>(given);
  };
  const Array new_stress = target(stress, "stress", n), new_state = target(state, "state", m),
              new_density = target(density, "density", flat);
  BoundBatch<N> bound;
  bound.batch.count = points;
  const auto s = write_columns(new_stress, "stress", points, n);
  std::copy(s.begin(), s.end(), bound.batch.stress.begin());
  const auto v = write_columns(new_state, "state", points, m);
  std::copy_n(v.begin(), m, bound.batch.state.begin());
  bound.batch.density = write_columns(new_density, "density", points, flat).front();
  bound.step(strain, dt, spin);
  if (points > 0) {
    const UpdateReport report = [&] {
      const py::gil_scoped_release released;
      return law.material().update(bound.batch);
    }();
    if (!report.ok()) refuse(report, law);
  }
  return py::make_tuple(new_stress, new_state, new_density);
}

template <int N>
py::array tangent(const Law& law, std::size_t points, const py::object& stress,
                  const py::object& state, const py::object& density, const py::object& strain,
                  double dt, const py::object& spin) {
  BoundBatch<N> bound;
  bound.look_at(law, points, stress, state, density);
  bound.step(strain, dt, spin);
  std::vector<double> values(points * N * N);
  const UpdateReport report = [&] {
    const py::gil_scoped_release released;
    return consistent_tangent(law.material(), bound.batch, values.data());
  }();
  if (!report.ok()) refuse(report, law);
  return array_of(std::move(values), {static_cast<py::ssize_t>(points), N, N});
}

/// What a Material answers for every point: its modulus, its stored energy.
template <int N>
py::array answer(const Law& law, std::size_t points, const py::object& stress,
                 const py::object& state, const py::object& density,
                 void (Material::*question)(const BatchOf<N>&, double*) const) {
  BoundBatch<N> bound;
  bound.look_at(law, points, stress, state, density);
  std::vector<double> values(padded(points));
  if (points > 0) {
    const py::gil_scoped_release released;
    (law.material().*question)(bound.batch, values.data());
  }
  values.resize(points);
  return array_of(std::move(values));
}

}  // namespace

void bind_laws(py::module_& module) {
  module.def(
      "laws",
      [] {
        py::list all;
        for (const LawInfo& info : all_laws()) all.append(about(info));
        return all;
      },
      "Every form of every law: its tables.");
  module.def(
      "batch_array",
      [](std::size_t points, std::optional<std::size_t> columns) {
        return batch_array(points, columns.value_or(flat));
      },
      py::arg("points"), py::arg("columns") = py::none(),
      "An array of zeros, (points, columns) or (points,), that updates take as it is.");
  const auto with = [](const char* what) { return py::arg(what); };
  py::class_<Law, std::shared_ptr<Law>>(module, "Law", "A law with its parameters.")
      .def(py::init<input::InputFile>(), py::arg("input"))
      .def_property_readonly("name", [](const Law& l) { return l.spec().name; })
      .def_property_readonly("info", [](const Law& l) { return about(l.material().law()); })
      .def_property_readonly("parameters", &Law::parameters)
      .def("toml", &Law::toml, "The lines of a [law] table that makes this law again.")
      .def("initial", &Law::initial, py::arg("input"),
           "Stress (6,), state and density of a point at rest.")
      .def(
          "density_at",
          [](const Law& l, double p, double ocr) { return l.material().density_at(p, ocr); },
          py::arg("p"), py::arg("ocr"), "Density at rest under the pressure p [kg/m³].")
      .def(
          "update",
          [](const Law& law, const py::object& stress, const py::object& state,
             const py::object& density, const py::object& strain, double dt, const py::object& spin,
             bool in_place) {
            const auto [points, components] = stress_shape(stress, "stress");
            return components == 4
                       ? update<4>(law, points, stress, state, density, strain, dt, spin, in_place)
                       : update<6>(law, points, stress, state, density, strain, dt, spin, in_place);
          },
          with("stress"), with("state"), with("density"), with("strain"), with("dt"), with("spin"),
          with("in_place"), "Stress, state and density after a step.")
      .def(
          "tangent",
          [](const Law& law, const py::object& stress, const py::object& state,
             const py::object& density, const py::object& strain, double dt,
             const py::object& spin) {
            const auto [points, components] = stress_shape(stress, "stress");
            return components == 4
                       ? tangent<4>(law, points, stress, state, density, strain, dt, spin)
                       : tangent<6>(law, points, stress, state, density, strain, dt, spin);
          },
          with("stress"), with("state"), with("density"), with("strain"), with("dt"), with("spin"),
          "The consistent tangent of a step, (points, N, N).")
      .def(
          "modulus",
          [](const Law& law, const py::object& stress, const py::object& state,
             const py::object& density) {
            const auto [points, components] = stress_shape(stress, "stress");
            return components == 4
                       ? answer<4>(law, points, stress, state, density, &Material::modulus)
                       : answer<6>(law, points, stress, state, density, &Material::modulus);
          },
          with("stress"), with("state"), with("density"), "P-wave modulus ρc² [Pa].")
      .def(
          "stored_energy",
          [](const Law& law, const py::object& stress, const py::object& state,
             const py::object& density) {
            const auto [points, components] = stress_shape(stress, "stress");
            return components == 4
                       ? answer<4>(law, points, stress, state, density, &Material::stored_energy)
                       : answer<6>(law, points, stress, state, density, &Material::stored_energy);
          },
          with("stress"), with("state"), with("density"),
          "Recoverable energy per current volume [J/m³].");
}

}  // namespace repose::python
