#include "mpm/study/shear_cell.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "mpm/step/simulation.hpp"
#include "mpm/study/noise.hpp"

namespace repose::mpm {
namespace {

double height(const ShearCell& cell) { return cell.height * cell.wavelength; }
double cell_size(const ShearCell& cell) { return cell.wavelength / cell.cells; }

Scene scene_of(const ShearCell& cell) {
  Scene scene;
  scene.name = "shear_cell";
  scene.gravity = 0.0;
  scene.end_time = 1e9;
  scene.h = cell_size(cell);
  scene.domain = {cell.slope * cell.wavelength, height(cell)};
  scene.left = scene.right = {Wall::Kind::periodic};
  // the middle is at rest, so that the step is that of the waves
  const double speed = 0.5 * cell.shear_rate * height(cell);
  scene.floor = {Wall::Kind::no_slip, 0.0, -speed};
  scene.top = {Wall::Kind::no_slip, 0.0, speed};
  scene.kernel = cell.kernel;
  scene.transfer = cell.transfer;
  if (cell.transfer == Transfer::relaxed) scene.relaxation_time = cell.relaxation_time;
  scene.points_per_cell = cell.points_per_cell;
  scene.courant = cell.courant;
  Body body;
  body.law = cell.law;
  body.size = {scene.domain[0], scene.domain[1]};
  body.initial.p = cell.p;
  scene.bodies = {body};
  return scene;
}

PointMotion noise_at(const ShearCell& cell, double x, double y) {
  const double h = cell_size(cell), a = cell.size * cell.shear_rate * h;
  return {{cell.shear_rate * (y - 0.5 * height(cell)) + a * scatter(x / h, y / h, 0.0),
           a * scatter(x / h, y / h, 1.0)},
          {0.0, cell.shear_rate, 0.0, 0.0}};
}

/// U and the packet ψ = A b(Y) sin(k·x), v = U + (∂ψ/∂y, −∂ψ/∂x), b = e^{−Y²/2s²}, Y from the
/// middle.
PointMotion packet_at(const ShearCell& cell, double x, double y) {
  const std::array<double, 2> k = wave_vector(cell, 0.0);
  const double s2 = cell.wavelength * cell.wavelength, Y = y - 0.5 * height(cell);
  const double A = cell.size * cell.shear_rate / (k[0] * k[0] + k[1] * k[1]);
  const double phase = k[0] * x + k[1] * Y;
  const double sine = A * std::sin(phase), cosine = A * std::cos(phase);
  const double b = std::exp(-0.5 * Y * Y / s2);
  const double b_y = -Y / s2 * b, b_yy = (Y * Y / s2 - 1.0) / s2 * b;
  const double psi_x = k[0] * b * cosine, psi_y = b_y * sine + k[1] * b * cosine;
  const double psi_xx = -k[0] * k[0] * b * sine;
  const double psi_xy = k[0] * (b_y * cosine - k[1] * b * sine);
  const double psi_yy = b_yy * sine + 2.0 * k[1] * b_y * cosine - k[1] * k[1] * b * sine;
  return {{cell.shear_rate * Y + psi_y, -psi_x},
          {psi_xy, cell.shear_rate + psi_yy, -psi_xx, -psi_xy}};
}

/// Of the wave at time t, or of noise.
double size_of(const ShearCell& cell, const Simulation::Snapshot& points, double t) {
  const std::array<double, 2> k = wave_vector(cell, t);
  std::array<std::complex<double>, 2> wave{};
  double square = 0.0;
  for (std::size_t i = 0; i < points.x_m.size(); ++i) {
    const double Y = points.y_m[i] - 0.5 * height(cell);
    const std::array<double, 2> v{points.vx[i] - cell.shear_rate * Y, points.vy[i]};
    const auto turned = std::polar(points.mass[i], -(k[0] * points.x_m[i] + k[1] * Y));
    for (std::size_t c = 0; c < 2; ++c) {
      wave[c] += v[c] * turned;
      square += points.mass[i] * v[c] * v[c];
    }
  }
  return std::sqrt(cell.noise ? square : std::norm(wave[0]) + std::norm(wave[1]));
}

}  // namespace

std::array<double, 2> wave_vector(const ShearCell& cell, double t) {
  const double k_y = 2.0 * std::numbers::pi / cell.wavelength, k_x = k_y / cell.slope;
  return {k_x, k_y - cell.shear_rate * t * k_x};
}

Growth follow_growth(const ShearCell& cell, double end, double most, std::size_t samples) {
  Prescribed prescribed;
  prescribed.start = [&](double x, double y) {
    return cell.noise ? noise_at(cell, x, y) : packet_at(cell, x, y);
  };
  Simulation simulation(scene_of(cell), prescribed, 1);
  Simulation::Snapshot points = simulation.snapshot();
  const double start = size_of(cell, points, 0.0);
  Growth growth;
  growth.time = growth.log_size = {0.0};
  for (std::size_t n = 1; n <= samples && std::abs(growth.log_size.back()) < most; ++n) {
    const double stop = end * static_cast<double>(n) / static_cast<double>(samples);
    while (simulation.time() < stop) simulation.step(stop);
    points = simulation.snapshot();
    growth.time.push_back(stop);
    growth.log_size.push_back(std::log(size_of(cell, points, stop) / start));
  }
  growth.dt = simulation.time() / static_cast<double>(simulation.steps());
  for (const double p : points.pressure_Pa)
    growth.pressure_error = std::max(growth.pressure_error, std::abs(p / cell.p - 1.0));
  return growth;
}

double late_rate(std::span<const double> time, std::span<const double> log_size) {
  const std::size_t from = time.size() / 2;
  const double count = static_cast<double>(time.size() - from);
  double t = 0.0, y = 0.0, cross = 0.0, square = 0.0;
  for (std::size_t i = from; i < time.size(); ++i) {
    t += time[i] / count;
    y += log_size[i] / count;
  }
  for (std::size_t i = from; i < time.size(); ++i) {
    cross += (time[i] - t) * (log_size[i] - y);
    square += (time[i] - t) * (time[i] - t);
  }
  return cross / square;
}

SeenWave seen_wave(Kernel kernel, double h, const std::array<double, 2>& k) {
  // a spline of n factors: w̃ = Π sinc(kᵢh/2)ⁿ, D = nh²/12
  const int n = kernel == Kernel::cubic ? 4 : 3;
  const double D = n * h * h / 12.0;
  std::array<double, 2> w{}, slope{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double z = 0.5 * k[i] * h;
    const double sinc = z == 0.0 ? 1.0 : std::sin(z) / z;
    w[i] = std::pow(sinc, n);
    slope[i] = z == 0.0 ? 0.0 : 0.5 * h * n * std::pow(sinc, n - 1) * (std::cos(z) - sinc) / z;
  }
  const std::array<double, 2> gradient{slope[0] * w[1], w[0] * slope[1]};
  const double share =
      std::pow(w[0] * w[1], 2) + (gradient[0] * gradient[0] + gradient[1] * gradient[1]) / D;
  SeenWave seen;
  for (std::size_t i = 0; i < 2; ++i) seen.k[i] = -std::sqrt(share) * gradient[i] / D;
  seen.loss = 1.0 - share;
  return seen;
}

}  // namespace repose::mpm
