#include "study/fit/comparison_record.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/fit/journal.hpp"

namespace repose::study {
namespace {

using calibration::Likelihood;
using io::Json;

/// Criteria of all fits under one kind of errors: columns aic, aicc and bic, and what they lie
/// above the least of their column.
struct Column {
  std::vector<double> value, above, weight;
};
Column column_of(const std::vector<double>& values) {
  Column c;
  c.value = values;
  double least = std::numeric_limits<double>::infinity();
  for (const double v : values)
    if (v < least) least = v;
  for (const double v : values) c.above.push_back(v - least);
  c.weight = calibration::akaike_weights(values);
  return c;
}
struct Table {
  Column aic, aicc, bic;
};
Table table_of(const Comparison& comparison, Likelihood ScoredFit::*errors) {
  std::vector<double> aic, aicc, bic;
  for (const ScoredFit& fit : comparison.fits) {
    aic.push_back((fit.*errors).aic());
    aicc.push_back((fit.*errors).aicc());
    bic.push_back((fit.*errors).bic());
  }
  return {column_of(aic), column_of(aicc), column_of(bic)};
}

Json criteria_json(const Likelihood& l, const Table& table, std::size_t k) {
  return {{"log_likelihood", number(l.log_likelihood)},
          {"k", l.parameters},
          {"n", l.rows},
          {"effective_rows", number(l.effective_rows)},
          {"at_the_fit", l.at_the_fit},
          {"aic", number(table.aic.value[k])},
          {"aicc", number(table.aicc.value[k])},
          {"bic", number(table.bic.value[k])},
          {"delta_aic", number(table.aic.above[k])},
          {"delta_aicc", number(table.aicc.above[k])},
          {"delta_bic", number(table.bic.above[k])},
          {"akaike_weight", number(table.aic.weight[k])},
          {"akaike_weight_corrected", number(table.aicc.weight[k])},
          {"schwarz_weight", number(table.bic.weight[k])}};
}

/// Two fits by a score, the better first; nothing where there are no two scores.
struct Pair {
  std::size_t better = 0, next = 0;
};
std::optional<Pair> best_two(const std::vector<double>& scores) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < scores.size(); ++k)
    if (!std::isnan(scores[k])) order.push_back(k);
  if (order.size() < 2) return {};
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  return Pair{order[0], order[1]};
}

/// By how much the choice of tests moves the difference of two fits' scores: √(T Var) of the T
/// differences (Vehtari, Gelman & Gabry 2017).
double spread_of(const Comparison& comparison, Pair pair, bool held_out) {
  std::vector<double> differences;
  for (std::size_t k = 0; k < comparison.tests.size(); ++k)
    if (comparison.tests[k].held_out == held_out)
      differences.push_back(comparison.fits[pair.better].tests[k].test.log_score -
                            comparison.fits[pair.next].tests[k].test.log_score);
  const auto n = static_cast<double>(differences.size());
  double mean = 0.0, squares = 0.0;
  for (const double d : differences) mean += d / n;
  for (const double d : differences) squares += (d - mean) * (d - mean);
  return n > 1.0 ? std::sqrt(n * squares / (n - 1.0)) : std::nan("");
}

/// "A predicts tests that it has not seen better than B: …"; empty if there is nothing to tell.
std::string predicts(const Comparison& comparison, bool held_out) {
  std::vector<double> scores;
  for (const ScoredFit& fit : comparison.fits)
    scores.push_back(held_out ? fit.held_out_score : fit.left_out_score);
  const auto pair = best_two(scores);
  if (!pair) return {};
  const ScoredFit &a = comparison.fits[pair->better], &b = comparison.fits[pair->next];
  const double spread = spread_of(comparison, *pair, held_out);
  std::string text =
      fmt::format("{} predicts the tests that {} better than {}: its log score is {:.3g} more",
                  a.name, held_out ? "were held out" : "are left out in turn", b.name,
                  scores[pair->better] - scores[pair->next]);
  if (std::isfinite(spread))
    text += fmt::format(" (give or take {:.2g} by the choice of tests)", spread);
  return text + fmt::format(", its r.m.s. error {:.2g} % of the range against {:.2g} %",
                            100.0 * (held_out ? a.held_out_error : a.left_out_error),
                            100.0 * (held_out ? b.held_out_error : b.left_out_error));
}

