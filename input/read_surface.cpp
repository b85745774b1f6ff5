#include "input/read_surface.hpp"

#include <cmath>

#include <fmt/core.h>

#include "input/key_info.hpp"
#include "input/toml_reader.hpp"
#include "input/toml_text.hpp"

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

}  // namespace

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

namespace {

/// The keys of one shape, which are read into it, and refused of another, if `shape` has not it.
template <class Shape, class Read>
void shape_keys(mpm::Solid& solid, bool is_it, Read&& read) {
  const Shape* const held = std::get_if<Shape>(&solid.shape);
  Shape shape = held != nullptr ? *held : Shape{};
  read(shape);
  if (is_it) solid.shape = std::move(shape);
}

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
  static constexpr std::array<std::string_view, 3> shapes{"half_space", "ball", "polygon"};
  keys.text({"name", "-", "for messages"}, surface.name);
  std::size_t shape = surface.solid.shape.index();
  keys.word({"shape", "-",
             "of the rigid region: all behind a plane (in the plane, a line); a sphere (a disc); a "
             "polygon, in space a prism along z without end"},
            shapes, shape);
  const auto of = [&](const Key& key, std::size_t which, std::string_view only) {
    return key.only_if(shape == which, only);
  };
  shape_keys<mpm::HalfSpace>(surface.solid, shape == 0, [&](mpm::HalfSpace& plane) {
    constexpr std::string_view only = "point and normal belong to shape = \"half_space\"";
    keys.place(of({"point", "m", "on the plane", {}, required}, 0, only), axes, plane.point);
    keys.place(
        of({"normal", "-", "of the plane, towards the material; of any length", {}, required}, 0,
           only),
        axes, plane.normal);
  });
  shape_keys<mpm::Ball>(surface.solid, shape == 1, [&](mpm::Ball& ball) {
    constexpr std::string_view only = "centre and radius belong to shape = \"ball\"";
    keys.place(of({"centre", "m", "of the ball", {}, required}, 1, only), axes, ball.centre);
    keys.number(of({"radius", "m", "of the ball", positive, required}, 1, only), ball.radius);
  });
  shape_keys<mpm::Polygon>(surface.solid, shape == 2, [&](mpm::Polygon& polygon) {
    corners_key(keys,
                of({"corners", "m", "of the polygon, in order: [[x, y], …]", {}, required}, 2,
                   "corners belong to shape = \"polygon\""),
                polygon);
  });
  keys.boolean({"hollow", "-", "rigid is what lies outside: a drum"}, surface.solid.hollow);
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
