#include "study/run/output_schedule.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace repose::study {
namespace {

std::vector<double> marks(const OutputSchedule& schedule) {
  std::vector<double> times{0.0};
  while (times.back() < schedule.end_time()) times.push_back(schedule.next(times.back()));
  return times;
}

TEST(OutputSchedule, marks_that_differ_by_round_off_are_one) {
  // 3 × 0.05 = 0.15000000000000002 and 30 × 0.005 = 0.15: one stop, which is row and frame.
  const OutputSchedule schedule(1.2, 0.005, 0.05);
  const std::vector<double> times = marks(schedule);
  ASSERT_EQ(times.size(), 241U);
  int frames = 0;
  for (const double t : times) {
    EXPECT_TRUE(schedule.row_due(t)) << t;
    frames += schedule.frame_due(t) ? 1 : 0;
  }
  EXPECT_EQ(frames, 25);
  EXPECT_EQ(times.back(), 1.2);
  // rows are at least 0.005 s apart but for round-off in k·0.005 <= 1.2: 1 ulp of 1.2, 2.3e-16
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_NEAR(times[i] - times[i - 1], 0.005, 5e-16);
}

TEST(OutputSchedule, the_end_is_a_mark_of_both) {
  const OutputSchedule schedule(1.0, 0.3, 0.7);
  const std::vector<double> expected{0.0, 0.3, 0.6, 0.7, 3 * 0.3, 1.0};
  EXPECT_EQ(marks(schedule), expected);
  EXPECT_TRUE(schedule.row_due(1.0));
  EXPECT_TRUE(schedule.frame_due(1.0));
  EXPECT_FALSE(schedule.row_due(0.7));
  EXPECT_FALSE(schedule.frame_due(0.3));
}

TEST(OutputSchedule, no_interval_leaves_the_first_and_the_last) {
  const OutputSchedule schedule(1.0, 0.0, 0.0);
  EXPECT_EQ(marks(schedule), (std::vector<double>{0.0, 1.0}));
  EXPECT_TRUE(schedule.row_due(0.0));
  EXPECT_FALSE(schedule.row_due(0.5));
  EXPECT_FALSE(schedule.frame_due(0.0));
}

TEST(OutputSchedule, frames_without_rows) {
  const OutputSchedule schedule(0.1, 0.0, 0.05);
  EXPECT_EQ(marks(schedule), (std::vector<double>{0.0, 0.05, 0.1}));
  EXPECT_FALSE(schedule.row_due(0.05));
  EXPECT_TRUE(schedule.frame_due(0.05));
}

TEST(OutputSchedule, depends_on_the_time_alone) {
  const OutputSchedule schedule(2.0, 0.01, 0.035);
  // from anywhere between two marks the next one is the same
  const std::vector<double> times = marks(schedule);
  for (std::size_t i = 1; i < times.size(); ++i)
    for (const double share : {0.0, 0.3, 0.999})
      EXPECT_EQ(schedule.next(times[i - 1] + share * (times[i] - times[i - 1])), times[i]);
}

}  // namespace
}  // namespace repose::study
