/// Shapes by their signed distance, and bodies cut by them.

#include <functional>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "mpm/scene/cut_body.hpp"
#include "mpm/scene/fill.hpp"
#include "tests/mpm/scenes.hpp"
#include "tests/mpm/shapes.hpp"

namespace repose::mpm {
namespace {

using std::numbers::pi;

double dot(const Position& a, const Position& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Places in a box around the origin.
template <class F>
void each_place(int count, double half, F&& f) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-half, half);
  for (int n = 0; n < count; ++n) {
    const double x = coordinate(random), y = coordinate(random);
    f(Position{x, y, coordinate(random)});
  }
}

/// How much the bending is off central differences of the normal over a length e.
double bending_error(const Solid& solid, const Position& x, double e) {
  const Bending S = bending(solid, x, e);
  double largest = 0.0;
  for (std::size_t j = 0; j < 3; ++j) {
    Position ahead = x, behind = x;
    ahead[j] += e;
    behind[j] -= e;
    const Position n = nearest(solid, ahead).normal, m = nearest(solid, behind).normal;
    for (std::size_t i = 0; i < 3; ++i)
      largest = std::max(largest, std::abs(S[i][j] - (n[i] - m[i]) / (2.0 * e)));
  }
  return largest;
}

// The distance is that of a rectangle, r over s, in the cylinder's own directions; all terms are of
// size 3, and add up to within some 20 roundings.
TEST(CylinderTest, DistanceNormalAndBendingAreExact) {
  const Position axis{2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0}, point{0.3, -0.2, 0.1};
  const double radius = 0.7, length = 1.6;
  for (const bool endless : {false, true})
    for (const bool hollow : {false, true}) {
      const Solid solid{Cylinder{point, {2.0, -3.0, 6.0}, radius, endless ? HUGE_VAL : length},
                        hollow};
      int bent = 0;
      each_place(2000, 2.0, [&](const Position& x) {
        const Position m{x[0] - point[0], x[1] - point[1], x[2] - point[2]};
        const double s = dot(m, axis), r = std::sqrt(dot(m, m) - s * s);
        const double side = r - radius, end = std::max(-s, s - length);
        const double exact = endless                   ? side
                             : side > 0.0 && end > 0.0 ? std::hypot(side, end)
                                                       : std::max(side, end);
        const Nearest at = nearest(solid, x);
        EXPECT_NEAR(at.distance, hollow ? -exact : exact, 1e-14);
        EXPECT_NEAR(dot(at.normal, at.normal), 1.0, 1e-14);
        EXPECT_EQ(holds(solid, x), at.distance < 0.0);
        // the foot lies on the surface: φ is a distance along its normal
        Position foot = x;
        for (std::size_t k = 0; k < 3; ++k) foot[k] -= at.distance * at.normal[k];
        EXPECT_NEAR(nearest(solid, foot).distance, 0.0, 1e-14);
        // away from where side and end part, of the side alone: e²/6 of a third derivative 2/r³ at
        // r
        // >= 0.2, and roundings over e
        const double e = 1e-4;
        if (r > 0.2 && (endless || end < -0.01) && std::abs(side - end) > 0.01) {
          EXPECT_LT(bending_error(solid, x, e), e * e * 2.0 / (r * r * r) + 1e-11);
          ++bent;
        }
      });
      EXPECT_GT(bent, 100);
    }
}

// A drum whose axis lies along z is the plane's in every section.
TEST(CylinderTest, AlongZItIsTheDiscOfThePlane) {
  const Solid disc{Ball{{0.2, -0.1, 0.0}, 0.8}, true};
  const Solid drum{Cylinder{{0.2, -0.1, 0.4}, {0.0, 0.0, -3.0}, 0.8}, true};
  each_place(1000, 2.0, [&](const Position& x) {
    const Nearest a = nearest(disc, {x[0], x[1], 0.0}), b = nearest(drum, x);
    EXPECT_NEAR(a.distance, b.distance, 1e-15);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.normal[i], b.normal[i], 1e-15);
    const Bending S = bending(disc, {x[0], x[1], 0.0}, 0.1), T = bending(drum, x, 0.1);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_NEAR(S[i][j], T[i][j], 1e-13 * std::abs(S[i][j]) + 1e-14);
  });
}

