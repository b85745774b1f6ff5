#include "study/stability/step.hpp"

#include <cmath>

#include <fmt/core.h>

namespace repose::study {
namespace {

using Json = io::Json;
using mpm::Place;
using mpm::StepTrial;

std::string row(const StepTrial& t, const char* limit, double measured, double theory) {
  return fmt::format("{},{},{},{},{},{},{},{},{}\n", limit, t.solid ? "solid" : "fluid",
                     mpm::name_of(t.kernel), mpm::name_of(t.transfer), t.points_per_cell,
                     mpm::place_names[static_cast<std::size_t>(t.place)],
                     t.place == Place::isolated ? t.offset : std::nan(""), measured, theory);
}

class MapOfSteps {
 public:
  explicit MapOfSteps(const input::StabilityInput& input) : quick_(input.quick) {}

  StepMaps run() {
    in_a_box(Place::bulk);
    in_a_box(Place::surface);
    isolated();
    viscous();
    maps_.tables.push_back({"step_limits", csv_});
    maps_.least_in_bulk = least_["bulk"]["cubic"].get<double>();
    maps_.least_alone = least_["isolated"]["cubic"].get<double>();
    maps_.figures = Json{{"least_courant", least_}, {"viscous", viscous_}};
    return std::move(maps_);
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

  void in_a_box(Place place) {
    const std::vector<int> counts = quick_ ? std::vector<int>{4} : std::vector<int>{1, 4, 9, 16};
    for (const mpm::Kernel kernel : kernels()) {
      StepsInABox box{place, kernel, {counts.begin(), counts.end()}, {}, 0.0};
      for (const mpm::Transfer transfer : transfers()) {
        StepsInABox::Curve& curve = box.curves.emplace_back(StepsInABox::Curve{transfer, {}});
        for (const int count : counts) {
          const StepTrial t{kernel, transfer, count, place, 0.5, false};
          const double measured = mpm::blow_up_courant(t);
          csv_ += row(t, "wave", measured, mpm::courant_of_theory(t));
          note(t, measured);
          curve.measured.push_back(measured);
        }
      }
      box.theory =
          mpm::courant_of_theory({kernel, mpm::Transfer::apic, 4, Place::bulk, 0.5, false});
      maps_.in_a_box.push_back(std::move(box));
    }
  }

  void isolated() {
    const std::vector<double> offsets =
        quick_ ? std::vector<double>{0.0, 0.5} : std::vector<double>{0.0, 0.1, 0.25, 0.4, 0.5};
    for (const mpm::Kernel kernel : kernels())
      for (const bool solid : {false, true}) {
        StepsAlone alone{kernel, solid, offsets, {}, 0.0};
        for (const mpm::Transfer transfer : {mpm::Transfer::relaxed, mpm::Transfer::apic}) {
          StepsInABox::Curve& curve = alone.curves.emplace_back(StepsInABox::Curve{transfer, {}});
          for (const double offset : offsets) {
            const StepTrial t{kernel, transfer, 1, Place::isolated, offset, solid};
            const double measured = mpm::blow_up_courant(t);
            csv_ += row(t, "wave", measured, mpm::courant_of_theory(t));
            note(t, measured);
            curve.measured.push_back(measured);
          }
        }
        alone.theory =
            mpm::courant_of_theory({kernel, mpm::Transfer::apic, 1, Place::isolated, 0.5, solid});
        maps_.alone.push_back(std::move(alone));
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

  StepMaps maps_;
  bool quick_;
  std::string csv_ =
      "limit,material,kernel,transfer,points_per_cell,place,offset_h,measured,theory\n";
  Json least_, viscous_;
};

}  // namespace

StepMaps map_step(const input::StabilityInput& input) { return MapOfSteps(input).run(); }

std::string words_of(const StepMaps& maps) {
  return fmt::format(
      "step: stable in the bulk up to Courant {:.3g} (cubic), isolated up to {:.3g} (fluid)",
      maps.least_in_bulk, maps.least_alone);
}

}  // namespace repose::study
