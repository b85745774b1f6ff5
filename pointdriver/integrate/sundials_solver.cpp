#include "pointdriver/integrate/sundials_solver.hpp"

#include <cmath>
#include <new>
#include <vector>

#include <arkode/arkode_arkstep.h>
#include <cvodes/cvodes.h>
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

namespace repose::point {
namespace {

/// The objects every solver needs, freed in reverse order.
class Workspace {
 public:
  Workspace(SmoothSystem& of, double tolerance_of) : system(&of), tolerance(tolerance_of) {
    if (SUNContext_Create(nullptr, &context) != 0) throw std::bad_alloc();
    const auto n = static_cast<sunindextype>(of.size());
    y = N_VNew_Serial(n, context);
    dy = N_VNew_Serial(n, context);
    matrix = SUNDenseMatrix(n, n, context);
    if (y == nullptr || dy == nullptr || matrix == nullptr) throw std::bad_alloc();
    linear = SUNLinSol_Dense(y, matrix, context);
    if (linear == nullptr) throw std::bad_alloc();
  }
  ~Workspace() {
    if (nonlinear != nullptr) SUNNonlinSolFree(nonlinear);
    SUNLinSolFree(linear);
    SUNMatDestroy(matrix);
    N_VDestroy(dy);
    N_VDestroy(y);
    SUNContext_Free(&context);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  void load(const double* from, const double* rate) const {
    double* to = N_VGetArrayPointer(y);
    double* to_rate = N_VGetArrayPointer(dy);
    for (int i = 0; i < system->size(); ++i) {
      to[i] = from[i];
      to_rate[i] = rate == nullptr ? 0.0 : rate[i];
    }
  }
  void store(double* to) const {
    const double* from = N_VGetArrayPointer(y);
    for (int i = 0; i < system->size(); ++i) to[i] = from[i];
  }

  SmoothSystem* system;
  double tolerance;
  SUNContext context = nullptr;
  N_Vector y = nullptr, dy = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNNonlinearSolver nonlinear = nullptr;
};

Workspace& work_of(void* user) { return *static_cast<Workspace*>(user); }
const double* data(N_Vector v) { return N_VGetArrayPointer(v); }

int rate_callback(realtype, N_Vector y, N_Vector dy, void* user) {
  return work_of(user).system->rate(data(y), N_VGetArrayPointer(dy)) ? 0 : 1;
}
int residual_callback(realtype, N_Vector y, N_Vector dy, N_Vector r, void* user) {
  return work_of(user).system->residual(data(y), data(dy), N_VGetArrayPointer(r)) ? 0 : 1;
}
int event_callback(realtype t, N_Vector y, realtype* g, void* user) {
  return work_of(user).system->events(t, data(y), g) ? 0 : -1;
}
int ida_event_callback(realtype t, N_Vector y, N_Vector, realtype* g, void* user) {
  return event_callback(t, y, g, user);
}
/// weights 1/(tolerance × size), the same sizes as the adaptive method uses
int weight_callback(N_Vector y, N_Vector weight, void* user) {
  const Workspace& work = work_of(user);
  double* w = N_VGetArrayPointer(weight);
  work.system->sizes(data(y), w);
  for (int i = 0; i < work.system->size(); ++i) {
    if (!(w[i] > 0.0) || !std::isfinite(w[i])) return -1;
    w[i] = 1.0 / (work.tolerance * w[i]);
  }
  return 0;
}
void quiet(int, const char*, const char*, char*, void*) {}

void check(int flag) {
  if (flag < 0) throw std::bad_alloc();
}
void check(const void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
}

/// The first event that fired upwards, in table order.
int fired(const std::vector<int>& flags) {
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i] > 0) return static_cast<int>(i);
  return -1;
}

/// Of one step, before a solver gives up. The default of 7 to 10 lets a step shrink by some 5
/// decades; where the flow of a slow test sets in, it must by more.
constexpr int most_failures = 40;

class Cvode final : public SundialsSolver {
 public:
  Cvode(SmoothSystem& system, double tolerance, long max_steps, bool stiff)
      : work_(system, tolerance),
        memory_(CVodeCreate(stiff ? CV_BDF : CV_ADAMS, work_.context)),
        flags_(static_cast<std::size_t>(system.event_count())) {
    check(memory_);
    std::vector<double> zero(static_cast<std::size_t>(system.size()), 1.0);
    work_.load(zero.data(), nullptr);
    check(CVodeInit(memory_, rate_callback, 0.0, work_.y));
    check(CVodeSetErrHandlerFn(memory_, quiet, nullptr));
    check(CVodeSetUserData(memory_, &work_));
    check(CVodeWFtolerances(memory_, weight_callback));
    if (stiff) {
      check(CVodeSetLinearSolver(memory_, work_.linear, work_.matrix));
      // A Jacobian that is some steps old may be far too stiff (the flow of a critical-state law
      // sets in at a rate like 1/q): Newton's corrections are then too small, pass for convergence,
      // and the solution is 1e-3 off at a tolerance of 1e-10. A fresh one takes fewer steps, too.
      check(CVodeSetLSetupFrequency(memory_, 1));
      check(CVodeSetJacEvalFrequency(memory_, 1));
    } else {
      work_.nonlinear = SUNNonlinSol_FixedPoint(work_.y, 0, work_.context);
      check(CVodeSetNonlinearSolver(memory_, work_.nonlinear));
    }
    check(CVodeSetMaxNumSteps(memory_, max_steps));
    check(CVodeSetMaxErrTestFails(memory_, most_failures));
    check(CVodeSetMaxConvFails(memory_, most_failures));
    check(CVodeRootInit(memory_, system.event_count(), event_callback));
    std::vector<int> up(flags_.size(), 1);
    check(CVodeSetRootDirection(memory_, up.data()));
    check(CVodeSetNoInactiveRootWarn(memory_));
  }
  ~Cvode() override { CVodeFree(&memory_); }

