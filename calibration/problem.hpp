#pragma once
/// \file
/// A fit as one least-squares problem: residuals r(z) of all fitted targets and priors over the
/// unit cube of the free parameters, objective ½ rᵀr, exact derivatives where the simulators have
/// them.

#include <atomic>
#include <functional>
#include <map>
#include <mutex>

#include "calibration/curve_error.hpp"
#include "calibration/loss.hpp"
#include "calibration/parameter_space.hpp"
#include "calibration/target.hpp"

namespace repose::calibration {

/// r(z), layout: per fitted target its channels' rows and one penalty row, then the priors. With a
/// robust loss (loss.hpp) rows of r and J are multiplied by the roots of their weights, so that
/// Jᵀr is the gradient of the objective, and ½ r·r + `beyond` the objective itself.
struct Evaluation {
  Eigen::VectorXd r;
  Eigen::MatrixXd J;         ///< empty unless asked for
  double beyond = 0.0;       ///< what the costs of the rows have over their weighted squares
  bool failed = false;       ///< a path broke off; r is finite all the same
  double objective() const;  ///< from one place: to the same last bit for everybody
};

/// What was spent. Counted over all threads.
struct Spent {
  long evaluations = 0;                  ///< residual vectors
  long gradients = 0;                    ///< residual vectors with derivatives
  long paths = 0;                        ///< simulations of one target, with or without derivatives
  std::map<std::string, long> failures;  ///< trials by reason
};

/// Where a channel's rows stand in r, and what multiplies its scaled residuals.
struct Block {
  std::size_t target = 0, channel = 0;
  Eigen::Index first = 0, rows = 0;
  double factor = 1.0;  ///< r = factor · (simulated − observed)/scale
};

class Problem {
 public:
  /// balance: every channel counts as if it had the mean number of rows, so that long tables do
  /// not drown short ones; otherwise every row counts alike. Errors: InputError (key "target") if
  /// nothing is fitted, a channel's length differs from x, weights or noise are not positive.
  Problem(ParameterSpace space, std::vector<Target> targets, bool balance = true, Loss loss = {});

  const ParameterSpace& space() const { return space_; }
  const std::vector<Target>& targets() const { return targets_; }
  Eigen::Index size() const { return size_; }  ///< residuals
  Eigen::Index parameters() const { return static_cast<Eigen::Index>(space_.size()); }
  const std::vector<Block>& blocks() const { return blocks_; }
  /// Measured rows that are fitted.
  Eigen::Index data_rows() const { return data_rows_; }

  /// r and, if wanted, J at z; z is moved into the cube first (some algorithms leave it by a hair).
  /// A path that breaks off gives a finite penalty that grows with its unfinished share, and is
  /// counted by reason. Thread safe, never throws.
  void evaluate(const Eigen::VectorXd& z, bool with_J, Evaluation& out) const;

  /// Simulation of one target (fitted or held out) at z.
  Misfit predict(std::size_t target, const Eigen::VectorXd& z, Response* response = nullptr) const;
  /// The same with rows close to each other, for a picture (Simulator::drawn); without rows where
  /// there are none.
  Response drawn(std::size_t target, const Eigen::VectorXd& z,
                 std::span<const std::string> channels) const;

  Spent spent() const;
  /// Every optimiser asks this before each trial and, if true, ends with its best point so far.
  void interrupt_by(std::function<bool()> asked) { interrupted_ = std::move(asked); }
  bool interrupted() const { return interrupted_ && interrupted_(); }

  /// A copy with other measured values (bootstrap): observed[k] is rows × channels of target k.
  Problem with_observed(const std::vector<Eigen::MatrixXd>& observed) const;
  /// A copy over another space of as many parameters: one held, other means of priors.
  Problem with_space(ParameterSpace space) const;
  const Loss& loss() const { return loss_; }
  Problem with_loss(Loss loss) const;
  /// The scale of a channel's good rows, of every block and in units of r: the declared noise;
  /// where none is declared a tenth of the range at first, and what settle() finds
  /// (multistart.hpp).
  Eigen::VectorXd scales() const;
  void set_scales(const Eigen::VectorXd& scales);
  /// The weight of every row of a fitted target at z over that of a residual of 0 (rows ×
  /// channels).
  Eigen::MatrixXd row_weights(std::size_t target, const Eigen::VectorXd& z) const;
  /// What residuals of a block, as r without a loss, cost.
  double cost(const Block& block, const Eigen::VectorXd& r) const;
  /// r and J as the statistics of an optimum take them: with a robust loss K sψ/√m and √m J, m the
  /// mean of ψ' in the channel and K that of 1 + p/n Var ψ'/m² (Huber 1981, §7.6), so that J⁺r is
  /// what errors move the parameters by to first order, and Jᵀr/K the gradient. `gain`: √m of each
  /// row.
  void linearise(const Eigen::VectorXd& z, Evaluation& out, Eigen::VectorXd& gain) const;
  /// A copy in which these targets, one flag each, are held out and no others.
  Problem with_held_out(const std::vector<bool>& held_out) const;
  /// A copy whose residuals are the innovations of these errors, one per block and in units of r:
  /// the least squares of it are the most likely parameters under such errors. Priors count by
  /// their own standard deviations.
  Problem with_errors(std::vector<CurveError> errors) const;
  /// A copy with other simulators, one per target.
  Problem with_simulators(std::vector<std::shared_ptr<const Simulator>> simulators) const;

  /// What each prior counts beside the data: its residual is multiplied by √weight. The data's
  /// residuals are in units of their noise only where that was declared and is kept to; a prior's
  /// weight is the variance of theirs (weigh_priors in uncertainty.hpp). At first 1, or
  /// that of a noise of 1 % of the range where none is declared.
  const Eigen::VectorXd& prior_weights() const { return prior_weights_; }
  void set_prior_weights(Eigen::VectorXd weights);

  /// Adds what a copy has spent to this one's account.
  void account(const Problem& copy) const;

  Problem(const Problem& other);
  Problem& operator=(const Problem&) = delete;

 private:
  bool simulate(std::size_t k, const Eigen::VectorXd& z, bool derivatives, Misfit& out,
                Response& response) const;
  void target_residuals(std::size_t k, const Eigen::VectorXd& z, Eigen::Ref<Eigen::VectorXd> r,
                        bool count, bool* failed) const;
  void whiten(Evaluation& out) const;
  void weigh(Evaluation& out) const;
  void lay_out();
  void note_failure(std::string_view reason) const;

  ParameterSpace space_;
  std::vector<Target> targets_;
  bool balance_;
  std::vector<Block> blocks_;
  std::vector<Eigen::Index> first_;  ///< per target, −1 if held out
  std::vector<double> penalty_;      ///< per target
  Loss loss_;
  std::vector<std::vector<double>> scales_;  ///< per target and channel, in units of scale_of()
  std::vector<CurveError> errors_;           ///< per block; empty: residuals are as they are
  Eigen::VectorXd prior_weights_;            ///< one per prior
  Eigen::Index size_ = 0, data_rows_ = 0;
  std::function<bool()> interrupted_;
  mutable std::atomic<long> evaluations_{0}, gradients_{0}, paths_{0};
  mutable std::mutex mutex_;
  mutable std::map<std::string, long> failures_;
};

}  // namespace repose::calibration
