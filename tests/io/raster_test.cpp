/// Maps and regions as GIS programs write them, and lines of equal value.

#include "io/raster.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "io/geojson.hpp"
#include "io/level_lines.hpp"
#include "io/table_error.hpp"

namespace repose::io {
namespace {

template <class F>
std::string complaint(F&& f) {
  try {
    f();
  } catch (const TableError& error) {
    return error.what();
  }
  return "";
}
std::string grid_complaint(const std::string& text) {
  return complaint([&] { parse_esri_grid(text, "g.asc"); });
}

constexpr const char* small =
    "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -9999\n"
    "1 2 3\n4.5 -9999 6e1\n";

TEST(RasterTest, ReadsCornersRowsAndGaps) {
  const Raster map = parse_esri_grid(small, "g.asc");
  EXPECT_EQ(map.columns, 3U);
  EXPECT_EQ(map.rows, 2U);
  EXPECT_EQ(map.west, 100.0);
  EXPECT_EQ(map.east(), 130.0);
  EXPECT_EQ(map.south, 200.0);
  EXPECT_EQ(map.north(), 220.0);
  EXPECT_EQ(map.at(0, 2), 3.0);
  EXPECT_EQ(map.at(1, 0), 4.5);
  EXPECT_TRUE(std::isnan(map.at(1, 1)));
  EXPECT_EQ(map.at(1, 2), 60.0);
}

// Keys in any case and order, cell centres, Windows' line ends, a byte-order mark, lines that wrap.
TEST(RasterTest, ReadsWhatOtherProgramsWrite) {
  const Raster map = parse_esri_grid(
      "\xEF\xBB\xBFNROWS 2\r\nNCOLS 3\r\nXLLCENTER 105\r\nYLLCENTER 205\r\nCELLSIZE 10\r\n"
      "1 2\r\n3 4.5\r\n+5 6e1",
      "g.asc");
  EXPECT_EQ(map.west, 100.0);
  EXPECT_EQ(map.south, 200.0);
  EXPECT_EQ(map.values, (std::vector<double>{1.0, 2.0, 3.0, 4.5, 5.0, 60.0}));
}

TEST(RasterTest, ComesBackAsItWasWritten) {
  Raster map = parse_esri_grid(small, "g.asc");
  map.west = 640123.25;
  const Raster again = parse_esri_grid(esri_grid_text(map, 3), "g.asc");
  EXPECT_EQ(again.west, map.west);
  EXPECT_EQ(again.cell, map.cell);
  for (std::size_t k = 0; k < map.values.size(); ++k)
    EXPECT_TRUE(again.values[k] == map.values[k] ||
                (std::isnan(again.values[k]) && std::isnan(map.values[k])));
}

TEST(RasterTest, SaysWhatIsWrong) {
  EXPECT_EQ(
      grid_complaint("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4,5 5 6"),
      "g.asc:7: a value is \"4,5\", which is no number; an ESRI ASCII grid has decimal "
      "points");
  EXPECT_EQ(grid_complaint("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 5"),
            "g.asc: 5 numbers instead of 2 rows of 3");
  EXPECT_EQ(grid_complaint("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3"),
            "g.asc:7: more numbers than the 1 rows of 2 that the header tells of");
  EXPECT_NE(grid_complaint("ncols 2\nnrows 1\nxllcorner 0\ncellsize 10\n1 2").find("no yllcorner"),
            std::string::npos);
  EXPECT_NE(grid_complaint("a,b\n1,2\n").find("no key of an ESRI ASCII grid"), std::string::npos);
  EXPECT_NE(grid_complaint("II*").find("gdal_translate"), std::string::npos);
  EXPECT_NE(grid_complaint("").find("no ncols"), std::string::npos);
  // nothing is allocated for what the file cannot hold
  EXPECT_NE(grid_complaint("ncols 9999\nnrows 9999\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n")
                .find("too short"),
            std::string::npos);
  EXPECT_NE(grid_complaint("ncols 1e9\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1")
                .find("no number of cells"),
            std::string::npos);
  EXPECT_NE(grid_complaint("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 0\n1")
                .find("must be > 0"),
            std::string::npos);
  EXPECT_NE(grid_complaint("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\ninf")
                .find("infinite"),
            std::string::npos);
}

TEST(GeoJsonTest, ReadsRegionsWithHolesAndDepths) {
  const auto regions = parse_geojson(
      R"({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"depth": 2.5}, "geometry": {"type": "Polygon",
          "coordinates": [[[0,0],[4,0],[4,4],[0,4],[0,0]], [[1,1],[1,2],[2,2],[1,1]]]}},
        {"type": "Feature", "properties": null, "geometry": {"type": "MultiPolygon",
          "coordinates": [[[[5,5,9],[6,5,9],[6,6,9]]]]}},
        {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1,2]}}]})",
      "r.geojson");
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].depth, 2.5);
  EXPECT_EQ(regions[0].outer.size(), 4U);
  ASSERT_EQ(regions[0].holes.size(), 1U);
  EXPECT_EQ(regions[0].holes[0].size(), 3U);
  EXPECT_FALSE(regions[1].depth.has_value());
  EXPECT_EQ(regions[1].outer[1], (std::array<double, 2>{6.0, 5.0}));
}

