#include "study/accuracy/accuracy_table.hpp"

#include <algorithm>
#include <cmath>

#include "study/accuracy/trained_domain.hpp"

namespace repose::study {
namespace {

using mpm::Kernel;
using mpm::Transfer;

struct Row {
  std::string_view law;
  Kernel kernel;
  Transfer transfer;
  double courant;
  Quantity quantity;
  double bias, motion, irregularity, scatter;
};

/// What does not depend on the law, in the order of Quantity; `scripts/accuracy rehearse` tells
/// what it is worth (docs/accuracy.md).
struct Form {
  double order, motion_order, caution;
};
constexpr std::array<Form, quantity_count> forms{{
    {1.0, 0.0, 0.8},   // front
    {1.1, 0.0, 0.6},   // front_99
    {0.85, 1.0, 2.5},  // height
    {0.9, 0.5, 0.75},  // profile
    {1.1, 0.0, 0.85},  // kinetic
    {1.0, 0.0, 1.0},   // momentum, which --accuracy is not asked for
}};

// printed by `scripts/accuracy constants`; docs/accuracy.md
constexpr std::array rows{
#include "study/accuracy/accuracy_rows.inc"
};

}  // namespace

ErrorModel error_form(Quantity q) {
  const Form& form = forms[static_cast<std::size_t>(q)];
  ErrorModel model;
  model.order = form.order;
  model.motion_order = form.motion_order;
  model.caution = form.caution;
  return model;
}

std::vector<Candidate> candidates_for(const mpm::Scene& scene, Quantity q) {
  std::vector<Candidate> candidates;
  for (const mpm::Body& body : scene.bodies) {
    const bool known = is_charted(body.law);
    for (const Row& row : rows) {
      if (row.quantity != q || (known && row.law != body.law.name)) continue;
      const auto found = std::find_if(
          candidates.begin(), candidates.end(),
          [&](const Candidate& c) { return c.kernel == row.kernel && c.transfer == row.transfer; });
      if (found == candidates.end()) {
        ErrorModel model = error_form(q);
        model.bias = row.bias;
        model.motion = row.motion;
        model.irregularity = row.irregularity;
        model.scatter = row.scatter;
        candidates.push_back({row.kernel, row.transfer, row.courant, model});
        continue;
      }
      found->courant = std::min(found->courant, row.courant);
      found->model.bias = std::max(found->model.bias, row.bias);
      found->model.motion = std::max(found->model.motion, row.motion);
      found->model.irregularity = std::max(found->model.irregularity, row.irregularity);
      found->model.scatter = std::max(found->model.scatter, row.scatter);
    }
  }
  if (scene.dimensions() == 3)
    for (Candidate& candidate : candidates) candidate.courant *= space_share;
  return candidates;
}

mpm::Scene scene_with(mpm::Scene scene, const Candidate& candidate, double h, int k) {
  scene.kernel = candidate.kernel;
  if (scene.transfer != candidate.transfer) {
    scene.transfer = candidate.transfer;
    scene.relaxation_time.reset();
  }
  scene.h = h;
  scene.dt.reset();
  scene.courant = std::round(1e4 * candidate.courant * (1.0 - 0.04 * k)) / 1e4;
  return scene;
}

std::vector<double> sizes_for(const mpm::Scene& scene, double most_points) {
  const bool in_space = scene.dimensions() == 3;
  double volume = 0.0, narrowest = HUGE_VAL;  // per metre of depth in the plane
  for (const mpm::Body& body : scene.bodies) {
    volume += body.size[0] * body.size[1] * (in_space ? body.size[2] : 1.0);
    const double ring = body.disc ? 2.0 * (body.disc->radius - body.disc->hole) : HUGE_VAL;
    narrowest = std::min({narrowest, body.size[0], body.size[1], ring});
    if (in_space) narrowest = std::min(narrowest, body.size[2]);
  }
  const auto divides = [&](double h) {
    mpm::Scene other = scene;
    other.h = h;
    mpm::raise_top_to_cells(other);
    try {
      mpm::validate(other);
    } catch (const InputError&) {
      return false;
    }
    return narrowest >= 3.999 * h;
  };
  std::vector<double> sizes{scene.h};
  while (divides(2.0 * sizes.front())) sizes.insert(sizes.begin(), 2.0 * sizes.front());
  const auto points = [&](double h) {
    return scene.points_per_cell * volume / std::pow(h, in_space ? 3 : 2);
  };
  while (points(0.5 * sizes.back()) <= most_points) sizes.push_back(0.5 * sizes.back());
  // between one size and half of it, which takes 8 times as long, those that take 2 and 3.4 times
  std::vector<double> all;
  for (const double h : sizes) {
    all.push_back(h);
    if (h == sizes.back()) break;
    for (const double between : {4.0 * h / 5.0, 2.0 * h / 3.0})
      if (divides(between)) all.push_back(between);
  }
  return all;
}

}  // namespace repose::study
