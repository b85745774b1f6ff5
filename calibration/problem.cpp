#include "calibration/problem.hpp"

#include <cmath>

namespace repose::calibration {

double Evaluation::objective() const { return 0.5 * r.squaredNorm() + beyond; }

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The scale of a channel's good rows before any are seen, where its noise is not declared: a share
/// of the range that leaves a search far from the optimum its way.
constexpr double first_scale = 0.1;

std::vector<std::vector<double>> first_scales(const std::vector<Target>& targets) {
  std::vector<std::vector<double>> scales;
  for (const Target& t : targets) {
    scales.emplace_back();
    for (const Channel& c : t.channels) scales.back().push_back(c.noise ? 1.0 : first_scale);
  }
  return scales;
}

}  // namespace

Problem::Problem(ParameterSpace space, std::vector<Target> targets, bool balance, Loss loss)
    : space_(std::move(space)),
      targets_(std::move(targets)),
      balance_(balance),
      loss_(loss),
      scales_(first_scales(targets_)) {
  lay_out();
}

Problem::Problem(const Problem& other)
    : space_(other.space_),
      targets_(other.targets_),
      balance_(other.balance_),
      loss_(other.loss_),
      scales_(other.scales_),
      errors_(other.errors_),
      interrupted_(other.interrupted_) {
  lay_out();
  prior_weights_ = other.prior_weights_;
}

void Problem::lay_out() {
  blocks_.clear();
  first_.assign(targets_.size(), -1);
  penalty_.assign(targets_.size(), 0.0);
  Index channels = 0;
  data_rows_ = 0;
  for (const Target& t : targets_) {
    if (t.held_out) continue;
    if (t.rows() == 0 || t.channels.empty())
      throw InputError("target", t.name + ": no rows to fit");
    if (!(t.weight > 0.0)) throw InputError("target", t.name + ": weight must be > 0");
    for (const Channel& c : t.channels) {
      if (c.observed.size() != t.rows())
        throw InputError("target", t.name + ": " + c.name + " has another number of rows than x");
      if (c.noise && !(*c.noise > 0.0))
        throw InputError("target", t.name + ": the noise of " + c.name + " must be > 0");
      if (!(c.weight > 0.0))
        throw InputError("target", t.name + ": the weight of " + c.name + " must be > 0");
    }
    channels += static_cast<Index>(t.channels.size());
    data_rows_ += t.count();
  }
  if (channels == 0) throw InputError("target", "every target is held out: nothing is fitted");
  const double mean_rows = static_cast<double>(data_rows_) / static_cast<double>(channels);
  Index row = 0;
  for (std::size_t k = 0; k < targets_.size(); ++k) {
    const Target& t = targets_[k];
    if (t.held_out) continue;
    first_[k] = row;
    double range = 0.0;
    for (std::size_t c = 0; c < t.channels.size(); ++c) {
      const Channel& channel = t.channels[c];
      const double share = balance_ ? mean_rows / static_cast<double>(t.rows()) : 1.0;
      const double factor = std::sqrt(t.weight * channel.weight * share);
      blocks_.push_back({k, c, row, t.rows(), factor});
      const double spread = channel.observed.maxCoeff() - channel.observed.minCoeff();
      const double relative = std::max(1.0, spread / scale_of(channel));
      range += static_cast<double>(t.rows()) * factor * factor * relative * relative;
      row += t.rows();
    }
    // a path that does not start costs ten times what a misfit by the whole range costs
    penalty_[k] = std::sqrt(10.0 * range);
    ++row;
  }
  size_ = row + static_cast<Index>(space_.prior_count());
  double variance = 0.0;
  for (const Block& b : blocks_) {
    const bool declared = targets_[b.target].channels[b.channel].noise.has_value();
    variance += static_cast<double>(b.rows) * b.factor * b.factor * (declared ? 1.0 : 1e-4);
  }
  prior_weights_ = VectorXd::Constant(static_cast<Index>(space_.prior_count()),
                                      variance / static_cast<double>(data_rows_));
}

