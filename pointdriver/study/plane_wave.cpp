#include "pointdriver/study/plane_wave.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/scalar.hpp"
#include "models/sym.hpp"

namespace repose::point {
namespace {

/// Points that share a step: arrays as a Batch wants them.
class Points {
 public:
  Points(const Material& material, std::size_t count, const ShearFlow& flow)
      : material_(&material),
        count_(count) {
    InitialConditions given;
    if (flow.v)
      given.v = flow.v;
    else
      given.p = flow.p;
    const InitialPoint start = material.initial(given);
    for (std::size_t k = 0; k < 4; ++k) {
      strain_[k].assign(padded(count), 0.0);
      stress_[k].assign(padded(count), start.stress.c[k]);
      state_[k].assign(padded(count), k < start.state.size() ? start.state[k] : 0.0);
    }
    spin_.assign(padded(count), 0.0);
    density_.assign(padded(count), start.density);
  }

  /// L = ∇U + (a_x, a_y)⊗(k_x, k_y) for a time dt; padding follows the last point.
  void set_gradient(std::size_t i, double shear_rate, double ax, double ay, double kx, double ky,
                    double dt) {
    const double L_xx = ax * kx, L_xy = shear_rate + ax * ky, L_yx = ay * kx, L_yy = ay * ky;
    const std::size_t end = i + 1 == count_ ? padded(count_) : i + 1;
    for (std::size_t s = i; s < end; ++s) {
      strain_[0][s] = dt * L_xx;
      strain_[1][s] = dt * L_yy;
      strain_[3][s] = 0.5 * dt * (L_xy + L_yx);
      spin_[s] = 0.5 * dt * (L_yx - L_xy);
    }
  }

  void advance(double dt) {
    Batch batch;
    batch.count = count_;
    batch.dt = dt;
    for (std::size_t k = 0; k < 4; ++k) {
      batch.strain[k] = strain_[k].data();
      batch.stress[k] = stress_[k].data();
      batch.state[k] = state_[k].data();
    }
    batch.spin = {spin_.data()};
    batch.density = density_.data();
    if (!material_->update(batch).ok())
      throw InputError("law", "the law's update fails in plane shear");
  }

  double stress(std::size_t component, std::size_t i) const { return stress_[component][i]; }
  double density() const { return density_[0]; }
  /// ρc² of point 0 [Pa].
  double modulus() {
    Batch batch;
    batch.count = 1;
    for (std::size_t k = 0; k < 4; ++k) {
      batch.strain[k] = strain_[k].data();
      batch.stress[k] = stress_[k].data();
      batch.state[k] = state_[k].data();
    }
    batch.density = density_.data();
    std::array<double, pack_size> rho_c2{};
    material_->modulus(batch, rho_c2.data());
    return rho_c2[0];
  }
  /// All points take the stress of point 0.
  void copy_first() {
    for (auto* four : {&stress_, &state_})
      for (auto& column : *four) std::fill(column.begin(), column.end(), column.front());
  }

