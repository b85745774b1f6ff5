#include "study/run/run_scene.hpp"

#include <cctype>
#include <cmath>
#include <cstdio>
#include <set>

#include <fmt/core.h>

#include "input/resolved_scene.hpp"
#include "io/frame_reader.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "mpm/output/frame_fields.hpp"
#include "mpm/output/grid_frame.hpp"
#include "mpm/study/needs.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/output_schedule.hpp"
#include "study/run/run_record.hpp"
#include "study/run/terrain_result.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;
using Json = io::Json;

/// Says where a run stands: warnings on the standard error output, the rest on the standard output.
class Voice {
 public:
  explicit Voice(const RunRequest& request) : quiet_(request.quiet), json_(request.json) {}

  void warn(const std::string& text) const {
    if (json_)
      event({{"event", "warning"}, {"message", text}});
    else if (!quiet_)
      std::fprintf(stderr, "warning: %s\n", text.c_str());  // never throws: no run is lost for it
  }
  void say(const std::string& text) const {
    if (!json_ && !quiet_) fmt::print("{}", text);
    std::fflush(stdout);
  }
  void event(const Json& line) const {
    if (json_) fmt::print("{}\n", line.dump());
    std::fflush(stdout);
  }

 private:
  bool quiet_, json_;
};

/// Refuses to go on with anything but the input that was interrupted.
void require_same_input(const RunRequest& request, const fs::path& stored) {
  const input::InputFile there = input::InputFile::read(stored);
  const input::InputFile here = input::InputFile::parse(request.input, "resolved input");
  std::vector<std::string> lines = input::differences(there.root(), here.root());
  if (lines.empty()) return;
  for (std::string& line : lines) line = fmt::format("{}: {}", stored.string(), line);
  lines.push_back(fmt::format(
      "{}: a run is resumed with the input it was begun with; without --resume it begins anew",
      stored.string()));
  throw input::BadInput(std::move(lines));
}

class Run {
 public:
  explicit Run(const RunRequest& request)
      : request_(request),
        scene_(request.file.scene),
        voice_(request),
        begun_(usage()),
        simulation_(scene_, request.threads),
        record_(simulation_),
        schedule_(scene_.end_time, scene_.series_interval, scene_.frame_interval),
        folder_(request.folder),
        claim_(folder_),
        frame_fields_(simulation_) {}

  io::ExitCode go();

 private:
  io::ExitCode advance();
  io::ExitCode finish();
  io::ExitCode stop_at_interrupt();
  io::ExitCode stop_at_failure(const std::string& reason);

  void start();
  void resume();
  void write_due();
  void write_probes();
  /// `open(file, columns)` for the table of every probe and tracer.
  template <class Open>
  void open_probes(Open&& open);
  void write_frame();
  void write_profile() const;
  bool write_picture();
  void write_checkpoint();
  void write_checkpoint_if_due();
  void load_checkpoint();
  void write_summary(const std::string& status, const std::string& reason);
  void tell_warnings();
  bool finite_state(std::string& reason) const;

  const RunRequest& request_;
  const mpm::Scene& scene_;
  Voice voice_;
  Usage begun_;
  mpm::Simulation simulation_;
  RunRecord record_;
  OutputSchedule schedule_;
  io::ResultFolder folder_;
  io::FolderClaim claim_;
  std::optional<io::RowWriter> series_;
  std::vector<io::RowWriter> probes_, tracers_;
  std::optional<io::FrameWriter> frames_;
  mpm::FrameFields frame_fields_;  ///< a run that fails writes a frame whatever it was asked for
  std::optional<io::FrameWriter> grid_frames_;
  mpm::GridFrame grid_frame_;
  double next_checkpoint_ = 0.0;           ///< by the clock of usage() [s]
  std::set<std::string> told_;             ///< warnings already printed, without_figures()
  std::vector<std::string> own_warnings_;  ///< beside the simulation's
};

