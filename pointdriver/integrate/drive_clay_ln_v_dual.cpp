#include "pointdriver/integrate/library_drives.hpp"

namespace repose::point {

REPOSE_DRIVE_PATH(Gradient, ModifiedCamClay<Compression::ln_v_ln_p>);

}  // namespace repose::point
