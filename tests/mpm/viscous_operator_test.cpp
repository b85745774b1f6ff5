/// The viscous operator by itself: symmetric, positive, blind to rigid motion, and the derivative
/// of the law's impulse.
#include "mpm/step/viscous_operator.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.125;
constexpr double dt = 0.01;
constexpr int nx = 24, ny = 16;
constexpr double epsilon = 2.2e-16;

/// Points of one viscous body anywhere in the box, in motion, with the masses of the nodes.
class Patch {
 public:
  Patch(const LawSpec& law, Kernel kernel, const Walls& walls, unsigned seed = 5)
      : random_(seed),
        kernel_(kernel),
        walls_(walls),
        grid_(h, nx, ny),
        arena_(2) {
    PointSet points;
    points.material = make_material(law);
    points.force_stress = {STATE, STATE, STATE + 1};
    points.fields = STATE + split_fields;
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (std::size_t k = 0; k < 600; ++k) {
      for (std::size_t f = 0; f < points.fields; ++f) points.field[f].push_back(0.0);
      points.field[X].back() = nx * h * share(random_);
      points.field[Y].back() = ny * h * share(random_);
      points.field[RHO].back() = 1310.0 + 20.0 * share(random_);  // under pressure
      points.field[MASS].back() = 1.0 + share(random_);
      points.id.push_back(static_cast<std::int64_t>(k));
      ++points.count;
    }
    bodies_.push_back(std::move(points));
    grid_.sort(bodies_);
    for (const std::size_t s : slots())
      stencil(s, [&](NodeBlock& node, std::size_t at, double w, double, double) {
        node.mass[at] += w * bodies_[0][MASS][s];
      });
  }

  PointSet& points() { return bodies_[0]; }
  std::vector<std::size_t> slots() {
    std::vector<std::size_t> found;
    for (std::size_t s = 0; s < points().slots(); ++s)
      if (points().id[s] >= 0) found.push_back(s);
    return found;
  }
  ViscousOperator& prepare() {
    op_.prepare(grid_, bodies_, walls_, kernel_, dt, arena_);
    return op_;
  }
  /// Calls f(x, y of the node) for all live nodes.
  template <class F>
  NodeVector field(F&& f) {
    NodeVector v(grid_.node_blocks.size());
    for (const std::size_t k : op_.live())
      for (int n = 0; n < block_nodes; ++n) {
        const std::array<double, 2> at =
            f((Grid::first_x(grid_.node_blocks[k].at[0]) + n % block_nx) * h,
              (Grid::first_y(grid_.node_blocks[k].at[1]) + n / block_nx) * h);
        v[k].x[static_cast<std::size_t>(n)] = at[0];
        v[k].y[static_cast<std::size_t>(n)] = at[1];
      }
    op_.mirror().extend(v);
    return v;
  }
  NodeVector noise() {
    std::normal_distribution<double> any;
    return field([&](double, double) { return std::array{any(random_), any(random_)}; });
  }
  NodeVector zero() const { return NodeVector(grid_.node_blocks.size()); }

  /// D at a point as (xx, yy, xy), from the definition L = Σ w v d ᵀ D⁻¹.
  std::array<double, 3> strain(std::size_t slot, const NodeVector& v) {
    const double inv_D = (kernel_ == Kernel::cubic ? 3.0 : 4.0) / (h * h);
    std::array<double, 3> D{};
    stencil(slot, [&](NodeBlock& node, std::size_t at, double w, double dx, double dy) {
      const NodeField& here = v[static_cast<std::size_t>(&node - grid_.node_blocks.data())];
      D[0] += w * inv_D * here.x[at] * dx;
      D[1] += w * inv_D * here.y[at] * dy;
      D[2] += 0.5 * w * inv_D * (here.x[at] * dy + here.y[at] * dx);
    });
    return D;
  }

 private:
  template <class F>
  void stencil(std::size_t s, F&& f) {
    kernel_ == Kernel::cubic ? stencil_of<CubicKernel>(s, f) : stencil_of<QuadraticKernel>(s, f);
  }
  template <class K, class F>
  void stencil_of(std::size_t s, F& f) {
    const double x = points()[X][s], y = points()[Y][s];
    const double first_x = K::anchor(x / h) - 1.0, first_y = K::anchor(y / h) - 1.0;
    const auto wx = K::weights(x / h - first_x - 1.0), wy = K::weights(y / h - first_y - 1.0);
    for (std::size_t j = 0; j < K::rows; ++j)
      for (std::size_t i = 0; i < K::rows; ++i) {
        const double node_x = first_x + static_cast<double>(i);
        const double node_y = first_y + static_cast<double>(j);
        const Grid::NodeRef node = grid_.node(static_cast<int>(node_x), static_cast<int>(node_y));
        f(*node.block, node.place, wx[i] * wy[j], node_x * h - x, node_y * h - y);
      }
  }

