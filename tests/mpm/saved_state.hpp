#pragma once
/// \file
/// Everything a simulation carries, read back from its checkpoint: what the public interface does
/// not show (the affine velocity, the order of the points), and what "the same bits" means.

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "mpm/grid/points.hpp"
#include "mpm/step/simulation.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::mpm {

/// A file name of its own for this test, gone with the object.
class ScratchFile {
 public:
  std::filesystem::path path() const { return folder_.path() / "state.h5"; }

 private:
  ScratchFolder folder_;
};

/// Every data set of a checkpoint by name.
struct SavedState {
  std::map<std::string, std::vector<double>> reals;
  std::map<std::string, std::vector<std::int64_t>> wholes;
  bool operator==(const SavedState&) const = default;
};

inline SavedState read_state(const std::filesystem::path& path) {
  SavedState state;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(file, 0);
  const auto visit = [](hid_t from, const char* name, const H5L_info_t*, void* target) -> herr_t {
    SavedState& into = *static_cast<SavedState*>(target);
    const hid_t set = H5Dopen2(from, name, H5P_DEFAULT);
    const hid_t space = H5Dget_space(set);
    const hid_t type = H5Dget_type(set);
    const auto n = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    if (H5Tget_class(type) == H5T_FLOAT) {
      std::vector<double>& values = into.reals[name];
      values.resize(n);
      if (n > 0) H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    } else {
      std::vector<std::int64_t>& values = into.wholes[name];
      values.resize(n);
      if (n > 0) H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
    return 0;
  };
  H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &state);
  H5Fclose(file);
  return state;
}

inline SavedState saved_state(const Simulation& simulation) {
  const ScratchFile file;
  simulation.save(file.path());
  return read_state(file.path());
}

/// A material point with all its fields (see Field).
struct PointState {
  std::int64_t id;
  std::size_t body;
  std::array<double, STATE + max_state> field{};
  std::array<double, affine_fields> affine{};  ///< xx, xy, yx, yy of the field given to the grid
  double operator[](std::size_t f) const { return field[f]; }
};

/// All points in the order of their creation.
inline std::vector<PointState> points_of(const Simulation& simulation) {
  const SavedState state = saved_state(simulation);
  std::vector<PointState> points;
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    const std::string body = "body" + std::to_string(b);
    const std::vector<std::int64_t>& id = state.wholes.at(body + "_id");
    // the last four fields where the transfer keeps an affine velocity of its own
    std::size_t fields = 0;
    while (state.reals.count(body + "_field" + std::to_string(fields)) > 0) ++fields;
    const bool apart = simulation.scene().transfer == Transfer::relaxed;
    const std::size_t affine = apart ? fields - affine_fields : LXX;
    for (std::size_t s = 0; s < id.size(); ++s) {
      if (id[s] < 0) continue;
      PointState& point = points.emplace_back(PointState{id[s], b, {}, {}});
      for (std::size_t f = 0; f < std::min(apart ? affine : fields, point.field.size()); ++f) {
        const auto values = state.reals.find(body + "_field" + std::to_string(f));
        if (values != state.reals.end()) point.field[f] = values->second[s];
      }
      for (std::size_t k = 0; k < affine_fields; ++k)
        point.affine[k] = state.reals.at(body + "_field" + std::to_string(affine + k))[s];
    }
  }
  std::sort(points.begin(), points.end(),
            [](const PointState& a, const PointState& b) { return a.id < b.id; });
  return points;
}

/// h² Σ w d², the second moment of the kernel, of which APIC's angular momentum is made.
inline double affine_moment(const Scene& scene) {
  return scene.h * scene.h / (scene.kernel == Kernel::cubic ? 3.0 : 4.0);
}

/// Σ m (x × v) + m D (L_yx − L_xy) about the origin [kg m²/s per m].
inline double angular_momentum(const std::vector<PointState>& points, const Scene& scene) {
  const double D = affine_moment(scene);
  double sum = 0.0;
  for (const PointState& p : points)
    sum += p[MASS] * (p[X] * p[VY] - p[Y] * p[VX] + D * (p[LYX] - p[LXY]));
  return sum;
}

}  // namespace repose::mpm