io::ExitCode Run::go() {
  for (const std::string& note : request_.file.notes) {
    voice_.warn(note);
    own_warnings_.push_back(note);
  }
  try {
    if (request_.resume)
      resume();
    else
      start();
  } catch (const mpm::NumericalFailure& failure) {
    return stop_at_failure(failure.what());
  }
  return advance();
}

template <class Open>
void Run::open_probes(Open&& open) {
  const bool space = scene_.dimensions() == 3;
  const auto columns = [&](std::vector<std::string> first) {
    std::vector<std::string> all{"time_s"};
    all.insert(all.end(), first.begin(), first.end());
    all.insert(all.end(), {"vx_m_per_s", "vy_m_per_s"});
    if (space) all.emplace_back("vz_m_per_s");
    all.insert(all.end(), {"speed_m_per_s", "pressure_Pa", "q_Pa", "density_kg_per_m3"});
    return all;
  };
  for (const mpm::Probe& probe : scene_.probes)
    probes_.push_back(
        open(folder_.file(fmt::format("probe_{}.csv", probe.name)), columns({"depth_m"})));
  std::vector<std::string> place{"x_m", "y_m"};
  if (space) place.emplace_back("z_m");
  for (const mpm::Probe& tracer : scene_.tracers)
    tracers_.push_back(
        open(folder_.file(fmt::format("tracer_{}.csv", tracer.name)), columns(place)));
}

/// A row for every probe and tracer; what is not there has empty cells.
void Run::write_probes() {
  const std::size_t axes = scene_.dimensions();
  const auto write = [&](io::RowWriter& table, const mpm::Simulation::Sight& sight, bool place) {
    std::string row = fmt::format("{}", simulation_.time());
    const auto add = [&](double x, bool there) {
      row += there ? fmt::format(",{}", x) : std::string(",");
    };
    const bool there = sight.mass > 0.0;
    if (place)
      for (std::size_t i = 0; i < axes; ++i) add(sight.position[i], there);
    else
      add(sight.depth, true);
    for (std::size_t i = 0; i < axes; ++i) add(sight.velocity[i], there);
    add(std::hypot(sight.velocity[0], sight.velocity[1], sight.velocity[2]), there);
    add(sight.pressure, there);
    add(sight.q, there);
    add(sight.density, there);
    table.rows(row + "\n");
  };
  for (std::size_t k = 0; k < probes_.size(); ++k)
    write(probes_[k], simulation_.look_at(scene_.probes[k].place), false);
  for (std::size_t k = 0; k < tracers_.size(); ++k) write(tracers_[k], simulation_.tracer(k), true);
}

void Run::start() {
  mpm::require_end_in_reach(scene_, simulation_.next_dt());
  if (fs::exists(folder_.checkpoint()))
    voice_.warn(fmt::format("{} held an interrupted run, which begins anew; --resume continues one",
                            folder_.path().string()));
  folder_.remove_old_outputs();
  folder_.write_file("input.toml", request_.input);
  series_.emplace(io::RowWriter::create(folder_.file("series.csv"), series_columns(scene_)));
  open_probes([](fs::path file, std::vector<std::string> columns) {
    return io::RowWriter::create(std::move(file), std::move(columns));
  });
  if (scene_.frame_interval > 0.0) frames_.emplace(folder_.frames(), scene_.name);
  if (frames_ && scene_.grid_frames)
    grid_frames_.emplace(folder_.frames(), io::grid_series_name(scene_.name));
  voice_.event({{"event", "start"},
                {"name", scene_.name},
                {"points", record_.initial_points},
                {"end_time_s", scene_.end_time},
                {"folder", folder_.path().string()}});
  write_due();
}

