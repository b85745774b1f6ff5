/// Every key of every kind of input, walked by what the key tables say of themselves: written, read
/// back, changed, refused when it is mistyped.
#include "input/keys.hpp"

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "input/read_chart.hpp"
#include "input/read_fit.hpp"
#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"
#include "input/read_stability.hpp"
#include "input/resolved_scene.hpp"
#include "input/schema.hpp"
#include "io/fingerprint.hpp"
#include "io/json.hpp"

namespace repose::input {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

/// Scenes that together have every key.
constexpr std::string_view law = R"(
[body.law]
name = "mu_i"
mu_0 = 0.38
mu_d = 0.57
I_0 = 0.279
d = 0.0053
rho_p = 2000.0
rho_0 = 1300.0
K = 254800.0
)";
constexpr std::string_view clay = R"(
[body.law]
name = "modified_cam_clay"
compression = "v-ln_p"
M = 0.888
lambda = 0.161
kappa = 0.062
nu = 0.3
Gamma = 2.759
rho_p = 2650.0
)";

std::vector<std::string> scenes() {
  // a wall that moves, but for a transfer that has none
  const auto plane = [](std::string_view body, std::string_view laws, std::string_view rest) {
    const bool sticks = rest.find("implicit") != std::string_view::npos;
    const bool still = rest.find("xpic") != std::string_view::npos ||
                       rest.find("implicit") != std::string_view::npos;
    return fmt::format(
        "[scene]\nname = \"walk\"\nend_time = 0.5\ngravity = 9.8\ntilt_deg = 3.0\n"
        "[domain]\nsize = [1.0, 0.5]\nfloor = {}\nwalls = \"no_slip\"\n"
        "left = {}\nright = \"open\"\ntop = \"slip\"\n"
        "[[body]]\nname = \"block\"\n{}\n{}\n{}",
        sticks ? "\"no_slip\"" : "{ friction = 0.4 }", still ? "\"slip\"" : "{ speed = 0.1 }", body,
        laws, rest);
  };
  const std::string box =
      "shape = \"box\"\norigin = [0.1, 0.1]\nsize = [0.2, 0.2]\n"
      "velocity = [0.1, 0.2]\nspin = 0.5\n";
  const std::string grid =
      "[grid]\nh = 0.025\npoints_per_cell = 4\nkernel = \"quadratic\"\n"
      "[output]\nframe_interval = 0.1\nseries_interval = 0.05\ncheckpoint_interval = "
      "30.0\nshear_strain = true\ngrid_frames = true\n"
      "colour = \"density\"\n";
  const std::string disc = "shape = \"disc\"\ncentre = [0.3, 0.3]\nradius = 0.1\nhole = 0.025\n";
  const std::string cylinder =
      "[scene]\nend_time = 0.5\n[domain]\nsize = [1.0, 0.5, 1.0]\nnear = \"slip\"\nfar = "
      "\"no_slip\"\n[[body]]\nshape = \"cylinder\"\ncentre = [0.0, 0.0]\nradius = 0.2\nhole = "
      "0.0\nbase = 0.0\nheight = 0.2\n";
  // shapes from files, and all others
  const auto file = [](const char* name) {
    const std::string path = std::string(REPOSE_SOURCE_DIR) + "/tests/input/" + name;
    return fmt::format("file = \"{}\"\nfile_content = \"{}\"\n", path,
                       io::fingerprint_of(text_of(path)));
  };
  const std::string outline =
      file("outline.csv") + "x = \"across\"\ny = \"up\"\nunit = \"cm\"\nclosed = true\n";
  const std::string velocity = "hollow = true\nvelocity = [0.1, 0.2]\n";
  const std::string mesh = file("tetrahedron.stl") + "scale = 0.2\nshift = [0.3, 0.1, 0.3]\n";
  const std::string tilted =
      "point = [0.3, 0.2, 0.3]\naxis = [1.0, 0.2, 0.1]\nradius = 0.1\nlength = 0.3\n";
  const std::string half_space = "point = [0.3, 0.2, 0.3]\nnormal = [1.0, 0.2, 0.1]\n";
  const auto every_shape = [&](bool space) {
    const std::string place = space ? "[0.4, 0.2, 0.4]" : "[0.4, 0.2]";
    std::vector<std::string> shapes{
        "shape = \"half_space\"\npoint = " + place + "\nnormal = " + place + "\n",
        "shape = \"ball\"\ncentre = " + place + "\nradius = 0.2\nhollow = true\n",
        "shape = \"polygon\"\ncorners = [[0.1, 0.1], [0.7, 0.1], [0.4, 0.4]]\n",
        "shape = \"curve\"\n" + outline};
    if (!space) return shapes;
    shapes.push_back("shape = \"cylinder\"\n" + tilted);
    shapes.push_back("shape = \"mesh\"\n" + mesh);
    return shapes;
  };
  const auto cuts = [](const std::vector<std::string>& shapes) {
    std::string text;
    for (const std::string& shape : shapes)
      for (const char* table : {"[[body.within]]\n", "[[body.without]]\n", "[[surface]]\n"})
        text += table + shape;
    return text;
  };
  const auto box_in_space = [](const std::string& body) {
    const std::size_t cut = std::min(body.find("[["), body.size());
    return "[scene]\nend_time = 0.5\n[domain]\nsize = [1.0, 0.5, 1.0]\n[[body]]\n" +
           body.substr(0, cut) + std::string(law) + body.substr(cut) + "[grid]\nh = 0.05\n";
  };
  return {
      plane(box + "[body.initial]\np = 5e3\n", law,
            grid + "[step]\ntransfer = \"relaxed\"\nrelaxation_time = 0.002\n"
                   "pressure_averaging = 0.5\nstorage = \"float\"\ncourant = 0.5\n"),
      plane(disc + "[body.initial]\np = 20e3\nocr = 1.5\nK0 = 0.8\n", clay,
            grid + "[step]\ntransfer = \"xpic\"\norder = 3\ndt = 1e-5\n"),
      plane(box + "[body.initial]\nsigma_v = 20e3\nK0 = 0.8\nocr_v = 1.5\nK0_nc = 0.6\n", clay,
            grid + "stress = \"points\"\n"),
      plane(box + "restitution = 0.6\n[body.initial]\ndensity = 1310.0\n", law, grid),
      plane(box + "[body.initial]\nv = 2.1\n", clay, grid),
      plane(box + "[body.initial]\ne = 1.1\n", clay, grid),
      plane(box + "[body.initial]\nsigma = [2e4, 2.5e4, 2e4, 0.0, 0.0, 0.0]\n", clay, grid),
      plane(box + "[body.initial]\nlithostatic = true\nK0 = 0.8\n", law, grid),
      plane(box,
            "[body.law]\nname = \"newtonian\"\neta = 5.0\nK = 26e3\nalpha = 7.0\nrho_0 = "
            "1300.0\n",
            "[grid]\nh = 0.025\n[step]\nviscosity = \"implicit\"\nviscosity_tolerance = 1e-4\n"),
      plane(box, law,
            grid +
                "[[inflow]]\nname = \"stream\"\nedge = \"top\"\nbody = \"block\"\nfrom = 0.5\nto = "
                "0.7\n"
                "speed = 0.5\nstarts = 0.1\nstops = 0.2\n[[inflow]]\nedge = \"floor\"\nrate = 3.0\n"
                "[[probe]]\nname = \"a\"\nplace = [0.1, 0.2]\n"
                "[[tracer]]\nname = \"b\"\nplace = [0.2, 0.2]\n"),
      cylinder + std::string(law) + "[grid]\nh = 0.05\n",
      "[scene]\ngravity_ramp = 0.2\nwater_table = 0.1\nwater_density = 1030.0\nstart = "
      "\"as_given\"\nstart_from = \"results/bed\"\n" +
          cylinder.substr(cylinder.find('\n') + 1) + std::string(law) +
          "[grid]\nh = 0.05\n[output]\nfinal_state = true\n",
      "[scene]\nend_time = 0.5\n[terrain]\nground = \"valley.asc\"\nrelease = "
      "\"valley_release.geojson\"\nrelease_depth = 4.0\nfriction = \"valley_release.asc\"\n"
      "ground_content = \"b4f5e16c1fb1b7a9\"\nrelease_content = \"c4c68dc1757848cf\"\n"
      "friction_content = \"5df6a1e56bcf9d4e\"\nbase = 900.0\nleast_depth = 0.5\n[[body]]\nshape = "
      "\"release\"\n" +
          std::string(law) + "[grid]\nh = 10.0\n",
      "[scene]\nend_time = 0.5\n[terrain]\nground = \"valley.asc\"\nkind = "
      "\"slip\"\n[domain]\nsize "
      "= [1200.0, 600.0, 600.0]\n[[body]]\norigin = [900.0, 400.0, 100.0]\nsize = [20.0, 20.0, "
      "20.0]\n" +
          std::string(law) + "[grid]\nh = 10.0\n",
      plane("shape = \"polygon\"\ncorners = [[0.1, 0.2], [0.3, 0.2], [0.2, 0.4]]\n", law,
            grid +
                "[[surface]]\nname = \"ramp\"\nshape = \"half_space\"\npoint = [0.1, 0.1]\n"
                "normal = [-0.2, 1.0]\nfriction = 0.3\n"
                "[[surface]]\nshape = \"ball\"\ncentre = [0.5, 0.2]\nradius = 0.4\nhollow = true\n"
                "spin = 1.0\npivot = [0.5, 0.2]\nkind = \"slip\"\n"
                "[[surface]]\nshape = \"polygon\"\ncorners = [[0.6, 0.0], [0.7, 0.0], [0.7, 0.3]]\n"
                "velocity = [0.1, 0.2]\nstarts = 0.1\nstops = 0.2\n"),
      // a curve as a body, and as the ground
      plane("shape = \"curve\"\n" + outline, law,
            grid + "[[surface]]\nshape = \"curve\"\n" + outline + velocity +
                cuts(every_shape(false))),
      // every shape that cuts a body, and as a surface
      box_in_space("shape = \"mesh\"\n" + mesh + cuts(every_shape(true))),
      box_in_space("shape = \"cylinder\"\n" + tilted),
      box_in_space("shape = \"half_space\"\n" + half_space),
      plane("shape = \"ball\"\ncentre = [0.5, 0.25]\nradius = 0.1\n", law, grid)};
}

