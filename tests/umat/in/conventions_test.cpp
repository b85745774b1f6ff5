/// What a UMAT is called with, and what becomes of its answer, in batches of points.
#include <cmath>
#include <numbers>
#include <thread>

#include "models/objective.hpp"
#include "tests/umat/in/umat_fixture.hpp"
#include "umat/in/wave_modulus.hpp"

namespace repose::umat {
namespace {

constexpr double E = 1e7;

/// Positions in STATEV of recording.c.
enum Recorded : std::size_t {
  r_stress = 0,
  r_stran = 6,
  r_dstran = 12,
  r_drot = 18,
  r_time = 27,
  r_dtime = 29,
  r_ndi,
  r_nshr,
  r_ntens,
  r_nstatv,
  r_nprops,
  r_noel,
  r_npt,
  r_kinc,
  r_kstep,
  r_length,
  r_name,
  r_pnewdt,
  r_deformation,
  r_rest,
  recorded
};

/// Points in columns, each with numbers of its own.
template <int N>
struct Points {
  std::size_t count;
  std::vector<std::vector<double>> stress, strain, spin, state, out;
  std::vector<double> density;

  Points(std::size_t n, std::size_t states) : count(n) {
    const auto columns = [&](std::size_t k, double scale, double offset) {
      std::vector<std::vector<double>> all(k, std::vector<double>(padded(n)));
      for (std::size_t c = 0; c < k; ++c)
        for (std::size_t i = 0; i < padded(n); ++i)
          all[c][i] = offset + scale * std::sin(1.0 + static_cast<double>(7 * c) +
                                                static_cast<double>(std::min(i, n - 1)));
      return all;
    };
    stress = columns(N, 1e4, 0.0);
    for (int c = 0; c < 3; ++c)
      for (double& x : stress[static_cast<std::size_t>(c)]) x -= 1e5;
    strain = columns(N, 1e-3, 0.0);
    spin = columns(N == 4 ? 1 : 3, 0.1, 0.0);
    state = std::vector<std::vector<double>>(states, std::vector<double>(padded(n), 0.0));
    out = columns(7, 0.0, -77.0);
    density.assign(padded(n), 2000.0);
  }
  BatchOf<N> batch(double dt) {
    BatchOf<N> b;
    b.count = count;
    b.dt = dt;
    for (std::size_t c = 0; c < stress.size(); ++c) b.stress[c] = stress[c].data();
    for (std::size_t c = 0; c < strain.size(); ++c) b.strain[c] = strain[c].data();
    for (std::size_t c = 0; c < spin.size(); ++c) b.spin[c] = spin[c].data();
    for (std::size_t c = 0; c < state.size(); ++c) b.state[c] = state[c].data();
    b.density = density.data();
    b.work = out[0].data();
    b.plastic = out[1].data();
    b.viscous = out[2].data();
    b.hypoelastic = out[3].data();
    b.separation = out[4].data();
    b.modulus = out[5].data();
    b.viscosity = out[6].data();
    return b;
  }
  Sym<double, N> tensor(const std::vector<std::vector<double>>& of, std::size_t i,
                        std::size_t first = 0) const {
    Sym<double, N> t;
    for (int c = 0; c < N; ++c) t[c] = of[first + static_cast<std::size_t>(c)][i];
    return t;
  }
  Sym<double, N> rotate(const Sym<double, N>& t, std::size_t i) const {
    if constexpr (N == 4)
      return rotated_in_plane(t, spin[0][i]);
    else
      return rotated(t, {spin[0][i], spin[1][i], spin[2][i]});
  }
};

Description recording() {
  Description d = describe(RECORDING, 2, recorded);
  d.library.cmname = "SAND";
  return d;
}

template <int N>
void see_arguments() {
  const TestLaw law = make_law(recording(), {E, 3.0});
  const auto material = make_material(law.spec);
  Points<N> points(5, law.info->state.size());
  const Points<N> before = points;
  ASSERT_TRUE(material->update(points.batch(0.01)).ok());
  const Points<N> between = points;
  ASSERT_TRUE(material->update(points.batch(0.02)).ok());
  constexpr std::array<std::size_t, 6> place{0, 1, 2, 3, 5, 4};  // xx, yy, zz, xy, yz, zx
  const double eps = std::numeric_limits<double>::epsilon();
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto said = [&](std::size_t k) { return points.state[k][i]; };
    const auto dstrain = before.tensor(before.strain, i);
    const auto stress = points.rotate(between.tensor(between.stress, i), i);
    const auto stran = points.rotate(dstrain, i);  // of the first step, carried along
    for (int c = 0; c < N; ++c) {
      const auto C = static_cast<std::size_t>(c);
      EXPECT_EQ(said(r_stress + place[C]), stress[c]) << "rotated before the call";
      EXPECT_EQ(said(r_stran + place[C]), (c < 3 ? 1.0 : 2.0) * stran[c]);
      EXPECT_EQ(said(r_dstran + place[C]), (c < 3 ? 1.0 : 2.0) * dstrain[c]);
    }
    // DROT turns a stress as the stress is turned
    double R[3][3], s[3][3];
    const auto old = between.tensor(between.stress, i);
    const int index[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        R[a][b] = said(r_drot + static_cast<std::size_t>(a + 3 * b));
        s[a][b] = index[a][b] < N ? old[index[a][b]] : 0.0;
      }
    for (int a = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b) {
        double turned = 0.0;
        for (int k = 0; k < 3; ++k)
          for (int l = 0; l < 3; ++l) turned += R[a][k] * s[k][l] * R[b][l];
        const double expected = index[a][b] < N ? stress[index[a][b]] : 0.0;
        EXPECT_NEAR(turned, expected, 20 * eps * 1e5);  // nine products of 1e5 Pa
      }
    EXPECT_EQ(said(r_time), 0.01);
    EXPECT_EQ(said(r_time + 1), 0.01);
    EXPECT_EQ(said(r_dtime), 0.02);
    EXPECT_EQ(said(r_ndi), 3);
    EXPECT_EQ(said(r_nshr), N - 3);
    EXPECT_EQ(said(r_ntens), N);
    EXPECT_EQ(said(r_nstatv), static_cast<double>(recorded));
    EXPECT_EQ(said(r_nprops), 2);
    EXPECT_EQ(said(r_noel), 1);
    EXPECT_EQ(said(r_npt), 1);
    EXPECT_EQ(said(r_kinc), 2);
    EXPECT_EQ(said(r_kstep), 1);
    EXPECT_EQ(said(r_length), 80);
    EXPECT_EQ(said(r_name), 1) << "CMNAME, filled up with blanks";
    EXPECT_EQ(said(r_pnewdt), 1);
    EXPECT_EQ(said(r_deformation), 3) << "DFGRD0 and DFGRD1 are the identity";
    EXPECT_EQ(said(r_rest), 1) << "TEMP, DTEMP, CELENT";
    // the answer: σ + E Δε, shear by γ E/2 = E ε
    const auto now = points.tensor(points.stress, i);
    double work = 0.0;
    for (int c = 0; c < N; ++c) {
      EXPECT_NEAR(now[c], stress[c] + E * dstrain[c], 2 * eps * 1e5);
      work += (c < 3 ? 1.0 : 2.0) * 0.5 * (now[c] + stress[c]) * dstrain[c];
    }
    EXPECT_NEAR(points.out[0][i], work, 20 * eps * 1e3);
    EXPECT_EQ(points.out[1][i], points.out[0][i]) << "no SSE: all work counts as not stored";
    for (const std::size_t k : {2u, 3u, 4u, 6u}) EXPECT_EQ(points.out[k][i], 0.0);
    // ν = 0: K = E/3, G = E/2, K + 4/3 G = E; the eigenvalues of a 6×6 to some ε
    EXPECT_NEAR(points.out[5][i], E, 100 * eps * E);
    EXPECT_NEAR(points.density[i], 2000.0 * std::exp(-2.0 * trace(dstrain)), 10 * eps * 2000.0);
  }
}

TEST(UmatConventions, PlaneStrainHasFourComponents) { see_arguments<4>(); }
TEST(UmatConventions, SpaceHasSix) { see_arguments<6>(); }

TEST(UmatBatch, LongerThanAnExchangeIsTheSameAsPointByPointFromAnyThread) {
  const TestLaw law = make_law(recording(), {E, 3.0});
  const auto material = make_material(law.spec);
  constexpr std::size_t n = 3 * exchange_capacity + 5;
  Points<4> together(n, law.info->state.size());
  Points<4> one_by_one = together;
  ASSERT_TRUE(material->update(together.batch(0.01)).ok());
  const auto update = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      Points<4> single(1, law.info->state.size());
      const auto copy = [&](auto& into, const auto& of) {
        for (std::size_t c = 0; c < of.size(); ++c)
          std::fill(into[c].begin(), into[c].end(), of[c][i]);
      };
      copy(single.stress, one_by_one.stress);
      copy(single.strain, one_by_one.strain);
      copy(single.spin, one_by_one.spin);
      ASSERT_TRUE(material->update(single.batch(0.01)).ok());
      for (std::size_t c = 0; c < 4; ++c) one_by_one.stress[c][i] = single.stress[c][0];
      for (std::size_t c = 0; c < one_by_one.state.size(); ++c)
        one_by_one.state[c][i] = single.state[c][0];
    }
  };
  std::thread other(update, 0, n / 2);
  update(n / 2, n);
  other.join();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(together.stress[c][i], one_by_one.stress[c][i]);
    for (std::size_t c = 0; c < together.state.size(); ++c)
      EXPECT_EQ(together.state[c][i], one_by_one.state[c][i]);
  }
  for (std::size_t i = n; i < padded(n); ++i)
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(together.stress[c][i], together.stress[c][n - 1]);
}