void Run::resume() {
  folder_.remove_old_parts();
  std::error_code ignored;
  fs::remove(folder_.file("manifest.json"), ignored);  // of the failure before
  require_same_input(request_, folder_.file("input.toml"));
  record_.continue_from(folder_.file("summary.json"));
  load_checkpoint();
  const double time = simulation_.time();
  series_.emplace(
      io::RowWriter::continued(folder_.file("series.csv"), series_columns(scene_), time));
  open_probes([&](fs::path file, std::vector<std::string> columns) {
    return io::RowWriter::continued(std::move(file), std::move(columns), time);
  });
  if (scene_.frame_interval > 0.0)
    frames_ = io::FrameWriter::continued(folder_.frames(), scene_.name, time);
  if (frames_ && scene_.grid_frames)
    grid_frames_ =
        io::FrameWriter::continued(folder_.frames(), io::grid_series_name(scene_.name), time);
  voice_.event({{"event", "resume"},
                {"name", scene_.name},
                {"time_s", time},
                {"step", simulation_.steps()},
                {"folder", folder_.path().string()}});
  voice_.say(fmt::format("{}: resumed at t = {:.6g} s, step {}\n", scene_.name, time,
                         simulation_.steps()));
}

/// The state as it is, beside the one before it. The summary comes first: what it says of rows that
/// a run resumed from the older state writes again is the same.
void Run::write_checkpoint() {
  if (fs::exists(folder_.checkpoint())) {
    std::error_code ignored;  // a file system without links keeps one checkpoint
    fs::remove(folder_.previous_checkpoint(), ignored);
    fs::create_hard_link(folder_.checkpoint(), folder_.previous_checkpoint(), ignored);
  }
  simulation_.save(folder_.checkpoint());
}

/// Once in checkpoint_interval, and never more than a fiftieth of the time.
void Run::write_checkpoint_if_due() {
  const double interval = request_.file.checkpoint_interval, begun = usage().wall_s;
  if (!(interval > 0.0) || begun < next_checkpoint_) return;
  if (next_checkpoint_ > 0.0) {
    write_summary("running", "");
    write_checkpoint();
  }
  const double end = usage().wall_s;
  next_checkpoint_ = end + std::max(interval, 50.0 * (end - begun));
}

/// The last checkpoint, or, if that is damaged, the one before it: the run comes to the same bits.
void Run::load_checkpoint() {
  if (fs::exists(folder_.checkpoint())) {
    try {
      simulation_.load(folder_.checkpoint());
      return;
    } catch (const io::IoError& error) {
      if (!fs::exists(folder_.previous_checkpoint())) throw;
      voice_.warn(fmt::format("{}; going on from the one before it", error.what()));
    }
  }
  simulation_.load(folder_.previous_checkpoint());
}

io::ExitCode Run::advance() {
  const io::InterruptGuard interrupt;
  io::Progress progress(io::Progress::mode(request_.quiet, request_.json), scene_.name,
                        scene_.end_time);
  try {
    while (simulation_.time() < scene_.end_time) {
      const bool first = simulation_.steps() == 0;
      simulation_.step(schedule_.next(simulation_.time()));
      if (simulation_.point_count() == 0) {
        own_warnings_.push_back(
            fmt::format("all material had left the box by t = {:.6g} s", simulation_.time()));
        progress.clear();
        voice_.warn(own_warnings_.back());
        break;
      }
      write_due();
      if (first) {
        progress.clear();
        tell_warnings();
      }
      write_checkpoint_if_due();
      const bool end = simulation_.time() >= scene_.end_time;
      progress.update(simulation_.time(), simulation_.steps(), simulation_.point_steps(), end);
      const bool spent = usage().cpu_s - begun_.cpu_s > request_.cpu_limit_s;
      if ((interrupt.requested() || spent) && !end) {
        progress.clear();
        return stop_at_interrupt();
      }
    }
  } catch (const mpm::NumericalFailure& failure) {
    progress.clear();
    return stop_at_failure(failure.what());
  }
  progress.clear();
  return finish();
}

