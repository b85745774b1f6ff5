#include "mpm/study/ill_posed_points.hpp"

#include <cmath>

#include "models/ill_posedness.hpp"

namespace repose::mpm {

std::vector<double> ill_posedness(const Scene& scene, const Simulation::Snapshot& points) {
  std::vector<std::unique_ptr<Material>> materials;
  for (const Body& body : scene.bodies) materials.push_back(make_material(body.law));
  std::vector<double> C(points.x_m.size(), std::nan(""));
  for (std::size_t i = 0; i < C.size(); ++i) {
    const auto body = static_cast<std::size_t>(points.body[i]);
    const auto response =
        shear_response(*materials[body], points.pressure_Pa[i], points.shear_rate[i]);
    if (response && points.mises_Pa[i] >= 0.99 * std::sqrt(3.0) * response->tau)
      C[i] = repose::ill_posedness(*response);
  }
  return C;
}

IllPosedShare ill_posed_share(const Simulation::Snapshot& points, std::span<const double> C) {
  double all = 0.0, flowing = 0.0, ill = 0.0;
  for (std::size_t i = 0; i < C.size(); ++i) {
    all += points.mass[i];
    if (std::isfinite(C[i])) flowing += points.mass[i];
    if (C[i] > 0.0) ill += points.mass[i];
  }
  return {flowing / all, ill / all};
}

}  // namespace repose::mpm
