#pragma once
/// \file
/// The stress update of the critical-state μ(I) law: exact elastic predictor, implicit flow in two
/// unknowns, loss of contact and what ends it. Included by critical_state_mu_i.hpp.

namespace repose {

/// The implicit flow (physics.md, CSM-6). With the modulus G of the elastic predictor frozen, the
/// flow rule makes the end of the step
///     s = s_tr e^{−t},  p = p_tr e^{−w},  Δε_q^p = q_tr (1 − e^{−t})/3G,  Δε_v^p = κw
/// (in the code p = p_b e^{b−w}, as p_tr = p_b e^b of a huge step is no number: there b > 0, and
/// p_b stands for p_tr in what follows),
///     I = c (1 − e^{−t}) e^{w/2},  c = q_tr d √(ρ_p/p_tr)/(3GΔt),
///     θ = ln(p_s/p) = ℓ + (1 + r)w + jI,  r = κ/(λ−κ),  j = 1/(I_v(λ−κ)),
/// in the unknowns t ≥ 0 and w, which are to satisfy
///     volume   (1 − e^{−t})(1 − e^θ) = a w e^{w−t},  a = 3Gκ/(M²p_tr)                (CSM-3)
///     surface  Ψ = ln{½[1 + Q²]} − θ = 0,  Q = q/(M M_I p) = η e^{w−t}/M_I           (CSM-1)
/// For every t > 0 one w satisfies the first (left side less right one, times e^{−w}, falls with
/// w); it lies between 0 and the w of θ = 0. Along these Ψ goes from its value at the trial state,
/// > 0 where that lies beyond the surface at rest, to −ln 2: a root, for any step.
///
/// With u = a w e^{w−t}/(1 − e^{−t}) the first is written so that it is nearly linear in w however
/// far p_s is from p:
///     wet (θ < 0 at w = 0):  V = ln(e^θ + u) = 0;   dry:  V = θ − ln(1 − u) = 0.
template <class T>
struct CriticalStateReturn {
  T eta;     ///< q_tr/(M p_tr)
  T ell;     ///< ln(p_s/p_tr) at I = 0 before the step
  T r, j;    ///< κ/(λ−κ), 1/(I_v(λ−κ))
  T c, a;    ///< as above
  T growth;  ///< M_∞/M − 1
  T I_M;
  T b;          ///< ln(p_tr/p_b), 0 but for huge steps
  T c_at_rest;  ///< c e^{−b/2}: I = c_at_rest (1 − e^{−t}) at w = 0
  T inv_slope;  ///< 1/(1 + r)

  struct Point {
    T t, w;                 ///< w moved into its bracket
    T V, V_t, V_w;          ///< volume and its derivatives
    T Psi, Psi_t, Psi_w;    ///< surface and its derivatives
    T fall_q, rise_p_over;  ///< e^{−t}, e^{w−b}
  };

  [[gnu::always_inline]] Point at(const T& t, const T& w_asked) const {
    const T zero(0.0), one(1.0), half(0.5);
    const ExpPair<T> e_t = exp_pair(T(-t));
    const T& X = e_t.whole;
    const T share = -e_t.minus_one;  // 1 − e^{−t}
    // I rises with w, so that θ does at least at the slope 1 + r: it is 0 between w = 0 and this
    // end
    const T theta_0 = ell + j * c_at_rest * share;
    const auto dry = theta_0 > zero;
    const T end = -theta_0 * inv_slope;
    const T low = select(dry, end, zero), high = select(dry, zero, end);
    T w = select(w_asked < low, low, w_asked);
    w = select(w > high, high, w);

    const T root_W = exp_pair(T(half * (w - b))).whole;
    const T XW = X * root_W * root_W;
    const T I = c * share * root_W;
    const T I_t = c * X * root_W;
    // M_I = B/A, A = I_M + I, B = I_M + (M_∞/M)I; m = d ln M_I/dI
    const T A = I_M + I, B = A + growth * I;
    const T inv_AB = one / (A * B);
    const T m = growth * I_M * inv_AB;
    const T Q = eta * XW * (A * A * inv_AB);
    const T Q2 = Q * Q;
    const T weight = T(2.0) * Q2 / (one + Q2);
    const T theta = ell + (one + r) * w + j * I;
    const auto huge = theta > T(600.0);
    const T e_theta = exp_pair(select(huge, T(600.0), theta)).whole;
    const T theta_w = one + r + half * j * I;
    const T theta_t = j * I_t;
    // of what the logarithm in V is, times 1 − e^{−t}: e^θ + u or 1 − u
    const T aXW = a * XW;
    const T flow = aXW * w;  // u times that
    const T wet_part = share * e_theta;
    const T sum = select(dry, T(share - flow), T(wet_part + flow));
    const T inv = one / (share * sum);
    const T inv_sum = share * inv;
    const T log_sum = select(huge && negated(dry), theta, T(ln(T(sum * sum * inv))));
    const T flow_w = aXW * (one + w);
    Point x;
    x.t = t;
    x.w = w;
    x.V = select(dry, T(theta - log_sum), log_sum);
    x.V_t = select(dry, T(theta_t - flow * inv), T((share * wet_part * theta_t - flow) * inv));
    x.V_w = select(dry, T(theta_w + flow_w * inv_sum), T((wet_part * theta_w + flow_w) * inv_sum));
    x.Psi = ln(T(half * (one + Q2))) - theta;
    x.Psi_t = -weight * (one + m * I_t) - theta_t;
    x.Psi_w = weight * (one - half * m * I) - theta_w;
    x.fall_q = X;
    x.rise_p_over = root_W * root_W;
    return x;
  }

