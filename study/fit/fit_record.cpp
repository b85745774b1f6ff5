#include "study/fit/fit_record.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "input/read_law.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "models/instruction_set.hpp"
#include "repose_version.hpp"
#include "study/fit/journal.hpp"

namespace repose::study {
namespace {

using calibration::Optimum;
using calibration::StartResult;
using Eigen::Index;
using Json = io::Json;

Json channel_json(const calibration::Target& target, const calibration::ChannelScore& s) {
  Json c;
  c["rows"] = s.rows;
  c["rms"] = number(s.rms);
  c["rms_over_range"] = number(s.relative_rms);
  c["bias"] = number(s.bias);
  c["chi2_per_row"] = number(s.chi2_per_row);
  c["lag_correlation"] = number(s.lag_correlation);
  c["systematic"] = s.systematic;
  c["worst_at_x"] = number(target.x[s.worst_row]);
  if (!target.held_out) c["objective"] = number(s.objective);
  return c;
}

}  // namespace

Json json_of(const Optimum& o) {
  Json out;
  out["z"] = list(o.z);
  out["objective"] = number(o.objective);
  out["why"] = o.why;
  out["evaluations"] = o.evaluations;
  out["gradients"] = o.gradients;
  out["seconds"] = o.seconds;
  out["failed"] = o.failed;
  Json trace = Json::array();
  for (const auto& t : o.trace)
    trace.push_back({t.evaluations, t.gradients, t.seconds, number(t.objective)});
  out["trace"] = std::move(trace);
  return out;
}

Optimum optimum_of(const Json& j) {
  Optimum o;
  o.z = vector_of(j.at("z"));
  o.objective = j.at("objective").is_null() ? std::numeric_limits<double>::infinity()
                                            : j.at("objective").get<double>();
  o.why = j.at("why").get<std::string>();
  o.evaluations = j.at("evaluations").get<long>();
  o.gradients = j.at("gradients").get<long>();
  o.seconds = j.at("seconds").get<double>();
  o.failed = j.at("failed").get<bool>();
  for (const Json& t : j.at("trace"))
    o.trace.push_back(
        {t.at(0).get<long>(), t.at(1).get<long>(), t.at(2).get<double>(),
         t.at(3).is_null() ? std::numeric_limits<double>::infinity() : t.at(3).get<double>()});
  return o;
}

std::string quoted_words(const input::FitFile& file, const FitResult& result,
                         std::size_t parameter) {
  const calibration::Recommendation& q = result.quoted[parameter];
  const auto& p = file.free[parameter];
  const std::string unit = p.unit == "-" ? "" : " " + p.unit;
  const auto [low, high] = q.interval;
  const int at = result.uncertainty.at_bound[parameter];
  std::string text;
  if (q.lower_is_bound && q.upper_is_bound)
    return fmt::format("the data do not determine it within its bounds, {:.5g} to {:.5g}{}", low,
                       high, unit);
  if (q.kind == "bounds") return "the data do not determine it";
  if (q.lower_is_bound)
    text = fmt::format("at most {:.5g}{}", high, unit);
  else if (q.upper_is_bound)
    text = fmt::format("at least {:.5g}{}", low, unit);
  else
    text = fmt::format("{:.5g} to {:.5g}{}", low, high, unit);
  if (at != 0)
    text += fmt::format("; the best value is at its {} bound", at < 0 ? "lower" : "upper");
  return text;
}

std::vector<std::string> discrepancies(const input::FitFile& file,
                                       const calibration::Problem& problem,
                                       const FitResult& result) {
  std::vector<std::string> texts;
  for (const auto& s : result.uncertainty.channels) {
    if (!s.systematic) continue;
    const auto& t = file.targets[s.target];
    std::string text =
        fmt::format("{}{}: {} is off by {:.3g} rms ({:.2g} % of its range), {:.3g} on average",
                    t.name, t.held_out ? " (held out)" : "", t.channels[s.channel].name, s.rms,
                    100.0 * s.relative_rms, s.bias);
    if (std::isfinite(s.chi2_per_row) && s.chi2_per_row > 1.0)
      text += fmt::format(", {:.2g} times the declared noise", std::sqrt(s.chi2_per_row));
    if (s.lag_correlation > 0.5)
      text += fmt::format(", in one direction over stretches (neighbours correlate by {:.2f})",
                          s.lag_correlation);
    texts.push_back(text + fmt::format("; worst at {} = {:.4g}", t.x_name, t.x[s.worst_row]));
  }
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    const bool far = std::any_of(
        result.uncertainty.channels.begin(), result.uncertainty.channels.end(),
        [&](const auto& s) { return s.target == k && s.large && !file.targets[k].held_out; });
    if (!far) continue;
    const auto cause = std::find_if(result.causes.begin(), result.causes.end(),
                                    [&](const auto& c) { return c.target == k; });
    texts.push_back(
        file.targets[k].name + ": " +
        (cause != result.causes.end()
             ? in_words(problem, *cause)
             : "the misfit is large beside the range of the data, and no factor of 100 or 1000 and "
               "no other sign of a column mends it: look at the initial state, the bounds, the "
               "starts (solver.starts) and the law"));
  }
  return texts;
}

