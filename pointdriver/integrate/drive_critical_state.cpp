#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(double, CriticalStateMuI);

}  // namespace repose::point
