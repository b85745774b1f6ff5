#pragma once
/// \file
/// The point driver's front door: a law's parameters and a test in, a curve out.
///
/// ```cpp
/// #include <repose/models/registry.hpp>
/// const LawSpec spec{"neo_hookean", {}, {{"E", 1e6}, {"nu", 0.3}, {"rho_0", 1000.0}}};
/// const LawInfo& law = find_law(spec);
/// const std::vector<double> theta = checked_parameters(spec);
/// point::Stage stage;  // drained triaxial compression, unless told otherwise
/// stage.goal = point::Goal{point::Quantity::eps_a, 0.1};
/// point::PointTest test;
/// test.path = point::path_of({stage});
/// test.initial.p = 1e3;
/// point::Curve curve;
/// point::simulate(law, theta, test, curve);  // reuse the curve: no further allocation
/// for (const auto& row : curve.rows) std::printf("%g\n", row.stress.c[1]);
/// std::vector<double> q;
/// point::read_column(law, theta, test, curve, point::Quantity::q, q);
/// ```

#include "models/material.hpp"
#include "pointdriver/path/laboratory.hpp"
#include "pointdriver/path/path.hpp"
#include "pointdriver/path/settings.hpp"

namespace repose::point {

struct PointTest {
  Path path;
  InitialConditions initial;
  Settings settings;
};

/// Drives the law of `law` (an entry of all_laws()) with parameters `theta` along the test. Absent
/// optional parameters may be NaN. Ranges of single parameters are not checked here. Never throws
/// for numbers and never loops without bound: see Outcome; explain() puts it in words. Allocates
/// nothing but what the curve's memory and the law's initial state need. Throws InputError (key
/// "name") for a law that is unknown or was registered without a point driver.
Outcome simulate(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                 Curve& curve);

/// Reads one quantity off every row. NaN where the law or test has none.
void read_column(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                 const Curve& curve, Quantity quantity, std::vector<double>& values);

/// The columns of curve.csv that apply to this law and test, in the interface's order.
std::vector<Quantity> columns_of(const LawInfo& law, const PointTest& test);

/// The outcome in words: what happened, where, and how much of the path is done.
std::string explain(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                    const Curve& curve);

/// The method that runs if the test says `automatic` (or `adaptive`, for a law without stress
/// memory).
Method method_for(const LawInfo& law, Method method);
std::string_view name_of(Method method);
std::optional<Method> find_method(std::string_view name);

/// Checks the test's start against the law. Throws InputError, also if the initial stress does not
/// suit the path (a triaxial test needs equal radial stresses and no shear).
void check_start(const LawInfo& law, std::span<const double> theta, const PointTest& test);

/// A quantity of the start, before anything is driven. Errors: InputError where the law cannot
/// start from the conditions.
double start_value(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                   Quantity quantity);

}  // namespace repose::point