// Of a box, the distance is that of a rectangle in each direction.
TEST(MeshTest, ABoxIsExact) {
  const Solid mesh = box_mesh({-0.5, -0.3, -0.8}, {0.5, 0.3, 0.8}).solid();
  each_place(5000, 1.5, [&](const Position& x) {
    const Position out{std::abs(x[0]) - 0.5, std::abs(x[1]) - 0.3, std::abs(x[2]) - 0.8};
    const double most = std::max({out[0], out[1], out[2]});
    double exact = most;
    if (most > 0.0)
      exact = std::hypot(std::max(out[0], 0.0), std::max(out[1], 0.0), std::max(out[2], 0.0));
    const Nearest at = nearest(mesh, x);
    EXPECT_NEAR(at.distance, exact, 1e-14);
    EXPECT_NEAR(dot(at.normal, at.normal), 1.0, 1e-14);
    EXPECT_EQ(holds(mesh, x), exact < 0.0);
    for (const double radius : {0.1, 0.5})
      EXPECT_EQ(is_beyond(mesh, x, radius), std::abs(exact) > radius);
  });
}

// Triangles of edges up to s lie up to s²/6R within a sphere of radius R, whose normals they have
// to s/(√3 R). Over ±e the bend is that of the sphere but for the jumps of the normal.
TEST(MeshTest, ASphereOfTrianglesIsNearlyASphere) {
  const double R = 0.8;
  const Position centre{0.1, 0.2, -0.1};
  const Solid ball{Ball{centre, R}, false};
  for (const int rounds : {3, 5}) {
    const Triangulation triangles = sphere_mesh(centre, R, rounds);
    const Solid mesh = triangles.solid();
    double s = 0.0;
    for (const auto& t : triangles.triangles) {
      const Position &a = triangles.vertices[t[0]], &b = triangles.vertices[t[1]];
      s = std::max(s, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    }
    double distance = 0.0, normal = 0.0, bend = 0.0;
    each_place(3000, 1.2, [&](const Position& x) {
      const Nearest a = nearest(mesh, x), b = nearest(ball, x);
      if (b.distance < -0.6 * R) return;
      distance = std::max(distance, std::abs(a.distance - b.distance));
      for (std::size_t i = 0; i < 3; ++i)
        normal = std::max(normal, std::abs(a.normal[i] - b.normal[i]));
      if (std::abs(b.distance) > 0.3 * R) return;
      const Bending S = bending(mesh, x, 0.25 * R), T = bending(ball, x, 0.25 * R);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) bend = std::max(bend, std::abs(S[i][j] - T[i][j]));
    });
    std::printf("[ measured ] sphere of %zu triangles: distance %.2g R, normal %.2g, bend %.2g/R\n",
                std::get<Mesh>(mesh.shape).mesh->size(), distance / R, normal, bend * R);
    EXPECT_LT(distance, 1.01 * s * s / (6.0 * R));  // and of higher order in s/R
    EXPECT_LT(normal, s / R);
    // two normals, each off by as much, over 2e = R/2; and (e/r)² of the bend itself, r >= 0.7 R
    EXPECT_LT(bend, 2.0 * s / R / (0.5 * R) + 0.13 / 0.7 / R);
  }
}

