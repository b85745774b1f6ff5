#pragma once
/// \file
/// PROPS: a law's parameters in the order of its table, then, for a law with state variables, `ocr`
/// and `v`, from which a point starts whose state is not given.

#include <span>
#include <vector>

#include "models/law.hpp"
#include "models/material.hpp"

namespace repose::umat {

/// What may follow the parameters.
struct StartConstant {
  std::string_view name, unit, range, doc;
};
/// Of a law without state variables, none: its stress says all.
std::span<const StartConstant> start_constants(const LawInfo& law);

struct Constants {
  std::vector<double> theta;  ///< completed parameters in table order; NaN: absent
  InitialConditions start;    ///< ocr and v, where given
};

/// Whether a 0 among the constants stands for "not given": where 0 is no value of the parameter.
/// (A blank field of an input file is 0.)
bool zero_is_absent(const ParamInfo& parameter);

/// Throws InputError (key: a parameter's name, or "PROPS") where there are too many, one is missing
/// or out of range, or two contradict each other.
Constants read_constants(const LawInfo& law, std::span<const double> props);

/// "PROPS(3), nu": where a key of read_constants()'s errors is; empty for none.
std::string place_of(const LawInfo& law, std::string_view key);

}  // namespace repose::umat
