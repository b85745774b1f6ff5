#include "io/frame_writer.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <sstream>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include "io/frame_reader.hpp"
#include "io/json.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::io {
namespace {

namespace fs = std::filesystem;

class FrameWriterTest : public ::testing::Test {
 protected:
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

/// What an independent reader finds under a name: its shape and its values as doubles (exact for
/// every type that a frame holds).
struct Dataset {
  std::vector<hsize_t> shape;
  std::vector<double> values;
  H5T_class_t kind = H5T_NO_CLASS;
  std::size_t bytes = 0;
};

Dataset read(const fs::path& path, const std::string& name) {
  Dataset out;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(set);
  out.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, out.shape.data(), nullptr);
  out.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.values.data());
  const hid_t type = H5Dget_type(set);
  out.kind = H5Tget_class(type);
  out.bytes = H5Tget_size(type);
  H5Tclose(type);
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
  return out;
}

/// Seven points with a value of every kind; the numbers differ everywhere, so that a swapped
/// component or order shows.
struct Sample {
  std::vector<double> x, y, p, xx, yy, zz, xy, vx, vy;
  std::vector<std::int32_t> body;

  Sample() {
    for (int i = 0; i < 7; ++i) {
      const double a = 0.1 * i;
      x.push_back(a);
      y.push_back(1 + a);
      p.push_back(2 + a);
      xx.push_back(3 + a);
      yy.push_back(4 + a);
      zz.push_back(5 + a);
      xy.push_back(6 + a);
      vx.push_back(7 + a);
      vy.push_back(8 + a);
      body.push_back(i % 2 == 0 ? i : -i);
    }
  }
  FrameView view(double time_s) const {
    FrameView frame;
    frame.time_s = time_s;
    frame.x_m = x;
    frame.y_m = y;
    frame.scalars = {{"p_Pa", p}};
    frame.vectors = {{"velocity_m_per_s", vx, vy}};
    frame.tensors = {{"stress_Pa", xx, yy, zz, xy}};
    frame.integers = {{"body", body}};
    return frame;
  }
};

TEST_F(FrameWriterTest, EveryValueComesBackInTheLayoutThatParaViewReads) {
  Sample sample;
  sample.p[3] = std::numeric_limits<double>::quiet_NaN();  // a bad value must stay visible
  FrameWriter writer(folder_ / "frames", "heap");
  const fs::path path = writer.write(sample.view(0.25));
  EXPECT_EQ(path, folder_ / "frames" / "heap_00000.hdf");

  const std::vector<hsize_t> one{1}, seven{7}, eight{8};
  for (const char* count : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"}) {
    const Dataset set = read(path, std::string("/VTKHDF/") + count);
    EXPECT_EQ(set.shape, one) << count;
    EXPECT_EQ(set.values, std::vector<double>{7}) << count;
  }
  const Dataset points = read(path, "/VTKHDF/Points");
  EXPECT_EQ(points.shape, (std::vector<hsize_t>{7, 3}));
  const Dataset connectivity = read(path, "/VTKHDF/Connectivity");
  const Dataset offsets = read(path, "/VTKHDF/Offsets");
  const Dataset types = read(path, "/VTKHDF/Types");
  EXPECT_EQ(connectivity.shape, seven);
  EXPECT_EQ(offsets.shape, eight);
  EXPECT_EQ(types.shape, seven);
  EXPECT_EQ(types.bytes, 1u);
  EXPECT_EQ(types.kind, H5T_INTEGER);

  const Dataset pressure = read(path, "/VTKHDF/PointData/p_Pa");
  const Dataset velocity = read(path, "/VTKHDF/PointData/velocity_m_per_s");
  const Dataset stress = read(path, "/VTKHDF/PointData/stress_Pa");
  const Dataset body = read(path, "/VTKHDF/PointData/body");
  EXPECT_EQ(velocity.shape, (std::vector<hsize_t>{7, 3}));
  EXPECT_EQ(stress.shape, (std::vector<hsize_t>{7, 6}));
  EXPECT_EQ(body.kind, H5T_INTEGER);
  // Stored without conversion, so equality is exact.
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(points.values[3 * i], sample.x[i]);
    EXPECT_EQ(points.values[3 * i + 1], sample.y[i]);
    EXPECT_EQ(points.values[3 * i + 2], 0.0);
    EXPECT_EQ(connectivity.values[i], static_cast<double>(i));
    EXPECT_EQ(offsets.values[i + 1], static_cast<double>(i + 1));
    EXPECT_EQ(types.values[i], 1.0);  // VTK_VERTEX
    if (i == 3) {
      EXPECT_TRUE(std::isnan(pressure.values[i]));
    } else {
      EXPECT_EQ(pressure.values[i], sample.p[i]);
    }
    EXPECT_EQ(velocity.values[3 * i], sample.vx[i]);
    EXPECT_EQ(velocity.values[3 * i + 1], sample.vy[i]);
    EXPECT_EQ(velocity.values[3 * i + 2], 0.0);
    const std::vector<double> row(stress.values.begin() + static_cast<std::ptrdiff_t>(6 * i),
                                  stress.values.begin() + static_cast<std::ptrdiff_t>(6 * i + 6));
    EXPECT_EQ(row, (std::vector<double>{sample.xx[i], sample.yy[i], sample.zz[i], sample.xy[i], 0.0,
                                        0.0}));
    EXPECT_EQ(body.values[i], sample.body[i]);
  }
  EXPECT_EQ(read(path, "/VTKHDF/FieldData/TimeValue").values, std::vector<double>{0.25});
}