  /// Newton's step in both unknowns.
  [[gnu::always_inline]] static void newton(const Point& x, T& t_step, T& w_step) {
    const T inv = T(1.0) / (x.Psi_t * x.V_w - x.Psi_w * x.V_t);
    t_step = (x.Psi_w * x.V - x.Psi * x.V_w) * inv;
    w_step = (x.Psi * x.V_t - x.Psi_t * x.V) * inv;
  }

  /// Newton's step in t from the trial state, t = w = 0, where I = 0. Returns Ψ there. (Of no use
  /// where b > 0.)
  [[gnu::always_inline]] T first_step(T& t_step) const {
    const T one(1.0);
    T Q = eta;
    if (any(b > T(0.0))) Q = eta * exp_pair(T(-b)).whole;
    const T Q2 = Q * Q;
    const T weight = T(2.0) * Q2 / (one + Q2);
    const T Psi = ln(T(T(0.5) * (one + Q2))) - ell;
    const T w_along = -exp_pair(ell).minus_one / a;
    const T slope = -weight * (one + growth / I_M * c) - j * c + (weight - one - r) * w_along;
    t_step = -Psi / slope;
    return Psi;
  }

  /// About the w that belongs to t: of w e^w = z, z = (e^t − 1)(1 − e^θ)/a with θ of w = 0, on the
  /// wet side (to 10 %); on the dry one half of the way to θ = 0 at most.
  [[gnu::always_inline]] T about_volume(const T& t) const {
    const T zero(0.0), one(1.0);
    const ExpPair<T> e_t = exp_pair(T(-t));
    const T theta_0 = ell - j * c_at_rest * e_t.minus_one;
    const T z = e_t.minus_one * exp_pair(theta_0).minus_one / (e_t.whole * a);
    const auto small = z * z < T(0.04);
    const T near_trial = z - z * z;
    if (!any(negated(small))) return near_trial;
    const T log_z = ln(T(one + select(z > zero, z, zero)));
    const T about_z = log_z * (one - ln(T(one + log_z)) / (T(2.0) + log_z));
    // not beyond where jI alone would bring θ to 0
    const T most =
        T(-2.0) * ln(T(j * c_at_rest * e_t.minus_one / select(ell < zero, ell, T(-one))));
    const T wet = select(about_z < most, about_z, most);
    const T dry = T(-0.5) * theta_0 / (one + r + T(0.5) * j * c_at_rest * -e_t.minus_one);
    const T far = select(theta_0 > zero, select(z > dry, z, dry), wet);
    return select(small, near_trial, far);
  }

