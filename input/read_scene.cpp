#include "input/read_scene.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "input/doubts.hpp"
#include "input/read_law.hpp"
#include "input/read_point_test.hpp"

namespace repose::input {
namespace {

using mpm::Wall;

bool fits_file_name(std::string_view name) {
  return !name.empty() && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) || c == '.' || c == '_' || c == '-';
         });
}

/// flat_mu_i of data/scenes/flat_mu_i.toml, made fit for file names.
std::string default_name(const InputFile& file) {
  std::string name = std::filesystem::path(file.name()).stem().string();
  for (char& c : name)
    if (!fits_file_name(std::string_view(&c, 1)) && c != '.') c = '_';
  return fits_file_name(name) ? name : "scene";
}

void read_general(TomlReader table, mpm::Scene& scene) {
  scene.name = table.text("name", "the result folder's name", default_name(table.file()));
  if (!fits_file_name(scene.name))
    table.report("name", fmt::format("scene.name = \"{}\" becomes part of file names: letters, "
                                     "digits, '.', '_' and '-' only, no '.' in front",
                                     scene.name));
  scene.end_time = table.number({"end_time", "s", "how long to simulate", not_negative, {}});
  scene.gravity = table.number({"gravity", "m/s²", "gravity", not_negative, scene.gravity});
  scene.tilt_deg = table.number(
      {"tilt_deg", "°", "tilt of the box", Range{-90.0, 90.0, false, false}, scene.tilt_deg});
}

Wall read_wall(TomlReader& table, std::string_view key, const Wall& fallback) {
  if (const toml::node* node = table.get(key); node != nullptr && node->is_table()) {
    TomlReader given = table.table(key);
    if (given.has("speed"))
      return {Wall::Kind::no_slip, 0.0,
              given.number({"speed", "m/s", "of the wall along itself", {}, {}})};
    Wall wall{Wall::Kind::friction};
    wall.friction = given.number({"friction", "-", "Coulomb coefficient", not_negative, {}});
    return wall;
  }
  constexpr std::array kinds{Wall::Kind::no_slip, Wall::Kind::slip, Wall::Kind::open,
                             Wall::Kind::periodic};
  table.expect(key);
  if (!table.has(key)) return fallback;
  const toml::node& node = *table.get(key);
  if (const auto* word = node.as_string(); word != nullptr && word->get() == "friction") {
    table.report(key,
                 fmt::format("{} = \"friction\" needs a coefficient: {} = {{ friction = 0.4 }}",
                             table.path_of(key), key));
    return fallback;
  }
  if (!node.is_string()) {
    table.report(key,
                 fmt::format("{} must be one of \"no_slip\", \"slip\", \"open\", \"periodic\", "
                             "or a table such as {{ friction = 0.4 }} or {{ speed = 0.1 }}; "
                             "got {}",
                             table.path_of(key), describe(node)));
    return fallback;
  }
  return {kinds[table.choice(key, {"no_slip", "slip", "open", "periodic"}, 0)]};
}

void read_domain(TomlReader table, mpm::Scene& scene) {
  const toml::node* const size = table.get("size");
  const bool space = size != nullptr && size->is_array() && size->as_array()->size() == 3;
  scene.domain =
      table.vector({"size",
                    "m",
                    space ? "width, height and depth of the box" : "width and height of the box",
                    positive,
                    {}},
                   space ? 3 : 2);
  if (std::isnan(scene.domain[2])) scene.domain[2] = 1.0;  // reported; still a scene in space
  scene.floor = read_wall(table, "floor", scene.floor);
  const Wall walls = read_wall(table, "walls", scene.left);
  scene.left = read_wall(table, "left", walls);
  scene.right = read_wall(table, "right", walls);
  // periodic walls are those across the flow; the top is then left as it is by default
  scene.top = read_wall(table, "top", walls.kind == Wall::Kind::periodic ? scene.top : walls);
  if (scene.dimensions() == 3) {
    scene.near = read_wall(table, "near", walls);
    scene.far = read_wall(table, "far", walls);
  }
}

