#pragma once
/// \file
/// SUNDIALS behind one small interface: a smooth stretch of a differential (or differential-
/// algebraic) system, advanced to given times or to the first event. Nothing here knows laws.

#include <memory>

#include "pointdriver/path/settings.hpp"

namespace repose::point {

/// A system that is smooth between events; the caller changes branch and starts again.
class SmoothSystem {
 public:
  virtual ~SmoothSystem() = default;
  virtual int size() const = 0;
  /// dy/dt; false where the law gives no rate (the solver then tries a shorter step). cvode,
  /// arkode.
  virtual bool rate(const double* y, double* dy) = 0;
  /// r(y, y′); false as for rate(). ida.
  virtual bool residual(const double* y, const double* dy, double* r) = 0;
  /// Which unknowns have a derivative in the residual (the others are algebraic). ida.
  virtual bool differential(int i) const = 0;
  /// Absolute size below which an error in component i does not count, times 1/tolerance.
  virtual void sizes(const double* y, double* size) const = 0;
  virtual int event_count() const = 0;
  /// Event functions, < 0 until the event happens.
  virtual bool events(double t, const double* y, double* g) = 0;
};

/// What advance() came back with.
struct Advance {
  enum class Kind : unsigned char {
    reached,
    event,
    step_limit,
    underflow,
    no_convergence,
    no_rate
  };
  Kind kind = Kind::reached;
  int event = -1;
};

class SundialsSolver {
 public:
  virtual ~SundialsSolver() = default;
  /// (Re)starts at t from y (and, for ida, consistent y′). `end`: never to be stepped beyond.
  virtual void start(double t, double end, const double* y, const double* dy) = 0;
  /// To t_out or the first event, whichever comes first; t and y are where it stopped.
  virtual Advance advance(double t_out, double& t, double* y) = 0;
  /// Internal steps and evaluations so far.
  virtual long steps() const = 0;
  virtual long evaluations() const = 0;
};

/// cvode: Adams with functional iteration, or BDF with Newton where `stiff`; ida: BDF;
/// arkode: diagonally implicit Runge-Kutta of order 4. Errors: std::bad_alloc.
std::unique_ptr<SundialsSolver> make_solver(Method method, SmoothSystem& system, double tolerance,
                                            long max_steps, bool stiff);

}  // namespace repose::point
