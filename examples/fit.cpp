// A fit: the friction and the compressibility of a clay from a drained triaxial test. The
// "measured" values are made here, by the law itself and a little noise, so that the answer is
// known.
#include <cmath>
#include <cstdio>

#include <repose/calibration/fit.hpp>

using namespace repose;

int main() {
  // What is known beforehand. M and lambda are free, and so not among the parameters of the law.
  LawSpec clay{"modified_cam_clay",
               {{"compression", "v-ln_p"}},
               {{"kappa", 0.035}, {"nu", 0.3}, {"Gamma", 2.060}, {"p_ref", 1e3}}};
  const double true_M = 0.95, true_lambda = 0.093;

  // The experiment: the test as it was made, x of every row, and what was measured there. The path
  // is driven exactly to each x; nothing is interpolated.
  point::Stage shear;
  shear.condition = point::Condition::drained;
  shear.goal = point::Goal{point::Quantity::eps_a, 0.20};
  calibration::Experiment test;
  test.name = "drained";
  test.test.path = point::path_of({shear});
  test.test.initial.p = 200e3;
  test.test.initial.ocr = 1.0;
  for (int i = 1; i <= 20; ++i) test.abscissae.push_back(0.01 * i);

  // Instead of a laboratory: the law with its true parameters, and its q with noise of 1 kPa.
  LawSpec truth = clay;
  truth.values.insert({{"M", true_M}, {"lambda", true_lambda}});
  const std::vector<double> theta = checked_parameters(truth);
  shear.points = 20;
  point::PointTest twin = test.test;
  twin.path = point::path_of({shear});
  point::Curve curve;
  point::simulate(find_law(truth), theta, twin, curve);
  std::vector<double> q;
  point::read_column(find_law(truth), theta, twin, curve, point::Quantity::q, q);
  q.erase(q.begin());  // the start itself
  for (std::size_t i = 0; i < q.size(); ++i) q[i] += 1.4e3 * std::sin(17.0 * double(i * i));
  test.measured = {{point::Quantity::q, q, 1e3}};

  // Free parameters have bounds; "of" would make one a ratio to another (kappa < lambda for sure).
  std::vector<calibration::FreeParameter> free(2);
  free[0] = {"M", "-", 0.5, 1.5};
  free[1] = {"lambda", "-", 0.05, 0.4, Scale::log};
  const calibration::FitResult found = calibration::fit(clay, free, {test}, {.starts = 4});

  for (const calibration::FittedValue& v : found.values)
    std::printf("%-6s = %.4f +- %.4f (95 %%: %.4f to %.4f)\n", v.name.c_str(), v.value,
                v.standard_error, v.interval[0], v.interval[1]);
  std::printf("q is met within %.2f %% of its range\n", 100.0 * found.scores[0].relative_rms);
  const auto met = [&](std::size_t i, double truth_of) {
    return std::abs(found.values[i].value - truth_of) < 4.0 * found.values[i].standard_error;
  };
  return met(0, true_M) && met(1, true_lambda) ? 0 : 1;
}