/// Keys of a kind as paths without positions: "body.initial.p", with what is known of each.
void collect(const std::vector<KeyInfo>& keys, const std::string& path,
             std::map<std::string, const KeyInfo*>& out) {
  for (const KeyInfo& key : keys) {
    if (key.name.empty()) continue;  // the forms of a law: law_parameters_test
    const std::string at = path.empty() ? key.name : path + "." + key.name;
    out[at] = &key;
    if (key.kind == ValueKind::table || key.kind == ValueKind::tables) collect(key.below, at, out);
    if (key.kind == ValueKind::any_of)
      for (const KeyInfo& form : key.below) collect(form.below, at, out);
  }
}

/// "body[0].initial.p" → "body.initial.p".
std::string without_positions(std::string path) {
  for (std::size_t at; (at = path.find('[')) != std::string::npos;)
    path.erase(at, path.find(']', at) - at + 1);
  return path;
}

/// Every key that a table of a file holds, "body[0].initial.p".
void list_keys(const toml::node& node, const std::string& path, std::vector<std::string>& out) {
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) {
      const std::string at =
          path.empty() ? std::string(key.str()) : path + "." + std::string(key.str());
      out.push_back(at);
      list_keys(child, at, out);
    }
  } else if (const toml::array* list = node.as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i)
      if (list->get(i)->is_table()) list_keys(*list->get(i), fmt::format("{}[{}]", path, i), out);
  }
}

