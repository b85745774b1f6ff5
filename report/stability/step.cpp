/// The largest stable step, measured, against theory.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mpm/study/blow_up.hpp"
#include "report/stability/part.hpp"

namespace repose::report {
namespace {

using Json = nlohmann::ordered_json;
using mpm::Place;
using mpm::StepTrial;

std::string row(const StepTrial& t, const char* limit, double measured, double theory) {
  return fmt::format("{},{},{},{},{},{},{},{},{}\n", limit, t.solid ? "solid" : "fluid",
                     mpm::name_of(t.kernel), mpm::name_of(t.transfer), t.points_per_cell,
                     mpm::place_names[static_cast<std::size_t>(t.place)],
                     t.place == Place::isolated ? t.offset : std::nan(""), measured, theory);
}

class StepMaps {
 public:
  StepMaps(const input::StabilityInput& input, PartOutput& out) : out_(out), quick_(input.quick) {}

  Json run() {
    Figure figure("Largest stable Courant number cΔt/h, measured by blow-up",
                  "dashed: theory of the bulk (two directions) and of an isolated point");
    figure.columns = 2;
    in_a_box(figure, Place::bulk);
    in_a_box(figure, Place::surface);
    isolated(figure);
    viscous();
    out_.table("step_limits.csv", csv_);
    out_.picture("step_limits.svg", figure);
    out_.tell(fmt::format(
        "step: stable in the bulk up to Courant {:.3g} (cubic), isolated up to "
        "{:.3g} (fluid)",
        least_["bulk"]["cubic"].get<double>(), least_["isolated"]["cubic"].get<double>()));
    return Json{{"least_courant", least_}, {"viscous", viscous_}};
  }

 private:
  std::vector<mpm::Transfer> transfers() const {
    using mpm::Transfer;
    if (quick_) return {Transfer::relaxed, Transfer::apic};
    return {Transfer::relaxed, Transfer::apic, Transfer::tpic, Transfer::aflip,
            Transfer::flip,    Transfer::pic,  Transfer::xpic};
  }
  std::vector<mpm::Kernel> kernels() const {
    if (quick_) return {mpm::Kernel::cubic};
    return {mpm::Kernel::cubic, mpm::Kernel::quadratic};
  }

  void note(const StepTrial& t, double measured) {
    Json& least = least_[std::string(mpm::place_names[static_cast<std::size_t>(t.place)])]
                        [std::string(mpm::name_of(t.kernel))];
    if (least.is_null() || measured < least.get<double>()) least = measured;
  }

  void in_a_box(Figure& figure, Place place) {
    const std::vector<int> counts = quick_ ? std::vector<int>{4} : std::vector<int>{1, 4, 9, 16};
    for (const mpm::Kernel kernel : kernels()) {
      Axes& axes = figure.add_axes();
      axes.title = fmt::format("{}, {}, fluid", place == Place::bulk ? "bulk" : "free surface",
                               mpm::name_of(kernel));
      axes.x = {"points per cell", AxisScale::linear, 0.0, 17.0};
      axes.y = {"cΔt/h", AxisScale::linear, 0.0, {}};
      axes.legend = Legend::right;
      for (const mpm::Transfer transfer : transfers()) {
        std::vector<double> x, y;
        for (const int count : counts) {
          const StepTrial t{kernel, transfer, count, place, 0.5, false};
          const double measured = mpm::blow_up_courant(t);
          csv_ += row(t, "wave", measured, mpm::courant_of_theory(t));
          note(t, measured);
          x.push_back(count);
          y.push_back(measured);
        }
        axes.line(std::string(mpm::name_of(transfer)), x, y,
                  {Colour::automatic, 1.5, Marker::circle, 5.0});
      }
      const double theory =
          mpm::courant_of_theory({kernel, mpm::Transfer::apic, 4, Place::bulk, 0.5, false});
      const std::vector<double> ends{0.0, 17.0}, level{theory, theory};
      axes.dashed("theory", ends, level, {Colour::black, 1.2});
    }
  }

  void isolated(Figure& figure) {
    const std::vector<double> offsets =
        quick_ ? std::vector<double>{0.0, 0.5} : std::vector<double>{0.0, 0.1, 0.25, 0.4, 0.5};
    for (const mpm::Kernel kernel : kernels()) {
      Axes& axes = figure.add_axes();
      axes.title = fmt::format("isolated point, {}", mpm::name_of(kernel));
      axes.x.label = "position in its cell (h)";
      axes.y = {"cΔt/h", AxisScale::linear, 0.0, {}};
      axes.legend = Legend::right;
      for (const bool solid : {false, true}) {
        for (const mpm::Transfer transfer : {mpm::Transfer::relaxed, mpm::Transfer::apic}) {
          std::vector<double> y;
          for (const double offset : offsets) {
            const StepTrial t{kernel, transfer, 1, Place::isolated, offset, solid};
            y.push_back(mpm::blow_up_courant(t));
            csv_ += row(t, "wave", y.back(), mpm::courant_of_theory(t));
            note(t, y.back());
          }
          axes.line(fmt::format("{}, {}", solid ? "solid" : "fluid", mpm::name_of(transfer)),
                    offsets, y, {Colour::automatic, 1.5, Marker::circle, 5.0});
        }
        const double theory =
            mpm::courant_of_theory({kernel, mpm::Transfer::apic, 1, Place::isolated, 0.5, solid});
        const std::vector<double> ends{0.0, 0.5}, level{theory, theory};
        axes.dashed(fmt::format("theory, {}", solid ? "solid" : "fluid"), ends, level,
                    {Colour::automatic, 1.2});
      }
    }
  }

  void viscous() {
    viscous_ = Json::array();
    for (const mpm::Kernel kernel : kernels())
      for (const int count : quick_ ? std::vector<int>{4} : std::vector<int>{1, 4, 9}) {
        const StepTrial t{kernel, mpm::Transfer::apic, count, Place::bulk, 0.5, false};
        const double measured = mpm::blow_up_viscous(t);
        csv_ += row(t, "viscous", measured, std::nan(""));
        viscous_.push_back({{"kernel", mpm::name_of(kernel)},
                            {"points_per_cell", count},
                            {"dt_over_rho_h2_per_4_eta", measured},
                            {"implicit_stable_at_30", mpm::implicit_viscosity_is_stable(t, 30.0)}});
      }
  }

  PartOutput& out_;
  bool quick_;
  std::string csv_ =
      "limit,material,kernel,transfer,points_per_cell,place,offset_h,measured,theory\n";
  Json least_, viscous_;
};

}  // namespace

Json map_step(const input::StabilityInput& input, PartOutput& out) {
  return StepMaps(input, out).run();
}

}  // namespace repose::report
