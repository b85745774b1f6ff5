/// Laws written in Python: classes whose methods take numpy arrays.
#include <deque>

#include <fmt/format.h>

#include "batches.hpp"
#include "binding.hpp"
#include "models/batch_law.hpp"
#include "models/registry.hpp"
#include "pointdriver/integrate/material_driver.hpp"

namespace repose::python {
namespace {

/// A law's tables and its class. Laws stay until the program ends, and so do these: the registry
/// and every Material refer to them, and a Python object must not be given up after the
/// interpreter.
struct OwnLaw {
  std::deque<std::string> texts;
  std::vector<ParamInfo> parameters;
  std::vector<StateField> state;
  LawInfo info{};
  py::object law;

  std::string_view keep(const py::handle& text) {
    return texts.emplace_back(py::cast<std::string>(text));
  }
};

/// A (points, components) array that Python owns: it may keep it.
Array matrix(const double* from, std::size_t points, std::size_t columns) {
  const auto size = static_cast<py::ssize_t>(sizeof(double));
  const auto n = static_cast<py::ssize_t>(points);
  Array array({n, static_cast<py::ssize_t>(columns)}, {size, size * n});
  std::copy_n(from, points * columns, array.mutable_data());
  return array;
}

/// What a method returned, into columns.
void take(const OwnLaw& law, const char* method, const py::handle& given, std::size_t points,
          std::size_t columns, double* to) {
  const Array array = Array::ensure(given);
  const auto extent = [&](py::ssize_t axis) { return static_cast<std::size_t>(array.shape(axis)); };
  if (is_complex(given))
    throw py::value_error(fmt::format("{}.{} must return real numbers; it returned complex ones",
                                      law.info.name, method));
  const bool scalar = array && array.ndim() == 0 && columns == 1;
  const bool one = array && array.ndim() == 1 && columns == 1 && extent(0) == points;
  const bool two = array && array.ndim() == 2 && extent(0) == points && extent(1) == columns;
  if (!scalar && !one && !two) {
    PyErr_Clear();
    const std::string wanted =
        columns == 1 ? fmt::format("({},)", points) : fmt::format("({}, {})", points, columns);
    throw py::value_error(fmt::format("{}.{} must return an array of the shape {}; it returned {}",
                                      law.info.name, method, wanted,
                                      py::cast<std::string>(py::repr(given)).substr(0, 80)));
  }
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t k = 0; k < columns; ++k) {
      const auto row = static_cast<py::ssize_t>(i), column = static_cast<py::ssize_t>(k);
      to[k * points + i] = scalar ? array.at() : one ? array.at(row) : array.at(row, column);
    }
}

/// A method of the law. An InputError of the class is one of the library, which knows its place.
template <class... A>
py::object call_method(const OwnLaw& law, const char* method, A&&... arguments) {
  try {
    return law.law.attr(method)(std::forward<A>(arguments)...);
  } catch (const py::error_already_set& error) {
    if (!error.matches(input_error())) throw;
    const py::object value = error.value();
    throw InputError(py::cast<std::string>(py::getattr(value, "key", py::str("name"))),
                     py::cast<std::string>(py::str(value)));
  }
}

/// The parameters by name, as every method of the law gets them. Absent optional ones are None.
py::dict named(const OwnLaw& law, std::span<const double> theta) {
  py::dict values;
  for (std::size_t i = 0; i < law.parameters.size(); ++i) {
    const py::str name{std::string(law.parameters[i].name)};
    values[name] = std::isnan(theta[i]) ? py::object(py::none()) : py::float_(theta[i]);
  }
  return values;
}

py::dict conditions(const InitialConditions& given) {
  py::dict all;
  const auto add = [&](const char* name, const auto& value) {
    if (value) all[name] = py::cast(*value);
  };
  add("p", given.p);
  add("sigma_v", given.sigma_v);
  add("ocr", given.ocr);
  add("ocr_v", given.ocr_v);
  add("K0_nc", given.K0_nc);
  add("v", given.v);
  add("density", given.density);
  add("K0", given.K0);
  add("sigma", given.sigma);
  return all;
}

class PythonMaterial final : public BatchLaw {
 public:
  PythonMaterial(const OwnLaw& law, std::vector<double> theta)
      : BatchLaw(law.info, std::move(theta)),
        law_(law) {}

  InitialPoint initial(const InitialConditions& given) const override {
    const py::gil_scoped_acquire held;
    InitialPoint point;
    point.stress = initial_stress(given, 0.0);
    const py::tuple answer = call("initial", conditions(given), given_stress(point.stress));
    take(law_, "initial", answer[0], 1, 6, point.stress.c.data());
    point.state.resize(law_.state.size());
    if (!point.state.empty())
      take(law_, "initial", answer[1], 1, point.state.size(), point.state.data());
    point.density = py::cast<double>(answer[2]);
    if (!(point.density > 0.0) || !std::isfinite(point.density))
      throw InputError("density", fmt::format("{} starts with a density of {} kg/m3",
                                              law_.info.name, point.density));
    return point;
  }

  double density_at(double p, double) const override {
    InitialConditions given;
    given.p = p;
    return initial(given).density;
  }