  std::mt19937_64 random_;
  Kernel kernel_;
  Walls walls_;
  Grid grid_;
  tbb::task_arena arena_;
  std::vector<PointSet> bodies_;
  ViscousOperator op_;
};

double dot(const NodeVector& a, const NodeVector& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t n = 0; n < block_nodes; ++n)
      sum += a[k].x[n] * b[k].x[n] + a[k].y[n] * b[k].y[n];
  return sum;
}
double norm(const NodeVector& a) { return std::sqrt(dot(a, a)); }
NodeVector sum(const NodeVector& a, double f, const NodeVector& b) {
  NodeVector c = a;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t n = 0; n < block_nodes; ++n) {
      c[k].x[n] += f * b[k].x[n];
      c[k].y[n] += f * b[k].y[n];
    }
  return c;
}

const Walls open{{Wall::Kind::open}, {Wall::Kind::open}, {Wall::Kind::open}, {Wall::Kind::open}};
const Walls box{{Wall::Kind::slip}, {Wall::Kind::slip}, {Wall::Kind::no_slip}, {Wall::Kind::slip}};
const LawSpec fluid = newtonian(7.0, 1e5, 1.0, 1300.0);
LawSpec grains() {
  LawSpec law = mu_i(254800.0, "regularised");
  law.values["r"] = 0.5;
  return law;
}

class ViscousOperatorTest : public ::testing::TestWithParam<Kernel> {};

// (a, Kb) = Δt Σ V 2η D′(a):D′(b), from the definition, with walls too; hence symmetric and
// positive.
TEST_P(ViscousOperatorTest, IsTheViscousPowerOfTwoFields) {
  for (const Walls& walls : {open, box}) {
    Patch patch(fluid, GetParam(), walls);
    ViscousOperator& op = patch.prepare();
    const NodeVector a = patch.noise(), b = patch.noise();
    NodeVector Ka = patch.zero(), Kb = patch.zero(), f = patch.zero();
    op.impulse(a, f);
    op.linearise();
    op.apply(a, Ka);
    op.apply(b, Kb);
    double power[3] = {0.0, 0.0, 0.0};  // aa, bb, ab
    for (const std::size_t s : patch.slots()) {
      const double V = patch.points()[MASS][s] / patch.points()[RHO][s];
      const auto D = patch.strain(s, a), E = patch.strain(s, b);
      const auto contract_deviators = [](const auto& x, const auto& y) {
        return x[0] * y[0] + x[1] * y[1] + 2.0 * x[2] * y[2] - (x[0] + x[1]) * (y[0] + y[1]) / 3.0;
      };
      const double factor = dt * V * 2.0 * 7.0;
      power[0] += factor * contract_deviators(D, D);
      power[1] += factor * contract_deviators(E, E);
      power[2] += factor * contract_deviators(D, E);
    }
    // sums of 600 points × 16 nodes, each to a few eps of (aKa bKb)^½
    const double round_off = 1e4 * epsilon * std::sqrt(power[0] * power[1]);
    EXPECT_NEAR(dot(a, Ka), power[0], 1e4 * epsilon * power[0]);
    EXPECT_NEAR(dot(a, Kb), power[2], round_off);
    EXPECT_NEAR(dot(b, Ka), dot(a, Kb), round_off);
    // a fluid's impulse is linear
    EXPECT_LT(norm(sum(f, -1.0, Ka)), 1e4 * epsilon * norm(Ka));
  }
}

// v = V + ω × x has D = 0 to round-off: eps of |v|/h in each strain.
TEST_P(ViscousOperatorTest, DoesNotFeelRigidMotion) {
  Patch patch(fluid, GetParam(), open);
  ViscousOperator& op = patch.prepare();
  const NodeVector rigid = patch.field([](double x, double y) {
    return std::array{1.0 - 2.0 * y, -3.0 + 2.0 * x};
  });
  const NodeVector shear = patch.field([](double x, double y) {
    return std::array{2.0 * y, 2.0 * x};
  });
  NodeVector f = patch.zero(), g = patch.zero();
  op.impulse(rigid, f);
  op.impulse(shear, g);
  EXPECT_GT(norm(g), 0.0);
  // |v| <= 10, |v|/h = 80 against strains of 2: 40 eps, and a few terms
  EXPECT_LT(norm(f), 1e3 * epsilon * norm(g));
}