std::vector<Outliers> outliers(const calibration::Problem& problem, const FitResult& result) {
  constexpr double little = 0.25;
  std::vector<Outliers> list;
  if (!problem.loss().robust()) return list;
  for (const calibration::Block& b : problem.blocks()) {
    const Eigen::MatrixXd weights = problem.row_weights(b.target, result.best().z);
    Outliers found{b.target, b.channel, {}};
    for (Index i = 0; i < b.rows; ++i)
      if (weights(i, static_cast<Index>(b.channel)) < little)
        found.rows.push_back(static_cast<std::size_t>(i));
    if (!found.rows.empty()) list.push_back(std::move(found));
  }
  return list;
}

namespace {

/// Lines of the table, or rows where it has none.
std::vector<int> places_of(const input::FitFile& file, const Outliers& found) {
  const std::vector<int>& lines = file.about[found.target].lines;
  std::vector<int> places;
  for (const std::size_t row : found.rows)
    places.push_back(row < lines.size() ? lines[row] : static_cast<int>(row + 1));
  return places;
}

/// What each candidate would teach, and the best of them in a row.
std::vector<std::string> design_words(const input::FitFile& file, const FitResult& result) {
  std::vector<std::string> lines;
  for (const calibration::Taught& t : result.design.candidates) {
    const std::string& name = file.candidates[t.candidate].name;
    lines.push_back(t.failed
                        ? fmt::format("next test: {} breaks off at these parameters", name)
                        : fmt::format("next test: {} would tell {:.3g} nats, most of {}, whose "
                                      "95 % would be {:.2g} of the width",
                                      name, t.gain, file.free[t.most].name,
                                      t.narrower[static_cast<Index>(t.most)]));
  }
  std::vector<std::string> names;
  for (const calibration::Taught& t : result.design.sequence)
    names.push_back(file.candidates[t.candidate].name);
  if (names.size() > 1)
    lines.push_back(fmt::format("the best {} in a row: {}", names.size(), fmt::join(names, ", ")));
  return lines;
}

}  // namespace

