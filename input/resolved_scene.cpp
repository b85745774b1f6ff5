#include "input/resolved_scene.hpp"

#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "repose_version.hpp"

namespace repose::input {
namespace {

using mpm::Wall;

/// A TOML basic string.
std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + '"';
}

/// The fewest digits that read back as the same double; always a TOML float.
std::string number(double x) {
  const std::string text = fmt::format("{}", x);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string pair(const std::array<double, 2>& x) {
  return fmt::format("[{}, {}]", number(x[0]), number(x[1]));
}

std::string vector(const std::array<double, 3>& x, std::size_t axes) {
  return axes == 2 ? pair({x[0], x[1]})
                   : fmt::format("[{}, {}, {}]", number(x[0]), number(x[1]), number(x[2]));
}

std::string wall(const Wall& w) {
  switch (w.kind) {
    case Wall::Kind::no_slip:
      return w.speed == 0.0 ? toml_string("no_slip")
                            : fmt::format("{{ speed = {} }}", number(w.speed));
    case Wall::Kind::slip:
      return toml_string("slip");
    case Wall::Kind::open:
      return toml_string("open");
    case Wall::Kind::periodic:
      return toml_string("periodic");
    case Wall::Kind::friction:
      break;
  }
  return fmt::format("{{ friction = {} }}", number(w.friction));
}

std::string unit_and_doc(const ParamInfo& info) {
  return info.unit == "-" ? std::string(info.doc) : fmt::format("{}, {}", info.unit, info.doc);
}

/// "key = value" in a column, then a comment.
std::string line(std::string_view key, std::string_view value, std::string_view comment = "") {
  const std::string text = fmt::format("{} = {}", key, value);
  return comment.empty() ? text + "\n" : fmt::format("{:<27} # {}\n", text, comment);
}

std::string shape_lines(const mpm::Body& body, std::size_t axes) {
  if (!body.disc)
    return line("shape", toml_string("box")) + line("origin", vector(body.origin, axes), "m") +
           line("size", vector(body.size, axes), "m");
  return line("shape", toml_string(axes == 2 ? "disc" : "cylinder")) +
         line("centre", pair(body.disc->centre), axes == 2 ? "m" : "m, x and z") +
         line("radius", number(body.disc->radius), "m") +
         line("hole", number(body.disc->hole), "m, radius of the hole") +
         (axes == 2 ? ""
                    : line("base", number(body.origin[1]), "m") +
                          line("height", number(body.size[1]), "m"));
}

std::string initial_table(const mpm::Body& body) {
  const InitialConditions& initial = body.initial;
  std::string out;
  const auto add = [&](std::string_view key, const std::optional<double>& x,
                       std::string_view comment) {
    if (x) out += line(key, number(*x), comment);
  };
  add("p", initial.p, "Pa");
  add("sigma_v", initial.sigma_v, "Pa, vertical");
  add("ocr", initial.ocr, "p_c/p");
  add("ocr_v", initial.ocr_v, "of vertical stresses");
  add("K0_nc", initial.K0_nc, "K0 at the greatest vertical stress");
  add("v", initial.v, "specific volume");
  add("density", initial.density, "kg/m³");
  add("K0", initial.K0, "horizontal over vertical stress");
  if (initial.sigma) {
    std::string list;
    for (const double x : *initial.sigma) list += (list.empty() ? "" : ", ") + number(x);
    out += line("sigma", "[" + list + "]", "Pa: xx, yy, zz, xy, yz, zx, compression positive");
  }
  out += line("lithostatic", body.lithostatic ? "true" : "false");
  return "\n[body.initial]\n" + out;
}

void flatten(const toml::node& node, const std::string& path,
             std::map<std::string, std::string>& out) {
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) flatten(child, join_path(path, key.str()), out);
  } else if (const toml::array* list = node.as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i)
      flatten(*list->get(i), fmt::format("{}[{}]", path, i), out);
  } else if (node.is_number()) {
    out[path] = fmt::format("{}", *node.value<double>());
  } else {
    std::ostringstream text;
    node.visit([&](const auto& value) { text << value; });
    out[path] = std::move(text).str();
  }
}

}  // namespace

