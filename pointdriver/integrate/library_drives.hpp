#pragma once
/// \file
/// The library's own laws along a path, in plain numbers and with derivatives: compiled once each,
/// in drive_clay.cpp, drive_grains.cpp, drive_fluids.cpp, drive_critical_state.cpp and their _dual
/// twins, for everything that drives them. (A law from outside brings its own:
/// register_law.hpp.)

#include "models/all_laws.hpp"
#include "pointdriver/integrate/drive.hpp"
#include "pointdriver/integrate/sensitivity.hpp"

namespace repose::point {

/// An explicit instantiation of drive_path(), or with `extern` before it its announcement.
#define REPOSE_DRIVE_PATH(T, ...)                                                               \
  template Outcome drive_path<__VA_ARGS__, T>(const ElementStart<__VA_ARGS__, T>&, const Path&, \
                                              const Settings&, BasicCurve<T>&)

#define REPOSE_DRIVE_PATHS(T)                                           \
  extern REPOSE_DRIVE_PATH(T, ModifiedCamClay<Compression::ln_v_ln_p>); \
  extern REPOSE_DRIVE_PATH(T, ModifiedCamClay<Compression::v_ln_p>);    \
  extern REPOSE_DRIVE_PATH(T, MuIElastoviscoplastic);                   \
  extern REPOSE_DRIVE_PATH(T, MuIRegularised);                          \
  extern REPOSE_DRIVE_PATH(T, MuIBarkerGray);                           \
  extern REPOSE_DRIVE_PATH(T, Newtonian<Tension::cut_off>);             \
  extern REPOSE_DRIVE_PATH(T, Newtonian<Tension::carried>);             \
  extern REPOSE_DRIVE_PATH(T, NeoHookean);                              \
  extern REPOSE_DRIVE_PATH(T, CriticalStateMuI)

REPOSE_DRIVE_PATHS(double);
REPOSE_DRIVE_PATHS(Gradient);
#undef REPOSE_DRIVE_PATHS

}  // namespace repose::point
