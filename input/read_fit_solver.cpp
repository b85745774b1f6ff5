#include "input/read_fit_solver.hpp"

#include <limits>

#include <fmt/format.h>

namespace repose::input {
namespace {

std::string joined_algorithms() {
  std::string text;
  for (const auto& a : calibration::algorithms())
    text += (text.empty() ? "\"" : ", \"") + std::string(a.name) + "\"";
  return text;
}

}  // namespace

void read_solver(TomlReader solver, std::uint64_t seed, FitFile& out) {
  calibration::FitOptions& o = out.options;
  const auto algorithm = [&](const char* key, std::string fallback, bool global) {
    const std::string name = solver.text(
        key, global ? "a global algorithm or \"none\"" : "a local algorithm or \"none\"",
        std::move(fallback));
    if (name == "none") return name;
    const calibration::Algorithm* a = calibration::find_algorithm(name);
    if (a == nullptr) {
      std::vector<std::string_view> known{"none"};
      for (const auto& b : calibration::algorithms()) known.push_back(b.name);
      const std::string near = nearest_name(name, known);
      solver.report(
          key,
          fmt::format("{} = \"{}\" is no algorithm{}; there are \"none\", {}", solver.path_of(key),
                      name, near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near),
                      joined_algorithms()));
    } else if (a->global != global) {
      solver.report(
          key, fmt::format("{}: {} is a {} algorithm; it belongs to solver.{}", solver.path_of(key),
                           name, a->global ? "global" : "local", a->global ? "global" : "local"));
    }
    return name;
  };
  o.global = algorithm("global", "none", true);
  o.local = algorithm("local", std::string(calibration::levenberg_marquardt_name), false);
  o.starts = static_cast<int>(solver.integer("starts", "starting points", 1, 1000000, 16));
  o.global_evaluations = solver.integer("global_evaluations", "of the global search", 1, 1000000000,
                                        o.global_evaluations);
  o.local_evaluations =
      solver.integer("local_evaluations", "per start", 1, 1000000000, o.local_evaluations);
  o.x_tolerance = solver.number(
      {"tolerance", "-", "of the parameters over their bounds", Range{0.0, 0.1}, o.x_tolerance});
  out.fine_evaluations = solver.integer("fine_evaluations",
                                        "of scenes at full resolution, after "
                                        "the search with coarse ones",
                                        1, 1000000000, out.fine_evaluations);
  out.balance = solver.boolean("balance", true);
  o.seed = static_cast<std::uint64_t>(solver.integer("seed", "of random numbers", 0,
                                                     std::numeric_limits<std::int64_t>::max(),
                                                     static_cast<std::int64_t>(seed)));
  if (o.global == "none" && o.local == "none")
    solver.report("local", "solver.global and solver.local cannot both be \"none\"");
}

void read_uncertainty(TomlReader table, FitFile& out) {
  out.profiles = table.boolean("profile", true);
  out.resolution_error = table.number(
      {"resolution", "-",
       "error of the fine scenes over the change from coarse to fine; 0: none is allowed for",
       Range{0.0, 100.0}, out.resolution_error});
  out.bootstrap =
      static_cast<int>(table.integer("bootstrap", "refits of resampled data", 0, 100000, 0));
}

}  // namespace repose::input
