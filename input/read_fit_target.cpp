#include "input/read_fit_target.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "input/collapse_simulator.hpp"
#include "input/read_keys.hpp"
#include "input/read_scene.hpp"
#include "input/resolved_scene.hpp"
#include "io/atomic_file.hpp"

namespace repose::input {

using calibration::Target;
using point::Quantity;

namespace {

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
  NoiseParts parts;
  ReadKeys keys(noise.table(channel.name));
  noise_part_keys(keys, parts);
  if (!parts.absolute && !parts.relative) {
    noise.report(channel.name,
                 fmt::format("{} needs absolute, relative or both", noise.path_of(channel.name)));
    return;
  }
  if (channel.observed.size() == 0) return;
  try {
    calibration::declare_noise(channel, parts.absolute.value_or(0.0), parts.relative.value_or(0.0));
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
  TargetTable given;
  ReadKeys keys(table);
  target_keys(keys, given);
  // a start that is free for this experiment alone is one, and so is the experiment
  bool own_start = false;
  if (const toml::node* free = table.get("free"); free != nullptr && free->is_table())
    for (const auto& [key, node] : *free->as_table()) own_start = own_start || node.is_table();
  const std::vector<FitTable> parts = read_fit_tables(table, given, !own_start);
  for (const FitTable& data : parts) {
    if (!data.note.empty()) out_.notes.push_back(data.note);
    read_part(table, given, data, parts.size() > 1);
  }
  ++tables_;
}

/// A target, or those of its channels that share their rows.
void TargetReader::read_part(TomlReader& table, const TargetTable& given, const FitTable& data,
                             bool one_of_several) {
  Target target;
  TargetAbout about;
  const std::string& x = given.x;
  const std::vector<std::string>& y = data.channels;
  about.table = tables_;
  about.data = given.data;
  about.lines = data.lines;
  about.x_label = x;
  target.name = given.name.empty() ? std::filesystem::path(given.data).stem().string() : given.name;
  if (one_of_several) target.name += ": " + y.front();
  target.weight = given.weight;
  target.held_out = given.held_out;
  const auto compare = given.compare;
  const bool scene = !given.scene.empty();
  const auto x_quantity = scene ? std::optional<Quantity>() : quantity(table, "x", x);
  std::vector<Quantity> y_quantities;
  for (const std::string& name : y)
    if (const auto q = scene ? std::optional<Quantity>() : quantity(table, "y", name))
      y_quantities.push_back(*q);
  target.channels = read_channels(table, y, data);
  target.x_name = x;
  target.x =
      Eigen::Map<const Eigen::VectorXd>(data.x.data(), static_cast<Eigen::Index>(data.x.size()));
  bind_law(target);
  if (scene) {
    read_scene_target(table, given, data, std::move(target), std::move(about));
    return;
  }
  read_point_target(table, data, {x_quantity, std::move(y_quantities), compare}, std::move(target),
                    std::move(about));
}

void TargetReader::bind_law(Target& target) const {
  target.inputs = theta_;
  for (std::size_t i = 0; i < out_.free.size(); ++i)
    if (!out_.law_key[i].empty())
      target.bindings.push_back(
          {point::parameter_index(out_.info->parameters, out_.law_key[i]), static_cast<int>(i)});
}

/// A target without data: rows at even x, and what their noise would be.
void TargetReader::read_candidate(TomlReader& table) {
  CandidateTable given;
  ReadKeys keys(table);
  candidate_keys(keys, given);
  Target target;
  target.name = given.name;
  target.x_name = given.x;
  target.held_out = true;  // nothing of its own can be fitted
  FitTable data;
  data.channels = given.y;
  for (int i = 1; i <= given.rows; ++i)
    data.x.push_back(given.from + (given.to - given.from) * i / given.rows);
  if (table.has("to") && given.to == given.from)
    table.report("to",
                 fmt::format("{} must differ from {}", table.path_of("to"), table.path_of("from")));
  target.x =
      Eigen::Map<const Eigen::VectorXd>(data.x.data(), static_cast<Eigen::Index>(data.x.size()));
  const auto x = quantity(table, "x", given.x);
  std::vector<Quantity> y;
  TomlReader noise = table.table("noise");
  for (const std::string& name : given.y) {
    if (const auto q = quantity(table, "y", name)) y.push_back(*q);
    calibration::Channel channel;
    channel.name = name;
    channel.observed = Eigen::VectorXd::Zero(target.x.size());
    channel.noise =
        noise.number({name, "-", "standard deviation of the measurement", positive, {}});
    target.channels.push_back(std::move(channel));
  }
  bind_law(target);
  const std::size_t before = out_.targets.size();
  read_point_target(table, data, {x, std::move(y), calibration::Compare::rows}, std::move(target),
                    {});
  if (out_.targets.size() == before) return;
  out_.candidates.push_back(std::move(out_.targets.back()));
  out_.candidates.back().held_out = false;
  out_.targets.pop_back();
  out_.coarse.pop_back();
  out_.about.pop_back();
}

/// A full simulation: series.csv's columns over time_s, or depth_m over x_m at the end.
void TargetReader::read_scene_target(TomlReader& table, const TargetTable& given,
                                     const FitTable& data, Target target, TargetAbout about) {
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
  std::filesystem::path path = given.scene;
  if (path.is_relative()) path = std::filesystem::path(file_.name()).parent_path() / path;
  std::vector<std::string> coarse = given.set;
  coarse.insert(coarse.end(), given.coarse.begin(), given.coarse.end());
  if (!file_.ok() || data.x.empty()) return;
  const auto simulator = [&](const std::vector<std::string>& with) {
    InputFile input = [&] {
      try {
        return InputFile::read(path, with);
      } catch (const io::IoError& error) {
        throw io::IoError(path, fmt::format("{}, which {} names", error.reason(),
                                            to_string(file_.origin(table.path_of("scene")))));
      }
    }();
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
  target.simulator = simulator(given.set);
  out_.targets.push_back(target);
  has_coarse_ = has_coarse_ || !given.coarse.empty();
  if (!given.coarse.empty()) target.simulator = simulator(coarse);
  out_.coarse.push_back(std::move(target));
  out_.about.push_back(std::move(about));
}

}  // namespace repose::input
