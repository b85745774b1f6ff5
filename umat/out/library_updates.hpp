#pragma once
/// \file
/// The library's own laws at an integration point, compiled once each, in updates_clay.cpp,
/// updates_critical_state.cpp, updates_grains.cpp and updates_fluids.cpp. (A law that is not listed
/// is compiled where it is asked for, in point_update.cpp.)

#include "models/all_laws.hpp"
#include "umat/out/law_point_update.hpp"

namespace repose::umat {

extern template class LawPointUpdate<ModifiedCamClay<Compression::ln_v_ln_p>>;
extern template class LawPointUpdate<ModifiedCamClay<Compression::v_ln_p>>;
extern template class LawPointUpdate<CriticalStateMuI>;
extern template class LawPointUpdate<MuIElastoviscoplastic>;
extern template class LawPointUpdate<MuIRegularised>;
extern template class LawPointUpdate<MuIBarkerGray>;
extern template class LawPointUpdate<Newtonian<Tension::cut_off>>;
extern template class LawPointUpdate<Newtonian<Tension::carried>>;
extern template class LawPointUpdate<NeoHookean>;

}  // namespace repose::umat