void Problem::note_failure(std::string_view reason) const {
  const std::lock_guard lock(mutex_);
  ++failures_[std::string(reason)];
}

bool Problem::simulate(std::size_t k, const VectorXd& z, bool derivatives, Misfit& out,
                       Response& response) const {
  const Target& t = targets_[k];
  const VectorXd values = space_.values(z);
  std::vector<double> inputs = t.inputs;
  std::vector<int> wanted;
  for (const Binding& b : t.bindings) {
    inputs[static_cast<std::size_t>(b.input)] = values[b.parameter];
    if (derivatives) wanted.push_back(b.input);
  }
  paths_.fetch_add(1, std::memory_order_relaxed);
  try {
    t.simulator->simulate(inputs, wanted, response);
  } catch (const std::exception&) {  // against the contract, but no reason to lose the fit
    response = {};
    response.y.resize(0, static_cast<Index>(t.channels.size()));
    response.reason = "exception";
    response.finished = 0.0;
  }
  misfit(t, response, out);
  if (!out.finite) {
    if (response.complete()) response.reason = "not_finite";
    response.finished = 0.0;
    out.r.setConstant(1.0);
    out.slope.setZero();
  }
  return response.complete();
}

void Problem::target_residuals(std::size_t k, const VectorXd& z, Eigen::Ref<VectorXd> r, bool count,
                               bool* failed) const {
  Misfit m;
  Response response;
  const bool complete = simulate(k, z, false, m, response);
  if (!complete && count) note_failure(response.reason);
  if (!complete && failed != nullptr) *failed = true;
  for (const Block& b : blocks_)
    if (b.target == k)
      r.segment(b.first, b.rows) =
          b.factor * m.r.segment(static_cast<Index>(b.channel) * b.rows, b.rows);
  r[first_[k] + targets_[k].count()] = penalty_[k] * (1.0 - response.finished);
}

void Problem::evaluate(const VectorXd& z_given, bool with_J, Evaluation& out) const {
  const VectorXd z = clipped(z_given);
  (with_J ? gradients_ : evaluations_).fetch_add(1, std::memory_order_relaxed);
  const Index n = parameters();
  out.r.setZero(size_);
  out.failed = false;
  out.beyond = 0.0;
  if (with_J)
    out.J.setZero(size_, n);
  else
    out.J.resize(0, 0);
  MatrixXd slopes;
  if (with_J) slopes = space_.slopes(z);
  for (std::size_t k = 0; k < targets_.size(); ++k) {
    const Target& t = targets_[k];
    if (t.held_out) continue;
    if (!with_J || !t.simulator->has_derivatives()) {
      target_residuals(k, z, out.r, true, &out.failed);
      if (!with_J) continue;
    } else {
      Misfit m;
      Response response;
      if (simulate(k, z, true, m, response)) {
        MatrixXd map(static_cast<Index>(t.bindings.size()), n);
        for (std::size_t b = 0; b < t.bindings.size(); ++b)
          map.row(static_cast<Index>(b)) = slopes.row(t.bindings[b].parameter);
        for (const Block& b : blocks_) {
          if (b.target != k) continue;
          const Index from = static_cast<Index>(b.channel) * b.rows;
          out.r.segment(b.first, b.rows) = b.factor * m.r.segment(from, b.rows);
          out.J.middleRows(b.first, b.rows) = b.factor * m.slope.middleRows(from, b.rows) * map;
        }
        continue;
      }
      target_residuals(k, z, out.r, true, &out.failed);
    }
    // no derivatives, or a path that broke off, whose end moves: differences in z, inwards at a
    // bound
    VectorXd a = out.r, b = out.r;
    const Index first = first_[k], rows = t.count() + 1;
    const double h = t.simulator->difference_step();
    for (Index j = 0; j < n; ++j) {
      bool matters = false;
      for (const Binding& binding : t.bindings)
        matters = matters || slopes(binding.parameter, j) != 0.0;
      if (!matters) continue;
      VectorXd up = z, down = z;
      up[j] = std::min(1.0, z[j] + h);
      down[j] = std::max(0.0, z[j] - h);
      target_residuals(k, up, a, false, nullptr);
      target_residuals(k, down, b, false, nullptr);
      out.J.col(j).segment(first, rows) =
          (a.segment(first, rows) - b.segment(first, rows)) / (up[j] - down[j]);
    }
  }
  const auto priors = static_cast<Index>(space_.prior_count());
  if (priors > 0) {
    if (with_J) {
      Eigen::Ref<MatrixXd> J = out.J.bottomRows(priors);
      space_.priors(z, out.r.tail(priors), &J);
      J = prior_weights_.cwiseSqrt().asDiagonal() * J;
    } else {
      space_.priors(z, out.r.tail(priors), nullptr);
    }
    out.r.tail(priors).array() *= prior_weights_.array().sqrt();
  }
  whiten(out);
  weigh(out);
}

