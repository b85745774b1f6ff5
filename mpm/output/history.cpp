#include "mpm/output/history.hpp"

namespace repose::mpm {

History record(const Scene& scene, const Prescribed& prescribed, int rows,
               const std::function<void(const Simulation&)>& at_row) {
  History history;
  Simulation simulation(scene, prescribed, 1);
  const auto note = [&] {
    history.rows.push_back(simulation.diagnostics());
    if (at_row) at_row(simulation);
  };
  note();
  try {
    for (int k = 1; k <= rows; ++k) {
      const double stop = scene.end_time * k / rows;
      while (simulation.time() < stop) simulation.step(stop);
      note();
    }
  } catch (const NumericalFailure& failure) {
    history.failure = failure.what();
  }
  return history;
}

}  // namespace repose::mpm