std::vector<std::string> keys_in(const std::string& text) {
  std::vector<std::string> keys;
  list_keys(InputFile::parse(text, "walk.toml").root(), "", keys);
  return keys;
}

std::string resolved(const std::string& text, std::vector<std::string> sets = {}) {
  InputFile file = InputFile::parse(text, "walk.toml", sets);
  return resolved_input(read_scene(file), "walk");
}

/// The first complaint about an input; "" if there is none.
template <class Read>
std::string complaint(const std::string& text, std::vector<std::string> sets, Read&& read) {
  try {
    InputFile file = InputFile::parse(text, "walk.toml", sets);
    read(file);
    return "";
  } catch (const BadInput& error) {
    return error.what();
  }
}

void read_as_scene(InputFile& file) { read_scene(file); }

std::map<std::string, const KeyInfo*> known(const std::vector<KeyInfo>& keys) {
  std::map<std::string, const KeyInfo*> out;
  collect(keys, "", out);
  return out;
}

TEST(KeyTable, EverySceneKeyIsReadWrittenOutAndReadBack) {
  const std::vector<KeyInfo> keys = keys_of(SchemaKind::scene);
  const auto infos = known(keys);
  std::set<std::string> seen, written;
  for (const std::string& text : scenes()) {
    const std::string once = resolved(text);
    EXPECT_EQ(resolved(once), once) << "what was written out reads as something else";
    for (const std::string& key : keys_in(text)) {
      const std::string name = without_positions(key);
      EXPECT_TRUE(infos.contains(name) || name.find(".law.") != std::string::npos)
          << name << " is read and in no key table";
      seen.insert(name);
    }
    for (const std::string& key : keys_in(once)) {
      const std::string name = without_positions(key);
      EXPECT_TRUE(infos.contains(name) || name.find(".law.") != std::string::npos)
          << name << " is written and in no key table";
      written.insert(name);
    }
  }
  for (const auto& [name, info] : infos) {
    if (name.starts_with("chart") || name.starts_with("sweep") || name.starts_with("sensitivity"))
      continue;
    const bool of_an_edge = name.starts_with("domain.") && name.find('.', 7) != std::string::npos;
    if (of_an_edge) continue;  // alike on all six
    EXPECT_TRUE(seen.contains(name)) << name << " is in none of the scenes of this test";
    // `walls` stands for the edges, `e` for v
    EXPECT_TRUE(written.contains(name) || name == "domain.walls" || name == "body.initial.e")
        << name << " is read and never written out";
  }
}

