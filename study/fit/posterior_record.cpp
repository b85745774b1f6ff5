#include "study/fit/posterior_record.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "models/instruction_set.hpp"
#include "repose_version.hpp"
#include "study/fit/journal.hpp"

namespace repose::study {

using calibration::Draw;
using Eigen::Index;
using Json = io::Json;

Json posterior_report(const input::FitFile& file, const Sampler& sampler,
                      const PosteriorResult& result) {
  const calibration::PosteriorOptions& options = *file.posterior;
  Json j;
  j["repose"] = version_string;
  j["instruction_set"] = instruction_set();
  j["kind"] = "posterior";
  j["name"] = file.name;
  j["status"] = result.converged ? "done" : "not converged";
  j["complaints"] = result.complaints;
  Json quantities;
  for (const QuantitySummary& s : result.summary) {
    Json q;
    if (!s.unit.empty()) q["unit"] = s.unit;
    q["mean"] = number(s.mean);
    q["sd"] = number(s.sd);
    q["median"] = number(s.median);
    q["interval_90"] = {number(s.interval_90[0]), number(s.interval_90[1])};
    q["interval_95"] = {number(s.interval_95[0]), number(s.interval_95[1])};
    q["r_hat"] = number(s.convergence.r_hat);
    q["effective_draws"] = {{"middle", number(s.convergence.bulk_ess)},
                            {"tails", number(s.convergence.tail_ess)}};
    quantities[s.name] = std::move(q);
  }
  j["quantities"] = std::move(quantities);
  Json correlation = Json::array();
  for (Index i = 0; i < result.correlation.rows(); ++i)
    correlation.push_back(list(result.correlation.row(i)));
  j["correlation"] = std::move(correlation);
  Json targets;
  const std::vector<calibration::Target>& all = sampler.posterior.problem().targets();
  for (std::size_t k = 0; k < all.size(); ++k) {
    Json t;
    t["held_out"] = all[k].held_out;
    for (std::size_t c = 0; c < all[k].channels.size(); ++c) {
      const auto column = static_cast<Index>(c);
      t["channels"][all[k].channels[c].name] = {
          {"rows", all[k].rows()},
          {"share_inside_90",
           number(calibration::share_inside(all[k].channels[c], result.bands[k], column))},
          {"band_holds_errors", static_cast<bool>(result.bands[k].has_errors[c])}};
    }
    targets[all[k].name] = std::move(t);
  }
  j["targets"] = std::move(targets);
  j["draws"] = {{"chains", options.chains},   {"warmup", options.warmup},
                {"kept", result.kept},        {"divergent", result.divergent},
                {"cut_off", result.longest},  {"acceptance", number(result.accept)},
                {"trials", result.leapfrogs}, {"trials_whose_path_broke_off", result.broken}};
  j["discrepancy"] = options.discrepancy;
  j["noise"] = options.keep_declared_noise ? "declared" : "estimated";
  j["seed"] = file.options.seed;
  j["fingerprint"] = sampler.fingerprint;
  return j;
}

std::string draws_csv(const input::FitFile& file, const PosteriorResult& result) {
  std::string text = "chain,draw,log_density,divergent";
  for (const QuantitySummary& s : result.summary) text += fmt::format(",\"{}\"", s.name);
  text += "\n";
  Index row = 0;
  for (const Draw& d : result.draws) {
    if (d.iteration <= file.posterior->warmup) continue;
    text += fmt::format("{},{},{},{}", d.chain, d.iteration - file.posterior->warmup, d.log_density,
                        d.divergent ? "yes" : "no");
    for (Index q = 0; q < result.quantities.cols(); ++q)
      text += fmt::format(",{}", result.quantities(row, q));
    text += "\n";
    ++row;
  }
  return text;
}

std::string bands_csv(const input::FitFile& file, const PosteriorResult& result) {
  std::string text =
      "target,held_out,x_name,channel,x,measured,median,curve_5,curve_95,repeated_5,repeated_95\n";
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    const calibration::Target& t = file.targets[k];
    const calibration::PredictiveBand& b = result.bands[k];
    for (std::size_t c = 0; c < t.channels.size(); ++c)
      for (Index i = 0; i < t.x.size(); ++i) {
        const auto column = static_cast<Index>(c);
        text +=
            fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{}\n", t.name, t.held_out ? "yes" : "no",
                        t.x_name, t.channels[c].name, t.x[i], t.channels[c].observed[i],
                        b.median(i, column), b.curve_lower(i, column), b.curve_upper(i, column),
                        b.lower(i, column), b.upper(i, column));
      }
  }
  return text;
}

void write_posterior(const io::ResultFolder& folder, const input::FitFile& file,
                     const Sampler& sampler, const PosteriorResult& result) {
  folder.write_file("posterior.json", posterior_report(file, sampler, result).dump(2) + "\n");
  folder.write_file("posterior.csv", draws_csv(file, result));
  folder.write_file("posterior_bands.csv", bands_csv(file, result));
}

