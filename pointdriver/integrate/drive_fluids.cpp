#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(double, Newtonian<Tension::cut_off>);
REPOSE_DRIVE_PATH(double, Newtonian<Tension::carried>);
REPOSE_DRIVE_PATH(double, NeoHookean);

}  // namespace repose::point
