#pragma once
/// \file
/// Every law of the library, as a type. A new law is one header and one entry in AllLaws.

#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>

#include "models/critical_state_mu_i.hpp"
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
               Newtonian<Tension::carried>, NeoHookean, CriticalStateMuI>;

/// Calls f(law) with a value of the law type that belongs to `info` (one of library_laws()), or
/// otherwise() for a law that is none of the library's.
template <class F, class Otherwise>
auto visit_law(const LawInfo& info, F&& f, Otherwise&& otherwise) {
  using Result = decltype(f(std::tuple_element_t<0, AllLaws>{}));
  const auto try_from = [&]<std::size_t i>(const auto& self,
                                           std::integral_constant<std::size_t, i>) -> Result {
    if constexpr (i == std::tuple_size_v<AllLaws>) {
      return otherwise();
    } else {
      using L = std::tuple_element_t<i, AllLaws>;
      if (L::name != info.name || L::option != info.option)
        return self(self, std::integral_constant<std::size_t, i + 1>{});
      return f(L{});
    }
  };
  return try_from(try_from, std::integral_constant<std::size_t, 0>{});
}

/// The same where only the library's own laws will do; throws InputError (key "name") for another.
template <class F>
auto visit_law(const LawInfo& info, F&& f) {
  using Result = decltype(f(std::tuple_element_t<0, AllLaws>{}));
  return visit_law(info, f, [&]() -> Result {
    throw InputError("name", "\"" + std::string(info.name) +
                                 (info.option.empty() ? "" : ", " + std::string(info.option)) +
                                 "\" is none of the library's own laws, and this works with those "
                                 "alone");
  });
}

}  // namespace repose
