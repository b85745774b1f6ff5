#include "input/read_fit_target.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "input/collapse_simulator.hpp"
#include "input/read_scene.hpp"
#include "input/resolved_scene.hpp"

namespace repose::input {

using calibration::Target;
using point::Quantity;

namespace {

/// A list of "key=value", as for --set.
std::vector<std::string> read_texts(TomlReader& table, std::string_view key) {
  std::vector<std::string> texts;
  const toml::node* node = table.get(key);
  if (node == nullptr) return texts;
  if (node->is_array())
    for (const auto& entry : *node->as_array())
      if (const auto text = entry.value<std::string>()) texts.push_back(*text);
  if (!node->is_array() || texts.size() != node->as_array()->size())
    table.report(key, fmt::format("{} must be a list of overrides, as in [\"grid.h=0.0125\"]; "
                                  "got {}",
                                  table.path_of(key), describe(*node)));
  return texts;
}

std::vector<std::string> read_names(TomlReader& table, std::string_view key) {
  table.expect(key);
  const toml::node* node = table.get(key);
  std::vector<std::string> names;
  if (node != nullptr && node->is_string()) names.push_back(*node->value<std::string>());
  if (node != nullptr && node->is_array())
    for (const auto& entry : *node->as_array())
      if (const auto name = entry.value<std::string>()) names.push_back(*name);
  const bool good =
      !names.empty() && (!node->is_array() || node->as_array()->size() == names.size());
  if (!good)
    table.report(
        key, fmt::format("{} must be a column or a list of columns, as in [\"q_Pa\", "
                         "\"u_Pa\"]{}",
                         table.path_of(key), node == nullptr ? "" : "; got " + describe(*node)));
  return names;
}

std::optional<Quantity> quantity(TomlReader& table, std::string_view key, const std::string& name) {
  if (name.empty()) return {};
  const auto found = point::find_quantity(name);
  if (found && std::string_view(name) == point::column_name(*found)) return found;
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < point::quantity_count; ++i)
    known.push_back(point::column_name(static_cast<Quantity>(i)));
  const std::string near = found ? std::string(point::column_name(*found)) : closest(name, known);
  table.report(key, fmt::format("{}: a simulation has no column '{}'{}", table.path_of(key), name,
                                near.empty() ? fmt::format("; it has {}", fmt::join(known, ", "))
                                             : fmt::format("; did you mean '{}'?", near)));
  return {};
}

/// noise = { q_Pa = 2e3, mu = { absolute = 0.001, relative = 0.01 } }
void read_noise(TomlReader& noise, calibration::Channel& channel) {
  const toml::node* node = noise.get(channel.name);
  if (node == nullptr || !node->is_table()) {
    channel.noise = noise.optional_number(
        {channel.name, "-", "standard deviation of the measurement", positive, {}});
    return;
  }
  TomlReader parts = noise.table(channel.name);
  const auto absolute = parts.optional_number(
      {"absolute", "-", "standard deviation of the measurement", positive, {}});
  const auto relative = parts.optional_number(
      {"relative", "-", "standard deviation as a share of the value", positive, {}});
  if (!absolute && !relative) {
    noise.report(channel.name,
                 fmt::format("{} needs absolute, relative or both", noise.path_of(channel.name)));
    return;
  }
  if (channel.observed.size() == 0) return;
  try {
    calibration::declare_noise(channel, absolute.value_or(0.0), relative.value_or(0.0));
  } catch (const InputError& error) {
    noise.report(channel.name, fmt::format("{}: {}", noise.path_of(channel.name), error.what()));
  }
}

std::vector<calibration::Channel> read_channels(TomlReader& table,
                                                const std::vector<std::string>& y,
                                                const FitTable& data) {
  std::vector<calibration::Channel> channels;
  TomlReader noise = table.table("noise");
  TomlReader weights = table.table("weights");
  for (std::size_t c = 0; c < y.size(); ++c) {
    calibration::Channel channel;
    channel.name = y[c];
    channel.weight = weights.number({y[c], "-", "weight of the channel", positive, 1.0});
    if (c < data.y.size())
      channel.observed = Eigen::Map<const Eigen::VectorXd>(
          data.y[c].data(), static_cast<Eigen::Index>(data.y[c].size()));
    read_noise(noise, channel);
    channels.push_back(std::move(channel));
  }
  return channels;
}

}  // namespace

