#pragma once
/// \file
/// The way from a tile to the points of a pack, by the instruction set: with 32 registers of eight
/// lanes a row of a tile is a table (table_stencil.hpp), else rows are summed as they lie
/// (row_stencil.hpp). Both give Σ w f and its first moments to round-off.

#include <type_traits>

#include "mpm/grid/row_stencil.hpp"
#if defined(__AVX512F__)
#include "mpm/grid/table_stencil.hpp"
#endif

namespace repose::mpm {

#if defined(__AVX512F__)
template <class Kernel, int dim>
using PointStencil = std::conditional_t<dim == 2, TableStencil<Kernel>, RowStencil<Kernel, dim>>;
#else
template <class Kernel, int dim>
using PointStencil = RowStencil<Kernel, dim>;
#endif

}  // namespace repose::mpm