  void start(double t, double end, const double* y, const double*) override {
    note();
    work_.load(y, nullptr);
    check(CVodeReInit(memory_, t, work_.y));
    check(CVodeSetStopTime(memory_, end));
  }

  Advance advance(double t_out, double& t, double* y) override {
    using Kind = Advance::Kind;
    const int flag = CVode(memory_, t_out, work_.y, &t, CV_NORMAL);
    work_.store(y);
    if (flag == CV_ROOT_RETURN) {
      check(CVodeGetRootInfo(memory_, flags_.data()));
      return {Kind::event, fired(flags_)};
    }
    if (flag >= 0) return {Kind::reached, -1};
    if (flag == CV_TOO_MUCH_WORK) return {Kind::step_limit, -1};
    if (flag == CV_ERR_FAILURE || flag == CV_TOO_MUCH_ACC || flag == CV_TOO_CLOSE)
      return {Kind::underflow, -1};
    if (flag == CV_CONV_FAILURE || flag == CV_LSETUP_FAIL || flag == CV_LSOLVE_FAIL)
      return {Kind::no_convergence, -1};
    return {Kind::no_rate, -1};
  }
  long steps() const override {
    long n = 0;
    CVodeGetNumSteps(memory_, &n);
    return steps_before_ + n;
  }
  long evaluations() const override {
    long n = 0;
    CVodeGetNumRhsEvals(memory_, &n);
    return evaluations_before_ + n;
  }

 private:
  void note() {  // ReInit clears the counters
    steps_before_ = steps();
    evaluations_before_ = evaluations();
  }
  Workspace work_;
  void* memory_;
  std::vector<int> flags_;
  long steps_before_ = 0, evaluations_before_ = 0;
};

class Ida final : public SundialsSolver {
 public:
  Ida(SmoothSystem& system, double tolerance, long max_steps)
      : work_(system, tolerance),
        memory_(IDACreate(work_.context)),
        flags_(static_cast<std::size_t>(system.event_count())) {
    check(memory_);
    std::vector<double> one(static_cast<std::size_t>(system.size()), 1.0);
    work_.load(one.data(), nullptr);
    check(IDAInit(memory_, residual_callback, 0.0, work_.y, work_.dy));
    check(IDASetErrHandlerFn(memory_, quiet, nullptr));
    check(IDASetUserData(memory_, &work_));
    check(IDAWFtolerances(memory_, weight_callback));
    check(IDASetLinearSolver(memory_, work_.linear, work_.matrix));
    check(IDASetMaxNumSteps(memory_, max_steps));
    check(IDASetMaxErrTestFails(memory_, most_failures));
    check(IDASetMaxConvFails(memory_, most_failures));
    check(IDARootInit(memory_, system.event_count(), ida_event_callback));
    std::vector<int> up(flags_.size(), 1);
    check(IDASetRootDirection(memory_, up.data()));
    check(IDASetNoInactiveRootWarn(memory_));
    id_ = N_VClone(work_.y);
    check(id_);
    for (int i = 0; i < system.size(); ++i)
      N_VGetArrayPointer(id_)[i] = system.differential(i) ? 1.0 : 0.0;
    check(IDASetId(memory_, id_));
    check(IDASetSuppressAlg(memory_, SUNTRUE));
  }
  ~Ida() override {
    N_VDestroy(id_);
    IDAFree(&memory_);
  }

  void start(double t, double end, const double* y, const double* dy) override {
    steps_before_ = steps();
    evaluations_before_ = evaluations();
    work_.load(y, dy);
    check(IDAReInit(memory_, t, work_.y, work_.dy));
    check(IDASetStopTime(memory_, end));
  }