/// Another value that the key may have, as TOML; "" where there is none to be had.
std::string another(const KeyInfo& key, const toml::node& now) {
  switch (key.kind) {
    case ValueKind::number: {
      const double x = *now.value<double>();
      for (const double y : {x * 1.01, x * 0.99, x + 1e-3, 0.5 * x})
        if (y != x && key.range.contains(y)) return fmt::format("{}", y + 0.0);
      return "";
    }
    case ValueKind::integer: {
      const std::int64_t n = *now.value<std::int64_t>();
      return std::to_string(n == 1 ? 4 : key.name == "points_per_cell" ? 1 : n + 1);
    }
    case ValueKind::boolean:
      return *now.value<bool>() ? "false" : "true";
    case ValueKind::text:
      return "\"changed\"";
    case ValueKind::word:
      for (const std::string& word : key.words)
        if (word != *now.value<std::string>()) return "\"" + word + "\"";
      return "";
    default:
      return "";
  }
}

constexpr const char* file_keys[] = {".file", ".file_content", ".x",    ".y",
                                     ".unit", ".closed",       ".shape"};

TEST(KeyTable, AChangedSceneKeyChangesWhatIsWrittenOut) {
  const std::vector<KeyInfo> keys = keys_of(SchemaKind::scene);
  const auto infos = known(keys);
  // whose other words need other keys, or whose other numbers leave the lattice of points
  const std::set<std::string> elsewhere{"body.shape",
                                        "step.transfer",
                                        "step.viscosity",
                                        "grid.h",
                                        "body.radius",
                                        "body.hole",
                                        "body.base",
                                        "body.height",
                                        "body.initial.lithostatic",
                                        "body.initial.e",
                                        "surface.shape",
                                        "body.name",
                                        "inflow.body",
                                        "inflow.edge",
                                        "scene.start",
                                        "terrain.ground",
                                        "terrain.release",
                                        "terrain.friction",
                                        "terrain.ground_content",
                                        "terrain.release_content",
                                        "terrain.friction_content"};
  // of a file, which they would not fit
  const auto of_file = [](const std::string& name) {
    return std::any_of(std::begin(file_keys), std::end(file_keys),
                       [&](const char* key) { return name.ends_with(key); });
  };
  std::set<std::string> changed;
  for (const std::string& text : scenes()) {
    const std::string before = resolved(text);
    for (const std::string& key : keys_in(text)) {
      const std::string name = without_positions(key);
      const auto info = infos.find(name);
      if (info == infos.end() || elsewhere.contains(name) || of_file(name)) continue;
      InputFile file = InputFile::parse(text, "walk.toml");
      const auto node = toml::at_path(file.root(), key);
      if (!node || node.is_table() || node.is_array()) continue;
      const std::string value = another(*info->second, *node.node());
      if (value.empty()) continue;
      // fixed and relative steps exclude each other within a file, so the file's own is replaced
      const std::string why = complaint(text, {key + "=" + value}, read_as_scene);
      ASSERT_EQ(why, "") << key << " = " << value;
      EXPECT_NE(resolved(text, {key + "=" + value}), before) << key << " = " << value;
      changed.insert(name);
    }
  }
  EXPECT_GE(changed.size(), 25U);
}

/// A name that is nearly right and no key of the table.
std::string mistyped(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  std::string name = key.substr(dot == std::string::npos ? 0 : dot + 1);
  name += name.back();
  return (dot == std::string::npos ? "" : key.substr(0, dot + 1)) + name;
}

/// A mistyped key is refused with the right name. One or two letters have no near name, and are
/// answered with the table's keys.
void expect_refused(const std::string& key, const std::string& why) {
  const std::string name = key.substr(key.rfind('.') == std::string::npos ? 0 : key.rfind('.') + 1);
  const std::string wrong = mistyped(key);
  EXPECT_NE(
      why.find("'" +
               wrong.substr(wrong.rfind('.') == std::string::npos ? 0 : wrong.rfind('.') + 1) +
               "'"),
      std::string::npos)
      << key << ": " << why;
  EXPECT_NE(why.find(name), std::string::npos) << key << ": " << why;
}

