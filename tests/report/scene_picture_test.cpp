// The figures behind the picture of a scene before it is run: what is drawn where.
#include "report/picture/scene_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "input/read_scene.hpp"
#include "report/picture/heap_picture.hpp"
#include "report/picture/scene_drawing.hpp"
#include "report/plot/gnuplot.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::report {
namespace {

using Kind = mpm::Wall::Kind;

const std::string sand =
    "law = { name = \"mu_i\", mu_0 = 0.38, mu_d = 0.57, I_0 = 0.28, d = 5e-3, rho_p = 2000, "
    "rho_0 = 1300, K = 1e5 }\n";
const std::string grid = "[grid]\nh = 0.025\n";
const std::string box = "[scene]\nname = \"s\"\nend_time = 1.0\n[domain]\nsize = [1.0, 0.5]\n";
const std::string block = "[[body]]\nname = \"sand\"\nsize = [0.1, 0.05]\n" + sand;

input::SceneFile file_of(const std::string& text) {
  input::InputFile file = input::InputFile::parse(text, "s.toml");
  return input::read_scene(file);
}

Figure picture_of(const mpm::Scene& scene) {
  const mpm::Simulation start(scene, 1);
  return scene_picture(scene, mpm::estimate(scene, 1), &start);
}
Figure picture_of(const std::string& text) { return picture_of(file_of(text).scene); }

const Axes& panel_of(const Figure& figure) { return *figure.panels().at(0); }

std::vector<Series> all(const Axes& axes, SeriesKind kind) {
  std::vector<Series> found;
  for (const Series& series : axes.series())
    if (series.kind == kind) found.push_back(series);
  return found;
}

Series named(const Axes& axes, const std::string& name) {
  for (const Series& series : axes.series())
    if (series.name == name) return series;
  ADD_FAILURE() << "nothing is called " << name;
  return {};
}

std::vector<std::string> names_of(const Axes& axes) {
  std::vector<std::string> names;
  for (const Series& series : axes.series())
    if (!series.name.empty()) names.push_back(series.name);
  return names;
}

bool has_label(const Axes& axes, const std::string& text) {
  return std::any_of(axes.labels().begin(), axes.labels().end(),
                     [&](const Label& label) { return label.text == text; });
}

TEST(ScenePicture, BodiesByColourWithTheirPoints) {
  const Figure figure = picture_of(
      box + block +
      "[[body]]\nname = \"ball\"\nshape = \"disc\"\ncentre = [0.5, 0.25]\nradius = 0.1\n" + sand +
      grid);
  const Axes& axes = panel_of(figure);
  EXPECT_EQ(names_of(axes), (std::vector<std::string>{"sand (mu_i)", "ball (mu_i)"}));
  const Series first = named(axes, "sand (mu_i)"), second = named(axes, "ball (mu_i)");
  EXPECT_NE(first.style.colour, second.style.colour);
  ASSERT_EQ(first.x.size(), 32u);  // 0.1 × 0.05 m, 0.0125 m apart
  const auto [left, right] = std::minmax_element(first.x.begin(), first.x.end());
  EXPECT_NEAR(*left, 0.00625, 1e-12);
  EXPECT_NEAR(*right, 0.1 - 0.00625, 1e-12);
  for (std::size_t i = 0; i < second.x.size(); ++i)
    EXPECT_LE(std::hypot(second.x[i] - 0.5, second.y[i] - 0.25), 0.1);
  EXPECT_EQ(figure.title, "s before its first step");
  EXPECT_NE(figure.subtitle.find("points: sand 32, ball " + std::to_string(second.x.size()) +
                                 "; cells: 40 × 20 of 0.025 m; first step "),
            std::string::npos)
      << figure.subtitle;
  EXPECT_NE(figure.subtitle.find("edges: left, right, top slip; floor no_slip"), std::string::npos)
      << figure.subtitle;
  // the shapes below the points
  const std::vector<Series> shapes = all(axes, SeriesKind::area);
  ASSERT_EQ(shapes.size(), 2u);
  EXPECT_EQ(shapes[1].style.colour, second.style.colour);
  // gravity alone
  ASSERT_EQ(axes.arrows().size(), 1u);
  EXPECT_EQ(axes.arrows()[0].label, "gravity");
}

TEST(ScenePicture, AnOpeningIsAGapInTheWall) {
  const std::string parts =
      "floor = [{ from = 0.4, to = 0.6, kind = \"open\" }, { to = 0.2, friction = 0.3 }, "
      "{ kind = \"no_slip\" }]\ntop = \"open\"\n";
  const mpm::Scene scene = file_of(box + parts + block + grid).scene;
  std::vector<EdgeStretch> floor;
  for (const EdgeStretch& stretch : edge_stretches(scene, 0.0))
    if (stretch.edge == 2) floor.push_back(stretch);
  ASSERT_EQ(floor.size(), 3u) << "closed parts side by side are one";
  EXPECT_EQ(floor[1].kind, Kind::open);
  EXPECT_EQ(floor[1].from, (std::array{0.4, 0.0}));
  EXPECT_EQ(floor[1].to, (std::array{0.6, 0.0}));

  const Figure figure = picture_of(scene);
  const Axes& axes = panel_of(figure);
  const auto covered = [&](SeriesKind kind, double x, double y) {
    const std::vector<Series> series = all(axes, kind);
    return std::any_of(series.begin(), series.end(), [&](const Series& line) {
      return line.x.size() == 2 && std::abs(line.y[0] - y) < 1e-12 &&
             std::abs(line.y[1] - y) < 1e-12 && std::min(line.x[0], line.x[1]) < x &&
             x < std::max(line.x[0], line.x[1]);
    });
  };
  for (const double x : {0.1, 0.39, 0.61, 0.9}) {
    EXPECT_TRUE(covered(SeriesKind::line, x, 0.0)) << x;
    EXPECT_FALSE(covered(SeriesKind::dashed, x, 0.0)) << x;
  }
  for (const double x : {0.41, 0.5, 0.59}) {
    EXPECT_FALSE(covered(SeriesKind::line, x, 0.0)) << x;
    EXPECT_TRUE(covered(SeriesKind::dashed, x, 0.0)) << x;
  }
  EXPECT_TRUE(covered(SeriesKind::dashed, 0.5, 0.5)) << "an edge that is open all along";
  EXPECT_FALSE(covered(SeriesKind::line, 0.5, 0.5));
  named(axes, "open edge");
}

TEST(ScenePicture, PeriodicEdgesAreNoWalls) {
  const Figure figure =
      picture_of(box + "left = \"periodic\"\nright = \"periodic\"\n" + block + grid);
  const Axes& axes = panel_of(figure);
  EXPECT_EQ(named(axes, "periodic edge").kind, SeriesKind::dashed);
  EXPECT_EQ(all(axes, SeriesKind::dashed).size(), 2u);
  EXPECT_EQ(all(axes, SeriesKind::band).size(), 2u) << "floor and top";
}

// On each edge, the arrow starts in the middle of the stretch and points into the box.
TEST(ScenePicture, AnInflowIsAnArrowInwards) {
  struct Case {
    const char* edge;
    double x, y, inwards_x, inwards_y;
  };
  for (const Case& c : {Case{"top", 0.3, 0.5, 0, -1}, Case{"floor", 0.3, 0.0, 0, 1},
                        Case{"left", 0.0, 0.3, 1, 0}, Case{"right", 1.0, 0.3, -1, 0}}) {
    const Figure figure =
        picture_of(box + "[[body]]\nname = \"sand\"\norigin = [0.45, 0.1]\nsize = [0.1, 0.05]\n" +
                   sand + "[[inflow]]\nname = \"jet\"\nedge = \"" + c.edge +
                   "\"\nfrom = 0.2\nto = 0.4\nspeed = 0.5\nstops = 3.0\n" + grid);
    const Axes& axes = panel_of(figure);
    ASSERT_EQ(axes.arrows().size(), 2u) << "gravity and the inflow";
    const Arrow& arrow = axes.arrows()[0];
    EXPECT_NEAR(arrow.from_x, c.x, 1e-12) << c.edge;
    EXPECT_NEAR(arrow.from_y, c.y, 1e-12) << c.edge;
    const double length = std::hypot(arrow.to_x - arrow.from_x, arrow.to_y - arrow.from_y);
    EXPECT_NEAR(arrow.to_x - arrow.from_x, c.inwards_x * length, 1e-12) << c.edge;
    EXPECT_NEAR(arrow.to_y - arrow.from_y, c.inwards_y * length, 1e-12) << c.edge;
    EXPECT_GT(length, 0.02);
    EXPECT_TRUE(has_label(axes, "jet 0.5 m/s until 3 s"));
  }
}

TEST(ScenePicture, WhatMovesHasAnArrow) {
  const std::string surfaces =
      "[[surface]]\nname = \"gate\"\nshape = \"polygon\"\n"
      "corners = [[0.2, 0.0], [0.3, 0.0], [0.3, 0.2], [0.2, 0.2]]\nvelocity = [0.0, 1.0]\n"
      "starts = 0.5\n"
      "[[surface]]\nname = \"rock\"\nshape = \"ball\"\ncentre = [0.6, 0.0]\nradius = 0.05\n";
  const Figure figure = picture_of(box + block + surfaces + grid);
  const Axes& axes = panel_of(figure);
  EXPECT_EQ(names_of(axes), (std::vector<std::string>{"sand (mu_i)", "rigid: gate, rock"}));
  ASSERT_EQ(axes.arrows().size(), 2u) << "gravity and the gate";
  const Arrow& gate = axes.arrows()[0];
  EXPECT_NEAR(gate.from_x, 0.25, 1e-12);
  EXPECT_NEAR(gate.from_y, 0.1, 1e-12);
  EXPECT_EQ(gate.to_x, gate.from_x);
  EXPECT_GT(gate.to_y, gate.from_y);
  EXPECT_TRUE(has_label(axes, "gate 1 m/s from 0.5 s"));
  EXPECT_EQ(all(axes, SeriesKind::area).size(), 3u) << "the body, and what is rigid";
}

// The arrow of a drum goes round its axis, the way that it turns; its inside is not tinted.
TEST(ScenePicture, ADrumTurns) {
  for (const double spin : {1.0, -1.0}) {
    const Figure figure = picture_of(
        box + "[[body]]\norigin = [0.4, 0.2]\nsize = [0.2, 0.05]\n" + sand +
        "[[surface]]\nname = \"drum\"\nshape = \"ball\"\nhollow = true\ncentre = [0.5, 0.25]\n"
        "radius = 0.2\npivot = [0.5, 0.25]\nspin = " +
        std::to_string(spin) + "\n" + grid);
    const Axes& axes = panel_of(figure);
    ASSERT_EQ(axes.arrows().size(), 2u);
    const Arrow& arrow = axes.arrows()[0];
    const double dx = arrow.to_x - arrow.from_x, dy = arrow.to_y - arrow.from_y;
    EXPECT_GT(spin * ((arrow.from_x - 0.5) * dy - (arrow.from_y - 0.25) * dx), 0.0);
    EXPECT_NEAR(std::hypot(arrow.to_x - 0.5, arrow.to_y - 0.25), 0.6 * 0.2, 1e-12);
    EXPECT_EQ(all(axes, SeriesKind::area).size(), 1u) << "the body alone";
  }
}

TEST(ScenePicture, ProbesAndTracersWithTheirNames) {
  const std::string looks =
      "[[probe]]\nname = \"toe\"\nplace = [0.3, 0.02]\n"
      "[[tracer]]\nname = \"grain\"\nplace = [0.05, 0.03]\n";
  const mpm::Scene scene = file_of(box + block + looks + grid).scene;
  const Figure figure = picture_of(scene);
  const Axes& axes = panel_of(figure);
  const Series probe = named(axes, "1: toe"), tracer = named(axes, "tracer");
  EXPECT_EQ(probe.style.marker, Marker::cross);
  EXPECT_EQ(probe.x, std::vector<double>{0.3});
  EXPECT_EQ(probe.y, std::vector<double>{0.02});
  EXPECT_EQ(tracer.style.marker, Marker::ring);
  // the ring is at a point of the body, the nearest: half a spacing away along each axis at most
  const Series points = named(axes, "sand (mu_i)");
  ASSERT_EQ(tracer.x.size(), 1u);
  double nearest = HUGE_VAL;
  for (std::size_t i = 0; i < points.x.size(); ++i)
    nearest = std::min(nearest, std::hypot(points.x[i] - tracer.x[0], points.y[i] - tracer.y[0]));
  EXPECT_EQ(nearest, 0.0);
  EXPECT_LE(std::abs(tracer.x[0] - 0.05), 0.00625 * (1 + 1e-12));
  EXPECT_LE(std::abs(tracer.y[0] - 0.03), 0.00625 * (1 + 1e-12));
  EXPECT_TRUE(has_label(axes, "1"));
  EXPECT_TRUE(has_label(axes, "grain"));

  // a tracer that falls is shown where it has come to
  mpm::Simulation run(scene, 1);
  for (int k = 0; k < 20; ++k) run.step(1.0);
  Figure later;
  Axes& then = add_section(later, scene);
  draw_surroundings(then, scene, section_of(run));
  EXPECT_EQ(names_of(then), (std::vector<std::string>{"1: toe", "tracer"}));
  const std::vector<Series> marks = all(then, SeriesKind::points);
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[1].x[0], run.tracer(0).position[0]);
  EXPECT_EQ(marks[1].y[0], run.tracer(0).position[1]);
  EXPECT_NE(marks[1].y[0], tracer.y[0]);
}

