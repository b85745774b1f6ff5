#include "input/fit_keys.hpp"

#include <limits>

#include <fmt/core.h>

#include "input/key_info.hpp"
#include "input/measured_columns.hpp"
#include "input/read_initial.hpp"
#include "input/read_law.hpp"
#include "input/read_point_test.hpp"
#include "input/test_keys.hpp"
#include "input/toml_reader.hpp"

namespace repose::input {
namespace {

constexpr std::array<std::string_view, 2> scale_words{"linear", "log"};
constexpr std::array<std::string_view, 2> noise_words{"estimated", "declared"};
constexpr std::array<std::string_view, 3> residual_words{"normal", "huber", "student"};
static_assert(static_cast<int>(calibration::Residuals::student) == 2);
constexpr std::array<std::string_view, 3> compare_words{"rows", "interpolate", "distance"};
static_assert(static_cast<int>(calibration::Compare::distance) == 2);
static_assert(static_cast<int>(Scale::log) == 1);

KeyInfo open_table() {
  KeyInfo info;
  info.kind = ValueKind::table;
  info.open = true;
  return info;
}

void nothing(TomlReader&) {}
std::string no_text() { return {}; }

/// What TargetReader hands on to other readers, of targets and of candidates.
void describe_test_tables(Keys& keys, std::string_view free_doc) {
  InitialConditions initial;
  TestTable test;
  point::Settings settings;
  strain_key(keys, test.measure);
  keys.table({"initial", "-", "the state at the start"},
             [&](Keys& below) { initial_keys(below, initial); });
  keys.table({"test", "-", "the path, as in a point test"},
             [&](Keys& below) { test_keys(below, test); });
  keys.table({"integration", "-", "how the path is integrated"},
             [&](Keys& below) { integration_keys(below, settings); });
  KeyInfo free = open_table();
  keys.value({"free", "-", free_doc}, nothing, no_text, free);
}

/// The tables of a target.
void describe_target_tables(Keys& keys) {
  NoiseParts parts;
  KeyInfo noise = open_table();
  KeyInfo either, number, table;
  either.name = "CHANNEL";
  either.kind = ValueKind::any_of;
  either.doc = "standard deviation of the measurement";
  number.range = positive;
  table.kind = ValueKind::table;
  table.below = describe_keys([&](Keys& below) { noise_part_keys(below, parts); });
  either.below = {number, table};
  noise.below = {either};
  keys.value({"noise", "-", "standard deviation of each channel's measurement"}, nothing, no_text,
             noise);
  keys.value({"weights", "-", "of single channels (1)"}, nothing, no_text, open_table());
  describe_test_tables(
      keys,
      "initial conditions that are fitted too (p, ocr, v, K0, p_c0): bounds as in [fit], or "
      "the name of a quantity of [fit.shared]");
}

}  // namespace

void entry_keys(Keys& keys, EntryTable& entry, std::string_view name, std::string_view unit,
                std::string_view doc, const Range& bounds) {
  keys.text({"of", "-", "another free parameter, to which this one is a ratio"}, entry.of);
  const bool ratio = !entry.of.empty();
  const Range range = ratio ? Range{0.0, 1e6, false, false} : bounds;
  const std::string what = ratio ? fmt::format("{}/{}", name, entry.of) : std::string(doc);
  const std::string low = "lower bound of " + what, high = "upper bound of " + what,
                    begin = "start of " + what;
  const std::string_view own = ratio ? "-" : unit;
  keys.number({"lower", own, low, range, required}, entry.lower);
  keys.number({"upper", own, high, range, required}, entry.upper);
  keys.choice({"scale", "-", "on which it is searched; a parameter's own by default"}, scale_words,
              entry.scale);
  keys.number({"start", own, begin}, entry.start);
  entry.has_prior = keys.reader() != nullptr && keys.reader()->has("prior");
  keys.table({"prior", "-", "what is known beforehand, a normal distribution"}, [&](Keys& below) {
    if (!entry.has_prior && !below.describes()) return;
    below.number({"mean", unit, "expected value", {}, required}, entry.mean);
    below.number({"sd", unit, "standard deviation in the parameter's own unit", positive},
                 entry.sd);
    below.number({"relative_sd", "-", "standard deviation as a share of the mean", positive},
                 entry.relative_sd);
  });
}

void target_keys(Keys& keys, TargetTable& target) {
  keys.text({"x", "-", "the abscissa's column, as in curve.csv", {}, required}, target.x);
  keys.text_list(
      {"y", "-", "a column or a list of columns, as in [\"q_Pa\", \"u_Pa\"]", {}, required},
      target.y);
  keys.text({"data", "-", "a measured table", {}, required}, target.data);
  keys.text({"name", "-", "for reports; the table's name by default"}, target.name);
  keys.number({"weight", "-", "of the target", positive}, target.weight);
  keys.boolean({"held_out", "-", "not fitted, but predicted"}, target.held_out);
  keys.choice({"compare", "-", "row by row, interpolated, or by distance"}, compare_words,
              target.compare);
  keys.number({"from", "-", "smallest x that is compared"}, target.from);
  keys.number({"to", "-", "largest x that is compared"}, target.to);
  keys.number({"x_shift", "-", "added to the table's x"}, target.x_shift);
  keys.text({"scene", "-", "a scene file: the target is a full simulation"}, target.scene);
  constexpr std::string_view only = "set and coarse belong to a target with a scene";
  const bool scene = !target.scene.empty() || keys.describes();
  keys.text_list(
      Key{"set", "-", "overrides of the scene, as in [\"grid.h=0.0125\"]"}.only_if(scene, only),
      target.set);
  keys.text_list(Key{"coarse", "-", "further overrides for the first search"}.only_if(scene, only),
                 target.coarse);
  describe_table_keys(keys);
  if (keys.describes()) describe_target_tables(keys);
}

void candidate_keys(Keys& keys, CandidateTable& candidate) {
  keys.text({"name", "-", "for reports", {}, required}, candidate.name);
  keys.text({"x", "-", "what the rows would be spaced over, as in curve.csv", {}, required},
            candidate.x);
  keys.text_list({"y", "-", "what would be measured, a column or a list of columns", {}, required},
                 candidate.y);
  keys.number({"from", "-", "x from which the rows go on, evenly"}, candidate.from);
  keys.number({"to", "-", "x of the last row", {}, required}, candidate.to);
  keys.integer({"rows", "-", "that would be measured"}, {1, 100000}, candidate.rows);
  if (!keys.describes()) return;
  KeyInfo noise = open_table(), number;
  number.name = "CHANNEL";
  number.range = positive;
  number.doc = "standard deviation of the measurement";
  noise.below = {number};
  keys.value({"noise", "-", "standard deviation of every channel's measurement", {}, required},
             nothing, no_text, noise);
  describe_test_tables(keys,
                       "initial conditions that are quantities of [fit.shared], by their names");
}

void noise_part_keys(Keys& keys, NoiseParts& parts) {
  keys.number({"absolute", "-", "standard deviation of the measurement", positive}, parts.absolute);
  keys.number({"relative", "-", "standard deviation as a share of the value", positive},
              parts.relative);
}

void solver_keys(Keys& keys, FitFile& fit) {
  constexpr std::int64_t most = 1000000000;
  calibration::FitOptions& o = fit.options;
  std::int64_t global = o.global_evaluations, local = o.local_evaluations,
               fine = fit.fine_evaluations, seed = static_cast<std::int64_t>(o.seed);
  keys.text({"global", "-", "a global algorithm of NLopt or \"none\""}, o.global);
  keys.text({"local", "-", "a local algorithm of NLopt, \"levenberg_marquardt\" or \"none\""},
            o.local);
  keys.integer({"starts", "-", "starting points"}, {1, 1000000}, o.starts);
  keys.integer({"global_evaluations", "-", "of the global search"}, {1, most}, global);
  keys.integer({"local_evaluations", "-", "per start"}, {1, most}, local);
  keys.number({"tolerance", "-", "of the parameters over their bounds", Range{0.0, 0.1}},
              o.x_tolerance);
  keys.integer(
      {"fine_evaluations", "-", "of scenes at full resolution, after the search with coarse ones"},
      {1, most}, fine);
  keys.boolean({"balance", "-", "targets count alike, whatever their number of rows"}, fit.balance);
  keys.integer({"seed", "-", "of random numbers"}, {0, std::numeric_limits<std::int64_t>::max()},
               seed);
  keys.choice(
      {"residuals", "-", "what a residual costs: its square, or less where it is large (outliers)"},
      residual_words, fit.loss.residuals);
  const bool robust = fit.loss.robust() || keys.describes();
  std::optional<double> tuning;
  keys.number(Key{"tuning", "-",
                  "of huber: residuals over their scale up to which it is the square (1.345); of "
                  "student: degrees of freedom (4)",
                  Range{0.0, 1e3}}
                  .only_if(robust, "it belongs to residuals = \"huber\" or \"student\""),
              tuning);
  fit.loss.tuning = tuning.value_or(calibration::usual_tuning(fit.loss.residuals));
  o.global_evaluations = global;
  o.local_evaluations = local;
  fit.fine_evaluations = fine;
  o.seed = static_cast<std::uint64_t>(seed);
}

void uncertainty_keys(Keys& keys, FitFile& fit) {
  keys.boolean({"profile", "-", "profile likelihood of every parameter"}, fit.profiles);
  keys.number({"resolution", "-",
               "error of the fine scenes over the change from coarse to fine; 0: none is allowed "
               "for",
               Range{0.0, 100.0, false, false}},
              fit.resolution_error);
  keys.integer({"bootstrap", "-", "refits of resampled data"}, {0, 100000}, fit.bootstrap);
}

void posterior_keys(Keys& keys, calibration::PosteriorOptions& posterior) {
  keys.integer({"chains", "-", "Markov chains, each from a beginning of its own"}, {1, 1000},
               posterior.chains);
  keys.integer({"warmup", "-", "draws per chain that set its step and are thrown away"},
               {20, 1000000}, posterior.warmup);
  keys.integer({"draws", "-", "draws per chain that are kept"}, {100, 1000000}, posterior.draws);
  keys.number({"discrepancy", "-",
               "expected size of the law's own error, which hangs together along a curve, as a "
               "share of each channel's range; 0: the law is right",
               Range{0.0, 10.0, false, false}},
              posterior.discrepancy);
  std::size_t noise = posterior.keep_declared_noise ? 1 : 0;
  keys.word({"noise", "-",
             "of each channel: estimated with the parameters, what is declared being right within "
             "a factor 2, or as it is declared"},
            noise_words, noise);
  posterior.keep_declared_noise = noise == 1;
  keys.number({"accept", "-", "mean acceptance that the step is set to; more: shorter steps",
               Range{0.5, 0.999, false, false}},
              posterior.accept);
}

std::vector<KeyInfo> fit_infos() {
  LawSpec law;
  FitFile fit = default_fit();
  EntryTable entry;
  TargetTable target;
  CandidateTable candidate;
  KeyInfo free = open_table(), one, shared = open_table();
  one.name = "PARAMETER";
  one.kind = ValueKind::table;
  one.doc = "a free parameter of the law, with its bounds";
  one.below = describe_keys(
      [&](Keys& below) { entry_keys(below, entry, "", "", "the parameter", Range{}); });
  shared.name = "shared";
  shared.doc = "quantities that several targets share, by names of your own, as parameters";
  free.below = {one, shared};
  return describe_keys([&](Keys& keys) {
    keys.table({"law", "-", "the law, its options and fixed parameters", {}, required},
               [&](Keys& below) { law_keys(below, law); });
    keys.value({"fit", "-", "the free parameters", {}, required}, nothing, no_text, free);
    keys.tables(
        {"target", "-", "an experiment", {}, required}, 0, [](std::size_t) {},
        [&](Keys& below, std::size_t) { target_keys(below, target); });
    keys.tables(
        {"candidate", "-", "a test that could be made next: what it would teach"}, 0,
        [](std::size_t) {}, [&](Keys& below, std::size_t) { candidate_keys(below, candidate); });
    keys.table({"solver", "-", "how the optimum is searched"},
               [&](Keys& below) { solver_keys(below, fit); });
    keys.table({"uncertainty", "-", "how sure the result is"},
               [&](Keys& below) { uncertainty_keys(below, fit); });
    keys.table({"posterior", "-", "draws from the posterior; without the table: none"},
               [&](Keys& below) {
                 calibration::PosteriorOptions posterior;
                 posterior_keys(below, posterior);
               });
    keys.value({"chart", "-", "of `repose chart fit`: evaluations and seed"}, nothing, no_text,
               open_table());
  });
}

}  // namespace repose::input