/// The fit with the smaller BIC of the two best, and by how much.
std::string bic_words(const Comparison& comparison, const Column& bic) {
  std::vector<double> scores;
  for (const double v : bic.value) scores.push_back(-v);
  const auto pair = best_two(scores);
  if (!pair) return "says nothing";
  return fmt::format("prefers {} by {:.3g}", comparison.fits[pair->better].name,
                     bic.value[pair->next] - bic.value[pair->better]);
}

std::size_t best_by(const Column& column) {
  return static_cast<std::size_t>(std::min_element(column.value.begin(), column.value.end()) -
                                  column.value.begin());
}

}  // namespace

std::string verdict(const Comparison& comparison) {
  const Table white = table_of(comparison, &ScoredFit::white),
              correlated = table_of(comparison, &ScoredFit::correlated);
  std::vector<std::string> sentences;
  for (const bool held_out : {false, true})
    if (std::string text = predicts(comparison, held_out); !text.empty())
      sentences.push_back(std::move(text));
  const bool by_prediction = !sentences.empty();
  if (!by_prediction)
    sentences.push_back(
        "No test could be left out or is held out, so that nothing tells how the fits predict");
  std::vector<double> scores;
  for (const ScoredFit& fit : comparison.fits)
    scores.push_back(std::isnan(fit.left_out_score) ? fit.held_out_score : fit.left_out_score);
  const std::size_t preferred = best_by(correlated.bic);
  const auto pair = best_two(scores);
  std::string agrees;
  if (pair) agrees = pair->better == preferred ? "agrees: it " : "disagrees: it ";
  sentences.push_back(fmt::format("BIC {}{} with correlated errors, and {} with white ones", agrees,
                                  bic_words(comparison, correlated.bic),
                                  bic_words(comparison, white.bic)));
  const Likelihood& l = comparison.fits[preferred].correlated;
  if (l.effective_rows < 0.8 * static_cast<double>(l.rows))
    sentences.push_back(fmt::format(
        "Neighbouring rows err alike, so that AIC and BIC of white errors overstate the evidence: "
        "{} rows are worth {:.2g}",
        l.rows, l.effective_rows));
  std::string all;
  for (const std::string& s : sentences) all += (all.empty() ? "" : " ") + s + ".";
  return all;
}

Json comparison_report(const Comparison& comparison) {
  const Table white = table_of(comparison, &ScoredFit::white),
              correlated = table_of(comparison, &ScoredFit::correlated);
  Json fits;
  for (std::size_t k = 0; k < comparison.fits.size(); ++k) {
    const ScoredFit& fit = comparison.fits[k];
    Json j;
    j["law"] = fit.law;
    j["parameters"] = fit.parameters;
    j["white_errors"] = criteria_json(fit.white, white, k);
    j["correlated_errors"] = criteria_json(fit.correlated, correlated, k);
    if (comparison.left_out)
      j["left_out"] = {{"log_score", number(fit.left_out_score)},
                       {"rms_over_range", number(fit.left_out_error)}};
    j["held_out"] = {{"log_score", number(fit.held_out_score)},
                     {"rms_over_range", number(fit.held_out_error)}};
    for (std::size_t t = 0; t < comparison.tests.size(); ++t) {
      const ComparedTest& test = comparison.tests[t];
      if (!test.held_out && !comparison.left_out) continue;
      const calibration::LeftOut& left = fit.tests[t];
      Json one;
      one["held_out"] = test.held_out;
      one["log_score"] = number(left.test.log_score);
      one["broke_off"] = left.test.failed;
      if (!test.held_out) {
        one["ended"] = left.optimum.why;
        std::vector<std::string> unknown;
        for (const std::size_t i : left.unknown) unknown.push_back(fit.parameters[i]);
        one["not_determined_without_it"] = unknown;
      }
      for (const auto& c : left.test.channels)
        one["channels"].push_back({{"target", c.target},
                                   {"channel", c.channel},
                                   {"rows", c.rows},
                                   {"rms", number(c.rms)},
                                   {"rms_over_range", number(c.relative_rms)},
                                   {"log_score", number(c.log_score)},
                                   {"error_is_its_own", c.own_error}});
      j["tests"][test.name] = std::move(one);
    }
    fits[fit.name] = std::move(j);
  }
  return {{"kind", "comparison"}, {"fits", std::move(fits)}, {"verdict", verdict(comparison)}};
}

