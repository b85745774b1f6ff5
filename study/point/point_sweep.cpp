#include "study/point/point_sweep.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "io/fingerprint.hpp"
#include "io/interrupt.hpp"
#include "io/number_text.hpp"
#include "study/point/laboratory_record.hpp"
#include "study/run/finished_result.hpp"

namespace repose::study {
namespace {

using io::Json;

constexpr const char* log_name = "finished.jsonl";
constexpr std::size_t tests_at_once = 64;  ///< are driven side by side before they are written

/// A finished test, and its rows of curves.csv.
struct Driven {
  PointFigures figures;
  std::string rows;
};

/// What curves.csv has after the number of the run: any quantity, and the stage and the cycle, that
/// one of the tests has.
struct CurveColumns {
  std::vector<point::Quantity> quantities;
  StageColumns places;

  explicit CurveColumns(const std::vector<PointCase>& cases) {
    std::array<bool, point::quantity_count> used{};
    for (const PointCase& one : cases) {
      if (!one.test) continue;
      for (const point::Quantity q : point::columns_of(find_law(one.test->law), one.test->test))
        used[static_cast<std::size_t>(q)] = true;
      const StageColumns own = stage_columns(one.test->test.path);
      places = {places.stage || own.stage, places.cycle || own.cycle};
    }
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i]) quantities.push_back(static_cast<point::Quantity>(i));
  }
  std::vector<std::string> names() const {
    std::vector<std::string> list{"run"};
    for (const point::Quantity q : quantities) list.emplace_back(point::column_name(q));
    if (places.stage) list.emplace_back("stage");
    if (places.cycle) list.emplace_back("cycle");
    return list;
  }
};

Driven driven(const PointCase& one, std::size_t run, const CurveColumns& wanted) {
  Driven out;
  if (!one.test) {
    out.figures = {"refused", one.refusal, 0, 0.0, Json::object(), {}};
    return out;
  }
  const TestResult result = drive(*one.test);
  const std::size_t rows = result.curve.rows.size();
  out.figures = {
      result.failed() ? "failed" : "done", result.reason, rows, result.wall_s, Json::object(), {}};
  const std::vector<std::vector<double>> columns = columns_of(*one.test, result, wanted.quantities);
  const std::vector<point::Path::Place> places = one.test->test.path.places();
  const std::size_t width = wanted.names().size();
  std::vector<double> values;
  values.reserve(rows * width);
  for (std::size_t row = 0; row < rows; ++row) {
    values.push_back(static_cast<double>(run));
    for (const std::vector<double>& column : columns) values.push_back(column[row] + 0.0);
    const auto [stage, cycle] = places[static_cast<std::size_t>(result.curve.rows[row].leg)];
    if (wanted.places.stage) values.push_back(stage);
    if (wanted.places.cycle) values.push_back(cycle);
  }
  out.rows = io::RowWriter::text_of(values, width);
  if (rows == 0) return out;
  Json& figures = out.figures.figures;
  figures["fraction"] = result.curve.outcome.fraction;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (std::isfinite(columns[i].back()))
      figures[fmt::format("end_{}", point::column_name(wanted.quantities[i]))] = columns[i].back();
  const Json laboratory = laboratory_json(result.figures);
  for (const Json::Member& member : laboratory.items())
    if (!member.value.is_array()) figures[member.key] = member.value;
  return out;
}

}  // namespace

/// The log's complete lines, in the order of the runs; what is behind a broken one is not kept.
PointSweep::PointSweep(const input::InputFile& file, const input::ParameterSets& sets,
                       std::string_view table)
    : keys_(sets.keys),
      cases_(cases_of<PointCase>(file, sets, table,
                                 [](PointCase& one, input::InputFile& run, std::size_t) {
                                   one.test = input::read_point_test(run);
                                 })) {}

void PointSweep::take_up(const io::ResultFolder& folder, bool with_curves) {
  std::ifstream log(folder.file(log_name));
  const std::string curves = text_of(folder.file("curves.csv"));
  std::size_t at = std::min(curves.size(), curves.find('\n')) + 1;  // behind the header
  /// The next rows of curves.csv if they are those that were written.
  const auto are_there = [&](std::size_t rows, const std::string& checksum) {
    const std::size_t begin = at;
    for (; rows > 0 && at <= curves.size(); --rows) {
      const std::size_t end = curves.find('\n', at);
      if (end == std::string::npos) return false;
      at = end + 1;
    }
    return begin <= curves.size() &&
           checksum == io::fingerprint_of(std::string_view(curves).substr(begin, at - begin));
  };
  for (std::string line; finished_.size() < cases_.size() && std::getline(log, line);) {
    const std::optional<Json> entry = Json::try_parse(line);
    if (!entry || !entry->contains("figures") ||
        entry->value("run", std::size_t{0}) != finished_.size() + 1)
      break;
    PointFigures figures{entry->value("status", ""),
                         entry->value("reason", ""),
                         entry->value("rows", std::size_t{0}),
                         entry->value("wall_s", 0.0),
                         entry->at("figures"),
                         entry->value("checksum", "")};
    if (with_curves ? !are_there(figures.rows, figures.checksum)
                    : figures.checksum != io::fingerprint_of(figures.figures.dump()))
      break;
    finished_.push_back(std::move(figures));
  }
  kept_ = finished_.size();
}