TEST(ScenePicture, InSpaceASlice) {
  const std::string space =
      "[scene]\nname = \"s\"\nend_time = 1.0\n[domain]\nsize = [0.5, 0.25, 0.2]\n"
      "near = \"no_slip\"\nfar = \"no_slip\"\n"
      "[[body]]\nname = \"sand\"\nsize = [0.1, 0.1, 0.2]\n" +
      sand +
      "[[probe]]\nname = \"in\"\nplace = [0.3, 0.02, 0.11]\n"
      "[[probe]]\nname = \"out\"\nplace = [0.3, 0.02, 0.05]\n"
      "[grid]\nh = 0.025\npoints_per_cell = 8\n";
  const Figure figure = picture_of(space);
  EXPECT_EQ(figure.title, "s before its first step, z = 0.1 to 0.125 m");
  const Axes& axes = panel_of(figure);
  EXPECT_EQ(named(axes, "sand (mu_i)").x.size(), 8u * 8u * 2u) << "two layers of points";
  EXPECT_NE(figure.subtitle.find("1 024 points"), std::string::npos) << figure.subtitle;
  EXPECT_NE(figure.subtitle.find("near, far no_slip"), std::string::npos) << figure.subtitle;
  EXPECT_EQ(names_of(axes),
            (std::vector<std::string>{"sand (mu_i)", "1: in", "2: out (z = 0.05 m)"}));
}