TEST_P(ViscousOperatorTest, DiagonalIsThatOfTheMatrix) {
  Patch patch(grains(), GetParam(), open);
  ViscousOperator& op = patch.prepare();
  const NodeVector v = patch.noise();
  NodeVector f = patch.zero(), d = patch.zero();
  op.impulse(v, f);
  op.linearise();
  op.diagonal(d);
  const std::size_t k = op.live()[op.live().size() / 2];
  for (std::size_t n = 0; n < block_nodes; ++n)
    for (const bool y : {false, true}) {
      NodeVector unit = patch.zero(), column = patch.zero();
      (y ? unit[k].y : unit[k].x)[n] = 1.0;
      op.apply(unit, column);
      const double expected = (y ? column[k].y : column[k].x)[n];
      EXPECT_NEAR((y ? d[k].y : d[k].x)[n], expected, 1e3 * epsilon * expected);
    }
}

// Where the points' stress is that of their strain, the tangent is the derivative of the impulse.
TEST_P(ViscousOperatorTest, TangentIsTheDerivativeOfTheImpulse) {
  Patch patch(grains(), GetParam(), open);
  ViscousOperator& op = patch.prepare();
  const NodeVector v = patch.field([](double x, double y) {
    return std::array{0.9 * x + 1.6 * y, 0.4 * x - 0.7 * y};
  });
  PointSet& points = patch.points();
  // the law's own stress at D = (0.9, −0.7, 1.0)
  std::vector<double> D[4], eta(points.slots()), thinning(points.slots());
  for (int c = 0; c < 4; ++c)
    D[c].assign(points.slots(), std::array{0.9, -0.7, 0.0, 1.0}[static_cast<std::size_t>(c)]);
  Batch batch = points.batch({0, points.slots()});
  batch.dt = 1.0;
  batch.strain = {D[0].data(), D[1].data(), D[2].data(), D[3].data()};
  points.material->viscosity(batch, eta.data(), thinning.data());
  for (std::size_t s = 0; s < points.slots(); ++s) {
    const double m = (0.9 - 0.7) / 3.0, p = 100.0;
    points.field[STATE][s] = -p;
    points.field[SXX][s] = -p + 2.0 * eta[s] * (0.9 - m);
    points.field[SYY][s] = -p + 2.0 * eta[s] * (-0.7 - m);
    points.field[SZZ][s] = -p - 2.0 * eta[s] * m;
    points.field[SXY][s] = 2.0 * eta[s] * 1.0;
    points.field[LXX][s] = 0.9;
    points.field[LXY][s] = 1.6;
    points.field[LYX][s] = 0.4;
    points.field[LYY][s] = -0.7;
    EXPECT_GT(thinning[s], 0.3) << "far from linear";
  }
  patch.prepare();
  NodeVector f = patch.zero(), before = patch.zero(), after = patch.zero(), tangent = patch.zero();
  op.state_of_points();
  op.linearise();
  // linear from the state of the points, and their state is v's
  op.linear_impulse(v, f);
  op.impulse(v, after);
  EXPECT_LT(norm(sum(f, -1.0, after)), 1e4 * epsilon * norm(f));
  op.state_of_points();
  op.linearise();
  const NodeVector w = patch.noise();
  op.apply(w, tangent);
  EXPECT_GT(dot(w, tangent), 0.0);
  // central difference: strains of w are of order 10, a change of 1e-5 in 1: (1e-5)² and eps/1e-6;
  // the law's own slope has 1e-8
  const double small = 1e-6;
  op.impulse(sum(v, small, w), after);
  op.impulse(sum(v, -small, w), before);
  const NodeVector difference = sum(after, -1.0, before);
  NodeVector expected = patch.zero();
  expected = sum(expected, 1.0 / (2.0 * small), difference);
  EXPECT_LT(norm(sum(tangent, -1.0, expected)), 1e-7 * norm(tangent));
}

// Whatever stress the points still have from before, the tangent is symmetric and positive.
TEST_P(ViscousOperatorTest, TangentIsPositiveForAnyStress) {
  Patch patch(grains(), GetParam(), box);
  std::mt19937_64 random(3);
  std::normal_distribution<double> any;
  for (std::size_t s = 0; s < patch.points().slots(); ++s)
    for (const Field f : {SXX, SYY, SXY}) patch.points().field[f][s] = 1e4 * any(random);
  ViscousOperator& op = patch.prepare();
  NodeVector f = patch.zero(), Ka = patch.zero(), Kb = patch.zero();
  op.impulse(patch.noise(), f);
  op.linearise();
  for (int k = 0; k < 20; ++k) {
    const NodeVector a = patch.noise(), b = patch.noise();
    op.apply(a, Ka);
    op.apply(b, Kb);
    const double aa = dot(a, Ka), bb = dot(b, Kb);
    EXPECT_GT(aa, 0.0);
    EXPECT_NEAR(dot(b, Ka), dot(a, Kb), 1e4 * epsilon * std::sqrt(aa * bb));
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, ViscousOperatorTest,
                         ::testing::Values(Kernel::cubic, Kernel::quadratic),
                         [](const auto& kernel) {
                           return kernel.param == Kernel::cubic ? "cubic" : "quadratic";
                         });

}  // namespace
}  // namespace repose::mpm
