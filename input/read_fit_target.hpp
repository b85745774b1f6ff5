#pragma once
/// \file
/// A [[target]] of a fit: an experiment, its table and how the two are compared.

#include <filesystem>

#include "calibration/point_simulator.hpp"
#include "input/fit_keys.hpp"
#include "input/fit_table.hpp"
#include "input/read_fit.hpp"
#include "input/read_fit_parameters.hpp"

namespace repose::input {

class TargetReader {
 public:
  /// theta: the law's parameters at the start, NaN where the law derives them. cache: where runs of
  /// scenes are kept.
  TargetReader(InputFile& file, FitFile& out, FitParameters& parameters, std::vector<double> theta,
               std::filesystem::path cache)
      : file_(file),
        out_(out),
        parameters_(parameters),
        theta_(std::move(theta)),
        cache_(std::move(cache)) {}

  /// Appends the target; a broken one is reported and left out.
  void read(TomlReader& table);

  /// Appends a test that could be made next (FitFile::candidates).
  void read_candidate(TomlReader& table);

  /// Does a target have coarse settings of its own?
  bool has_coarse() const { return has_coarse_; }

 private:
  /// What of a point test is compared with the table; x and y lack the names that no curve has.
  struct Compared {
    std::optional<point::Quantity> x;
    std::vector<point::Quantity> y;
    calibration::Compare rows;
  };

  /// The law's free parameters as inputs of a target.
  void bind_law(calibration::Target& target) const;
  void read_scene_target(TomlReader& table, const TargetTable& given, const FitTable& data,
                         calibration::Target target, TargetAbout about);
  // read_fit_point_target.cpp
  void read_part(TomlReader& table, const TargetTable& given, const FitTable& data,
                 bool one_of_several);
  void read_point_target(TomlReader& table, const FitTable& data, Compared compared,
                         calibration::Target target, TargetAbout about);
  void read_initial_freedom(TomlReader& table, calibration::Target& target,
                            InitialConditions& initial);
  bool stress_is_free(TomlReader& table);
  std::vector<double> driven_abscissae(TomlReader& table, point::Quantity x,
                                       std::vector<double> values);
  static bool is_strain_driven(const point::Path& path);
  void check_reach(TomlReader& table, point::Quantity x, const FitTable& data,
                   const calibration::Simulator& simulator, const calibration::Target& target);
  void read_test(TomlReader& table, point::Quantity x, const FitTable& data,
                 calibration::Compare compare, calibration::PointExperiment& e,
                 calibration::Target& target);
  void read_flow_curve(TomlReader& test, point::Quantity x, const FitTable& data,
                       calibration::PointExperiment& e);

  InputFile& file_;
  FitFile& out_;
  FitParameters& parameters_;
  std::vector<double> theta_;
  std::filesystem::path cache_;
  bool has_coarse_ = false;
  std::size_t tables_ = 0;                                            ///< read so far
  point::StrainMeasure measure_ = point::StrainMeasure::logarithmic;  ///< of the present target
};

}  // namespace repose::input
