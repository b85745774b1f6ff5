#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(Gradient, MuIElastoviscoplastic);
REPOSE_DRIVE_PATH(Gradient, MuIRegularised);
REPOSE_DRIVE_PATH(Gradient, MuIBarkerGray);

}  // namespace repose::point
