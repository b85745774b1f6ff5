#include "study/fit/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "io/fingerprint.hpp"
#include "study/fit/journal.hpp"

namespace repose::study {
namespace {

using calibration::Channel;
using calibration::Target;
using Eigen::Index;
using io::Json;

/// What of a target differs from another's; empty if nothing does.
std::string difference(const Target& a, const Target& b, const std::string& in_a,
                       const std::string& in_b) {
  const auto both = [&](const std::string& what, const auto& x, const auto& y) {
    return fmt::format("{} {} in {} and {} in {}", what, x, in_a, y, in_b);
  };
  if (a.name != b.name) return both("it is called", a.name, b.name);
  if (a.held_out != b.held_out)
    return fmt::format("it is held out in {} alone", a.held_out ? in_a : in_b);
  if (a.rows() != b.rows()) return both("it has rows:", a.rows(), b.rows());
  if (a.x_name != b.x_name) return both("its x is", a.x_name, b.x_name);
  if (a.channels.size() != b.channels.size())
    return both("it has channels:", a.channels.size(), b.channels.size());
  for (Index i = 0; i < a.rows(); ++i)
    if (a.x[i] != b.x[i])
      return both(fmt::format("{} of row {} is", a.x_name, i + 1), a.x[i], b.x[i]);
  const bool a_is_distance = a.compare == calibration::Compare::distance;
  if (a_is_distance != (b.compare == calibration::Compare::distance))
    return fmt::format("it is compared by distance in {} alone", a_is_distance ? in_a : in_b);
  for (std::size_t c = 0; c < a.channels.size(); ++c) {
    const Channel &p = a.channels[c], &q = b.channels[c];
    if (p.name != q.name) return both(fmt::format("channel {} is", c + 1), p.name, q.name);
    const auto noise = [](const Channel& channel) {
      return channel.noise ? fmt::format("{}", *channel.noise) : std::string("not declared");
    };
    if (noise(p) != noise(q) || p.row_noise.size() != q.row_noise.size())
      return both("the noise of " + p.name + " is", noise(p), noise(q));
    for (Index i = 0; i < a.rows(); ++i)
      if (p.observed[i] != q.observed[i])
        return both(fmt::format("{} of row {} is", p.name, i + 1), p.observed[i], q.observed[i]);
  }
  return {};
}

calibration::OptimiseOptions left_out_options(const input::FitFile& file) {
  calibration::OptimiseOptions options;
  options.max_evaluations =
      file.coarse.empty() ? file.options.local_evaluations : file.fine_evaluations;
  options.x_tolerance = file.options.x_tolerance;
  options.seed = file.options.seed;
  return options;
}

std::string left_out_algorithm(const input::FitFile& file) {
  if (file.options.local != "none") return file.options.local;
  return file.coarse.empty() ? std::string(calibration::levenberg_marquardt_name) : "LN_BOBYQA";
}

/// Sum of the scores and r.m.s. of the errors of some tests.
void sum_up(const Comparison& comparison, const ScoredFit& fit, bool held_out, double& score,
            double& error) {
  double squares = 0.0, channels = 0.0;
  score = 0.0;
  for (std::size_t k = 0; k < comparison.tests.size(); ++k) {
    if (comparison.tests[k].held_out != held_out) continue;
    const calibration::UnseenTest& test = fit.tests[k].test;
    score += test.failed ? std::nan("") : test.log_score;
    for (const auto& c : test.channels) {
      if (!std::isfinite(c.relative_rms)) continue;
      squares += c.relative_rms * c.relative_rms;
      channels += 1.0;
    }
  }
  if (channels == 0.0) score = std::nan("");
  error = std::sqrt(squares / channels);
}

std::string fingerprint_of(const std::vector<Contender>& contenders) {
  std::string key;
  for (const Contender& c : contenders) {
    key += c.name + " " + c.file.fingerprint;
    for (const double z : c.result.best().z) key += fmt::format(" {}", z);
  }
  return io::fingerprint_of(key);
}

}  // namespace

std::vector<ComparedTest> compared_tests(const input::FitFile& file) {
  std::vector<ComparedTest> tests;
  for (std::size_t k = 0; k < file.targets.size(); ++k) {
    const bool more = k > 0 && file.about[k].table == file.about[k - 1].table;
    if (!more) {
      tests.push_back({file.targets[k].name, {}, file.targets[k].held_out});
      // a part is named after its first channel
      const bool parted =
          k + 1 < file.targets.size() && file.about[k + 1].table == file.about[k].table;
      if (parted) tests.back().name.resize(tests.back().name.rfind(": "));
    }
    tests.back().targets.push_back(k);
  }
  return tests;
}

void check_same_data(const std::vector<input::FitFile>& files) {
  const input::FitFile& first = files.front();
  for (std::size_t f = 1; f < files.size(); ++f) {
    const input::FitFile& other = files[f];
    for (std::size_t g = 0; g < f; ++g)
      if (files[g].name == other.name)
        throw input::BadInput({fmt::format(
            "two of the fits are called {}, and so would be the folders of their results: rename "
            "one of the files",
            other.name)});
    const std::string not_same =
        fmt::format("{} and {} are not fits of the same data: ", first.name, other.name);
    if (first.targets.size() != other.targets.size())
      throw input::BadInput({fmt::format("{}they have {} and {} targets", not_same,
                                         first.targets.size(), other.targets.size())});
    for (std::size_t k = 0; k < first.targets.size(); ++k) {
      const std::string what =
          difference(first.targets[k], other.targets[k], first.name, other.name);
      if (!what.empty())
        throw input::BadInput(
            {fmt::format("{}of target {}, {}, {}", not_same, k + 1, first.targets[k].name, what)});
    }
  }
}

Comparison compare(const std::vector<Contender>& contenders, const ComparisonRequest& request) {
  Comparison comparison;
  comparison.tests = compared_tests(contenders.front().file);
  comparison.left_out = std::count_if(comparison.tests.begin(), comparison.tests.end(),
                                      [](const auto& t) { return !t.held_out; }) >= 2;
  for (const Contender& c : contenders) {
    ScoredFit fit;
    fit.name = c.name;
    fit.law = c.file.law.name;
    if (!c.file.info->option.empty()) fit.law += fmt::format(" {}", c.file.info->option);
    for (const auto& p : c.file.free) fit.parameters.push_back(p.name);
    const Eigen::VectorXd& z = c.result.best().z;
    fit.white = calibration::most_likely(c.problem, z, calibration::Errors::white);
    fit.correlated = calibration::most_likely(c.problem, z, calibration::Errors::correlated);
    fit.tests.resize(comparison.tests.size());
    comparison.fits.push_back(std::move(fit));
  }
  const std::size_t tests = comparison.tests.size();
  std::mutex mutex;
  tbb::parallel_for(std::size_t{0}, contenders.size() * tests, [&](std::size_t i) {
    const Contender& c = contenders[i / tests];
    const ComparedTest& test = comparison.tests[i % tests];
    calibration::LeftOut& left = comparison.fits[i / tests].tests[i % tests];
    const Eigen::VectorXd& z = c.result.best().z;
    if (test.held_out) {
      left.test = calibration::score_unseen(c.problem, z, test.targets);
      return;
    }
    if (!comparison.left_out || c.problem.interrupted()) return;
    const auto known = std::find_if(request.done.begin(), request.done.end(), [&](const auto& d) {
      return d.fit == c.name && d.test == test.name;
    });
    if (known != request.done.end()) {
      left = calibration::left_out(c.problem, known->optimum, test.targets);
      return;
    }
    left = calibration::leave_out(c.problem, z, test.targets, left_out_algorithm(c.file),
                                  left_out_options(c.file));
    const std::lock_guard lock(mutex);
    if (request.after && left.optimum.why != "interrupted")
      request.after({c.name, test.name, left.optimum});
  });
  for (const Contender& c : contenders)
    comparison.complete = comparison.complete && !c.problem.interrupted();
  for (ScoredFit& fit : comparison.fits) {
    sum_up(comparison, fit, false, fit.left_out_score, fit.left_out_error);
    sum_up(comparison, fit, true, fit.held_out_score, fit.held_out_error);
  }
  return comparison;
}

std::string comparison_name(const std::vector<input::FitFile>& files) {
  std::string name;
  for (const input::FitFile& file : files) name += (name.empty() ? "" : "_") + file.name;
  return name;
}

std::string journal_line(const LeftOutFit& fit) {
  return journal_line(
      Json{{"fit", fit.fit}, {"test", fit.test}, {"optimum", json_of(fit.optimum)}});
}

std::vector<LeftOutFit> begin_comparison(const io::ResultFolder& folder,
                                         const std::vector<Contender>& contenders, bool resume) {
  const std::string fingerprint = fingerprint_of(contenders);
  std::vector<LeftOutFit> done;
  if (resume)
    read_journal(folder.file(left_out_name), "test left out", fingerprint, [&](const Json& j) {
      done.push_back({j.at("fit").get<std::string>(), j.at("test").get<std::string>(),
                      optimum_of(j.at("optimum"))});
    });
  std::vector<std::string> names;
  for (const Contender& c : contenders) names.push_back(c.name);
  std::string text = Json{{"comparison", names}, {"fingerprint", fingerprint}}.dump() + "\n";
  for (const LeftOutFit& d : done) text += journal_line(d);
  folder.write_file(left_out_name, text);
  folder.remove_old_outputs();
  return done;
}

}  // namespace repose::study