std::string comparison_csv(const Comparison& comparison) {
  std::string text = "fit,errors,k,n,effective_rows,log_likelihood";
  for (const char* name : {"aic", "aicc", "bic"}) text += fmt::format(",{0},delta_{0}", name);
  text +=
      ",akaike_weight,left_out_log_score,left_out_rms_over_range,held_out_log_score,"
      "held_out_rms_over_range\n";
  for (const bool white : {false, true}) {
    const auto errors = white ? &ScoredFit::white : &ScoredFit::correlated;
    const Table table = table_of(comparison, errors);
    for (std::size_t k = 0; k < comparison.fits.size(); ++k) {
      const ScoredFit& fit = comparison.fits[k];
      const Likelihood& l = fit.*errors;
      text += fmt::format("\"{}\",{},{},{},{},{}", fit.name, white ? "white" : "correlated",
                          l.parameters, l.rows, l.effective_rows, l.log_likelihood);
      for (const Column* c : {&table.aic, &table.aicc, &table.bic})
        text += fmt::format(",{},{}", c->value[k], c->above[k]);
      text += fmt::format(",{},{},{},{},{}\n", table.aic.weight[k], fit.left_out_score,
                          fit.left_out_error, fit.held_out_score, fit.held_out_error);
    }
  }
  return text;
}

std::string unseen_csv(const Comparison& comparison) {
  std::string text = "fit,test,held_out,target,channel,rows,rms,rms_over_range,log_score\n";
  for (const ScoredFit& fit : comparison.fits)
    for (std::size_t t = 0; t < comparison.tests.size(); ++t)
      for (const auto& c : fit.tests[t].test.channels)
        text += fmt::format("\"{}\",\"{}\",{},{},{},{},{},{},{}\n", fit.name,
                            comparison.tests[t].name, comparison.tests[t].held_out ? "yes" : "no",
                            c.target, c.channel, c.rows, c.rms, c.relative_rms, c.log_score);
  return text;
}

void write_comparison(const io::ResultFolder& folder, const Comparison& comparison) {
  folder.write_file("comparison.json", comparison_report(comparison).dump(2) + "\n");
  folder.write_file("comparison.csv", comparison_csv(comparison));
  folder.write_file("unseen.csv", unseen_csv(comparison));
}

std::vector<std::string> comparison_words(const Comparison& comparison) {
  const Table white = table_of(comparison, &ScoredFit::white),
              correlated = table_of(comparison, &ScoredFit::correlated);
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<16} {:>3} {:>10} {:>9} {:>9} {:>9} {:>7}  {:>9} {:>10} {:>8}", "",
                              "k", "ln L", "dAIC", "dAICc", "dBIC", "weight", "dBIC white",
                              "left out", "error"));
  for (std::size_t k = 0; k < comparison.fits.size(); ++k) {
    const ScoredFit& fit = comparison.fits[k];
    const bool left = !std::isnan(fit.left_out_score);
    lines.push_back(fmt::format(
        "{:<16} {:>3} {:>10.5g} {:>9.4g} {:>9.4g} {:>9.4g} {:>7.3f}  {:>10.4g} "
        "{:>10.5g} {:>6.2g} %",
        fit.name, fit.correlated.parameters, fit.correlated.log_likelihood, correlated.aic.above[k],
        correlated.aicc.above[k], correlated.bic.above[k], correlated.aic.weight[k],
        white.bic.above[k], left ? fit.left_out_score : fit.held_out_score,
        100.0 * (left ? fit.left_out_error : fit.held_out_error)));
  }
  lines.push_back(verdict(comparison));
  for (const ScoredFit& fit : comparison.fits) {
    if (fit.correlated.at_the_fit)
      lines.push_back(
          fmt::format("{}: its likelihood is that at the fit, not the largest, as its "
                      "simulations have no derivatives",
                      fit.name));
    for (std::size_t t = 0; t < comparison.tests.size(); ++t) {
      const calibration::LeftOut& left = fit.tests[t];
      if (left.test.failed)
        lines.push_back(fmt::format("{}: {} breaks off where it is not fitted", fit.name,
                                    comparison.tests[t].name));
      if (left.unknown.empty()) continue;
      std::vector<std::string> names;
      for (const std::size_t i : left.unknown) names.push_back(fit.parameters[i]);
      lines.push_back(fmt::format(
          "{}: without {} nothing determines {}: {} near what the whole fit found for {}, which "
          "flatters "
          "the error and not the score",
          fit.name, comparison.tests[t].name, fmt::join(names, ", "),
          names.size() == 1 ? "it stays" : "they stay", names.size() == 1 ? "it" : "them"));
    }
  }
  return lines;
}

}  // namespace repose::study
