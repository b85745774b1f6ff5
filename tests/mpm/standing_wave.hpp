#pragma once
/// \file
/// The standing wave of an elastic bar between slip walls, u = A sin(πx/L) sin ωt, in uniaxial
/// strain: ω = πc/L, c² = (λ + 2μ)/ρ_0 for amplitudes so small that the law is linear. And what a
/// transfer makes of it: on a regular lattice a mode of wave number k stays one, so that the whole
/// method is a map of three numbers from step to step.
///
/// With W the spline of degree p (3 or 2) and variance σ²h² = (p + 1)h²/12, passing a mode between
/// points and nodes multiplies it by its transform Ŵ = (sin(kh/2)/(kh/2))^(p+1), and taking its
/// gradient by moving least squares by ik S, S = −Ŵ′(kh)/(σ²kh), with the spline's gradient by ik
/// Ŵ; force is the adjoint of gradient, and the affine field gives the nodes (kh)²σ² S of itself.
/// Points at ±h/4 in their cells also see the wave numbers k + 4πm/h, with the sign (−1)^m. Not in
/// the map: k ± 2π/h, which makes neighbours in a cell differ and acts by its square (pattern()).

#include <cmath>

#include "tests/mpm/manufactured_block.hpp"

namespace repose::mpm {

struct StandingWave {
  double L = 1.0, E = 1e7, nu = 0.3, rho_0 = 1000.0;
  /// Largest strain. The wave steepens by strain × ωt, which changes its main mode by the square of
  /// that: 1e-7 after five periods.
  double strain = 1e-5;

  static constexpr double pi = std::numbers::pi;
  double k() const { return pi / L; }
  double wave_speed() const {
    return std::sqrt(E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / rho_0);
  }
  double omega() const { return k() * wave_speed(); }
  double period() const { return 2.0 * pi / omega(); }

  /// n cells over the bar's length, steps of Courant number C.
  Scene scene(int n, Kernel kernel, Transfer transfer, double C) const {
    const double h = L / n;
    Scene s = empty_box(L, 4.0 * h, h);
    s.bodies = {block(0.0, 0.0, L, 4.0 * h, neo_hookean(E, nu, rho_0))};
    s.kernel = kernel;
    s.transfer = transfer;
    s.dt = C * h / wave_speed();
    return s;
  }

  /// What a history of the mode's displacement says: ω, and the share of its amplitude that it
  /// loses in a period, as a logarithm. NaN if it does not swing.
  struct Swing {
    double omega, decrement;
  };
  class History {
   public:
    void add(double t, double q) {
      t_.push_back(t);
      q_.push_back(q);
    }
    /// ω from the first zero to the last, amplitudes from the parabolas through the extremes.
    Swing swing() const {
      std::vector<double> zeros, extremes;
      for (std::size_t i = 2; i < q_.size(); ++i) {
        if (q_[i - 1] * q_[i] < 0.0)
          zeros.push_back(t_[i - 1] + (t_[i] - t_[i - 1]) * q_[i - 1] / (q_[i - 1] - q_[i]));
        const double a = std::abs(q_[i - 2]), b = std::abs(q_[i - 1]), c = std::abs(q_[i]);
        if (b >= a && b > c) extremes.push_back(b + (c - a) * (c - a) / (8.0 * (2.0 * b - a - c)));
      }
      if (zeros.size() < 2 || extremes.size() < 2) return {std::nan(""), std::nan("")};
      const auto halves = [](const auto& list) { return static_cast<double>(list.size() - 1); };
      return {pi * halves(zeros) / (zeros.back() - zeros.front()),
              2.0 * std::log(extremes.front() / extremes.back()) / halves(extremes)};
    }

   private:
    std::vector<double> t_, q_;
  };

  Swing run(const Scene& s, double periods, int threads = 1) const {
    Prescribed start;
    start.start = [*this](double X, double) {
      const double v = strain * wave_speed();
      return PointMotion{{v * std::sin(k() * X), 0.0},
                         {v * k() * std::cos(k() * X), 0.0, 0.0, 0.0}};
    };
    Simulation simulation(s, start, threads);
    const std::vector<double> X = simulation.snapshot().x_m;
    History history;
    while (simulation.time() < periods * period()) {
      simulation.step(HUGE_VAL);
      const std::vector<double> x = simulation.snapshot().x_m;
      double q = 0.0;
      for (std::size_t p = 0; p < X.size(); ++p) q += (x[p] - X[p]) * std::sin(k() * X[p]);
      history.add(simulation.time(), q);
    }
    return history.swing();
  }

  /// The part of a gradient that differs between the points of a cell, relative: −Ŵ′(a)/(σ²kh) of
  /// a = kh ± 2π, both together, to the first power of kh.
  double pattern(const Scene& s) const {
    const double order = s.kernel == Kernel::cubic ? 4.0 : 3.0, kh = k() * s.h;
    return 24.0 * std::pow(kh, order - 2.0) / std::pow(2.0 * pi, order);
  }

  /// The same by the map of one mode (above), for the transfers as docs/transfers.md defines them.
  Swing predicted(const Scene& s, double periods) const {
    const double kh = k() * s.h;
    const int order = s.kernel == Kernel::cubic ? 4 : 3;  // p + 1
    const double variance = order / 12.0;
    double W = 0.0, S = 0.0, spline_gradient = 0.0;
    for (int m = -2; m <= 2; ++m) {
      const double a = kh + 4.0 * pi * m, sign = m % 2 == 0 ? 1.0 : -1.0;
      const double transform = std::pow(std::sin(0.5 * a) / (0.5 * a), order);
      W += sign * transform;
      spline_gradient += sign * transform * a / kh;
      // Ŵ′ = (p + 1) Ŵ (½ cot(a/2) − 1/a)
      S += sign * order * transform * (1.0 / a - 0.5 / std::tan(0.5 * a)) / (variance * kh);
    }
    const double gradient = s.transfer == Transfer::tpic ? spline_gradient : S;
    const double affine = variance * kh * kh * S;
    const double dt = *s.dt, w2 = omega() * omega();
    double keep = 0.0, keep_affine = 0.0, of_affine = 0.0, extension = 1.0;
    switch (s.transfer) {
      case Transfer::pic:
        break;
      case Transfer::flip:
        keep = 1.0;
        break;
      case Transfer::apic:
      case Transfer::tpic:
        of_affine = 1.0;
        break;
      case Transfer::aflip:
        keep = of_affine = 1.0;
        break;
      case Transfer::relaxed:
        of_affine = 1.0;
        keep = keep_affine = std::exp(-dt / *s.relaxation_time);
        break;
      case Transfer::xpic:
      case Transfer::fmpm:
        for (int j = 1; j < s.order; ++j) extension += std::pow(1.0 - W * W, j);
    }
    const bool whole = s.transfer == Transfer::fmpm;
    // velocity v, affine velocity ik b, strain ik e and displacement q of the points
    double v = 1.0, b = of_affine, e = 0.0, q = 0.0;
    History history;
    for (double t = dt; t < periods * period() + dt; t += dt) {
      const double u = W * v + of_affine * affine * b;
      const double moved = (u - dt * w2 * gradient * e) * (whole ? extension : 1.0);
      const double given = whole ? moved : moved + (extension - 1.0) * u;
      v = W * given + keep * (v - W * u);
      b = gradient * moved + keep_affine * (b - gradient * u);
      e += dt * gradient * moved;
      q += dt * W * moved;
      history.add(t, q);
    }
    return history.swing();
  }
};

}  // namespace repose::mpm