TEST(UmatBatch, LeavesThePointsAloneWhereTheLibraryFails) {
  const TestLaw law = make_law(MISBEHAVING, {7.0, 1.0}, 1);  // a null pointer, at once
  const auto material = make_material(law.spec);
  Points<4> points(20, law.info->state.size());
  const Points<4> before = points;
  const UpdateReport report = material->update(points.batch(0.01));
  EXPECT_EQ(report.failed, 0u);
  EXPECT_NE(report.reason.find("SIGSEGV"), std::string::npos) << report.reason;
  EXPECT_EQ(points.stress, before.stress);
  EXPECT_EQ(points.state, before.state);
  EXPECT_EQ(points.density, before.density);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ(points.out[k], std::vector<double>(padded(20), 0.0));
}

TEST(UmatBatch, ReportsAPointThatIsNotANumber) {
  const TestLaw law = make_law(recording(), {E, 3.0});
  const auto material = make_material(law.spec);
  Points<4> points(20, law.info->state.size());
  points.strain[1][13] = std::nan("");
  const Points<4> before = points;
  EXPECT_EQ(material->update(points.batch(0.01)).failed, 13u);
  EXPECT_EQ(points.stress, before.stress);
}

// PNEWDT < 1 in a batch: the increment is gone through in parts. half_increments (15) takes 1e-4 at
// most, and answers elastically: the parts add up to round-off.
TEST(UmatBatch, CutsIncrementsThatAreTooLarge) {
  const TestLaw law = make_law(MISBEHAVING, {15.0, 0.0}, 1);
  const auto material = make_material(law.spec);
  Points<4> points(3, law.info->state.size());
  const Points<4> before = points;
  ASSERT_TRUE(material->update(points.batch(0.01)).ok());
  for (std::size_t i = 0; i < 3; ++i) {
    const auto start = before.rotate(before.tensor(before.stress, i), i);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(points.tensor(points.stress, i)[c],
                  start[c] + E * before.strain[static_cast<std::size_t>(c)][i], 1e-13 * 1e5 * 32);
    EXPECT_NEAR(points.state[0][i], 0.01, 1e-15) << "time passes once";
  }
  const TestLaw never = make_law(MISBEHAVING, {11.0, 0.0}, 1);
  Points<4> stuck(3, never.info->state.size());
  const UpdateReport report = make_material(never.spec)->update(stuck.batch(0.01));
  EXPECT_NE(report.reason.find("PNEWDT"), std::string::npos) << report.reason;
}