std::vector<std::string> fit_words(const input::FitFile& file, const calibration::Problem& problem,
                                   const FitResult& result) {
  std::vector<std::string> lines;
  const auto& u = result.uncertainty;
  if (!result.coarse.empty()) {
    const StartResult& fine = result.starts.front();
    lines.push_back(
        fmt::format("coarse: objective {:.5g} from {} starts; fine: {:.5g} after {} evaluations",
                    fine.global.objective, result.coarse.size(), fine.optimum.objective,
                    fine.optimum.evaluations + fine.optimum.gradients));
  }
  for (std::size_t i = 0; i < file.free.size(); ++i)
    lines.push_back(fmt::format("{:<16} {:.6g}{}   95 % ({}): {}", file.free[i].name,
                                u.values[static_cast<Index>(i)],
                                file.free[i].unit == "-" ? "" : " " + file.free[i].unit,
                                result.quoted[i].kind, quoted_words(file, result, i)));
  if (!result.converged)
    lines.push_back(
        fmt::format("not converged: the limit of evaluations (solver.{} = {}) ended every start of "
                    "the best optimum; values and intervals are provisional",
                    file.coarse.empty() ? "local_evaluations" : "fine_evaluations",
                    file.coarse.empty() ? file.options.local_evaluations : file.fine_evaluations));
  if (!u.combinations.empty() && u.combinations.front().relative_sd > 0.1)
    lines.push_back("worst determined: " + u.combinations.front().words);
  for (const Outliers& found : outliers(problem, result)) {
    const auto& t = file.targets[found.target];
    const std::size_t n = found.rows.size();
    lines.push_back(fmt::format("{} {} of {} ({}) look{} like {}: line{} {}", n,
                                n == 1 ? "row" : "rows", file.about[found.target].data,
                                t.channels[found.channel].name, n == 1 ? "s" : "",
                                n == 1 ? "an outlier" : "outliers", n == 1 ? "" : "s",
                                fmt::join(places_of(file, found), ", ")));
  }
  for (const std::string& text : discrepancies(file, problem, result))
    lines.push_back("does not follow: " + text);
  for (std::string& line : design_words(file, result)) lines.push_back(std::move(line));
  if (const auto& c = result.clusters; c.size() > 1)
    lines.push_back(fmt::format("{} distinct optima; the best from {} of {} starts{}", c.size(),
                                c.front().starts.size(), result.starts.size(),
                                c[1].same_prediction ? ", another fits as well" : ""));
  return lines;
}

