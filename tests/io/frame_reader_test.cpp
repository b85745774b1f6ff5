// Frames come back as they were written, and what is no frame is refused with its reason.
#include "io/frame_reader.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "io/frame_writer.hpp"
#include "io/seal.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::io {
namespace {

namespace fs = std::filesystem;

class FrameReaderTest : public ::testing::Test {
 protected:
  fs::path written(double time) const {
    FrameView view;
    view.time_s = time;
    view.x_m = x_;
    view.y_m = y_;
    view.scalars = {{"pressure_Pa", p_}};
    view.vectors = {{"velocity_m_per_s", x_, p_}};
    view.tensors = {{"stress_Pa", x_, y_, p_, x_}};
    view.integers = {{"body", body_}};
    return FrameWriter(folder_, "sand").write(view);
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
  std::vector<double> x_{0.1, 0.2, 0.3}, y_{1.1, 1.2, 1.3}, p_{-7.0, 1e5, 1.0 / 3.0};
  std::vector<std::int32_t> body_{0, 1, 1};
};

const Frame::Field& field(const Frame& frame, const std::string& name) {
  for (const Frame::Field& f : frame.fields)
    if (f.name == name) return f;
  throw std::runtime_error("no field " + name);
}

TEST_F(FrameReaderTest, EveryValueComesBackToTheBit) {
  const Frame frame = read_frame(written(0.25));
  EXPECT_EQ(frame.time_s, 0.25);
  EXPECT_EQ(frame.points, 3u);
  EXPECT_EQ(frame.position_m, (std::vector<double>{0.1, 1.1, 0, 0.2, 1.2, 0, 0.3, 1.3, 0}));
  EXPECT_EQ(frame.fields.size(), 4u);
  EXPECT_EQ(field(frame, "pressure_Pa").values, p_);
  EXPECT_EQ(field(frame, "velocity_m_per_s").components, 3u);
  EXPECT_EQ(field(frame, "velocity_m_per_s").values,
            (std::vector<double>{0.1, p_[0], 0, 0.2, p_[1], 0, 0.3, p_[2], 0}));
  EXPECT_EQ(field(frame, "stress_Pa").components, 6u);
  EXPECT_EQ(field(frame, "body").values, (std::vector<double>{0, 1, 1}));
}

TEST_F(FrameReaderTest, TheSeriesNamesItsFrames) {
  written(0.0);
  const std::vector<FrameEntry> frames = read_frame_series(folder_ / "sand.hdf.series");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].file_name, "sand_00000.hdf");
  EXPECT_EQ(frames[0].time_s, 0.0);
}

TEST_F(FrameReaderTest, TheSeriesOfPointsIsToldFromThatOfTheGrid) {
  EXPECT_EQ(point_series_in(folder_), fs::path());
  EXPECT_EQ(point_series_in(folder_ / "none"), fs::path());
  // of a scene that is itself called after a grid
  const std::string name = "sand_grid";
  std::ofstream(folder_ / (grid_series_name(name) + ".hdf.series")) << "{}";
  std::ofstream(folder_ / (name + ".hdf.series")) << "{}";
  EXPECT_EQ(point_series_in(folder_), folder_ / "sand_grid.hdf.series");
}

std::string reason(const std::function<void()>& read) {
  try {
    read();
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(FrameReaderTest, WhatIsNoFrameIsRefused) {
  const fs::path frame = written(0.0), text = folder_ / "text.hdf";
  std::ofstream(text) << "no HDF5 at all";
  EXPECT_EQ(
      reason([&] { read_frame(text); }),
      text.string() + ": is cut short, or of another version of repose: its checksum is missing");
  std::ofstream(text) << "no HDF5 at all" << seal_of("no HDF5 at all");
  EXPECT_EQ(reason([&] { read_frame(text); }).find(text.string() + ": not a frame: HDF5 could not"),
            0u);
  EXPECT_NE(reason([&] { read_frame(folder_ / "none.hdf"); }).find("No such file"),
            std::string::npos);
  // a copy that was cut short
  fs::resize_file(frame, fs::file_size(frame) / 2);
  EXPECT_NE(reason([&] { read_frame(frame); }).find("is cut short"), std::string::npos);
}

TEST_F(FrameReaderTest, ASeriesStaysInItsFolder) {
  const fs::path series = folder_ / "a.hdf.series";
  std::ofstream(series) << R"({"files": [{"name": "../elsewhere.hdf", "time": 0}]})";
  EXPECT_NE(reason([&] { read_frame_series(series); }).find("../elsewhere.hdf"), std::string::npos);
  std::ofstream(series) << "{}";
  EXPECT_NE(reason([&] { read_frame_series(series); }).find("not a series of frames"),
            std::string::npos);
}

}  // namespace
}  // namespace repose::io
