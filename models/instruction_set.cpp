#include "models/instruction_set.hpp"

#include "models/scalar.hpp"

namespace repose {

std::string_view instruction_set() {
  if constexpr (Pack::size == 8)
    return "avx512";
  else
    return "avx2";
}

}  // namespace repose