TEST(ScenePicture, TooManyPointsAreDrawnAsShapes) {
  const mpm::Scene scene = file_of(box + block + grid).scene;
  const Figure figure = scene_picture(scene, mpm::count_estimate(scene), nullptr);
  const Axes& axes = panel_of(figure);
  const Series shape = named(axes, "sand (mu_i)");
  EXPECT_EQ(shape.kind, SeriesKind::area);
  EXPECT_EQ(*std::max_element(shape.x.begin(), shape.x.end()), 0.1);
  EXPECT_TRUE(all(axes, SeriesKind::points).empty());
  EXPECT_NE(figure.subtitle.find("32 points"), std::string::npos) << figure.subtitle;
}

TEST(ScenePicture, ManyBodiesDoNotFillTheLegend) {
  std::string bodies;
  for (int k = 0; k < 15; ++k)
    bodies +=
        "[[body]]\norigin = [" + std::to_string(0.05 * k) + ", 0.0]\nsize = [0.05, 0.05]\n" + sand;
  const Figure figure = picture_of(box + bodies + grid);
  const std::vector<std::string> names = names_of(panel_of(figure));
  ASSERT_EQ(names.size(), 13u);
  EXPECT_EQ(names.back(), "and 3 more");
  EXPECT_EQ(all(panel_of(figure), SeriesKind::points).size(), 15u);
  EXPECT_NE(figure.subtitle.find("240 points in 15 bodies"), std::string::npos) << figure.subtitle;
}

