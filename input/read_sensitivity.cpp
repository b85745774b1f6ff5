#include "input/read_sensitivity.hpp"

#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "input/read_keys.hpp"
#include "input/read_sweep.hpp"

namespace repose::input {
namespace {

constexpr std::array<std::string_view, 2> method_words{"sobol", "morris"};
constexpr std::array<std::string_view, 2> surrogate_words{"chaos", "none"};
constexpr std::array<std::string_view, 2> uncertain_scale_words{"linear", "log"};

void uncertain_keys(Keys& keys, UncertainInput& input) {
  std::optional<double> lower, upper, mean, sd, relative;
  keys.text_list({"key",
                  "-",
                  "of this file, as --set names it; of a list all take the same value",
                  {},
                  required},
                 input.keys);
  keys.number({"lower", "-", "least value"}, lower);
  keys.number({"upper", "-", "largest value"}, upper);
  keys.choice({"scale", "-", "on which values are even"}, uncertain_scale_words, input.scale);
  keys.number({"mean", "-", "of a normal distribution in place of an even one"}, mean);
  keys.number({"sd", "-", "its standard deviation", positive}, sd);
  keys.number({"relative_sd", "-", "or that of the logarithm: a share of the mean", positive},
              relative);
  TomlReader* const table = keys.reader();
  if (table == nullptr) return;
  if (lower) input.lower = *lower;
  if (upper) input.upper = *upper;
  const bool normal = mean || sd || relative;
  if (normal) {
    if (!mean)
      table->report("mean", fmt::format("{} is missing: the mean of the normal distribution",
                                        table->path_of("mean")));
    else if (sd.has_value() == relative.has_value())
      table->report("mean",
                    fmt::format("{} needs either sd or relative_sd", table->path_of("mean")));
    else
      input.prior = calibration::Prior{*mean, sd ? *sd : *relative, relative.has_value()};
    if (relative && mean && !(*mean > 0.0))
      table->report("mean", fmt::format("{} must be > 0 with a relative_sd; got {}",
                                        table->path_of("mean"), *mean));
  } else if (!lower || !upper) {
    table->report("lower", fmt::format("{} needs lower and upper, or mean and sd (or relative_sd)",
                                       table->path()));
  }
  if (!(input.lower < input.upper))
    table->report("upper", fmt::format("{} = {} must be > lower = {}", table->path_of("upper"),
                                       input.upper, input.lower));
  if (input.scale == Scale::log && !normal && lower && !(*lower > 0.0))
    table->report("lower", fmt::format("{} must be > 0 on a logarithmic scale; got {}",
                                       table->path_of("lower"), *lower));
}

void check_names(TomlReader& table, const SensitivityInput& s) {
  std::set<std::string> seen;
  for (const UncertainInput& input : s.inputs)
    for (const std::string& key : input.keys) {
      if (key == "sensitivity" || key.starts_with("sensitivity."))
        table.report("input", fmt::format("sensitivity.input: {} is no input of a run", key));
      if (!seen.insert(key).second)
        table.report("input", fmt::format("sensitivity.input: {} is there twice", key));
    }
}

void check_size(TomlReader& table, const SensitivityInput& s) {
  const std::size_t n = s.inputs.size();
  if (n > most_uncertain_inputs) {
    table.report("input", fmt::format("sensitivity.input: {} inputs are too many, at most {}", n,
                                      most_uncertain_inputs));
    return;
  }
  if (s.runs() > static_cast<int>(most_sweep_runs))
    table.report("samples",
                 fmt::format("sensitivity.samples = {} asks for {} runs of {} inputs, at most {}",
                             s.samples, s.runs(), n, most_sweep_runs));
  const auto least = static_cast<int>(2 * (n + 1));
  if (s.method == SensitivityMethod::sobol && s.surrogate == SurrogateKind::chaos &&
      s.samples < least)
    table.report("samples",
                 fmt::format("sensitivity.samples = {}: a polynomial of {} inputs needs {} runs at "
                             "least, and several times as many to be good",
                             s.samples, n, least));
}

void table_keys(Keys& keys, SensitivityInput& s) {
  keys.choice({"method", "-",
               "shares of the output's variance, or elementary effects, which tell with few runs "
               "what matters at all"},
              method_words, s.method);
  const bool all = keys.describes();
  const bool sobol = s.method == SensitivityMethod::sobol;
  keys.choice(
      Key{"surrogate", "-", "a polynomial chaos in place of the runs, or differences of runs"}
          .only_if(sobol || all, "only method = \"sobol\" has a surrogate"),
      surrogate_words, s.surrogate);
  keys.integer({"samples",
                "-",
                "runs for a surrogate; without, blocks of inputs + 2 runs each; of morris, "
                "trajectories of inputs + 1 runs each",
                {},
                required},
               {2, 20'000}, s.samples);
  keys.integer(
      Key{"levels", "-", "values of each input on the grid of morris, an even number"}.only_if(
          !sobol || all, "only method = \"morris\" has levels"),
      {2, 100}, s.levels);
  keys.text_list({"output",
                  "-",
                  "figures of a run: of a test as sweep.csv heads them (end_q_Pa), of a scene as "
                  "summary.json names them, or the last row of series.csv (front_99_m)",
                  {},
                  required},
                 s.outputs);
  keys.tables(
      {"input", "-", "what is not known", {}, required}, s.inputs.size(),
      [&](std::size_t n) { s.inputs.resize(n); },
      [&](Keys& below, std::size_t i) { uncertain_keys(below, s.inputs[i]); });
  TomlReader* const table = keys.reader();
  if (table == nullptr || !table->file().ok()) return;
  if (s.levels % 2 != 0)
    table->report("levels", fmt::format("sensitivity.levels = {} must be even", s.levels));
  check_names(*table, s);
  check_size(*table, s);
}

}  // namespace

int SensitivityInput::runs() const {
  const auto n = static_cast<int>(inputs.size());
  if (method == SensitivityMethod::morris) return samples * (n + 1);
  return surrogate == SurrogateKind::chaos ? samples : samples * (n + 2);
}

void sensitivity_keys(Keys& keys) {
  SensitivityInput sensitivity;
  keys.table({"sensitivity", "-", "what `repose sensitivity` varies, and what it looks at"},
             [&](Keys& below) { table_keys(below, sensitivity); });
}

std::optional<SensitivityInput> read_sensitivity(InputFile& file) {
  TomlReader root(file);
  root.expect_any();  // what else the file holds is read in each of the runs
  if (!root.has("sensitivity")) return std::nullopt;
  SensitivityInput sensitivity;
  ReadKeys keys(root.table("sensitivity"));
  table_keys(keys, sensitivity);
  sensitivity.output_place = to_string(file.origin("sensitivity.output"));
  return sensitivity;
}

}  // namespace repose::input