Json fit_report(const input::FitFile& file, const calibration::Problem& problem,
                const FitResult& result, const std::string& status) {
  const auto& u = result.uncertainty;
  const Optimum& best = result.best();
  Json j;
  j["repose"] = version_string;
  j["instruction_set"] = instruction_set();
  j["kind"] = "fit";
  j["name"] = file.name;
  j["status"] = status;
  j["law"] = {{"name", file.info->name},
              {std::string(file.info->option_key.empty() ? "option" : file.info->option_key),
               file.info->option}};
  Json parameters;
  for (std::size_t i = 0; i < file.free.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const auto& p = file.free[i];
    Json e;
    e["value"] = number(u.values[k]);
    e["unit"] = p.unit;
    e["standard_error"] = number(u.standard_error[k]);
    e["standard_error_if_residuals_were_white"] = number(u.white_error[k]);
    if (!result.coarse.empty()) e["shift_by_resolution"] = number(u.shift[k]);
    e["interval_95"] = {number(u.interval[i][0]), number(u.interval[i][1])};
    const calibration::Recommendation& quoted = result.quoted[i];
    e["recommended_95"] = {{"interval", {number(quoted.interval[0]), number(quoted.interval[1])}},
                           {"lower_is_bound", quoted.lower_is_bound},
                           {"upper_is_bound", quoted.upper_is_bound},
                           {"kind", quoted.kind},
                           {"reason", quoted.reason}};
    e["degrees_of_freedom"] = number(u.freedoms[k]);
    for (const auto& profile : result.profiles) {
      if (profile.parameter != static_cast<int>(i)) continue;
      e["profile_interval_95"] = {profile.lower_open ? Json(nullptr) : number(profile.lower),
                                  profile.upper_open ? Json(nullptr) : number(profile.upper)};
    }
    if (result.bootstrap.rows() > 0) {
      const auto reach = problem.space().reach(i);
      const auto drawn =
          calibration::bootstrap_interval(result.bootstrap.col(k), u.values[k], u.quantiles[k]);
      e["bootstrap_interval_95"] = {std::max(drawn[0], reach[0]), std::min(drawn[1], reach[1])};
    }
    if (p.prior) {
      const double pull =
          p.prior->relative ? std::log(u.values[k] / p.prior->mean) : u.values[k] - p.prior->mean;
      e["prior"] = {{"mean", p.prior->mean},
                    {p.prior->relative ? "relative_sd" : "sd", p.prior->sd},
                    {"pulled_by_sd", number(pull / p.prior->sd)}};
    }
    e["lower"] = p.lower;
    e["upper"] = p.upper;
    if (p.of >= 0) e["bounds_are_of_the_ratio_to"] = file.free[static_cast<std::size_t>(p.of)].name;
    e["at_bound"] = u.at_bound[i] < 0   ? Json("lower")
                    : u.at_bound[i] > 0 ? Json("upper")
                                        : Json(false);
    parameters[p.name] = std::move(e);
  }
  j["parameters"] = std::move(parameters);
  j["objective"] = number(best.objective);
  j["rows"] = problem.data_rows();
  j["best_point_broke_off"] = best.failed;
  Json targets;
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    Json t;
    t["data"] = file.about[k].data;
    t["held_out"] = file.targets[k].held_out;
    if (!file.about[k].strain.empty()) t["strain"] = file.about[k].strain;
    double objective = 0.0;
    for (const auto& s : u.channels) {
      if (s.target != k) continue;
      t["channels"][file.targets[k].channels[s.channel].name] = channel_json(file.targets[k], s);
      objective += s.objective;
    }
    if (!file.targets[k].held_out) t["objective"] = number(objective);
    targets[file.targets[k].name] = std::move(t);
  }
  j["targets"] = std::move(targets);
  j["discrepancy"] = discrepancies(file, problem, result);
  if (!file.candidates.empty()) {
    const auto json = [&](const calibration::Taught& t) {
      Json one{{"test", file.candidates[t.candidate].name}};
      if (t.failed) {
        one["broke_off"] = true;
        return one;
      }
      one["gain_nats"] = number(t.gain);
      one["teaches_most"] = file.free[t.most].name;
      for (std::size_t i = 0; i < file.free.size(); ++i)
        one["width_after_over_before"][file.free[i].name] =
            number(t.narrower[static_cast<Index>(i)]);
      return one;
    };
    Json alone = Json::array(), sequence = Json::array();
    for (const auto& t : result.design.candidates) alone.push_back(json(t));
    for (const auto& t : result.design.sequence) sequence.push_back(json(t));
    j["design"] = {{"candidates", std::move(alone)}, {"best_sequence", std::move(sequence)}};
  }
  if (problem.loss().robust()) {
    Json list = Json::array();
    for (const Outliers& found : outliers(problem, result)) {
      const auto& t = file.targets[found.target];
      std::vector<double> x;
      for (const std::size_t row : found.rows) x.push_back(t.x[static_cast<Index>(row)]);
      list.push_back({{"target", t.name},
                      {"channel", t.channels[found.channel].name},
                      {"lines", places_of(file, found)},
                      {"x", x}});
    }
    j["outliers"] = std::move(list);
  }
  Json correlation = Json::array();
  for (Index i = 0; i < u.correlation.rows(); ++i)
    correlation.push_back(list(u.correlation.row(i)));
  j["correlation"] = std::move(correlation);
  Json combinations = Json::array();
  for (const auto& c : u.combinations) {
    Json direction;
    for (std::size_t i = 0; i < file.free.size(); ++i)
      direction[file.free[i].name] = number(c.direction[static_cast<Index>(i)]);
    combinations.push_back({{"singular_value", number(c.singular_value)},
                            {"relative_sd", number(c.relative_sd)},
                            {"determined", c.relative_sd < 0.5},
                            {"direction", direction},
                            {"words", c.words}});
  }
  j["singular_values_of_scaled_jacobian"] = std::move(combinations);
  Json optima = Json::array();
  for (const auto& c : result.clusters) {
    Json values;
    const Eigen::VectorXd v = problem.space().values(c.z);
    for (std::size_t i = 0; i < file.free.size(); ++i)
      values[file.free[i].name] = number(v[static_cast<Index>(i)]);
    optima.push_back({{"objective", number(c.objective)},
                      {"starts", c.starts},
                      {"fits_as_well_as_the_best", c.same_prediction},
                      {"values", values}});
  }
  j["optima"] = std::move(optima);
  const calibration::Spent spent = problem.spent();
  long evaluations = 0, gradients = 0;
  Json ends;
  for (const StartResult& s : result.starts) {
    evaluations += s.optimum.evaluations;
    gradients += s.optimum.gradients;
    if (s.global.z.size() > 0 && file.options.local != "none") {
      evaluations += s.global.evaluations;
      gradients += s.global.gradients;
    }
    auto& n = ends[s.optimum.why];
    n = n.is_null() ? Json(1) : Json(n.get<int>() + 1);
  }
  j["counts"] = {{"starts", result.starts.size()},
                 {"evaluations", evaluations},
                 {"gradients", gradients},
                 {"ends", ends},
                 {"this_session",
                  {{"evaluations", spent.evaluations},
                   {"gradients", spent.gradients},
                   {"paths", spent.paths},
                   {"failed_trials", spent.failures}}}};
  if (!result.coarse.empty()) {
    j["coarse"] = {{"starts", result.coarse.size()},
                   {"objective", number(calibration::best_of(result.coarse).optimum.objective)}};
    for (const StartResult& s : result.coarse) {
      const Eigen::VectorXd v = problem.space().values(s.optimum.z);
      Json values;
      for (std::size_t i = 0; i < file.free.size(); ++i)
        values[file.free[i].name] = number(v[static_cast<Index>(i)]);
      j["coarse"]["ends"].push_back({{"start", s.index},
                                     {"objective", number(s.optimum.objective)},
                                     {"evaluations", s.optimum.evaluations},
                                     {"gradients", s.optimum.gradients},
                                     {"values", values}});
    }
  }
  if (const long done = file.runs->simulated, kept = file.runs->recalled; done + kept > 0)
    j["counts"]["this_session"]["scenes"] = {{"simulated", done}, {"recalled", kept}};
  j["solver"] = {{"global", file.options.global},
                 {"local", file.options.local},
                 {"seed", file.options.seed},
                 {"balance", file.balance}};
  if (file.loss.robust()) {
    j["solver"]["residuals"] =
        file.loss.residuals == calibration::Residuals::huber ? "huber" : "student";
    j["solver"]["tuning"] = file.loss.tuning;
  }
  j["notes"] = file.notes;
  j["fingerprint"] = file.fingerprint;
  return j;
}

