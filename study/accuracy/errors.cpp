#include "study/accuracy/errors.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "study/accuracy/accuracy_table.hpp"
#include "study/accuracy/exact_flow.hpp"

namespace repose::study {

using Eigen::VectorXd;

std::string SweepFamily::name() const {
  std::string text =
      fmt::format("{}, {}", mpm::name_of(scene().transfer), mpm::name_of(scene().kernel));
  if (scene().points_per_cell != mpm::Scene{}.points_per_cell)
    text += fmt::format(", {} per cell", scene().points_per_cell);
  if (const std::string variation = runs.front()->variation(); !variation.empty())
    text += ", " + variation;
  return text;
}

std::vector<double> SweepFamily::cells() const {
  std::vector<double> cells;
  for (const SweepRun* run : runs)
    if (cells.empty() || run->scene().h < cells.back()) cells.push_back(run->scene().h);
  return cells;
}

std::vector<Resolution> SweepFamily::levels(Quantity q, double bin) const {
  std::vector<Resolution> levels;
  for (const SweepRun* run : runs) {
    if (levels.empty() || run->scene().h < levels.back().h) levels.push_back({run->scene().h, {}});
    levels.back().runs.push_back(shares_of(*run, q, bin));
  }
  return levels;
}

std::vector<SweepFamily> families_of(std::span<const SweepRun> runs) {
  std::vector<SweepFamily> families;
  for (const SweepRun& run : runs) {
    if (!run.done() || run.scene().dt) continue;
    const auto same = [&](const SweepFamily& f) {
      return f.scene().transfer == run.scene().transfer && f.scene().kernel == run.scene().kernel &&
             f.scene().points_per_cell == run.scene().points_per_cell &&
             f.runs.front()->varied == run.varied;
    };
    const auto found = std::find_if(families.begin(), families.end(), same);
    (found == families.end() ? families.emplace_back() : *found).runs.push_back(&run);
  }
  for (SweepFamily& family : families)
    std::stable_sort(
        family.runs.begin(), family.runs.end(),
        [](const SweepRun* a, const SweepRun* b) { return a->scene().h > b->scene().h; });
  return families;
}

double common_bin(std::span<const SweepRun> runs) {
  double bin = 0.0;
  for (const SweepRun& run : runs) bin = std::max(bin, run.scene().h);
  return bin;
}

std::optional<SweepReference> exact_reference(std::span<const SweepRun> runs,
                                              input::ExactFlow flow) {
  SweepReference reference;
  reference.exact = flow;
  const auto done =
      std::find_if(runs.begin(), runs.end(), [](const SweepRun& run) { return run.done(); });
  if (done == runs.end()) return {};
  for (std::size_t q = 0; q < quantity_count; ++q)
    if (const auto shares = exact_shares(flow, done->scene(), static_cast<Quantity>(q))) {
      Reference& value = reference.values[q].emplace();
      value.value = *shares;
    }
  return reference;
}

std::optional<SweepReference> reference_of(std::span<const SweepRun> runs,
                                           const mpm::Scene& scene) {
  const std::vector<SweepFamily> families = families_of(runs);
  std::optional<SweepReference> reference;
  const auto rank = [&](const SweepFamily& f) {
    const bool own = f.runs.front()->varied == runs.front().varied &&
                     f.scene().transfer == scene.transfer && f.scene().kernel == scene.kernel &&
                     f.scene().points_per_cell == scene.points_per_cell;
    return std::pair(-f.cells().back(), own);
  };
  for (std::size_t k = 0; k < families.size(); ++k) {
    const std::vector<double> cells = families[k].cells();
    if (cells.size() < 3) continue;
    if (reference && rank(families[k]) <= rank(families[reference->family])) continue;
    reference.emplace();
    reference->family = k;
  }
  if (!reference) return {};
  const double bin = common_bin(runs);
  for (std::size_t q = 0; q < quantity_count; ++q) {
    const auto levels = families[reference->family].levels(static_cast<Quantity>(q), bin);
    const auto is_finite = [](const Resolution& level) { return level.mean().allFinite(); };
    if (!std::all_of(levels.begin(), levels.end(), is_finite)) continue;
    reference->values[q] = extrapolated_reference(levels);
    reference->cells = reference->values[q]->sizes;
    reference->steps = levels.back().runs.size();
    for (const Resolution& level : levels)
      reference->steps = std::min(reference->steps, level.runs.size());
  }
  return reference;
}

std::optional<SweepReference> reference_of(std::span<const SweepRun> runs, const mpm::Scene& scene,
                                           const input::Sweep& sweep) {
  return sweep.exact ? exact_reference(runs, *sweep.exact) : reference_of(runs, scene);
}

double error_of(const SweepRun& run, Quantity q, const SweepReference& reference, double bin) {
  const auto& value = reference.values[static_cast<std::size_t>(q)];
  if (!value || !run.done()) return std::nan("");
  return relative_distance(shares_of(run, q, bin), value->value);
}

std::vector<bool> pareto_front(std::span<const SweepRun> runs, Quantity q,
                               const SweepReference& reference) {
  const double bin = common_bin(runs);
  std::vector<double> error;
  for (const SweepRun& run : runs) error.push_back(error_of(run, q, reference, bin));
  std::vector<bool> front(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    front[i] = std::isfinite(error[i]);
    const double cost = runs[i].figure("cpu_s");
    for (std::size_t j = 0; j < runs.size(); ++j) {
      const double other = runs[j].figure("cpu_s");
      if (error[j] <= error[i] && other <= cost && (error[j] < error[i] || other < cost))
        front[i] = false;
    }
  }
  return front;
}

std::string SweepReference::name(std::span<const SweepFamily> families) const {
  if (exact)
    return fmt::format("the exact {}", input::exact_flow_names[static_cast<std::size_t>(*exact)]);
  return families[family].name();
}

ShownErrors shown_errors(const SweepFamily& family, Quantity q, const SweepReference& reference,
                         double bin) {
  const auto& value = reference.values[static_cast<std::size_t>(q)];
  return shown_errors(family.levels(q, bin), value->value, value->error, length_of(family.scene()),
                      error_form(q), start_of(*family.runs.front(), q, bin));
}

}  // namespace repose::study
