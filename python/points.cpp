/// Point tests.
#include <fmt/format.h>

#include "binding.hpp"
#include "input/file_kind.hpp"
#include "input/read_point_test.hpp"
#include "pointdriver/integrate/gradient.hpp"
#include "report/picture/point_picture.hpp"
#include "study/point/laboratory_record.hpp"
#include "study/point/test_record.hpp"
#include "study/run/run_record.hpp"

namespace repose::python {
namespace {

using point::Quantity;

std::string name_of(point::Status status) {
  constexpr std::array<std::string_view, 12> names{
      "completed",     "stopped",      "separated",   "beyond_limit",
      "no_response",   "goal_not_met", "step_limit",  "step_underflow",
      "not_converged", "not_finite",   "bad_initial", "unsupported"};
  return std::string(names[static_cast<std::size_t>(status)]);
}

/// A test that was read once and may be driven often.
class PointTest {
 public:
  explicit PointTest(input::InputFile file) {
    input::require_kind(file, input::FileKind::point_test, "point");
    input_ = std::make_shared<const input::InputFile>(file);
    file_ = std::make_shared<const input::PointTestFile>(input::read_point_test(file));
  }
  PointTest(std::shared_ptr<const input::InputFile> input, input::PointTestFile file)
      : input_(std::move(input)),
        file_(std::make_shared<const input::PointTestFile>(std::move(file))) {}

  const input::PointTestFile& file() const { return *file_; }
  const input::InputFile& input() const { return *input_; }

  /// The same with other values of parameters.
  PointTest with(const std::map<std::string, double>& values) const {
    input::PointTestFile changed = *file_;
    for (const auto& [name, x] : values) changed.law.values[name] = x;
    checked_parameters(changed.law);
    return {input_, std::move(changed)};
  }

 private:
  std::shared_ptr<const input::InputFile> input_;
  std::shared_ptr<const input::PointTestFile> file_;
};

/// A test as it was driven. What is not the curve is found when it is asked for.
class Driven {
 public:
  explicit Driven(PointTest test) : test_(std::move(test)) {
    result_.law = &find_law(test_.file().law);
    result_.theta = checked_parameters(test_.file().law);
    const py::gil_scoped_release released;
    const double begun = study::usage().wall_s;
    point::simulate(*result_.law, result_.theta, test_.file().test, result_.curve);
    result_.wall_s = study::usage().wall_s - begun;
  }

  const input::PointTestFile& file() const { return test_.file(); }
  const point::Curve& curve() const { return result_.curve; }
  bool failed() const { return result_.failed(); }
  double seconds() const { return result_.wall_s; }

  std::vector<std::string> columns() const {
    std::vector<std::string> names;
    for (const Quantity q : point::columns_of(*result_.law, file().test))
      names.emplace_back(point::column_name(q));
    const auto [stage, cycle] = study::stage_columns(file().test.path);
    if (stage) names.emplace_back("stage");
    if (cycle) names.emplace_back("cycle");
    return names;
  }

