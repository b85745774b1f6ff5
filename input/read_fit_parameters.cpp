#include "input/read_fit_parameters.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace repose::input {

using calibration::FreeParameter;
using calibration::Target;

FitParameters::Entry FitParameters::read_entry(TomlReader entry, const std::string& name,
                                               std::string_view unit, std::string_view doc,
                                               Scale scale, const Range& range) {
  Entry result;
  FreeParameter& p = result.parameter;
  p.name = name;
  p.unit = unit;
  const Range finite{std::isfinite(range.lower) ? range.lower : -1e300,
                     std::isfinite(range.upper) ? range.upper : 1e300, false, false};
  result.of = entry.text("of", "another free parameter, to which this one is a ratio", "");
  const bool ratio = !result.of.empty();
  const Range bounds = ratio ? Range{0.0, 1e6, false, false} : finite;
  const std::string what = ratio ? name + "/" + result.of : std::string(doc);
  p.lower = entry.number({"lower", ratio ? "-" : unit, "lower bound of " + what, bounds, {}});
  p.upper = entry.number({"upper", ratio ? "-" : unit, "upper bound of " + what, bounds, {}});
  const std::size_t fallback = scale == Scale::log && p.lower > 0.0 && !ratio ? 1 : 0;
  p.scale = entry.choice("scale", {"linear", "log"}, fallback) == 1 ? Scale::log : Scale::linear;
  p.start = entry.optional_number({"start", ratio ? "-" : unit, "start of " + what, {}, {}});
  if (entry.has("prior")) {
    TomlReader prior = entry.table("prior");
    p.prior = calibration::Prior{
        prior.number({"mean", unit, "expected value", {}, {}}),
        prior.number({"sd", "-", "standard deviation (relative on a log scale)", positive, {}})};
  } else {
    entry.expect("prior");
  }
  if (!(p.lower < p.upper) && std::isfinite(p.lower) && std::isfinite(p.upper))
    entry.report("upper", fmt::format("{} = {} must be > lower = {}", entry.path_of("upper"),
                                      p.upper, p.lower));
  if (p.scale == Scale::log && p.lower <= 0.0)
    entry.report("lower", fmt::format("{} must be > 0 on a logarithmic scale; got {}",
                                      entry.path_of("lower"), p.lower));
  return result;
}

double start_value(const FreeParameter& p) {
  if (p.start) return *p.start;
  return p.scale == Scale::log && p.lower > 0.0 ? std::sqrt(p.lower * p.upper)
                                                : 0.5 * (p.lower + p.upper);
}

const ParamInfo* FitParameters::law_parameter(std::string_view name) const {
  for (const ParamInfo& p : out_.info->parameters)
    if (p.name == name) return &p;
  return nullptr;
}

int FitParameters::add(Entry entry, std::string law_key, const std::string& path) {
  out_.free.push_back(std::move(entry.parameter));
  of_.push_back(std::move(entry.of));
  out_.law_key.push_back(std::move(law_key));
  path_.push_back(path);
  return static_cast<int>(out_.free.size()) - 1;
}

void FitParameters::read(TomlReader& fit) {
  fit.expect_any();
  // in the order of the law's table, so that results read alike whatever the file's order
  for (const ParamInfo& p : out_.info->parameters)
    if (fit.has(p.name))
      add(read_entry(fit.table(p.name), std::string(p.name), p.unit, p.doc, p.scale, p.range),
          std::string(p.name), fit.path_of(p.name));
  for (const std::string& key : fit.keys()) {
    if (law_parameter(key) != nullptr) continue;
    if (key == "shared") {
      TomlReader shared = fit.table("shared");
      shared.expect_any();
      for (const std::string& name : shared.keys())
        shared_[name] =
            add(read_entry(shared.table(name), name, "-", "the shared quantity", Scale::linear, {}),
                "", shared.path_of(name));
      continue;
    }
    std::vector<std::string_view> known{"shared"};
    for (const ParamInfo& p : out_.info->parameters) known.push_back(p.name);
    const std::string near = closest(key, known);
    fit.report(key, fmt::format("{} has no parameter '{}'{}", out_.info->name, key,
                                near.empty() ? fmt::format("; it has {}", fmt::join(known, ", "))
                                             : fmt::format("; did you mean '{}'?", near)));
  }
}

int FitParameters::add_initial(TomlReader& free, const std::string& key,
                               const std::string& target) {
  const bool pressure = key == "p" || key == "p_c0";
  const Range range = key == "ocr" || key == "v" ? Range{1.0, 1e300, false, false} : positive;
  return add(read_entry(free.table(key), key + " of " + target, pressure ? "Pa" : "-",
                        "the initial " + key, pressure ? Scale::log : Scale::linear, range),
             "", free.path_of(key));
}

void FitParameters::link_ratios() {
  std::vector<std::size_t> order(out_.free.size());
  const auto find = [&](std::string_view name) {
    for (std::size_t i = 0; i < out_.free.size(); ++i)
      if (out_.free[i].name == name) return static_cast<int>(i);
    return -1;
  };
  for (const auto& [small, large] :
       {std::pair<std::string_view, std::string_view>{"kappa", "lambda"}, {"mu_0", "mu_d"}}) {
    const int i = find(small), j = find(large);
    if (i < 0 || j < 0 || out_.law_key[static_cast<std::size_t>(i)] != small) continue;
    FreeParameter& p = out_.free[static_cast<std::size_t>(i)];
    const FreeParameter& of = out_.free[static_cast<std::size_t>(j)];
    if (!of_[static_cast<std::size_t>(i)].empty() || p.upper < of.lower || p.prior) continue;
    const double start = start_value(p) / start_value(of);
    p.lower = std::max(1e-6, p.lower / of.upper);
    p.upper = std::min(0.999, p.upper / of.lower);
    p.start = start;
    p.scale = Scale::linear;
    of_[static_cast<std::size_t>(i)] = large;
    out_.notes.push_back(fmt::format("{} < {} is kept by fitting {}/{} in [{:.3g}, {:.3g}]", small,
                                     large, small, large, p.lower, p.upper));
  }
  std::vector<int> placed(out_.free.size(), -1);
  std::vector<FreeParameter> sorted;
  std::vector<std::string> keys;
  for (const bool ratios : {false, true})
    for (std::size_t i = 0; i < out_.free.size(); ++i) {
      if (of_[i].empty() == ratios) continue;
      FreeParameter p = out_.free[i];
      if (ratios) {
        const int other = find(of_[i]);
        if (other < 0 || !of_[static_cast<std::size_t>(other)].empty()) {
          file_.report(join_path(path_[i], "of"),
                       fmt::format("{}.of = \"{}\" must name a free parameter that is no ratio "
                                   "itself",
                                   path_[i], of_[i]));
          continue;
        }
        p.of = placed[static_cast<std::size_t>(other)];
      }
      placed[i] = static_cast<int>(sorted.size());
      sorted.push_back(std::move(p));
      keys.push_back(out_.law_key[i]);
    }
  if (sorted.empty()) file_.report("fit", "[fit] needs at least one free parameter");
  for (auto* list : {&out_.targets, &out_.coarse})
    for (Target& t : *list)
      for (calibration::Binding& b : t.bindings)
        b.parameter = placed[static_cast<std::size_t>(b.parameter)];
  out_.free = std::move(sorted);
  out_.law_key = std::move(keys);
  try {
    if (file_.ok()) calibration::ParameterSpace space(out_.free);
  } catch (const InputError& error) {
    file_.report(error, "fit");
  }
}

}  // namespace repose::input