TEST(KeyTable, AMistypedSceneKeyIsRefusedAtEveryDepth) {
  for (const std::string& text : scenes())
    for (const std::string& key : keys_in(text)) {
      if (key.ends_with("]")) continue;
      expect_refused(key, complaint(text, {mistyped(key) + "=1"}, read_as_scene));
    }
}

TEST(KeyTable, ASceneValueOfTheWrongTypeIsRefused) {
  const std::vector<KeyInfo> keys = keys_of(SchemaKind::scene);
  const auto infos = known(keys);
  for (const std::string& text : scenes())
    for (const std::string& key : keys_in(text)) {
      const auto info = infos.find(without_positions(key));
      if (info == infos.end()) continue;
      const bool textual = info->second->kind == ValueKind::text;
      const std::string why =
          complaint(text, {key + (textual ? "=1.5" : "=\"seven\"")}, read_as_scene);
      EXPECT_NE(why.find(info->second->name), std::string::npos) << key << ": " << why;
    }
}

TEST(KeyTable, ANumberOutOfItsRangeIsRefusedWithTheRange) {
  const std::vector<KeyInfo> keys = keys_of(SchemaKind::scene);
  const auto infos = known(keys);
  std::size_t ranges = 0;
  for (const std::string& text : scenes())
    for (const std::string& key : keys_in(text)) {
      const auto info = infos.find(without_positions(key));
      if (info == infos.end() || info->second->kind != ValueKind::number) continue;
      const Range& range = info->second->range;
      for (const double edge : {range.lower, range.upper}) {
        if (!std::isfinite(edge)) continue;
        const double beyond = edge == range.lower ? edge - 1.0 : edge + 1.0;
        const std::string why =
            complaint(text, {fmt::format("{}={:.1f}", key, beyond)}, read_as_scene);
        EXPECT_NE(why.find("out of range"), std::string::npos) << key << ": " << why;
        ++ranges;
      }
      const std::string why = complaint(text, {key + "=nan"}, read_as_scene);
      EXPECT_NE(why.find("out of range"), std::string::npos) << key << ": " << why;
    }
  EXPECT_GT(ranges, 50U);
}

/// Point tests that together have every key.
std::vector<std::string> point_tests() {
  const std::string clay_law =
      "[law]\nname = \"modified_cam_clay\"\ncompression = \"v-ln_p\"\nM = 0.888\nlambda = "
      "0.161\nkappa = 0.062\nnu = 0.3\nGamma = 2.759\n";
  const std::string grains =
      "[law]\nname = \"mu_i\"\nmu_0 = 0.38\nmu_d = 0.64\nI_0 = 0.279\nd = 0.5e-3\nrho_p = "
      "2450.0\nrho_0 = 1470.0\nK = 1e7\n[initial]\np = 1e3\n";
  const std::string start = clay_law + "[initial]\np = 100e3\nocr = 1.2\n";
  const std::string how =
      "[integration]\nmethod = \"adaptive\"\ntolerance = 1e-7\nsubsteps = 5\nmax_steps = "
      "10000\nmax_strain = 5.0\n";
  const auto ends = [&](const std::string& key, const std::string& kind = "triaxial") {
    return start + "[test]\nkind = \"" + kind + "\"\n" + key + "\n";
  };
  std::vector<std::string> list{
      start + how +
          "[test]\nkind = \"triaxial\"\nstrain = \"engineering\"\ndrainage = \"undrained\"\nrate "
          "= 1e-4\nstress_rate = 500.0\npoints = 50\nstrain_limit = 0.5\ncontrol = "
          "\"strain\"\naxial_strain = 0.1\nstop = { q_over_p = 0.85, eps_q = 0.2, eps_v = 0.2, "
          "eps_q_total = 0.3, eps_v_total = 0.3, p_below = 1e3, p_above = 1e6, q = 1e6, tau = "
          "1e6, p_c = 1e7 }\n",
      clay_law + "[initial]\nsigma_v = 100e3\nK0 = 0.7\nocr_v = 1.3\nK0_nc = 0.7\n" +
          "[test]\nkind = \"oedometer\"\nsigma_a_end = 200e3\n",
      clay_law + "[initial]\nv = 1.9\n[test]\nkind = \"isotropic\"\np_end = 300e3\n",
      clay_law + "[initial]\ne = 0.9\n[test]\nkind = \"isotropic\"\np_end = 300e3\n",
      clay_law +
          "[initial]\nsigma = [1e5, 1e5, 1e5, 0.0, 0.0, 0.0]\n[test]\nkind = "
          "\"triaxial\"\naxial_strain_total = 0.1\n",
      ends("q_end = 50e3"),
      ends("q_over_p_end = 0.5"),
      ends("sigma_r_end = 90e3\ndrainage = \"constant_sigma_a\""),
      ends("volumetric_strain = 0.01"),
      ends("volumetric_strain_total = 0.01"),
      ends("shear_strain = 0.1", "simple_shear"),
      ends("shear_strain_total = 0.1", "simple_shear"),
      ends("tau_end = 10e3", "simple_shear"),
      ends("hold = \"stress\"\nduration = 10.0"),
      grains +
          "[test]\nkind = \"simple_shear\"\ndrainage = \"constant_p\"\nshear_strain = "
          "0.6\nrates = { from = 0.1, to = 10.0, count = 3 }\n",
      start +
          "[test]\nkind = \"triaxial\"\n[[test.stages]]\nkind = \"isotropic\"\np_end = "
          "150e3\n[[test.stages]]\naxial_strain = 0.05\n",
      start +
          "[test]\nkind = \"custom\"\nduration = 100.0\nstrain_rate = { xx = 1e-5, yy = 1e-4, "
          "zz = 1e-5, xy = 0.0 }\nstress_rate = { yz = 0.0 }\nconstraints = [{ strain = { zx "
          "= 1.0 }, stress = { zx = 0.0 }, rate = 0.0 }]\n",
  };
  for (const char* key : {"q", "p", "sigma_a"})
    list.push_back(
        ends(fmt::format("cycles = 2\n{0}_min = {1}\n{0}_max = {2}", key,
                         key[0] == 'q' ? "0.0" : "100e3", key[0] == 'q' ? "20e3" : "120e3")));
  for (const char* key :
       {"axial_strain", "volumetric_strain", "axial_strain_total", "volumetric_strain_total"})
    list.push_back(ends(fmt::format("cycles = 2\n{0}_min = 0.0\n{0}_max = 0.01", key)));
  for (const char* key : {"shear_strain", "shear_strain_total"})
    list.push_back(
        ends(fmt::format("cycles = 2\n{0}_min = -0.01\n{0}_max = 0.01", key), "simple_shear"));
  list.push_back(ends("shear_strain = 0.1\n[report]\nsecant_G_at = [1e-4, 1e-3]", "simple_shear"));
  list.push_back(ends("cycles = 2\ntau_min = -1e3\ntau_max = 1e3", "simple_shear"));
  return list;
}

