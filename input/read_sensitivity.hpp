#pragma once
/// \file
/// [sensitivity]: which inputs of a test or a scene its results depend on.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calibration/free_parameter.hpp"
#include "input/input_file.hpp"
#include "input/keys.hpp"

namespace repose::input {

/// A value that is not known: even between bounds on its scale, or with a mean normal, or with a
/// relative standard deviation log-normal, cut off at the bounds it has.
struct UncertainInput {
  std::vector<std::string> keys;  ///< "law.M", "body[0].law.d": all take the one value
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  Scale scale = Scale::linear;
  std::optional<calibration::Prior> prior{};

  const std::string& name() const { return keys.front(); }
};

enum class SensitivityMethod : std::uint8_t { sobol, morris };
enum class SurrogateKind : std::uint8_t { chaos, none };

struct SensitivityInput {
  SensitivityMethod method = SensitivityMethod::sobol;
  SurrogateKind surrogate = SurrogateKind::chaos;
  int samples =
      0;  ///< runs of a surrogate; blocks of inputs + 2 runs, or trajectories of inputs + 1
  int levels = 4;
  std::vector<std::string> outputs;
  std::string output_place{};  ///< where they are written, for a complaint after the runs
  std::vector<UncertainInput> inputs;

  int runs() const;
};

inline constexpr std::size_t most_uncertain_inputs = 20;

/// The [sensitivity] of a test or scene; nothing if it has none. What else the file holds counts as
/// known. Mistakes are reported.
std::optional<SensitivityInput> read_sensitivity(InputFile& file);

/// Its table, for the schema and the page.
void sensitivity_keys(Keys& keys);

}  // namespace repose::input