// Of an isotropic tangent it is K + 4/3 G to round-off; no plane wave of any tangent is faster:
// n⊗m : D : n⊗m over a fan of directions, for a sheared, unsymmetric one.
TEST(WaveModulus, BoundsEveryPlaneWave) {
  const double K = 3e7, G = 1e7;
  std::array<double, 36> D{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      D[j * 6 + i] = i < 3 && j < 3 ? K - 2.0 / 3.0 * G + (i == j ? 2.0 * G : 0.0)
                     : i == j       ? G
                                    : 0.0;
  EXPECT_NEAR(wave_modulus<6>(D.data()), K + 4.0 / 3.0 * G, 1e-12 * K);
  for (std::size_t k = 0; k < 36; ++k) D[k] += 4e6 * std::sin(static_cast<double>(3 * k * k));
  const double bound = wave_modulus<6>(D.data());
  constexpr std::array<std::array<std::size_t, 3>, 3> at{{{0, 3, 4}, {3, 1, 5}, {4, 5, 2}}};
  double most = 0.0;
  for (int a = 0; a < 24; ++a)
    for (int b = 0; b < 24; ++b) {
      const double u = std::numbers::pi * a / 24.0, w = std::numbers::pi * b / 24.0;
      const std::array<double, 3> n{std::sin(u) * std::cos(w), std::sin(u) * std::sin(w),
                                    std::cos(u)};
      for (const auto& m :
           {n, std::array{std::cos(u) * std::cos(w), std::cos(u) * std::sin(w), -std::sin(u)}}) {
        std::array<double, 6> strain{}, weight{};
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) {
            strain[at[i][j]] += 0.5 * (n[i] * m[j] + n[j] * m[i]);  // γ for a shear, summed twice
            weight[at[i][j]] += n[i] * m[j];
          }
        double form = 0.0;
        for (std::size_t i = 0; i < 6; ++i)
          for (std::size_t j = 0; j < 6; ++j) form += weight[i] * D[j * 6 + i] * strain[j];
        most = std::max(most, form);
      }
    }
  EXPECT_LE(most, bound);
  EXPECT_GT(most, 0.7 * bound) << "and it is not far off";
}

