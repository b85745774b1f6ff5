// The resolved input: running it again gives the same scene, whatever was in the first one.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "input/resolved_scene.hpp"

namespace repose::input {
namespace {

namespace fs = std::filesystem;

SceneFile reread(const std::string& text) {
  InputFile file = InputFile::parse(text, "input.toml");
  return read_scene(file);
}

void expect_same(const SceneFile& a, const SceneFile& b) {
  const mpm::Scene &s = a.scene, &t = b.scene;
  EXPECT_EQ(a.colour, b.colour);
  EXPECT_EQ(s.name, t.name);
  EXPECT_EQ(s.end_time, t.end_time);
  EXPECT_EQ(s.gravity, t.gravity);
  EXPECT_EQ(s.tilt_deg, t.tilt_deg);
  EXPECT_EQ(s.domain, t.domain);
  for (const auto edge : {&mpm::Scene::floor, &mpm::Scene::left, &mpm::Scene::right,
                          &mpm::Scene::top, &mpm::Scene::near, &mpm::Scene::far}) {
    EXPECT_EQ((s.*edge).kind, (t.*edge).kind);
    EXPECT_EQ((s.*edge).friction, (t.*edge).friction);
  }
  EXPECT_EQ(s.h, t.h);
  EXPECT_EQ(s.points_per_cell, t.points_per_cell);
  EXPECT_EQ(s.kernel, t.kernel);
  EXPECT_EQ(s.viscosity, t.viscosity);
  EXPECT_EQ(s.viscosity_tolerance, t.viscosity_tolerance);
  EXPECT_EQ(s.courant, t.courant);
  EXPECT_EQ(s.dt, t.dt);
  EXPECT_EQ(s.frame_interval, t.frame_interval);
  EXPECT_EQ(s.grid_frames, t.grid_frames);
  EXPECT_EQ(s.series_interval, t.series_interval);
  ASSERT_EQ(s.bodies.size(), t.bodies.size());
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const mpm::Body &p = s.bodies[i], &q = t.bodies[i];
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.origin, q.origin);
    EXPECT_EQ(p.size, q.size);
    ASSERT_EQ(p.disc.has_value(), q.disc.has_value());
    if (p.disc) {
      EXPECT_EQ(p.disc->centre, q.disc->centre);
      EXPECT_EQ(p.disc->radius, q.disc->radius);
      EXPECT_EQ(p.disc->hole, q.disc->hole);
    }
    EXPECT_EQ(p.velocity, q.velocity);
    EXPECT_EQ(p.spin, q.spin);
    EXPECT_EQ(p.lithostatic, q.lithostatic);
    EXPECT_EQ(p.restitution, q.restitution);
    EXPECT_EQ(p.law.name, q.law.name);
    EXPECT_EQ(p.law.options, q.law.options);
    EXPECT_EQ(p.law.values, q.law.values);
    EXPECT_EQ(p.initial.p, q.initial.p);
    EXPECT_EQ(p.initial.ocr, q.initial.ocr);
    EXPECT_EQ(p.initial.v, q.initial.v);
    EXPECT_EQ(p.initial.density, q.initial.density);
    EXPECT_EQ(p.initial.K0, q.initial.K0);
    EXPECT_EQ(p.initial.sigma, q.initial.sigma);
  }
}