TEST(ScenePicture, ShapesOfBodies) {
  mpm::Body ring;
  set_disc(ring, {{0.5, 0.5}, 0.2, 0.1});
  // a regular 120-gon of radius 1 has the area 60 sin(2π/120)
  const double area = 60.0 * std::sin(std::numbers::pi / 60.0);
  const std::vector<mpm::Polygon> plane = outlines_of(ring, 0.0);
  ASSERT_EQ(plane.size(), 1u);
  EXPECT_NEAR(std::abs(mpm::piece_of(plane[0]).area), area * (0.04 - 0.01), 1e-12);

  mpm::Body pipe;  // upright, its axis at z = 0.5
  set_cylinder(pipe, {{0.5, 0.5}, 0.2, 0.1}, 0.0, 0.3);
  const std::vector<mpm::Polygon> walls = outlines_of(pipe, 0.5);
  ASSERT_EQ(walls.size(), 2u);
  EXPECT_NEAR(walls[0].corners[0][0], 0.3, 1e-15);
  EXPECT_NEAR(walls[0].corners[1][0], 0.4, 1e-15);
  EXPECT_NEAR(walls[1].corners[0][0], 0.6, 1e-15);
  const std::vector<mpm::Polygon> side = outlines_of(pipe, 0.62);  // beside the hole
  ASSERT_EQ(side.size(), 1u);
  // the chord 0.12 from the axis: 2 √(0.2² − 0.12²) = 0.32
  EXPECT_NEAR(side[0].corners[1][0] - side[0].corners[0][0], 0.32, 1e-15);
  EXPECT_TRUE(outlines_of(pipe, 0.71).empty());
}