std::string predictions_csv(const input::FitFile& file, const calibration::Problem& problem,
                            const FitResult& result) {
  std::string text = "target,held_out,x_name,channel,x,measured,fitted,weight\n";
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    const auto& t = file.targets[k];
    const Eigen::MatrixXd simulated = problem.predict(k, result.best().z).simulated;
    Eigen::MatrixXd weights;
    if (!t.held_out) weights = problem.row_weights(k, result.best().z);
    for (std::size_t c = 0; c < t.channels.size(); ++c)
      for (Index i = 0; i < t.x.size(); ++i) {
        const auto col = static_cast<Index>(c);
        text += fmt::format("\"{}\",{},{},{},{},{},{},{}\n", t.name, t.held_out ? "yes" : "no",
                            t.x_name, t.channels[c].name, t.x[i], t.channels[c].observed[i],
                            simulated(i, col),
                            t.held_out ? std::string() : fmt::format("{}", weights(i, col)));
      }
  }
  return text;
}

std::string fitted_toml(const input::FitFile& file, const FitResult& result) {
  const auto& u = result.uncertainty;
  const LawSpec law = input::fitted_law(file, u.values);
  std::string text = fmt::format(
      "# Fitted by repose {} to {} experiments ({}); objective {:.6g}.\n# 95 % intervals in "
      "comments.\n\n[law]\nname = \"{}\"\n",
      version_string,
      std::count_if(file.targets.begin(), file.targets.end(),
                    [](const auto& t) { return !t.held_out; }),
      file.name, result.best().objective, law.name);
  if (const std::string own = input::own_option_lines(law); !own.empty())
    text += own;
  else
    for (const auto& [key, value] : law.options)
      text += value == "true" || value == "false" ? fmt::format("{} = {}\n", key, value)
                                                  : fmt::format("{} = \"{}\"\n", key, value);
  const auto line = [](const std::string& key, double x, const std::string& comment) {
    std::string digits = fmt::format("{}", x);
    if (digits.find_first_of(".en") == std::string::npos) digits += ".0";
    const std::string assignment = fmt::format("{} = {}", key, digits);
    return comment.empty() ? assignment + "\n" : fmt::format("{:<32}# {}\n", assignment, comment);
  };
  const auto comment = [&](std::size_t i) { return quoted_words(file, result, i); };
  for (const ParamInfo& p : file.info->parameters) {
    const auto value = law.values.find(std::string(p.name));
    if (value == law.values.end()) continue;
    if (!p.words.empty()) {
      text += fmt::format("{} = \"{}\"\n", p.name, input::word_of(p, value->second));
      continue;
    }
    std::string words = "fixed";
    for (std::size_t i = 0; i < file.free.size(); ++i)
      if (file.law_key[i] == p.name) words = comment(i);
    text += line(std::string(p.name), value->second, words);
  }
  for (std::size_t i = 0; i < file.free.size(); ++i)
    if (file.law_key[i].empty())
      text += "# " + line(file.free[i].name, u.values[static_cast<Index>(i)], comment(i));
  return text;
}