void read_initial(TomlReader table, mpm::Body& body) {
  body.initial = read_initial_conditions(table);
  body.lithostatic = table.boolean("lithostatic", false);
}

mpm::Body read_body(TomlReader table, std::size_t position, std::size_t axes) {
  mpm::Body body;
  body.name = table.text("name", "a name for messages", fmt::format("body{}", position));
  const bool space = axes == 3;
  if (table.choice("shape", {"box", space ? "cylinder" : "disc"}, 0) == 0) {
    body.origin =
        table.vector({"origin", "m", "lower left corner", {}, {}}, axes, std::array{0.0, 0.0, 0.0});
    body.size = table.vector(
        {"size", "m", space ? "width, height and depth" : "width and height", positive, {}}, axes);
  } else {
    mpm::Disc disc;
    disc.centre = table.pair(
        {"centre", "m", space ? "x and z of the cylinder's axis" : "of the disc", {}, {}});
    disc.radius =
        table.number({"radius", "m", space ? "of the cylinder" : "of the disc", positive, {}});
    disc.hole = table.number({"hole", "m", "radius of the hole", not_negative, 0.0});
    if (space) {
      const double base = table.number({"base", "m", "y of the cylinder's base", {}, 0.0});
      set_cylinder(body, disc, base,
                   table.number({"height", "m", "of the cylinder", positive, {}}));
    } else {
      set_disc(body, disc);
    }
  }
  body.velocity = table.vector({"velocity", "m/s", "initial velocity", {}, {}}, axes,
                               std::array{0.0, 0.0, 0.0});
  body.spin = table.number({"spin", "rad/s", "initial angular velocity", {}, 0.0});
  read_initial(table.table("initial"), body);
  body.law = read_law(table.table("law"));
  return body;
}

void read_grid(TomlReader table, mpm::Scene& scene) {
  scene.h = table.number({"h", "m", "cell size", positive, {}});
  const bool space = scene.dimensions() == 3;
  if (space) scene.points_per_cell = 8;
  scene.points_per_cell = static_cast<int>(table.integer(
      "points_per_cell", space ? "a cube number: 1, 8, 27" : "a square number: 1, 4, 9, 16", 1, 100,
      scene.points_per_cell));
  scene.kernel = static_cast<mpm::Kernel>(
      table.choice("kernel", {mpm::kernel_names.begin(), mpm::kernel_names.end()},
                   static_cast<std::size_t>(scene.kernel)));
}