// By level lines on 400 places across: an arc is cut off by less than a hundredth of its area.
TEST(ScenePicture, ShapesThatCutEachOther) {
  mpm::Body ball;
  set_solid(ball, {mpm::Ball{{0.5, 0.5, 0.4}, 0.3}, false}, {1.0, 1.0, 1.0});
  ball.without = {{mpm::Cylinder{{0.5, 0.5, 0.0}, {0.0, 0.0, 1.0}, 0.1}, false}};
  const std::vector<mpm::Polygon> ring = outlines_of(ball, 0.4);
  ASSERT_EQ(ring.size(), 1u);
  EXPECT_NEAR(std::abs(mpm::piece_of(ring[0]).area), std::numbers::pi * 0.08, 0.01 * 0.25);
  EXPECT_TRUE(outlines_of(ball, 0.75).empty());

  mpm::Surface pipe;  // along the section
  pipe.solid = {mpm::Cylinder{{-1.0, 0.5, 0.5}, {1.0, 0.0, 0.0}, 0.2}, false};
  const std::vector<mpm::Outline> bar = pipe.outlines(0.0, 0.5, {0.0, 0.0}, {1.0, 1.0});
  ASSERT_EQ(bar.size(), 1u);
  ASSERT_EQ(bar[0].size(), 1u);
  EXPECT_NEAR(mpm::piece_of(bar[0][0]).area, 0.4, 1e-12);
}

