#include "mpm/step/contact_damping.hpp"

#include "models/objective.hpp"
#include "models/scalar.hpp"

namespace repose::mpm {

template <int dim>
void damp_contacts(PointsOf<dim>& points, const SlotRange& range,
                   const typename PointsOf<dim>::Batch& batch,
                   const std::array<double*, Layout<dim>::components>& before, double* work) {
  using F = Layout<dim>;
  using Stress = Sym<Pack, static_cast<int>(F::components)>;
  // xx, yy, xy of the plane: σ_zz does no work there
  constexpr std::array<int, dim == 2 ? 3 : 6> component = [] {
    if constexpr (dim == 2)
      return std::array<int, 3>{0, 1, 3};
    else
      return std::array<int, 6>{0, 1, 2, 3, 4, 5};
  }();
  const Pack zero(0.0), half(0.5), per_step(points.damping_length / batch.dt);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const std::size_t s = range.begin + k;
    const auto turned = [&](const Stress& stress) {
      if constexpr (dim == 2)
        return rotated_in_plane(stress, Pack::load_aligned(batch.spin[0] + k));
      else
        return rotated(
            stress, {Pack::load_aligned(batch.spin[0] + k), Pack::load_aligned(batch.spin[1] + k),
                     Pack::load_aligned(batch.spin[2] + k)});
    };
    Stress now, then, viscous_then = Stress::isotropic(zero), strain;
    for (int i = 0; i < now.size; ++i) {
      const auto c = static_cast<std::size_t>(i);
      now[i] = Pack::load_aligned(points.data(F::stress + c) + s);
      then[i] = Pack::load_aligned(before[c] + k);
      strain[i] = Pack::load_aligned(batch.strain[c] + k);
    }
    for (std::size_t j = 0; j < component.size(); ++j)
      viscous_then[component[j]] =
          Pack::load_aligned(points.data(points.force_stress[j]) + s) - then[component[j]];
    // ℓ/(cΔt)
    const Pack factor = per_step * sqrt(Pack::load_aligned(points.data(F::rho) + s) /
                                        Pack::load_aligned(batch.modulus + k));
    Stress viscous = factor * (now - turned(then));
    const Pack p = pressure(now), p_viscous = pressure(viscous);
    const auto pulls = p + p_viscous < zero;
    const Pack share =
        select(pulls, Pack(select(p > zero, p, zero) / select(pulls, Pack(-p_viscous), Pack(1.0))),
               Pack(1.0));
    viscous = share * viscous;
    viscous_then = turned(viscous_then);
    if constexpr (dim == 2) viscous[2] = zero;  // as it was left out before the step
    for (std::size_t j = 0; j < component.size(); ++j)
      (now[component[j]] + viscous[component[j]])
          .store_aligned(points.data(points.force_stress[j]) + s);
    const Pack of_damping = half * contract(viscous_then + viscous, strain);
    of_damping.store_aligned(work + k);
    (Pack::load_aligned(batch.work + k) + of_damping).store_aligned(batch.work + k);
  }
}

template void damp_contacts<2>(PointsOf<2>&, const SlotRange&, const PointsOf<2>::Batch&,
                               const std::array<double*, 4>&, double*);
template void damp_contacts<3>(PointsOf<3>&, const SlotRange&, const PointsOf<3>::Batch&,
                               const std::array<double*, 6>&, double*);

}  // namespace repose::mpm