TEST(MeshTest, TellsWhyItIsNoClosedSurface) {
  const Triangulation box = box_mesh({0.0, 0.0, 0.0}, {1.0, 2.0, 3.0});
  const auto fault = [&](const std::function<void(Triangulation&)>& change) {
    Triangulation changed = box;
    change(changed);
    return TriangleMesh::fault_of(changed.vertices, changed.triangles).value_or("");
  };
  EXPECT_EQ(fault([](Triangulation&) {}), "");
  EXPECT_EQ(fault([](Triangulation& t) { t.triangles.pop_back(); }),
            "the edge from (0, 0, 3) to (0, 2, 3) of triangle 1 belongs to no other triangle: the "
            "surface has a hole there");
  EXPECT_NE(fault([](Triangulation& t) {
              std::swap(t.triangles[4][0], t.triangles[4][1]);
            }).find("one of the two faces the other way"),
            std::string::npos);
  EXPECT_NE(fault([](Triangulation& t) {
              t.triangles.push_back(t.triangles[0]);
            }).find("belongs to 3 triangles"),
            std::string::npos);
  EXPECT_EQ(fault([](Triangulation& t) {
              for (auto& triangle : t.triangles) std::swap(triangle[0], triangle[1]);
            }),
            "the surface faces inwards: its volume comes out as -6 m³");
  EXPECT_EQ(fault([](Triangulation& t) { t.vertices[2][1] = std::nan(""); }),
            "a vertex is not finite");
  EXPECT_EQ(fault([](Triangulation& t) { t.triangles.clear(); }), "there is no triangle");
}

// A closed curve is the polygon of its points; an open one what lies below it, as far as it goes.
TEST(CurveTest, IsThePolygonOfItsPoints) {
  const std::vector<std::array<double, 2>> points{{-0.6, -0.5}, {0.7, -0.4}, {0.3, 0.1},
                                                  {0.8, 0.7},   {-0.2, 0.5}, {-0.9, 0.6}};
  for (const bool reversed : {false, true}) {
    auto ordered = points;
    if (reversed) std::reverse(ordered.begin(), ordered.end());
    const Solid curve{curve_of(ordered, true), false}, polygon{Polygon{ordered}, false};
    each_place(3000, 1.5, [&](const Position& x) {
      const Nearest a = nearest(curve, x), b = nearest(polygon, x);
      EXPECT_NEAR(a.distance, b.distance, 1e-15);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.normal[i], b.normal[i], 1e-13);
      for (const double radius : {0.1, 0.5})
        EXPECT_EQ(is_beyond(curve, x, radius), std::abs(b.distance) > radius);
    });
  }
}

TEST(CurveTest, AnOpenOneGoesOnLevel) {
  const Solid ground{curve_of({{-0.5, 0.4}, {0.0, -0.1}, {0.5, 0.2}}, false), false};
  const double far = 100.0;
  const Solid polygon{Polygon{{{-far, -far},
                               {far, -far},
                               {far, 0.2},
                               {0.5, 0.2},
                               {0.0, -0.1},
                               {-0.5, 0.4},
                               {-far, 0.4}}},
                      false};
  each_place(3000, 2.0, [&](const Position& x) {
    const Nearest a = nearest(ground, x), b = nearest(polygon, x);
    EXPECT_NEAR(a.distance, b.distance, 1e-14);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.normal[i], b.normal[i], 1e-12);
    EXPECT_EQ(holds(ground, x), b.distance < 0.0);
  });
}

// Points of a circle stand for what bends: 1/r but for the corners' jumps, of 2π/n over 2e.
TEST(CurveTest, BendsAsWhatItsPointsStandFor) {
  const int n = 720;
  std::vector<std::array<double, 2>> points;
  for (int k = 0; k < n; ++k)
    points.push_back({0.8 * std::cos(2.0 * pi * k / n), 0.8 * std::sin(2.0 * pi * k / n)});
  const Solid curve{curve_of(points, true), true}, ball{Ball{{}, 0.8}, true};
  const double e = 0.05;
  each_place(500, 0.56, [&](Position x) {
    x[2] = 0.0;
    const double r = std::hypot(x[0], x[1]);
    if (r < 0.5) return;
    const Bending S = bending(curve, x, e), T = bending(ball, x, e);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_NEAR(S[i][j], T[i][j], 2.0 * pi / n / e + e * e / (r * r * r));
  });
}

