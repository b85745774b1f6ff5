/// [terrain] from its file to the maps that a run leaves.

#include "study/run/terrain_result.hpp"

#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "input/read_scene.hpp"
#include "input/resolved_scene.hpp"
#include "io/coordinate_system.hpp"
#include "io/level_lines.hpp"
#include "io/raster_file.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_scene.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;

class TerrainFileTest : public testing::Test {
 protected:
  TerrainFileTest() {
    map("ground.asc", [](double x, double y) { return 500.0 + 0.4 * (60.0 - x) + 0.01 * y; });
    map("release.asc", [](double x, double y) {
      return x > 10.0 && x < 22.0 && y > 12.0 && y < 24.0 ? 2.0 : 0.0;
    });
    write("region.geojson",
          R"({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates":
              [[[110, 212], [122, 212], [122, 224], [110, 224], [110, 212]]]}})");
    write("scene.toml", text());
  }

  static std::string text(
      const std::string& terrain = "release = \"release.asc\"\nfriction = 0.2\n") {
    return "[scene]\nend_time = 1.0\n[terrain]\nground = \"ground.asc\"\n" + terrain +
           "[[body]]\nshape = \"release\"\n[body.law]\nname = \"mu_i\"\nmu_0 = 0.38\nmu_d = 0.57\n"
           "I_0 = 0.28\nd = 0.05\nrho_p = 2000\nrho_0 = 1300\nK = 1e6\n[grid]\nh = 1.0\n";
  }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_.path() / name) << content;
  }
  /// Of 3 m cells, 60 m by 36 m, corner (100, 200); in coordinates from that corner.
  void map(const std::string& name, const std::function<double(double, double)>& value) const {
    io::Raster raster{20, 12, 100.0, 200.0, 3.0, {}};
    for (std::size_t row = 0; row < raster.rows; ++row)
      for (std::size_t column = 0; column < raster.columns; ++column)
        raster.values.push_back(value(3.0 * (static_cast<double>(column) + 0.5),
                                      36.0 - 3.0 * (static_cast<double>(row) + 0.5)));
    write(name, io::esri_grid_text(raster, 6));
  }
  input::SceneFile read(const std::vector<std::string>& set = {}) const {
    input::InputFile file = input::InputFile::read(folder_.path() / "scene.toml", set);
    return input::read_scene(file);
  }
  std::string complaint(const std::vector<std::string>& set = {}) const {
    try {
      read(set);
    } catch (const input::BadInput& error) {
      return error.what();
    }
    return "";
  }
  io::ExitCode run(const fs::path& result) const {
    RunRequest request;
    request.file = read();
    request.input = input::resolved_input(request.file, "test");
    request.folder = result;
    request.threads = 1;
    request.quiet = true;
    return run_scene(request);
  }

  ScratchFolder folder_;
};

TEST_F(TerrainFileTest, TheBoxIsThatOfTheMap) {
  const mpm::Scene scene = read().scene;
  EXPECT_EQ(scene.dimensions(), 3U);
  EXPECT_EQ(scene.domain[0], 60.0);
  EXPECT_EQ(scene.domain[2], 36.0);
  EXPECT_EQ(scene.right.kind, mpm::Wall::Kind::open);
  // the lowest cell of the map, at x = 58.5 and y = 1.5, is 500.615 m high
  EXPECT_EQ(scene.terrain->base, 496.0);
  EXPECT_NEAR(scene.terrain->ground->height(58.5, 34.5), 4.615, 1e-9);
  EXPECT_EQ(scene.terrain->release->volume(), 288.0);
  EXPECT_EQ(read({"domain.size=[30, 40, 30]"}).scene.domain[0], 30.0);
  EXPECT_EQ(read({"domain.right=\"slip\""}).scene.right.kind, mpm::Wall::Kind::slip);
  EXPECT_EQ(read({"terrain.base=480"}).scene.terrain->base, 480.0);
}

