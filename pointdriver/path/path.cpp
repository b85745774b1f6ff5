#include "pointdriver/path/path.hpp"

#include "models/parameter.hpp"

namespace repose::point {
namespace {

void require_positive(double x, const char* key, const char* what) {
  if (!(x > 0.0) || !std::isfinite(x))
    throw InputError(key, std::string(key) + " must be > 0 " + what);
}

Control prepared(const LegSpec& spec, double sign) {
  std::array<Constraint, 6> rows = spec.rows;
  if (spec.driver >= 0) rows[static_cast<std::size_t>(spec.driver)].rate *= sign;
  return Control(rows);
}

}  // namespace

Leg::Leg(LegSpec spec) : spec_(std::move(spec)) {
  if (spec_.points < 1) throw InputError("points", "points must be >= 1 row");
  if (spec_.goal) {
    if (!std::isfinite(spec_.goal->value))
      throw InputError(std::string(column_name(spec_.goal->quantity)),
                       "the value a leg is to reach must be finite");
    if (spec_.driver < 0) throw InputError("stages", "a leg with a goal needs a driven component");
    require_positive(spec_.rows[static_cast<std::size_t>(spec_.driver)].rate, "rate", "1/s (Pa/s)");
    require_positive(spec_.goal_rate, "rate", "1/s (Pa/s)");
    if (spec_.goal_is_event) require_positive(spec_.strain_limit, "strain_limit", "[-]");
  } else {
    require_positive(spec_.duration, "duration", "s");
  }
  const double rising = spec_.goal_falls ? -1.0 : 1.0;  // the driver's sign towards a larger goal
  control_[0] = prepared(spec_, rising);
  control_[1] = prepared(spec_, -rising);
}

std::vector<Path::Place> Path::places() const {
  std::vector<Place> places;
  int half_cycles = 0;  // of this stage; a cycle is two legs, up and down
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const bool goes_on = legs[i].spec().continues && i > 0;
    const bool cyclic = goes_on || (i + 1 < legs.size() && legs[i + 1].spec().continues);
    half_cycles = goes_on ? half_cycles + 1 : 0;
    const int stage = (places.empty() ? 0 : places.back().stage) + (goes_on ? 0 : 1);
    places.push_back({stage, cyclic ? half_cycles / 2 + 1 : 0});
  }
  return places;
}

std::size_t Path::row_count() const {
  std::size_t n = 2;  // the start and, should it fail, where
  for (const Leg& leg : legs) n += static_cast<std::size_t>(leg.spec().points);
  return n;
}

}  // namespace repose::point