  CriticalStateReturn<Value<T>> values() const {
    return {value(eta),    value(ell), value(r), value(j),         value(c),        value(a),
            value(growth), value(I_M), value(b), value(c_at_rest), value(inv_slope)};
  }
};

/// Where the flow of a step ends: unknowns, and e^{−t} and e^{b−w}.
template <class T>
struct FlowEnd {
  T t, w, q_ratio, p_ratio;
};

/// w of V = 0 at a given t, by Newton's method inside a shrinking bracket; a step that does not
/// shorten the last one to half gives way to bisection.
template <class T>
T volume_at(const CriticalStateReturn<T>& eq, const T& t, int* evaluations = nullptr) {
  constexpr int max_steps = 200;
  const T zero(0.0);
  const T theta_0 = eq.ell - eq.j * eq.c_at_rest * exp_pair(T(-t)).minus_one;
  const T end = -theta_0 * eq.inv_slope;
  T low = select(end < zero, end, zero);
  T high = select(end < zero, zero, end);
  const T start = eq.about_volume(t);
  T w = select(start > low && start < high, start, T(T(0.5) * end));
  T last_move = high - low;
  auto open = t >= zero;  // lanes still moving; the others stay as they are
  for (int step = 0; step < max_steps && any(open); ++step) {
    const auto x = eq.at(t, w);
    if (evaluations != nullptr) ++*evaluations;
    const auto above = x.V > zero;  // V rises with w
    high = select(open && above, w, high);
    low = select(open && negated(above), w, low);
    const T candidate = w - x.V / x.V_w;
    const T jump = candidate - w;
    const auto good =
        candidate >= low && candidate <= high && jump * jump < T(0.25) * last_move * last_move;
    const T next = select(good, candidate, T(T(0.5) * (low + high)));
    last_move = select(open, T(next - w), last_move);
    w = select(open, next, w);
    open = open && last_move * last_move > T(1e-30) * (w * w + T(1e-30));
  }
  return w;
}

/// The root nearest to the trial state (the smallest t), for the lanes marked in `active`; those
/// for which none is found stay marked. Newton's method in both unknowns from the step that it
/// makes at t = 0; Ψ falls and is convex along V = 0 but for rare cases, so that it comes from the
/// left. Lanes that do not get there in a few steps are bracketed in t, V = 0 solved at every t.
template <class T>
FlowEnd<T> flow_end(const CriticalStateReturn<T>& eq, Mask<T>& active, int* evaluations = nullptr) {
  constexpr int fast_steps = 16;
  const T zero(0.0), one(1.0), half(0.5);
  const auto size = [&](const T& y) { return select(y > zero, y, T(-y)); };
  FlowEnd<T> end{zero, zero, one, one};
  T t_first;
  const T Psi_0 = eq.first_step(t_first);
  if (evaluations != nullptr) ++*evaluations;
  active = active && Psi_0 > zero;
  const auto sound = t_first > zero && t_first < T(700.0) && eq.b == zero;
  T t = select(sound, t_first, T(1e-3));
  T w = eq.about_volume(t);
  T last = t;
  const T round_off = T(4.0 * std::numeric_limits<double>::epsilon()) * (one + size(eq.ell));
  auto fast = active;
  for (int step = 0; step < fast_steps && any(fast); ++step) {
    const auto x = eq.at(t, w);
    if (evaluations != nullptr) ++*evaluations;
    T t_step, w_step;
    eq.newton(x, t_step, w_step);
    // done: the step left is so small that its error, of second order, is round-off; or Ψ is where
    // the volume is satisfied (V_w > 0)
    const T scale_w = size(x.w) + t;
    const auto done = (size(t_step) <= T(1e-8) * t && size(w_step) <= T(1e-7) * scale_w &&
                       size(w_step) <= T(1e-8) * (size(x.w) + one)) ||
                      (size(T(x.Psi * x.V_w - x.Psi_w * x.V)) <= round_off * x.V_w &&
                       size(x.V) <= T(1e-7) * scale_w * x.V_w);
    const auto ends = fast && done;
    end.t = select(ends, T(t + t_step), end.t);
    end.w = select(ends, T(x.w + w_step), end.w);
    end.q_ratio = select(ends, T(x.fall_q * (one - t_step * (one - half * t_step))), end.q_ratio);
    end.p_ratio =
        select(ends, T((one - w_step * (one - half * w_step)) / x.rise_p_over), end.p_ratio);
    active = active && !ends;
    fast = fast && !done;
    if (!any(fast)) break;
    // far from the volume, w moves alone; t by no more than half of itself downwards, and upwards
    // by no more than it has been seen to go
    const auto far = size(x.V) > one;
    const T longest = T(8.0) * last + T(4.0) * t;
    T bounded = select(t_step < -half * t, T(-half * t), t_step);
    bounded = select(far, zero, select(bounded > longest, longest, bounded));
    const auto cut = negated(bounded == t_step);
    if (any(cut && fast)) {
      const T inv = one / x.V_w;
      w_step = select(cut, T((-x.V - x.V_t * bounded) * inv), w_step);
    }
    last = select(far, last, size(bounded));
    t = select(fast, T(t + bounded), t);
    w = select(fast, T(x.w + w_step), w);
  }
  if (!any(active)) return end;

  // Bracket: Ψ > 0 at `low`, ≤ 0 at `high`, from the first step of Newton's method upwards by
  // factors of 2 or downwards by 8; then bisection.
  const auto Psi_of = [&](const T& at_t) {
    return eq.at(at_t, volume_at(eq, at_t, evaluations)).Psi;
  };
  const T guess = select(t_first > T(1e-8) && t_first < T(1e2), t_first, T(1e-8));
  T low = zero, high = guess;
  auto below = Psi_of(guess) <= zero;
  for (int k = 0; k < 350 && any(active && below && low == zero); ++k) {
    const T next = T(0.125) * high;
    const auto still = Psi_of(next) <= zero;
    const auto moves = active && below && low == zero;
    high = select(moves && still, next, high);
    low = select(moves && negated(still), next, low);
  }
  for (int k = 0; k < 64 && any(active && negated(below)); ++k) {
    const T next = select(below, high, T(T(2.0) * high));
    const auto now = Psi_of(next) <= zero;
    low = select(below, low, high);
    high = next;
    below = below || now;
  }
  for (int k = 0; k < 200; ++k) {
    const auto wide = high - low > T(2.0 * std::numeric_limits<double>::epsilon()) * high;
    if (!any(active && wide)) break;
    const T middle = half * (low + high);
    const auto outside = Psi_of(middle) > zero;
    low = select(wide && outside, middle, low);
    high = select(wide && negated(outside), middle, high);
  }
  const T root_w = volume_at(eq, high, evaluations);
  const auto x = eq.at(high, root_w);
  const auto found = active && below && finite(x.Psi) && finite(root_w);
  end.t = select(found, high, end.t);
  end.w = select(found, root_w, end.w);
  end.q_ratio = select(found, x.fall_q, end.q_ratio);
  end.p_ratio = select(found, T(one / x.rise_p_over), end.p_ratio);
  active = active && !found;
  return end;
}

template <class T, int N>
Mask<T> CriticalStateMuI::update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& stress,
                                 State<T>& at, StepWork<T>* spent, int* evaluations) {
  using std::sqrt;
  const T one(1.0);
  const T zero(0.0);
  const T half(0.5);
  const T hardening = P.lambda - P.kappa;
  const T volume_rate = P.volume_rate();

  // Contact (MCC-7): a separated point carries nothing until its density is back at ρ_sep; the rest
  // of that step then acts on p_sep. Shear can carry it before: where steady flow at p_sep would be
  // looser than the point is (CSM-9), it starts from p_sep at its own density.
  const auto apart = at[i_rho_sep] > zero;
  const T strain_total = -trace(inc.strain);  // Δε_v, compression positive
  const Sym<T, N> strain_whole = deviator(inc.strain);
  const T size = contract(inc.strain, inc.strain);
  const T p_contact = P.p_sep;
  auto touching = !apart || inc.density >= at[i_rho_sep];
  auto carried = apart && !apart;
  T share = one;
  T strain_v = strain_total;
  const T ln_contact = ln(p_contact);
  const T ln_2(0.69314718055994530942);
  T ln_p_c_n = at[i_ln_p_c];
  if (any(apart)) {
    const T rho_sep = select(apart, at[i_rho_sep], inc.density);
    const T dilated = ln(T(rho_sep / inc.density));
    const T I_contact = T(2.0 / std::sqrt(3.0)) * shear_norm(strain_whole) * P.d *
                        sqrt(T(P.rho_p / p_contact)) / inc.dt;
    carried = apart && !touching &&
              ln_p_c_n - ln_2 - ln_contact + volume_rate * I_contact > dilated / hardening;
    const auto rejoining = apart && touching;
    strain_v = select(rejoining, T(-dilated), select(carried, zero, strain_total));
    const T whole = select(strain_total > zero, strain_total, one);
    share = select(rejoining, T(strain_v / whole), one);
    share = select(share > one, one, share);
    ln_p_c_n = select(carried, T(ln_p_c_n - dilated / hardening), ln_p_c_n);
    touching = touching || carried;
  }
  const T p_n = select(apart, p_contact, pressure(stress));
  Sym<T, N> s_n = deviator(stress);
  for (int i = 0; i < N; ++i) s_n[i] = select(apart, zero, s_n[i]);
  const Sym<T, N> strain_dev = share * strain_whole;

  // Elastic predictor, exact for a proportional increment: p = p_n e^x, s = s_n + 2Ḡ Δe   (MCC-4).
  // A compression by more than 30κ in one step has no use for a Ḡ that grows with e^x; beyond 300κ
  // the trial state, far outside for certain, has no number (p_trial is then that of 300κ).
  const T x_trial = strain_v / P.kappa;
  const T g_n = P.shear_ratio() * p_n / P.kappa;
  const auto beyond_numbers = x_trial > T(300.0);
  const T x_base = select(beyond_numbers, T(300.0), x_trial);
  const ExpPair<T> growth = exp_pair(x_base);
  const T p_trial = p_n * growth.whole;
  T mean_growth = expm1_over(x_base, growth);
  if (any(x_trial > T(30.0)))
    mean_growth = select(x_trial > T(30.0), expm1_over(T(30.0)), mean_growth);
  const T G = g_n * mean_growth;
  const T Q0 = T(1.5) * contract(s_n, s_n);
  const T Q1 = T(6.0) * contract(s_n, strain_dev);
  const T Q2 = T(6.0) * contract(strain_dev, strain_dev);
  const T q2_trial = Q0 + G * (Q1 + G * Q2);
  const T M =
      P.slope(s_n + (T(2.0) * G) * strain_dev);  // of the trial state: s keeps its direction
  const T q2_M2 = q2_trial / square(M);
  const T p_c_n = exp_pair(ln_p_c_n).whole;
  const T F = q2_M2 - p_trial * (p_c_n - p_trial);  // CSM-1 at I = 0
  const T round_off(16.0 * std::numeric_limits<double>::epsilon());
  const auto yields =
      touching && inc.dt > zero && F - round_off * (q2_M2 + p_trial * (p_c_n + p_trial)) > zero;
  // a point at rest keeps its stress to the last bit
  const auto moving = apart || size > zero || yields;

  T p = p_trial;
  T x = x_trial;  // ln(p/p_n)
  T ln_p_c = ln_p_c_n;
  T q_ratio = one;
  Mask<T> failed = negated(
      finite(strain_total) && finite(size) && finite(T(contract(stress, stress))) && finite(F) &&
      inc.dt >= zero && finite(T(inc.density + at[i_rho_sep])) && inc.density > zero &&
      p_n > zero && finite(ln_p_c_n) && (inc.dt > zero || negated(beyond_numbers)));
  // what would leave e^{−200} of p_n parts without flowing
  const auto flows = yields && !failed && x_trial > T(-200.0);
  if (any(flows)) {
    const T r = P.kappa / hardening;
    const T q_trial = sqrt(select(q2_trial > zero, q2_trial, zero));
    const T inv_p = one / select(flows, p_trial, one);
    const T three_G = T(3.0) * G;
    const T rate_scale = q_trial * P.d * sqrt(T(P.rho_p * inv_p)) / (three_G * inc.dt);
    // a step of no duration: no flow to speak of
    const T c = select(rate_scale < T(1e100), rate_scale, T(1e100));
    T c_at_rest = c;
    if (any(beyond_numbers)) c_at_rest = c * exp_pair(T(half * (x_base - x_trial))).whole;
    const CriticalStateReturn<T> eq{T(q_trial * inv_p / M),
                                    T(ln_p_c_n - ln_2 - ln(select(flows, p_n, one)) - x_trial),
                                    r,
                                    volume_rate,
                                    c,
                                    T(three_G * P.kappa * inv_p / square(M)),
                                    T(P.M_inf / P.M - one),
                                    P.I_M,
                                    T(x_trial - x_base),
                                    c_at_rest,
                                    T(one / (one + r))};
    auto active = flows;
    FlowEnd<T> end;
    if constexpr (ScalarTraits<T>::is_dual) {
      // solve on values, then differentiate the root by one Newton step in T
      const auto root = flow_end(eq.values(), active, evaluations);
      auto x_root = eq.at(T(root.t), T(root.w));
      for (T* const residual : {&x_root.V, &x_root.Psi})
        *residual = *residual - T(value(*residual));
      T t_step, w_step;
      eq.newton(x_root, t_step, w_step);
      end.t = T(root.t) + t_step;
      end.w = T(root.w) + w_step;
      end.q_ratio = exp_pair(T(-end.t)).whole;
      end.p_ratio = exp_pair(T(eq.b - end.w)).whole;
    } else {
      end = flow_end(eq, active, evaluations);
    }
    failed = failed || active;
    p = select(flows, T(p_trial * end.p_ratio), p);
    x = select(flows, T(x_trial - end.w), x);
    ln_p_c = select(flows, T(ln_p_c_n + r * end.w), ln_p_c);
    q_ratio = select(flows, end.q_ratio, q_ratio);
  }

  // Loss of contact: what was dilated beyond p_sep is kept as the way back                (MCC-7).
  // Material so loose that only its flow carries it (p_c0 < p_sep) has half of p_sep to find its
  // flow in: from s = 0 at p_sep it contracts for some steps before shear dilates it.
  const auto sunk = ln_p_c < ln_contact;
  const auto parting = touching && moving && p < select(sunk, T(half * p_contact), p_contact);
  const auto bears = touching && !parting;
  T rho_sep = select(touching, zero, at[i_rho_sep]);
  if (any(parting)) {
    // down the swelling line from p_sep; and where p_c has sunk below p_sep, up the compression
    // line to p_sep first, so that v, p and p_c meet again on the law's own lines
    const T depth = select(sunk, T(ln_contact - ln_p_c), zero);
    const T gone = P.kappa * (ln(T(p_contact / p_n)) - x) + hardening * depth;
    const T back = inc.density * exp_pair(gone).whole;
    rho_sep = select(parting, back, rho_sep);
    failed = failed || (parting && negated(back > zero && finite(back)));
    ln_p_c = select(parting && sunk, ln_contact, ln_p_c);
  }

  // pressures beyond the square root of the number range cannot be squared in the yield condition
  failed = failed || (touching && negated(p < T(1e100) && ln_p_c < T(230.0)));
  const Sym<T, N> s = q_ratio * (s_n + (T(2.0) * G) * strain_dev);
  const Sym<T, N> next = s - Sym<T, N>::isotropic(p);
  failed = failed || (bears && negated(finite(T(contract(next, next)))));
  const auto keeps = failed || (touching && !moving);
  if (spent != nullptr) {
    // as for modified Cam-Clay, Ḡ here being that of the predictor
    const auto works = touching && moving;
    const T p_end = select(p > T(1e-200), p, T(1e-200));
    const T third(1.0 / 3.0);
    const T n_trial = third * (T(2.0) * Q0 + G * Q1);
    const T trial2 = T(2.0) * third * q2_trial;
    const T plastic_v = P.kappa * (x_trial - x);
    const T mean_p = half * (p_n + p);
    const T quarter_G = T(0.25) / G;
    const T flow = quarter_G * (one - q_ratio) * (n_trial + q_ratio * trial2) + mean_p * plastic_v;
    spent->plastic = select(works, flow, zero);
    const T quarter_g = T(0.25) / g_n;
    const T s2_n = T(2.0) * third * Q0;
    const T s2 = square(q_ratio) * trial2;
    const T shear_n = quarter_g * s2_n;
    const T shear_end = quarter_g * s2 * p_n / p_end;
    const T stored_over_p = P.kappa / (one - P.kappa);
    const T path = quarter_G * (s2 - s2_n) - (shear_end - shear_n) +
                   half * (shear_n + shear_end) * strain_v + stored_over_p * mean_p * plastic_v;
    spent->hypoelastic = select(works, path, zero);
    if (any(parting))
      spent->separation =
          select(parting && works,
                 T(stored_over_p * p_end + shear_end - half * contract(next, inc.strain)), zero);
    if (any(apart)) {
      // the strain that a point did not bear: a share of all of it, or the volume alone
      const T unborne = select(carried, T(half * p * strain_total),
                               T(half * (one - share) * contract(next, inc.strain) +
                                 half * p_contact * share * trace(inc.strain)));
      spent->separation =
          spent->separation + select(apart && works, T(unborne - stored_over_p * p_contact), zero);
    }
  }
  for (int i = 0; i < N; ++i) stress[i] = select(keeps, stress[i], T(select(bears, next[i], zero)));
  at[i_ln_p_c] = select(keeps || negated(touching), at[i_ln_p_c], ln_p_c);
  at[i_rho_sep] = select(keeps, at[i_rho_sep], rho_sep);
  return failed;
}