std::vector<std::string> posterior_words(const input::FitFile& file,
                                         const PosteriorResult& result) {
  std::vector<std::string> lines;
  if (!result.complete)
    return {
        fmt::format("posterior: {} of {} chains are drawn", result.chains, file.posterior->chains)};
  lines.push_back(fmt::format("posterior: {} draws of {} chains, {} divergent{}", result.kept,
                              result.chains, result.divergent,
                              result.converged ? "" : "; not converged"));
  for (const QuantitySummary& s : result.summary)
    lines.push_back(
        fmt::format("{:<16} {:.5g}{}   90 %: {:.5g} to {:.5g}   R-hat {:.3f}, worth {:.0f} draws",
                    s.name, s.median, s.unit.empty() || s.unit == "-" ? "" : " " + s.unit,
                    s.interval_90[0], s.interval_90[1], s.convergence.r_hat,
                    std::min(s.convergence.bulk_ess, s.convergence.tail_ess)));
  for (std::size_t k = 0; k < file.targets.size(); ++k)
    for (std::size_t c = 0; c < file.targets[k].channels.size(); ++c) {
      const calibration::Target& t = file.targets[k];
      const double share =
          calibration::share_inside(t.channels[c], result.bands[k], static_cast<Index>(c));
      lines.push_back(fmt::format("{}{}, {}: {:.0f} % of {} rows within the 90 % band", t.name,
                                  t.held_out ? " (held out)" : "", t.channels[c].name,
                                  100.0 * share, t.rows()));
    }
  for (const std::string& text : result.complaints) lines.push_back("posterior: " + text);
  return lines;
}

std::string chains_journal(const input::FitFile& file, const Sampler& sampler,
                           const std::vector<Draw>& draws) {
  std::string text =
      Json{{"posterior", file.name}, {"fingerprint", sampler.fingerprint}}.dump() + "\n";
  for (const Draw& d : draws) text += journal_line(d);
  return text;
}

std::string journal_line(const Draw& d) {
  Json j;
  j["chain"] = d.chain;
  j["iteration"] = d.iteration;
  j["w"] = list(d.w);
  j["log_density"] = number(d.log_density);
  j["accept"] = d.accept;
  j["leapfrogs"] = d.leapfrogs;
  j["divergent"] = d.divergent;
  j["longest"] = d.longest;
  j["broken"] = d.broken;
  j["adaptation"] = {d.adaptation[0], d.adaptation[1], d.adaptation[2]};
  return journal_line(j);
}

namespace {

std::vector<Draw> read_one(const std::filesystem::path& path, const Sampler& sampler) {
  std::vector<Draw> draws;
  read_journal(path, "draw", sampler.fingerprint, [&](const Json& j) {
    Draw d;
    d.chain = j.at("chain").get<int>();
    d.iteration = j.at("iteration").get<int>();
    d.w = vector_of(j.at("w"));
    d.log_density = j.at("log_density").get<double>();
    d.accept = j.at("accept").get<double>();
    d.leapfrogs = j.at("leapfrogs").get<int>();
    d.divergent = j.at("divergent").get<bool>();
    d.longest = j.at("longest").get<bool>();
    d.broken = j.at("broken").get<int>();
    for (std::size_t k = 0; k < 3; ++k) d.adaptation[k] = j.at("adaptation").at(k).get<double>();
    draws.push_back(std::move(d));
  });
  return draws;
}

/// Adds draws that are not there yet.
void merge_into(std::vector<Draw>& all, std::vector<Draw> more, const std::string& from) {
  const auto before = [](const Draw& a, const Draw& b) {
    return std::pair(a.chain, a.iteration) < std::pair(b.chain, b.iteration);
  };
  std::sort(more.begin(), more.end(), before);
  std::vector<Draw> merged;
  std::merge(all.begin(), all.end(), more.begin(), more.end(), std::back_inserter(merged), before);
  all.clear();
  for (Draw& d : merged) {
    const bool same = !all.empty() && !before(all.back(), d);
    if (same && all.back().w != d.w)
      throw input::BadInput(
          {fmt::format("{}: draw {} of chain {} is another one than in another folder; both cannot "
                       "come from the same program and input",
                       from, d.iteration, d.chain)});
    // a journal ends where it was cut off: what lies behind a gap cannot be gone on from
    const bool follows = all.empty() || all.back().chain != d.chain
                             ? d.iteration == 0
                             : d.iteration == all.back().iteration + 1;
    if (!same && follows) all.push_back(std::move(d));
  }
}

}  // namespace

std::vector<Draw> read_chains(const std::vector<std::filesystem::path>& journals,
                              const Sampler& sampler) {
  std::vector<Draw> all;
  for (const std::filesystem::path& path : journals)
    merge_into(all, read_one(path, sampler), path.string());
  return all;
}

bool have_chains(const std::vector<std::string>& folders) {
  return std::any_of(folders.begin(), folders.end(), [](const std::string& folder) {
    return std::filesystem::exists(std::filesystem::path(folder) / chains_name);
  });
}

std::vector<Draw> begin_sampling(const io::ResultFolder& folder, const input::FitFile& file,
                                 const Sampler& sampler, const std::vector<std::string>& merge,
                                 bool resume) {
  std::vector<std::filesystem::path> journals;
  for (const std::string& dir : merge) journals.push_back(std::filesystem::path(dir) / chains_name);
  if (resume) journals.push_back(folder.file(chains_name));
  std::vector<Draw> done = read_chains(journals, sampler);
  folder.write_file(chains_name, chains_journal(file, sampler, done));
  return done;
}

void share_chains(input::FitFile& file, int from, int to, bool merged) {
  calibration::PosteriorOptions& posterior = *file.posterior;
  const int end = to < 0 ? posterior.chains : to;
  if (from >= end || end > posterior.chains)
    throw input::BadInput(
        {fmt::format("--chains-from {} --chains-to {}: this posterior has chains 0 to {}, and "
                     "--chains-to is the first one that is left out",
                     from, end, posterior.chains)});
  const calibration::FitOptions& starts = file.options;
  if (starts.starts_from > 0 || (starts.starts_to >= 0 && starts.starts_to < starts.starts))
    throw input::BadInput(
        {"the posterior is drawn around the best of all starts: share out the starts without it, "
         "then its chains with --merge of their folders and --chains-from, --chains-to"});
  posterior.chains_from = from;
  posterior.chains_to = merged ? from : end;
}

}  // namespace repose::study