TEST(CurveTest, TellsWhatIsWrongWithItsPoints) {
  const auto fault = [](std::vector<std::array<double, 2>> points, bool closed) {
    const auto found = PolyLine::fault_of(points, closed);
    return found ? std::to_string(found->point) + ": " + found->what : std::string();
  };
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1, 1}}, true), "");
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1, 1}}, false), "");
  EXPECT_EQ(fault({{0, 0}}, false), "0: 1 point is too few: an open curve takes 2");
  EXPECT_EQ(fault({{0, 0}, {1, 1}}, true), "1: 2 points are too few: a closed curve takes 3");
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1, 0}, {1, 1}}, true),
            "2: the point (1, 0) is there twice in a row");
  EXPECT_EQ(fault({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, true),
            "2: the curve meets itself: from (0, 0) to (1, 1), and again from (1, 0) to (0, 1)");
  EXPECT_NE(fault({{0, 0}, {2, 0}, {1, 0}, {1, 1}}, true), "");          // turns back upon itself
  EXPECT_NE(fault({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}, true), "");  // touches itself
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {0.5, 1}}, false).substr(0, 26), "2: x falls from 1 to 0.5: ");
  EXPECT_NE(fault({{0, 0}, {0, 1}}, false), "");
  EXPECT_NE(fault({{0, 0}, {std::nan(""), 1}}, false), "");
  EXPECT_NE(fault(std::vector<std::array<double, 2>>(PolyLine::most_points + 1), false), "");
}

/// A box of 2 × 1.5 (× 1.2) m with a body; its points' sum of volumes.
class CutBodyTest : public testing::Test {
 protected:
  static Scene scene(bool space, double h = 0.05) {
    Scene scene = empty_box(2.0, 1.5, h);
    if (space) {
      scene.domain[2] = 1.2;
      scene.near = scene.far = {Wall::Kind::slip};
      scene.points_per_cell = 8;
    }
    Body body = block(0.0, 0.0, 1.0, 1.0, mu_i());
    scene.bodies = {body};
    return scene;
  }
  struct Filled {
    double volume = 0.0;
    Position centroid{};
    double largest = 0.0;  ///< share of a cell
  };
  template <int dim>
  static Filled filled(const Scene& scene) {
    validate(scene);
    const PointsOf<dim> points = fill<dim>(scene.bodies[0], scene, 0);
    using F = Layout<dim>;
    Filled sum;
    for (std::size_t n = 0; n < points.count; ++n) {
      const double volume = points[F::mass][n] / points[F::rho][n];
      sum.volume += volume;
      sum.largest = std::max(sum.largest, volume / std::pow(point_spacing(scene), dim));
      for (std::size_t k = 0; k < dim; ++k) sum.centroid[k] += volume * points[F::x + k][n];
    }
    for (double& x : sum.centroid) x /= sum.volume;
    return sum;
  }
  static void expect_whole(const char* what, const Filled& filled, double volume,
                           const Position& centroid, double digits, double place) {
    std::printf("[ measured ] %s: volume off by %.2g of it, centroid by %.2g m\n", what,
                std::abs(filled.volume / volume - 1.0),
                std::hypot(filled.centroid[0] - centroid[0], filled.centroid[1] - centroid[1],
                           filled.centroid[2] - centroid[2]));
    EXPECT_NEAR(filled.volume, volume, digits * volume) << what;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(filled.centroid[k], centroid[k], place) << what << " " << k;
    EXPECT_LT(filled.largest, 1.0 + place) << what;
  }
};

