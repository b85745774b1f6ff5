#include "binding.hpp"
#include "models/instruction_set.hpp"
#include "repose_version.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace repose::python;
  module.doc() = "The compiled part of repose; the package `repose` is what to import.";
  module.attr("version") = repose::version;
  module.attr("version_string") = repose::version_string;
  module.attr("instruction_set") = std::string(repose::instruction_set());
  bind_errors(module);
  bind_input(module);
  bind_laws(module);
  bind_own_law(module);
  bind_point(module);
  bind_simulation(module);
  bind_fit(module);
  bind_verbs(module);
  bind_results(module);
}
