/// The points as they are, in the order of their names.

#include <algorithm>
#include <limits>

#include "mpm/output/averaged_stress.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {

template <int dim>
Simulation::Snapshot Simulation::Impl<dim>::snapshot() const {
  using F = Layout<dim>;
  constexpr int components = F::components;
  struct Place {
    std::int64_t id;
    std::size_t body, slot;
  };
  std::vector<Place> places;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t s = 0; s < bodies[b].slots(); ++s)
      if (bodies[b].id[s] >= 0) places.push_back({bodies[b].id[s], b, s});
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.id < b.id; });

  Snapshot shot;
  for (const Place& place : places) {
    const PointsOf<dim>& points = bodies[place.body];
    const auto at = [&](std::size_t f) { return points[f][place.slot]; };
    Sym<double, components> stress;
    for (std::size_t k = 0; k < F::components; ++k) stress.c[k] = at(F::stress + k);
    shot.x_m.push_back(at(F::x));
    shot.y_m.push_back(at(F::x + 1));
    shot.vx.push_back(at(F::v));
    shot.vy.push_back(at(F::v + 1));
    shot.density.push_back(at(F::rho));
    shot.pressure_Pa.push_back(pressure(stress));
    shot.mises_Pa.push_back(mises(stress));
    const auto L = [&](std::size_t i, std::size_t j) { return at(F::L + i * F::axes + j); };
    Sym<double, components> D{};
    D.c[0] = L(0, 0);
    D.c[1] = L(1, 1);
    D.c[3] = 0.5 * (L(0, 1) + L(1, 0));
    if constexpr (dim == 3) {
      D.c[2] = L(2, 2);
      D.c[4] = 0.5 * (L(1, 2) + L(2, 1));
      D.c[5] = 0.5 * (L(2, 0) + L(0, 2));
    }
    shot.shear_rate.push_back(2.0 * shear_norm(deviator(D)));
    shot.mass.push_back(at(F::mass));
    shot.sxx.push_back(stress[0]);
    shot.syy.push_back(stress[1]);
    shot.szz.push_back(stress[2]);
    shot.sxy.push_back(stress[3]);
    if constexpr (dim == 3) {
      shot.z_m.push_back(at(F::x + 2));
      shot.vz.push_back(at(F::v + 2));
      shot.syz.push_back(stress[4]);
      shot.szx.push_back(stress[5]);
    }
    shot.body.push_back(static_cast<std::int32_t>(place.body));
    shot.id.push_back(place.id);
    if (points.shear_strain != 0) shot.shear_strain.push_back(at(points.shear_strain));
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto table = bodies[b].material->law().state;
    for (std::size_t k = 0; k < table.size(); ++k) {
      auto variable = std::find_if(shot.state.begin(), shot.state.end(), [&](const auto& known) {
        return known.field->name == table[k].name && known.field->unit == table[k].unit;
      });
      if (variable == shot.state.end()) {
        const double none = std::numeric_limits<double>::quiet_NaN();
        shot.state.push_back({&table[k], std::vector<double>(places.size(), none)});
        variable = shot.state.end() - 1;
      }
      for (std::size_t i = 0; i < places.size(); ++i)
        if (places[i].body == b) variable->values[i] = bodies[b][F::state + k][places[i].slot];
    }
  }
  return shot;
}

Simulation::Snapshot Simulation::snapshot(Stress of) const {
  Snapshot points = visit([](const auto& s) { return s.snapshot(); });
  if (of == Stress::averaged) average_stress(points, scene().h);
  return points;
}

Simulation::Snapshot Simulation::Snapshot::slice(double from, double to) const {
  using Values = std::vector<double> Snapshot::*;
  constexpr std::array<Values, 17> columns{
      &Snapshot::shear_rate,  &Snapshot::mass,     &Snapshot::x_m, &Snapshot::y_m,
      &Snapshot::z_m,         &Snapshot::vx,       &Snapshot::vy,  &Snapshot::vz,
      &Snapshot::density,     &Snapshot::sxx,      &Snapshot::syy, &Snapshot::szz,
      &Snapshot::pressure_Pa, &Snapshot::mises_Pa, &Snapshot::sxy, &Snapshot::syz,
      &Snapshot::szx};
  Snapshot part;
  for (std::size_t k = 0; k < z_m.size(); ++k) {
    if (!(z_m[k] >= from && z_m[k] < to)) continue;
    for (const Values column : columns) (part.*column).push_back((this->*column)[k]);
    part.body.push_back(body[k]);
    part.id.push_back(id[k]);
    if (!shear_strain.empty()) part.shear_strain.push_back(shear_strain[k]);
    for (std::size_t i = 0; i < state.size(); ++i) {
      if (part.state.size() == i) part.state.push_back({state[i].field, {}});
      part.state[i].values.push_back(state[i].values[k]);
    }
  }
  return part;
}

io::FrameView Simulation::Snapshot::view(double time_s) const {
  io::FrameView frame;
  frame.time_s = time_s;
  frame.x_m = x_m;
  frame.y_m = y_m;
  frame.z_m = z_m;
  frame.scalars = {
      {"density_kg_per_m3", density}, {"pressure_Pa", pressure_Pa}, {"mises_Pa", mises_Pa}};
  frame.vectors = {{"velocity_m_per_s", vx, vy, vz}};
  frame.tensors = {{"stress_Pa", sxx, syy, szz, sxy, syz, szx}};
  frame.integers = {{"body", body}};
  return frame;
}

template Simulation::Snapshot Simulation::Impl<2>::snapshot() const;
template Simulation::Snapshot Simulation::Impl<3>::snapshot() const;

}  // namespace repose::mpm