TEST(UmatStart, TakesVoidRatioDensityAndStress) {
  Description d = recording();
  d.initial_statev[3] = 0.25;
  d.void_ratio_statev = 1;
  TestLaw law = make_law(d, {E, 3.0}, 1700.0);
  const auto material = make_material(law.spec);
  InitialConditions given;
  given.p = 2e5;
  given.K0 = 0.5;
  given.v = 1.7;
  const InitialPoint point = material->initial(given);
  EXPECT_NEAR(point.state[0], 0.7, 1e-15);
  EXPECT_EQ(point.state[3], 0.25);
  EXPECT_EQ(point.density, 1700.0);
  EXPECT_NEAR(point.stress[1], -3e5, 1e-9);  // p = σ_v (1 + 2 K0)/3
  EXPECT_NEAR(point.stress[0], -1.5e5, 1e-9);
  EXPECT_EQ(material->density_at(1e6, 1.0), 1700.0);
  given.ocr = 2.0;
  EXPECT_THROW(material->initial(given), InputError);

  law.spec.values.erase(std::string(density_name));
  given.ocr.reset();
  try {
    make_material(law.spec)->initial(given);
    ADD_FAILURE() << "no density, and no complaint";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "rho_0");
  }
  d.void_ratio_statev = static_cast<int>(recorded) + 1;
  EXPECT_THROW(make_known(d), InputError);
  d.void_ratio_statev = 0;
  d.names = {"phi", "phi"};
  EXPECT_THROW(make_known(d), InputError);
}

// A row of a curve carries four variables of a law, however many it has: the start of a path reads
// its figures all the same, and writes beyond nothing (address sanitizer).
TEST(UmatState, MayBeMoreThanARowCarries) {
  const TestLaw law = make_law(describe(VON_MISES, 4, most_statev), {1e7, 0.25, 2e4, 1e6}, 1700.0);
  const point::PointTest test = triaxial(1e5, 0.01, 5);
  EXPECT_EQ(point::start_value(*law.info, law.theta, test, point::Quantity::density), 1700.0);
  EXPECT_DOUBLE_EQ(point::start_value(*law.info, law.theta, test, point::Quantity::p), 1e5);
  point::Curve curve;
  EXPECT_EQ(point::simulate(*law.info, law.theta, test, curve).status, point::Status::completed);
}

}  // namespace
}  // namespace repose::umat