template <class T, int N>
T CriticalStateMuI::flow_number(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at) {
  const T p = pressure(stress);
  if (!(value(p) > 0.0) || P.rate_independent()) return T(0.0);  // (no p: apart)
  // Ψ(I) = ln{½[1 + (η/M_I)²]} − ln(p_c0/2p) − jI falls                                     CSM-4
  const Sym<T, N> s = deviator(stress);
  const T eta = T(std::sqrt(3.0)) * shear_norm(s) / (P.slope(s) * p);
  const T ell = at[i_ln_p_c] - ln(T(T(2.0) * p));
  const T j = P.volume_rate();
  const T growth = P.M_inf / P.M - T(1.0);
  const auto Psi = [&](const T& I, T& slope) {
    const T M_I = T(1.0) + growth * I / (P.I_M + I);
    const T Q2 = square(T(eta / M_I));
    slope = T(-2.0) * Q2 / (T(1.0) + Q2) * growth * P.I_M / (square(T(P.I_M + I)) * M_I) - j;
    return T(ln(T(T(0.5) * (T(1.0) + Q2))) - ell - j * I);
  };
  T slope;
  const T Psi_at_rest = Psi(T(0.0), slope);
  const double at_rest = value(Psi_at_rest);
  if (!(at_rest > 0.0)) return -Psi_at_rest / slope;
  // either growth alone, of friction or of volume, would do
  const double infinity = std::numeric_limits<double>::infinity();
  const double tip = 2.0 * std::exp(value(ell)) - 1.0;
  const double M_needed = tip > 0.0 ? value(eta) / std::sqrt(tip) : infinity;
  const double room = 1.0 + value(growth) - M_needed;
  double high = room > 0.0 ? value(P.I_M) * (M_needed - 1.0) / room : infinity;
  if (value(j) > 0.0) high = std::min(high, at_rest / value(j));
  if (!(high < infinity)) return T(infinity);
  double low = 0.0;
  double I = 0.0;
  for (int step = 0; step < 200; ++step) {
    T slope_here;
    const double here = value(Psi(T(I), slope_here));
    (here > 0.0 ? low : high) = I;
    const double candidate = I - here / value(slope_here);
    const double next = candidate > low && candidate < high ? candidate
                        : step == 0                         ? high
                                                            : 0.5 * (low + high);
    const double move = std::abs(next - I);
    I = next;
    if (move <= 1e-15 * I || high - low <= 1e-15 * high) break;
  }
  if constexpr (ScalarTraits<T>::is_dual) {
    const T miss = Psi(T(I), slope);
    return T(I) - (miss - T(value(miss))) / T(value(slope));
  } else {
    return I;
  }
}

