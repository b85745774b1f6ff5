#include "input/read_fit.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "input/program_identity.hpp"
#include "input/read_fit_parameters.hpp"
#include "input/read_fit_solver.hpp"
#include "input/read_fit_target.hpp"
#include "input/read_law.hpp"
#include "input/read_umat.hpp"
#include "io/fingerprint.hpp"
#include "umat/in/library_law.hpp"

namespace repose::input {
namespace {

void read_tables(InputFile& file, std::uint64_t seed, const std::filesystem::path& cache,
                 FitFile& out) {
  TomlReader root(file);
  root.expect("chart");  // read_chart.hpp
  out.name = std::filesystem::path(file.name()).stem().string();
  out.law = read_law(root.table("law"));
  TomlReader fit = root.table("fit");
  read_solver(root.table("solver"), seed, out);
  read_uncertainty(root.table("uncertainty"), out);
  std::vector<TomlReader> targets = root.tables("target", "an experiment");
  std::vector<TomlReader> candidates;
  if (root.has("candidate"))
    candidates = root.tables("candidate", "a test that could be made next");
  const bool posterior = root.has("posterior");
  TomlReader posterior_table = root.table("posterior");
  if (!file.ok()) {
    // what depends on a sound law cannot be checked yet
    fit.expect_any();
    posterior_table.expect_any();
    for (TomlReader& t : targets) t.expect_any();
    for (TomlReader& t : candidates) t.expect_any();
    file.throw_if_bad();
  }
  out.info = &find_law(out.law);
  FitParameters parameters(file, out);
  parameters.read(fit);
  TargetReader reader(file, out, parameters,
                      parameter_vector(out.info->name, out.info->parameters, out.law.values),
                      cache);
  for (TomlReader& t : targets) reader.read(t);
  for (TomlReader& t : candidates) reader.read_candidate(t);
  file.throw_if_bad();
  if (posterior) read_posterior(std::move(posterior_table), out);
  if (!reader.has_coarse()) out.coarse.clear();
  parameters.link_ratios();
  file.throw_if_bad();
}

/// The law's free parameters at their start, as overrides of [law], so that one reader serves both.
std::vector<std::string> starts_as_overrides(const InputFile& file) {
  std::vector<std::string> overrides;
  const toml::table* fit = file.root()["fit"].as_table();
  if (fit == nullptr) return overrides;
  const toml::table* law = file.root()["law"].as_table();
  std::vector<std::string> problems;
  std::map<std::string, double, std::less<>> starts;
  const auto bound = [](const toml::table& t, const char* key) {
    const auto node = t[key];
    return node.is_number() ? *node.value<double>() : std::nan("");
  };
  for (const auto& [key, node] : *fit) {
    const toml::table* entry = node.as_table();
    if (entry == nullptr || key.str() == "shared") continue;
    const std::string name(key.str());
    const auto law_name = file.root()["law"]["name"].value<std::string>();
    if (law_name == std::string(umat::law_name)) continue;  // it has a value for each of its names
    const LawList laws = all_laws();
    const ParamInfo* parameter = nullptr;
    for (const LawInfo& info : laws)
      if (law_name && info.name == *law_name)
        for (const ParamInfo& p : info.parameters)
          if (p.name == name) parameter = &p;
    if (parameter == nullptr) {
      std::vector<std::string_view> known{"shared"};
      for (const LawInfo& info : laws)
        if (law_name && info.name == *law_name)
          for (const ParamInfo& p : info.parameters) known.push_back(p.name);
      if (known.size() == 1) continue;  // no such law: reported later
      const std::string near = closest(name, known);
      problems.push_back(fmt::format(
          "{}: {} has no parameter '{}'{}", to_string(file.origin("fit." + name)), *law_name, name,
          near.empty() ? fmt::format("; it has {}", fmt::join(known, ", "))
                       : fmt::format("; did you mean '{}'?", near)));
      continue;
    }
    if (!parameter->words.empty()) {
      problems.push_back(fmt::format("{}: {} is a word, not a number: give it in [law]",
                                     to_string(file.origin("fit." + name)), name));
      continue;
    }
    const std::string_view angle = parameter->angle.name;
    if (law != nullptr && (law->contains(name) || (!angle.empty() && law->contains(angle)))) {
      problems.push_back(fmt::format("{}: {} is fixed in [law] and free in [fit]: leave out one",
                                     to_string(file.origin("fit." + name)), name));
      continue;
    }
    double lower = bound(*entry, "lower"), upper = bound(*entry, "upper"),
           start = bound(*entry, "start"), of = 1.0;
    if (const auto other = (*entry)["of"].value<std::string>())
      if (const toml::table* partner = (*fit)[*other].as_table()) {
        const double a = bound(*partner, "lower"), b = bound(*partner, "upper");
        const double s = bound(*partner, "start");
        of = std::isnan(s) ? (a > 0.0 ? std::sqrt(a * b) : 0.5 * (a + b)) : s;
      }
    // only a stand-in that the law accepts: the fit starts where the coordinates say
    if (std::isnan(start) || !(start > lower && start < upper))
      start = lower > 0.0 ? std::sqrt(lower * upper) : 0.5 * (lower + upper);
    if (std::isfinite(start * of)) starts[name] = start * of;
  }
  // in the order that the laws demand; whether the bounds leave room for it, link_ratios() tells
  for (const auto& [small, large] : {std::pair{"kappa", "lambda"}, {"mu_0", "mu_d"}})
    if (starts.contains(small) && starts.contains(large) && starts[small] >= starts[large])
      starts[small] = 0.5 * starts[large];
  for (const auto& [name, start] : starts)
    overrides.push_back(fmt::format("law.{}={}", name, start));
  if (!problems.empty()) throw BadInput(std::move(problems));
  return overrides;
}

}  // namespace

FitFile read_fit(const std::filesystem::path& file, std::span<const std::string> overrides,
                 std::uint64_t seed, const std::filesystem::path& cache) {
  return read_fit(InputFile::read(file, overrides), seed, cache);
}

FitFile read_fit(const InputFile& given, std::uint64_t seed, const std::filesystem::path& cache) {
  const std::filesystem::path file = given.name();
  InputFile input = given.with(starts_as_overrides(given));
  FitFile out = default_fit();
  read_tables(input, seed, cache, out);
  out.tables = input.tables();

  toml::table resolved = given.root();
  resolved.erase("chart");  // says nothing of the fit
  if (toml::table* law = resolved["law"].as_table()) anchor_umat(*law, file.parent_path());
  if (toml::array* targets = resolved["target"].as_array())
    for (auto& node : *targets)
      if (toml::table* t = node.as_table())
        for (const char* key : {"data", "scene"})
          if (const auto name = (*t)[key].value<std::string>())
            t->insert_or_assign(
                key,
                std::filesystem::absolute(file.parent_path() / *name).lexically_normal().string());
  const auto text_of = [](const toml::table& table) {
    std::ostringstream text;
    text << table << "\n";
    return std::move(text).str();
  };
  out.resolved = text_of(resolved);
  for (const char* key : {"posterior", "candidate"}) resolved.erase(key);  // say nothing of a start
  std::string key = text_of(resolved) + out.fingerprint +
                    fmt::format("seed {} {}", out.options.seed, program_identity());
  for (const calibration::Target& t : out.targets)
    for (const auto& channel : t.channels)
      for (Eigen::Index i = 0; i < t.rows(); ++i)
        key += fmt::format(" {} {}", t.x[i], channel.observed[i]);
  out.fingerprint = io::fingerprint_of(key);
  return out;
}

LawSpec fitted_law(const FitFile& file, const Eigen::VectorXd& values) {
  LawSpec law = file.law;
  for (std::size_t i = 0; i < file.free.size(); ++i)
    if (!file.law_key[i].empty())
      law.values[file.law_key[i]] = values[static_cast<Eigen::Index>(i)];
  return law;
}

}  // namespace repose::input