void read_step(TomlReader table, mpm::Scene& scene) {
  // without gravity there is no time from which a relaxation time could follow
  if (scene.gravity == 0.0) scene.transfer = mpm::Transfer::apic;
  scene.transfer = static_cast<mpm::Transfer>(
      table.choice("transfer", {mpm::transfer_names.begin(), mpm::transfer_names.end()},
                   static_cast<std::size_t>(scene.transfer)));
  scene.relaxation_time = table.optional_number(
      {"relaxation_time", "s", "of the points' own velocity towards the grid's", positive, {}});
  const bool relaxed = scene.transfer == mpm::Transfer::relaxed;
  if (relaxed && !scene.relaxation_time && scene.gravity == 0.0)
    table.report("transfer", "without gravity, relaxed needs step.relaxation_time [s]");
  if (!relaxed && scene.relaxation_time)
    table.report("relaxation_time", "only step.transfer = \"relaxed\" has a relaxation time");
  const bool has_order =
      scene.transfer == mpm::Transfer::xpic || scene.transfer == mpm::Transfer::fmpm;
  if (!has_order && table.has("order"))
    table.report("order", "only step.transfer = \"xpic\" and \"fmpm\" have an order");
  scene.order = static_cast<int>(table.integer("order", "1 is pic", 1, 100, scene.order));
  scene.pressure_averaging =
      table.number({"pressure_averaging", "-", "of neighbouring points, per unit of shear strain",
                    not_negative, scene.pressure_averaging});
  scene.viscosity = static_cast<mpm::Viscosity>(
      table.choice("viscosity", {mpm::viscosity_names.begin(), mpm::viscosity_names.end()},
                   static_cast<std::size_t>(scene.viscosity)));
  const auto tolerance =
      table.optional_number({"viscosity_tolerance",
                             "-",
                             "error of an implicit step's velocity over what its forces bring",
                             Range{0.0, 0.1, true, false},
                             {}});
  if (tolerance && scene.viscosity != mpm::Viscosity::implicit_solve)
    table.report("viscosity_tolerance", "only step.viscosity = \"implicit\" has a tolerance");
  scene.viscosity_tolerance = tolerance.value_or(scene.viscosity_tolerance);
  scene.sleep_speed = table.number({"sleep_speed", "m/s",
                                    "blocks whose points are slower come to sleep, 0 for none",
                                    not_negative, scene.sleep_speed});
  scene.storage = static_cast<mpm::Storage>(
      table.choice("storage", {mpm::storage_names.begin(), mpm::storage_names.end()},
                   static_cast<std::size_t>(scene.storage)));
  // A fluid's point alone, and the bulk of all, lose √(2/3) of their step with the third direction
  // (step_size.hpp).
  if (scene.dimensions() == 3) scene.courant = 0.65;
  const double default_courant = scene.courant;
  scene.courant =
      table.number({"courant", "-", "share of the stable step", mpm::courant_range, scene.courant});
  scene.dt = table.optional_number({"dt", "s", "fixed step", positive, {}});
  if (!table.has("courant") || !table.has("dt")) return;
  // An override replaces the file's choice; within one place the two contradict each other.
  const bool courant_set = table.file().origin(table.path_of("courant")).is_override();
  const bool dt_set = table.file().origin(table.path_of("dt")).is_override();
  if (courant_set == dt_set)
    table.report("dt", "give either step.courant or step.dt: a fixed step leaves no choice");
  else if (courant_set)
    scene.dt.reset();
  else
    scene.courant = default_courant;
}

PictureField read_output(TomlReader table, mpm::Scene& scene) {
  scene.frame_interval = table.number({"frame_interval", "s", "time between frames, 0 for none",
                                       not_negative, scene.frame_interval});
  scene.series_interval =
      table.number({"series_interval", "s", "time between rows of series.csv, 0 for two rows only",
                    not_negative, scene.series_interval});
  return table.choice("colour", {"mises", "density"}, 0) == 0 ? PictureField::mises
                                                              : PictureField::density;
}

}  // namespace

SceneFile read_scene(InputFile& file) {
  SceneFile result;
  mpm::Scene& scene = result.scene;
  TomlReader root(file);
  root.expect("chart");  // read_chart.hpp
  read_general(root.table("scene"), scene);
  read_domain(root.table("domain"), scene);
  for (const TomlReader& table : root.tables("body", "a block of material"))
    scene.bodies.push_back(read_body(table, scene.bodies.size(), scene.dimensions()));
  read_grid(root.table("grid"), scene);
  read_step(root.table("step"), scene);
  result.colour = read_output(root.table("output"), scene);
  if (file.ok()) {
    const double height = scene.domain[1];
    if (mpm::raise_top_to_cells(scene))
      result.notes.push_back(fmt::format(
          "domain.size: the box is {:.10g} m high instead of {:.10g} m, a whole number of "
          "cells (h = {:.10g} m)",
          scene.domain[1], height, scene.h));
    try {
      mpm::validate(scene);
    } catch (const InputError& error) {
      file.report(error);
    }
  }
  file.throw_if_bad();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const LawSpec& law = scene.bodies[i].law;
    for (const std::string& doubt : doubts(find_law(law), checked_parameters(law), {}))
      result.notes.push_back(fmt::format("body[{}].{}", i, doubt));
  }
  return result;
}

}  // namespace repose::input