TEST_F(TerrainFileTest, WhatIsWrittenOutReadsTheSame) {
  for (const std::string& terrain :
       {std::string("release = \"release.asc\"\nfriction = 0.2\n"),
        std::string("release = \"release.asc\"\nfriction = \"release.asc\"\n"),
        std::string("release = \"region.geojson\"\nrelease_depth = 1.5\nkind = \"slip\"\n")}) {
    write("scene.toml", text(terrain));
    const input::SceneFile file = read();
    const std::string once = input::resolved_input(file, "test");
    const ScratchFolder elsewhere;  // the maps are found from anywhere
    std::ofstream(elsewhere.path() / "input.toml") << once;
    input::InputFile again = input::InputFile::read(elsewhere.path() / "input.toml");
    const input::SceneFile second = input::read_scene(again);
    EXPECT_EQ(input::resolved_input(second, "test"), once);
    EXPECT_EQ(second.scene.terrain->release->volume(), file.scene.terrain->release->volume());
  }
}

TEST_F(TerrainFileTest, SaysWhatIsWrong) {
  EXPECT_EQ(complaint(), "");
  const std::string here = folder_.path().string() + "/";
  EXPECT_EQ(complaint({"terrain.ground=nowhere.asc"}),
            "--set terrain.ground=nowhere.asc: nowhere.asc: there is no such file");
  write("scene.toml", text("release = \"relaese.asc\"\n"));
  EXPECT_EQ(complaint(), here + "scene.toml:5:1: " + here +
                             "relaese.asc: there is no such file; did you mean " + here +
                             "release.asc?");
  write("scene.toml", text("release = \"region.geojson\"\n"));
  EXPECT_NE(complaint().find("terrain.release_depth gives that of all that have none"),
            std::string::npos);
  write("scene.toml", text("release = \"release.asc\"\nrelease_depth = 2\n"));
  EXPECT_NE(complaint().find("only a release of regions has one depth"), std::string::npos);
  write("scene.toml", text("friction = 0.2\n"));
  EXPECT_NE(complaint().find("shape = \"release\" needs terrain.release"), std::string::npos);
  write("scene.toml", text("release = \"release.asc\"\nfriction = 0.2\nkind = \"slip\"\n"));
  EXPECT_NE(complaint().find("give either kind or friction"), std::string::npos);
  // another file under the same name
  write("scene.toml", text());
  std::ofstream(folder_.path() / "input.toml") << input::resolved_input(read(), "test");
  map("ground.asc", [](double x, double) { return 500.0 + 0.5 * (60.0 - x); });
  input::InputFile changed = input::InputFile::read(folder_.path() / "input.toml");
  try {
    input::read_scene(changed);
    ADD_FAILURE() << "a changed map was taken";
  } catch (const input::BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("not the file that the scene was made with"),
              std::string::npos);
  }
  map("gap.asc", [](double x, double y) { return x > 50.0 && y < 4.0 ? std::nan("") : 3.0; });
  write("scene.toml", text());
  EXPECT_NE(complaint({"terrain.ground=" + here + "gap.asc"})
                .find("row 12, column 18 of the map has no data"),
            std::string::npos);
  EXPECT_NE(complaint({"terrain.friction=" + here + "gap.asc"}).find("has no data"),
            std::string::npos);
  // a box without a terrain still needs its size
  write("scene.toml", "[scene]\nend_time = 1.0\n[[body]]\nshape = \"release\"\n[grid]\nh = 1.0\n");
  EXPECT_NE(complaint().find("domain"), std::string::npos);
}

// A map of depths has the volume of the points, whatever its cells: the hats of the nodes add up to
// one over the box, which is that of the map.
TEST_F(TerrainFileTest, MapsHaveTheVolumeOfThePoints) {
  const mpm::Scene scene = read().scene;
  mpm::Simulation simulation(scene, 1);
  const auto volume = [](const io::Raster& map) {
    double sum = 0.0;
    for (const double depth : map.values) sum += depth * map.cell * map.cell;
    return sum;
  };
  EXPECT_NEAR(volume(terrain_maps(simulation).deposit_m), 288.0, 288.0 * 1e-12);
  while (simulation.time() < 1.0) simulation.step(1.0);
  const TerrainMaps maps = terrain_maps(simulation);
  EXPECT_NEAR(volume(maps.deposit_m), 288.0, 288.0 * 1e-12);
  for (std::size_t n = 0; n < maps.deposit_m.values.size(); ++n) {
    EXPECT_GE(maps.largest_depth_m.values[n], maps.deposit_m.values[n] - 0.02);
    if (!std::isnan(maps.arrival_s.values[n])) {
      EXPECT_GE(maps.arrival_s.values[n], 0.0);
      EXPECT_LE(maps.arrival_s.values[n], 1.0);
    }
  }
}

