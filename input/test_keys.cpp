#include "input/test_keys.hpp"

#include <algorithm>

#include "input/key_info.hpp"
#include "input/measured_columns.hpp"
#include "input/toml_reader.hpp"

namespace repose::input {
namespace {

using point::Condition;
using point::Kind;

constexpr std::array<std::string_view, 5> kind_words{"isotropic", "oedometer", "triaxial",
                                                     "simple_shear", "custom"};
constexpr std::array<std::string_view, 2> control_words{"strain", "stress"};

struct ConditionWord {
  std::string_view word;
  Condition condition;
};
constexpr std::array triaxial_conditions{
    ConditionWord{"drained", Condition::drained}, ConditionWord{"undrained", Condition::undrained},
    ConditionWord{"constant_p", Condition::constant_p},
    ConditionWord{"constant_sigma_r", Condition::drained},
    ConditionWord{"constant_sigma_a", Condition::constant_sigma_a}};
constexpr std::array shear_conditions{
    ConditionWord{"constant_volume", Condition::constant_volume},
    ConditionWord{"constant_normal_stress", Condition::constant_normal_stress},
    ConditionWord{"constant_p", Condition::constant_p}};

void drainage_key(Keys& keys, StageTable& stage) {
  const bool triaxial = stage.kind == Kind::triaxial;
  std::vector<ConditionWord> list;
  if (triaxial || keys.describes())
    list.insert(list.end(), triaxial_conditions.begin(), triaxial_conditions.end());
  if (!triaxial || keys.describes())
    list.insert(list.end(), shear_conditions.begin(),
                shear_conditions.end() - (keys.describes() ? 1 : 0));
  std::vector<std::string_view> words;
  std::size_t at = 0;
  for (std::size_t i = list.size(); i-- > 0;) {
    words.insert(words.begin(), list[i].word);
    if (list[i].condition == stage.condition) at = i;
  }
  const bool has_any = triaxial || stage.kind == Kind::simple_shear;
  keys.word(
      Key{"drainage", "-", "what is kept while the test is driven"}.only_if(
          has_any || keys.describes(), "only triaxial and simple_shear tests have a drainage"),
      words, at);
  if (has_any) stage.condition = list[at].condition;
}

void component_keys(Keys& keys, Values& values, std::string_view unit) {
  for (std::size_t i = 0; i < values.size(); ++i)
    keys.number({point::component_names[i], unit, "component, compression positive"}, values[i]);
}

/// Pa/s: of a named test a number, of a custom stage components.
void stress_rate_key(Keys& keys, StageTable& stage) {
  const Key key{"stress_rate", "Pa/s", "of a stage driven by stress; of a custom one components",
                positive};
  const auto components = [&](Keys& below) { component_keys(below, stage.stress_rates, "Pa/s"); };
  if (keys.describes()) {
    KeyInfo any, number, table;
    any.kind = ValueKind::any_of;
    number.range = positive;
    table.kind = ValueKind::table;
    table.below = describe_keys(components);
    any.below = {number, table};
    keys.value(
        key, [](TomlReader&) {}, [] { return std::string(); }, any);
  } else if (stage.kind == Kind::custom) {
    keys.table(key, components);
  } else {
    keys.number(key, stage.stress_rate);
  }
}

/// What a stage shares with the test around it.
void shared_keys(Keys& keys, StageTable& stage) {
  drainage_key(keys, stage);
  keys.number({"rate", "1/s", "strain rate", positive}, stage.rate);
  stress_rate_key(keys, stage);
  keys.integer({"points", "-", "rows of output"}, {1, 1000000}, stage.points);
  keys.number({"strain_limit", "-", "how far a stage may strain in search of its end",
               Range{0.0, 1e3, true, false}},
              stage.strain_limit);
  keys.choice({"control", "-", "what drives a stage towards its end"}, control_words,
              stage.control);
  // a stage's own stops take the place of those of the test
  if (const TomlReader* const table = keys.reader(); table != nullptr && table->has("stop"))
    stage.stops = {};
  keys.table({"stop", "-", "other ends of a stage"}, [&](Keys& below) {
    for (std::size_t i = 0; i < stop_keys.size(); ++i)
      below.number({stop_keys[i].key, stop_keys[i].unit, stop_keys[i].doc}, stage.stops[i]);
  });
}

/// What belongs to one stage: where it ends.
void own_keys(Keys& keys, StageTable& stage) {
  const TomlReader* const table = keys.reader();
  const bool all = keys.describes(), custom = stage.kind == Kind::custom;
  const bool cycles = table != nullptr && table->has("cycles");
  stage.sweeps = table != nullptr && table->has("rates");
  constexpr std::string_view no_custom =
      "a custom stage has no such key: it lasts for its duration";
  keys.integer(
      Key{"cycles", "-", "number of cycles between the limits"}.only_if(!custom, no_custom),
      {1, 10000}, stage.cycles);
  for (std::size_t i = 0; i < cycle_keys.size(); ++i)
    for (const auto& [end, values] : {std::pair{"_min", &stage.lowest}, {"_max", &stage.highest}})
      keys.number(
          Key{std::string(cycle_keys[i].key) + end, cycle_keys[i].unit, cycle_keys[i].doc}.only_if(
              cycles || all, "limits belong to cycles, which are missing"),
          (*values)[i]);
  keys.table(
      Key{"rates", "-", "a sweep of shear rates"}.only_if(
          stage.kind == Kind::simple_shear || all, "rates belong to kind = \"simple_shear\""),
      [&](Keys& below) {
        if (!stage.sweeps && !all) return;
        below.number({"from", "1/s", "slowest shear rate", positive, required}, stage.slowest);
        below.number({"to", "1/s", "fastest shear rate", positive, required}, stage.fastest);
        below.integer({"count", "-", "number of rates", {}, required}, {2, 10000}, stage.rates);
      });
  keys.choice(Key{"hold", "-", "keep stress (creep) or strain (relaxation) for a duration"}.only_if(
                  !custom, no_custom),
              control_words, stage.hold);
  Key duration{"duration", "s", "how long to hold, or how long a custom stage lasts", positive};
  if (stage.hold || custom) duration.presence = required;
  keys.number(duration.only_if(stage.hold || custom || all,
                               "a duration belongs to hold, or to a custom stage"),
              stage.duration);
  for (std::size_t i = 0; i < goal_keys.size(); ++i) {
    const bool of_sweep = stage.sweeps && goal_keys[i].key == "shear_strain";
    const bool ends = !custom && !cycles && !stage.hold && !stage.sweeps;
    keys.number(Key{goal_keys[i].key, goal_keys[i].unit, goal_keys[i].doc}.only_if(
                    ends || of_sweep || all,
                    custom ? no_custom
                           : "cycles, rates and hold have their own end: leave out one of the two"),
                stage.goals[i]);
  }
}

void custom_keys(Keys& keys, StageTable& stage) {
  const bool custom = stage.kind == Kind::custom || keys.describes();
  constexpr std::string_view only = "strain_rate and constraints belong to kind = \"custom\"";
  keys.table(Key{"strain_rate", "1/s", "components of a custom stage"}.only_if(custom, only),
             [&](Keys& below) { component_keys(below, stage.strain_rate, "1/s"); });
  keys.tables(
      Key{"constraints", "-", "a linear constraint on the rates"}.only_if(custom, only),
      stage.constraints.size(), [&](std::size_t count) { stage.constraints.assign(count, {}); },
      [&](Keys& below, std::size_t i) {
        StageTable::Constraint& row = stage.constraints[i];
        below.table({"strain", "-", "factors of the strain rates"},
                    [&](Keys& k) { component_keys(k, row.strain, "-"); });
        below.table({"stress", "1/Pa", "factors of the stress rates"},
                    [&](Keys& k) { component_keys(k, row.stress, "1/Pa"); });
        below.number({"rate", "-", "right-hand side"}, row.rate);
      });
}

}  // namespace

void strain_key(Keys& keys, point::StrainMeasure& measure) {
  static_assert(static_cast<int>(point::StrainMeasure::logarithmic) == 0);
  static constexpr std::array<std::string_view, 2> words{"logarithmic", "engineering"};
  keys.choice({"strain", "-", "measure of every strain in this table"}, words, measure);
}

void stage_keys(Keys& keys, StageTable& stage) {
  const Kind before = stage.kind;
  keys.choice({"kind", "-", "of the stage"}, kind_words, stage.kind);
  if (stage.kind != before)
    stage.condition =
        stage.kind == Kind::simple_shear ? Condition::constant_volume : Condition::drained;
  shared_keys(keys, stage);
  own_keys(keys, stage);
  custom_keys(keys, stage);
}

void test_keys(Keys& keys, TestTable& test, const std::function<void(Keys&, std::size_t)>& stage) {
  static_assert(static_cast<int>(point::HistoryIs::absolute) == 0);
  static constexpr std::array<std::string_view, 2> history_words{"absolute", "change"};
  strain_key(keys, test.measure);
  keys.choice({"kind", "-", "of the test", {}, required}, kind_words, test.shared.kind);
  if (test.shared.kind == Kind::simple_shear) test.shared.condition = Condition::constant_volume;
  const bool custom = test.shared.kind == Kind::custom || keys.describes();
  constexpr std::string_view only = "a history belongs to kind = \"custom\"";
  keys.text(Key{"history", "-", "a table of the boundary's motion over time"}.only_if(custom, only),
            test.history);
  keys.choice(Key{"history_is", "-", "what the table's columns hold: values, or changes"}.only_if(
                  custom, only),
              history_words, test.history_is);
  describe_table_keys(keys);
  if (!test.history.empty()) return;
  shared_keys(keys, test.shared);
  const TomlReader* const table = keys.reader();
  const bool staged = table != nullptr && table->has("stages");
  if (!staged) {
    own_keys(keys, test.shared);
    custom_keys(keys, test.shared);
  }
  std::size_t count = 1;
  keys.tables(
      {"stages", "-", "a stage of the test"}, 0, [&](std::size_t n) { count = n; },
      [&](Keys& below, std::size_t i) {
        if (stage) {
          stage(below, i);
        } else {
          StageTable own = test.shared;
          stage_keys(below, own);
        }
      });
}

void report_keys(Keys& keys, std::vector<double>& secants_at) {
  keys.number_list({"secant_G_at", "-",
                    "shear strains at which summary.json gives the secant shear modulus of a "
                    "triaxial or simple shear stage",
                    Range{0.0, 1.0, true, false}},
                   secants_at);
}

void integration_keys(Keys& keys, point::Settings& settings) {
  static constexpr std::array<std::string_view, 6> words{"automatic", "adaptive", "implicit",
                                                         "cvode",     "ida",      "arkode"};
  static_assert(static_cast<int>(point::Method::arkode) == 5);
  keys.choice({"method", "-", "of integration"}, words, settings.method);
  keys.number({"tolerance", "-", "relative error per step", Range{1e-14, 0.1, false, false}},
              settings.tolerance);
  keys.integer({"substeps", "-", "implicit: steps per row"}, {1, 1000000}, settings.substeps);
  std::int64_t most = settings.max_steps;
  keys.integer({"max_steps", "-", "steps per stage"}, {1, 1000000000}, most);
  settings.max_steps = most;
  keys.number(
      {"max_strain", "-", "a path that strains further has run away", Range{0.0, 1e3, true, false}},
      settings.max_strain);
}

}  // namespace repose::input
