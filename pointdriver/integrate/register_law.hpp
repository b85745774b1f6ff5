#pragma once
/// \file
/// Makes a law's type known by its name, point driver and all: what register_law() of
/// models/register_law.hpp does, and the integrators compiled for the law, in plain and in dual
/// numbers. One source of a program includes this (it takes a minute to compile) and calls
/// `repose::point::register_law<MyLaw>()`; examples/own_law.cpp shows one.

#include "models/register_law.hpp"
#include "pointdriver/integrate/outside_driver.hpp"
#include "pointdriver/integrate/plain_rows.hpp"
#include "pointdriver/integrate/start.hpp"

namespace repose::point {

template <class L>
class DriverOf final : public OutsideDriver {
 public:
  Method method_for(Method method) const override { return chosen_method<L>(method); }

  std::vector<double> start(std::span<const double> theta, const PointTest& test) const override {
    return flat_start<L>(theta, test);
  }

  Outcome drive(std::span<const double> numbers, const PointTest& test,
                Curve& curve) const override {
    return drive_path<L, double>(lifted<double>(numbers, numbers), test.path, test.settings, curve);
  }

  Outcome drive(std::span<const double> numbers, std::span<const double> slopes,
                const PointTest& test, Curve& curve,
                std::vector<Curve>& slope_curves) const override {
    using D = Dual<static_cast<int>(slope_width)>;
    std::vector<D> dual(numbers.begin(), numbers.end());
    for (std::size_t k = 0; k < slope_width; ++k)
      for (std::size_t i = 0; i < dual.size(); ++i)
        dual[i].v[static_cast<int>(k)] = slopes[k * dual.size() + i];
    BasicCurve<D> driven;
    const Outcome outcome =
        drive_path<L, D>(lifted<D>(dual, numbers), test.path, test.settings, driven);
    split(driven, curve, slope_curves);
    return outcome;
  }

 private:
  template <class T>
  static ElementStart<L, T> lifted(std::span<const T> numbers, std::span<const double> plain) {
    constexpr std::size_t n = L::parameters.size();
    ElementStart<L, T> start;
    start.parameters = L::template Params<T>::from(numbers.first(n));
    start.plain = L::template Params<double>::from(plain.first(n));
    for (std::size_t i = 0; i < start.stress_and_state.size(); ++i)
      start.stress_and_state[i] = numbers[n + i];
    start.density = numbers.back();
    return start;
  }
};

/// The entry of the registry for a law's type.
template <class L>
OutsideLaw outside_law() {
  OutsideLaw law = repose::outside_law<L>();
  law.point = std::make_shared<DriverOf<Compiled<L>>>();
  return law;
}

/// The forms of one law; the first is the default. Throws InputError (key "name") where the name is
/// taken; see register_law(forms) of models/registry.hpp.
template <class... Forms>
void register_law() {
  repose::register_law(std::vector<OutsideLaw>{point::outside_law<Forms>()...});
}

}  // namespace repose::point
