// What a program sees of the library, as bits: compiled several ways by any_flags.sh. Nothing is
// computed here, so that all numbers are the library's.
#include <cstdio>

#include <repose/calibration/fit.hpp>
#include <repose/models/ill_posedness.hpp>
#include <repose/models/registry.hpp>
#include <repose/mpm/output/rest_pressure.hpp>
#include <repose/mpm/step/simulation.hpp>
#include <repose/pointdriver/integrate/gradient.hpp>
#include <repose/pointdriver/integrate/simulate.hpp>

using namespace repose;

namespace {

template <class T>
void layout(const char* name) {
  std::printf("%s %zu %zu\n", name, sizeof(T), alignof(T));
}

void show(const char* name, double x) { std::printf("%s %a\n", name, x); }

void layouts() {
  std::printf("pack_size %zu\n", pack_size);
#define LAYOUT(type) layout<type>(#type)
  LAYOUT(Batch);
  LAYOUT(SpatialBatch);
  LAYOUT(LawInfo);
  LAYOUT(LawSpec);
  LAYOUT(LawList);
  LAYOUT(OutsideLaw);
  LAYOUT(InitialConditions);
  LAYOUT(InitialPoint);
  LAYOUT(Material);
  LAYOUT(ShearResponse);
  LAYOUT(point::PointTest);
  LAYOUT(point::Path);
  LAYOUT(point::Leg);
  LAYOUT(point::Stage);
  LAYOUT(point::Curve);
  LAYOUT(point::Row<double>);
  LAYOUT(point::Outcome);
  LAYOUT(point::Settings);
  LAYOUT(point::GradientColumn);
  LAYOUT(calibration::Experiment);
  LAYOUT(calibration::FreeParameter);
  LAYOUT(calibration::FitSettings);
  LAYOUT(calibration::FitResult);
  LAYOUT(calibration::FittedValue);
  LAYOUT(mpm::Scene);
  LAYOUT(mpm::Body);
  LAYOUT(mpm::Prescribed);
  LAYOUT(mpm::Simulation);
  LAYOUT(mpm::SeriesRow);
  LAYOUT(mpm::Simulation::Snapshot);
  LAYOUT(mpm::Simulation::Counters);
  LAYOUT(mpm::RestPressure);
#undef LAYOUT
}

LawSpec clay() {
  return {"modified_cam_clay",
          {{"compression", "v-ln_p"}},
          {{"M", 0.95}, {"lambda", 0.093}, {"kappa", 0.035}, {"nu", 0.3}, {"Gamma", 2.06}}};
}

LawSpec grains() {
  return {"mu_i",
          {},
          {{"mu_0", 0.3819},
           {"mu_d", 0.5718},
           {"I_0", 0.279},
           {"d", 0.0053},
           {"rho_p", 2000.0},
           {"rho_0", 1300.0},
           {"K", 254800.0}}};
}

/// 21 points that all differ, in arrays with room for padded(21) of them.
void batch(const LawSpec& spec) {
  const auto material = make_material(spec);
  InitialConditions given;
  given.p = 1e5;
  const InitialPoint start = material->initial(given);
  constexpr std::size_t count = 21, room = padded(count);
  std::vector<std::vector<double>> arrays(16, std::vector<double>(room));
  Batch b;
  b.count = count;
  b.dt = 0.5;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < room; ++i) {
      arrays[k][i] = static_cast<double>(static_cast<int>(i % count) - static_cast<int>(4 * k));
      arrays[k][i] /= 16384.0;  // exact
      arrays[4 + k][i] = start.stress.c[k];
      arrays[8 + k][i] = k < start.state.size() ? start.state[k] : 0.0;
    }
    b.strain[k] = arrays[k].data();
    b.stress[k] = arrays[4 + k].data();
    b.state[k] = arrays[8 + k].data();
  }
  arrays[12].assign(room, start.density);
  arrays[13].assign(room, 0.0);
  b.density = arrays[12].data();
  b.modulus = arrays[13].data();
  std::printf("update %d\n", material->update(b).ok() ? 1 : 0);
  for (std::size_t i = 0; i < count; ++i) {
    show("stress", arrays[4][i]);
    show("modulus", arrays[13][i]);
  }
}

