#include "input/read_scene.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "input/doubts.hpp"
#include "input/key_info.hpp"
#include "input/read_initial.hpp"
#include "input/read_keys.hpp"
#include "input/read_law.hpp"
#include "input/read_surface.hpp"
#include "input/read_terrain.hpp"
#include "input/toml_text.hpp"
#include "umat/in/library_law.hpp"

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

void general_keys(Keys& keys, mpm::Scene& scene) {
  keys.text({"name", "-", "the result folder's name"}, scene.name);
  keys.number({"end_time", "s", "how long to simulate", not_negative, required}, scene.end_time);
  keys.number({"gravity", "m/s²", "gravity", not_negative}, scene.gravity);
  keys.number({"tilt_deg", "°", "tilt of the box, towards +x", Range{-90.0, 90.0, false, false}},
              scene.tilt_deg);
  keys.number({"gravity_ramp", "s", "time over which gravity grows from 0 (0: it is there at once)",
               not_negative},
              scene.gravity_ramp);
  static constexpr std::array<std::string_view, 2> starts{"as_given", "at_rest"};
  std::optional<std::size_t> start;
  if (scene.equilibrium) start = *scene.equilibrium ? 1 : 0;
  keys.word({"start", "-",
             "at_rest: the stresses of lithostatic bodies are corrected until nothing moves; the "
             "default where all bodies are lithostatic and there are several, or a polygon"},
            starts, start);
  if (start) scene.equilibrium = *start == 1;
  keys.text({"start_from", "-",
             "result folder of a run with output.final_state = true, whose points the bodies are"},
            scene.start_from);
  keys.number({"water_table", "m", "height below which bodies are buoyant"}, scene.water_table);
  keys.number(
      Key{"water_density", "kg/m³", "of the water below the water table", positive}.only_if(
          scene.water_table.has_value(), "only a scene with a water_table has a water_density"),
      scene.water_density);
  if (TomlReader* const table = keys.reader(); table != nullptr && !fits_file_name(scene.name))
    table->report("name", fmt::format("scene.name = \"{}\" becomes part of file names: letters, "
                                      "digits, '.', '_' and '-' only, no '.' in front",
                                      scene.name));
}

constexpr std::array<std::string_view, 4> wall_words{"no_slip", "slip", "open", "periodic"};
constexpr std::array wall_kinds{Wall::Kind::no_slip, Wall::Kind::slip, Wall::Kind::open,
                                Wall::Kind::periodic};

void friction_key(Keys& keys, double& friction) {
  keys.number({"friction", "-", "Coulomb coefficient", Range{0.0, 1e3, false, false}, required},
              friction);
}

void speed_key(Keys& keys, double& speed) {
  keys.number({"speed", "m/s", "of the wall along itself", {}, required}, speed);
}

constexpr std::array<std::string_view, 3> part_words{"no_slip", "slip", "open"};

/// An end of a stretch of an edge: along it, in space of both its directions or of the first.
void end_key(Keys& keys, std::string_view name, std::string_view doc, double absent,
             std::array<double, 2>& end) {
  KeyInfo info, one, two;
  info.kind = ValueKind::any_of;
  one.kind = ValueKind::number;
  two.kind = ValueKind::number_list;
  two.least = two.most = 2;
  info.below = {one, two};
  keys.value(
      {name, "m", doc},
      [&](TomlReader& table) {
        if (table.get(name)->is_array())
          end = table.pair({name, "m", doc, {}, {}});
        else
          end = {table.number({name, "m", doc, {}, {}}), absent};
      },
      [&] {
        if (std::isfinite(end[1]))
          return fmt::format("[{}, {}]", toml_number(end[0]), toml_number(end[1]));
        return std::isfinite(end[0]) ? toml_number(end[0]) : std::string();
      },
      info);
}

void stretch_keys(Keys& keys, std::array<double, 2>& from, std::array<double, 2>& to) {
  end_key(keys, "from", "where it begins along the edge; in space also [x, z]: in both directions",
          -HUGE_VAL, from);
  end_key(keys, "to", "where it ends", HUGE_VAL, to);
}

