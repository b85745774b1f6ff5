/// Inputs: files, shipped ones by name, and tables that a program has made.
#include "binding.hpp"
#include "input/file_kind.hpp"
#include "input/law_tables.hpp"
#include "input/read_initial.hpp"
#include "input/schema.hpp"
#include "input/shipped_input.hpp"
#include "input/toml_reader.hpp"
#include "input/toml_text.hpp"

namespace repose::python {
namespace {

using input::InputFile;
using Sets = std::vector<std::string>;

InputFile open_input(const std::string& kind, const std::string& name_or_file, const Sets& sets) {
  if (kind == "scene") return input::open_scene(name_or_file, sets);
  if (kind == "point_test") return input::open_test(name_or_file, sets);
  return InputFile::read(name_or_file, sets);
}

std::vector<std::string> words(const std::vector<std::string_view>& views) {
  return {views.begin(), views.end()};
}

py::dict key_dict(const input::KeyInfo& key) {
  py::dict about;
  about["name"] = key.name;
  about["unit"] = key.unit;
  about["doc"] = key.doc;
  about["range"] = to_string(key.range);
  about["required"] = key.required;
  about["default"] = key.fallback;
  about["words"] = key.words;
  py::list below;
  for (const input::KeyInfo& one : key.below) below.append(key_dict(one));
  about["below"] = below;
  return about;
}

}  // namespace

void bind_input(py::module_& module) {
  py::class_<InputFile>(module, "Input", "An input with its overrides, not yet checked.")
      .def_static("open", &open_input, py::arg("kind"), py::arg("name_or_file"), py::arg("sets"),
                  "A file, or a shipped scene or point test by its name. sets: \"key=value\".")
      .def_static(
          "table",
          [](const std::string& text, const std::string& name, const Sets& sets) {
            return InputFile::from_table(text, name, sets);
          },
          py::arg("text"), py::arg("name"), py::arg("sets"),
          "A table that a program has made, as TOML text.")
      .def_property_readonly("name", &InputFile::name)
      .def(
          "has",
          [](const InputFile& file, const std::string& key) { return file.root().contains(key); },
          py::arg("table"), "Whether there is a table of this name.")
      .def(
          "count",
          [](const InputFile& file, const std::string& list) {
            const toml::array* const entries = file.root()[list].as_array();
            return entries == nullptr ? std::size_t{0} : entries->size();
          },
          py::arg("list"), "How many entries a list of tables has.")
      .def(
          "text",
          [](const InputFile& file, const std::string& table, const std::string& key) {
            return file.root()[table][key].value_or(std::string());
          },
          py::arg("table"), py::arg("key"), "A text of a table; empty where there is none.")
      .def("__repr__", [](const InputFile& file) { return "<repose input " + file.name() + ">"; });
  module.def(
      "closest",
      [](const std::string& name, const std::vector<std::string>& known) {
        return input::closest(name, {known.begin(), known.end()});
      },
      py::arg("name"), py::arg("known"), "The known name that a misspelt one stands for, or \"\".");
  module.def("toml_string", &input::toml_string, py::arg("text"),
             "A TOML string, quotes included.");
  module.def("toml_number", &input::toml_number, py::arg("x"),
             "The fewest digits that read back as the same number.");
  module.def(
      "shipped_scenes", [] { return words(input::shipped_scenes()); },
      "Names of the scenes that come with repose.");
  module.def(
      "shipped_tests", [] { return words(input::shipped_tests()); },
      "Names of the point tests that come with repose.");
  module.def(
      "shipped_cases", [] { return words(input::shipped_benchmarks()); },
      "Names of the validation cases that come with repose.");
  module.def(
      "keys",
      [](const std::string& kind) {
        py::list all;
        for (const input::KeyInfo& key : input::keys_of(input::schema_kind(kind)))
          all.append(key_dict(key));
        return all;
      },
      py::arg("kind"), "Every key of a kind of input: name, unit, range, meaning, default.");
  module.def(
      "json_schema",
      [](const std::string& kind) { return input::json_schema(input::schema_kind(kind)); },
      py::arg("kind"), "A JSON Schema of a kind of input, as text.");
  module.def("law_description", &input::law_description, py::arg("name"),
             "The tables of a law as `repose models NAME` prints them.");
}

}  // namespace repose::python
