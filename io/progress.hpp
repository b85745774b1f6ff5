#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace repose::io {

/// Says on standard error, whatever else is quiet, that a file is not as it was written and what is
/// done about it: "warning: FILE: damage, so it is run again".
void warn_of_damage(const std::string& file, const std::string& damage, const char* consequence);

/// Tells how far a run is: one line that is redrawn on a terminal, JSON lines, or nothing.
class Progress {
 public:
  enum class Mode { none, terminal, json };

  /// terminal if the standard error output is one, unless something else is asked for.
  static Mode mode(bool quiet, bool json);

  Progress(Mode mode, std::string name, double end_time)
      : mode_(mode),
        name_(std::move(name)),
        end_time_(end_time) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Call as often as wanted; draws several times a second (JSON: once a second) and `at_once`.
  void update(double time, std::int64_t steps, std::int64_t point_steps, bool at_once = false);
  /// Takes the line off the terminal, so that something else can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(double time, std::int64_t steps, double seconds_left);

  Mode mode_;
  std::string name_;
  double end_time_;
  bool begun_ = false, shown_ = false;
  Clock::time_point last_{};
  double last_time_ = 0.0;
  std::int64_t last_point_steps_ = 0;
  double speed_ = 0.0;  ///< point-steps per second, smoothed
  double pace_ = 0.0;   ///< simulated seconds per second, smoothed
};

/// "42 s", "3 min 05 s", "2 h 10 min".
std::string duration_text(double seconds);

}  // namespace repose::io
