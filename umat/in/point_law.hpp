#pragma once
/// \file
/// A UMAT in the shape in which the point driver takes a law (models/law.hpp): its update calls the
/// library, and the derivatives of the stress come from DDSDDE.

#include <optional>

#include "models/dual.hpp"
#include "umat/in/abaqus_order.hpp"
#include "umat/in/host_pool.hpp"
#include "umat/in/library_law.hpp"

namespace repose::umat {

/// What one path of a UMAT goes through: a process, the last call, and what went wrong.
class Session {
 public:
  using State = std::array<double, most_state_variables>;

  Session(const Description& description, std::span<const double> props, bool checks_tangent);

  /// A call and its answer. Stress in the order of Sym, tension positive.
  struct Call {
    Sym<double, 6> strain;
    double dt = 0.0;
    Sym<double, 6> stress;
    State state{};
  };
  struct Answer {
    Sym<double, 6> stress;
    State state{};
    std::array<double, 36> ddsdde{};
  };

  /// The update over a step. Null where the UMAT finds the step too large (PNEWDT < 1) or has
  /// failed, which is then failure(). A call that is the last one again is answered from memory.
  const Answer* update(const Call& call);

  /// Compares the tangent of the last answer with differences of the update, and counts.
  void check_tangent();

  /// A failure is forgotten: a path is driven once to find its length, and once for its rows.
  void forget_failure() { failure_.reset(); }
  const std::optional<Failure>& failure() const { return failure_; }
  /// Whether the last call asked for a smaller increment.
  bool wants_less() const { return wants_less_; }
  bool checks_tangent() const { return checks_; }
  const Layout& layout() const { return at_; }
  long tangents_checked = 0, tangents_off = 0;

 private:
  void put(const Call& call, const Sym<double, 6>& strain, std::size_t i);
  /// False: see failure().
  bool run(std::size_t count);

  Description description_;
  Layout at_;
  std::vector<double> props_;
  bool checks_;
  std::optional<HostLease> host_;
  std::optional<Failure> failure_;
  Call last_;
  Answer answer_;
  bool has_answer_ = false;
  bool wants_less_ = false;
};

/// The law. As far as the driver's way of integrating goes it has no rate form, so that the driver
/// takes it for a law without stress memory: its update is all there is.
struct PointLaw {
  static constexpr std::string_view name = law_name;
  static constexpr bool has_stress_memory = false;
  static constexpr std::array<StateField, most_state_variables> state{};
  /// Newton ends here: a UMAT's tangent is seldom exact to more, and every round is a call.
  static constexpr double control_goal = 1e-10;
  /// And this is taken where the UMAT's own substepping makes the answer jump.
  static constexpr double control_enough = 1e-8;

  template <class T>
  struct Params {
    Session* session = nullptr;
    T rho_p{0.0};  ///< for the specific volume
  };
  template <class T>
  using State = std::array<T, most_state_variables>;

  template <class S>
  static Params<S> lifted(const Params<double>& P) {
    return {P.session, S(P.rho_p)};
  }
  static void begin_leg(const Params<double>& P) { P.session->forget_failure(); }
  static bool broken(const Params<double>& P) { return P.session->failure().has_value(); }

  /// True: not updated. In dual numbers the stress has the derivatives that DDSDDE gives it.
  template <class T>
  static bool update(const Params<T>& P, const Increment<T, 6>& increment, Sym<T, 6>& stress,
                     State<T>& at, StepWork<T>* spent = nullptr) {
    Session& session = *P.session;
    Session::Call call;
    call.dt = value(increment.dt);
    for (int i = 0; i < 6; ++i) {
      call.strain[i] = value(increment.strain[i]);
      call.stress[i] = value(stress[i]);
    }
    for (std::size_t i = 0; i < at.size(); ++i) call.state[i] = value(at[i]);
    const Session::Answer* const answer = session.update(call);
    if (answer == nullptr) return true;
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = T(answer->state[i]);
    for (int i = 0; i < 6; ++i) {
      stress[i] = T(answer->stress[i]);
      if constexpr (ScalarTraits<T>::is_dual)
        for (int j = 0; j < 6; ++j)
          stress[i].v += tangent<6>(answer->ddsdde.data(), i, j) * increment.strain[j].v;
    }
    if constexpr (std::is_same_v<T, double>)
      if (spent != nullptr) {
        const Layout& in = session.layout();
        const double work = 0.5 * contract(call.stress + answer->stress, call.strain);
        const std::size_t spd = in.own(umat::spent), sse = in.own(stored);
        spent->plastic = spent_in_step(call.state[spd], answer->state[spd], call.state[sse],
                                       answer->state[sse], work);
        if (session.checks_tangent()) session.check_tangent();
      }
    return false;
  }

  /// The rate over a step so short that it changes nothing: for the strain rate of the first row.
  template <class T, class S>
  static void rate(const Params<T>& P, const Sym<T, 6>& stress, const S& at, const T&,
                   const Sym<T, 6>& D, Branch, Sym<T, 6>& stress_rate, S& state_rate) {
    stress_rate = Sym<T, 6>::isotropic(T(0.0));
    for (T& x : state_rate) x = T(0.0);
    const double size = norm(D);
    if (!(size > 0.0)) return;
    Increment<T, 6> increment;
    increment.dt = 1e-8 / size;
    increment.strain = increment.dt * D;
    Sym<T, 6> moved = stress;
    S ignored = at;
    if (update(P, increment, moved, ignored)) return;
    stress_rate = (1.0 / increment.dt) * (moved - stress);
  }
  template <class T, class S>
  static T hypoelastic_power(const Params<T>&, const Sym<T, 6>&, const S&, const T&,
                             const Sym<T, 6>&, const Sym<T, 6>&) {
    return T(0.0);
  }
  template <class T, class S>
  static T stored_energy(const Params<T>& P, const Sym<T, 6>&, const S& at, const T&) {
    return at[P.session->layout().own(stored)];
  }
};

}  // namespace repose::umat
