#include "app/read_fit.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "app/collapse_simulator.hpp"
#include "app/fit_table.hpp"
#include "app/read_law.hpp"
#include "app/read_point_test.hpp"
#include "calibration/path_derivatives.hpp"
#include "calibration/point_simulator.hpp"
#include "mpm/atomic_file.hpp"

namespace repose::app {
namespace {

using calibration::FreeParameter;
using calibration::Target;
using point::Quantity;

std::string joined_algorithms() {
  std::string text;
  for (const auto& a : calibration::algorithms())
    text += (text.empty() ? "\"" : ", \"") + std::string(a.name) + "\"";
  return text;
}

/// One entry of [fit], or of a target's `free`.
struct FreeEntry {
  FreeParameter parameter;
  std::string of;
};

FreeEntry read_free(TomlReader entry, const std::string& name, std::string_view unit,
                    std::string_view doc, Scale scale, const Range& range) {
  FreeEntry result;
  FreeParameter& p = result.parameter;
  p.name = name;
  p.unit = unit;
  const Range finite{std::isfinite(range.lower) ? range.lower : -1e300,
                     std::isfinite(range.upper) ? range.upper : 1e300, false, false};
  result.of = entry.text("of", "another free parameter, to which this one is a ratio", "");
  const bool ratio = !result.of.empty();
  const Range bounds = ratio ? Range{0.0, 1e6, false, false} : finite;
  const std::string what = ratio ? name + "/" + result.of : std::string(doc);
  p.lower = entry.number({"lower", ratio ? "-" : unit, "lower bound of " + what, bounds, {}});
  p.upper = entry.number({"upper", ratio ? "-" : unit, "upper bound of " + what, bounds, {}});
  const std::size_t fallback = scale == Scale::log && p.lower > 0.0 && !ratio ? 1 : 0;
  p.scale = entry.choice("scale", {"linear", "log"}, fallback) == 1 ? Scale::log : Scale::linear;
  p.start = entry.optional_number({"start", ratio ? "-" : unit, "start of " + what, {}, {}});
  if (entry.has("prior")) {
    TomlReader prior = entry.table("prior");
    p.prior = calibration::Prior{
        prior.number({"mean", unit, "expected value", {}, {}}),
        prior.number({"sd", "-", "standard deviation (relative on a log scale)", positive, {}})};
  } else {
    entry.expect("prior");
  }
  if (!(p.lower < p.upper) && std::isfinite(p.lower) && std::isfinite(p.upper))
    entry.report("upper", fmt::format("{} = {} must be > lower = {}", entry.path_of("upper"),
                                      p.upper, p.lower));
  if (p.scale == Scale::log && p.lower <= 0.0)
    entry.report("lower", fmt::format("{} must be > 0 on a logarithmic scale; got {}",
                                      entry.path_of("lower"), p.lower));
  return result;
}

/// The value a parameter starts from, as far as it is known without its partner.
double start_value(const FreeParameter& p) {
  if (p.start) return *p.start;
  return p.scale == Scale::log && p.lower > 0.0 ? std::sqrt(p.lower * p.upper)
                                                : 0.5 * (p.lower + p.upper);
}

class FitReader {
 public:
  FitReader(InputFile& file, FitFile& out, std::filesystem::path cache)
      : file_(file),
        root_(file),
        out_(out),
        cache_(std::move(cache)) {}

  void run(std::uint64_t seed) {
    out_.name = std::filesystem::path(file_.name()).stem().string();
    out_.law = read_law(root_.table("law"));
    TomlReader fit = root_.table("fit");
    TomlReader solver = root_.table("solver");
    read_solver(solver, seed);
    read_uncertainty(root_.table("uncertainty"));
    std::vector<TomlReader> targets = root_.tables("target", "an experiment");
    if (!file_.ok()) {
      // what depends on a sound law cannot be checked yet
      fit.expect_any();
      for (TomlReader& t : targets) t.expect_any();
      file_.throw_if_bad();
    }
    out_.info = &find_law(out_.law);
    theta_ = parameter_vector(out_.info->name, out_.info->parameters, out_.law.values);
    read_parameters(fit);
    for (TomlReader& t : targets) read_target(t);
    file_.throw_if_bad();
    link_ratios();
    file_.throw_if_bad();
  }

