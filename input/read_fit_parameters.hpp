#pragma once
/// \file
/// The free parameters of a fit, as they are read.

#include <map>

#include "input/read_fit.hpp"
#include "input/toml_reader.hpp"

namespace repose::input {

/// Collects what [fit] and the targets' `free` tables set free, in FitFile::free.
class FitParameters {
 public:
  /// out.info must be known.
  FitParameters(InputFile& file, FitFile& out) : file_(file), out_(out) {}

  /// [fit] with its [fit.shared]; the law's parameters come first, in the order of its table.
  void read(TomlReader& fit);

  /// Positions of the quantities of [fit.shared], by name.
  const std::map<std::string, int>& shared() const { return shared_; }

  /// An entry `key` of a target's `free`: p, ocr, v, K0 or p_c0. Returns its position.
  int add_initial(TomlReader& free, const std::string& key, const std::string& target);

  /// Resolves `of`, and keeps the orders that the laws demand (κ < λ, μ_0 < μ_d) where the bounds
  /// alone do not; every bound that was written holds. What depends on another parameter goes last,
  /// so positions change: the targets' bindings follow.
  void link_ratios();

 private:
  struct Entry {
    calibration::FreeParameter parameter;
    std::string of;  ///< another free parameter, to which this one is a ratio
  };
  static Entry read_entry(TomlReader entry, const std::string& name, std::string_view unit,
                          std::string_view doc, Scale scale, const Range& range);
  int add(Entry entry, std::string law_key, const std::string& path);
  const ParamInfo* law_parameter(std::string_view name) const;

  InputFile& file_;
  FitFile& out_;
  std::vector<std::string> of_, path_;  ///< per free parameter
  std::vector<std::string> below_;      ///< per free parameter: the one it must stay below
  std::map<std::string, int> shared_;
};

/// The value a parameter starts from, as far as it is known without its partner.
double start_value(const calibration::FreeParameter& parameter);

}  // namespace repose::input
