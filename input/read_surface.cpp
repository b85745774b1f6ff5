#include "input/read_surface.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "input/key_info.hpp"
#include "input/source_file.hpp"
#include "input/toml_reader.hpp"
#include "input/toml_text.hpp"
#include "io/measured_table.hpp"
#include "io/stl.hpp"

namespace repose::input {
namespace {

/// Of what a file gives as corners; none if that is anything else.
std::vector<std::array<double, 2>> corners_of(const toml::node& node) {
  std::vector<std::array<double, 2>> corners;
  const toml::array* const list = node.as_array();
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const toml::array* const pair = list->get_as<toml::array>(i);
    if (pair == nullptr || pair->size() != 2) return {};
    std::array<double, 2> corner{};
    for (std::size_t k = 0; k < 2; ++k) {
      const toml::node& x = *pair->get(k);
      if (!x.is_number()) return {};
      corner[k] = *x.value<double>();
      if (!std::isfinite(corner[k])) return {};
    }
    corners.push_back(corner);
  }
  return corners;
}

/// Corners [[x, y], …], three at least.
void corners_key(Keys& keys, const Key& key, mpm::Polygon& polygon) {
  KeyInfo info;
  info.kind = ValueKind::corner_list;
  info.least = 3;
  keys.value(
      key,
      [&](TomlReader& table) {
        polygon.corners = corners_of(*table.get(key.name));
        if (polygon.corners.size() < info.least)
          table.report(key.name,
                       fmt::format("{} must be a list of three or more corners, each [x, y] in "
                                   "metres: [[0, 0], [1, 0], [0, 1]]",
                                   table.path_of(key.name)));
      },
      [&] {
        std::string text;
        for (const auto& [x, y] : polygon.corners)
          text +=
              fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", toml_number(x), toml_number(y));
        return "[" + text + "]";
      },
      info);
}

/// The shape that a solid has, or one to be filled.
template <class Shape>
Shape shape_in(const mpm::Solid& solid) {
  const Shape* const held = std::get_if<Shape>(&solid.shape);
  return held != nullptr ? *held : Shape{};
}

constexpr std::array<std::string_view, 6> solid_names{"half_space", "ball",     "polygon",
                                                      "curve",      "cylinder", "mesh"};
constexpr std::size_t names_of_plane = 4;  // those that the plane has too

/// `shape` of one that may be any of them.
std::string_view solid_name_key(Keys& keys, std::size_t axes, const mpm::Solid& solid) {
  std::size_t shape = solid.shape.index();
  const std::span<const std::string_view> names(solid_names);
  keys.word({"shape", "-",
             "all behind a plane (in the plane, a line); a sphere (a disc); a polygon or a curve "
             "from a table, in space prisms along z without end; in space a cylinder or a mesh"},
            keys.describes() || axes == 3 ? names : names.first(names_of_plane), shape);
  return solid_names[std::min(shape, solid_names.size() - 1)];
}

void hollow_key(Keys& keys, mpm::Solid& solid) {
  keys.boolean({"hollow", "-", "what lies outside of the shape, instead of inside: a drum"},
               solid.hollow);
}

}  // namespace

std::shared_ptr<const mpm::PolyLine> line_of(std::string bytes, const std::string& name,
                                             const mpm::Curve& curve, bool closed) {
  const io::RawTable table = io::parse_table(std::move(bytes), name);
  const auto column = [&](const char* what, const std::string& from) {
    return read_column(
        table,
        {.name = what, .from = from, .unit = curve.unit, .dimension = io::dimension::length});
  };
  const io::MeasuredColumn x = column("x", curve.x), y = column("y", curve.y);
  for (const io::MeasuredColumn* const one : {&x, &y})
    if (one->dropped > 0) {
      std::size_t row = 0;  // the first that is not there
      while (row < one->file_rows.size() && one->file_rows[row] == table.file_row(row)) ++row;
      throw io::TableError(name, table.file_row(row), table.column_title(one->column),
                           "a point of a curve has no number here", "");
    }
  std::vector<std::array<double, 2>> points;
  for (std::size_t k = 0; k < x.values.size(); ++k) points.push_back({x.values[k], y.values[k]});
  // an outline may end where it began; a profile may come from the right
  if (closed && points.size() > 1 && points.front() == points.back()) points.pop_back();
  const bool backwards = !closed && points.size() > 1 && points.front()[0] > points.back()[0];
  if (backwards) std::reverse(points.begin(), points.end());
  if (const auto fault = mpm::PolyLine::fault_of(points, closed)) {
    const std::size_t given = std::min(fault->point, x.file_rows.size() - 1);
    throw io::TableError(name, x.file_rows[backwards ? x.file_rows.size() - 1 - given : given], "",
                         fault->what, "");
  }
  return std::make_shared<const mpm::PolyLine>(std::move(points), closed);
}