 private:
  void read_solver(TomlReader& solver, std::uint64_t seed) {
    calibration::FitOptions& o = out_.options;
    const auto algorithm = [&](const char* key, std::string fallback, bool global) {
      const std::string name = solver.text(
          key, global ? "a global algorithm or \"none\"" : "a local algorithm or \"none\"",
          std::move(fallback));
      if (name == "none") return name;
      const calibration::Algorithm* a = calibration::find_algorithm(name);
      if (a == nullptr) {
        std::vector<std::string_view> known{"none"};
        for (const auto& b : calibration::algorithms()) known.push_back(b.name);
        const std::string near = nearest_name(name, known);
        solver.report(key,
                      fmt::format("{} = \"{}\" is no algorithm{}; there are \"none\", {}",
                                  solver.path_of(key), name,
                                  near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near),
                                  joined_algorithms()));
      } else if (a->global != global) {
        solver.report(key, fmt::format("{}: {} is a {} algorithm; it belongs to solver.{}",
                                       solver.path_of(key), name, a->global ? "global" : "local",
                                       a->global ? "global" : "local"));
      }
      return name;
    };
    o.global = algorithm("global", "none", true);
    o.local = algorithm("local", std::string(calibration::levenberg_marquardt_name), false);
    o.starts = static_cast<int>(solver.integer("starts", "starting points", 1, 1000000, 16));
    o.global_evaluations = solver.integer("global_evaluations", "of the global search", 1,
                                          1000000000, o.global_evaluations);
    o.local_evaluations =
        solver.integer("local_evaluations", "per start", 1, 1000000000, o.local_evaluations);
    o.x_tolerance = solver.number(
        {"tolerance", "-", "of the parameters over their bounds", Range{0.0, 0.1}, o.x_tolerance});
    out_.fine_evaluations = solver.integer("fine_evaluations",
                                           "of scenes at full resolution, after "
                                           "the search with coarse ones",
                                           1, 1000000000, out_.fine_evaluations);
    out_.balance = solver.boolean("balance", true);
    o.seed = static_cast<std::uint64_t>(solver.integer("seed", "of random numbers", 0,
                                                       std::numeric_limits<std::int64_t>::max(),
                                                       static_cast<std::int64_t>(seed)));
    if (o.global == "none" && o.local == "none")
      solver.report("local", "solver.global and solver.local cannot both be \"none\"");
  }

  void read_uncertainty(TomlReader table) {
    out_.profiles = table.boolean("profile", true);
    out_.bootstrap =
        static_cast<int>(table.integer("bootstrap", "refits of resampled data", 0, 100000, 0));
  }

  const ParamInfo* law_parameter(std::string_view name) const {
    for (const ParamInfo& p : out_.info->parameters)
      if (p.name == name) return &p;
    return nullptr;
  }

  int add(FreeEntry entry, std::string law_key, const std::string& path) {
    out_.free.push_back(std::move(entry.parameter));
    of_.push_back(std::move(entry.of));
    out_.law_key.push_back(std::move(law_key));
    path_.push_back(path);
    return static_cast<int>(out_.free.size()) - 1;
  }

  void read_parameters(TomlReader& fit) {
    fit.expect_any();
    // in the order of the law's table, so that results read alike whatever the file's order
    for (const ParamInfo& p : out_.info->parameters)
      if (fit.has(p.name))
        add(read_free(fit.table(p.name), std::string(p.name), p.unit, p.doc, p.scale, p.range),
            std::string(p.name), fit.path_of(p.name));
    for (const std::string& key : fit.keys()) {
      if (law_parameter(key) != nullptr) continue;
      if (key == "shared") {
        TomlReader shared = fit.table("shared");
        shared.expect_any();
        for (const std::string& name : shared.keys())
          shared_[name] = add(
              read_free(shared.table(name), name, "-", "the shared quantity", Scale::linear, {}),
              "", shared.path_of(name));
        continue;
      }
      std::vector<std::string_view> known{"shared"};
      for (const ParamInfo& p : out_.info->parameters) known.push_back(p.name);
      const std::string near = closest(key, known);
      fit.report(key, fmt::format("{} has no parameter '{}'{}", out_.info->name, key,
                                  near.empty() ? fmt::format("; it has {}", fmt::join(known, ", "))
                                               : fmt::format("; did you mean '{}'?", near)));
    }
  }