std::string design_csv(const input::FitFile& file, const FitResult& result) {
  if (file.candidates.empty()) return {};
  std::string text = "order,test,gain_nats,teaches_most";
  for (const auto& p : file.free) text += fmt::format(",\"{} narrower\"", p.name);
  text += "\n";
  const auto line = [&](const std::string& order, const calibration::Taught& t) {
    text += fmt::format("{},\"{}\",{},\"{}\"", order, file.candidates[t.candidate].name,
                        t.failed ? std::nan("") : t.gain, t.failed ? "" : file.free[t.most].name);
    for (const double x : t.narrower) text += fmt::format(",{}", x);
    text += "\n";
  };
  for (const auto& t : result.design.candidates) line("alone", t);
  for (std::size_t k = 0; k < result.design.sequence.size(); ++k)
    line(fmt::format("{}", k + 1), result.design.sequence[k]);
  return text;
}

void write_fit(const io::ResultFolder& folder, const input::FitFile& file,
               const calibration::Problem& problem, const FitResult& result, const Json& report) {
  folder.write_file("fit.json", report.dump(2) + "\n");
  folder.write_file("fitted.toml", fitted_toml(file, result));
  folder.write_file("predictions.csv", predictions_csv(file, problem, result));
  if (!file.candidates.empty()) folder.write_file("design.csv", design_csv(file, result));
}

Json fit_summary(const input::FitFile& file, const std::string& status, const Usage& before,
                 const Json& report) {
  const Usage after = usage();
  Json s;
  s["repose"] = version_string;
  s["instruction_set"] = instruction_set();
  s["kind"] = "fit";
  s["name"] = file.name;
  s["status"] = status;
  s["seed"] = file.options.seed;
  s["wall_s"] = after.wall_s - before.wall_s;
  s["cpu_s"] = after.cpu_s - before.cpu_s;
  s["peak_memory_MB"] = after.peak_memory_MB;
  for (const char* key : {"objective", "parameters", "counts", "discrepancy"})
    if (report.contains(key)) s[key] = report[key];
  s["input"] = file.resolved;
  return s;
}

