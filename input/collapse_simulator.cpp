#include "input/collapse_simulator.hpp"

#include <array>
#include <cmath>
#include <fstream>

#include <fmt/core.h>

#include "input/resolved_scene.hpp"
#include "io/atomic_file.hpp"
#include "io/fingerprint.hpp"
#include "io/json.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::input {
namespace {

using calibration::Response;
using Eigen::Index;

constexpr std::array<std::string_view, 6> series_channels{
    "front_m", "front_99_m", "front_max_m", "height_m", "kinetic_J_per_m", "potential_J_per_m"};

double read(const mpm::SeriesRow& row, std::string_view channel) {
  if (channel == "front_m") return row.front_m;
  if (channel == "front_99_m") return row.front_99_m;
  if (channel == "front_max_m") return row.front_max_m;
  if (channel == "height_m") return row.height_m;
  if (channel == "kinetic_J_per_m") return row.kinetic_J_per_m;
  return row.potential_J_per_m;
}

class CollapseSimulator final : public calibration::Simulator {
 public:
  explicit CollapseSimulator(CollapseExperiment experiment) : e_(std::move(experiment)) {
    const LawInfo& info = find_law(e_.law);
    for (const ParamInfo& p : info.parameters) names_.emplace_back(p.name);
    if (!e_.times.empty()) e_.scene.scene.end_time = e_.times.back();
    if (e_.cache.empty()) return;
    std::filesystem::create_directories(e_.cache);
    io::remove_old_parts(e_.cache, [](std::string_view name) { return name.ends_with(".json"); });
  }

  const std::vector<std::string>& inputs() const override { return names_; }
  bool has_derivatives() const override { return false; }
  /// The front moves from cell to cell: differences must span more than that grain.
  double difference_step() const override { return 0.03; }

  void simulate(std::span<const double> inputs, std::span<const int>,
                Response& response) const override {
    SceneFile file = e_.scene;
    LawSpec law = e_.law;
    law.values.clear();
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (!std::isnan(inputs[i])) law.values[names_[i]] = inputs[i];
    for (mpm::Body& body : file.scene.bodies) body.law = law;
    response = {};
    const auto channels = static_cast<Index>(e_.channels.size());
    try {
      std::string key = resolved_input(file, "");
      for (const double t : e_.times) key += fmt::format(" {}", t);
      for (const std::string& c : e_.channels) key += " " + c;
      const std::filesystem::path kept = e_.cache / (io::fingerprint_of(key) + ".json");
      if (!e_.cache.empty() && recall(kept, key, response)) {
        e_.count->recalled.fetch_add(1, std::memory_order_relaxed);
        return;
      }
      e_.count->simulated.fetch_add(1, std::memory_order_relaxed);
      run(file.scene, response);
      if (!e_.cache.empty()) keep(kept, key, response);
    } catch (const InputError&) {
      response.reason = "bad_initial";
      response.finished = 0.0;
      response.x.resize(0);
      response.y.resize(0, channels);
    }
  }

 private:
  void run(const mpm::Scene& scene, Response& r) const {
    mpm::Simulation simulation(scene, e_.threads);
    const auto channels = static_cast<Index>(e_.channels.size());
    std::vector<double> x;
    std::vector<Eigen::RowVectorXd> y;
    const auto state = [&] {
      const mpm::SeriesRow row = simulation.diagnostics();
      Eigen::RowVectorXd values(channels);
      for (Index c = 0; c < channels; ++c)
        values[c] = read(row, e_.channels[static_cast<std::size_t>(c)]);
      return values;
    };
    try {
      if (e_.times.empty()) {
        while (simulation.time() < scene.end_time) simulation.step(scene.end_time);
        const auto profile = simulation.profile();
        x = profile.x_m;
        for (const double depth : profile.depth_m)
          y.push_back(Eigen::RowVectorXd::Constant(1, depth));
      } else {
        for (const double t : e_.times) {
          while (simulation.time() < t) simulation.step(t);
          x.push_back(t);
          y.push_back(state());
        }
      }
    } catch (const mpm::NumericalFailure&) {
      r.reason = "numerical_failure";
      r.finished = simulation.time() / scene.end_time;
      if (!e_.times.empty()) r.last = state();
    }
    r.x = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Index>(x.size()));
    r.y.resize(static_cast<Index>(y.size()), channels);
    for (std::size_t i = 0; i < y.size(); ++i) r.y.row(static_cast<Index>(i)) = y[i];
  }

  /// The whole key is kept beside the answer: a hash alone could collide.
  static void keep(const std::filesystem::path& file, const std::string& key, const Response& r) {
    if (!r.complete()) return;
    io::Json j;
    j["input"] = key;
    j["x"] = std::vector<double>(r.x.begin(), r.x.end());
    for (Index c = 0; c < r.y.cols(); ++c)
      j["y"].push_back(std::vector<double>(r.y.col(c).begin(), r.y.col(c).end()));
    const std::string text = j.dump();
    io::write_atomically(file, io::fingerprint_of(text) + "\n" + text);
  }

  static bool recall(const std::filesystem::path& file, const std::string& key, Response& r) {
    std::ifstream in(file);
    if (!in) return false;
    const std::string text(std::istreambuf_iterator<char>(in), {});
    const std::size_t head = text.find('\n');
    // what is not as it was written is simulated again, and replaced
    if (head == std::string::npos ||
        text.substr(0, head) != io::fingerprint_of(std::string_view(text).substr(head + 1)))
      return false;
    const auto j = io::Json::try_parse(std::string_view(text).substr(head + 1));
    if (!j || j->value("input", "") != key) return false;
    const auto x = j->at("x").get<std::vector<double>>();
    const auto y = j->at("y").get<std::vector<std::vector<double>>>();
    r.x = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Index>(x.size()));
    r.y.resize(r.x.size(), static_cast<Index>(y.size()));
    for (std::size_t c = 0; c < y.size(); ++c)
      r.y.col(static_cast<Index>(c)) =
          Eigen::Map<const Eigen::VectorXd>(y[c].data(), static_cast<Index>(y[c].size()));
    return true;
  }

  CollapseExperiment e_;
  std::vector<std::string> names_;
};

}  // namespace

std::span<const std::string_view> collapse_channels() { return series_channels; }

std::unique_ptr<calibration::Simulator> make_collapse_simulator(CollapseExperiment experiment) {
  return std::make_unique<CollapseSimulator>(std::move(experiment));
}

}  // namespace repose::input
