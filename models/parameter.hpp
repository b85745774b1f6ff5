#pragma once
/// \file
/// The one table of a law's parameters and state variables. Help texts, scene validation, fit
/// bounds, generated documentation and the order of every parameter vector come from it.

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace repose {

/// An interval with open or closed ends.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = true;
  bool upper_open = true;
  constexpr bool contains(double x) const {
    return (lower_open ? x > lower : x >= lower) && (upper_open ? x < upper : x <= upper);
  }
};
constexpr Range positive{0.0, std::numeric_limits<double>::infinity(), true, true};
constexpr Range not_negative{0.0, std::numeric_limits<double>::infinity(), false, true};

/// "> 0", "[0, 0.5)", "any number".
std::string to_string(const Range& range);

enum class Need : std::uint8_t {
  required,   ///< no default: leaving it out is an error
  defaulted,  ///< ParamInfo::value applies
  optional,   ///< absent (NaN) unless given, or derived by the law (ParamInfo::doc says how)
};
enum class Scale : std::uint8_t { linear, log };

struct ParamInfo {
  std::string_view name;    ///< key in a TOML file
  std::string_view symbol;  ///< as in the law's paper
  std::string_view unit;    ///< "-" if it has none
  std::string_view doc;
  Need need = Need::required;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< default, if need == defaulted
  Range range{};
  Scale scale = Scale::linear;  ///< natural scale for fitting
  /// What an input file may give instead of it; none: an empty name.
  struct Angle {
    std::string_view name;                             ///< key of a friction angle [°]
    double (*parameter_of)(double degrees) = nullptr;  ///< the parameter of that angle
  };
  Angle angle{};
  /// Where it is not empty, the value is one of these words, and the number its position.
  std::span<const std::string_view> words{};
};

struct StateField {
  std::string_view name;
  std::string_view symbol;
  std::string_view unit;
  std::string_view doc;
};

/// A parameter, option or initial condition that a law cannot accept. `key` is the TOML key the
/// message is about, so that a reader can point at its line.
class InputError : public std::runtime_error {
 public:
  InputError(std::string key, const std::string& message)
      : std::runtime_error(message),
        key_(std::move(key)) {}
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

/// The known name closest to a misspelt one (edit distance, at most a third of its letters wrong,
/// letter case ignored), or "" if none is close.
std::string nearest_name(std::string_view misspelt, std::span<const std::string_view> known);

/// A parameter vector in table order from named values: defaults filled in, absent optional ones
/// NaN. Throws InputError for an unknown name (with the nearest one), a missing value, a value that
/// is not finite or out of range (with range and unit).
std::vector<double> parameter_vector(std::string_view law, std::span<const ParamInfo> table,
                                     const std::map<std::string, double>& given);

}  // namespace repose
