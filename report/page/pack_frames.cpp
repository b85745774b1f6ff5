#include "report/page/pack_frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "io/base64.hpp"
#include "io/json.hpp"
#include "io/thin_evenly.hpp"

namespace repose::report {
namespace {

using Json = io::Json;

constexpr double outer = 0.005;  ///< share of values beyond each end of the colours

struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  void include(double x) {
    if (!std::isfinite(x)) return;
    lower = std::min(lower, x);
    upper = std::max(upper, x);
  }
  bool empty() const { return !(lower < upper); }
};

/// The chosen points of all frames, one after another.
struct Gathered {
  std::vector<double> times;
  std::vector<std::size_t> counts;
  std::vector<float> x, y;
  std::map<std::string, std::vector<float>> fields;
  std::size_t most_points = 0;
  bool depth = false;
};

float magnitude(std::span<const double> v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return static_cast<float>(v.size() == 1 ? v.front() : std::sqrt(sum));
}

void gather(Gathered& all, const io::Frame& frame, double plan_height, std::size_t most) {
  const std::vector<std::size_t> chosen = io::thin_evenly(frame.points, most);
  const std::size_t before = all.x.size();
  all.times.push_back(frame.time_s);
  all.counts.push_back(chosen.size());
  all.most_points = std::max(all.most_points, frame.points);
  for (const std::size_t i : chosen) {
    all.x.push_back(static_cast<float>(frame.position_m[3 * i]));
    const double y = frame.position_m[3 * i + 1], z = frame.position_m[3 * i + 2];
    const bool above = plan_height > 0.0;
    all.y.push_back(static_cast<float>(above ? plan_height - z : y));
    all.depth = all.depth || (!above && z != frame.position_m[2]);
  }
  for (const io::Frame::Field& field : frame.fields) {
    const std::size_t n = field.components;
    if (n > 3) continue;
    // a field that earlier frames did not have is no number there
    std::vector<float>& values = all.fields[field.name];
    values.resize(before, std::numeric_limits<float>::quiet_NaN());
    for (const std::size_t i : chosen)
      values.push_back(magnitude(std::span(field.values).subspan(n * i, n)));
  }
  for (auto& [name, values] : all.fields)
    values.resize(all.x.size(), std::numeric_limits<float>::quiet_NaN());
}

/// lower to upper on 0 to `top`, what lies beyond on the ends; not-a-number on top + 1.
std::uint32_t code_of(double x, const Range& range, std::uint32_t top) {
  if (!std::isfinite(x)) return top + 1;
  const double share = (x - range.lower) / (range.upper - range.lower);
  return static_cast<std::uint32_t>(std::lround(std::clamp(share, 0.0, 1.0) * top));
}

Range range_of(std::span<const float> values) {
  Range range;
  for (const float x : values) range.include(x);
  return range;
}

/// Where the colours begin and end: percentiles, but all of a few whole numbers, and from zero
/// where zero is near.
Range colours_of(std::span<const float> values, const Range& extremes) {
  std::vector<float> sorted;
  for (const float x : values)
    if (std::isfinite(x)) sorted.push_back(x);
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  const bool whole =
      std::all_of(sorted.begin(), sorted.end(), [](float x) { return x == std::round(x); });
  Range range{at(outer), at(1.0 - outer)};
  if ((whole && extremes.upper - extremes.lower < 255.0) || range.empty()) range = extremes;
  if (extremes.lower >= 0.0 && range.lower < 0.25 * range.upper) range.lower = 0.0;
  return range;
}

}  // namespace

Json pack_frames(std::size_t count, const std::function<io::Frame(std::size_t)>& next,
                 const PackLimits& limits, double plan_height) {
  const std::vector<std::size_t> chosen = io::thin_evenly(count, limits.frames);
  const std::size_t most =
      std::min(limits.points, limits.points_in_all / std::max<std::size_t>(chosen.size(), 1));
  Gathered all;
  for (const std::size_t i : chosen) gather(all, next(i), plan_height, most);

  std::size_t lost = 0;
  const auto span_of = [](const Range& r) { return r.empty() ? Range{r.lower, r.lower + 1.0} : r; };
  Range x = range_of(all.x), y = range_of(all.y);
  if (!std::isfinite(x.lower)) x.lower = 0.0;  // not one finite place
  if (!std::isfinite(y.lower)) y.lower = 0.0;
  x = span_of(x);
  y = span_of(y);
  std::vector<std::uint8_t> places;
  places.reserve(4 * all.x.size());
  for (std::size_t i = 0; i < all.x.size(); ++i)
    for (const std::uint32_t code : {code_of(all.x[i], x, 65534), code_of(all.y[i], y, 65534)}) {
      lost += code == 65535;
      places.push_back(static_cast<std::uint8_t>(code & 255));
      places.push_back(static_cast<std::uint8_t>(code >> 8));
    }

  Json fields = Json::array();
  for (const auto& [name, values] : all.fields) {
    const auto strange =
        std::count_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
    lost += static_cast<std::size_t>(strange);
    const Range extremes = range_of(values);
    if (extremes.empty()) continue;
    const Range colours = colours_of(values, extremes);
    std::vector<std::uint8_t> codes;
    codes.reserve(values.size());
    for (const float v : values)
      codes.push_back(static_cast<std::uint8_t>(code_of(v, colours, 254)));
    fields.push_back({{"name", name},
                      {"lower", colours.lower},
                      {"upper", colours.upper},
                      {"least", extremes.lower},
                      {"largest", extremes.upper},
                      {"codes", io::base64(codes)}});
  }
  return {{"times", all.times},
          {"counts", all.counts},
          {"x", {x.lower, x.upper}},
          {"y", {y.lower, y.upper}},
          {"xy", io::base64(places)},
          {"fields", std::move(fields)},
          {"lost", lost},
          {"depth", all.depth},
          {"all_frames", count},
          {"most_points", all.most_points}};
}

}  // namespace repose::report
