#include "input/read_fit_parameters.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "input/fit_keys.hpp"
#include "input/read_keys.hpp"

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
  EntryTable given;
  ReadKeys keys(entry);
  entry_keys(keys, given, name, unit, doc, finite);
  result.of = given.of;
  const bool ratio = !given.of.empty();
  p.lower = given.lower;
  p.upper = given.upper;
  p.start = given.start;
  p.scale = given.scale.value_or(p.lower > 0.0 && !ratio ? scale : Scale::linear);
  if (given.has_prior) {
    TomlReader prior = entry.table("prior");
    if (given.sd.has_value() == given.relative_sd.has_value())
      prior.report(
          given.sd ? "relative_sd" : "sd",
          fmt::format("{} needs either sd, in the unit of {} [{}], or relative_sd, a share "
                      "of the mean",
                      entry.path_of("prior"), name, unit));
    if (given.relative_sd && !(given.mean > 0.0))
      prior.report("mean", fmt::format("{} must be > 0 with a relative_sd; got {}",
                                       prior.path_of("mean"), given.mean));
    p.prior = calibration::Prior{given.mean, given.sd.value_or(given.relative_sd.value_or(1.0)),
                                 given.relative_sd.has_value()};
  }
  if (!(p.lower < p.upper) && std::isfinite(p.lower) && std::isfinite(p.upper))
    entry.report("upper", fmt::format("{} = {} must be > lower = {}", entry.path_of("upper"),
                                      p.upper, p.lower));
  if (p.start && p.lower < p.upper && !(*p.start >= p.lower && *p.start <= p.upper))
    entry.report("start",
                 fmt::format("{} = {} lies outside its bounds, {} to {}{}", entry.path_of("start"),
                             *p.start, p.lower, p.upper, ratio ? " of the ratio" : ""));
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
  below_.assign(out_.free.size(), "");
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
    const FreeParameter& p = out_.free[static_cast<std::size_t>(i)];
    const FreeParameter& above = out_.free[static_cast<std::size_t>(j)];
    if (!of_[static_cast<std::size_t>(i)].empty() || !of_[static_cast<std::size_t>(j)].empty() ||
        p.upper < above.lower)
      continue;
    if (!(p.lower < calibration::below_share * above.upper)) {
      file_.report(join_path(path_[static_cast<std::size_t>(i)], "lower"),
                   fmt::format("{0} must be less than {1}, but {0} >= {2} and {1} <= {3} leave no "
                               "such values: lower the bounds of {0} or raise those of {1}",
                               small, large, p.lower, above.upper));
      continue;
    }
    below_[static_cast<std::size_t>(i)] = large;
    out_.notes.push_back(
        fmt::format("{0} < {1} is kept: {0} stays between {2:.4g} and the smaller "
                    "of {3:.4g} and {4} {1}",
                    small, large, p.lower, p.upper, calibration::below_share));
  }
  std::vector<int> placed(out_.free.size(), -1);
  std::vector<FreeParameter> sorted;
  std::vector<std::string> keys;
  for (const bool ratios : {false, true})
    for (std::size_t i = 0; i < out_.free.size(); ++i) {
      if ((of_[i].empty() && below_[i].empty()) == ratios) continue;
      FreeParameter p = out_.free[i];
      if (!below_[i].empty())
        p.below = placed[static_cast<std::size_t>(find(below_[i]))];
      else if (ratios) {
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
  for (auto* list : {&out_.targets, &out_.coarse, &out_.candidates})
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
