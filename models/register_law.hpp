#pragma once
/// \file
/// Makes a law's type known by its name, from outside the library (law.hpp says what the type must
/// provide), `repose::register_law<MyLaw>()`; of several forms of one name the first is the
/// default. examples/own_law.cpp is a whole one.
///
/// The law is then found by find_law() and make_material(), and the Material Point Method runs it.
/// pointdriver/integrate/register_law.hpp does this and gives it to the point driver and to fits as
/// well. The law is compiled here, for whatever instruction set this file is compiled for; only
/// plain arrays go between it and the library.

#include "models/law_material.hpp"
#include "models/registry.hpp"
#include "models/shear_response.hpp"

namespace repose {

/// A law as compiled for one instruction set: the same law, with the set in the name, so that two
/// compilations of it in one program stay apart.
template <class L, class InstructionSet = Pack::arch_type>
struct Compiled : L {};

/// The entry of the registry for a law's type, without a point driver.
template <class L>
OutsideLaw outside_law() {
  using C = Compiled<L>;
  static_assert(ConstitutiveLaw<C>, "models/law.hpp lists what a law provides");
  OutsideLaw law;
  law.info = &LawMaterial<C>::info();
  law.complete = [](std::vector<double>& theta) { C::complete(theta); };
  law.make = [](std::vector<double> theta) -> std::unique_ptr<Material> {
    return std::make_unique<LawMaterial<C>>(std::move(theta));
  };
  if constexpr (HasSteadyShear<C>)
    law.shear_response = [](std::span<const double> theta, double p, double gamma_dot) {
      return shear_response<C>(theta, p, gamma_dot);
    };
  return law;
}

/// Throws InputError (key "name") where the name is taken; see register_law(forms).
template <class... Forms>
void register_law() {
  register_law(std::vector<OutsideLaw>{outside_law<Forms>()...});
}

}  // namespace repose
