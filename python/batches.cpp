#include "batches.hpp"

#include <fmt/format.h>

#include "models/padding.hpp"

namespace repose::python {
namespace {

constexpr const char* memory_name = "repose.batch_array";

struct Memory {
  explicit Memory(std::size_t size) : numbers(size, 0.0) {}
  std::vector<double> numbers;
};

std::size_t columns_in(std::size_t columns) { return columns == flat ? 1 : columns; }

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < array.ndim(); ++k)
    text += fmt::format("{}{}", k == 0 ? "" : ", ", array.shape(k));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// Throws InputError unless it is (points, columns), or (points,) where columns is `flat`.
void require_shape(const py::array& array, std::string_view what, std::size_t points,
                   std::size_t columns) {
  const auto is = [&](py::ssize_t axis, std::size_t n) {
    return array.shape(axis) == static_cast<py::ssize_t>(n);
  };
  const bool right = columns == flat ? array.ndim() == 1 && is(0, points)
                                     : array.ndim() == 2 && is(0, points) && is(1, columns);
  if (!right)
    throw InputError(std::string(what),
                     fmt::format("{} must have the shape {}; it has {}", what,
                                 columns == flat ? fmt::format("({},)", points)
                                                 : fmt::format("({}, {})", points, columns),
                                 shape_text(array)));
}

/// The memory of batch_array() that an array is a view of; null if it is none.
const Memory* memory_of(const py::array& array) {
  py::object base = array.base();
  while (base && py::isinstance<py::array>(base)) base = py::cast<py::array>(base).base();
  if (!base || PyCapsule_IsValid(base.ptr(), memory_name) == 0) return nullptr;
  return static_cast<const Memory*>(PyCapsule_GetPointer(base.ptr(), memory_name));
}

/// Whether a batch may take the columns as they are: contiguous, and the padding of each is room
/// that may be read (`write`: that belongs to no other point).
bool suits(const Array& array, std::size_t points, std::size_t columns, bool write) {
  const auto size = static_cast<py::ssize_t>(sizeof(double));
  if (points == 0 || columns == 0) return true;
  if (points > 1 && array.strides(0) != size) return false;
  const std::size_t room = padded(points), count = columns_in(columns);
  if (columns != flat && columns > 1 &&
      (array.strides(1) < size * static_cast<py::ssize_t>(points) || array.strides(1) % size != 0))
    return false;
  if (room == points) return true;
  const Memory* const memory = memory_of(array);
  if (memory == nullptr) return false;
  const double* const first = array.data();
  const double* const begin = memory->numbers.data();
  const auto step =
      columns != flat && columns > 1 ? array.strides(1) / size : static_cast<py::ssize_t>(room);
  const double* const last = first + step * static_cast<py::ssize_t>(count - 1);
  if (first < begin || last + room > begin + memory->numbers.size()) return false;
  return !write || (first == begin && step == static_cast<py::ssize_t>(room));
}

Array as_numbers(const py::object& given, std::string_view what) {
  Array array = Array::ensure(given);
  if (!array || is_complex(given)) {
    PyErr_Clear();
    throw InputError(std::string(what), fmt::format("{} is no array of real numbers", what));
  }
  return array;
}

/// Copies into columns with room for padding, which repeats the last point.
void copy_columns(const Array& from, std::size_t points, std::size_t columns, double* to) {
  const std::size_t room = padded(points), count = columns_in(columns);
  for (std::size_t k = 0; k < count; ++k) {
    double* const column = to + k * room;
    for (std::size_t i = 0; i < points; ++i) {
      const auto row = static_cast<py::ssize_t>(i);
      column[i] = columns == flat ? from.at(row) : from.at(row, static_cast<py::ssize_t>(k));
    }
    for (std::size_t i = points; i < room && points > 0; ++i) column[i] = column[points - 1];
  }
}

}  // namespace

bool is_complex(const py::handle& given) {
  const py::array array = py::array::ensure(given);
  if (!array) PyErr_Clear();
  return array && array.dtype().kind() == 'c';
}

Array batch_array(std::size_t points, std::size_t columns) {
  const std::size_t room = padded(points);
  auto* const memory = new Memory(std::max<std::size_t>(1, room * columns_in(columns)));
  const py::capsule owner(memory, memory_name, [](PyObject* capsule) {
    delete static_cast<Memory*>(PyCapsule_GetPointer(capsule, memory_name));
  });
  const auto size = static_cast<py::ssize_t>(sizeof(double));
  const auto n = static_cast<py::ssize_t>(points);
  if (columns == flat) return Array({n}, {size}, memory->numbers.data(), owner);
  return Array({n, static_cast<py::ssize_t>(columns)},
               {size, size * static_cast<py::ssize_t>(room)}, memory->numbers.data(), owner);
}

ReadColumns::ReadColumns(const py::object& given, std::string_view what, std::size_t points,
                         std::size_t columns)
    : held_(as_numbers(given, what)) {
  require_shape(held_, what, points, columns);
  const std::size_t count = columns_in(columns);
  if (points > 0 && suits(held_, points, columns, false)) {
    for (std::size_t k = 0; k < count; ++k)
      columns_.push_back(columns == flat ? held_.data()
                                         : held_.data(0, static_cast<py::ssize_t>(k)));
    return;
  }
  copy_.resize(count * padded(points));
  copy_columns(held_, points, columns, copy_.data());
  for (std::size_t k = 0; k < count; ++k) columns_.push_back(copy_.data() + k * padded(points));
}

std::vector<double*> write_columns(const Array& array, std::string_view what, std::size_t points,
                                   std::size_t columns) {
  require_shape(array, what, points, columns);
  if (!array.writeable())
    throw InputError(std::string(what),
                     fmt::format("{} cannot be updated in place: it is read-only", what));
  if (!suits(array, points, columns, true))
    throw InputError(
        std::string(what),
        fmt::format("{} cannot be updated in place: it needs numbers in columns (order "
                    "\"F\") and a multiple of {} points, or an array of "
                    "repose.batch_array()",
                    what, pack_size));
  std::vector<double*> list;
  if (columns == 0) return list;
  double* const first = const_cast<double*>(array.data());
  const auto step = columns != flat && columns > 1
                        ? static_cast<std::size_t>(array.strides(1)) / sizeof(double)
                        : std::size_t{0};
  for (std::size_t k = 0; k < columns_in(columns); ++k) list.push_back(first + k * step);
  return list;
}

Array batch_copy(const py::object& given, std::string_view what, std::size_t points,
                 std::size_t columns) {
  const Array numbers = as_numbers(given, what);
  require_shape(numbers, what, points, columns);
  Array copy = batch_array(points, columns);
  copy_columns(numbers, points, columns, const_cast<double*>(copy.data()));
  return copy;
}

Shape stress_shape(const py::object& stress, std::string_view what) {
  const Array array = as_numbers(stress, what);
  if (array.ndim() != 2 || (array.shape(1) != 4 && array.shape(1) != 6))
    throw InputError(std::string(what),
                     fmt::format("{} must have the shape (points, 4), xx yy zz xy in plane strain, "
                                 "or (points, 6), xx yy zz xy yz zx; it has {}",
                                 what, shape_text(array)));
  return {static_cast<std::size_t>(array.shape(0)), static_cast<std::size_t>(array.shape(1))};
}

}  // namespace repose::python