void read_as_point_test(InputFile& file) { read_point_test(file); }

TEST(KeyTable, EveryKeyOfAPointTestIsReadAndAMistypedOneRefused) {
  const std::vector<KeyInfo> keys = keys_of(SchemaKind::test);
  const auto infos = known(keys);
  std::set<std::string> seen;
  for (const std::string& text : point_tests()) {
    ASSERT_EQ(complaint(text, {}, read_as_point_test), "") << text;
    for (const std::string& key : keys_in(text)) {
      seen.insert(without_positions(key));
      if (key.ends_with("]")) continue;
      expect_refused(key, complaint(text, {mistyped(key) + "=1"}, read_as_point_test));
    }
  }
  for (const auto& [name, info] : infos) {
    // stages have what the test has; a history needs a table, with keys beside it
    // (measured_columns_test); components are alike
    const std::set<std::string> beside_history{"test.columns",   "test.where",   "test.rows",
                                               "test.separator", "test.decimal", "test.header_row"};
    const bool alike = name.starts_with("test.stages.") || name.ends_with(".density") ||
                       name.find("history") != std::string::npos || beside_history.contains(name) ||
                       name.find("_rate.") != std::string::npos ||
                       name.find("constraints.") != std::string::npos ||
                       name.starts_with("sweep") ||      // sweep_test
                       name.starts_with("sensitivity");  // sensitivity_command_test
    EXPECT_TRUE(alike || seen.contains(name)) << name << " is in none of the tests here";
  }
}

