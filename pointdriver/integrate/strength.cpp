#include "pointdriver/integrate/strength.hpp"

#include "models/registry.hpp"

namespace repose::point {
namespace {

constexpr std::array<double, 6> none{};
constexpr double strain_rate_if_none = 1e-4;  // 1/s

/// The six rows of a leg with one strain in place of the stress that drives it.
struct StrainDriven {
  std::array<Constraint, 6> rows{};
  int driver = 0;
  Quantity quantity = Quantity::q;
  double asked = 0.0;  ///< of the quantity
  double sign = 1.0;   ///< of the way to it
};

/// The quantity that a row prescribes alone, if it has a name.
std::optional<Quantity> named(const Constraint& row, Frame frame) {
  const auto is = [&](std::array<double, 6> stress) {
    const double scale = *std::max_element(row.stress.begin(), row.stress.end());
    for (std::size_t i = 0; i < 6; ++i)
      if (std::abs(row.stress[i] - scale * stress[i]) > 1e-12 * scale) return false;
    return scale > 0.0;
  };
  if (is({0, 1, 0, 0, 0, 0})) return Quantity::sigma_a;
  if (is({1, 0, 1, 0, 0, 0}) && frame == Frame::axisymmetric) return Quantity::sigma_r;
  if (is({0, 0, 0, 1, 0, 0})) return Quantity::tau;
  if (is({1, 1, 1, 0, 0, 0})) return Quantity::p;
  return {};
}

double size_of(const std::array<double, 6>& row) {
  double size = 0.0;
  for (const double x : row) size = std::max(size, std::abs(x));
  return size;
}

/// A strain that works on the stress which a row prescribes, at a rate.
Constraint strain_in_place(const std::array<double, 6>& stress, double rate) {
  Constraint row;
  const double size = size_of(stress);
  for (std::size_t i = 0; i < 6; ++i) row.strain[i] = stress[i] / size;
  row.rate = rate;
  return row;
}

/// A leg with a goal: its driver, turned into a strain. start: of the goal's quantity.
std::optional<StrainDriven> of_goal(const LegSpec& leg, double start) {
  StrainDriven driven;
  driven.rows = leg.rows;
  driven.driver = leg.driver;
  driven.quantity = leg.goal->quantity;
  driven.asked = leg.goal->value;
  driven.sign = start <= driven.asked ? 1.0 : -1.0;
  Constraint& row = driven.rows[at(leg.driver)];
  const double rate = row.stress == none ? row.rate : strain_rate_if_none;
  row = strain_in_place(row.stress == none ? row.strain : row.stress, driven.sign * rate);
  return driven;
}

/// A custom leg whose only changes are stresses, in proportion: they keep their proportion, and a
/// strain drives them. read: a quantity at the leg's start.
template <class Read>
std::optional<StrainDriven> of_rates(const LegSpec& leg, Frame frame, Read&& read) {
  StrainDriven driven;
  driven.rows = leg.rows;
  std::vector<int> changing;
  for (int i = 0; i < 6; ++i) {
    const Constraint& row = leg.rows[at(i)];
    if (row.rate == 0.0) continue;
    if (row.strain != none || row.stress == none) return {};
    changing.push_back(i);
  }
  // told by the row that has a name and changes most
  int first = -1;
  for (const int i : changing)
    if (named(leg.rows[at(i)], frame) &&
        (first < 0 || std::abs(leg.rows[at(i)].rate) > std::abs(leg.rows[at(first)].rate)))
      first = i;
  if (first < 0) return {};
  const Constraint lead = leg.rows[at(first)];
  Constraint work;
  for (const int i : changing) {
    const Constraint& row = leg.rows[at(i)];
    for (std::size_t k = 0; k < 6; ++k) work.stress[k] += row.rate / lead.rate * row.stress[k];
    if (i == first) continue;
    Constraint& ratio = driven.rows[at(i)];
    for (std::size_t k = 0; k < 6; ++k)
      ratio.stress[k] = row.stress[k] - row.rate / lead.rate * lead.stress[k];
    ratio.rate = 0.0;
  }
  driven.driver = first;
  driven.quantity = *named(lead, frame);
  driven.sign = lead.rate > 0.0 ? 1.0 : -1.0;
  // σ_r is the mean of two components
  const double weight = driven.quantity == Quantity::sigma_r ? 2.0
                        : driven.quantity == Quantity::p     ? 3.0
                                                             : 1.0;
  driven.asked = read(driven.quantity) + lead.rate * leg.duration / (weight * size_of(lead.stress));
  driven.rows[at(first)] = strain_in_place(work.stress, driven.sign * strain_rate_if_none);
  return driven;
}

}  // namespace

std::optional<Strength> strength_exceeded(const LawInfo& law, std::span<const double> theta,
                                          const PointTest& test, const Curve& curve) {
  if (curve.rows.empty() || !is_failure(curve.outcome.status)) return {};
  const int broken = curve.outcome.leg;
  const LegSpec& leg = test.path.legs[at(broken)].spec();
  std::vector<double> values;
  const auto at_start = [&](Quantity quantity) {
    read_column(law, theta, test, curve, quantity, values);
    double value = values.front();
    for (std::size_t i = 0; i < values.size() && curve.rows[i].leg < broken; ++i) value = values[i];
    return value;
  };
  const bool stress_goal =
      leg.goal &&
      (leg.goal->quantity == Quantity::q || leg.goal->quantity == Quantity::p ||
       leg.goal->quantity == Quantity::sigma_a || leg.goal->quantity == Quantity::sigma_r ||
       leg.goal->quantity == Quantity::tau || leg.goal->quantity == Quantity::eta);
  std::optional<StrainDriven> driven;
  if (stress_goal)
    driven = of_goal(leg, at_start(leg.goal->quantity));
  else if (!leg.goal)
    driven = of_rates(leg, test.path.frame, at_start);
  if (!driven) return {};

  PointTest again = test;
  again.settings = Settings();
  again.settings.energy = false;
  again.path.legs.assign(test.path.legs.begin(), test.path.legs.begin() + broken);
  // rows at strains that grow by 5 % each, from 1e-5 to 5
  const double rate = std::abs(driven->rows[at(driven->driver)].rate);
  double done = 0.0;
  try {
    for (double strain = 1e-5; done < 5.0; strain *= 1.5) {
      LegSpec part;
      part.rows = driven->rows;
      part.duration = (strain - done) / rate;
      part.points = 8;
      part.name = leg.name;
      again.path.legs.emplace_back(std::move(part));
      done = strain;
    }
  } catch (const InputError&) {  // the strain is prescribed already
    return {};
  }
  // a path by strain that ends early while the stress still grows tells nothing: another method
  Curve by_strain;
  const auto told = [&] {
    const Outcome outcome = simulate(law, theta, again, by_strain);
    if (outcome.leg < broken || by_strain.rows.empty()) return false;
    if (!is_failure(outcome.status) || outcome.leg >= broken + 25) return true;
    if (outcome.status != Status::separated && outcome.status != Status::beyond_limit) return false;
    read_column(law, theta, again, by_strain, driven->quantity, values);
    double most = -std::numeric_limits<double>::infinity();
    for (const double x : values) most = std::max(most, driven->sign * x);
    return driven->sign * values.back() < most - 1e-3 * std::abs(most);
  };
  bool good = false;
  for (const Method method : {Method::automatic, Method::cvode, Method::implicit}) {
    again.settings.method = method;
    good = told();
    if (good) break;
  }
  if (!good) return {};

  Strength found{driven->quantity, driven->asked, 0.0, 0.0, rate};
  double most = -std::numeric_limits<double>::infinity();
  const auto search = [&](const PointTest& of, const Curve& in) {
    std::vector<double> q;
    read_column(law, theta, of, in, driven->quantity, values);
    read_column(law, theta, of, in, Quantity::q, q);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (in.rows[i].leg < broken || !(driven->sign * values[i] > most)) continue;
      most = driven->sign * values[i];
      found.carried = values[i];
      found.q = q[i];
    }
  };
  search(again, by_strain);
  search(test, curve);
  const double size = std::max(std::abs(found.asked), std::abs(found.carried));
  if (!(driven->sign * found.asked > most + 1e-6 * size)) return {};
  return found;
}

}  // namespace repose::point
