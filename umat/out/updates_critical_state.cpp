#include "umat/out/library_updates.hpp"

namespace repose::umat {

template class LawPointUpdate<CriticalStateMuI>;

}  // namespace repose::umat