TEST(KeyTable, TyposInsideTheEntriesOfAFitAreRefused) {
  const auto complain = [](const std::string& entry, const std::string& target = "") {
    const std::string text =
        "[law]\nname = \"modified_cam_clay\"\ncompression = \"v-ln_p\"\nlambda = 0.161\nkappa = "
        "0.062\nnu = 0.3\nGamma = 2.759\n[fit]\nM = " +
        entry + "\n[[target]]\ndata = \"" + REPOSE_SOURCE_DIR +
        "/data/experiments/kaolin_a7_undrained.csv\"\nx = \"eps_a\"\ny = \"q_Pa\"\nto = "
        "0.05\ninitial = { p = 400e3, ocr = 1.0 }\ntest = { kind = \"triaxial\", drainage = "
        "\"undrained\" }\n" +
        target;
    const auto file = std::filesystem::temp_directory_path() /
                      fmt::format("repose_keys_test_{}.toml", ::getpid());
    std::ofstream(file) << text;
    std::string why;
    try {
      read_fit(file, {}, 1);
    } catch (const BadInput& error) {
      why = error.what();
    }
    std::filesystem::remove(file);
    return why;
  };
  EXPECT_EQ(complain("{ lower = 0.5, upper = 1.5 }"), "");
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5, strat = 1.0 }").find("did you mean 'start'?"),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5, scal = \"log\" }").find("did you mean 'scale'?"),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5, prior = { mean = 1.0, sds = 0.1 } }")
                .find("did you mean 'sd'?"),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5 }", "[solver]\nstart = 3\n")
                .find("did you mean 'starts'?"),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5 }", "[solver]\nresiduals = \"hubert\"\n")
                .find("did you mean \"huber\"?"),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5 }", "[solver]\ntuning = 2.0\n")
                .find("it belongs to residuals = \"huber\" or \"student\""),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5 }",
                     "[solver]\nresiduals = \"student\"\n[posterior]\ndraws = 300\n")
                .find("posterior takes the errors to be normal"),
            std::string::npos);
  const std::string candidate =
      "[[candidate]]\nname = \"shear\"\nx = \"eps_a\"\ny = \"q_Pa\"\nto = 0.1\ninitial = { p "
      "= 2e5, ocr = 1.0 }\ntest = { kind = \"triaxial\", drainage = \"drained\" }\n";
  const std::string noise = "noise = { q_Pa = 1e3 }\n";
  EXPECT_EQ(complain("{ lower = 0.5, upper = 1.5 }", candidate + noise), "");
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5 }", candidate).find("noise needs q_Pa"),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5 }", candidate + noise + "rosw = 3\n")
                .find("did you mean 'rows'?"),
            std::string::npos);
  EXPECT_NE(complain("{ lower = 0.5, upper = 1.5 }", "[posterior]\ndrawss = 300\n")
                .find("did you mean 'draws'?"),
            std::string::npos);
  EXPECT_NE(
      complain("{ lower = 0.5, upper = 1.5 }", "wieght = 2.0\n").find("did you mean 'weight'?"),
      std::string::npos);
}

TEST(KeyTable, EveryKeyOfChartsAndMapsIsReadAndAMistypedOneRefused) {
  const std::string scene = scenes().front();
  const std::string chart =
      "[chart]\nkind = \"mpm\"\nevaluations = 10\nseed = 3\nquick = true\ntransfers = "
      "[\"apic\"]\nkernels = [\"cubic\"]\npoints_per_cell = [4]\ncells = [0.1]\nreference = "
      "[0.05]\ncourants = [0.5]\ndts = [1e-4]\nexact = \"couette\"\nvary = { "
      "\"step.relaxation_time\" "
      "= [0.01] }\n";
  const auto read = [](InputFile& file) {
    read_chart(file);
    file.throw_if_bad();
  };
  std::set<std::string> seen;
  for (const std::string& key : keys_in(chart)) {
    seen.insert(key);
    if (key == "chart" || key.find("vary.") != std::string::npos) continue;
    expect_refused(key, complaint(chart, {mistyped(key) + "=1"}, read));
  }
  const auto infos = known(keys_of(SchemaKind::scene));
  for (const auto& [name, info] : infos)
    EXPECT_TRUE(!name.starts_with("chart.") || seen.contains(name))
        << name << " is not in the chart of this test";
  const std::string maps = "[stability]\nparts = [\"clay\"]\np = 1e3\nquick = true\n";
  for (const std::string& key : keys_in(maps)) {
    if (key == "stability") continue;
    expect_refused(key, complaint(maps, {mistyped(key) + "=1"},
                                  [](InputFile& file) { read_stability(file); }));
  }
}

TEST(KeyPage, IsWhatTheProgramPrints) {
  EXPECT_EQ(text_of(std::filesystem::path(REPOSE_SOURCE_DIR) / "docs/keys.md"), key_page())
      << "repose schema --page > docs/keys.md";
}

using Json = io::Json;

Json json_of(const toml::node& node) {
  if (const toml::table* table = node.as_table()) {
    Json object = Json::object();
    for (const auto& [key, child] : *table) object[std::string(key.str())] = json_of(child);
    return object;
  }
  if (const toml::array* list = node.as_array()) {
    Json values = Json::array();
    for (const toml::node& child : *list) values.push_back(json_of(child));
    return values;
  }
  if (const auto* value = node.as_integer()) return value->get();
  if (const auto* value = node.as_floating_point()) return value->get();
  if (const auto* value = node.as_boolean()) return value->get();
  return *node.value<std::string>();
}

