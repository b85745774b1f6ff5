#include "study/accuracy/grain_layer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace repose::study {
namespace {

/// Faces between finite volumes carry the stress, the lowest that of the floor; the free surface
/// carries none.
class StartingFlow {
 public:
  StartingFlow(const GrainLayer& layer, std::size_t cells)
      : layer_(layer),
        dy_(layer.H / static_cast<double>(cells)),
        u_(cells),
        before_(cells),
        tau_(cells),
        trial_(cells),
        slope_(cells) {}

  LayerMeans means() const {
    LayerMeans mean;
    for (const double u : u_) {
      mean.velocity += u / static_cast<double>(u_.size());
      mean.square += u * u / static_cast<double>(u_.size());
    }
    return mean;
  }

  /// `count` steps of BDF2, (3u − 4u_n + u_{n−1})/2Δt = ∂u/∂t, the first of them backward Euler's.
  void advance(double time, std::size_t count) {
    dt_ = time / static_cast<double>(count);
    for (std::size_t k = 0; k < count; ++k) {
      const bool first = k == 0;
      const double a = first ? 1.0 : 1.5;  // of u over Δt
      std::vector<double> old(u_.size());
      for (std::size_t j = 0; j < u_.size(); ++j)
        old[j] = first ? u_[j] : 2.0 * u_[j] - 0.5 * before_[j];
      before_ = u_;
      solve(a, old);
    }
  }

 private:
  static constexpr int most_iterations = 100;

  /// Stress of the face at y and its slope over the rate: elastic up to μ_0 p, then the smaller
  /// root of τ² − Bτ + H = 0 (docs/physics.md, "The implicit step").
  void stress(std::size_t face, double rate) {
    const double y = dy_ * static_cast<double>(face);
    const double p = layer_.rho * layer_.g * std::cos(layer_.tilt) * (layer_.H - y);
    const double S_0 = layer_.mu_0 * p, S_2 = layer_.mu_d * p;
    const double trial = tau_[face] + layer_.G * dt_ * rate;
    trial_[face] = trial;
    slope_[face] = layer_.G * dt_;
    if (trial <= S_0) return;
    const double alpha = layer_.G * dt_ * layer_.I_0 / layer_.d * std::sqrt(p / layer_.rho_p);
    const double B = S_2 + trial + alpha, H = S_2 * trial + S_0 * alpha;
    const double tau = 2.0 * H / (B + std::sqrt(B * B - 4.0 * H));
    trial_[face] = tau;
    slope_[face] *= (S_2 - tau) / ((S_2 - tau) + (trial - tau) + alpha);
  }

  /// Newton's iteration until forces balance to 1e-8 of the volumes' weight.
  void solve(double a, const std::vector<double>& old) {
    const double tolerance = 1e-8 * layer_.rho * layer_.g * dy_;
    for (int iteration = 0; balance(a, old) > tolerance; ++iteration) {
      if (iteration == most_iterations)
        throw std::runtime_error("the layer of grains does not converge");
      const std::vector<double> change = newton(a, old);
      for (std::size_t j = 0; j < u_.size(); ++j) u_[j] += change[j];
    }
    tau_ = trial_;
  }

  double gap(std::size_t face) const { return face == 0 ? 0.5 * dy_ : dy_; }

  double force(std::size_t j, double a, const std::vector<double>& old) const {
    const double above = j + 1 < u_.size() ? trial_[j + 1] : 0.0;
    return above - trial_[j] +
           dy_ * layer_.rho * (layer_.g * std::sin(layer_.tilt) - (a * u_[j] - old[j]) / dt_);
  }

  /// Stresses of u_, and the largest force that is not balanced [Pa].
  double balance(double a, const std::vector<double>& old) {
    for (std::size_t face = 0; face < u_.size(); ++face)
      stress(face, (u_[face] - (face == 0 ? 0.0 : u_[face - 1])) / gap(face));
    double largest = 0.0;
    for (std::size_t j = 0; j < u_.size(); ++j)
      largest = std::max(largest, std::abs(force(j, a, old)));
    return largest;
  }

  /// Newton's step: symmetric tridiagonal, eliminated downwards.
  std::vector<double> newton(double a, const std::vector<double>& old) const {
    const std::size_t n = u_.size();
    const auto stiffness = [&](std::size_t face) {
      return face < n ? slope_[face] / gap(face) : 0.0;
    };
    std::vector<double> diagonal(n), x(n);
    for (std::size_t j = 0; j < n; ++j) {
      diagonal[j] = a * layer_.rho * dy_ / dt_ + stiffness(j) + stiffness(j + 1);
      x[j] = force(j, a, old);
      if (j == 0) continue;
      const double share = stiffness(j) / diagonal[j - 1];
      diagonal[j] -= share * stiffness(j);
      x[j] += share * x[j - 1];
    }
    x[n - 1] /= diagonal[n - 1];
    for (std::size_t j = n - 1; j-- > 0;) x[j] = (x[j] + stiffness(j + 1) * x[j + 1]) / diagonal[j];
    return x;
  }

  const GrainLayer& layer_;
  double dy_, dt_ = 0.0;
  std::vector<double> u_, before_;   ///< of the volumes [m/s]
  std::vector<double> tau_, trial_;  ///< of the faces, at the step's start and in it [Pa]
  std::vector<double> slope_;        ///< ∂τ/∂(rate) [Pa s]
};

}  // namespace

double bagnold_speed(const GrainLayer& layer) {
  const double mu = std::tan(layer.tilt);
  const double I = layer.I_0 * (mu - layer.mu_0) / (layer.mu_d - mu);
  return 2.0 * I / (3.0 * layer.d) *
         std::sqrt(layer.rho / layer.rho_p * layer.g * std::cos(layer.tilt)) *
         std::pow(layer.H, 1.5);
}

std::vector<LayerMeans> starting_flow(const GrainLayer& layer, double interval, std::size_t rows,
                                      std::size_t cells, std::size_t steps) {
  StartingFlow flow(layer, cells);
  std::vector<LayerMeans> means{flow.means()};
  while (means.size() < rows) {
    // at first the layer is elastic, and what it gains until it yields is felt for long
    flow.advance(interval, means.size() == 1 ? 100 * steps : steps);
    means.push_back(flow.means());
  }
  return means;
}

}  // namespace repose::study