TEST_F(FrameWriterTest, AttributesAreThoseOfVersionOne) {
  const Sample sample;
  FrameWriter writer(folder_, "heap");
  const fs::path path = writer.write(sample.view(0.0));

  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t version = H5Aopen_by_name(file, "/VTKHDF", "Version", H5P_DEFAULT, H5P_DEFAULT);
  std::array<std::int64_t, 2> numbers{};
  EXPECT_GE(H5Aread(version, H5T_NATIVE_INT64, numbers.data()), 0);
  EXPECT_EQ(numbers, (std::array<std::int64_t, 2>{1, 0}));

  const hid_t type = H5Aopen_by_name(file, "/VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
  const hid_t kind = H5Aget_type(type);
  EXPECT_EQ(H5Tget_class(kind), H5T_STRING);
  EXPECT_EQ(H5Tget_cset(kind), H5T_CSET_ASCII);
  EXPECT_EQ(H5Tis_variable_str(kind), 0);
  std::string text(H5Tget_size(kind), '\0');
  EXPECT_GE(H5Aread(type, kind, text.data()), 0);
  EXPECT_EQ(text, "UnstructuredGrid");
  H5Tclose(kind);
  H5Aclose(type);
  H5Aclose(version);
  H5Fclose(file);
}

/// An attribute's numbers.
std::vector<double> attribute(const fs::path& path, const char* name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Aopen_by_name(file, "/VTKHDF", name, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Aget_space(set);
  std::vector<double> numbers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Aread(set, H5T_NATIVE_DOUBLE, numbers.data());
  H5Sclose(space);
  H5Aclose(set);
  H5Fclose(file);
  return numbers;
}

std::string type_in(const fs::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t type = H5Aopen_by_name(file, "/VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
  const hid_t kind = H5Aget_type(type);
  std::string text(H5Tget_size(kind), '\0');
  H5Aread(type, kind, text.data());
  H5Tclose(kind);
  H5Aclose(type);
  H5Fclose(file);
  return text;
}

/// 4 by 3 by 2 nodes, or a plane of 4 by 3, with numbers that tell their node.
struct SampleGrid {
  std::array<std::size_t, 3> nodes;
  std::vector<double> mass, vx, vy, vz;

  explicit SampleGrid(std::size_t layers) : nodes{4, 3, layers} {
    for (std::size_t n = 0; n < 12 * layers; ++n) {
      mass.push_back(0.1 * static_cast<double>(n));
      vx.push_back(100.0 + mass.back());
      vy.push_back(200.0 + mass.back());
      if (layers > 1) vz.push_back(300.0 + mass.back());
    }
  }
  GridView view(double time_s) const {
    return {time_s, 0.25, nodes, {{"mass_kg", mass}}, {{"velocity_m_per_s", vx, vy, vz}}};
  }
};

TEST_F(FrameWriterTest, AGridIsAnImageInTheLayoutThatParaViewReads) {
  for (const std::size_t layers : {1, 2}) {
    const SampleGrid sample(layers);
    FrameWriter writer(folder_ / std::to_string(layers), "heap_grid");
    const fs::path path = writer.write(sample.view(0.75));
    EXPECT_EQ(path.filename(), "heap_grid_00000.hdf");
    EXPECT_EQ(type_in(path), "ImageData");
    EXPECT_EQ(attribute(path, "Version"), (std::vector<double>{1, 0}));
    EXPECT_EQ(attribute(path, "WholeExtent"),
              (layers == 1 ? std::vector<double>{0, 0, 0, 3, 0, 2}
                           : std::vector<double>{0, 3, 0, 2, 0, 1}));
    EXPECT_EQ(attribute(path, "Origin"), (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(attribute(path, "Spacing"), (std::vector<double>{0.25, 0.25, 0.25}));
    // in the plane the image's axes are z, x and y: x = j, y = k, z = i
    EXPECT_EQ(attribute(path, "Direction"),
              (layers == 1 ? std::vector<double>{0, 1, 0, 0, 0, 1, 1, 0, 0}
                           : std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    const Dataset mass = read(path, "/VTKHDF/PointData/mass_kg");
    const Dataset velocity = read(path, "/VTKHDF/PointData/velocity_m_per_s");
    std::vector<hsize_t> shape{3, 4, 1};
    if (layers > 1) shape = {layers, 3, 4};
    EXPECT_EQ(mass.shape, shape);
    shape.push_back(3);
    EXPECT_EQ(velocity.shape, shape);
    EXPECT_EQ(mass.values, sample.mass);
    for (std::size_t n = 0; n < sample.mass.size(); ++n) {
      EXPECT_EQ(velocity.values[3 * n], sample.vx[n]);
      EXPECT_EQ(velocity.values[3 * n + 1], sample.vy[n]);
      EXPECT_EQ(velocity.values[3 * n + 2], layers > 1 ? sample.vz[n] : 0.0);
    }
    // it has no points, and says so to what reads points
    EXPECT_THROW(read_frame(path), IoError);
  }
}

TEST_F(FrameWriterTest, RefusesGridsThatDoNotFit) {
  const SampleGrid sample(2);
  FrameWriter writer(folder_, "heap_grid");
  const auto refused = [&](const GridView& grid) -> std::string {
    try {
      writer.write(grid);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  GridView grid = sample.view(0.0);
  grid.nodes[2] = 3;
  EXPECT_EQ(refused(grid), "frame: mass_kg has 24 values for 36 nodes");
  grid.nodes[2] = 0;
  EXPECT_EQ(refused(grid), "frame: its grid has no nodes");
  grid = sample.view(0.0);
  grid.h_m = 0.0;
  EXPECT_NE(refused(grid), "");
  grid = sample.view(0.0);
  grid.vectors[0].name = "mass_kg";
  EXPECT_EQ(refused(grid), "frame: two fields are called 'mass_kg'");
  EXPECT_NE(refused(sample.view(std::nan(""))), "");
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(FrameWriterTest, SeriesFollowsEveryFrame) {
  const Sample sample;
  FrameWriter writer(folder_, "heap");
  for (std::size_t k = 0; k < 3; ++k) {
    writer.write(sample.view(0.1 * static_cast<double>(k)));
    const auto series = io::Json::parse(content_of(folder_ / "heap.hdf.series"));
    EXPECT_EQ(series.at("file-series-version"), "1.0");
    ASSERT_EQ(series.at("files").size(), k + 1);
    EXPECT_EQ(series["files"][k]["name"], "heap_0000" + std::to_string(k) + ".hdf");
    EXPECT_EQ(series["files"][k]["time"], 0.1 * static_cast<double>(k));  // round-trips exactly
  }
  EXPECT_EQ(writer.count(), 3u);
}

TEST_F(FrameWriterTest, SameFrameSameBytes) {
  const Sample sample;
  FrameWriter(folder_ / "a", "heap").write(sample.view(0.5));
  ::usleep(1'100'000);  // longer than the resolution (1 s) of the times that HDF5 would store
  FrameWriter(folder_ / "b", "heap").write(sample.view(0.5));
  const std::string bytes = content_of(folder_ / "a" / "heap_00000.hdf");
  EXPECT_FALSE(bytes.empty());
  EXPECT_EQ(bytes, content_of(folder_ / "b" / "heap_00000.hdf"));
}

TEST_F(FrameWriterTest, ContinuesAfterARestart) {
  const Sample sample;
  {
    FrameWriter writer(folder_, "heap");
    for (const double time : {0.0, 0.1, 0.2, 0.3}) writer.write(sample.view(time));
  }
  FrameWriter writer = FrameWriter::continued(folder_, "heap", 0.15);
  EXPECT_EQ(writer.count(), 2u);
  EXPECT_TRUE(fs::exists(folder_ / "heap_00001.hdf"));
  EXPECT_FALSE(fs::exists(folder_ / "heap_00002.hdf"));
  EXPECT_FALSE(fs::exists(folder_ / "heap_00003.hdf"));
  EXPECT_EQ(writer.write(sample.view(0.25)).filename(), "heap_00002.hdf");
  const auto series = io::Json::parse(content_of(writer.series_path()));
  ASSERT_EQ(series["files"].size(), 3u);
  EXPECT_EQ(series["files"][2]["time"], 0.25);

  EXPECT_EQ(FrameWriter::continued(folder_ / "empty", "heap", 1.0).count(), 0u);
}

TEST_F(FrameWriterTest, BrokenSeriesIsAnError) {
  std::ofstream(folder_ / "heap.hdf.series") << "{\"files\": [{\"name\": \"other.hdf\", ";
  try {
    FrameWriter::continued(folder_, "heap", 1.0);
    FAIL() << "no exception";
  } catch (const IoError& error) {
    EXPECT_EQ(error.path(), folder_ / "heap.hdf.series");
    EXPECT_NE(std::string(error.what()).find("not a series of frames"), std::string::npos);
  }
}

TEST_F(FrameWriterTest, RefusesViewsThatDoNotFit) {
  const Sample sample;
  FrameWriter writer(folder_, "heap");
  const auto refused = [&](const FrameView& frame) -> std::string {
    try {
      writer.write(frame);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  FrameView frame = sample.view(0.0);
  frame.tensors[0].zz = frame.tensors[0].zz.first(6);
  EXPECT_EQ(refused(frame), "frame: stress_Pa has 6 values for 7 points");
  frame = sample.view(0.0);
  frame.scalars.push_back({"body", sample.p});
  EXPECT_EQ(refused(frame), "frame: two fields are called 'body'");
  frame = sample.view(0.0);
  frame.scalars[0].name = "a/b";
  EXPECT_EQ(refused(frame), "frame: 'a/b' cannot be the name of a field");
  EXPECT_EQ(refused(FrameView{}), "frame: it has no points");
  EXPECT_NE(refused(sample.view(std::nan(""))), "");
  EXPECT_EQ(writer.count(), 0u);
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_THROW(FrameWriter(folder_, "../heap"), std::invalid_argument);
  EXPECT_THROW(FrameWriter(folder_, ""), std::invalid_argument);
}

TEST_F(FrameWriterTest, AFrameThatCannotBeWrittenSaysWhyAndLeavesNothing) {
  const Sample sample;
  FrameWriter writer(folder_ / "frames", "heap");
  writer.write(sample.view(0.0));
  fs::remove_all(folder_ / "frames");
  ::testing::internal::CaptureStderr();
  try {
    writer.write(sample.view(0.1));
    FAIL() << "no exception";
  } catch (const IoError& error) {
    EXPECT_EQ(error.path(), folder_ / "frames" / "heap_00001.hdf");
    EXPECT_EQ(error.reason(), "cannot create the file: No such file or directory");
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");  // HDF5 prints no stack of its own
  fs::create_directory(folder_ / "frames");
  EXPECT_EQ(writer.write(sample.view(0.1)).filename(), "heap_00001.hdf");  // tried again

  std::ofstream(folder_ / "file") << "x";
  EXPECT_THROW(FrameWriter(folder_ / "file", "heap"), IoError);
}

}  // namespace
}  // namespace repose::io