TEST_F(TerrainFileTest, ARunLeavesMapsAndOutlines) {
  write("ground.prj", "PROJCS[\"x\",AUTHORITY[\"EPSG\",\"4326\"],AUTHORITY[\"EPSG\",\"32632\"]]");
  const fs::path result = folder_.path() / "result";
  ASSERT_EQ(run(result), io::ExitCode::done);
  for (const char* name : {"largest_depth", "largest_speed", "arrival_time", "deposit"}) {
    const std::string content = content_of(result / (std::string(name) + ".asc"));
    const io::Raster map = io::parse_esri_grid(content, name);
    EXPECT_EQ(map.columns, 20U);
    EXPECT_EQ(map.west, 100.0);
    EXPECT_EQ(map.south, 200.0);
    EXPECT_EQ(map.cell, 3.0);
    EXPECT_TRUE(fs::exists(result / (std::string(name) + ".prj")));
  }
  const std::string outlines = content_of(result / "outlines.geojson");
  EXPECT_NE(outlines.find("urn:ogc:def:crs:EPSG::32632"), std::string::npos);
  const auto regions = io::parse_geojson(outlines, "outlines");
  ASSERT_FALSE(regions.empty());
  for (const io::Region& region : regions) {
    EXPECT_GT(io::signed_area(region.outer), 0.0);
    for (const auto& [x, y] : region.outer) {
      EXPECT_TRUE(x >= 99.0 && x <= 161.0) << x;
      EXPECT_TRUE(y >= 199.0 && y <= 237.0) << y;
    }
  }
  // what was released lies within what was reached: its middle, and not that far north
  double reached = 0.0;
  for (const io::Region& region : regions) reached += io::signed_area(region.outer);
  EXPECT_GT(reached, 144.0);
  // a second run leaves nothing of the first
  std::ofstream(result / "deposit.prj") << "old";
  fs::remove(folder_.path() / "ground.prj");
  ASSERT_EQ(run(result), io::ExitCode::done);
  EXPECT_FALSE(fs::exists(result / "deposit.prj"));
}