/// Writes the row and the frame that belong to this very moment.
void Run::write_due() {
  const double time = simulation_.time();
  if (schedule_.row_due(time)) {
    const mpm::SeriesRow row = simulation_.diagnostics();
    record_.include(row);
    const std::vector<double> values = series_values(row, simulation_);
    for (const double x : values)
      if (!std::isfinite(x))
        throw mpm::NumericalFailure(fmt::format(
            "step {} at t = {:.6g} s: a figure of the series is not finite", row.step, time));
    series_->row(values);
    write_probes();
  }
  if (frames_ && schedule_.frame_due(time)) write_frame();
}

void Run::write_frame() {
  const mpm::Simulation::Snapshot shot = simulation_.snapshot(request_.file.stress);
  if (shot.x_m.empty()) return;
  frames_->write(frame_fields_.view(shot, simulation_.time()));
  if (grid_frames_) grid_frames_->write(grid_frame_.view(simulation_));
}

void Run::write_profile() const {
  const mpm::Simulation::Profile profile = simulation_.profile();
  std::string text = "x_m,depth_m\n";
  for (std::size_t i = 0; i < profile.x_m.size(); ++i)
    text += fmt::format("{},{}\n", profile.x_m[i], profile.depth_m[i]);
  folder_.write_file("profile.csv", text);
}

/// Whether there is one: a picture is never worth a run.
bool Run::write_picture() {
  if (!request_.picture || simulation_.point_count() == 0) return false;
  try {
    return request_.picture(request_.file, simulation_, folder_.file("final.svg"));
  } catch (const std::runtime_error& error) {
    own_warnings_.push_back(fmt::format("final.svg could not be drawn: {}", error.what()));
    voice_.warn(own_warnings_.back());
    return false;
  }
}

/// A warning without its figures, which may grow while it stays the same warning.
std::string without_figures(std::string_view text) {
  std::string words;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    if (word.empty() || std::isdigit(static_cast<unsigned char>(word.front())) == 0)
      words += std::string(word) + ' ';
    text.remove_prefix(std::min(word.size() + 1, text.size()));
  }
  return words;
}

void Run::tell_warnings() {
  for (const std::string& warning : simulation_.warnings()) {
    if (!told_.insert(without_figures(warning)).second) continue;
    voice_.warn(warning);
  }
}

void Run::write_summary(const std::string& status, const std::string& reason) {
  RunFacts facts;
  facts.status = status;
  facts.reason = reason;
  facts.input = input::InputFile::parse(request_.input, "input.toml").root();
  facts.seed = request_.seed;
  facts.warnings = simulation_.warnings();
  facts.warnings.insert(facts.warnings.end(), own_warnings_.begin(), own_warnings_.end());
  Usage spent = usage();
  spent.wall_s -= begun_.wall_s;
  spent.cpu_s -= begun_.cpu_s;
  folder_.write_file("summary.json", summary_text(facts, record_, simulation_, spent));
}