/// The keys of a part of an edge: one of kind, friction and speed.
void part_keys(Keys& keys, Wall::Part& part) {
  static constexpr std::array kinds{Wall::Kind::no_slip, Wall::Kind::slip, Wall::Kind::open};
  std::optional<std::size_t> kind;
  std::optional<double> friction, speed;
  if (part.kind == Wall::Kind::friction)
    friction = part.friction;
  else if (part.speed != 0.0)
    speed = part.speed;
  else
    kind = std::find(kinds.begin(), kinds.end(), part.kind) - kinds.begin();
  if (keys.reader() != nullptr || keys.describes()) kind.reset();
  keys.word({"kind", "-", "of this part; or friction, or speed"}, part_words, kind);
  keys.number({"friction", "-", "Coulomb coefficient", Range{0.0, 1e3, false, false}}, friction);
  keys.number({"speed", "m/s", "of the wall along itself"}, speed);
  stretch_keys(keys, part.from, part.to);
  TomlReader* const table = keys.reader();
  if (table == nullptr) return;
  const int given = (table->has("kind") ? 1 : 0) + (table->has("friction") ? 1 : 0) +
                    (table->has("speed") ? 1 : 0);
  if (given != 1)
    table->report(given == 0 ? "" : "kind",
                  fmt::format("{} needs one of kind = \"no_slip\", \"slip\" or \"open\", "
                              "friction = 0.4 and speed = 0.1",
                              table->path()));
  part.kind = friction ? Wall::Kind::friction : kind ? kinds[*kind] : Wall::Kind::no_slip;
  part.friction = friction.value_or(0.0);
  part.speed = speed.value_or(0.0);
}

}  // namespace

Wall read_wall(TomlReader& table, std::string_view key, const Wall& fallback) {
  const toml::node& node = *table.get(key);
  if (node.is_array() && key != "walls") {
    Wall wall{Wall::Kind::parts};
    for (const TomlReader& entry : table.tables(key, "parts of an edge")) {
      ReadKeys keys(entry);
      part_keys(keys, wall.parts.emplace_back());
    }
    return wall;
  }
  if (node.is_table()) {
    const TomlReader given = table.table(key);
    ReadKeys keys(given);
    Wall wall{Wall::Kind::no_slip};
    if (given.has("speed")) {
      speed_key(keys, wall.speed);
    } else {
      wall.kind = Wall::Kind::friction;
      friction_key(keys, wall.friction);
    }
    return wall;
  }
  if (const auto* word = node.as_string(); word != nullptr && word->get() == "friction") {
    table.report(key,
                 fmt::format("{} = \"friction\" needs a coefficient: {} = {{ friction = 0.4 }}",
                             table.path_of(key), key));
    return fallback;
  }
  if (!node.is_string()) {
    table.report(key,
                 fmt::format("{} must be one of \"no_slip\", \"slip\", \"open\", \"periodic\", "
                             "or a table such as {{ friction = 0.4 }} or {{ speed = 0.1 }}{}; "
                             "got {}",
                             table.path_of(key),
                             key == "walls" ? ""
                                            : ", or a list of parts such as "
                                              "{ from = 0.4, to = 0.6, kind = \"open\" }",
                             describe(node)));
    return fallback;
  }
  return {wall_kinds[table.choice(key, {wall_words.begin(), wall_words.end()}, 0)]};
}

