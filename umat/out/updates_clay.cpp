#include "umat/out/library_updates.hpp"

namespace repose::umat {

template class LawPointUpdate<ModifiedCamClay<Compression::ln_v_ln_p>>;
template class LawPointUpdate<ModifiedCamClay<Compression::v_ln_p>>;

}  // namespace repose::umat
