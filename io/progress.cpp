#include "io/progress.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/core.h>
#include <unistd.h>

#include "io/json.hpp"

namespace repose::io {

void warn_of_damage(const std::string& file, const std::string& damage, const char* consequence) {
  fmt::print(stderr, "warning: {}: {}, {}\n", file, damage, consequence);
}

Progress::Mode Progress::mode(bool quiet, bool json) {
  if (json) return Mode::json;
  return !quiet && ::isatty(STDERR_FILENO) == 1 ? Mode::terminal : Mode::none;
}

void Progress::update(double time, std::int64_t steps, std::int64_t point_steps, bool at_once) {
  if (mode_ == Mode::none) return;
  const Clock::time_point now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - last_).count();
  const double every = mode_ == Mode::json ? 1.0 : 0.2;
  if (begun_ && !at_once && elapsed < every) return;
  if (begun_ && elapsed > 0.0) {
    // The newest interval counts by its length: about the last three seconds show.
    const double weight = speed_ == 0.0 ? 1.0 : 1.0 - std::exp(-elapsed / 3.0);
    speed_ += weight * (static_cast<double>(point_steps - last_point_steps_) / elapsed - speed_);
    pace_ += weight * ((time - last_time_) / elapsed - pace_);
  }
  begun_ = true;
  last_ = now;
  last_time_ = time;
  last_point_steps_ = point_steps;
  draw(time, steps, pace_ > 0.0 ? (end_time_ - time) / pace_ : -1.0);
}

void Progress::draw(double time, std::int64_t steps, double seconds_left) {
  const double share = end_time_ > 0.0 ? time / end_time_ : 1.0;
  if (mode_ == Mode::json) {
    Json line{
        {"event", "progress"},     {"name", name_}, {"percent", 100.0 * share},   {"time_s", time},
        {"end_time_s", end_time_}, {"step", steps}, {"point_steps_per_s", speed_}};
    line["seconds_left"] = seconds_left < 0.0 ? Json() : Json(seconds_left);
    fmt::print("{}\n", line.dump());
    std::fflush(stdout);
    return;
  }
  fmt::print(stderr, "\r\033[K{}  {:.0f} %  t = {:.3f} of {:g} s{}{}", name_, 100.0 * share, time,
             end_time_, speed_ > 0.0 ? fmt::format("  {:.1f} Mpoint-steps/s", speed_ / 1e6) : "",
             seconds_left < 0.0 ? "" : "  " + duration_text(seconds_left) + " left");
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

std::string duration_text(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long long>(std::lround(std::min(seconds, 1e15)));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  if (whole < 48 * 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  return fmt::format("{:.1f} days", static_cast<double>(whole) / 86400.0);
}

}  // namespace repose::io