std::shared_ptr<const mpm::TriangleMesh> mesh_of(const std::string& bytes, const std::string& name,
                                                 const mpm::Mesh& mesh) {
  io::Triangles read = io::parse_stl(bytes, name);
  for (mpm::Position& x : read.vertices)
    for (std::size_t k = 0; k < 3; ++k) x[k] = mesh.scale * x[k] + mesh.shift[k];
  if (const auto fault = mpm::TriangleMesh::fault_of(read.vertices, read.corners))
    throw io::TableError(name, 0, "", *fault, "");
  return std::make_shared<const mpm::TriangleMesh>(std::move(read.vertices),
                                                   std::move(read.corners));
}

std::string_view shape_name(const mpm::Solid& solid) { return solid_names[solid.shape.index()]; }

void shape_keys(Keys& keys, std::string_view shape, std::size_t axes, mpm::Solid& solid,
                mpm::Disc* disc) {
  TomlReader* const table = keys.reader();
  auto plane = shape_in<mpm::HalfSpace>(solid);
  auto ball = shape_in<mpm::Ball>(solid);
  auto polygon = shape_in<mpm::Polygon>(solid);
  auto curve = shape_in<mpm::Curve>(solid);
  auto cylinder = shape_in<mpm::Cylinder>(solid);
  auto mesh = shape_in<mpm::Mesh>(solid);
  const bool upright = shape == "cylinder" && disc != nullptr &&
                       (table != nullptr ? !table->has("axis")
                                         : !std::holds_alternative<mpm::Cylinder>(solid.shape));
  const bool is_disc = shape == "disc" || upright;
  const bool is_plane = shape == "half_space", is_ball = shape == "ball", is_mesh = shape == "mesh",
             is_cylinder = shape == "cylinder" && !upright, is_curve = shape == "curve";
  keys.place(
      Key{"point", "m", "on the plane; on a cylinder's axis, the middle of one end", {}, required}
          .only_if(is_plane || is_cylinder,
                   disc != nullptr ? "point belongs to shape = \"half_space\" and, with an axis, "
                                     "\"cylinder\""
                                   : "point belongs to shape = \"half_space\" and \"cylinder\""),
      axes, is_plane ? plane.point : cylinder.point);
  keys.place(
      Key{"normal", "-", "of the plane, away from what lies behind it; of any length", {}, required}
          .only_if(is_plane, "normal belongs to shape = \"half_space\""),
      axes, plane.normal);
  keys.vector(
      Key{"axis", "-", "of a cylinder, away from its point; of any length", {}, required}.only_if(
          is_cylinder, "axis belongs to shape = \"cylinder\""),
      3, cylinder.axis);
  const Key centre =
      Key{"centre", "m", "of the ball or disc; x and z of an upright cylinder's axis", {}, required}
          .only_if(is_ball || is_disc,
                   "centre belongs to shape = \"ball\", to a disc and to a cylinder without axis");
  if (is_disc)
    keys.pair(centre, disc->centre);
  else
    keys.place(centre, axes, ball.centre);
  keys.number(Key{"radius", "m", "of a ball, disc or cylinder", positive, required}.only_if(
                  is_ball || is_disc || is_cylinder,
                  "radius belongs to shape = \"ball\", \"cylinder\" and to a disc"),
              is_disc       ? disc->radius
              : is_cylinder ? cylinder.radius
                            : ball.radius);
  std::optional<double> length;
  if (cylinder.length < HUGE_VAL) length = cylinder.length;
  keys.number(
      Key{"length", "m", "of a cylinder; without it, endless to both sides", positive}.only_if(
          is_cylinder, "length belongs to a cylinder with an axis"),
      length);
  cylinder.length = length.value_or(HUGE_VAL);
  corners_key(keys,
              Key{"corners", "m", "of the polygon, in order: [[x, y], …]", {}, required}.only_if(
                  shape == "polygon", "corners belong to shape = \"polygon\""),
              polygon);

  constexpr std::string_view of_file = "a file belongs to shape = \"curve\" and \"mesh\"",
                             of_curve = "x, y, unit and closed belong to shape = \"curve\"",
                             of_mesh = "scale and shift belong to shape = \"mesh\"";
  mpm::SourceFile& file = is_mesh ? mesh.file : curve.file;
  keys.text(Key{"file",
                "-",
                "of a curve, a table of its points; of a mesh, an STL file: a path seen from this "
                "file",
                {},
                required}
                .only_if(is_curve || is_mesh, of_file),
            file.name);
  keys.text(Key{"file_content", "-",
                "fingerprint of its bytes, written by repose: another file is refused"}
                .only_if(is_curve || is_mesh, of_file),
            file.content);
  keys.text(Key{"x", "m", "column of the table"}.only_if(is_curve, of_curve), curve.x);
  keys.text(Key{"y", "m", "column of the table"}.only_if(is_curve, of_curve), curve.y);
  keys.text(
      Key{"unit", "-", "of both columns, where the table names none"}.only_if(is_curve, of_curve),
      curve.unit);
  bool closed = curve.line == nullptr || curve.line->closed();
  keys.boolean(Key{"closed", "-",
                   "whether the curve surrounds what it stands for; or all below it, level beyond "
                   "its ends"}
                   .only_if(is_curve, of_curve),
               closed);
  keys.number(Key{"scale", "m", "one unit of the mesh's file", positive}.only_if(is_mesh, of_mesh),
              mesh.scale);
  keys.vector(Key{"shift", "m", "of the mesh, once scaled"}.only_if(is_mesh, of_mesh), 3,
              mesh.shift);
  if (table != nullptr && table->file().ok() && is_curve)
    if (auto line = parsed(*table, "file", file, [&](std::string bytes, const std::string& name) {
          return line_of(std::move(bytes), name, curve, closed);
        }))
      curve.line = std::move(*line);
  if (table != nullptr && table->file().ok() && is_mesh)
    if (auto triangles =
            parsed(*table, "file", file, [&](const std::string& bytes, const std::string& name) {
              return mesh_of(bytes, name, mesh);
            }))
      mesh.mesh = std::move(*triangles);
  if (is_plane) solid.shape = plane;
  if (is_ball) solid.shape = ball;
  if (is_cylinder) solid.shape = cylinder;
  if (shape == "polygon") solid.shape = std::move(polygon);
  if (is_curve) solid.shape = std::move(curve);
  if (is_mesh) solid.shape = std::move(mesh);
}

