#pragma once
/// \file
/// What the sources of the extension module `repose._core` share. It hands Python's inputs to the
/// library's readers and its results back as arrays, and computes nothing.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "input/input_file.hpp"
#include "io/exit_code.hpp"
#include "io/raster.hpp"

namespace repose::python {

namespace py = pybind11;

using Array = py::array_t<double>;

void bind_errors(py::module_& module);
void bind_input(py::module_& module);
void bind_laws(py::module_& module);
void bind_own_law(py::module_& module);
void bind_point(py::module_& module);
void bind_simulation(py::module_& module);
void bind_fit(py::module_& module);
void bind_verbs(py::module_& module);
void bind_results(py::module_& module);

/// An array that owns its numbers. shape: its extents, C order; their product is values.size().
template <class T>
py::array_t<T> array_of(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto* const kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return py::array_t<T>(std::move(shape), kept->data(), owner);
}
template <class T>
py::array_t<T> array_of(std::vector<T> values) {
  const auto count = static_cast<py::ssize_t>(values.size());
  return array_of(std::move(values), {count});
}

/// What repose.Map is made of.
inline py::dict raster_of(const io::Raster& raster, const std::string& crs) {
  py::dict map;
  map["values"] = array_of(raster.values, {static_cast<py::ssize_t>(raster.rows),
                                           static_cast<py::ssize_t>(raster.columns)});
  map["west"] = raster.west;
  map["south"] = raster.south;
  map["cell"] = raster.cell;
  map["crs"] = crs;
  return map;
}

/// Calls f, which reads `input` and what it names. What a library says against a key becomes the
/// input's problem, as the command tells it.
template <class F>
auto reading(input::InputFile& input, F&& f) {
  try {
    return f();
  } catch (const InputError& error) {
    input.report(error);
    input.throw_if_bad();
    throw;
  }
}

/// repose.InputError.
py::object input_error();

/// Throws KeyboardInterrupt.
[[noreturn]] void throw_interrupted();

}  // namespace repose::python
