#pragma once
/// \file
/// The posterior density of a fit: what is known of the parameters, of each channel's noise and of
/// the law's own error, given the data. docs/posterior.md derives it.
///
/// ln p(u) = Σ_c ln p(e_c | errors of c) + ln priors + Σ ln |dz/du|, over coordinates u on the
/// whole of the real line: z = 1/(1 + e^−u) of every parameter, then per fitted channel ln σ
/// (unless the declared noise is kept to) and, with a discrepancy, ln τ and ln ℓ (curve_error.hpp).

#include "calibration/curve_error.hpp"
#include "calibration/problem.hpp"

namespace repose::calibration {

struct PosteriorOptions {
  int chains = 4;
  int warmup = 500;  ///< draws per chain that set the step and are thrown away
  int draws = 1000;  ///< per chain, kept
  /// Expected size of the law's own error, as a share of each channel's range; 0: the law is right.
  double discrepancy = 0.0;
  bool keep_declared_noise = false;  ///< false: estimated, declared or not
  double accept = 0.8;               ///< mean acceptance that the step is set to
  int chains_from = 0;               ///< this machine's share: [chains_from, chains_to)
  int chains_to = -1;                ///< −1: all
};

class Posterior {
 public:
  /// Errors: InputError (key "noise") if the declared noise is to be kept to and a channel has
  /// none.
  Posterior(const Problem& problem, const PosteriorOptions& options);

  const Problem& problem() const { return problem_; }
  Eigen::Index size() const { return size_; }  ///< coordinates

  struct Point {
    double log_density = 0.0;  ///< −∞ where a path breaks off
    Eigen::VectorXd gradient;
    /// Gauss-Newton's of −ln p, positive definite; empty unless asked for.
    Eigen::MatrixXd curvature;
  };
  /// Thread safe, never throws.
  void evaluate(const Eigen::VectorXd& u, bool with_curvature, Point& out) const;

  /// u of parameters at z, with errors as large as the residuals there.
  Eigen::VectorXd start(const Eigen::VectorXd& z) const;
  Eigen::VectorXd z(const Eigen::VectorXd& u) const;
  /// The errors of a fitted channel, in the channel's unit; `block` is its place in
  /// Problem::blocks().
  CurveError error(const Eigen::VectorXd& u, std::size_t block) const;

  /// What is drawn, in the order of quantities(): the parameters' values, then each channel's noise
  /// and, with a discrepancy, its size, in the channel's unit, and its length.
  std::vector<std::string> quantity_names() const;
  Eigen::VectorXd quantities(const Eigen::VectorXd& u) const;

 private:
  /// Of one fitted channel, in units of its scale.
  struct ChannelErrors {
    double scale = 1.0;             ///< in the channel's unit
    Eigen::VectorXd w;              ///< scale of a row over `scale`
    Eigen::Index noise = -1;        ///< place of ln σ in u; −1: kept
    Eigen::Index discrepancy = -1;  ///< place of ln τ, before that of ln ℓ; −1: none
    double noise_centre = 1.0, noise_width = 1.0;  ///< log-normal prior of σ
    double discrepancy_size = 0.0;                 ///< half-normal prior of τ
  };
  CurveError error_of(const Eigen::VectorXd& u, const ChannelErrors& c) const;
  double error_priors(const ChannelErrors& c, const CurveError& error,
                      std::array<double, 3>& slope) const;
  Eigen::Matrix3d error_curvature(const ChannelErrors& c, const CurveError& error,
                                  const Eigen::VectorXd& off) const;

  Problem problem_;
  std::vector<ChannelErrors> channels_;  ///< as Problem::blocks()
  Eigen::Index size_ = 0;
};

/// The u of the largest density that can be reached from `start`, by damped Gauss-Newton steps.
Eigen::VectorXd mode(const Posterior& posterior, const Eigen::VectorXd& start);

}  // namespace repose::calibration