/// Why a value is not what a schema asks for, of the words that ours are made of; "" if it is.
std::string refusal(const Json& value, const Json& schema, const std::string& at) {
  if (schema.contains("anyOf")) {
    std::string reasons;
    for (const Json& form : schema["anyOf"]) {
      const std::string why = refusal(value, form, at);
      if (why.empty()) return "";
      reasons += (reasons.empty() ? "" : ", ") + why;
    }
    return reasons;
  }
  if (schema.contains("const") && value != schema["const"]) return at + " is another word";
  if (schema.contains("enum")) {
    for (const Json& word : schema["enum"])
      if (word == value) return "";
    return at + " is none of the words";
  }
  const std::string type = schema.value("type", "");
  if ((type == "number" && !value.is_number()) ||
      (type == "integer" && !value.is_number_integer()) ||
      (type == "string" && !value.is_string()) || (type == "boolean" && !value.is_boolean()) ||
      (type == "array" && !value.is_array()) || (type == "object" && !value.is_object()))
    return at + " is no " + type;
  if (value.is_number()) {
    const double x = value.get<double>();
    if ((schema.contains("minimum") && x < schema["minimum"].get<double>()) ||
        (schema.contains("exclusiveMinimum") && x <= schema["exclusiveMinimum"].get<double>()) ||
        (schema.contains("maximum") && x > schema["maximum"].get<double>()) ||
        (schema.contains("exclusiveMaximum") && x >= schema["exclusiveMaximum"].get<double>()))
      return at + " is out of range";
  }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", std::size_t{0}) ||
        value.size() > schema.value("maxItems", value.size()))
      return at + " has another length";
    for (const Json& item : value)
      if (const std::string why = refusal(item, schema["items"], at + "[]"); !why.empty())
        return why;
  }
  if (type == "object") {
    for (const auto& [key, child] : value.items()) {
      if (schema["properties"].contains(key)) {
        const std::string why = refusal(child, schema["properties"][key], at + "." + key);
        if (!why.empty()) return why;
      } else if (schema["additionalProperties"] == false) {
        return at + " has no " + key;
      }
    }
    if (schema.contains("required"))
      for (const Json& key : schema["required"])
        if (!value.contains(key.get<std::string>())) return at + " lacks " + key.get<std::string>();
  }
  return "";
}

TEST(KeySchema, AcceptsEveryShippedFileAndRefusesATypo) {
  namespace fs = std::filesystem;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(REPOSE_SOURCE_DIR) / "data")) {
    if (entry.path().extension() != ".toml") continue;
    const InputFile file = InputFile::read(entry.path());
    std::ifstream in(entry.path());
    std::string line;
    std::getline(in, line);
    const Json schema = Json::parse(text_of(entry.path().parent_path() / line.substr(9)));
    Json value = json_of(file.root());
    EXPECT_EQ(refusal(value, schema, entry.path().filename().string()), "");
    value["scen"] = 1;
    EXPECT_NE(refusal(value, schema, ""), "") << entry.path();
  }
  const Json scene = Json::parse(json_schema(SchemaKind::scene));
  for (const std::string& text : scenes()) {
    const InputFile file = InputFile::parse(text, "walk.toml");
    EXPECT_EQ(refusal(json_of(file.root()), scene, "walk"), "") << text;
  }
  const Json test = Json::parse(json_schema(SchemaKind::test));
  for (const std::string& text : point_tests()) {
    const InputFile file = InputFile::parse(text, "walk.toml");
    EXPECT_EQ(refusal(json_of(file.root()), test, "walk"), "") << text;
  }
}

TEST(KeySchema, IsWhatTheProgramPrintsAndEveryShippedFileNamesItsOwn) {
  namespace fs = std::filesystem;
  const fs::path root = REPOSE_SOURCE_DIR;
  for (std::size_t k = 0; k < schema_names.size(); ++k) {
    const std::string name = fmt::format("docs/schema/{}.json", schema_names[k]);
    EXPECT_EQ(text_of(root / name), json_schema(static_cast<SchemaKind>(k)))
        << "repose schema " << schema_names[k] << " > " << name;
    EXPECT_TRUE(io::Json::try_parse(json_schema(static_cast<SchemaKind>(k))).has_value());
  }
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root / "data")) {
    if (entry.path().extension() != ".toml") continue;
    std::ifstream in(entry.path());
    std::string line;
    std::getline(in, line);
    ASSERT_TRUE(line.starts_with("#:schema ")) << entry.path();
    EXPECT_TRUE(fs::exists(entry.path().parent_path() / line.substr(9))) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 40U);
}

}  // namespace
}  // namespace repose::input
