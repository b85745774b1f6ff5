#include "calibration/fit.hpp"

#include <cmath>

#include "calibration/multistart.hpp"
#include "calibration/path_derivatives.hpp"
#include "calibration/point_simulator.hpp"
#include "calibration/uncertainty.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;

double start_of(const FreeParameter& p) {
  if (p.start) return *p.start;
  return p.scale == Scale::log && p.lower > 0.0 ? std::sqrt(p.lower * p.upper)
                                                : 0.5 * (p.lower + p.upper);
}

/// Which input of a point simulator a free parameter is: a parameter of the law, then those of the
/// initial state.
int input_of(const LawInfo& law, const FreeParameter& free) {
  if (const int i = point::parameter_index(law.parameters, free.name); i >= 0) return i;
  for (std::size_t k = 0; k < initial_input_names.size(); ++k)
    if (initial_input_names[k] == free.name) return static_cast<int>(law.parameters.size() + k);
  std::vector<std::string_view> known(initial_input_names.begin(), initial_input_names.end());
  for (const ParamInfo& p : law.parameters) known.push_back(p.name);
  const std::string near = nearest_name(free.name, known);
  throw InputError("fit", "the free parameter '" + free.name + "' is neither one of " +
                              std::string(law.name) + " nor p, ocr, v, K0 or p_c0" +
                              (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

/// What is free, by input, with the values at its start.
struct Start {
  std::vector<Binding> bindings;
  std::vector<double> theta;  ///< NaN where absent
  InitialConditions initial;  ///< what of it is free
};

Start start_of(const LawInfo& law, const LawSpec& spec, const std::vector<FreeParameter>& free) {
  Start start;
  std::map<std::string, double> values = spec.values;
  std::vector<double> starts;
  for (std::size_t i = 0; i < free.size(); ++i) {
    const FreeParameter& p = free[i];
    const int input = input_of(law, p);
    for (const Binding& other : start.bindings)
      if (other.input == input) throw InputError("fit", "'" + p.name + "' is free twice");
    start.bindings.push_back({input, static_cast<int>(i)});
    double value = start_of(p);
    if (p.of >= 0 && p.of < static_cast<int>(i)) value *= starts[static_cast<std::size_t>(p.of)];
    starts.push_back(value);
    const int k = input - static_cast<int>(law.parameters.size());
    if (k < 0) {
      if (spec.values.contains(p.name))
        throw InputError("fit", p.name + " is fixed in the law and free: leave out one");
      values[p.name] = value;
    }
    if (k == input_p) start.initial.p = value;
    if (k == input_ocr) start.initial.ocr = value;
    if (k == input_v) start.initial.v = value;
    if (k == input_K0) start.initial.K0 = value;
    if (k == input_p_c0) start.initial.ocr = 1.0;  // until p is known
  }
  start.theta = parameter_vector(law.name, law.parameters, values);
  return start;
}

Target target_of(const LawInfo& law, const Start& start, const Experiment& given) {
  PointExperiment e;
  e.law = &law;
  e.theta = start.theta;
  e.test = given.test;
  InitialConditions& initial = e.test.initial;
  if (start.initial.p) initial.p = start.initial.p;
  if (start.initial.ocr) initial.ocr = start.initial.ocr;
  if (start.initial.v) initial.v = start.initial.v;
  if (start.initial.K0) initial.K0 = start.initial.K0;
  e.x = given.x;
  e.abscissae = given.abscissae;
  Target target;
  target.name = given.name;
  target.held_out = given.held_out;
  target.x_name = std::string(point::column_name(given.x));
  target.x = Eigen::Map<const Eigen::VectorXd>(given.abscissae.data(),
                                               static_cast<Index>(given.abscissae.size()));
  for (const Measured& m : given.measured) {
    e.y.push_back(m.quantity);
    Channel channel;
    channel.name = std::string(point::column_name(m.quantity));
    channel.observed =
        Eigen::Map<const Eigen::VectorXd>(m.values.data(), static_cast<Index>(m.values.size()));
    if (channel.observed.size() != target.x.size())
      throw InputError("target", given.name + ": " + std::to_string(m.values.size()) +
                                     " values of " + channel.name + " at " +
                                     std::to_string(given.abscissae.size()) + " abscissae");
    if (!channel.observed.allFinite() || !target.x.allFinite())
      throw InputError("target", given.name + ": " + channel.name + " is not finite in every row");
    channel.noise = m.noise;
    channel.weight = m.weight;
    target.channels.push_back(std::move(channel));
  }
  if (!leads_along(e.test.path, given.x))
    throw InputError("target", given.name + ": " + target.x_name +
                                   " is not what drives the test, so that it has no rows at given "
                                   "values of it");
  target.inputs = start.theta;
  target.inputs.resize(start.theta.size() + initial_input_count, std::nan(""));
  target.bindings = start.bindings;
  target.simulator = make_point_simulator(std::move(e));
  return target;
}

}  // namespace

FitResult fit(const LawSpec& spec, const std::vector<FreeParameter>& free,
              const std::vector<Experiment>& experiments, const FitSettings& settings) {
  if (free.empty()) throw InputError("fit", "nothing is free: name a parameter to fit");
  const LawInfo& law = find_law(spec);
  if (find_algorithm(settings.algorithm) == nullptr)
    throw InputError("fit", "no algorithm is called '" + settings.algorithm + "'");
  const Start start = start_of(law, spec, free);
  std::vector<Target> targets;
  for (const Experiment& e : experiments) targets.push_back(target_of(law, start, e));
  Problem problem(ParameterSpace(free), std::move(targets));
  FitOptions options;
  options.starts = std::max(1, settings.starts);
  options.local = settings.algorithm;
  options.local_evaluations = settings.max_evaluations;
  options.seed = settings.seed;
  std::vector<StartResult> starts = run_starts(problem, options);
  settle(problem, options, starts);
  const Optimum& best = best_of(starts).optimum;
  const Uncertainty at = uncertainty(problem, best.z);
  const std::vector<Recommendation> quoted = recommend(problem, at, {});

  FitResult result;
  result.objective = best.objective;
  result.why = best.why;
  result.failed = best.failed;
  for (const StartResult& s : starts)
    result.evaluations += s.optimum.evaluations + s.optimum.gradients;
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto k = static_cast<Index>(i);
    result.values.push_back(
        {free[i].name, at.values[k], at.standard_error[k], quoted[i].interval, at.at_bound[i]});
  }
  for (const ChannelScore& s : score(problem, best.z))
    result.scores.push_back({experiments[s.target].name,
                             experiments[s.target].measured[s.channel].quantity, s.rms,
                             s.relative_rms});
  return result;
}

}  // namespace repose::calibration
