#include "input/read_fit_solver.hpp"

#include <fmt/core.h>

#include "input/fit_keys.hpp"
#include "input/read_keys.hpp"

namespace repose::input {
namespace {

std::string joined_algorithms() {
  std::string text;
  for (const auto& a : calibration::algorithms())
    text += (text.empty() ? "\"" : ", \"") + std::string(a.name) + "\"";
  return text;
}

/// An algorithm of the wrong kind, or none at all.
void check_algorithm(TomlReader& solver, const char* key, const std::string& name, bool global) {
  if (name == "none") return;
  const calibration::Algorithm* a = calibration::find_algorithm(name);
  if (a == nullptr) {
    std::vector<std::string_view> known{"none"};
    for (const auto& b : calibration::algorithms()) known.push_back(b.name);
    const std::string near = nearest_name(name, known);
    solver.report(key, fmt::format("{} = \"{}\" is no algorithm{}; there are \"none\", {}",
                                   solver.path_of(key), name,
                                   near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near),
                                   joined_algorithms()));
  } else if (a->global != global) {
    solver.report(
        key, fmt::format("{}: {} is a {} algorithm; it belongs to solver.{}", solver.path_of(key),
                         name, a->global ? "global" : "local", a->global ? "global" : "local"));
  }
}

}  // namespace

FitFile default_fit() {
  FitFile fit;
  fit.options.global = "none";
  fit.options.local = calibration::levenberg_marquardt_name;
  fit.options.starts = 16;
  return fit;
}

void read_solver(TomlReader solver, std::uint64_t seed, FitFile& out) {
  out.options.seed = seed;
  ReadKeys keys(solver);
  solver_keys(keys, out);
  check_algorithm(solver, "global", out.options.global, true);
  check_algorithm(solver, "local", out.options.local, false);
  if (out.options.global == "none" && out.options.local == "none")
    solver.report("local", "solver.global and solver.local cannot both be \"none\"");
}

void read_uncertainty(TomlReader table, FitFile& out) {
  ReadKeys keys(std::move(table));
  uncertainty_keys(keys, out);
}

void read_posterior(TomlReader table, FitFile& out) {
  if (out.loss.robust())
    table.report("noise", fmt::format("{} takes the errors to be normal: leave out either it or "
                                      "solver.residuals",
                                      table.path()));
  out.posterior.emplace();
  ReadKeys keys(table);
  posterior_keys(keys, *out.posterior);
  if (!out.posterior->keep_declared_noise) return;
  for (const calibration::Target& t : out.targets)
    for (const calibration::Channel& c : t.channels)
      if (!t.held_out && !c.noise)
        table.report("noise", fmt::format("{} = \"declared\", but {} declares no noise of {}",
                                          table.path_of("noise"), t.name, c.name));
}

}  // namespace repose::input
