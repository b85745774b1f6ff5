#pragma once

namespace repose::study {

/// The times of a run at which something is written: rows every series_interval, frames every
/// frame_interval, both at 0 and at end_time. All of it depends on the time alone, so a resumed run
/// stops where one never stopped would have. Marks that differ by round-off only (3 × 0.05 and
/// 30 × 0.005) are one. An interval of 0: none but the first and the last.
class OutputSchedule {
 public:
  OutputSchedule(double end_time, double series_interval, double frame_interval)
      : end_(end_time),
        series_(series_interval),
        frames_(frame_interval) {}

  double end_time() const { return end_; }
  /// The first mark after t, at most end_time.
  double next(double t) const;
  /// Whether t, 0 or a value that next() gave, is a mark of a row or of a frame.
  bool row_due(double t) const;
  bool frame_due(double t) const;

 private:
  double row_mark(double k) const;
  double frame_mark(double k) const;
  double end_, series_, frames_;
};

}  // namespace repose::study
