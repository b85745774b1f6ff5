#pragma once
/// \file
/// The name of a material in the input of a finite element program, and the form of a law that it
/// means.
///
///     NAME[-FORM][__SUFFIX]
///
/// NAME is the law's name and FORM the value of its option; a form that is switched on or off is
/// the name of the switch, or NO_ and that. FORM may be left out where the law has a default. The
/// suffix is the user's own: two materials of one law need two names. Letter case does not count,
/// blanks at the end neither.

#include <string>
#include <string_view>

#include "models/material.hpp"

namespace repose::umat {

/// Abaqus's limit [characters].
inline constexpr std::size_t longest_name = 80;

/// "MU_I-REGULARISED", "NEWTONIAN-NO_TENSION_CUTOFF", "CRITICAL_STATE_MU_I".
std::string material_name(const LawInfo& law);

/// The form that a material's name means, one of library_laws(). Throws InputError (key "CMNAME")
/// where there is none, with the nearest name.
const LawInfo& find_form(std::string_view name);

}  // namespace repose::umat