  void read_target(TomlReader& table) {
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
    const std::size_t compare = table.choice("compare", {"rows", "interpolate", "distance"}, 0);
    const FitTable data = read_fit_table(table, x, y);
    const bool scene = table.has("scene");
    const auto x_quantity = scene ? std::optional<Quantity>() : quantity(table, "x", x);
    std::vector<Quantity> y_quantities;
    for (const std::string& name : y)
      if (const auto q = scene ? std::optional<Quantity>() : quantity(table, "y", name))
        y_quantities.push_back(*q);
    TomlReader noise = table.table("noise");
    TomlReader weights = table.table("weights");
    for (std::size_t c = 0; c < y.size(); ++c) {
      calibration::Channel channel;
      channel.name = y[c];
      channel.noise =
          noise.optional_number({y[c], "-", "standard deviation of the measurement", positive, {}});
      channel.weight = weights.number({y[c], "-", "weight of the channel", positive, 1.0});
      if (c < data.y.size())
        channel.observed = Eigen::Map<const Eigen::VectorXd>(
            data.y[c].data(), static_cast<Eigen::Index>(data.y[c].size()));
      target.channels.push_back(std::move(channel));
    }
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
    target.inputs.resize(theta_.size() + calibration::initial_input_count, std::nan(""));
    calibration::PointExperiment e;
    e.law = out_.info;
    e.theta = theta_;
    e.test.initial = read_initial_conditions(table.table("initial"));
    e.test.settings = read_settings(table.table("integration"));
    read_initial_freedom(table, target, e.test.initial);
    const bool sound = x_quantity && y_quantities.size() == y.size() && !data.x.empty();
    if (sound)
      read_test(table, *x_quantity, data, compare, e, target);
    else
      table.table("test").expect_any();
    if (!sound || !file_.ok()) return;
    e.x = *x_quantity;
    e.y = std::move(y_quantities);
    e.abscissae = data.x;
    e.lines = data.lines;
    try {
      std::vector<double> start = theta_;
      complete_start(start);
      point::check_start(*out_.info, start, e.test);
      target.simulator = calibration::make_point_simulator(std::move(e));
    } catch (const InputError& error) {
      const bool parameter = point::parameter_index(out_.info->parameters, error.key()) >= 0;
      if (error.key() == "data" || error.key() == "initial")
        file_.report(error, table.path());
      else
        file_.report(error, parameter ? "fit" : join_path(table.path(), "initial"));
      return;
    }
    out_.coarse.push_back(target);
    out_.targets.push_back(std::move(target));
    out_.about.push_back(std::move(about));
  }