TEST(ScenePicture, ATerrainFromAbove) {
  input::InputFile file = input::InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/valley.toml");
  const mpm::Scene scene = input::read_scene(file).scene;
  const mpm::Simulation start(scene, 1);
  const Figure figure = scene_picture(scene, mpm::count_estimate(scene), &start);
  const Axes& axes = panel_of(figure);
  EXPECT_EQ(names_of(axes), (std::vector<std::string>{"released", "body0 (mu_i)", "open edge"}));
  EXPECT_EQ(all(axes, SeriesKind::shade).size(), 1u);
  // all points lie within the rectangle around what is released, but for half a spacing
  const Series points = named(axes, "body0 (mu_i)");
  EXPECT_EQ(points.x.size(), static_cast<std::size_t>(start.point_count()));
  const double height = scene.terrain->ground_map.height();
  const mpm::Release& release = *scene.terrain->release;
  const double slack = mpm::point_spacing(scene);
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    EXPECT_GE(points.x[i], release.low()[0] - slack);
    EXPECT_LE(points.x[i], release.high()[0] + slack);
    EXPECT_GE(height - points.y[i], release.low()[1] - slack);
    EXPECT_LE(height - points.y[i], release.high()[1] + slack);
  }
  EXPECT_EQ(all(axes, SeriesKind::dashed).size(), 5u) << "four edges and the release";
}

// What a run leaves: names of probes and tracers, and what comes in, are in final.svg.
TEST(ScenePicture, TheFinalPictureShowsWhatIsLookedAt) {
  try {
    run_gnuplot("");
  } catch (const PlotError& error) {
    GTEST_SKIP() << error.what();
  }
  const input::SceneFile file =
      file_of(box + block +
              "[[probe]]\nname = \"toe\"\nplace = [0.3, 0.02]\n"
              "[[tracer]]\nname = \"grain\"\nplace = [0.05, 0.03]\n"
              "[[inflow]]\nname = \"jet\"\nedge = \"top\"\nfrom = 0.2\nto = 0.4\nspeed = 0.5\n" +
              grid);
  const mpm::Simulation start(file.scene, 1);
  const ScratchFolder scratch;
  ASSERT_TRUE(draw_final_picture(file, start, scratch.path() / "final.svg"));
  const std::string svg = content_of(scratch.path() / "final.svg");
  for (const char* const text :
       {">1: toe<", ">1<", ">tracer<", ">grain<", ">jet 0.5 m/s<", ">gravity<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
}

// Several bodies are told apart unless a quantity is asked for.
TEST(ScenePicture, TheFinalPictureTellsBodiesApart) {
  try {
    run_gnuplot("");
  } catch (const PlotError& error) {
    GTEST_SKIP() << error.what();
  }
  const std::string two = box + block +
                          "[[body]]\nname = \"gravel\"\norigin = [0.2, 0.0]\nsize = [0.1, 0.05]\n" +
                          sand + grid;
  const ScratchFolder scratch;
  const auto drawn = [&](const std::string& text) {
    const input::SceneFile file = file_of(text);
    EXPECT_TRUE(draw_final_picture(file, mpm::Simulation(file.scene, 1), scratch.path() / "p.svg"));
    return content_of(scratch.path() / "p.svg");
  };
  const std::string bodies = drawn(two);
  EXPECT_NE(bodies.find(">gravel (mu_i)<"), std::string::npos);
  EXPECT_EQ(bodies.find("von Mises"), std::string::npos);
  const std::string stress = drawn(two + "[output]\ncolour = \"mises\"\n");
  EXPECT_EQ(stress.find(">gravel (mu_i)<"), std::string::npos);
  EXPECT_NE(stress.find("von Mises"), std::string::npos);
  const std::string one = box + block + grid;
  EXPECT_NE(drawn(one).find("von Mises"), std::string::npos)
      << "one body has nothing to tell apart";
  EXPECT_NE(drawn(one + "[output]\ncolour = \"body\"\n").find(">sand (mu_i)<"), std::string::npos);
}

TEST(ScenePicture, ManyProbesDoNotFillTheLegend) {
  std::string probes;
  for (int k = 0; k < 15; ++k)
    probes += "[[probe]]\nname = \"p" + std::to_string(k) + "\"\nplace = [0." +
              std::to_string(k + 10) + ", 0.02]\n";
  const std::vector<std::string> names =
      names_of(panel_of(picture_of(box + block + probes + grid)));
  ASSERT_EQ(names.size(), 14u) << "the body, twelve probes and the rest";
  EXPECT_EQ(names.back(), "13 to 15: more probes");
}

}  // namespace
}  // namespace repose::report
