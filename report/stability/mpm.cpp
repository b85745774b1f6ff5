/// Cell crossing, numerical fracture, locking and ringing as numbers.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mpm/study/failure_modes.hpp"
#include "report/stability/part.hpp"

namespace repose::report {
namespace {

using Json = nlohmann::ordered_json;
using mpm::Discretisation;

class MethodFailures {
 public:
  MethodFailures(const input::StabilityInput& input, PartOutput& out)
      : out_(out),
        quick_(input.quick) {}

  Json run() {
    Figure figure("Failures of the method over points per cell and cell size");
    figure.columns = 2;
    Json json;
    json["cell_crossing"] =
        over_counts(figure, "cell crossing", "rms error of the density, stretched by half",
                    "cell_crossing", AxisScale::logarithmic,
                    [](const Discretisation& d) { return mpm::cell_crossing_error(d); });
    json["fracture_stretch"] = over_counts(
        figure, "numerical fracture", "stretch at which the density is off by 10 %", "fracture",
        AxisScale::linear, [](const Discretisation& d) { return mpm::fracture_stretch(d); });
    json["locking"] = locking(figure);
    json["ringing"] = ringing(figure);
    out_.table("mpm_failures.csv", csv_);
    out_.picture("mpm_failures.svg", figure);
    return json;
  }

 private:
  template <class F>
  Json over_counts(Figure& figure, const char* title, const char* label, const char* key,
                   AxisScale scale, F&& measure) {
    Axes& axes = figure.add_axes();
    axes.title = title;
    axes.x = {"points per cell", AxisScale::linear, 0.0, 17.0};
    axes.y = {label, scale};
    Json json;
    for (const mpm::Kernel kernel : {mpm::Kernel::cubic, mpm::Kernel::quadratic})
      for (const mpm::Transfer transfer : {mpm::Transfer::relaxed, mpm::Transfer::apic}) {
        std::vector<double> x, y;
        for (const int count : quick_ ? std::vector<int>{4} : std::vector<int>{1, 4, 9, 16}) {
          const double value = measure(Discretisation{kernel, transfer, count, 6.0});
          x.push_back(count);
          y.push_back(value);
          const std::string name =
              fmt::format("{}_{}", mpm::name_of(kernel), mpm::name_of(transfer));
          csv_ += fmt::format("{},{},{},{},,{}\n", key, mpm::name_of(kernel),
                              mpm::name_of(transfer), count, value);
          json[name][fmt::format("{}", count)] = value;
        }
        axes.line(fmt::format("{}, {}", mpm::name_of(kernel), mpm::name_of(transfer)), x, y,
                  {Colour::automatic, 1.6, Marker::circle, 5.0});
      }
    return json;
  }

  Json locking(Figure& figure) {
    Axes& axes = figure.add_axes();
    axes.title = "locking: bulge of a block under its weight";
    axes.x = {"cells across the block", AxisScale::logarithmic};
    axes.y.label = "over that of the finest, compressible";
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
      axes.line(fmt::format("ν = {}", nu), cells, y, {Colour::automatic, 1.6, Marker::circle, 5.0});
    }
    axes.y.label = "bulge over that of the finest cells";
    return json;
  }

  Json ringing(Figure& figure) {
    Axes& axes = figure.add_axes();
    axes.title = "ringing: pressure noise of the heap at rest";
    axes.x = {"points per cell", AxisScale::linear, 0.0, 17.0};
    axes.y = {"noise of p over the overburden, rms (%)", AxisScale::linear, 0.0, {}};
    Json json;
    for (const double h : quick_ ? std::vector<double>{0.05} : std::vector<double>{0.025, 0.0125}) {
      std::vector<double> x, y;
      for (const int count : quick_ ? std::vector<int>{4} : std::vector<int>{4, 9, 16}) {
        mpm::Scene scene = paper_scene(
            "flat_mu_i",
            {fmt::format("grid.h={}", h), fmt::format("grid.points_per_cell={}", count)});
        raise_top_to_cells(scene);
        const mpm::RestPressure rest = mpm::rest_pressure_after(scene);
        x.push_back(count);
        y.push_back(100.0 * rest.pressure.noise);
        csv_ += fmt::format("ringing,cubic,relaxed,{},{},{}\n", count, h, rest.pressure.noise);
        json[fmt::format("h_{}", h)][fmt::format("{}", count)] = rest.pressure.noise;
      }
      axes.line(fmt::format("h = {} m", h), x, y, {Colour::automatic, 1.6, Marker::circle, 5.0});
    }
    return json;
  }

  PartOutput& out_;
  bool quick_;
  std::string csv_ = "failure,kernel,transfer,points_per_cell,cells_or_h,value\n";
};

}  // namespace

Json map_mpm(const input::StabilityInput& input, PartOutput& out) {
  const Json j = MethodFailures(input, out).run();
  out.tell("mpm: cell crossing, fracture, locking, ringing in mpm_failures.csv");
  return j;
}

}  // namespace repose::report
