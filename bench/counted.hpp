#pragma once
/// \file
/// A number that counts what is done with it, so that the floating-point operations of a law are
/// counted by running the law itself.

#include <cmath>

#include "models/scalar.hpp"

namespace repose::bench {

/// + − × ÷ and √ count as one operation each; comparisons, selections, signs and the integer part
/// of an exponential as none. log and expm1 of a library count as what their polynomials take.
struct Counted {
  static constexpr double library_function = 25.0;
  inline static double flops = 0.0;

  double x = 0.0;
  Counted() = default;
  explicit Counted(double value) : x(value) {}

  friend Counted operator+(Counted a, Counted b) { return of(a.x + b.x); }
  friend Counted operator-(Counted a, Counted b) { return of(a.x - b.x); }
  friend Counted operator*(Counted a, Counted b) { return of(a.x * b.x); }
  friend Counted operator*(double a, Counted b) { return of(a * b.x); }
  friend Counted operator/(Counted a, Counted b) { return of(a.x / b.x); }
  friend Counted operator-(Counted a) { return Counted(-a.x); }
  friend bool operator<(Counted a, Counted b) { return a.x < b.x; }
  friend bool operator>(Counted a, Counted b) { return a.x > b.x; }
  friend bool operator<=(Counted a, Counted b) { return a.x <= b.x; }
  friend bool operator>=(Counted a, Counted b) { return a.x >= b.x; }
  friend bool operator==(Counted a, Counted b) { return a.x == b.x; }

  friend Counted sqrt(Counted a) { return of(std::sqrt(a.x)); }
  friend Counted exp(Counted a) { return library(std::exp(a.x)); }
  friend Counted log(Counted a) { return library(std::log(a.x)); }
  friend Counted expm1(Counted a) { return library(std::expm1(a.x)); }

  friend Counted select(bool mask, Counted a, Counted b) { return mask ? a : b; }
  friend Counted value(Counted a) { return a; }
  friend bool finite(Counted a) { return std::isfinite(a.x); }
  friend Counted power_of_two(Counted shifted) { return Counted(repose::power_of_two(shifted.x)); }

 private:
  static Counted of(double value) {
    flops += 1.0;
    return Counted(value);
  }
  static Counted library(double value) {
    flops += library_function;
    return Counted(value);
  }
};

}  // namespace repose::bench
