#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(Gradient, Newtonian<Tension::cut_off>);
REPOSE_DRIVE_PATH(Gradient, Newtonian<Tension::carried>);
REPOSE_DRIVE_PATH(Gradient, NeoHookean);

}  // namespace repose::point
