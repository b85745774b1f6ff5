/// Exceptions of the library as exceptions of Python.
#include "binding.hpp"
#include "io/atomic_file.hpp"
#include "mpm/grid/numerical_failure.hpp"

namespace repose::python {
namespace {

/// The classes live as long as the module, which is as long as the interpreter.
PyObject* input_error_class = nullptr;
PyObject* numerical_failure = nullptr;

/// problems: as the command tells them, but for its option --set, which is a keyword here.
void raise_input_error(std::vector<std::string> problems) {
  constexpr std::string_view option = "--set ";
  std::string text;
  for (std::string& problem : problems) {
    if (problem.starts_with(option)) problem.erase(0, option.size());
    text += (text.empty() ? "" : "\n") + problem;
  }
  const auto type = py::reinterpret_borrow<py::object>(input_error_class);
  const py::object error = type(text);
  error.attr("problems") = problems;
  PyErr_SetObject(input_error_class, error.ptr());
}

}  // namespace

py::object input_error() { return py::reinterpret_borrow<py::object>(input_error_class); }

void throw_interrupted() {
  PyErr_SetNone(PyExc_KeyboardInterrupt);
  throw py::error_already_set();
}

void bind_errors(py::module_& module) {
  input_error_class = PyErr_NewExceptionWithDoc(
      "repose.InputError",
      "Input that cannot be used. `problems` lists all that is wrong, each with its place, the\n"
      "accepted range and the nearest right name; str() is one per line.",
      PyExc_ValueError, nullptr);
  numerical_failure = PyErr_NewExceptionWithDoc(
      "repose.NumericalFailure",
      "A computation that could not be finished: where, when and why. `result` is what there is\n"
      "of it, or None.",
      PyExc_ArithmeticError, nullptr);
  module.add_object("InputError", input_error_class);
  module.add_object("NumericalFailure", numerical_failure);
  py::reinterpret_borrow<py::object>(input_error_class).attr("problems") = py::list();
  py::reinterpret_borrow<py::object>(numerical_failure).attr("result") = py::none();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const input::BadInput& error) {
      raise_input_error(error.problems());
    } catch (const InputError& error) {
      raise_input_error({error.what()});
    } catch (const mpm::NumericalFailure& error) {
      PyErr_SetString(numerical_failure, error.what());
    } catch (const io::IoError& error) {
      PyErr_SetString(PyExc_OSError, error.what());
    }
  });
}

}  // namespace repose::python