// The same scene from a GeoTIFF of the same numbers: the same maps, as GeoTIFFs in the ground's
// coordinates.
TEST_F(TerrainFileTest, AGeoTiffGivesWhatAnEsriGridGives) {
  if (io::gdal_library().empty())
    GTEST_SKIP() << "built without GDAL: scripts/packages maps installs it";
  const fs::path grids = folder_.path() / "grids", tiffs = folder_.path() / "tiffs";
  ASSERT_EQ(run(grids), io::ExitCode::done);
  const std::string utm =
      "PROJCS[\"UTM 32N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,"
      "298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],"
      "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],"
      "PARAMETER[\"central_meridian\",9],PARAMETER[\"scale_factor\",0.9996],"
      "PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1],"
      "AUTHORITY[\"EPSG\",\"32632\"]]";
  for (const char* name : {"ground", "release"}) {
    const io::RasterFile grid = io::read_raster(folder_.path() / (std::string(name) + ".asc"));
    // what single precision keeps of these heights, written out whole: multiples of 2⁻¹⁴ m
    io::Raster map = grid.raster;
    std::ofstream(folder_.path() / (std::string(name) + ".tif"), std::ios::binary)
        << io::geotiff_of(map, 6, utm);
    for (double& x : map.values) x = static_cast<float>(std::nearbyint(x * 1e6) / 1e6);
    write(std::string(name) + ".asc", io::esri_grid_text(map, 20));
  }
  ASSERT_EQ(run(grids), io::ExitCode::done);
  std::string scene = text("release = \"release.tif\"\nfriction = 0.2\n");
  scene.replace(scene.find("ground.asc"), 10, "ground.tif");
  write("scene.toml", scene);
  ASSERT_EQ(run(tiffs), io::ExitCode::done);
  EXPECT_EQ(content_of(tiffs / "series.csv"), content_of(grids / "series.csv"));
  for (const std::string name : {"largest_depth", "largest_speed", "arrival_time", "deposit"}) {
    EXPECT_FALSE(fs::exists(tiffs / (name + ".asc")));
    const io::RasterFile grid = io::read_raster(grids / (name + ".asc"));
    const io::RasterFile tiff = io::read_raster(tiffs / (name + ".tif"));
    EXPECT_EQ(tiff.raster.west, 100.0);
    EXPECT_EQ(tiff.raster.south, 200.0);
    EXPECT_EQ(io::epsg_of(tiff.crs), "32632");
    ASSERT_EQ(tiff.raster.values.size(), grid.raster.values.size());
    for (std::size_t k = 0; k < tiff.raster.values.size(); ++k) {
      const double a = tiff.raster.values[k], b = grid.raster.values[k];
      EXPECT_TRUE((std::isnan(a) && std::isnan(b)) || a == static_cast<float>(b)) << name << k;
    }
  }
  EXPECT_NE(content_of(tiffs / "outlines.geojson").find("EPSG::32632"), std::string::npos);
  // the result's own input reads them again, and a changed one is refused
  std::ofstream(folder_.path() / "input.toml") << content_of(tiffs / "input.toml");
  input::InputFile again = input::InputFile::read(folder_.path() / "input.toml");
  EXPECT_TRUE(input::read_scene(again).scene.terrain->geotiff);
  // in degrees, or in another system than the ground
  const auto tiff_in = [&](const std::string& system) {
    std::ofstream(folder_.path() / "release.tif", std::ios::binary)
        << io::geotiff_of(io::read_raster(folder_.path() / "release.asc").raster, 6, system);
  };
  tiff_in(
      "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
      "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]");
  EXPECT_NE(
      complaint().find("its places are in degrees (WGS 84); metres are needed: gdalwarp -t_srs"),
      std::string::npos)
      << complaint();
  std::string other = utm;
  other.replace(other.find("32632"), 5, "32633");
  other.replace(other.find("meridian\",9"), 11, "meridian\",15");
  tiff_in(other);
  EXPECT_NE(
      complaint().find("its coordinate system is EPSG:32633, and that of the ground EPSG:32632"),
      std::string::npos)
      << complaint();
}

TEST_F(TerrainFileTest, AGridInDegreesIsRefused) {
  write("ground.prj", "GEOGCS[\"GCS_WGS_1984\",UNIT[\"Degree\",0.0174532925199433]]");
  EXPECT_NE(complaint().find("its places are in degrees (GCS_WGS_1984)"), std::string::npos);
}

TEST_F(TerrainFileTest, TheSeriesTellsHowFarTheFlowIs) {
  const fs::path result = folder_.path() / "result";
  ASSERT_EQ(run(result), io::ExitCode::done);
  const NumberTable series = read_numbers(result / "series.csv");
  const auto& farthest = series.at("runout_max_m");
  const auto& most = series.at("runout_99_m");
  // 12 m × 12 m, 2 m deep, lie in whole cells of 1 m: all of them at the start
  EXPECT_EQ(farthest.front(), 0.0);
  EXPECT_EQ(series.at("depth_max_m").front(), 2.0);
  // the nodes within carry 2 m, those on the edge half of it, the corners a quarter: all are
  // reached from a quarter of a cell on, 13 × 13 of them; and the volume is 288 m³
  EXPECT_NEAR(series.at("area_m2").front(), 169.0, 1e-9);
  EXPECT_NEAR(series.at("depth_mean_m").front(), 288.0 / 169.0, 1e-12);
  EXPECT_EQ(series.at("speed_mean_m_per_s").front(), 0.0);
  // after a second on a slope of 0.4 with friction 0.2 (a frictionless block would have gone
  // g t²/2 · sin cos = 1.7 m in the plan), with what the edges of the block spread
  EXPECT_GT(farthest.back(), 0.5);
  EXPECT_LT(farthest.back(), 6.0);
  EXPECT_GT(most.back(), 0.3);
  EXPECT_LE(most.back(), farthest.back());
  EXPECT_GE(series.at("reached_m2").back(), series.at("area_m2").back());
  const auto summary = read_summary(result / "summary.json").figures;
  EXPECT_EQ(summary.at("runout_99_m"), most.back());
  EXPECT_GE(summary.at("largest_depth_m"), series.at("depth_max_m").back() - 1e-12);
}

}  // namespace
}  // namespace repose::study
