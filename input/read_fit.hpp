#pragma once
/// \file
/// A fit file: [law], [fit], [[target]], [solver], [uncertainty], [posterior] (docs/interface.md,
/// Fit).

#include <filesystem>

#include "calibration/multistart.hpp"
#include "calibration/posterior.hpp"
#include "input/collapse_simulator.hpp"
#include "input/input_file.hpp"
#include "input/key_info.hpp"
#include "models/registry.hpp"

namespace repose::input {

/// What the pictures need of a target beside its numbers.
struct TargetAbout {
  std::string data;          ///< the table as the fit file names it
  std::string x_label;       ///< "eps_a"
  std::string strain{};      ///< "logarithmic" or "engineering": of the data; empty for a scene
  std::size_t table = 0;     ///< of which [[target]] it is, or a part
  std::vector<int> lines{};  ///< of the table's rows in its file
  bool triaxial = false;     ///< its last stage is one: q over p′ is worth a picture
};

struct FitFile {
  std::string name;
  LawSpec law;  ///< with the free parameters at their start
  const LawInfo* info = nullptr;
  std::vector<calibration::FreeParameter> free;
  /// Which parameter of the law a free one is; "" for initial and shared quantities.
  std::vector<std::string> law_key;
  std::vector<calibration::Target> targets;
  /// The targets with their scenes' coarse settings, searched first; empty if none has any.
  std::vector<calibration::Target> coarse;
  /// Tests that could be made next: their rows and noise, without data.
  std::vector<calibration::Target> candidates;
  long fine_evaluations = 60;
  std::vector<TargetAbout> about;
  bool balance = true;
  calibration::Loss loss;
  calibration::FitOptions options;
  bool profiles = true;
  int bootstrap = 0;  ///< repeats
  /// Standard deviation of the fine scenes' discretisation error over the change from coarse to
  /// fine at the coarse optimum.
  double resolution_error = 1.0;
  std::optional<calibration::PosteriorOptions> posterior;  ///< absent: none is asked for
  std::shared_ptr<CollapseCount> runs = std::make_shared<CollapseCount>();
  std::string resolved;             ///< the input as TOML, --set included, tables by absolute path
  std::string fingerprint;          ///< of everything that the result of a start depends on
  std::vector<std::string> tables;  ///< how each measured table was understood
  std::vector<std::string> notes;   ///< what was made of the input that the user may not expect
};

/// A fit as it is where a file says nothing: 16 starts of Levenberg-Marquardt.
FitFile default_fit();

/// Every key of a fit.
std::vector<KeyInfo> fit_infos();

/// Reads and validates a fit and its tables. Throws BadInput with everything that is wrong, IoError
/// for files that cannot be read.
/// cache: where runs of scenes are kept.
FitFile read_fit(const std::filesystem::path& file, std::span<const std::string> overrides,
                 std::uint64_t seed, const std::filesystem::path& cache = {});

/// The same of a file that was read already. Its measured tables are relative to the folder of its
/// name.
FitFile read_fit(const InputFile& given, std::uint64_t seed,
                 const std::filesystem::path& cache = {});

/// The law with fitted values in place of the free parameters' starts.
LawSpec fitted_law(const FitFile& file, const Eigen::VectorXd& values);

}  // namespace repose::input