void Problem::weigh(Evaluation& out) const {
  if (!loss_.robust()) return;
  const VectorXd scale = scales();
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& b = blocks_[k];
    const double s = scale[static_cast<Index>(k)];
    for (Index i = b.first; i < b.first + b.rows; ++i) {
      const double u = out.r[i] / s, w = loss_.weight(u);
      out.beyond += s * s * (loss_.cost(u) - 0.5 * w * u * u);
      out.r[i] *= std::sqrt(w);
      if (out.J.size() > 0) out.J.row(i) *= std::sqrt(w);
    }
  }
}

void Problem::linearise(const VectorXd& z, Evaluation& out, VectorXd& gain) const {
  with_loss({}).evaluate(z, true, out);
  gain = VectorXd::Ones(size_);
  if (!loss_.robust()) return;
  const VectorXd scale = scales();
  const double share = static_cast<double>(parameters()) / static_cast<double>(data_rows_);
  double K = 1.0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& b = blocks_[k];
    const double s = scale[static_cast<Index>(k)], rows = static_cast<double>(b.rows);
    double mean = 0.0, square = 0.0;
    for (Index i = b.first; i < b.first + b.rows; ++i) {
      const double slope = loss_.slope(out.r[i] / s);
      mean += slope / rows;
      square += slope * slope / rows;
    }
    mean = std::max(mean, 0.1);  // most rows are outliers: next to nothing is known
    K += share * rows / static_cast<double>(data_rows_) *
         std::max(0.0, square / (mean * mean) - 1.0);
    for (Index i = b.first; i < b.first + b.rows; ++i) {
      gain[i] = std::sqrt(mean);
      out.r[i] = s * loss_.score(out.r[i] / s) / gain[i];
      out.J.row(i) *= gain[i];
    }
  }
  for (const Block& b : blocks_) out.r.segment(b.first, b.rows) *= K;
}

VectorXd Problem::scales() const {
  VectorXd scales(static_cast<Index>(blocks_.size()));
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    scales[static_cast<Index>(k)] =
        blocks_[k].factor * scales_[blocks_[k].target][blocks_[k].channel];
  return scales;
}

void Problem::set_scales(const VectorXd& scales) {
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    scales_[blocks_[k].target][blocks_[k].channel] =
        scales[static_cast<Index>(k)] / blocks_[k].factor;
}

double Problem::cost(const Block& block, const VectorXd& r) const {
  if (!loss_.robust()) return 0.5 * r.squaredNorm();
  const double s = block.factor * scales_[block.target][block.channel];
  double sum = 0.0;
  for (const double x : r) sum += s * s * loss_.cost(x / s);
  return sum;
}

MatrixXd Problem::row_weights(std::size_t target, const VectorXd& z) const {
  const Target& t = targets_[target];
  const Misfit m = predict(target, z);
  MatrixXd weights(t.rows(), static_cast<Index>(t.channels.size()));
  for (Index c = 0; c < weights.cols(); ++c)
    for (Index i = 0; i < t.rows(); ++i)
      weights(i, c) =
          loss_.weight(m.r[c * t.rows() + i] / scales_[target][static_cast<std::size_t>(c)]) /
          loss_.weight(0.0);
  return weights;
}

