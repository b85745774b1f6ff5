#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "models/all_laws.hpp"
#include "models/dual.hpp"
#include "pointdriver/integrate/dual_start.hpp"
#include "pointdriver/integrate/sensitivity.hpp"

namespace repose::point {
namespace {

/// CVODES, with its objects freed at the end of a scope.
struct Session {
  SUNContext context = nullptr;
  N_Vector y = nullptr;
  N_Vector* s = nullptr;
  void* memory = nullptr;
  SUNNonlinearSolver solver = nullptr, sensitivity_solver = nullptr;
  ~Session() {
    if (memory != nullptr) CVodeFree(&memory);
    if (sensitivity_solver != nullptr) SUNNonlinSolFree(sensitivity_solver);
    if (solver != nullptr) SUNNonlinSolFree(solver);
    if (s != nullptr) N_VDestroyVectorArray(s, 1);
    if (y != nullptr) N_VDestroy(y);
    if (context != nullptr) SUNContext_Free(&context);
  }
};

/// f(y, θ) and its directional derivative f_y s + f_θ by one dual number.
template <class L>
class Problem {
 public:
  using D = Dual<1>;
  using F = Flow<L, double>;
  using DF = Flow<L, D>;

  explicit Problem(const ElementStart<L, D>& start)
      : plain_parameters_(start.plain),
        flow_(plain_parameters_, start.density.a, false),
        dual_flow_(start.parameters, start.density, false) {
    flow_.set_plain(start.plain);
    dual_flow_.set_plain(start.plain);
    for (std::size_t i = 0; i < start.stress_and_state.size(); ++i)
      y_[i] = start.stress_and_state[i];
    for (std::size_t i = start.stress_and_state.size(); i < F::size; ++i) y_[i] = D(0.0);
  }

  void use(const Control& control) {
    flow_.use(control);
    dual_flow_.use(control);
    flow_.begin_leg(values(y_));
    dual_flow_.begin_leg(y_);
  }
  void on(Branch branch) { flow_.branch = dual_flow_.branch = branch; }

  static typename F::Y values(const typename DF::Y& y) {
    typename F::Y r;
    for (std::size_t i = 0; i < F::size; ++i) r[i] = y[i].a;
    return r;
  }
  static typename DF::Y joined(const double* y, const double* s) {
    typename DF::Y r;
    for (std::size_t i = 0; i < F::size; ++i) r[i] = D(y[i]);
    if (s != nullptr)
      for (std::size_t i = 0; i < F::size; ++i) r[i].v[0] = s[i];
    return r;
  }

  F& flow() { return flow_; }
  DF& dual_flow() { return dual_flow_; }
  const typename DF::Y& start() const { return y_; }

  static int rate(realtype, N_Vector y, N_Vector dy, void* user) {
    typename F::Y at, out;
    std::copy(N_VGetArrayPointer(y), N_VGetArrayPointer(y) + F::size, at.begin());
    if (!static_cast<Problem*>(user)->flow_.rate(at, out)) return 1;
    std::copy(out.begin(), out.end(), N_VGetArrayPointer(dy));
    return 0;
  }
  static int sensitivity_rate(int, realtype, N_Vector y, N_Vector, N_Vector* s, N_Vector* ds,
                              void* user, N_Vector, N_Vector) {
    typename DF::Y out;
    if (!static_cast<Problem*>(user)->dual_flow_.rate(
            joined(N_VGetArrayPointer(y), N_VGetArrayPointer(s[0])), out))
      return 1;
    for (std::size_t i = 0; i < F::size; ++i) N_VGetArrayPointer(ds[0])[i] = out[i].v[0];
    return 0;
  }
  static int yields(realtype, N_Vector y, realtype* g, void* user) {
    auto* problem = static_cast<Problem*>(user);
    typename F::Y at;
    std::copy(N_VGetArrayPointer(y), N_VGetArrayPointer(y) + F::size, at.begin());
    g[0] = problem->flow_.branch == Branch::elastic ? problem->flow_.yield(at) : -1.0;
    return 0;
  }

  /// s⁺ = s⁻ + (f⁻ − f⁺) dt*/dθ; the branch is plastic afterwards.
  bool jump(double* y, double* s) {
    const typename DF::Y at = joined(y, s);
    typename F::Y before, after;
    if (!flow_.rate(values(at), before)) return false;
    const D f = dual_flow_.yield(at);  // F_y s⁻ + F_θ in its dual part
    typename DF::Y along = at;
    for (std::size_t i = 0; i < F::size; ++i) along[i].v[0] = before[i];
    const double slope = flow_yield_slope(along);
    if (slope == 0.0) return false;
    const double dt = -f.v[0] / slope;
    on(Branch::plastic);
    if (!flow_.rate(values(at), after)) return false;
    for (std::size_t i = 0; i < F::size; ++i) s[i] += (before[i] - after[i]) * dt;
    return true;
  }

 private:
  /// F_y·f⁻: the parameters' own derivatives must not enter, so they are taken as constants.
  double flow_yield_slope(const typename DF::Y& along) const {
    constexpr std::size_t count = L::parameters.size();
    const auto plain = std::bit_cast<std::array<double, count>>(plain_parameters_);
    std::array<D, count> constants;
    for (std::size_t i = 0; i < count; ++i) constants[i] = D(plain[i]);
    const auto P = L::template Params<D>::from(std::span<const D>(constants));
    const Sym<D, 6> zero = Sym<D, 6>::isotropic(D(0.0));
    return L::yield(P, DF::stress(along), DF::state(along), D(1.0), zero).v[0];
  }