io::ExitCode PointSweep::run(const io::ResultFolder& folder, int threads, bool resume,
                             bool with_curves) {
  if (resume) take_up(folder, with_curves);
  const CurveColumns columns(cases_);
  const std::vector<std::string> names = columns.names();
  const std::filesystem::path file = folder.file("curves.csv");
  std::optional<io::RowWriter> curves;
  if (with_curves && kept_ > 0)
    curves.emplace(io::RowWriter::continued(file, names, static_cast<double>(kept_)));
  else if (with_curves)
    curves.emplace(io::RowWriter::create(file, names));
  std::string log;
  for (std::size_t k = 0; k < kept_; ++k) log += log_line(k);
  folder.write_file(log_name, log, io::Outlives::kill);
  std::ofstream more(folder.file(log_name), std::ios::app | std::ios::binary);
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  const io::InterruptGuard interrupt;
  while (finished_.size() < cases_.size()) {
    if (interrupt.requested()) return io::ExitCode::interrupted;
    const std::size_t first = finished_.size();
    std::vector<Driven> block(std::min(tests_at_once, cases_.size() - first));
    arena.execute([&] {
      tbb::parallel_for(std::size_t{0}, block.size(), [&](std::size_t i) {
        block[i] = driven(cases_[first + i], first + i + 1, columns);
      });
    });
    for (Driven& one : block) {
      if (curves) curves->rows(one.rows);
      one.figures.checksum = io::fingerprint_of(curves ? one.rows : one.figures.figures.dump());
      finished_.push_back(std::move(one.figures));
      more << log_line(finished_.size() - 1);
    }
    if (!more.flush()) throw io::IoError(folder.file(log_name), "cannot write", errno);
  }
  return io::ExitCode::done;
}

std::string PointSweep::log_line(std::size_t run) const {
  const PointFigures& one = finished_[run];
  return Json{{"run", run + 1},          {"status", one.status}, {"reason", one.reason},
              {"rows", one.rows},        {"wall_s", one.wall_s}, {"figures", one.figures},
              {"checksum", one.checksum}}
             .dump() +
         "\n";
}

std::string PointSweep::table() const {
  std::vector<std::string> names;
  for (const PointFigures& one : finished_)
    for (const Json::Member& member : one.figures.items())
      if (std::find(names.begin(), names.end(), member.key) == names.end())
        names.push_back(member.key);
  std::string text = "run";
  for (const std::string& key : keys_) text += "," + io::csv_cell(key);
  text += ",status,rows";
  for (const std::string& name : names) text += "," + name;
  text += ",reason\n";
  for (std::size_t run = 0; run < finished_.size(); ++run) {
    const PointFigures& one = finished_[run];
    text += fmt::format("{}", run + 1);
    for (const std::string& value : cases_[run].values) text += "," + io::csv_cell(value);
    text += fmt::format(",{},{}", one.status, one.rows);
    for (const std::string& name : names) {
      text += ",";
      const Json* figure = one.figures.find(name);
      if (figure == nullptr) continue;
      text += figure->is_string() ? io::csv_cell(figure->get<std::string>())
                                  : fmt::format("{}", figure->get<double>());
    }
    text += "," + io::csv_cell(one.reason) + "\n";
  }
  return text;
}

std::size_t PointSweep::count(std::string_view status) const {
  return static_cast<std::size_t>(
      std::count_if(finished_.begin(), finished_.end(),
                    [&](const PointFigures& one) { return one.status == status; }));
}

SweepCounts PointSweep::counts() const {
  SweepCounts counts;
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    const bool ended = k < finished_.size();
    counts.add(fmt::format("run {}", k + 1), ended ? finished_[k].status : "",
               ended ? finished_[k].reason : "");
  }
  return counts;
}

double PointSweep::driving_s() const {
  double sum = 0.0;
  for (const PointFigures& one : finished_) sum += one.wall_s;
  return sum;
}

}  // namespace repose::study
