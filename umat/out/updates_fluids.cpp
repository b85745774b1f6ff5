#include "umat/out/library_updates.hpp"

namespace repose::umat {

template class LawPointUpdate<Newtonian<Tension::cut_off>>;
template class LawPointUpdate<Newtonian<Tension::carried>>;
template class LawPointUpdate<NeoHookean>;

}  // namespace repose::umat