  py::array column(const std::string& name) const {
    if (name == "stage" || name == "cycle") {
      const auto places = file().test.path.places();
      std::vector<std::int64_t> values;
      for (const auto& row : curve().rows) {
        const auto& at = places[static_cast<std::size_t>(row.leg)];
        values.push_back(name == "stage" ? at.stage : at.cycle);
      }
      return array_of(std::move(values));
    }
    const std::optional<Quantity> quantity = point::find_quantity(name);
    if (!quantity) {
      const std::vector<std::string> known = columns();
      const std::string near = input::closest(name, {known.begin(), known.end()});
      throw InputError(name,
                       fmt::format("there is no column '{}': {}{}", name, fmt::join(known, ", "),
                                   near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
    std::vector<double> values;
    point::read_column(*result_.law, result_.theta, file().test, curve(), *quantity, values);
    return array_of(std::move(values));
  }

  /// (rows, 6) of every row.
  py::array tensor(Sym<double, 6> point::Row<double>::*field) const {
    std::vector<double> values;
    for (const auto& row : curve().rows)
      values.insert(values.end(), (row.*field).c.begin(), (row.*field).c.end());
    return array_of(std::move(values), {static_cast<py::ssize_t>(curve().rows.size()), 6});
  }
  py::array number(double point::Row<double>::*field) const {
    std::vector<double> values;
    for (const auto& row : curve().rows) values.push_back(row.*field);
    return array_of(std::move(values));
  }
  py::array state() const {
    const std::size_t m =
        std::min(result_.law->state.size() + result_.law->derived.size(), point::max_state);
    std::vector<double> values;
    for (const auto& row : curve().rows)
      values.insert(values.end(), row.state.begin(),
                    row.state.begin() + static_cast<std::ptrdiff_t>(m));
    return array_of(std::move(values),
                    {static_cast<py::ssize_t>(curve().rows.size()), static_cast<py::ssize_t>(m)});
  }

  const std::string& reason() {
    look_closer();
    return result_.reason;
  }
  std::string laboratory() {
    look_closer();
    return study::laboratory_json(result_.figures).dump();
  }
  std::string summary() {
    look_closer();
    return study::test_summary(file(), result_, study::resolved_test(test_.input(), file()),
                               result_.wall_s, 0)
        .dump();
  }
  std::vector<std::string> notes() const {
    std::vector<std::string> all = file().notes;
    for (std::string& remark : study::remarks(file(), result_)) all.push_back(std::move(remark));
    return all;
  }
  std::string csv() const { return study::curve_csv(file(), result_); }
  void picture(const std::string& path) const {
    report::point_picture(file(), result_.theta, curve()).render_svg(path);
  }

 private:
  void look_closer() {
    if (!result_.reason.empty()) return;
    const py::gil_scoped_release released;
    result_.figures = point::laboratory_figures(*result_.law, result_.theta, file().test, curve(),
                                                file().secants_at);
    result_.reason = point::explain(*result_.law, result_.theta, file().test, curve());
  }

  PointTest test_;
  study::TestResult result_;
};

py::tuple sensitivities(const PointTest& test, const std::vector<std::string>& parameters,
                        const std::vector<std::string>& columns) {
  const LawInfo& law = find_law(test.file().law);
  // what the law derives stays absent, and follows
  const std::vector<double> theta =
      parameter_vector(law.name, law.parameters, test.file().law.values);
  std::vector<std::string_view> known;
  for (const ParamInfo& p : law.parameters) known.push_back(p.name);
  std::vector<int> which;
  for (const std::string& name : parameters) {
    which.push_back(point::parameter_index(law.parameters, name));
    if (which.back() >= 0) continue;
    const std::string near = input::closest(name, known);
    throw InputError(
        name, fmt::format("{} has no parameter '{}': {}{}", law.name, name, fmt::join(known, ", "),
                          near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
  std::vector<Quantity> quantities;
  for (const std::string& name : columns) {
    const std::optional<Quantity> quantity = point::find_quantity(name);
    if (!quantity) throw InputError(name, "there is no column '" + name + "'");
    quantities.push_back(*quantity);
  }
  std::vector<point::GradientColumn> found;
  point::Outcome outcome;
  {
    const py::gil_scoped_release released;
    outcome = point::simulate_columns_with_gradient(law, theta, which, test.file().test, quantities,
                                                    found);
  }
  py::list values, derivatives;
  for (point::GradientColumn& column : found) {
    const auto rows = static_cast<py::ssize_t>(column.values.size());
    derivatives.append(
        array_of(std::move(column.derivatives), {rows, static_cast<py::ssize_t>(which.size())}));
    values.append(array_of(std::move(column.values)));
  }
  return py::make_tuple(name_of(outcome.status), values, derivatives);
}

}  // namespace

void bind_point(py::module_& module) {
  using Row = point::Row<double>;
  py::class_<Driven>(module, "Driven", "A point test as it was driven.")
      .def_property_readonly("columns", &Driven::columns)
      .def("column", &Driven::column, py::arg("name"), "A column of curve.csv by its name.")
      .def_property_readonly("rows", [](const Driven& d) { return d.curve().rows.size(); })
      .def_property_readonly("status",
                             [](const Driven& d) { return name_of(d.curve().outcome.status); })
      .def_property_readonly("failed", &Driven::failed)
      .def_property_readonly("fraction", [](const Driven& d) { return d.curve().outcome.fraction; })
      .def_property_readonly("steps",
                             [](const Driven& d) { return d.curve().outcome.counts.steps; })
      .def_property_readonly("wall_s", &Driven::seconds)
      .def_property_readonly("reason", &Driven::reason)
      .def_property_readonly("notes", &Driven::notes)
      .def_property_readonly("stress", [](const Driven& d) { return d.tensor(&Row::stress); })
      .def_property_readonly("strain", [](const Driven& d) { return d.tensor(&Row::strain); })
      .def_property_readonly("state", &Driven::state)
      .def_property_readonly("density", [](const Driven& d) { return d.number(&Row::density); })
      .def_property_readonly("work", [](const Driven& d) { return d.number(&Row::work); })
      .def_property_readonly("dissipated",
                             [](const Driven& d) { return d.number(&Row::dissipated); })
      .def("laboratory", &Driven::laboratory, "\"laboratory\" of summary.json, as text.")
      .def("summary", &Driven::summary, "summary.json, as text.")
      .def("csv", &Driven::csv, "The text of curve.csv.")
      .def("picture", &Driven::picture, py::arg("path"), "Draws curve.svg with gnuplot.");
  py::class_<PointTest>(module, "PointTest", "A point test that was read and checked.")
      .def(py::init<input::InputFile>(), py::arg("input"))
      .def_property_readonly("name", [](const PointTest& t) { return t.file().name; })
      .def_property_readonly("law", [](const PointTest& t) { return t.file().law.name; })
      .def_property_readonly("law_toml",
                             [](const PointTest& t) { return input::law_lines(t.file().law); })
      .def_property_readonly("method",
                             [](const PointTest& t) {
                               return std::string(point::name_of(point::method_for(
                                   find_law(t.file().law), t.file().test.settings.method)));
                             })
      .def_property_readonly(
          "stages", [](const PointTest& t) { return t.file().test.path.places().back().stage; })
      .def("with_parameters", &PointTest::with, py::arg("values"),
           "The same test with other values of parameters of its law.")
      .def(
          "run", [](const PointTest& t) { return std::make_unique<Driven>(t); }, "Drives it.")
      .def("sensitivities", &sensitivities, py::arg("parameters"), py::arg("columns"),
           "Columns and their derivatives, (rows, parameters) each.");
}

}  // namespace repose::python