 private:
  void advance(const PointArrays& points) const override {
    const py::gil_scoped_acquire held;
    const py::tuple answer =
        call("update", stress_of(points), state_of(points), density_of(points),
             matrix(points.strain.data(), points.count, points.components), points.dt);
    take(law_, "update", answer[0], points.count, points.components, points.stress.data());
    if (!law_.state.empty())
      take(law_, "update", answer[1], points.count, law_.state.size(), points.state.data());
  }
  void wave_modulus(const PointArrays& points, double* rho_c2) const override {
    const py::gil_scoped_acquire held;
    take(law_, "modulus", call("modulus", stress_of(points), state_of(points), density_of(points)),
         points.count, 1, rho_c2);
    // the largest stable step is made of it
    require("modulus", "> 0", rho_c2, points.count, [](double x) { return x > 0.0; });
  }
  void step_viscosity(const PointArrays& points, double* eta) const override {
    const py::gil_scoped_acquire held;
    const double per_dt = points.dt > 0.0 ? 1.0 / points.dt : 0.0;
    std::vector<double> D(points.strain.begin(), points.strain.end());
    for (double& x : D) x *= per_dt;
    take(law_, "viscosity",
         call("viscosity", stress_of(points), density_of(points),
              matrix(D.data(), points.count, points.components)),
         points.count, 1, eta);
    require("viscosity", ">= 0", eta, points.count, [](double x) { return x >= 0.0; });
  }
  void energy(const PointArrays& points, double* stored) const override {
    const py::gil_scoped_acquire held;
    take(law_, "stored_energy",
         call("stored_energy", stress_of(points), state_of(points), density_of(points)),
         points.count, 1, stored);
  }

  template <class F>
  void require(const char* method, const char* range, const double* values, std::size_t count,
               F&& good) const {
    for (std::size_t i = 0; i < count; ++i)
      if (!std::isfinite(values[i]) || !good(values[i]))
        throw InputError("name", fmt::format("{}.{} must return finite numbers {}; it returned {} "
                                             "for point {}",
                                             law_.info.name, method, range, values[i], i));
  }
  template <class... A>
  py::object call(const char* method, A&&... arguments) const {
    return call_method(law_, method, named(law_, theta()), std::forward<A>(arguments)...);
  }
  static Array given_stress(const Sym<double, 6>& stress) {
    Array array(6);
    std::copy(stress.c.begin(), stress.c.end(), array.mutable_data());
    return array;
  }
  static Array stress_of(const PointArrays& points) {
    return matrix(points.stress.data(), points.count, points.components);
  }
  Array state_of(const PointArrays& points) const {
    return matrix(points.state.data(), points.count, law_.state.size());
  }
  static Array density_of(const PointArrays& points) {
    Array array(static_cast<py::ssize_t>(points.count));
    std::copy(points.density.begin(), points.density.end(), array.mutable_data());
    return array;
  }

  const OwnLaw& law_;
};

/// tables: {"name", "doc", "has_stress_memory", "parameters": [...], "state": [...]}, as law_info
/// of the package makes them of a class.
void register_own_law(const py::object& law, const py::dict& tables) {
  auto owned = std::make_unique<OwnLaw>();
  owned->law = law;
  for (const py::handle entry : py::list(tables["parameters"])) {
    ParamInfo p;
    p.name = owned->keep(entry["name"]);
    p.symbol = owned->keep(entry["symbol"]);
    p.unit = owned->keep(entry["unit"]);
    p.doc = owned->keep(entry["doc"]);
    p.need = py::cast<bool>(entry["optional"]) ? Need::optional
             : entry["default"].is_none()      ? Need::required
                                               : Need::defaulted;
    if (p.need == Need::defaulted) p.value = py::cast<double>(entry["default"]);
    p.range = {py::cast<double>(entry["lower"]), py::cast<double>(entry["upper"]),
               py::cast<bool>(entry["lower_open"]), py::cast<bool>(entry["upper_open"])};
    p.scale = py::cast<bool>(entry["log"]) ? Scale::log : Scale::linear;
    owned->parameters.push_back(p);
  }
  for (const py::handle entry : py::list(tables["state"]))
    owned->state.push_back({owned->keep(entry["name"]), owned->keep(entry["symbol"]),
                            owned->keep(entry["unit"]), owned->keep(entry["doc"])});
  owned->info = {owned->keep(tables["name"]),
                 "",
                 "",
                 owned->keep(tables["doc"]),
                 owned->parameters,
                 owned->state,
                 py::cast<bool>(tables["has_stress_memory"])};
  OwnLaw* const kept = owned.get();
  OutsideLaw entry;
  entry.info = &kept->info;
  entry.complete = [kept](std::vector<double>& theta) {
    const py::gil_scoped_acquire held;
    const py::object completed = call_method(*kept, "complete", named(*kept, theta));
    for (std::size_t i = 0; i < theta.size(); ++i) {
      const py::object x = completed[py::str(std::string(kept->parameters[i].name))];
      theta[i] = x.is_none() ? std::nan("") : py::cast<double>(x);
    }
  };
  entry.make = [kept](std::vector<double> theta) -> std::unique_ptr<Material> {
    return std::make_unique<PythonMaterial>(*kept, std::move(theta));
  };
  entry.point = point::material_driver(kept->info, entry.complete, entry.make);
  register_law({entry});
  owned.release();  // until the program ends
}

}  // namespace

void bind_own_law(py::module_& module) {
  module.def("register_law", &register_own_law, py::arg("law"), py::arg("tables"),
             "Makes a law known by its name; `repose.register_law` is what to call.");
}

}  // namespace repose::python
