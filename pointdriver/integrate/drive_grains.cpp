#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(double, MuIElastoviscoplastic);
REPOSE_DRIVE_PATH(double, MuIRegularised);
REPOSE_DRIVE_PATH(double, MuIBarkerGray);

}  // namespace repose::point
