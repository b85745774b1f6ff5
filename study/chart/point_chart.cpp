#include "study/chart/point_chart.hpp"

#include <fmt/core.h>

namespace repose::study {

std::vector<ErrorMap> error_maps(int cells) {
  const std::vector<point::WorkPath> paths = point::work_paths();
  const LawInfo& law = find_law(paths.front().law);
  const std::vector<double> theta = checked_parameters(paths.front().law);
  const auto start = [](double q_over_p, double ocr) {
    // σ_a = p + 2q/3, σ_r = p − q/3 at p = 100 kPa
    InitialConditions given;
    const double p = 100e3, q = q_over_p * p;
    given.sigma = {{p - q / 3.0, p + 2.0 * q / 3.0, p - q / 3.0, 0.0, 0.0, 0.0}};
    if (ocr > 0.0) given.ocr = ocr;
    return given;
  };
  constexpr double reach = 0.02;
  return {
      {"at yield, q = 0", point::step_error_map(law, theta, start(0.0, 0.0), reach, cells)},
      {"at yield, q/p = M/2", point::step_error_map(law, theta, start(0.444, 0.0), reach, cells)},
      {"critical state", point::step_error_map(law, theta, start(0.888, 0.0), reach, cells)},
      {"OCR 1.5", point::step_error_map(law, theta, start(0.0, 1.5), reach, cells)}};
}

std::string work_csv(const std::vector<point::WorkPoint>& points) {
  std::string text =
      "path,method,tolerance,substeps,error,stress_error,state_error,wall_s,wall_lower_s,"
      "wall_upper_s,repeats,steps,rates,completed\n";
  for (const point::WorkPoint& p : points)
    text += fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{}\n", p.path,
                        point::name_of(p.method), p.tolerance, p.substeps, p.error(),
                        p.stress_error, p.state_error, p.seconds, p.lower, p.upper, p.repeats,
                        p.steps, p.rates, p.completed ? 1 : 0);
  return text;
}

std::string error_map_csv(const std::vector<ErrorMap>& maps) {
  std::string text = "start,eps_v,eps_q,error\n";
  for (const ErrorMap& map : maps)
    for (const point::StepError& c : map.cells)
      text += fmt::format("\"{}\",{},{},{}\n", map.name, c.eps_v, c.eps_q, c.error);
  return text;
}

std::string tangent_csv(const std::vector<point::TangentTest>& tests) {
  std::string text = "law,h,remainder\n";
  for (const point::TangentTest& test : tests)
    for (const point::TangentPoint& p : test.points)
      text += fmt::format("\"{}\",{:.6g},{:.6g}\n", test.name, p.h, p.remainder);
  return text;
}

}  // namespace repose::study
