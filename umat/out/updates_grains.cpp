#include "umat/out/library_updates.hpp"

namespace repose::umat {

template class LawPointUpdate<MuIElastoviscoplastic>;
template class LawPointUpdate<MuIRegularised>;
template class LawPointUpdate<MuIBarkerGray>;

}  // namespace repose::umat