TEST(GeoJsonTest, SaysWhatIsWrong) {
  const auto of = [](const std::string& text) {
    return complaint([&] { parse_geojson(text, "r.geojson"); });
  };
  EXPECT_EQ(of("{"), "r.geojson: this is no JSON");
  EXPECT_EQ(of("[1, 2]"), "r.geojson: this is no GeoJSON: an object with a \"type\" is missing");
  EXPECT_EQ(of(R"({"type": "Point", "coordinates": [1, 2]})"),
            "r.geojson: there is no polygon in it");
  EXPECT_EQ(of(R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 1]]]})"),
            "r.geojson: a ring of a polygon has less than three places");
  EXPECT_EQ(of(R"({"type": "Polygon", "coordinates": [[[0, 0], [1, "a"], [2, 2]]]})"),
            "r.geojson: a place of a polygon is not [x, y]");
  EXPECT_NE(of(R"({"type": "Feature", "properties": {"depth": -1}, "geometry": null})")
                .find("must be a number > 0"),
            std::string::npos);
}

TEST(GeoJsonTest, ComesBackAsItWasWritten) {
  Region region{{{0, 0}, {4, 0}, {4, 4}}, {{{2, 1}, {3, 2}, {3, 1}}}, {}};
  const auto again =
      parse_geojson(geojson_text({{"deposit", {region}}}, "urn:ogc:def:crs:EPSG::32632"), "r");
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].outer, region.outer);
  EXPECT_EQ(again[0].holes, region.holes);
}

/// A ring between two circles about (2, 3), as values that are 1 on both of its edges.
struct Ringed {
  static constexpr std::size_t n = 201;
  static constexpr double inner = 0.6, outer = 1.4, dx = 0.02;
  std::vector<double> values;
  Ringed() {
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < n; ++i) {
        const double r =
            std::hypot(dx * static_cast<double>(i) - 2.0, dx * static_cast<double>(k) - 2.0);
        values.push_back(std::max(0.0, 1.0 + std::min(r - inner, outer - r)));
      }
  }
};

// A chord cuts r − √(r² − dx²/4) = dx²/8r off a circle: areas are smaller by less than 2πr dx²/8r
// of the outer one, and as much again for the bending of a value that is linear along the radius.
TEST(LevelLinesTest, EncloseTheAreaOfARing) {
  const Ringed ringed;
  for (const double sense : {1.0, -1.0}) {  // northwards and southwards
    const Lattice lattice{Ringed::n,  Ringed::n,          0.0,          sense * 1.0,
                          Ringed::dx, sense * Ringed::dx, ringed.values};
    const auto regions = regions_above(lattice, 1.0);
    ASSERT_EQ(regions.size(), 1U);
    ASSERT_EQ(regions[0].holes.size(), 1U);
    const double most = 2.0 * std::numbers::pi * Ringed::dx * Ringed::dx / 4.0;
    EXPECT_NEAR(signed_area(regions[0].outer), std::numbers::pi * Ringed::outer * Ringed::outer,
                most);
    EXPECT_NEAR(signed_area(regions[0].holes[0]), -std::numbers::pi * Ringed::inner * Ringed::inner,
                most);
    for (const auto& [x, y] : regions[0].outer)
      EXPECT_NEAR(std::hypot(x - 2.0, y - sense * 3.0), Ringed::outer, Ringed::dx * Ringed::dx);
  }
}

TEST(LevelLinesTest, EndAtTheBorderAndAtGaps) {
  const std::vector<double> slope{0, 1, 2, 0, 1, 2, 0, 1, 2};  // x of a lattice of 3 by 3
  const auto lines = level_lines({3, 3, 0.0, 0.0, 1.0, 1.0, slope}, 0.25);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].closed);
  ASSERT_EQ(lines[0].places.size(), 3U);
  for (const auto& place : lines[0].places) EXPECT_EQ(place[0], 0.25);
  std::vector<double> gap = slope;
  gap[0] = std::nan("");
  EXPECT_EQ(level_lines({3, 3, 0.0, 0.0, 1.0, 1.0, gap}, 0.25)[0].places.size(), 2U);
}

// Two high corners that face each other: one region where the middle is high, two where it is not.
TEST(LevelLinesTest, TellASaddleByItsMiddle) {
  for (const auto& [low, regions] : {std::pair{0.9, 1U}, {0.0, 2U}}) {
    const std::vector<double> saddle{1.3, low, low, 1.3};
    EXPECT_EQ(regions_above({2, 2, 0.0, 0.0, 1.0, 1.0, saddle}, 1.0).size(), regions) << low;
  }
}

TEST(LevelLinesTest, AHoleBelongsToTheNearestRingAround) {
  // a high frame, in it a low one, in that a high place with a hole of its own
  constexpr std::size_t n = 11;
  std::vector<double> values(n * n, 0.0);
  const auto fill = [&](std::size_t from, double x) {
    for (std::size_t k = from; k < n - from; ++k)
      for (std::size_t i = from; i < n - from; ++i) values[k * n + i] = x;
  };
  fill(0, 1.0);
  fill(1, 0.0);
  fill(3, 1.0);
  fill(5, 0.0);
  const auto regions = regions_above({n, n, 0.0, 0.0, 1.0, 1.0, values}, 0.5);
  ASSERT_EQ(regions.size(), 2U);
  for (const Region& region : regions) {
    ASSERT_EQ(region.holes.size(), 1U);
    EXPECT_GT(signed_area(region.outer), -signed_area(region.holes[0]));
  }
}

}  // namespace
}  // namespace repose::io
