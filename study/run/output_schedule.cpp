#include "study/run/output_schedule.hpp"

#include <algorithm>
#include <cmath>

namespace repose::study {
namespace {

/// Marks closer than this share of an interval are the same: k·interval is off by at most k/2 ulp,
/// 1e-9 for a million marks.
constexpr double same = 1e-8;

/// The first mark after t of a series that grows with k.
template <class Mark>
double first_after(double t, double interval, Mark&& mark) {
  double k = std::max(0.0, std::floor(t / interval) - 1.0);
  while (mark(k) <= t) k += 1.0;
  return mark(k);
}

}  // namespace

double OutputSchedule::row_mark(double k) const {
  const double t = k * series_;
  return std::abs(t - end_) <= same * series_ ? end_ : t;
}

double OutputSchedule::frame_mark(double k) const {
  const double t = k * frames_;
  if (std::abs(t - end_) <= same * frames_) return end_;
  if (series_ <= 0.0) return t;
  const double nearest = row_mark(std::round(t / series_));
  return std::abs(t - nearest) <= same * series_ ? nearest : t;
}

double OutputSchedule::next(double t) const {
  double mark = end_;
  if (series_ > 0.0)
    mark = std::min(mark, first_after(t, series_, [&](double k) { return row_mark(k); }));
  if (frames_ > 0.0)
    mark = std::min(mark, first_after(t, frames_, [&](double k) { return frame_mark(k); }));
  return mark;
}

bool OutputSchedule::row_due(double t) const {
  return t == 0.0 || t == end_ || (series_ > 0.0 && row_mark(std::round(t / series_)) == t);
}

bool OutputSchedule::frame_due(double t) const {
  if (frames_ <= 0.0) return false;
  return t == 0.0 || t == end_ || frame_mark(std::round(t / frames_)) == t;
}

}  // namespace repose::study