void solids_key(Keys& keys, const Key& key, std::size_t axes, std::vector<mpm::Solid>& solids) {
  keys.tables(
      key, solids.size(), [&](std::size_t count) { solids.resize(count); },
      [&](Keys& below, std::size_t i) {
        shape_keys(below, solid_name_key(below, axes, solids[i]), axes, solids[i]);
        hollow_key(below, solids[i]);
      });
}

namespace {

/// A coefficient of friction is a contact of its own.
void contact_keys(Keys& keys, mpm::Surface& surface) {
  std::optional<double> friction;
  if (surface.contact == mpm::Surface::Contact::friction) friction = surface.friction;
  keys.number({"friction", "-", "Coulomb coefficient of a contact that may part; or a kind",
               Range{0.0, 1e3, false, false}},
              friction);
  contact_kind_key(keys, friction.has_value(), "a surface", surface.contact);
  surface.friction = friction.value_or(0.0);
}

}  // namespace

void contact_kind_key(Keys& keys, bool rubs, std::string_view what,
                      mpm::Surface::Contact& contact) {
  using Contact = mpm::Surface::Contact;
  static constexpr std::array<std::string_view, 2> kinds{"no_slip", "slip"};
  TomlReader* const table = keys.reader();
  if (table != nullptr && table->has("friction") && table->has("kind"))
    table->report("kind", fmt::format("give either kind or friction: {} with friction slips where "
                                      "it must",
                                      what));
  auto kind = rubs ? Contact::no_slip : contact;
  keys.choice(Key{"kind", "-", "of contact without friction, which does not part"}.only_if(
                  !rubs || table != nullptr, ""),
              kinds, kind);
  contact = rubs ? Contact::friction : kind;
}

void surface_keys(Keys& keys, mpm::Surface& surface, std::size_t axes) {
  keys.text({"name", "-", "for messages"}, surface.name);
  shape_keys(keys, solid_name_key(keys, axes, surface.solid), axes, surface.solid);
  hollow_key(keys, surface.solid);
  contact_keys(keys, surface);
  keys.place({"velocity", "m/s", "of the surface"}, axes, surface.velocity);
  keys.number({"spin", "rad/s", "of the surface about z, through its pivot"}, surface.spin);
  keys.pair({"pivot", "m", "x and y at the start; it moves along"}, surface.pivot);
  keys.number({"starts", "s", "when it begins to move", not_negative}, surface.starts);
  std::optional<double> stops;
  if (surface.stops < HUGE_VAL) stops = surface.stops;
  keys.number({"stops", "s", "when it comes to rest; without it, never", not_negative}, stops);
  surface.stops = stops.value_or(HUGE_VAL);
}

}  // namespace repose::input