  typename L::template Params<double> plain_parameters_;
  F flow_;
  DF dual_flow_;
  typename DF::Y y_;
};

template <class L>
Status run(const ElementStart<L, Dual<1>>& start, const PointTest& test,
           std::vector<CvodesRow>& rows) {
  using P = Problem<L>;
  using F = typename P::F;
  const Leg& leg = test.path.legs.front();
  const LegSpec& spec = leg.spec();
  P problem(start);
  // the leg's direction and duration as any integrator sees them
  ElementStart<L, double> plain;
  plain.plain = plain.parameters = start.plain;
  for (std::size_t i = 0; i < plain.stress_and_state.size(); ++i)
    plain.stress_and_state[i] = start.stress_and_state[i].a;
  plain.density = start.density.a;
  const Readout<double> reading = make_readout(plain, test.path.frame);
  typename F::Y y0 = P::values(problem.start());
  LegRun<L, double> leg_run(problem.flow(), reading, test.path, 0, 0.0, y0, nullptr);
  if (leg_run.goal_is_event() || test.path.legs.size() != 1) return Status::unsupported;
  problem.use(problem.flow().control());
  if (const Status s = leg_run.decide_branch(y0); s != Status::completed) return s;
  problem.on(problem.flow().branch);

  Session session;
  const auto n = static_cast<sunindextype>(F::size);
  if (SUNContext_Create(nullptr, &session.context) != 0) throw std::bad_alloc();
  session.y = N_VNew_Serial(n, session.context);
  session.s = N_VCloneVectorArray(1, session.y);
  double* y = N_VGetArrayPointer(session.y);
  double* s = N_VGetArrayPointer(session.s[0]);
  for (std::size_t i = 0; i < F::size; ++i) {
    y[i] = problem.start()[i].a;
    s[i] = problem.start()[i].v[0];
  }
  session.memory = CVodeCreate(CV_ADAMS, session.context);
  void* m = session.memory;
  const double tolerance = test.settings.tolerance;
  const double p = F::stress_scale(y0);
  N_Vector absolute = N_VClone(session.y);
  for (std::size_t i = 0; i < F::size; ++i)
    N_VGetArrayPointer(absolute)[i] = tolerance * (i < F::i_strain ? p : 1e-3);
  int flag = CVodeInit(m, P::rate, 0.0, session.y);
  flag |= CVodeSetUserData(m, &problem);
  flag |= CVodeSVtolerances(m, tolerance, absolute);
  session.solver = SUNNonlinSol_FixedPoint(session.y, 0, session.context);
  flag |= CVodeSetNonlinearSolver(m, session.solver);
  flag |= CVodeSetMaxNumSteps(m, test.settings.max_steps);
  flag |= CVodeSensInit(m, 1, CV_STAGGERED, P::sensitivity_rate, session.s);
  flag |= CVodeSensSVtolerances(m, tolerance, &absolute);
  flag |= CVodeSetSensErrCon(m, SUNTRUE);
  session.sensitivity_solver = SUNNonlinSol_FixedPointSens(1, session.y, 0, session.context);
  flag |= CVodeSetNonlinearSolverSensStg(m, session.sensitivity_solver);
  flag |= CVodeRootInit(m, 1, P::yields);
  flag |= CVodeSetNoInactiveRootWarn(m);
  const double end = leg_run.duration();
  flag |= CVodeSetStopTime(m, end);
  Status status = flag == 0 ? Status::completed : Status::not_converged;
  double t = 0.0;
  for (int row = 1, events = 0; status == Status::completed && row <= spec.points;) {
    const double target = end * row / spec.points;
    const int answer = CVode(m, target, session.y, &t, CV_NORMAL);
    double at = t;
    if (answer < 0 || CVodeGetSens(m, &at, session.s) < 0) {
      status = Status::not_converged;
    } else if (answer == CV_ROOT_RETURN) {
      if (++events > 10 || !problem.jump(y, s)) status = Status::no_response;
      if (CVodeReInit(m, t, session.y) != 0 || CVodeSensReInit(m, CV_STAGGERED, session.s) != 0 ||
          CVodeSetStopTime(m, end) != 0)
        status = Status::not_converged;
    } else {
      CvodesRow out{t, {}, {}};
      for (std::size_t i = 0; i < 6; ++i) {
        out.stress.c[i] = y[i];
        out.derivative.c[i] = s[i];
      }
      rows.push_back(out);
      ++row;
    }
  }
  N_VDestroy(absolute);
  return status;
}

}  // namespace

Status cvodes_gradient(const LawInfo& law, std::span<const double> theta, int parameter,
                       const PointTest& test, std::vector<CvodesRow>& rows) {
  rows.clear();
  return visit_law(law, [&]<class L>(L) -> Status {
    if constexpr (!L::has_stress_memory || is_rate_dependent<L>()) {
      return Status::unsupported;
    } else {
      try {
        return run<L>(dual_start<L, Dual<1>>(theta, std::span(&parameter, 1), test), test, rows);
      } catch (const InputError&) {
        return Status::bad_initial;
      }
    }
  });
}

}  // namespace repose::point
