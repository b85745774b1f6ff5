#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(Gradient, ModifiedCamClay<Compression::v_ln_p>);

}  // namespace repose::point