  /// A full simulation: series.csv's columns over time_s, or depth_m over x_m at the end.
  void read_scene_target(TomlReader& table, const FitTable& data, Target target,
                         TargetAbout about) {
    const bool profile = target.x_name == "x_m";
    const auto known = collapse_channels();
    if (!profile && target.x_name != "time_s")
      table.report("x", fmt::format("{} must be \"time_s\" or, for the final profile, \"x_m\"",
                                    table.path_of("x")));
    for (const auto& channel : target.channels) {
      const bool fits = profile
                            ? channel.name == "depth_m"
                            : std::find(known.begin(), known.end(), channel.name) != known.end();
      if (!fits)
        table.report("y",
                     fmt::format("{}: a run has no '{}' over {}; there are {}", table.path_of("y"),
                                 channel.name, target.x_name,
                                 profile ? "depth_m" : fmt::format("{}", fmt::join(known, ", "))));
    }
    if (!profile && !(std::is_sorted(data.x.begin(), data.x.end()) && data.x.front() > 0.0))
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
      e.law = out_.law;
      for (const auto& channel : target.channels) e.channels.push_back(channel.name);
      if (!profile) e.times = data.x;
      e.cache = cache_;
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

  /// Parameters at the start of the fit with the law's derived ones.
  void complete_start(std::vector<double>& theta) const {
    visit_law(*out_.info, [&]<class L>(L) {
      L::complete(theta);
      return 0;
    });
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

  std::optional<Quantity> quantity(TomlReader& table, std::string_view key,
                                   const std::string& name) {
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

  /// free = { ocr = { lower, upper } } or { ocr = "name of a shared quantity" }
  void read_initial_freedom(TomlReader& table, Target& target, InitialConditions& initial) {
    TomlReader free = table.table("free");
    for (int i = 0; i < calibration::initial_input_count; ++i) {
      const std::string key(calibration::initial_input_names[static_cast<std::size_t>(i)]);
      free.expect(key);
      if (!free.has(key)) continue;
      int parameter = -1;
      if (const auto name = free.get(key)->value<std::string>()) {
        const auto found = shared_.find(*name);
        if (found == shared_.end()) {
          std::vector<std::string_view> known;
          for (const auto& [shared, unused] : shared_) known.push_back(shared);
          const std::string near = closest(*name, known);
          free.report(
              key,
              fmt::format("{} = \"{}\" names no quantity of [fit.shared]{}", free.path_of(key),
                          *name, near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
          continue;
        }
        parameter = found->second;
      } else {
        if (target.held_out) {
          free.report(key, fmt::format("{}: a held-out target is predicted, so nothing of its own "
                                       "can be fitted; tie it to a quantity of [fit.shared]",
                                       free.path_of(key)));
          continue;
        }
        const bool pressure = key == "p" || key == "p_c0";
        const Range range = key == "ocr" || key == "v" ? Range{1.0, 1e300, false, false} : positive;
        parameter =
            add(read_free(free.table(key), key + " of " + target.name, pressure ? "Pa" : "-",
                          "the initial " + key, pressure ? Scale::log : Scale::linear, range),
                "", free.path_of(key));
      }
      const int input = static_cast<int>(out_.info->parameters.size()) + i;
      target.bindings.push_back({input, parameter});
      const double start = start_value(out_.free[static_cast<std::size_t>(parameter)]);
      if (key == "p") initial.p = start;
      if (key == "ocr") initial.ocr = start;
      if (key == "v") initial.v = start;
      if (key == "K0") initial.K0 = start;
      if (key == "p_c0") {
        if (!initial.p)
          free.report(key, fmt::format("{} needs initial.p: ocr = p_c0/p", free.path_of(key)));
        else
          initial.ocr = std::max(1.0, start / *initial.p);
      }
    }
  }

  void read_test(TomlReader& table, Quantity x, const FitTable& data, std::size_t compare,
                 calibration::PointExperiment& e, Target& target) {
    TomlReader test = table.table("test");
    const auto kind_name = test.get("kind") == nullptr ? std::optional<std::string>()
                                                       : test.get("kind")->value<std::string>();
    if (kind_name == "simple_shear" && (x == Quantity::I || x == Quantity::shear_rate)) {
      read_flow_curve(test, x, data, e);
      return;
    }
    point::Kind kind = point::Kind::triaxial;
    e.test.path = read_path(test, kind);
    if (!file_.ok()) return;
    const bool leads = calibration::leads_along(e.test.path, x);
    if (compare == 2) {
      target.compare = calibration::Compare::distance;
      e.rows = calibration::Rows::along;
    } else if (compare == 1 || !leads) {
      target.compare = calibration::Compare::interpolate;
      e.rows = calibration::Rows::along;
      if (compare == 0)
        out_.notes.push_back(
            fmt::format("{}: {} is not what drives the test, so the simulated curve is "
                        "interpolated at the data",
                        target.name, point::column_name(x)));
    }
  }

  /// A flow curve: one steady shear rate per row of the data.
  void read_flow_curve(TomlReader& test, Quantity x, const FitTable& data,
                       calibration::PointExperiment& e) {
    test.expect("kind");
    constexpr std::array conditions{point::Condition::constant_volume,
                                    point::Condition::constant_normal_stress,
                                    point::Condition::constant_p};
    const auto condition = conditions[test.choice(
        "drainage", {"constant_volume", "constant_normal_stress", "constant_p"}, 0)];
    const double strain = test.number(
        {"shear_strain", "-", "shear strain at each rate, enough to become steady", positive, 0.5});
    std::vector<double> rates = data.x;
    if (x == Quantity::I) {
      // γ̇ = I √(p/ρ_p)/d (physics.md, MUI-2), so d and ρ_p must be known
      const int d = point::parameter_index(out_.info->parameters, "d");
      const int rho = point::parameter_index(out_.info->parameters, "rho_p");
      const bool fixed = d >= 0 && rho >= 0 && e.test.initial.p &&
                         std::none_of(out_.law_key.begin(), out_.law_key.end(),
                                      [](const auto& k) { return k == "d" || k == "rho_p"; });
      if (!fixed) {
        test.report("kind",
                    "a flow curve over I needs initial.p and fixed d and rho_p; with free "
                    "ones give the data over shear_rate_per_s");
        return;
      }
      for (double& rate : rates)
        rate *= std::sqrt(*e.test.initial.p / theta_[static_cast<std::size_t>(rho)]) /
                theta_[static_cast<std::size_t>(d)];
    }
    for (const double rate : rates)
      if (!(rate > 0.0)) {
        test.report("kind",
                    fmt::format("a flow curve needs {} > 0 in every row", point::column_name(x)));
        return;
      }
    e.test.path = calibration::flow_curve_path(rates, condition, strain);
    e.rows = calibration::Rows::leg_ends;
  }

  /// Resolves `of`, and keeps the orders that the laws demand (κ < λ, μ_0 < μ_d) by ratios where
  /// the bounds alone do not.
  void link_ratios() {
    std::vector<std::size_t> order(out_.free.size());
    const auto find = [&](std::string_view name) {
      for (std::size_t i = 0; i < out_.free.size(); ++i)
        if (out_.free[i].name == name) return static_cast<int>(i);
      return -1;
    };
    for (const auto& [small, large] :
         {std::pair<std::string_view, std::string_view>{"kappa", "lambda"}, {"mu_0", "mu_d"}}) {
      const int i = find(small), j = find(large);
      if (i < 0 || j < 0 || out_.law_key[static_cast<std::size_t>(i)] != small) continue;
      FreeParameter& p = out_.free[static_cast<std::size_t>(i)];
      const FreeParameter& of = out_.free[static_cast<std::size_t>(j)];
      if (!of_[static_cast<std::size_t>(i)].empty() || p.upper < of.lower || p.prior) continue;
      const double start = start_value(p) / start_value(of);
      p.lower = std::max(1e-6, p.lower / of.upper);
      p.upper = std::min(0.999, p.upper / of.lower);
      p.start = start;
      p.scale = Scale::linear;
      of_[static_cast<std::size_t>(i)] = large;
      out_.notes.push_back(fmt::format("{} < {} is kept by fitting {}/{} in [{:.3g}, {:.3g}]",
                                       small, large, small, large, p.lower, p.upper));
    }
    std::vector<int> placed(out_.free.size(), -1);
    std::vector<FreeParameter> sorted;
    std::vector<std::string> keys;
    for (const bool ratios : {false, true})
      for (std::size_t i = 0; i < out_.free.size(); ++i) {
        if (of_[i].empty() == ratios) continue;
        FreeParameter p = out_.free[i];
        if (ratios) {
          const int other = find(of_[i]);
          if (other < 0 || !of_[static_cast<std::size_t>(other)].empty()) {
            file_.report(join_path(path_[i], "of"),
                         fmt::format("{}.of = \"{}\" must name a free parameter that is no ratio "
                                     "itself",
                                     path_[i], of_[i]));
            continue;
          }
          p.of = placed[static_cast<std::size_t>(other)];
        }
        placed[i] = static_cast<int>(sorted.size());
        sorted.push_back(std::move(p));
        keys.push_back(out_.law_key[i]);
      }
    if (sorted.empty()) file_.report("fit", "[fit] needs at least one free parameter");
    for (auto* list : {&out_.targets, &out_.coarse})
      for (Target& t : *list)
        for (calibration::Binding& b : t.bindings)
          b.parameter = placed[static_cast<std::size_t>(b.parameter)];
    if (!has_coarse_) out_.coarse.clear();
    out_.free = std::move(sorted);
    out_.law_key = std::move(keys);
    try {
      if (file_.ok()) calibration::ParameterSpace space(out_.free);
    } catch (const InputError& error) {
      file_.report(error, "fit");
    }
  }

  InputFile& file_;
  TomlReader root_;
  FitFile& out_;
  std::filesystem::path cache_;
  bool has_coarse_ = false;
  std::vector<double> theta_;  ///< at the start; NaN where the law derives
  std::vector<std::string> of_, path_;
  std::map<std::string, int> shared_;
};

/// The law's free parameters at their start, as overrides of [law], so that one reader serves both.
std::vector<std::string> starts_as_overrides(const InputFile& file) {
  std::vector<std::string> overrides;
  const toml::table* fit = file.root()["fit"].as_table();
  if (fit == nullptr) return overrides;
  const toml::table* law = file.root()["law"].as_table();
  std::vector<std::string> problems;
  const auto bound = [](const toml::table& t, const char* key) {
    const auto node = t[key];
    return node.is_number() ? *node.value<double>() : std::nan("");
  };
  for (const auto& [key, node] : *fit) {
    const toml::table* entry = node.as_table();
    if (entry == nullptr || key.str() == "shared") continue;
    const std::string name(key.str());
    const auto law_name = file.root()["law"]["name"].value<std::string>();
    const auto has = [&](const LawInfo& info) {
      return law_name && info.name == *law_name &&
             std::any_of(info.parameters.begin(), info.parameters.end(),
                         [&](const ParamInfo& p) { return p.name == name; });
    };
    if (std::none_of(all_laws().begin(), all_laws().end(), has)) continue;  // reported later
    if (law != nullptr && law->contains(name)) {
      problems.push_back(fmt::format("{}: {} is fixed in [law] and free in [fit]: leave out one",
                                     to_string(file.origin("fit." + name)), name));
      continue;
    }
    double lower = bound(*entry, "lower"), upper = bound(*entry, "upper"),
           start = bound(*entry, "start"), of = 1.0;
    if (const auto other = (*entry)["of"].value<std::string>())
      if (const toml::table* partner = (*fit)[*other].as_table()) {
        const double a = bound(*partner, "lower"), b = bound(*partner, "upper");
        const double s = bound(*partner, "start");
        of = std::isnan(s) ? (a > 0.0 ? std::sqrt(a * b) : 0.5 * (a + b)) : s;
      }
    // only a stand-in that the law accepts: the fit starts where the coordinates say
    if (std::isnan(start) || !(start > lower && start < upper))
      start = lower > 0.0 ? std::sqrt(lower * upper) : 0.5 * (lower + upper);
    if (std::isfinite(start * of)) overrides.push_back(fmt::format("law.{}={}", name, start * of));
  }
  if (!problems.empty()) throw BadInput(std::move(problems));
  return overrides;
}

/// FNV-1a, 64 bit
std::string hash_of(const std::string& text) {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const unsigned char c : text) h = (h ^ c) * 0x100000001b3ULL;
  return fmt::format("{:016x}", h);
}

}  // namespace

FitFile read_fit(const std::filesystem::path& file, std::span<const std::string> overrides,
                 std::uint64_t seed, const std::filesystem::path& cache) {
  const InputFile given = InputFile::read(file, overrides);
  std::vector<std::string> sets(overrides.begin(), overrides.end());
  for (std::string& start : starts_as_overrides(given)) sets.push_back(std::move(start));
  InputFile input = InputFile::read(file, sets);
  FitFile out;
  FitReader(input, out, cache).run(seed);

  toml::table resolved = given.root();
  if (toml::array* targets = resolved["target"].as_array())
    for (auto& node : *targets)
      if (toml::table* t = node.as_table())
        if (const auto data = (*t)["data"].value<std::string>())
          t->insert_or_assign(
              "data",
              std::filesystem::absolute(file.parent_path() / *data).lexically_normal().string());
  std::ostringstream text;
  text << resolved << "\n";
  out.resolved = std::move(text).str();
  std::string key = out.resolved + fmt::format("seed {}", out.options.seed);
  for (const Target& t : out.targets)
    for (const auto& channel : t.channels)
      for (Eigen::Index i = 0; i < t.rows(); ++i)
        key += fmt::format(" {} {}", t.x[i], channel.observed[i]);
  out.fingerprint = hash_of(key);
  return out;
}

LawSpec fitted_law(const FitFile& file, const Eigen::VectorXd& values) {
  LawSpec law = file.law;
  for (std::size_t i = 0; i < file.free.size(); ++i)
    if (!file.law_key[i].empty())
      law.values[file.law_key[i]] = values[static_cast<Eigen::Index>(i)];
  return law;
}

}  // namespace repose::app
