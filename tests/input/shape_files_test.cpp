/// Curves and meshes from their files.

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "input/read_surface.hpp"
#include "io/table_error.hpp"

namespace repose::input {
namespace {

std::string complaint_about(const std::string& table, bool closed, const std::string& unit = "") {
  mpm::Curve curve;
  curve.unit = unit;
  try {
    line_of(table, "c.csv", curve, closed);
    return "";
  } catch (const io::TableError& error) {
    return error.what();
  }
}

TEST(ShapeFiles, ACurveIsReadInMetres) {
  mpm::Curve curve;
  curve.x = "along";
  curve.y = "up";
  const auto line = line_of("up [cm];along [mm]\n1,5;0\n0;20\n-1;40\n", "c.csv", curve, false);
  ASSERT_EQ(line->points().size(), 3U);
  EXPECT_DOUBLE_EQ(line->points()[0][1], 0.015);
  EXPECT_DOUBLE_EQ(line->points()[2][0], 0.04);
  // an outline may end where it began, and a profile come from the right
  curve = {};
  EXPECT_EQ(line_of("x_m,y_m\n0,0\n1,0\n0,1\n0,0\n", "c.csv", curve, true)->points().size(), 3U);
  EXPECT_EQ(line_of("x_m,y_m\n2,0\n1,5\n", "c.csv", curve, false)->points()[0][0], 1.0);
}

TEST(ShapeFiles, ACurveIsRefusedWithItsRow) {
  EXPECT_EQ(complaint_about("x,y\n0,0\n1,0\n0,1\n", true, "m"), "");
  EXPECT_EQ(
      complaint_about("# of a survey\nx_m,y_m\n0,1\n1,0\n0.5,0\n", false),
      "c.csv:5: x falls from 1 to 0.5: along an open curve, below which all is rigid, it rises");
  EXPECT_EQ(complaint_about("x_m,y_m\n1,1\n0.5,3\n0.8,2\n0,0\n", false).substr(0, 15),
            "c.csv:3: x fall");  // read from the right: the same step the other way
  EXPECT_EQ(complaint_about("x_m,y_m\n0,0\n1,0\n1,0\n1,1\n", true),
            "c.csv:4: the point (1, 0) is there twice in a row");
  EXPECT_EQ(complaint_about("x_m,y_m\n0,0\n1,nan\n2,0\n", false),
            "c.csv:3: column 2 (y_m): a point of a curve has no number here");
  EXPECT_EQ(complaint_about("x_m,y_m\n0,0\n", false),
            "c.csv:2: 1 point is too few: an open curve takes 2");
  EXPECT_NE(complaint_about("x,y\n0,0\n1,0\n0,1\n", true).find("the file names no unit"),
            std::string::npos);
}

TEST(ShapeFiles, AMeshIsScaledAndShifted) {
  std::ifstream in(std::string(REPOSE_SOURCE_DIR) + "/tests/input/tetrahedron.stl");
  std::ostringstream text;
  text << in.rdbuf();
  mpm::Mesh mesh;
  mesh.scale = 0.5;
  mesh.shift = {1.0, 2.0, 3.0};
  const auto surface = mesh_of(text.str(), "t.stl", mesh);
  EXPECT_DOUBLE_EQ(surface->volume(), 0.125 / 6.0);
  EXPECT_EQ(surface->bounds().low, (mpm::Position{1.0, 2.0, 3.0}));
  EXPECT_EQ(surface->bounds().high, (mpm::Position{1.5, 2.5, 3.5}));
  std::string holed = text.str();
  holed.erase(holed.find("facet"),
              holed.find("facet", holed.find("endfacet") + 8) - holed.find("facet"));
  try {
    mesh_of(holed, "t.stl", mesh);
    FAIL();
  } catch (const io::TableError& error) {
    EXPECT_NE(std::string(error.what()).find("t.stl: the edge from"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace repose::input
