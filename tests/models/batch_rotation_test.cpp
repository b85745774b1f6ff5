/// \file
/// What every law must fulfil as a Material where points turn.

#include <Eigen/Geometry>

#include "tests/models/batch_columns.hpp"

namespace repose {
namespace {

template <class C>
class BatchRotation : public ::testing::Test {};
TYPED_TEST_SUITE(BatchRotation, CasesOf<AllLaws>::Types, CaseName);

Eigen::Matrix3d matrix(const Sym<double, 6>& a) {
  Eigen::Matrix3d m;
  m << a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2];
  return m;
}

TYPED_TEST(BatchRotation, FullTurnKeepsTheInvariants) {
  using L = typename TypeParam::Law;
  constexpr bool plane = TypeParam::components == 4;
  const double turn = 2.0 * std::acos(-1.0);
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    for (const int steps : {100, 1000}) {
      Random random(25);
      Columns<TypeParam> columns(pack_size);
      std::vector<LawPoint<L>> start;
      std::vector<Eigen::Vector3d> axes;
      for (std::size_t i = 0; i < pack_size; ++i) {
        LawPoint<L> point = random_point<L>(example, P, random, plane);
        for (int settle = 0; settle < 5; ++settle)  // no viscous stress left to die away
          ASSERT_FALSE(point.step(P, Sym<double, 6>::isotropic(0.0), 1e6 * example.time));
        start.push_back(point);
        axes.push_back(
            plane ? Eigen::Vector3d::UnitZ()
                  : Eigen::Vector3d(random(-1, 1), random(-1, 1), random(-1, 1)).normalized());
        const Eigen::Vector3d angle = turn / steps * axes.back();
        columns.set(i, point, Sym<double, 6>::isotropic(0.0), {angle[0], angle[1], angle[2]});
      }
      for (int step = 0; step < steps; ++step)
        ASSERT_TRUE(material->update(columns.batch(example.time)).ok());
      for (std::size_t i = 0; i < pack_size; ++i) {
        const Sym<double, 6> before = start[i].stress;
        const Sym<double, 6> after = columns.point(i).stress;
        // a step's rotation matrix is orthogonal to 8 ε at most and the update rounds 4 times (in
        // space 12: two products of matrices with sums of three)
        const double tolerance = (plane ? 16.0 : 24.0) * epsilon * steps * largest(before);
        EXPECT_NEAR(pressure(after), pressure(before), tolerance) << example.label;
        EXPECT_NEAR(mises(after), mises(before), 2.0 * tolerance) << example.label;
        // A stress on its yield surface may be turned out of it by that much: where that flows, the
        // hardening follows, d ln p_c = d ln p at most.
        const double flow = requires { L::rate_dependent; }
        ? 2.0 * tolerance / pressure(before) : 0.0;
        for (std::size_t k = 0; k < L::state.size(); ++k)
          EXPECT_NEAR(columns.point(i).state[k], start[i].state[k], flow * start[i].state[k])
              << example.label;
        EXPECT_EQ(columns.density[i], start[i].density);
        if (!L::has_stress_memory) continue;
        // Cayley's rotation turns by 2 atan(θ/2) in a step: short of a full turn by this angle
        const double angle = steps * 2.0 * std::atan(0.5 * turn / steps);
        const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, axes[i]).toRotationMatrix();
        const Eigen::Matrix3d expected = R * matrix(before) * R.transpose();
        EXPECT_LT((matrix(after) - expected).cwiseAbs().maxCoeff(), 4.0 * tolerance)
            << example.label;
      }
    }
  }
}

// A plane rotation and strain in space is what plane strain does.
template <class L>
class PlaneInSpace : public ::testing::Test {};
TYPED_TEST_SUITE(PlaneInSpace, LawTypes, LawName);
TYPED_TEST(PlaneInSpace, IsPlaneStrain) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    Random random(26);
    for (int sample = 0; sample < 50; ++sample) {
      Columns<Case<L, 4>> plane(pack_size);
      Columns<Case<L, 6>> space(pack_size);
      std::vector<Task<Case<L, 4>>> tasks;
      for (std::size_t i = 0; i < pack_size; ++i) {
        tasks.push_back(Task<Case<L, 4>>::random(example, P, random));
        tasks[i].spin[0] = tasks[i].spin[1] = 0.0;
        plane.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
        space.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
      }
      ASSERT_TRUE(material->update(plane.batch(example.time)).ok());
      ASSERT_TRUE(material->update(space.batch(example.time)).ok());
      for (std::size_t i = 0; i < pack_size; ++i) {
        const LawPoint<L> p = plane.point(i), s = space.point(i);
        // the two rotations round differently, 8 ε each, which the tangent magnifies at most as it
        // does the stress itself
        const double tolerance =
            64.0 * epsilon * stress_scale(P, tasks[i].point, p, tasks[i].strain);
        for (int k = 0; k < 6; ++k)
          EXPECT_NEAR(s.stress[k], p.stress[k], tolerance) << example.label << " " << k;
        EXPECT_EQ(s.density, p.density);
      }
    }
  }
}

}  // namespace
}  // namespace repose