std::string starts_journal(const input::FitFile& file, const std::vector<StartResult>& starts) {
  std::string text = Json{{"fit", file.name}, {"fingerprint", file.fingerprint}}.dump() + "\n";
  for (const StartResult& s : starts) text += journal_line(s);
  return text;
}

std::string journal_line(const StartResult& start) {
  Json j;
  j["start"] = start.index;
  j["from"] = list(start.from);
  if (start.global.z.size() > 0) j["global"] = json_of(start.global);
  j["optimum"] = json_of(start.optimum);
  return journal_line(j);
}

namespace {

std::vector<StartResult> read_one(const std::filesystem::path& path, const input::FitFile& file) {
  std::vector<StartResult> starts;
  read_journal(path, "start", file.fingerprint, [&](const Json& j) {
    StartResult s;
    s.index = j.at("start").get<int>();
    s.from = vector_of(j.at("from"));
    if (j.contains("global")) s.global = optimum_of(j.at("global"));
    s.optimum = optimum_of(j.at("optimum"));
    starts.push_back(std::move(s));
  });
  return starts;
}

void merge_into(std::vector<StartResult>& all, std::vector<StartResult> more,
                const std::string& from) {
  for (StartResult& s : more) {
    const auto same = std::find_if(all.begin(), all.end(),
                                   [&](const StartResult& a) { return a.index == s.index; });
    if (same == all.end()) {
      all.push_back(std::move(s));
    } else if (same->optimum.z != s.optimum.z) {
      throw input::BadInput(
          {fmt::format("{}: start {} ended elsewhere than in another folder; both cannot "
                       "come from the same program and input",
                       from, s.index)});
    }
  }
  std::sort(all.begin(), all.end(),
            [](const StartResult& a, const StartResult& b) { return a.index < b.index; });
}

}  // namespace

std::vector<StartResult> read_starts(const std::vector<std::filesystem::path>& journals,
                                     const input::FitFile& file) {
  std::vector<StartResult> all;
  for (const std::filesystem::path& path : journals)
    merge_into(all, read_one(path, file), path.string());
  return all;
}

void share_starts(input::FitFile& file, int from, int to) {
  file.options.starts_from = from;
  file.options.starts_to = to;
  const int end = to < 0 ? file.options.starts : to;
  if (from >= end || end > file.options.starts)
    throw input::BadInput(
        {fmt::format("--starts-from {} --starts-to {}: this fit has starts 0 to {}, and "
                     "--starts-to is the first one that is left out",
                     from, to, file.options.starts)});
}

std::vector<StartResult> begin_fit(const io::ResultFolder& folder, const input::FitFile& file,
                                   const std::string& source, const std::vector<std::string>& merge,
                                   bool resume) {
  std::vector<std::filesystem::path> journals;
  for (const std::string& dir : merge) {
    journals.push_back(std::filesystem::path(dir) / starts_name);
    if (!std::filesystem::exists(journals.back()))
      throw io::IoError(journals.back(),
                        "there is no journal of starts; give result folders of `repose fit`");
  }
  if (resume) journals.push_back(folder.file(starts_name));
  std::vector<StartResult> done = read_starts(journals, file);
  // the journal first: a kill in between must not lose the starts that it holds
  folder.write_file(starts_name, starts_journal(file, done));
  folder.remove_old_outputs();
  folder.write_file("input.toml",
                    fmt::format("# The input of this result, by repose {}.\n# From {}\n{}",
                                version_string, source, file.resolved));
  return done;
}

}  // namespace repose::study