template <class T, int N>
void CriticalStateMuI::rate(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                            const T& density, const Sym<T, N>& D, Branch branch,
                            Sym<T, N>& stress_rate, State<T>& state_rate) {
  using std::sqrt;
  const T p = pressure(stress);
  const Sym<T, N> s = deviator(stress);
  const T q = T(std::sqrt(3.0)) * shear_norm(s);
  // Without shear stress there is no direction of flow and no rate effect: isotropic compression
  // (CSM-3: ε̇_q^p = 0) is that of the law at rest. So is everything where no parameter knows a
  // rate.
  if (branch == Branch::elastic || value(q) <= 1e-12 * value(p) || P.rate_independent()) {
    const auto clay = at_rest(stress, at);
    Clay::State<T> clay_rate{};
    Clay::rate(P.clay(), stress, clay, density, D, branch, stress_rate, clay_rate);
    state_rate = {clay_rate[Clay::i_p_c] / clay[Clay::i_p_c], T(0.0)};
    return;
  }
  const T I = flow_number(P, stress, at);
  const T flow_q = I * sqrt(T(p / P.rho_p)) / P.d;  // ε̇_q^p
  const T M = P.slope(s);
  const T Q = q / (M * friction_growth(P, I) * p);                            // p_s = ½p(1 + Q²)
  const T flow_v = square(M) * p * (T(1.0) - Q * Q) / (T(2.0) * q) * flow_q;  // CSM-3
  const T K = p / P.kappa;
  const T two_G = T(2.0) * P.shear_ratio() * K;
  stress_rate = two_G * (deviator(D) - (T(1.5) * flow_q / q) * s) -
                Sym<T, N>::isotropic(K * (-trace(D) - flow_v));
  state_rate = {flow_v / (P.lambda - P.kappa), T(0.0)};  // CSM-2
}

}  // namespace repose