void drive() {
  const LawSpec spec = clay();
  point::Stage shear;
  shear.condition = point::Condition::drained;
  shear.goal = point::Goal{point::Quantity::eps_a, 0.125};
  shear.points = 8;
  point::PointTest test;
  test.path = point::path_of({shear});
  test.initial.p = 2e5;
  test.initial.ocr = 1.5;
  const std::vector<double> theta = checked_parameters(spec);
  point::Curve curve;
  for (const point::Method m :
       {point::Method::adaptive, point::Method::implicit, point::Method::cvode}) {
    test.settings.method = m;
    point::simulate(find_law(spec), theta, test, curve);
    for (const auto& row : curve.rows) {
      show("sigma_a", row.stress.c[1]);
      show("dissipated", row.dissipated);
    }
  }
  test.settings.method = point::Method::adaptive;
  std::vector<point::GradientColumn> columns;
  const std::vector<int> which{0, 1, 2, 3, 4};
  const std::vector<point::Quantity> wanted{point::Quantity::q, point::Quantity::eps_v};
  point::simulate_columns_with_gradient(find_law(spec), theta, which, test, wanted, columns);
  for (const point::GradientColumn& column : columns)
    for (const double x : column.derivatives) show("derivative", x);

  calibration::Experiment experiment;
  experiment.name = "drained";
  experiment.test = test;
  for (const auto& row : curve.rows)
    if (row.time > 0.0) experiment.abscissae.push_back(-row.strain.c[1]);
  point::simulate(find_law(spec), theta, test, curve);
  std::vector<double> q;
  point::read_column(find_law(spec), theta, test, curve, point::Quantity::q, q);
  q.erase(q.begin());
  experiment.measured = {{point::Quantity::q, q, 1e3}};
  LawSpec open = spec;
  open.values.erase("M");
  std::vector<calibration::FreeParameter> free(1);
  free[0].name = "M";
  free[0].lower = 0.5;
  free[0].upper = 1.5;
  const calibration::FitResult found = calibration::fit(open, free, {experiment}, {.starts = 3});
  show("M", found.values[0].value);
  show("standard error", found.values[0].standard_error);
}

void collapse() {
  mpm::Scene scene;
  scene.domain = {0.5, 0.25, 0.0};
  scene.floor.kind = mpm::Wall::Kind::friction;
  scene.floor.friction = 0.5;
  scene.h = 0.0125;
  mpm::Body body;
  body.name = "heap";
  body.size = {0.1, 0.1, 0.0};
  body.law = grains();
  scene.bodies = {body};
  mpm::Simulation simulation(scene, 2);
  while (simulation.time() < 0.0625) simulation.step(0.0625);
  const mpm::SeriesRow row = simulation.diagnostics();
  show("front", row.front_99_m);
  show("kinetic", row.kinetic_J_per_m);
  show("residual", row.energy_residual_J_per_m);
  const auto snapshot = simulation.snapshot();
  for (std::size_t i = 0; i < snapshot.x_m.size(); i += 16) {
    show("x", snapshot.x_m[i]);
    show("mises", snapshot.mises_Pa[i]);
  }
}

}  // namespace

void NUMBERS();
void NUMBERS() {
  layouts();
  for (const LawInfo& law : all_laws())
    std::printf("%s %s\n", std::string(law.name).c_str(), std::string(law.option).c_str());
  batch(clay());
  batch(grains());
  drive();
  collapse();
  const auto response = shear_response(*make_material(grains()), 1e3, 2.0);
  show("chi", response.value().chi);
}

#ifdef MAIN
int main() { NUMBERS(); }
#endif