std::string law_table(const LawSpec& spec, std::string_view table) {
  const LawInfo& info = find_law(spec);
  const std::vector<double> theta = checked_parameters(spec);
  std::string out = fmt::format("\n[{}]\n", table) + line("name", toml_string(spec.name), info.doc);
  if (!info.option_key.empty()) {
    const bool boolean = info.option == "true" || info.option == "false";
    out += line(info.option_key, boolean ? std::string(info.option) : toml_string(info.option));
  }
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const ParamInfo& parameter = info.parameters[i];
    if (std::isnan(theta[i])) continue;
    const bool derived =
        parameter.need == Need::optional && !spec.values.contains(std::string(parameter.name));
    out += line(fmt::format("{}{}", derived ? "# " : "", parameter.name), number(theta[i]),
                fmt::format("{}{}", derived ? "derived: " : "", unit_and_doc(parameter)));
  }
  return out;
}

std::string resolved_input(const SceneFile& file, const std::string& origin) {
  const mpm::Scene& scene = file.scene;
  const std::size_t axes = scene.dimensions();
  std::string out = fmt::format(
      "# The input of this result with every default written out, by repose {}.\n# {}\n",
      version_string, origin);
  out += "\n[scene]\n" + line("name", toml_string(scene.name)) +
         line("end_time", number(scene.end_time), "s") +
         line("gravity", number(scene.gravity), "m/s²") +
         line("tilt_deg", number(scene.tilt_deg), "°, towards +x");
  out += "\n[domain]\n" + line("size", vector(scene.domain, axes), "m") +
         line("floor", wall(scene.floor)) + line("left", wall(scene.left)) +
         line("right", wall(scene.right)) + line("top", wall(scene.top)) +
         (axes == 2 ? "" : line("near", wall(scene.near)) + line("far", wall(scene.far)));
  for (const mpm::Body& body : scene.bodies) {
    out += "\n[[body]]\n" + line("name", toml_string(body.name)) + shape_lines(body, axes) +
           line("velocity", vector(body.velocity, axes), "m/s") +
           line("spin", number(body.spin), "rad/s");
    out += initial_table(body) + law_table(body.law, "body.law");
  }
  out += "\n[grid]\n" + line("h", number(scene.h), "m") +
         line("points_per_cell", std::to_string(scene.points_per_cell)) +
         line("kernel", toml_string(mpm::name_of(scene.kernel)));
  out += "\n[step]\n" + line("transfer", toml_string(mpm::name_of(scene.transfer))) +
         // left out where it follows from h, so that it goes on following in a chart over h
         (scene.transfer == mpm::Transfer::relaxed && scene.relaxation_time
              ? line("relaxation_time", number(*scene.relaxation_time), "s")
              : "") +
         (scene.transfer == mpm::Transfer::xpic || scene.transfer == mpm::Transfer::fmpm
              ? line("order", std::to_string(scene.order), "1 is pic")
              : "") +
         line("pressure_averaging", number(scene.pressure_averaging), "0 for none") +
         line("sleep_speed", number(scene.sleep_speed), "m/s, 0: no block sleeps") +
         line("storage", toml_string(mpm::storage_names[static_cast<std::size_t>(scene.storage)]),
              "of points between steps") +
         line("viscosity",
              toml_string(mpm::viscosity_names[static_cast<std::size_t>(scene.viscosity)])) +
         (scene.viscosity == mpm::Viscosity::implicit_solve
              ? line("viscosity_tolerance", number(scene.viscosity_tolerance),
                     "of the velocity change")
              : "") +
         (scene.dt ? line("dt", number(*scene.dt), "s, fixed")
                   : line("courant", number(scene.courant), "of the largest stable step"));
  out += "\n[output]\n" + line("frame_interval", number(scene.frame_interval), "s, 0 for none") +
         line("series_interval", number(scene.series_interval), "s") +
         line("colour", toml_string(file.colour == PictureField::mises ? "mises" : "density"),
              "of final.svg");
  return out;
}

std::vector<std::string> differences(const toml::table& there, const toml::table& here) {
  std::map<std::string, std::string> a, b;
  flatten(there, "", a);
  flatten(here, "", b);
  const auto value = [](const std::map<std::string, std::string>& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? std::string("nothing") : found->second;
  };
  std::map<std::string, std::string> keys = a;
  keys.insert(b.begin(), b.end());
  std::vector<std::string> lines;
  for (const auto& [key, unused] : keys)
    if (value(a, key) != value(b, key))
      lines.push_back(fmt::format("{}: {} there, {} here", key, value(a, key), value(b, key)));
  return lines;
}

}  // namespace repose::input
