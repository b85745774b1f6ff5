#include "study/chart/fit_chart.hpp"

#include <fmt/core.h>

#include "study/fit/twin.hpp"

namespace repose::study {

FitTask twin_task() {
  const Twin twin = cam_clay_twin();
  calibration::Problem problem = twin_problem(twin, cam_clay_tests());
  const auto n = problem.parameters();
  return {"five parameters of Cam-Clay, three tests, no noise", problem,
          Eigen::VectorXd::LinSpaced(n, 0.3, 0.7), ""};
}

FitTask task_of(const input::FitFile& file) {
  calibration::Problem problem(calibration::ParameterSpace(file.free), file.targets, file.balance,
                               file.loss);
  const Eigen::VectorXd start = problem.space().start();
  return {file.name, std::move(problem), start, file.resolved};
}

double first_objective(const FitTask& task) {
  calibration::Evaluation at_start;
  task.problem.evaluate(task.start, false, at_start);
  return at_start.objective();
}

long trials(const calibration::TracePoint& p) { return p.evaluations + p.gradients; }

const calibration::TracePoint* first_below(const calibration::Optimum& optimum, double objective) {
  for (const calibration::TracePoint& p : optimum.trace)
    if (p.objective <= objective) return &p;
  return nullptr;
}

std::string trace_csv(const std::vector<AlgorithmRun>& runs) {
  std::string text = "algorithm,trials,gradients,time_s,objective\n";
  for (const AlgorithmRun& run : runs)
    for (const calibration::TracePoint& p : run.optimum.trace)
      text += fmt::format("{},{},{},{:.6g},{:.10g}\n", run.algorithm.name, trials(p), p.gradients,
                          p.seconds, p.objective);
  return text;
}

std::string table_csv(const std::vector<AlgorithmRun>& runs, double first) {
  std::string text = "algorithm,objective,trials,gradients,time_s,end";
  for (const double level : objective_levels)
    text += fmt::format(",trials_to_{0:.0e},time_to_{0:.0e}_s", level);
  text += "\n";
  for (const AlgorithmRun& run : runs) {
    const calibration::Optimum& o = run.optimum;
    text += fmt::format("{},{:.10g},{},{},{:.6g},\"{}\"", run.algorithm.name, o.objective,
                        o.evaluations + o.gradients, o.gradients, o.seconds, o.why);
    for (const double level : objective_levels) {
      const calibration::TracePoint* p = first_below(o, level * first);
      text += p == nullptr ? ",," : fmt::format(",{},{:.6g}", trials(*p), p->seconds);
    }
    text += "\n";
  }
  return text;
}

}  // namespace repose::study