TEST(ResolvedInput, of_every_shipped_scene_gives_the_same_scene) {
  for (const auto& entry : fs::recursive_directory_iterator(REPOSE_SOURCE_DIR "/data/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    InputFile file = InputFile::read(entry.path());
    const SceneFile first = read_scene(file);
    const std::string text = resolved_input(first, "From a test");
    const SceneFile second = reread(text);
    expect_same(first, second);
    EXPECT_EQ(resolved_input(second, "From a test"), text);
  }
}

TEST(ResolvedInput, keeps_every_digit_and_every_kind_of_key) {
  const std::string odd =
      "[scene]\nname = \"odd\"\nend_time = 0.1\ngravity = 9.80665\ntilt_deg = "
      "-12.3456789012345678\n"
      "[domain]\nsize = [0.9, 0.9]\nfloor = { friction = 0.123456789012345678 }\nright = \"open\"\n"
      "[[body]]\nname = 'a \"b\" \\ c'\nsize = [0.3, 0.3]\nvelocity = [1e-17, -3]\nspin = 1e5\n"
      "restitution = 0.61234567890123456\n"
      "law = { name = \"mu_i\", mu_0 = 0.3, mu_d = 0.5, I_0 = 0.1, d = 1e-3, rho_p = 2e3, rho_0 = "
      "1300, K = 1e6, G = 123456.7 }\n"
      "initial = { sigma = [1e3, 1100, 1e3, 50, 0, 0] }\n"
      "[[body]]\nsize = [0.3, 0.3]\norigin = [0.3, 0.0]\n"
      "law = { name = \"modified_cam_clay\", compression = \"v-ln_p\", M = 1, lambda = 0.2, kappa "
      "= "
      "0.05, nu = 0.2, N = 2.9 }\n"
      "initial = { lithostatic = true, K0 = 0.8, ocr = 1.5 }\n"
      "[grid]\nh = 0.1\npoints_per_cell = 9\nkernel = \"quadratic\"\n"
      "[output]\ncolour = \"density\"\n[step]\ndt = 1.2345678901234567e-5\n";
  const SceneFile first = reread(odd);
  const std::string text = resolved_input(first, "From a test");
  expect_same(first, reread(text));
  EXPECT_EQ(first.scene.bodies[0].name, "a \"b\" \\ c");
  EXPECT_TRUE(first.scene.bodies[1].lithostatic);
}

// Friction as an angle becomes the parameter that it gives, the shape of the cone stays a word.
TEST(ResolvedInput, has_friction_once_and_the_cone_by_name) {
  const std::string given =
      "[scene]\nend_time = 0.1\n[domain]\nsize = [0.9, 0.9]\n[[body]]\nsize = [0.3, 0.3]\n"
      "law = { name = \"mu_i\", phi_0 = 21.3, phi_d = 33.7, shape = \"matsuoka_nakai\", I_0 = 0.1, "
      "d = "
      "1e-3, rho_p = 2e3, rho_0 = 1300, K = 1e6 }\n[grid]\nh = 0.1\n";
  const SceneFile first = reread(given);
  const LawSpec& law = first.scene.bodies[0].law;
  // 2√3 sin φ/(3 − sin φ)
  const double sine = std::sin(21.3 * std::acos(-1.0) / 180.0);
  EXPECT_DOUBLE_EQ(law.values.at("mu_0"), 2.0 * std::sqrt(3.0) * sine / (3.0 - sine));
  EXPECT_FALSE(law.values.contains("phi_0"));
  EXPECT_EQ(law.values.at("shape"), 1.0);
  const std::string text = resolved_input(first, "From a test");
  EXPECT_NE(text.find("\nshape = \"matsuoka_nakai\""), std::string::npos) << text;
  // tan φ = 0.3899: sin of plane flow is 2t/√(3 + 4t²) = 0.4104
  EXPECT_NE(text.find("; 21.3° in triaxial compression, 24.2° in plane flow"), std::string::npos)
      << text;
  expect_same(first, reread(text));
}

TEST(ResolvedInput, keeps_the_implicit_viscosity) {
  InputFile file = InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/flat_newtonian.toml");
  SceneFile first = read_scene(file);
  first.scene.viscosity = mpm::Viscosity::implicit_solve;
  first.scene.viscosity_tolerance = 1.2345678901234567e-4;
  expect_same(first, reread(resolved_input(first, "From a test")));
}

TEST(ResolvedInput, derived_parameters_are_comments) {
  InputFile file = InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml");
  const std::string text = resolved_input(read_scene(file), "From a test");
  EXPECT_NE(text.find("\n# G = 1019200.0 "), std::string::npos) << text;  // 4 × 254800
}

TEST(Differences, name_the_key_and_both_values) {
  const toml::table a = toml::parse("[grid]\nh = 0.1\nk = 1\n[[body]]\nsize = [1, 2]\n");
  const toml::table b = toml::parse("[grid]\nh = 0.2\nk = 1.0\n[[body]]\nsize = [1.0, 3]\n");
  const std::vector<std::string> expected{"body[0].size[1]: 2 there, 3 here",
                                          "grid.h: 0.1 there, 0.2 here"};
  EXPECT_EQ(differences(a, b), expected);
  EXPECT_TRUE(differences(a, a).empty());
  const std::vector<std::string> absent{"body[0].size[0]: 1 there, nothing here",
                                        "body[0].size[1]: 2 there, nothing here"};
  const toml::table less = toml::parse("[grid]\nh = 0.1\nk = 1\n");
  EXPECT_EQ(differences(a, less), absent);
  const std::vector<std::string> added{"body[0].size[0]: nothing there, 1 here",
                                       "body[0].size[1]: nothing there, 2 here"};
  EXPECT_EQ(differences(less, a), added);
}

}  // namespace
}  // namespace repose::input
