#pragma once
/// \file
/// A full simulation as a fit's simulator: the scene of `repose run`, one law, front and height
/// over time or the final profile.

#include <atomic>
#include <filesystem>
#include <memory>

#include "calibration/simulator.hpp"
#include "input/read_scene.hpp"

namespace repose::input {

/// Simulations so far, over all threads.
struct CollapseCount {
  std::atomic<long> simulated{0}, recalled{0};
};

struct CollapseExperiment {
  SceneFile scene;
  LawSpec law;                        ///< replaces the law of every body; values come as inputs
  std::vector<std::string> channels;  ///< columns of series.csv, or "depth_m" for the final profile
  std::vector<double> times;          ///< of the data [s]; empty for the final profile
  int threads = 1;
  std::filesystem::path cache;  ///< folder of finished runs by hash of their input; empty: none
  std::shared_ptr<CollapseCount> count = std::make_shared<CollapseCount>();
};

/// The columns of series.csv that a fit may compare.
std::span<const std::string_view> collapse_channels();

/// Rows stand exactly at the data's times (the step is cut to land there); x of the final profile
/// is x_m. Inputs: the law's parameters. A run whose result lies in the cache is not repeated, so
/// that a killed fit loses only the runs under way. Errors of a trial are reasons, never thrown;
/// IoError for the cache.
std::unique_ptr<calibration::Simulator> make_collapse_simulator(CollapseExperiment experiment);

}  // namespace repose::input