 private:
  const Material* material_;
  std::size_t count_;
  std::array<std::vector<double>, 4> strain_, stress_, state_;
  std::vector<double> spin_, density_;
};

/// Shears all points alike until point 0 is steady: one long step, which takes an implicit update
/// to the flow curve at once, then short steps until the stress has turned with the vorticity.
void flow_steadily(Points& points, std::size_t count, const ShearFlow& flow) {
  const double dt = 1e-4 / flow.shear_rate;
  const auto shear = [&](double step) {
    for (std::size_t i = 0; i < count; ++i)
      points.set_gradient(i, flow.shear_rate, 0.0, 0.0, 0.0, 0.0, step);
    points.advance(step);
  };
  shear(1.0 / flow.shear_rate);
  for (int n = 0; n < 200000; ++n) {
    const double before[3] = {points.stress(0, 0), points.stress(1, 0), points.stress(3, 0)};
    shear(dt);
    const double change = std::max({std::abs(points.stress(0, 0) - before[0]),
                                    std::abs(points.stress(1, 0) - before[1]),
                                    std::abs(points.stress(3, 0) - before[2])});
    if (change <= 1e-13 * flow.p) break;
  }
  points.copy_first();
}

struct Wave {
  double kx, ky, vx, vy;
};

/// ρ dû/dt = −δσ·k − ρ(û·∇)U over a step, δσ from point i to the undisturbed one.
void accelerate(Wave& w, const Points& points, std::size_t i, std::size_t undisturbed,
                const ShearFlow& flow, double rho, double dt) {
  const auto excess = [&](std::size_t c) {
    return points.stress(c, i) - points.stress(c, undisturbed);
  };
  const double s_xx = excess(0), s_yy = excess(1), s_xy = excess(3), vy = w.vy;
  w.vx -= dt * ((s_xx * w.kx + s_xy * w.ky) / rho + flow.shear_rate * vy);
  w.vy -= dt * (s_xy * w.kx + s_yy * w.ky) / rho;
}

void strain(Points& points, std::size_t i, const Wave& w, const ShearFlow& flow, double dt) {
  points.set_gradient(i, flow.shear_rate, w.vx, w.vy, w.kx, w.ky, dt);
}

/// ρ and K = ρ dp/dρ at p.
std::array<double, 2> density_and_bulk_modulus(const Material& material, double p) {
  const double rho = material.density_at(p, 1.0);
  const double step = 1e-3 * p;
  return {rho, rho * 2.0 * step /
                   (material.density_at(p + step, 1.0) - material.density_at(p - step, 1.0))};
}

/// Leapfrog: ω Δt < 2 for waves, and for a law that is viscous at once 4/3 ηk²/ρ Δt < 2.
double step_of(Points& points, const Material& material, const ShearFlow& flow, double k) {
  double signal = k * std::sqrt(points.modulus() / material.density_at(flow.p, 1.0));
  if (!material.law().has_stress_memory)
    signal = std::max(signal, 4.0 * viscous_rate(material, flow, k));
  return 0.3 / signal;
}

}  // namespace

double flow_viscosity(const Material& material, const ShearFlow& flow) {
  Points points(material, 1, flow);
  points.set_gradient(0, flow.shear_rate, 0.0, 0.0, 0.0, 0.0, 1.0 / flow.shear_rate);
  points.advance(1.0 / flow.shear_rate);
  return std::hypot(points.stress(3, 0), 0.5 * (points.stress(0, 0) - points.stress(1, 0))) /
         flow.shear_rate;
}

double viscous_rate(const Material& material, const ShearFlow& flow, double wave_number) {
  return flow_viscosity(material, flow) * wave_number * wave_number /
         material.density_at(flow.p, 1.0);
}

double wave_number_of_share(const Material& material, const ShearFlow& flow, double share) {
  const auto [rho, K] = density_and_bulk_modulus(material, flow.p);
  return share * std::sqrt(rho * K) / flow_viscosity(material, flow);
}

std::vector<WaveGrowth> wave_growth(const Material& material, const ShearFlow& flow,
                                    double wave_number, std::size_t directions) {
  const std::size_t n = directions;
  Points points(material, n + 1, flow);  // the last one is undisturbed
  const double k = wave_number;
  const auto [rho, K] = density_and_bulk_modulus(material, flow.p);
  const double viscous = viscous_rate(material, flow, k);
  const double share = viscous / (k * std::sqrt(K / rho));
  flow_steadily(points, n + 1, flow);
  const double dt = step_of(points, material, flow, k);  // the flow may be stiffer than its start
  const double end = 20.0 * (1.0 + share * share) / viscous;

  struct Noise {
    Wave wave;
    std::vector<double> log_size;  ///< ln|û|, at the moments of `times`
    bool over = false;
  };
  const double start = 1e-5 * flow.shear_rate / k;
  std::vector<Noise> waves(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    // across k, where all modes of slow growth are, and a little along it
    waves[i].wave = {k * std::cos(angle), k * std::sin(angle),
                     start * (0.3 * std::cos(angle) - std::sin(angle)),
                     start * (0.3 * std::sin(angle) + std::cos(angle))};
  }
  const long steps = std::lround(std::ceil(end / dt));
  const long stride = std::max(1L, steps / 400);
  for (long step = 0; step < steps; ++step) {
    std::size_t running = 0;
    for (std::size_t i = 0; i < n; ++i) {
      Noise& w = waves[i];
      if (!w.over) {
        accelerate(w.wave, points, i, n, flow, rho, dt);
        ++running;
      } else {
        w.wave.vx = w.wave.vy = 0.0;
      }
      strain(points, i, w.wave, flow, dt);
      if (w.over || step % stride != 0) continue;
      w.log_size.push_back(std::log(std::hypot(w.wave.vx, w.wave.vy)));
      w.over = std::abs(w.log_size.back() - w.log_size.front()) > std::log(100.0);
    }
    if (running == 0) break;
    points.set_gradient(n, flow.shear_rate, 0.0, 0.0, 0.0, 0.0, dt);
    points.advance(dt);
  }
  std::vector<WaveGrowth> result;
  for (std::size_t i = 0; i < n; ++i) {
    // a line through the second half, so that what still oscillates does not decide
    const std::vector<double>& y = waves[i].log_size;
    const std::size_t from = y.size() / 2, m = y.size() - from;
    double mean_t = 0.0, mean_y = 0.0, cross = 0.0, square = 0.0;
    for (std::size_t s = from; s < y.size(); ++s) {
      mean_t += static_cast<double>(s) / static_cast<double>(m);
      mean_y += y[s] / static_cast<double>(m);
    }
    for (std::size_t s = from; s < y.size(); ++s) {
      const double t = static_cast<double>(s) - mean_t;
      cross += t * (y[s] - mean_y);
      square += t * t;
    }
    result.push_back({std::numbers::pi * static_cast<double>(i) / static_cast<double>(n),
                      cross / (square * dt * static_cast<double>(stride))});
  }
  return result;
}

std::vector<double> follow_wave(const Material& material, const ShearFlow& flow,
                                const std::function<std::array<double, 2>(double t)>& wave_vector,
                                double interval, std::size_t samples) {
  Points points(material, 2, flow);
  const double rho = material.density_at(flow.p, 1.0);
  const auto [kx, ky] = wave_vector(0.0);
  const double k = std::hypot(kx, ky), start = 1e-5 * flow.shear_rate / k;
  flow_steadily(points, 2, flow);
  const double most = step_of(points, material, flow, k);
  Wave wave{kx, ky, start * ky / k, -start * kx / k};
  std::vector<double> log_size{0.0};
  const long steps = std::lround(std::ceil(interval / most));
  const double dt = interval / static_cast<double>(steps);
  for (std::size_t sample = 1; sample < samples; ++sample) {
    for (long step = 0; step < steps; ++step) {
      const double t =
          interval * static_cast<double>(sample - 1) + dt * (static_cast<double>(step) + 0.5);
      const auto now = wave_vector(t);
      wave.kx = now[0];
      wave.ky = now[1];
      accelerate(wave, points, 0, 1, flow, rho, dt);
      strain(points, 0, wave, flow, dt);
      points.set_gradient(1, flow.shear_rate, 0.0, 0.0, 0.0, 0.0, dt);
      points.advance(dt);
    }
    log_size.push_back(std::log(std::hypot(wave.vx, wave.vy) / start));
  }
  return log_size;
}

WaveGrowth fastest(const std::vector<WaveGrowth>& waves) {
  return *std::max_element(
      waves.begin(), waves.end(),
      [](const WaveGrowth& a, const WaveGrowth& b) { return a.rate < b.rate; });
}

}  // namespace repose::point