void Problem::whiten(Evaluation& out) const {
  for (std::size_t k = 0; k < errors_.size(); ++k) {
    const Block& b = blocks_[k];
    const VectorXd alike = VectorXd::Ones(b.rows);
    out.r.segment(b.first, b.rows) = innovations(errors_[k], out.r.segment(b.first, b.rows), alike);
    if (out.J.size() > 0)
      out.J.middleRows(b.first, b.rows) =
          innovations(errors_[k], out.J.middleRows(b.first, b.rows), alike);
  }
}

Misfit Problem::predict(std::size_t target, const VectorXd& z, Response* response) const {
  Misfit m;
  Response own;
  simulate(target, clipped(z), false, m, response == nullptr ? own : *response);
  return m;
}

Response Problem::drawn(std::size_t target, const VectorXd& z,
                        std::span<const std::string> channels) const {
  const Target& t = targets_[target];
  Response response;
  const std::shared_ptr<const Simulator> simulator = t.simulator->drawn(channels);
  if (!simulator) return response;
  const VectorXd values = space_.values(clipped(z));
  std::vector<double> inputs = t.inputs;
  for (const Binding& b : t.bindings)
    inputs[static_cast<std::size_t>(b.input)] = values[b.parameter];
  simulator->simulate(inputs, {}, response);
  return response;
}

Spent Problem::spent() const {
  const std::lock_guard lock(mutex_);
  return {evaluations_.load(), gradients_.load(), paths_.load(), failures_};
}

Problem Problem::with_observed(const std::vector<MatrixXd>& observed) const {
  Problem copy(*this);
  for (std::size_t k = 0; k < copy.targets_.size(); ++k)
    for (std::size_t c = 0; c < copy.targets_[k].channels.size(); ++c) {
      Channel& channel = copy.targets_[k].channels[c];
      // the scale stays that of the data, so that residuals compare
      if (!channel.noise) channel.noise = scale_of(channel);
      channel.observed = observed[k].col(static_cast<Index>(c));
    }
  copy.lay_out();
  copy.prior_weights_ = prior_weights_;
  return copy;
}

Problem Problem::with_space(ParameterSpace space) const {
  Problem copy(*this);
  copy.space_ = std::move(space);
  return copy;
}

Problem Problem::with_held_out(const std::vector<bool>& held_out) const {
  Problem copy(*this);
  for (std::size_t k = 0; k < copy.targets_.size(); ++k) copy.targets_[k].held_out = held_out[k];
  copy.lay_out();
  copy.prior_weights_ = prior_weights_;
  return copy;
}

Problem Problem::with_loss(Loss loss) const {
  Problem copy(*this);
  copy.loss_ = loss;
  return copy;
}

Problem Problem::with_errors(std::vector<CurveError> errors) const {
  Problem copy(*this);
  copy.loss_ = {};
  copy.errors_ = std::move(errors);
  copy.prior_weights_.setOnes();
  return copy;
}

Problem Problem::with_simulators(std::vector<std::shared_ptr<const Simulator>> simulators) const {
  Problem copy(*this);
  for (std::size_t k = 0; k < copy.targets_.size(); ++k)
    copy.targets_[k].simulator = std::move(simulators[k]);
  return copy;
}

void Problem::set_prior_weights(VectorXd weights) {
  for (const double w : weights)
    if (!(w > 0.0 && std::isfinite(w)))
      throw InputError("prior", "a prior's weight must be positive");
  prior_weights_ = std::move(weights);
}

void Problem::account(const Problem& copy) const {
  const Spent spent = copy.spent();
  evaluations_ += spent.evaluations;
  gradients_ += spent.gradients;
  paths_ += spent.paths;
  const std::lock_guard lock(mutex_);
  for (const auto& [reason, n] : spent.failures) failures_[reason] += n;
}

}  // namespace repose::calibration
