#include "study/stability/mpm.hpp"

#include <cmath>

#include <fmt/core.h>

#include "mpm/study/failure_modes.hpp"

namespace repose::study {
namespace {

using Json = io::Json;
using mpm::Discretisation;

class MethodFailures {
 public:
  explicit MethodFailures(const input::StabilityInput& input) : quick_(input.quick) {}

  FailureMaps run() {
    Json& json = maps_.figures;
    json["cell_crossing"] =
        over_counts(maps_.cell_crossing, "cell_crossing",
                    [](const Discretisation& d) { return mpm::cell_crossing_error(d); });
    json["fracture_stretch"] = over_counts(maps_.fracture, "fracture", [](const Discretisation& d) {
      return mpm::fracture_stretch(d);
    });
    json["locking"] = locking();
    json["ringing"] = ringing();
    maps_.tables.push_back({"mpm_failures", csv_});
    return std::move(maps_);
  }

 private:
  template <class F>
  Json over_counts(std::vector<FailureCurve>& curves, const char* key, F&& measure) {
    Json json;
    for (const mpm::Kernel kernel : {mpm::Kernel::cubic, mpm::Kernel::quadratic})
      for (const mpm::Transfer transfer : {mpm::Transfer::relaxed, mpm::Transfer::apic}) {
        FailureCurve& curve = curves.emplace_back(FailureCurve{kernel, transfer, {}, {}});
        for (const int count : quick_ ? std::vector<int>{4} : std::vector<int>{1, 4, 9, 16}) {
          const double value = measure(Discretisation{kernel, transfer, count, 6.0});
          curve.counts.push_back(count);
          curve.values.push_back(value);
          const std::string name =
              fmt::format("{}_{}", mpm::name_of(kernel), mpm::name_of(transfer));
          csv_ += fmt::format("{},{},{},{},,{}\n", key, mpm::name_of(kernel),
                              mpm::name_of(transfer), count, value);
          json[name][fmt::format("{}", count)] = value;
        }
      }
    return json;
  }

  Json locking() {
    Json json;
    const std::vector<double> cells =
        quick_ ? std::vector<double>{4.0, 8.0} : std::vector<double>{4.0, 8.0, 16.0, 32.0};
    for (const double nu : {0.3, 0.49, quick_ ? 0.49 : 0.499}) {
      if (json.contains(fmt::format("nu_{}", nu))) continue;
      std::vector<double> y;
      for (const double n : cells) {
        y.push_back(mpm::bulge({mpm::Kernel::cubic, mpm::Transfer::relaxed, 4, n}, nu));
        csv_ += fmt::format("bulge_nu_{},cubic,relaxed,4,{},{}\n", nu, n, y.back());
        json[fmt::format("nu_{}", nu)][fmt::format("{}", n)] = y.back();
      }
      const double finest = y.back();
      for (double& b : y) b /= finest;
      maps_.locking.push_back({nu, cells, std::move(y)});
    }
    return json;
  }

  Json ringing() {
    Json json;
    for (const double h : quick_ ? std::vector<double>{0.05} : std::vector<double>{0.025, 0.0125}) {
      RingingCurve curve{h, {}, {}};
      for (const int count : quick_ ? std::vector<int>{4} : std::vector<int>{4, 9, 16}) {
        mpm::Scene scene = paper_scene(
            "flat_mu_i",
            {fmt::format("grid.h={}", h), fmt::format("grid.points_per_cell={}", count)});
        raise_top_to_cells(scene);
        const mpm::RestPressure rest = mpm::rest_pressure_after(scene);
        curve.counts.push_back(count);
        curve.percent.push_back(100.0 * rest.pressure.noise);
        csv_ += fmt::format("ringing,cubic,relaxed,{},{},{}\n", count, h, rest.pressure.noise);
        json[fmt::format("h_{}", h)][fmt::format("{}", count)] = rest.pressure.noise;
      }
      maps_.ringing.push_back(std::move(curve));
    }
    return json;
  }

  bool quick_;
  FailureMaps maps_;
  std::string csv_ = "failure,kernel,transfer,points_per_cell,cells_or_h,value\n";
};

}  // namespace

FailureMaps map_mpm(const input::StabilityInput& input) { return MethodFailures(input).run(); }

}  // namespace repose::study