  Advance advance(double t_out, double& t, double* y) override {
    using Kind = Advance::Kind;
    const int flag = IDASolve(memory_, t_out, &t, work_.y, work_.dy, IDA_NORMAL);
    work_.store(y);
    if (flag == IDA_ROOT_RETURN) {
      check(IDAGetRootInfo(memory_, flags_.data()));
      return {Kind::event, fired(flags_)};
    }
    if (flag >= 0) return {Kind::reached, -1};
    if (flag == IDA_TOO_MUCH_WORK) return {Kind::step_limit, -1};
    if (flag == IDA_ERR_FAIL || flag == IDA_TOO_MUCH_ACC) return {Kind::underflow, -1};
    if (flag == IDA_CONV_FAIL || flag == IDA_LSETUP_FAIL || flag == IDA_LSOLVE_FAIL)
      return {Kind::no_convergence, -1};
    return {Kind::no_rate, -1};
  }
  long steps() const override {
    long n = 0;
    IDAGetNumSteps(memory_, &n);
    return steps_before_ + n;
  }
  long evaluations() const override {
    long n = 0, for_jacobian = 0;
    IDAGetNumResEvals(memory_, &n);
    IDAGetNumLinResEvals(memory_, &for_jacobian);
    return evaluations_before_ + n + for_jacobian;
  }

 private:
  Workspace work_;
  void* memory_;
  N_Vector id_ = nullptr;
  std::vector<int> flags_;
  long steps_before_ = 0, evaluations_before_ = 0;
};

class Arkode final : public SundialsSolver {
 public:
  Arkode(SmoothSystem& system, double tolerance, long max_steps)
      : work_(system, tolerance),
        flags_(static_cast<std::size_t>(system.event_count())) {
    std::vector<double> one(static_cast<std::size_t>(system.size()), 1.0);
    work_.load(one.data(), nullptr);
    memory_ = ARKStepCreate(nullptr, rate_callback, 0.0, work_.y, work_.context);
    check(memory_);
    check(ARKStepSetErrHandlerFn(memory_, quiet, nullptr));
    check(ARKStepSetUserData(memory_, &work_));
    check(ARKStepWFtolerances(memory_, weight_callback));
    check(ARKStepSetLinearSolver(memory_, work_.linear, work_.matrix));
    check(ARKStepSetOrder(memory_, 4));
    check(ARKStepSetMaxNumSteps(memory_, max_steps));
    check(ARKStepRootInit(memory_, system.event_count(), event_callback));
    std::vector<int> up(flags_.size(), 1);
    check(ARKStepSetRootDirection(memory_, up.data()));
    check(ARKStepSetNoInactiveRootWarn(memory_));
  }
  ~Arkode() override { ARKStepFree(&memory_); }

  void start(double t, double end, const double* y, const double*) override {
    work_.load(y, nullptr);
    check(ARKStepReset(memory_, t, work_.y));
    check(ARKStepSetInitStep(memory_, 0.0));
    check(ARKStepSetStopTime(memory_, end));
    end_ = end;
  }

  Advance advance(double t_out, double& t, double* y) override {
    using Kind = Advance::Kind;
    const int flag = ARKStepEvolve(memory_, t_out, work_.y, &t, ARK_NORMAL);
    work_.store(y);
    if (flag == ARK_ROOT_RETURN) {
      check(ARKStepGetRootInfo(memory_, flags_.data()));
      return {Kind::event, fired(flags_)};
    }
    if (flag >= 0) return {Kind::reached, -1};
    if (flag == ARK_TOO_MUCH_WORK) return {Kind::step_limit, -1};
    if (flag == ARK_ERR_FAILURE || flag == ARK_TOO_MUCH_ACC || flag == ARK_TOO_CLOSE)
      return {Kind::underflow, -1};
    if (flag == ARK_CONV_FAILURE || flag == ARK_LSETUP_FAIL || flag == ARK_LSOLVE_FAIL)
      return {Kind::no_convergence, -1};
    return {Kind::no_rate, -1};
  }
  long steps() const override {
    long n = 0;
    ARKStepGetNumSteps(memory_, &n);
    return n;
  }
  long evaluations() const override {
    long explicit_part = 0, implicit_part = 0;
    ARKStepGetNumRhsEvals(memory_, &explicit_part, &implicit_part);
    return explicit_part + implicit_part;
  }

 private:
  Workspace work_;
  void* memory_ = nullptr;
  std::vector<int> flags_;
  double end_ = 0.0;
};

}  // namespace

std::unique_ptr<SundialsSolver> make_solver(Method method, SmoothSystem& system, double tolerance,
                                            long max_steps, bool stiff) {
  if (method == Method::ida) return std::make_unique<Ida>(system, tolerance, max_steps);
  if (method == Method::arkode) return std::make_unique<Arkode>(system, tolerance, max_steps);
  return std::make_unique<Cvode>(system, tolerance, max_steps, stiff);
}

}  // namespace repose::point
