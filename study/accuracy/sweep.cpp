#include "study/accuracy/sweep.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/core.h>

#include "input/resolved_scene.hpp"
#include "io/json.hpp"
#include "io/progress.hpp"
#include "io/result_folder.hpp"
#include "repose_version.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_record.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;

constexpr int rows_of_series = 60;

/// The step as it was asked for: fixed steps [s], or Courant numbers, which compare among
/// themselves.
double nominal_step(const mpm::Scene& scene) { return scene.dt.value_or(scene.courant); }

std::string name_of_run(const mpm::Scene& base, const mpm::Scene& scene) {
  const std::string step =
      scene.dt ? fmt::format("dt{}", *scene.dt) : fmt::format("courant{}", scene.courant);
  const std::string points = scene.points_per_cell == base.points_per_cell
                                 ? ""
                                 : fmt::format("_{}ppc", scene.points_per_cell);
  return fmt::format("{}_{}_{}{}_h{}_{}", base.name, mpm::name_of(scene.transfer),
                     mpm::name_of(scene.kernel), points, scene.h, step);
}

double initial_height(const mpm::Scene& scene) {
  double top = 0.0;
  for (const mpm::Body& body : scene.bodies) top = std::max(top, body.origin[1] + body.size[1]);
  return top;
}

/// Why this scene cannot be run with a transfer; "" if it can, or if it is the scene that is wrong.
std::string refusal(mpm::Scene scene, mpm::Transfer transfer) {
  try {
    mpm::validate(scene);
  } catch (const InputError&) {
    return "";
  }
  scene.transfer = transfer;
  try {
    mpm::validate(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// The text after its first line, which names the version: what else is the same is the same
/// solver's, by the digest in the second.
std::string_view after_version(std::string_view text) {
  return text.substr(std::min(text.size(), text.find('\n')));
}

void read_result(SweepRun& run, const fs::path& folder) {
  run.summary = read_summary(folder / "summary.json");
  run.series = read_numbers(folder / "series.csv");
  if (!run.done()) return;
  auto profile = read_numbers(folder / "profile.csv");
  run.x_m = std::move(profile["x_m"]);
  run.depth_m = std::move(profile["depth_m"]);
}

}  // namespace

input::Sweep with_defaults(input::Sweep sweep, const mpm::Scene& scene, bool quick,
                           std::vector<std::string>& notes) {
  if (sweep.transfers.empty())
    for (std::size_t k = 0; k < mpm::transfer_names.size(); ++k) {
      const auto transfer = static_cast<mpm::Transfer>(k);
      const std::string why = refusal(scene, transfer);
      if (why.empty())
        sweep.transfers.push_back(transfer);
      else
        notes.push_back(fmt::format("{} is left out: {}", mpm::name_of(transfer), why));
    }
  if (sweep.kernels.empty()) sweep.kernels = {scene.kernel};
  if (sweep.points_per_cell.empty()) sweep.points_per_cell = {scene.points_per_cell};
  if (sweep.cells.empty()) {
    sweep.cells = {4.0 * scene.h};
    if (!quick) sweep.cells = {8.0 * scene.h, 4.0 * scene.h, 2.0 * scene.h};
  }
  if (sweep.courants.empty() && sweep.dts.empty()) {
    sweep.courants = {0.8, 0.4};
    if (!quick) sweep.courants.insert(sweep.courants.end(), {0.2, 0.1});
  }
  return sweep;
}

double SweepRun::figure(std::string_view key) const {
  const auto found = summary.figures.find(named(key, scene().dimensions()));
  return found != summary.figures.end() ? found->second : std::nan("");
}

const std::vector<double>& SweepRun::column(std::string_view key) const {
  static const std::vector<double> none;
  const auto found = series.find(named(key, scene().dimensions()));
  return found != series.end() ? found->second : none;
}

SweepRun run_of(const input::SceneFile& base, mpm::Scene scene) {
  SweepRun run{base, {}, {}, {}, {}, {}};
  scene.frame_interval = 0.0;
  scene.series_interval = scene.end_time / rows_of_series;
  mpm::raise_top_to_cells(scene);
  mpm::validate(scene);
  scene.name = name_of_run(base.scene, scene);
  run.file.scene = std::move(scene);
  return run;
}

namespace {

/// Every combination for one scene, and if asked for the finer cells of the reference.
void add_runs(const input::SceneFile& base, const input::Sweep& sweep, bool with_reference,
              std::vector<SweepRun>& runs) {
  const auto descending = [](auto values) {
    std::sort(values.rbegin(), values.rend());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
  };
  const auto add = [&](mpm::Scene scene, double h) {
    scene.h = h;
    const auto add_step = [&](double courant, std::optional<double> dt) {
      scene.courant = courant;
      scene.dt = dt;
      try {
        runs.push_back(run_of(base, scene));
      } catch (const InputError& error) {
        mpm::Scene with_own = scene;
        with_own.transfer = base.scene.transfer;
        mpm::raise_top_to_cells(with_own);
        if (const std::string why = refusal(with_own, scene.transfer); !why.empty())
          throw InputError("chart.transfers", why);
        throw InputError("chart.cells", fmt::format("cells of {} m: {}", h, error.what()));
      }
    };
    for (const double courant : descending(sweep.courants)) add_step(courant, {});
    for (const double dt : descending(sweep.dts)) add_step(mpm::Scene{}.courant, dt);
  };
  for (const mpm::Transfer transfer : sweep.transfers)
    for (const mpm::Kernel kernel : sweep.kernels)
      for (const std::int64_t points : descending(sweep.points_per_cell)) {
        mpm::Scene scene = base.scene;
        scene.transfer = transfer;
        scene.kernel = kernel;
        scene.points_per_cell = static_cast<int>(points);
        for (const double h : descending(sweep.cells)) add(scene, h);
      }
  if (with_reference)
    for (const double h : descending(sweep.reference)) add(base.scene, h);
}

/// "_pressure_averaging50" of "pressure_averaging 50": what a folder's name may hold.
std::string file_suffix(const std::string& variation) {
  if (variation.empty()) return "";
  std::string suffix = "_";
  for (const char c : variation)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_' || c == '+')
      suffix += c;
  return suffix;
}

}  // namespace

std::string SweepRun::variation() const {
  std::string text;
  for (const auto& [key, value] : varied)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", key.substr(key.rfind('.') + 1), value);
  return text;
}

std::vector<SweepRun> runs_of(const input::SceneFile& scene, const input::Sweep& sweep) {
  const SceneVariant only{scene, {}};
  return runs_of(std::span(&only, 1), sweep);
}

std::vector<SweepRun> runs_of(std::span<const SceneVariant> variants, const input::Sweep& sweep) {
  double count = static_cast<double>(sweep.reference.size());
  count += static_cast<double>(variants.size()) * static_cast<double>(sweep.transfers.size()) *
           static_cast<double>(sweep.kernels.size()) *
           static_cast<double>(sweep.points_per_cell.size()) *
           static_cast<double>(sweep.cells.size()) *
           static_cast<double>(sweep.courants.size() + sweep.dts.size());
  if (count > most_chart_runs)
    throw InputError("chart", fmt::format("the lists of [chart] make {:g} runs, and a chart has at "
                                          "most {}",
                                          count, most_chart_runs));
  std::vector<SweepRun> runs;
  for (const SceneVariant& variant : variants) {
    const std::size_t before = runs.size();
    add_runs(variant.file, sweep, &variant == &variants.front(), runs);
    for (std::size_t i = before; i < runs.size(); ++i) {
      runs[i].varied = variant.values;
      runs[i].file.scene.name += file_suffix(runs[i].variation());
    }
  }
  return runs;
}

std::vector<SweepSeries> series_of(std::span<const SweepRun> runs) {
  std::vector<SweepSeries> list;
  for (const SweepRun& run : runs) {
    const auto same = [&](const SweepSeries& s) {
      return s.scene().transfer == run.scene().transfer && s.scene().kernel == run.scene().kernel &&
             s.scene().points_per_cell == run.scene().points_per_cell &&
             s.runs.front()->varied == run.varied && s.scene().h == run.scene().h;
    };
    const auto found = std::find_if(list.begin(), list.end(), same);
    (found == list.end() ? list.emplace_back() : *found).runs.push_back(&run);
  }
  return list;
}

std::string SweepSeries::name() const {
  std::string text(mpm::name_of(scene().transfer));
  if (scene().points_per_cell != mpm::Scene{}.points_per_cell)
    text += fmt::format(", {} per cell", scene().points_per_cell);
  if (const std::string variation = runs.front()->variation(); !variation.empty())
    text += ", " + variation;
  return text;
}

const SweepRun* SweepSeries::finest() const {
  const SweepRun* finest = nullptr;
  for (const SweepRun* run : runs) {
    if (run->status().empty()) return nullptr;
    if (run->done() && (finest == nullptr || run->mean_dt() < finest->mean_dt())) finest = run;
  }
  return finest;
}

std::vector<const SweepRun*> SweepSeries::done_runs() const {
  std::vector<const SweepRun*> list;
  for (const SweepRun* run : runs)
    if (run->done()) list.push_back(run);
  std::stable_sort(list.begin(), list.end(), [](const SweepRun* a, const SweepRun* b) {
    return a->mean_dt() > b->mean_dt();
  });
  return list;
}

std::optional<SweepChange> change_between(const SweepRun& run, const SweepRun& reference) {
  if (!run.done() || !reference.done() || run.depth_m.size() != reference.depth_m.size()) return {};
  const double front = reference.figure("front_m"), height = reference.figure("height_m");
  if (!(front > 0.0) || !(height > 0.0)) return {};
  const double H_0 = initial_height(run.scene());
  SweepChange change{run.figure("front_m") / front - 1.0,
                     run.figure("front_99_m") / reference.figure("front_99_m") - 1.0,
                     run.figure("height_m") / height - 1.0, 0.0, 0.0};
  for (std::size_t i = 0; i < run.depth_m.size(); ++i) {
    const double difference = std::abs(run.depth_m[i] - reference.depth_m[i]);
    // the end columns are half as wide (deposit.hpp)
    const double width =
        i == 0 || i + 1 == run.depth_m.size() ? 0.5 * run.scene().h : run.scene().h;
    change.profile_mean += difference * width / (front * H_0);
    change.profile_max = std::max(change.profile_max, difference / H_0);
  }
  return change;
}

std::optional<SweepChange> change_when_quartered(const SweepSeries& series) {
  std::optional<SweepChange> worst;
  for (const SweepRun* run : series.runs)
    for (const SweepRun* shorter : series.runs) {
      if (run->scene().dt.has_value() != shorter->scene().dt.has_value()) continue;
      const double ratio = nominal_step(run->scene()) / nominal_step(shorter->scene());
      if (std::abs(ratio - 4.0) > 1e-9) continue;
      const auto change = change_between(*run, *shorter);
      if (!change) return {};
      if (!worst) worst = SweepChange{};
      worst->front = std::max(worst->front, std::abs(change->front));
      worst->front_99 = std::max(worst->front_99, std::abs(change->front_99));
      worst->height = std::max(worst->height, std::abs(change->height));
      worst->profile_mean = std::max(worst->profile_mean, change->profile_mean);
      worst->profile_max = std::max(worst->profile_max, change->profile_max);
    }
  return worst;
}

io::ExitCode carry_out(SweepRun& run, const fs::path& folder, int threads, bool resume,
                       double cpu_limit_s) {
  RunRequest request;
  request.file = run.file;
  request.file.notes.clear();
  request.input = input::resolved_input(
      run.file, fmt::format("One of several runs of a scene; solver {}.", solver_digest));
  request.folder = folder / run.scene().name;
  request.threads = threads;
  request.quiet = true;
  request.cpu_limit_s = cpu_limit_s;
  const std::string there = noted_status(request.folder / "summary.json");
  const std::string text = text_of(request.folder / "input.toml");
  const bool same = !text.empty() && after_version(text) == after_version(request.input);
  const bool ended = there == "done" || there == "failed";
  std::string damage;
  if (same && ended) damage = io::ResultFolder(request.folder).damage();
  if (!damage.empty()) io::warn_of_damage(request.folder.string(), damage, "so it is run again");
  if (!same || !ended || !damage.empty()) {
    request.resume = resume && same && (there == "interrupted" || there == "running");
    const io::ExitCode code = run_scene(request);
    if (code == io::ExitCode::interrupted) return code;
  } else {
    tidy_finished(io::ResultFolder(request.folder));
  }
  read_result(run, request.folder);
  return io::ExitCode::done;
}

}  // namespace repose::study
