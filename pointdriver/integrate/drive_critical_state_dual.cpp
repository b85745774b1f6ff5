#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(Gradient, CriticalStateMuI);

}  // namespace repose::point
