#pragma once
/// \file
/// Every law of the library, as a type. A new law is one header and one entry in AllLaws.

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "models/material.hpp"
#include "models/modified_cam_clay.hpp"
#include "models/mu_i.hpp"
#include "models/mu_i_barker_gray.hpp"
#include "models/neo_hookean.hpp"
#include "models/newtonian.hpp"

namespace repose {

/// The first entry of a name is its default form where defaults exist (default_form()).
using AllLaws =
    std::tuple<ModifiedCamClay<Compression::ln_v_ln_p>, ModifiedCamClay<Compression::v_ln_p>,
               MuIElastoviscoplastic, MuIRegularised, MuIBarkerGray, Newtonian<Tension::cut_off>,
               Newtonian<Tension::carried>, NeoHookean>;

/// Calls f(law) with a value of the law type that belongs to `info` (one of all_laws()).
template <class F>
auto visit_law(const LawInfo& info, F&& f) {
  using Result = decltype(f(std::tuple_element_t<0, AllLaws>{}));
  const auto try_from = [&]<std::size_t i>(const auto& self,
                                           std::integral_constant<std::size_t, i>) -> Result {
    using L = std::tuple_element_t<i, AllLaws>;
    if constexpr (i + 1 < std::tuple_size_v<AllLaws>) {
      if (L::name != info.name || L::option != info.option)
        return self(self, std::integral_constant<std::size_t, i + 1>{});
    }
    return f(L{});
  };
  return try_from(try_from, std::integral_constant<std::size_t, 0>{});
}

}  // namespace repose