// Whatever cuts cells, their sum is the closed form's: thousands of cells, each to some roundings.
TEST_F(CutBodyTest, HasTheVolumeOfItsShape) {
  Scene plane = scene(false);
  Body& flat = plane.bodies[0];
  set_solid(flat, {Ball{{0.93, 0.71, 0.0}, 0.52}, false}, plane.domain);
  expect_whole("disc", filled<2>(plane), pi * 0.52 * 0.52, {0.93, 0.71, 0.0}, 1e-12, 1e-12);
  flat = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(flat, {HalfSpace{{0.0, 1.0, 0.0}, {1.0, 2.0, 0.0}}, false}, plane.domain);
  // y < 1 − x/2: a triangle of 2 × 1
  expect_whole("half-plane", filled<2>(plane), 1.0, {2.0 / 3.0, 1.0 / 3.0, 0.0}, 1e-12, 1e-12);
  flat = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(flat, {curve_of({{0.2, 0.2}, {1.7, 0.2}, {0.95, 1.1}}, true), false}, plane.domain);
  expect_whole("curve", filled<2>(plane), 0.5 * 1.5 * 0.9, {0.95, 0.5, 0.0}, 1e-12, 1e-12);

  Scene space = scene(true);
  Body& body = space.bodies[0];
  set_solid(body, {Ball{{0.93, 0.71, 0.6}, 0.52}, false}, space.domain);
  // places by 256 lines in a column, in volume scaled
  expect_whole("ball", filled<3>(space), 4.0 / 3.0 * pi * std::pow(0.52, 3), {0.93, 0.71, 0.6},
               1e-12, 1e-4);
  body = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(body, {Cylinder{{0.5, 0.4, 0.4}, {1.0, 0.5, 0.25}, 0.25, 0.9}, false}, space.domain);
  const double along = 0.45 / std::hypot(1.0, 0.5, 0.25);
  expect_whole("cylinder", filled<3>(space), pi * 0.25 * 0.25 * 0.9,
               {0.5 + along, 0.4 + 0.5 * along, 0.4 + 0.25 * along}, 1e-12, 1e-4);
  body = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(body, {HalfSpace{{0.0, 1.0, 0.0}, {1.0, 2.0, 0.0}}, false}, space.domain);
  expect_whole("half-space", filled<3>(space), 1.2, {2.0 / 3.0, 1.0 / 3.0, 0.6}, 1e-12, 1e-12);
  body = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(body, {HalfSpace{{0.3, 0.0, 0.0}, {1.0, 1.0, 1.0}}, false}, space.domain);
  expect_whole("corner", filled<3>(space), std::pow(0.3, 3) / 6.0, {0.075, 0.075, 0.075}, 1e-12,
               1e-12);
  body = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(body, {HalfSpace{{0.0, 0.5, 0.0}, {0.0, 1.0, 0.0}}, false}, space.domain);
  expect_whole("level", filled<3>(space), 1.2, {1.0, 0.25, 0.6}, 1e-12, 1e-12);
  body = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(body, box_mesh({0.4, 0.2, 0.2}, {1.13, 0.9, 0.87}, 0.3).solid(), space.domain);
  const double c = std::cos(0.3), s = std::sin(0.3);
  expect_whole("turned box", filled<3>(space), 0.73 * 0.7 * 0.67,
               {0.4 + c * 0.365 - s * 0.35, 0.2 + s * 0.365 + c * 0.35, 0.535}, 1e-12, 1e-12);
  body = block(0.0, 0.0, 1.0, 1.0, mu_i());
  const Solid sphere = sphere_mesh({0.9, 0.7, 0.6}, 0.55, 4).solid();
  set_solid(body, sphere, space.domain);
  expect_whole("sphere of triangles", filled<3>(space), std::get<Mesh>(sphere.shape).mesh->volume(),
               {0.9, 0.7, 0.6}, 1e-12, 1e-12);
}

