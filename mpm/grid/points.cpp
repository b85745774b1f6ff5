#include "mpm/grid/points.hpp"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "models/scalar.hpp"

namespace repose::mpm {

template <int dim>
typename PointsOf<dim>::Batch PointsOf<dim>::batch(const SlotRange& range) {
  Batch b;
  b.count = range.count;
  b.density = field[At::rho].data() + range.begin;
  for (std::size_t k = 0; k < At::components; ++k)
    b.stress[k] = field[At::stress + k].data() + range.begin;
  for (std::size_t k = 0; k < state_fields(); ++k)
    b.state[k] = field[At::state + k].data() + range.begin;
  return b;
}

template <int dim>
void rearrange(PointsOf<dim>& points, const std::vector<std::uint32_t>& order,
               const std::vector<bool>& is_padding) {
  // A thread keeps one piece of memory to move a field into, and takes the field's in exchange:
  // fresh memory costs several times what the move does.
  const auto move = [&]<class Real>(AlignedVector<Real>& values) {
    static thread_local AlignedVector<Real> moved;
    moved.resize(order.size());
    const Real* const from = values.data();
    Real* const to = moved.data();
    for (std::size_t k = 0; k < order.size(); ++k) to[k] = from[order[k]];
    values.swap(moved);
  };
  tbb::parallel_for(std::size_t{0}, points.fields, [&](std::size_t f) {
    points.single ? move(points.narrow[f]) : move(points.field[f]);
  });
  if (points.single)
    for (AlignedVector<float>& rest : points.rest) move(rest);
  std::vector<std::int64_t> names(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    names[k] = is_padding[k] ? -1 : points.id[order[k]];
  points.id.swap(names);
}

template <int dim>
FieldView PointsOf<dim>::operator[](std::size_t f) const {
  if (!single) return {field[f].data(), nullptr, nullptr};
  const bool position = f < At::x + At::axes;  // the first fields
  return {nullptr, narrow[f].data(), position ? rest[f - At::x].data() : nullptr};
}

template <int dim>
void PointsOf<dim>::set(std::size_t f, std::size_t slot, double value) {
  if (!single) {
    field[f][slot] = value;
    return;
  }
  narrow[f][slot] = static_cast<float>(value);
  if (f < At::x + At::axes)
    rest[f - At::x][slot] = static_cast<float>(value - double{narrow[f][slot]});
}

template <int dim>
PointsOf<dim>& PointsOf<dim>::unpacked(const SlotRange& range) const {
  static thread_local PointsOf copy;
  if (copy.material != material) copy.material = material;
  copy.rho_0 = rho_0;
  copy.count = range.count;
  copy.fields = fields;
  copy.shear_strain = shear_strain;
  copy.affine = affine;
  copy.force_stress = force_stress;
  copy.damping_length = damping_length;
  copy.damped_signal = damped_signal;
  const std::size_t n = std::min(padded(range.count), slots() - range.begin);
  if (copy.id.size() < padded(n)) {
    copy.id.resize(padded(n));
    for (AlignedVector<double>& values : copy.field) values.resize(padded(n));
  }
  std::copy_n(id.begin() + static_cast<std::ptrdiff_t>(range.begin), n, copy.id.begin());
  for (std::size_t f = 0; f < fields; ++f)
    single ? std::copy_n(narrow[f].data() + range.begin, n, copy.data(f))
           : std::copy_n(data(f) + range.begin, n, copy.data(f));
  for (std::size_t axis = 0; single && axis < At::axes; ++axis) {
    const float* const of = rest[axis].data() + range.begin;
    double* const to = copy.data(At::x + axis);
    for (std::size_t k = 0; k < n; ++k) to[k] += double{of[k]};
  }
  for (std::size_t f = 0; n > 0 && f < fields; ++f)  // behind the last point, where it is not whole
    std::fill_n(copy.data(f) + n, padded(n) - n, copy.field[f][n - 1]);
  return copy;
}

template <int dim>
void PointsOf<dim>::pack(const PointsOf& copy, const SlotRange& range) {
  const std::size_t n = padded(range.count);
  for (std::size_t f = 0; f < fields; ++f) {
    const double* const from = copy.data(f);
    float* const to = narrow[f].data() + range.begin;
    for (std::size_t k = 0; k < n; ++k) to[k] = static_cast<float>(from[k]);
  }
  for (std::size_t axis = 0; axis < At::axes; ++axis) {
    const double* const from = copy.data(At::x + axis);
    const float* const rounded = narrow[At::x + axis].data() + range.begin;
    float* const to = rest[axis].data() + range.begin;
    for (std::size_t k = 0; k < n; ++k) to[k] = static_cast<float>(from[k] - double{rounded[k]});
  }
}

template <int dim>
std::vector<double> PointsOf<dim>::values(std::size_t f) const {
  std::vector<double> all(slots());
  for (std::size_t s = 0; s < all.size(); ++s) all[s] = (*this)[f][s];
  return all;
}

template <int dim>
void PointsOf<dim>::assign(std::size_t f, const std::vector<double>& values) {
  if (!single) {
    field[f].assign(values.begin(), values.end());
    return;
  }
  narrow[f].resize(values.size());
  if (f < At::x + At::axes) rest[f - At::x].resize(values.size());
  for (std::size_t s = 0; s < values.size(); ++s) set(f, s, values[s]);
}

template <int dim>
void PointsOf<dim>::reserve(std::size_t n) {
  id.reserve(n);
  for (std::size_t f = 0; f < fields; ++f) single ? narrow[f].reserve(n) : field[f].reserve(n);
  if (single)
    for (AlignedVector<float>& values : rest) values.reserve(n);
}

template <int dim>
void PointsOf<dim>::append(std::size_t f, double value) {
  if (!single) {
    field[f].push_back(value);
    return;
  }
  narrow[f].push_back(0.0F);
  if (f < At::x + At::axes) rest[f - At::x].push_back(0.0F);
  set(f, narrow[f].size() - 1, value);
}

template struct PointsOf<2>;
template struct PointsOf<3>;
template void rearrange(PointsOf<2>&, const std::vector<std::uint32_t>&, const std::vector<bool>&);
template void rearrange(PointsOf<3>&, const std::vector<std::uint32_t>&, const std::vector<bool>&);

}  // namespace repose::mpm