namespace {

std::string part_text(const Wall::Part& part) {
  const auto end = [](std::string_view name, const std::array<double, 2>& at) {
    if (std::isfinite(at[1]))
      return fmt::format("{} = [{}, {}], ", name, toml_number(at[0]), toml_number(at[1]));
    return std::isfinite(at[0]) ? fmt::format("{} = {}, ", name, toml_number(at[0])) : "";
  };
  const auto at = std::find(wall_kinds.begin(), wall_kinds.end(), part.kind) - wall_kinds.begin();
  const std::string kind =
      part.kind == Wall::Kind::friction ? fmt::format("friction = {}", toml_number(part.friction))
      : part.speed != 0.0
          ? fmt::format("speed = {}", toml_number(part.speed))
          : fmt::format("kind = {}", toml_string(wall_words[static_cast<std::size_t>(at)]));
  return fmt::format("{{ {}{}{} }}", end("from", part.from), end("to", part.to), kind);
}

std::string wall_text(const Wall& wall) {
  if (wall.kind == Wall::Kind::parts) {
    std::string text;
    for (const Wall::Part& part : wall.parts) text += (text.empty() ? "" : ", ") + part_text(part);
    return fmt::format("[{}]", text);
  }
  if (wall.kind == Wall::Kind::friction)
    return fmt::format("{{ friction = {} }}", toml_number(wall.friction));
  if (wall.speed != 0.0) return fmt::format("{{ speed = {} }}", toml_number(wall.speed));
  const auto at = std::find(wall_kinds.begin(), wall_kinds.end(), wall.kind) - wall_kinds.begin();
  return toml_string(wall_words[static_cast<std::size_t>(at)]);
}

/// `in_parts`: whether the edge may be given so.
const KeyInfo& wall_info(bool in_parts) {
  const auto info_of = [](bool parts) {
    KeyInfo any, word, friction, speed;
    any.kind = ValueKind::any_of;
    word.kind = ValueKind::word;
    word.words.assign(wall_words.begin(), wall_words.end());
    friction.kind = speed.kind = ValueKind::table;
    double x = 0.0;
    friction.below = describe_keys([&](Keys& keys) { friction_key(keys, x); });
    speed.below = describe_keys([&](Keys& keys) { speed_key(keys, x); });
    any.below = {word, friction, speed};
    if (parts) {
      KeyInfo list;
      list.kind = ValueKind::tables;
      Wall::Part part;
      list.below = describe_keys([&](Keys& keys) { part_keys(keys, part); });
      any.below.push_back(list);
    }
    return any;
  };
  static const KeyInfo whole = info_of(false), any = info_of(true);
  return in_parts ? any : whole;
}

void wall_key(Keys& keys, std::string_view name, std::string_view doc, Wall& wall) {
  keys.value(
      {name, "-", doc}, [&](TomlReader& table) { wall = read_wall(table, name, wall); },
      [&] { return wall_text(wall); }, wall_info(true));
}

void domain_keys(Keys& keys, mpm::Scene& scene) {
  std::size_t axes = scene.dimensions();
  if (const TomlReader* const table = keys.reader()) {
    const toml::node* const size = table->get("size");
    axes = scene.terrain || (size != nullptr && size->is_array() && size->as_array()->size() == 3)
               ? 3
               : 2;
    if (scene.terrain) {  // material leaves a map where it ends
      scene.left = scene.right = scene.near = scene.far = scene.top = {Wall::Kind::open};
      if (size == nullptr) scene.domain = {};
    }
  }
  const Key size =
      Key{"size", "m", "width and height of the box, in space also its depth", positive, required}
          .only_if(true, "required; with [terrain] it may be left to the map");
  if (scene.terrain && keys.reader() != nullptr && !keys.reader()->has("size"))
    keys.reader()->expect("size");
  else
    keys.place(size, axes, scene.domain);
  if (std::isnan(scene.domain[2])) scene.domain[2] = 1.0;  // reported; still a scene in space
  wall_key(keys, "floor", "lower edge", scene.floor);
  keys.value(
      {"walls", "-", "every other edge that is not given itself"},
      [&](TomlReader& table) {
        const Wall walls = read_wall(table, "walls", scene.left);
        scene.left = scene.right = walls;
        if (axes == 3) scene.near = scene.far = walls;
        // periodic walls are those across the flow; the top is then left as it is
        if (walls.kind != Wall::Kind::periodic) scene.top = walls;
      },
      [] { return std::string(); }, wall_info(false));
  wall_key(keys, "left", "edge at x = 0", scene.left);
  wall_key(keys, "right", "edge at the other end of x", scene.right);
  wall_key(keys, "top", "upper edge", scene.top);
  if (axes == 2 && !keys.describes()) return;
  wall_key(keys, "near", "in space: edge at z = 0", scene.near);
  wall_key(keys, "far", "in space: edge at the other end of z", scene.far);
}

void body_initial_keys(Keys& keys, mpm::Body& body) {
  initial_keys(keys, body.initial);
  keys.boolean({"lithostatic", "-",
                "the vertical stress is the weight of what stands over a place; K0 and ocr apply"},
               body.lithostatic);
}

std::string_view shape_word(const mpm::Body& body, bool space) {
  return body.release   ? "release"
         : body.solid   ? shape_name(*body.solid)
         : body.polygon ? "polygon"
         : body.disc    ? space ? "cylinder" : "disc"
                        : "box";
}

/// What the points of a body fill.
void body_shape_keys(Keys& keys, mpm::Body& body, std::size_t axes) {
  static constexpr std::array<std::string_view, 9> described{
      "box", "disc", "polygon", "cylinder", "release", "ball", "half_space", "curve", "mesh"};
  static constexpr std::array<std::string_view, 6> in_plane{"box",  "disc",       "polygon",
                                                            "ball", "half_space", "curve"};
  static constexpr std::array<std::string_view, 6> in_space{"box",  "cylinder",   "release",
                                                            "ball", "half_space", "mesh"};
  const bool space = axes == 3;
  const auto words = keys.describes() ? std::span<const std::string_view>(described)
                     : space          ? std::span<const std::string_view>(in_space)
                                      : std::span<const std::string_view>(in_plane);
  auto place = static_cast<std::size_t>(
      std::find(words.begin(), words.end(), shape_word(body, space)) - words.begin());
  keys.word({"shape", "-",
             "of the body. The points of a box, a disc and an upright cylinder stand on its own "
             "lattice; of anything else, cells of the grid's lattice are cut"},
            words, place);
  const std::string_view shape = words[place];
  constexpr std::string_view box_only = "origin and size belong to a box";
  keys.place(Key{"origin", "m", "lower left corner of a box (0)"}.only_if(shape == "box", box_only),
             axes, body.origin);
  keys.place(
      Key{"size", "m", "width, height and in space depth of a box", positive, required}.only_if(
          shape == "box", box_only),
      axes, body.size);
  mpm::Solid solid = body.solid.value_or(mpm::Solid{});
  if (body.polygon && !body.solid) solid.shape = *body.polygon;
  mpm::Disc disc = body.disc.value_or(mpm::Disc{});
  double base = body.origin[1], height = body.size[1];
  shape_keys(keys, shape, axes, solid, &disc);
  const bool tilted = std::holds_alternative<mpm::Cylinder>(solid.shape);
  const bool upright = shape == "cylinder" && !tilted;
  constexpr std::string_view upright_only = "base and height belong to a cylinder without axis";
  keys.number(Key{"hole", "m", "radius of the hole of a disc or upright cylinder (0)", not_negative}
                  .only_if(shape == "disc" || upright, "a hole belongs to a disc or a cylinder"),
              disc.hole);
  keys.number(Key{"base", "m", "y of the cylinder's base (0)"}.only_if(upright, upright_only),
              base);
  keys.number(
      Key{"height", "m", "of the cylinder", positive, required}.only_if(upright, upright_only),
      height);
  solids_key(keys, {"within", "-", "a shape that the body is cut to: what lies in all of them"},
             axes, body.within);
  solids_key(keys, {"without", "-", "a shape that is cut out of the body"}, axes, body.without);
  if (keys.reader() == nullptr) return;
  body.release = shape == "release";
  if (upright)
    set_cylinder(body, disc, base, height);
  else if (shape == "disc")
    set_disc(body, disc);
  else if (shape == "polygon")  // without its corners, which is reported, it has no box to be set
    if (const auto& polygon = std::get<mpm::Polygon>(solid.shape); polygon.corners.size() > 2)
      set_polygon(body, polygon);
  if (shape != "box" && shape != "release" && shape != "disc" && shape != "polygon" && !upright)
    body.solid = std::move(solid);  // its box is set with that of the scene
}

void body_keys(Keys& keys, mpm::Body& body, std::size_t axes) {
  keys.text({"name", "-", "for messages"}, body.name);
  body_shape_keys(keys, body, axes);
  keys.place({"velocity", "m/s", "at the start"}, axes, body.velocity);
  keys.number({"spin", "rad/s", "angular velocity at the start"}, body.spin);
  keys.number(
      {"restitution", "-",
       "of the grains' contacts, which then damp elastic waves; a law with a grain diameter",
       Range{0.0, 1.0, true, false}},
      body.restitution);
  keys.table({"initial", "-", "the state at the start"},
             [&](Keys& below) { body_initial_keys(below, body); });
  keys.table(
      {"law",
       "-",
       "the constitutive law; or a file with a [law] table, as a fit leaves it: \"fitted.toml\"",
       {},
       required},
      [&](Keys& below) { law_keys(below, body.law); });
}

void inflow_keys(Keys& keys, mpm::Inflow& inflow, const mpm::Scene& scene) {
  keys.text({"name", "-", "for messages"}, inflow.name);
  keys.word({"edge", "-", "through which it comes in", {}, required}, mpm::edge_names, inflow.edge);
  std::string body =
      inflow.body < scene.bodies.size() ? scene.bodies[inflow.body].name : std::string();
  keys.text({"body", "-", "the name of the body whose law and initial state it has (the first)"},
            body);
  stretch_keys(keys, inflow.from, inflow.to);
  keys.number({"speed", "m/s", "inwards; or a rate", positive}, inflow.speed);
  keys.number({"rate", "kg/s", "mass per time, in the plane per metre of depth",
               Range{0.0, 1e12, true, false}},
              inflow.rate);
  keys.number({"starts", "s", "when it begins", not_negative}, inflow.starts);
  std::optional<double> stops;
  if (inflow.stops < HUGE_VAL) stops = inflow.stops;
  keys.number({"stops", "s", "when it ends; without it, never", not_negative}, stops);
  inflow.stops = stops.value_or(HUGE_VAL);
  TomlReader* const table = keys.reader();
  if (table == nullptr) return;
  std::vector<std::string_view> names;
  for (const mpm::Body& there : scene.bodies) names.push_back(there.name);
  const auto found = std::find(names.begin(), names.end(), body);
  inflow.body = static_cast<std::size_t>(found - names.begin());
  if (found == names.end()) {
    const std::string near = nearest_name(body, names);
    table->report("body",
                  fmt::format("{} = \"{}\" is no body: there is \"{}\"{}", table->path_of("body"),
                              body, fmt::join(names, "\", \""),
                              near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
  }
}

/// A place of a probe or tracer, by which its file is named.
void probe_keys(Keys& keys, mpm::Probe& probe, std::size_t axes) {
  keys.text({"name", "-", "of its file"}, probe.name);
  keys.place({"place", "m", "where it is; of a tracer, at the start", {}, required}, axes,
             probe.place);
  if (TomlReader* const table = keys.reader(); table != nullptr && !fits_file_name(probe.name))
    table->report("name", fmt::format("{} = \"{}\" becomes part of a file name: letters, digits, "
                                      "'.', '_' and '-' only, no '.' in front",
                                      table->path_of("name"), probe.name));
}

void grid_keys(Keys& keys, mpm::Scene& scene) {
  keys.number({"h", "m", "cell size", positive, required}, scene.h);
  if (keys.reader() != nullptr && scene.dimensions() == 3) scene.points_per_cell = 8;
  keys.integer({"points_per_cell", "-", "a square number: 1, 4, 9, 16; in space a cube: 1, 8, 27"},
               {1, 100}, scene.points_per_cell);
  keys.choice({"kernel", "-", "spline of the grid"}, mpm::kernel_names, scene.kernel);
}

/// An override replaces the file's choice between a Courant number and a fixed step; within one
/// place the two contradict each other.
void choose_step(TomlReader& table, mpm::Scene& scene, double default_courant) {
  if (!table.has("courant") || !table.has("dt")) return;
  const bool courant_set = table.file().origin(table.path_of("courant")).is_override();
  const bool dt_set = table.file().origin(table.path_of("dt")).is_override();
  if (courant_set == dt_set)
    table.report("dt", "give either step.courant or step.dt: a fixed step leaves no choice");
  else if (courant_set)
    scene.dt.reset();
  else
    scene.courant = default_courant;
}

void step_keys(Keys& keys, mpm::Scene& scene) {
  TomlReader* const table = keys.reader();
  // without gravity there is no time from which a relaxation time could follow
  if (table != nullptr && scene.gravity == 0.0) scene.transfer = mpm::Transfer::apic;
  keys.choice({"transfer", "-", "of velocities between points and grid"}, mpm::transfer_names,
              scene.transfer);
  const bool relaxed = scene.transfer == mpm::Transfer::relaxed;
  const bool has_order =
      scene.transfer == mpm::Transfer::xpic || scene.transfer == mpm::Transfer::fmpm;
  // left out where it follows from h, so that it goes on following in a chart over h
  keys.number(Key{"relaxation_time", "s",
                  "of the points' own velocity towards the grid's; 0.03 √(h/g)", positive}
                  .only_if(relaxed, "only step.transfer = \"relaxed\" has a relaxation time"),
              scene.relaxation_time);
  if (table != nullptr && relaxed && !scene.relaxation_time && scene.gravity == 0.0)
    table->report("transfer", "without gravity, relaxed needs step.relaxation_time [s]");
  keys.integer(Key{"order", "-", "of the transfer, 1 is pic"}.only_if(
                   has_order, "only step.transfer = \"xpic\" and \"fmpm\" have an order"),
               {1, 100}, scene.order);
  keys.number(
      {"pressure_averaging", "-", "of neighbouring points, per unit of shear strain; 0 for none",
       Range{0.0, 1e9, false, false}},
      scene.pressure_averaging);
  if (table != nullptr && table->has("sleep_speed")) {
    table->expect("sleep_speed");
    table->report(
        "sleep_speed",
        "sleep_speed is no more: blocks that slept kept the stress of the moment when they "
        "fell asleep, 5 % of p off; leave the key out");
  }
  keys.choice({"storage", "-", "of points between steps"}, mpm::storage_names, scene.storage);
  keys.choice({"viscosity", "-", "how viscous stress acts"}, mpm::viscosity_names, scene.viscosity);
  keys.number(Key{"viscosity_tolerance", "-",
                  "error of an implicit step's velocity over what its forces bring",
                  Range{0.0, 0.1, true, false}}
                  .only_if(scene.viscosity == mpm::Viscosity::implicit_solve,
                           "only step.viscosity = \"implicit\" has a tolerance"),
              scene.viscosity_tolerance);
  // A fluid's point alone, and the bulk of all, lose √(2/3) of their step with the third direction
  // (step_size.hpp).
  if (table != nullptr && scene.dimensions() == 3) scene.courant = 0.65;
  const double default_courant = scene.courant;
  if (table != nullptr || keys.describes() || !scene.dt)
    keys.number({"courant", "-", "share of the largest stable step", mpm::courant_range},
                scene.courant);
  keys.number({"dt", "s", "fixed step, in place of courant", positive}, scene.dt);
  if (table != nullptr) choose_step(*table, scene, default_courant);
}

void output_keys(Keys& keys, SceneFile& file) {
  keys.number({"frame_interval", "s", "time between frames, 0 for none", not_negative},
              file.scene.frame_interval);
  keys.boolean(Key{"grid_frames", "-", "frames of the grid as well, its mass and velocity"}.only_if(
                   file.scene.frame_interval > 0.0 || keys.describes(),
                   "only a run with frames (output.frame_interval) has frames of its grid"),
               file.scene.grid_frames);
  keys.number({"series_interval", "s", "time between rows of series.csv, 0 for two rows only",
               not_negative},
              file.scene.series_interval);
  keys.number(
      {"checkpoint_interval", "s",
       "wall-clock time between checkpoints, from which a run that was killed is resumed; 0 "
       "for none",
       not_negative},
      file.checkpoint_interval);
  keys.boolean({"final_state", "-", "final_state.h5, which another scene can start_from"},
               file.final_state);
  keys.boolean({"shear_strain", "-", "of every point since the start, in frames"},
               file.scene.shear_strain);
  keys.choice(
      {"stress", "-",
       "of frames and final.svg: averaged over a point's neighbourhood, as the grid sees it, "
       "or the points' own, with noise that no force shows"},
      mpm::stress_names, file.stress);
  if (keys.reader() != nullptr && file.scene.bodies.size() > 1) file.colour = PictureField::body;
  keys.choice({"colour", "-",
               "of the points of final.svg: a quantity, or a colour for each body, as where there "
               "are several and nothing else is asked for"},
              picture_field_names, file.colour);
}

}  // namespace

void scene_keys(Keys& keys, SceneFile& file) {
  mpm::Scene& scene = file.scene;
  keys.table({"scene", "-", "what is simulated", {}, required},
             [&](Keys& below) { general_keys(below, scene); });
  const Key terrain{"terrain", "-", "in space: ground and release from maps"};
  if (TomlReader* const reader = keys.reader()) reader->expect(terrain.name);
  if (keys.reader() != nullptr ? keys.reader()->has(terrain.name)
                               : keys.describes() || scene.terrain.has_value()) {
    mpm::Terrain held = scene.terrain.value_or(mpm::Terrain{});
    keys.table(terrain, [&](Keys& below) { terrain_keys(below, held); });
    if (!keys.describes()) scene.terrain = std::move(held);
  }
  Key domain{"domain", "-", "the box and its edges", {}, required};
  if (scene.terrain) domain.presence = Presence::defaulted;
  keys.table(domain.only_if(true, "required; with [terrain] it may be left to the map"),
             [&](Keys& below) { domain_keys(below, scene); });
  keys.tables(
      {"body", "-", "a block of material", {}, required}, scene.bodies.size(),
      [&](std::size_t count) {
        for (std::size_t i = scene.bodies.size(); i < count; ++i)
          scene.bodies.emplace_back().name = fmt::format("body{}", i);
      },
      [&](Keys& below, std::size_t i) { body_keys(below, scene.bodies[i], scene.dimensions()); });
  keys.tables(
      {"surface", "-", "a rigid surface, at rest or moving, by which bodies are cut"},
      scene.surfaces.size(),
      [&](std::size_t count) {
        for (std::size_t i = scene.surfaces.size(); i < count; ++i)
          scene.surfaces.emplace_back().name = fmt::format("surface{}", i);
      },
      [&](Keys& below, std::size_t i) {
        surface_keys(below, scene.surfaces[i], scene.dimensions());
      });
  keys.tables(
      {"inflow", "-", "material that comes in through an edge"}, scene.inflows.size(),
      [&](std::size_t count) {
        for (std::size_t i = scene.inflows.size(); i < count; ++i)
          scene.inflows.emplace_back().name = fmt::format("inflow{}", i);
      },
      [&](Keys& below, std::size_t i) { inflow_keys(below, scene.inflows[i], scene); });
  const auto probes = [&](const Key& key, std::vector<mpm::Probe>& list) {
    keys.tables(
        key, list.size(),
        [&](std::size_t count) {
          for (std::size_t i = list.size(); i < count; ++i)
            list.emplace_back().name = fmt::format("{}", i);
        },
        [&](Keys& below, std::size_t i) { probe_keys(below, list[i], scene.dimensions()); });
  };
  probes({"probe", "-", "a place that is looked at over time: probe_NAME.csv"}, scene.probes);
  probes({"tracer", "-", "the point nearest to a place, followed: tracer_NAME.csv"}, scene.tracers);
  keys.table({"grid", "-", "cells and points", {}, required},
             [&](Keys& below) { grid_keys(below, scene); });
  keys.table({"step", "-", "how a step is made"}, [&](Keys& below) { step_keys(below, scene); });
  keys.table({"output", "-", "what is written"}, [&](Keys& below) { output_keys(below, file); });
}

SceneFile read_scene(InputFile& file) {
  SceneFile result;
  mpm::Scene& scene = result.scene;
  TomlReader root(file);
  root.expect("chart");        // read_chart.hpp
  root.expect("sweep");        // read_sweep.hpp
  root.expect("sensitivity");  // read_sensitivity.hpp
  scene.name = default_name(file);
  ReadKeys keys(root);
  scene_keys(keys, result);
  if (file.ok() && scene.terrain) mpm::fit_to_terrain(scene);
  if (file.ok()) {
    const double height = scene.domain[1];
    if (mpm::raise_top_to_cells(scene))
      result.notes.push_back(fmt::format(
          "domain.size: the box is {:.10g} m high instead of {:.10g} m, a whole number of "
          "cells (h = {:.10g} m)",
          scene.domain[1], height, scene.h));
    for (mpm::Body& body : scene.bodies)
      if (body.solid) set_solid(body, mpm::Solid(*body.solid), scene.domain);
    try {
      mpm::validate(scene);
    } catch (const InputError& error) {
      file.report(error);
    }
  }
  if (!scene.start_from.empty())
    result.notes.push_back(
        fmt::format("scene.start_from: bodies start as {} has left them, whatever "
                    "shape, velocity and initial state is given here",
                    scene.start_from));
  for (const mpm::Body& body : scene.bodies)
    if (body.law.name == umat::law_name && scene.pressure_averaging > 0.0)
      file.report("step.pressure_averaging",
                  "step.pressure_averaging needs to know which part of a strain is elastic, and a "
                  "umat does not say: leave it out");
  file.throw_if_bad();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const LawSpec& law = scene.bodies[i].law;
    for (const std::string& doubt : doubts(find_law(law), checked_parameters(law), {}))
      result.notes.push_back(fmt::format("body[{}].{}", i, doubt));
  }
  return result;
}

}  // namespace repose::input