// Shapes that cut a body and each other: exact where all are straight or round in the plane, and to
// what 256 lines in a column tell in space.
TEST_F(CutBodyTest, WithinAndWithout) {
  Scene plane = scene(false);
  Body& flat = plane.bodies[0];
  flat = block(0.31, 0.2, 1.0, 0.93, mu_i());
  flat.without = {{Polygon{{{0.5, 0.1}, {0.9, 0.5}, {0.5, 0.5}}}, false}};
  // the triangle loses its corner below y = 0.2, of 0.1 × 0.1
  expect_whole(
      "box without a triangle", filled<2>(plane), 0.93 - 0.08 + 0.005,
      [&] {
        Position sum{0.93 * 0.81, 0.93 * 0.665, 0.0};
        const auto take = [&](double area, double x, double y) {
          sum[0] -= area * x;
          sum[1] -= area * y;
        };
        take(0.08, 0.5 + 0.4 / 3.0, 0.5 - 0.4 / 3.0);
        take(-0.005, 0.5 + 0.1 / 3.0, 0.2 - 0.1 / 3.0);
        return Position{sum[0] / 0.855, sum[1] / 0.855, 0.0};
      }(),
      1e-12, 1e-12);
  flat = block(0.0, 0.0, 1.0, 1.0, mu_i());
  set_solid(flat, {Ball{{0.93, 0.71, 0.0}, 0.52}, false}, plane.domain);
  flat.without = {{Ball{{0.93, 0.71, 0.0}, 0.2}, false}};
  flat.within = {{HalfSpace{{0.0, 0.71, 0.0}, {0.0, 1.0, 0.0}}, false}};
  const double ring = 0.5 * pi * (0.52 * 0.52 - 0.2 * 0.2);
  expect_whole("half a ring", filled<2>(plane), ring,
               {0.93, 0.71 - 2.0 / 3.0 * (std::pow(0.52, 3) - std::pow(0.2, 3)) / ring, 0.0}, 1e-11,
               1e-11);
  // a lens: two circles of radius r whose middles are d apart
  flat = block(0.0, 0.0, 1.0, 1.0, mu_i());
  const double r = 0.5, d = 0.4;
  set_solid(flat, {Ball{{0.8, 0.7, 0.0}, r}, false}, plane.domain);
  flat.within = {{Ball{{0.8 + d, 0.7, 0.0}, r}, false}};
  expect_whole("lens", filled<2>(plane),
               2.0 * r * r * std::acos(0.5 * d / r) - 0.5 * d * std::sqrt(4.0 * r * r - d * d),
               {0.8 + 0.5 * d, 0.7, 0.0}, 1e-11, 1e-11);

  Scene space = scene(true);
  Body& body = space.bodies[0];
  body.origin = {0.4, 0.2, 0.1};
  body.size = {1.0, 0.8, 1.0};
  body.without = {{Cylinder{{0.9, 0.0, 0.6}, {0.0, 1.0, 0.0}, 0.3}, false}};
  expect_whole("box with a bore", filled<3>(space), 0.8 * (1.0 - pi * 0.09), {0.9, 0.6, 0.6}, 1e-3,
               1e-3);
  body.without.clear();
  body.within = {{Ball{{0.9, 0.6, 0.6}, 0.45}, false}};
  body.origin[1] = 0.1;
  body.size[1] = 0.5;
  expect_whole("half a ball", filled<3>(space), 2.0 / 3.0 * pi * std::pow(0.45, 3),
               {0.9, 0.6 - 3.0 / 8.0 * 0.45, 0.6}, 1e-3, 1e-3);
}

TEST_F(CutBodyTest, BodiesThatOverlapAreFound) {
  Scene plane = scene(false);
  Body ball = plane.bodies[0];
  set_solid(ball, {Ball{{0.9, 0.7, 0.0}, 0.4}, false}, plane.domain);
  plane.bodies[0] = block(0.2, 0.1, 1.4, 1.2, mu_i());
  plane.bodies[0].without = {{Ball{{0.9, 0.7, 0.0}, 0.4}, false}};
  plane.bodies.push_back(ball);
  validate(plane);  // it fills the hole
  std::get<Ball>(plane.bodies[0].without[0].shape).radius = 0.35;
  try {
    validate(plane);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "body[1].shape");
    EXPECT_NE(std::string(error.what()).find("overlaps body[0]"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace repose::mpm