io::ExitCode Run::finish() {
  const mpm::SeriesRow last = simulation_.diagnostics();
  const std::int64_t lost = record_.lost_points(simulation_.point_count(), last);
  if (lost != 0) return stop_at_failure(fmt::format("{} points have been lost", lost));
  tell_warnings();
  write_profile();
  if (scene_.terrain) write_terrain_maps(folder_, simulation_);
  if (request_.file.final_state) simulation_.save_final_state(folder_.file("final_state.h5"));
  const bool drawn = write_picture();
  write_summary("done", "");
  folder_.seal();
  folder_.remove_checkpoints();

  const double wall = record_.wall_s + usage().wall_s - begun_.wall_s;
  voice_.event(
      {{"event", "end"}, {"status", "done"}, {"exit", 0}, {"folder", folder_.path().string()}});
  std::string files = drawn ? "final.svg, series.csv, profile.csv" : "series.csv, profile.csv";
  if (scene_.terrain)
    for (const char* const map : {"largest_depth", "largest_speed", "arrival_time", "deposit"})
      files += fmt::format(", {}.{}", map, scene_.terrain->geotiff ? "tif" : "asc");
  if (scene_.terrain) files += ", outlines.geojson";
  for (const auto* const frames : {&frames_, &grid_frames_})
    if (*frames) files += fmt::format(", frames/{}", (*frames)->series_path().filename().string());
  const std::string extent =
      scene_.terrain ? flow_extent(simulation_)
                     : fmt::format("front {:.4g} m, height {:.4g} m", last.front_m, last.height_m);
  voice_.say(
      fmt::format("{}: done in {}, {} steps, {:.1f} Mpoint-steps/s\n"
                  "  {}, kinetic energy {:.2g} {}, energy error {:.2g} %\n"
                  "  {}: {}\n",
                  scene_.name, io::duration_text(wall), last.step,
                  static_cast<double>(simulation_.point_steps()) / wall / 1e6, extent,
                  last.kinetic_J_per_m, scene_.dimensions() == 2 ? "J/m" : "J",
                  100.0 * record_.energy_error(last), folder_.path().string(), files));
  return io::ExitCode::done;
}

io::ExitCode Run::stop_at_interrupt() {
  write_summary("interrupted", "");
  write_checkpoint();
  voice_.event({{"event", "end"},
                {"status", "interrupted"},
                {"exit", static_cast<int>(io::ExitCode::interrupted)},
                {"time_s", simulation_.time()},
                {"folder", folder_.path().string()}});
  if (!request_.json && !request_.quiet)
    fmt::print(stderr,
               "{}: interrupted at t = {:.6g} s; the same command with --resume continues\n",
               scene_.name, simulation_.time());
  return io::ExitCode::interrupted;
}

io::ExitCode Run::stop_at_failure(const std::string& reason) {
  simulation_.save(folder_.checkpoint());
  if (!frames_) frames_.emplace(folder_.frames(), scene_.name);
  if (!schedule_.frame_due(simulation_.time()) || frames_->count() == 0) write_frame();
  tell_warnings();
  write_summary("failed", reason);
  folder_.seal();
  voice_.event({{"event", "end"},
                {"status", "failed"},
                {"exit", static_cast<int>(io::ExitCode::numerical_failure)},
                {"reason", reason},
                {"folder", folder_.path().string()}});
  fmt::print(stderr, "{}: failed: {}\n  the state before it is in {}\n", scene_.name, reason,
             folder_.path().string());
  return io::ExitCode::numerical_failure;
}

}  // namespace

io::ExitCode run_scene(const RunRequest& request) {
  RunRequest asked = request;
  if (asked.resume) {
    if (!fs::is_directory(asked.folder))
      throw io::IoError(asked.folder,
                        "there is no such result to resume; without --resume it is begun");
    const io::ResultFolder folder(asked.folder);
    if (!fs::exists(folder.checkpoint()) && !fs::exists(folder.previous_checkpoint())) {
      if (fs::exists(folder.file("input.toml")))
        require_same_input(asked, folder.file("input.toml"));
      const Voice voice(asked);
      const bool done = noted_status(folder.file("summary.json")) == "done";
      const std::string damage = done ? folder.damage() : "";
      if (!damage.empty()) voice.warn(fmt::format("{}: {}", asked.folder.string(), damage));
      if (done && damage.empty()) {
        tidy_finished(folder);
        voice.event({{"event", "end"}, {"status", "done"}, {"exit", 0}});
        voice.say(fmt::format("{} is complete: nothing to resume\n", asked.folder.string()));
        return io::ExitCode::done;
      }
      voice.say(fmt::format(
          "{}: {}, so the run begins anew\n", asked.folder.string(),
          done ? "its files are not as they were written" : "there is no checkpoint yet"));
      asked.resume = false;
    }
  }
  mpm::require_memory(asked.file.scene);
  Run run(asked);
  return run.go();
}

}  // namespace repose::study
