/// Triangles from STL files.

#include "io/stl.hpp"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "io/table_error.hpp"

namespace repose::io {
namespace {

using Corner = std::array<float, 3>;
using Facet = std::array<Corner, 3>;

const std::vector<Facet>& tetrahedron() {
  static const Corner o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  static const std::vector<Facet> facets{{{o, y, x}}, {{o, x, z}}, {{o, z, y}}, {{x, y, z}}};
  return facets;
}

std::string binary(const std::vector<Facet>& facets, std::string head = "solid of CAD") {
  head.resize(80, ' ');
  const auto add = [&](const auto& value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    head.append(bytes, sizeof value);
  };
  add(static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) {
    add(Corner{});
    for (const Corner& corner : facet) add(corner);
    add(std::uint16_t{0});
  }
  return head;
}

std::string ascii(const std::vector<Facet>& facets) {
  std::string text = "solid a b\n";
  for (const Facet& facet : facets) {
    text += "  facet normal nan 0 -1e0\n  outer loop\n";
    for (const Corner& c : facet)
      text += "   vertex " + std::to_string(c[0]) + " +" + std::to_string(c[1]) + "\t" +
              std::to_string(c[2]) + "\r\n";
    text += "  endloop\n  ENDFACET\n";
  }
  return text + "endsolid a b\n";
}

TEST(StlTest, BothFormsGiveTheSameTriangles) {
  for (const std::string& file : {binary(tetrahedron()), ascii(tetrahedron())}) {
    const Triangles read = parse_stl(file, "t.stl");
    ASSERT_EQ(read.vertices.size(), 4U);
    ASSERT_EQ(read.corners.size(), 4U);
    for (std::size_t n = 0; n < 4; ++n)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < 3; ++i)
          EXPECT_EQ(read.vertices[read.corners[n][k]][i],
                    static_cast<double>(tetrahedron()[n][k][i]));
  }
}

TEST(StlTest, CornersOfOnePlaceAreOneVertex) {
  std::vector<Facet> facets = tetrahedron();
  facets[0][0][0] = -0.0F;
  facets.push_back({{{2, 2, 2}, {2, 2, 2}, {1, 0, 0}}});  // of two corners: left out
  const Triangles read = parse_stl(binary(facets), "t.stl");
  EXPECT_EQ(read.corners.size(), 4U);
}

std::string complaint(const std::string& file) {
  try {
    parse_stl(file, "t.stl");
    return "";
  } catch (const TableError& error) {
    return error.what();
  }
}

TEST(StlTest, TellsWhatIsWrong) {
  const std::string good = binary(tetrahedron()), text = ascii(tetrahedron());
  EXPECT_EQ(complaint(good.substr(0, good.size() - 60)),
            "t.stl: its head tells of 4 triangles, and there is room for 2 and a part of one; the "
            "file is cut off");
  EXPECT_EQ(complaint(good + "more"),
            "t.stl: its head tells of 4 triangles, and there is room for 4 and a part of one");
  EXPECT_EQ(complaint(binary({})), "t.stl: there are no triangles in it");
  EXPECT_EQ(complaint("x,y\n1,2\n").substr(0, 28), "t.stl: this is no STL file; ");
  std::vector<Facet> facets = tetrahedron();
  facets[2][1][2] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(complaint(binary(facets)), "t.stl: corner 2 of triangle 3 is not finite");
  EXPECT_EQ(complaint(text.substr(0, text.find("endsolid"))),
            "t.stl:30: the file ends before endsolid; it is cut off");
  EXPECT_EQ(complaint(text.substr(0, text.find("endloop"))),
            "t.stl:7: the file ends where endloop is expected; it is cut off");
  std::string changed = text;
  changed.replace(changed.find("vertex 1."), 9, "vertex l.");
  EXPECT_EQ(complaint(changed), "t.stl:6: \"l.000000\" is no number");
  changed = text;
  changed.replace(changed.find("outer"), 5, "inner");
  EXPECT_EQ(complaint(changed), "t.stl:3: \"inner\" stands where outer is expected");
}

}  // namespace
}  // namespace repose::io
