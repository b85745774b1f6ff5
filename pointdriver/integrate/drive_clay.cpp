#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(double, ModifiedCamClay<Compression::ln_v_ln_p>);
REPOSE_DRIVE_PATH(double, ModifiedCamClay<Compression::v_ln_p>);

}  // namespace repose::point
