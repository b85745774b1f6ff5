#pragma once
/// \file
/// Between numpy arrays of shape (points, components) and the batches of models/material.hpp, which
/// want one contiguous column per component, with room for padded(points).

#include "binding.hpp"
#include "models/material.hpp"

namespace repose::python {

/// In place of a number of columns: the array is (points,).
inline constexpr std::size_t flat = static_cast<std::size_t>(-1);

/// An array (points, columns), or (points,) where `columns` is `flat`, in memory that a batch takes
/// as it is: column by column, with room for the padding.
Array batch_array(std::size_t points, std::size_t columns);

/// Whether numbers would lose their imaginary parts.
bool is_complex(const py::handle& given);

/// The columns of an array, to be read. Where its memory does not do (any order but column by
/// column; no room for padding) they are copied.
class ReadColumns {
 public:
  /// what: for messages, "strain". Throws InputError for another shape.
  ReadColumns(const py::object& given, std::string_view what, std::size_t points,
              std::size_t columns);
  // the columns point into this one's own copy, which goes along when it is moved
  ReadColumns(const ReadColumns&) = delete;
  ReadColumns(ReadColumns&&) noexcept = default;
  const double* operator[](std::size_t k) const { return columns_[k]; }

 private:
  Array held_;
  std::vector<double> copy_;
  std::vector<const double*> columns_;
};

/// The columns of an array made by batch_array(), or of one that a batch may write in place.
/// Throws InputError, saying what would do, for another.
std::vector<double*> write_columns(const Array& array, std::string_view what, std::size_t points,
                                   std::size_t columns);

/// A copy in memory of batch_array(), with its padding filled.
Array batch_copy(const py::object& given, std::string_view what, std::size_t points,
                 std::size_t columns);

/// How many points an array of (points, components) has, and how many components: 4 or 6.
struct Shape {
  std::size_t points, components;
};
Shape stress_shape(const py::object& stress, std::string_view what);

}  // namespace repose::python