void TargetReader::read(TomlReader& table) {
  Target target;
  TargetAbout about;
  const std::string x = table.text("x", "the abscissa's column, as in curve.csv");
  std::vector<std::string> y = read_names(table, "y");
  about.data = table.text("data", "a CSV table");
  about.x_label = x;
  target.name =
      table.text("name", "for reports", std::filesystem::path(about.data).stem().string());
  target.weight = table.number({"weight", "-", "weight of the target", positive, 1.0});
  target.held_out = table.boolean("held_out", false);
  constexpr std::array comparisons{calibration::Compare::rows, calibration::Compare::interpolate,
                                   calibration::Compare::distance};
  const auto compare = comparisons[table.choice("compare", {"rows", "interpolate", "distance"}, 0)];
  const FitTable data = read_fit_table(table, x, y);
  const bool scene = table.has("scene");
  const auto x_quantity = scene ? std::optional<Quantity>() : quantity(table, "x", x);
  std::vector<Quantity> y_quantities;
  for (const std::string& name : y)
    if (const auto q = scene ? std::optional<Quantity>() : quantity(table, "y", name))
      y_quantities.push_back(*q);
  target.channels = read_channels(table, y, data);
  target.x_name = x;
  target.x =
      Eigen::Map<const Eigen::VectorXd>(data.x.data(), static_cast<Eigen::Index>(data.x.size()));
  target.inputs = theta_;
  for (std::size_t i = 0; i < out_.free.size(); ++i)
    if (!out_.law_key[i].empty())
      target.bindings.push_back(
          {point::parameter_index(out_.info->parameters, out_.law_key[i]), static_cast<int>(i)});
  for (const char* key : {"scene", "set", "coarse"}) table.expect(key);
  if (scene) {
    read_scene_target(table, data, std::move(target), std::move(about));
    return;
  }
  read_point_target(table, data, {x_quantity, std::move(y_quantities), compare}, std::move(target),
                    std::move(about));
}

/// A full simulation: series.csv's columns over time_s, or depth_m over x_m at the end.
void TargetReader::read_scene_target(TomlReader& table, const FitTable& data, Target target,
                                     TargetAbout about) {
  const bool profile = target.x_name == "x_m";
  const auto known = collapse_channels();
  if (!profile && target.x_name != "time_s")
    table.report("x", fmt::format("{} must be \"time_s\" or, for the final profile, \"x_m\"",
                                  table.path_of("x")));
  for (const auto& channel : target.channels) {
    const bool fits = profile ? channel.name == "depth_m"
                              : std::find(known.begin(), known.end(), channel.name) != known.end();
    if (!fits)
      table.report("y",
                   fmt::format("{}: a run has no '{}' over {}; there are {}", table.path_of("y"),
                               channel.name, target.x_name,
                               profile ? "depth_m" : fmt::format("{}", fmt::join(known, ", "))));
  }
  if (!profile && !data.x.empty() &&
      !(std::is_sorted(data.x.begin(), data.x.end()) && data.x.front() > 0.0))
    table.report("data", fmt::format("{}: times must grow and be > 0 s", table.path_of("data")));
  const std::string name = table.text("scene", "a scene file");
  std::filesystem::path path = name;
  if (path.is_relative()) path = std::filesystem::path(file_.name()).parent_path() / path;
  const std::vector<std::string> sets = read_texts(table, "set");
  std::vector<std::string> coarse = sets;
  for (std::string& text : read_texts(table, "coarse")) coarse.push_back(std::move(text));
  if (!file_.ok() || data.x.empty()) return;
  const auto simulator = [&](const std::vector<std::string>& with) {
    InputFile input = InputFile::read(path, with);
    CollapseExperiment e;
    e.scene = read_scene(input);
    // the fit file alone does not tell all that its starts depend on
    out_.fingerprint += resolved_input(e.scene, "");
    e.law = out_.law;
    for (const auto& channel : target.channels) e.channels.push_back(channel.name);
    if (!profile) e.times = data.x;
    e.cache = cache_;
    e.count = out_.runs;
    return std::shared_ptr<const calibration::Simulator>(make_collapse_simulator(std::move(e)));
  };
  if (profile) target.compare = calibration::Compare::interpolate;
  target.simulator = simulator(sets);
  out_.targets.push_back(target);
  has_coarse_ = has_coarse_ || coarse.size() > sets.size();
  if (coarse.size() > sets.size()) target.simulator = simulator(coarse);
  out_.coarse.push_back(std::move(target));
  out_.about.push_back(std::move(about));
}

}  // namespace repose::input
