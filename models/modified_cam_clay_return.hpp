#pragma once
/// \file
/// The stress update of modified Cam-Clay: exact elastic predictor, implicit plastic return, loss
/// of contact. Included by modified_cam_clay.hpp.

namespace repose {

/// The implicit return in one bounded unknown (physics.md, MCC-8; derived there). With κ standing
/// for κ* and λ for λ*, a = κ/λ, z = Δε_v^p and p = p_tr e^{−z/κ}, p_c = p_cn e^{z/(λ−κ)}, the
/// state moves along y = ln(2p/p_c) from the trial value L towards critical state, y = 0. The
/// unknown is w = y/L ∈ (0, 1], which stays regular where L itself is 0. With
///     x = ln(p/p_n) = y + a(L − y) + ln(p_cn/2p_n),  g = e^{−x},  h = e^{−y},  f(x) = (1 − g)/x,
///     G = G_n f/g, the mean over the elastic part of the step,
///     C = βf(x)/f(y),  β = 3(G/K)(1 − a)/M²,  D = w + (1 − w)C,
/// the flow rule makes q = q_tr w/D, and the yield condition divided by (Mp/D)² reads
///     H(w) = w²(A_0 g² + A_1 f g + A_2 f²) − D²(2h − 1) = 0,
/// where (q_tr/Mp)² has been written as a polynomial in G.
/// H < 0 for w → 0 and H ≥ 0 at w = 1 (the trial lies outside) or where 2h = 1 (p = p_c), whichever
/// comes first: a bracket that needs no search, wet or dry, for any increment.
///
/// Where strength depends on the direction of s (cone.hpp), G stays that of the predictor, G_n
/// times the mean growth Γ: f is then Γg in C and in q_tr, and s_{n+1} ∥ s_trial has the strength
/// of the trial state. The argument holds as it stands.
template <class T>
struct CamClayReturn {
  T a;           ///< κ/λ
  T L;           ///< ln(2p_tr/p_cn)
  T ln_ratio;    ///< ln(p_cn/2p_n)
  T beta;        ///< 3(G/K)(1 − a)/M²
  T A0, A1, A2;  ///< (3/2) s_n:s_n/(Mp_n)², 6G_n s_n:Δe/(Mp_n)², 6G_n² Δe:Δe/(Mp_n)²
  T held;  ///< Γ where G is that of the predictor, else 0; A0 is then (q_tr/Mp_n)², A1 = A2 = 0

  struct Point {
    T w;
    T H, slope, scale;  ///< residual, dH/dw, and what H is small against
    T x, g, h, f, D;    ///< as above; q = q_tr w/D
    T f_x, D_w;         ///< df/dx, dD/dw
  };

  [[gnu::always_inline]] Point at(const T& w) const {
    const T y = L * w;
    const T x = y + a * (L - y) + ln_ratio;
    return point(w, x, exp_pair(T(-x)), y, exp_pair(T(-y)));
  }

  /// The same where e^{−x} and e^{−y} are known.
  [[gnu::always_inline]] Point point(const T& w, const T& x, const ExpPair<T>& e_x, const T& y,
                                     const ExpPair<T>& e_y) const {
    const T one(1.0);
    const T& g = e_x.whole;
    const T& h = e_y.whole;
    // f(x) = (1 − g)/x, φ(y) = 1/f(y), and their derivatives (g − f)/x, (1 − φh)/(1 − h)
    T f, f_x, phi, phi_y;
    if constexpr (ScalarTraits<T>::is_dual) {
      f = expm1_over(T(-x), e_x);
      phi = one / expm1_over(T(-y), e_y);
      f_x = phi_y = T(0.0);  // a slope in dual numbers is not asked for
    } else {
      const T inv_x = one / select(near_0(x, 1e-16), one, x);
      const T inv_y = T(-1.0) / select(near_0(y, 1e-16), one, e_y.minus_one);
      f = select(near_0(x, 1e-16), one, T(-e_x.minus_one * inv_x));
      phi = select(near_0(y, 1e-16), one, T(y * inv_y));
      f_x = select(near_0(x, 1e-5), T(-0.5), T((g - f) * inv_x));
      phi_y = select(near_0(y, 1e-5), T(0.5), T((one - phi * h) * inv_y));
    }
    if (any(held > T(0.0))) {
      f = held * g;
      if constexpr (!ScalarTraits<T>::is_dual) f_x = -f;
    }
    const T C = beta * f * phi;
    const T D = w + (one - w) * C;
    const T q2 = A0 * g * g + f * (A1 * g + A2 * f);  // (q_tr/Mp)²
    const T S = T(2.0) * h - one;                     // (q/Mp)² at yield
    const T x_w = L * (one - a);
    const T C_w = beta * (f_x * phi * x_w + f * phi_y * L);
    const T D_w = one - C + (one - w) * C_w;
    const T q2_w = x_w * (f_x * (A1 * g + T(2.0) * A2 * f) - g * (T(2.0) * A0 * g + A1 * f));
    const T left = w * w * q2;
    Point r;
    r.w = w;
    r.H = left - D * D * S;
    r.slope = w * (T(2.0) * q2 + w * q2_w) - T(2.0) * D * (D_w * S - D * h * L);
    r.scale = left + D * D * (T(2.0) * h + one);
    r.x = x;
    r.g = g;
    r.h = h;
    r.f = f;
    r.D = D;
    r.f_x = f_x;
    r.D_w = D_w;
    return r;
  }

  /// A point at w + move by its Taylor series; the error is of second order in f and D, of third in
  /// g and h, of second in H.
  [[gnu::always_inline]] Point moved(const Point& from, const T& move) const {
    const T one(1.0), half(0.5);
    const T y_move = L * move;
    const T x_move = (one - a) * y_move;
    Point r = from;
    r.w = from.w + move;
    r.H = from.H + from.slope * move;
    r.x = from.x + x_move;
    r.g = from.g * (one - x_move * (one - half * x_move));
    r.h = from.h * (one - y_move * (one - half * y_move));
    r.f = from.f + from.f_x * x_move;
    r.D = from.D + from.D_w * move;
    return r;
  }

  /// Where the bracket of w ends: at the trial state, or where p = p_c (y = ln 2) if that comes
  /// first. On the dry side it ends at y = −200 at the latest, where p is p_c e^{-200}/2, below any
  /// p_sep: no sign change is then needed, the point parts.
  T bracket_end() const {
    const T ln_2(0.69314718055994530942);
    const T driest(-200.0);
    const auto wet = L > ln_2;
    const auto dry = L < driest;
    return select(wet, T(ln_2 / select(wet, L, ln_2)),
                  select(dry, T(driest / select(dry, L, driest)), T(1.0)));
  }

  CamClayReturn<Value<T>> values() const {
    return {value(a),  value(L),  value(ln_ratio), value(beta),
            value(A0), value(A1), value(A2),       value(held)};
  }

  static Mask<T> near_0(const T& x, double bound) { return x * x < T(bound * bound); }
};

/// Root of H, by inverse cubic interpolation through the last two values and slopes (Newton's
/// method with a correction; order 1 + √3), kept inside a shrinking bracket: a step that leaves the
/// bracket or is not clearly shorter than the one before gives way to bisection. Returns the
/// equation at the root, whose w is the root; a last step of less than 1e-9 is taken by Taylor's
/// series: it leaves an error of some 1e-18 (Newton's quadratic one) and costs no exponential.
/// `first` is the equation at w = 1, `upper` the end of
/// the bracket; `active` marks the lanes to solve, the values of the others mean nothing. Lanes
/// that have not met the tolerance stay marked in `active`. `evaluations`, if given, counts those
/// of H.
template <class R, class T>
typename R::Point bracketed_root(const R& eq, const typename R::Point& first, const T& upper,
                                 Mask<T>& active, int* evaluations = nullptr) {
  constexpr int max_steps = 200;  // every step halves the bracket or shortens the move to 0.7
  const T eps(4.0 * std::numeric_limits<double>::epsilon());
  T low(0.0);
  T high = upper;
  // the first step starts at w = 1 even where the bracket ends before
  T w_before(1.0);
  T H_before = first.H;
  T k_before = T(1.0) / first.slope;
  T w = w_before - H_before * k_before;
  w = select(w > low && w < high, w, upper);
  T last_move = upper;
  T rest(0.0);
  for (int step = 0;; ++step) {
    const typename R::Point here = eq.at(w);
    if (evaluations != nullptr) ++*evaluations;
    const auto above = here.H >= T(0.0);
    high = select(above, w, high);
    low = select(above, low, w);
    // w as a function of H by divided differences, at H = 0
    const T k = T(1.0) / here.slope;
    const T inv = T(1.0) / (H_before - here.H);
    const T d = (w_before - w) * inv;
    const T second = (d - k) * inv;
    const T third = ((k_before - d) * inv - second) * inv;
    const T newton_move = here.H * k;
    const T correction = here.H * here.H * (second - H_before * third);
    const auto trusted = correction * correction < T(0.25) * newton_move * newton_move;
    const T jump = select(trusted, T(correction - newton_move), T(-newton_move));
    const T candidate = w + jump;
    const T middle = T(0.5) * (low + high);
    const auto shrinking = jump * jump < T(0.5) * last_move * last_move;
    // written so that a NaN bisects
    const T next = select(candidate > low && candidate < high && shrinking, candidate, middle);
    last_move = next - w;
    // done: H at round-off of its terms, or w no longer moves. Such a lane keeps its w, so that
    // `here` belongs to it whenever the last lane ends.
    const T abs_H = select(above, here.H, T(-here.H));
    const T abs_move = select(next > w, last_move, T(-last_move));
    active = active && !(abs_H <= eps * here.scale || abs_move <= eps * w);
    // or a last step, which is kept for the end: what a lane becomes is its own business
    const auto last = active && trusted && abs_move <= T(1e-9) * w && next == candidate;
    rest = select(last, last_move, rest);
    active = active && !last;
    if (!any(active) || step == max_steps) return eq.moved(here, rest);
    w_before = select(active, w, w_before);
    H_before = select(active, here.H, H_before);
    k_before = select(active, k, k_before);
    w = select(active, next, w);
  }
}

template <Compression compression>
template <class T, int N>
Mask<T> ModifiedCamClay<compression>::update(const Params<T>& P, const Increment<T, N>& inc,
                                             Sym<T, N>& stress, State<T>& at, StepWork<T>* spent,
                                             int* evaluations) {
  const T one(1.0);
  const T zero(0.0);

  // Contact (MCC-7): a separated point carries nothing until its density is back at ρ_sep; the
  // rest of that step then acts on p_sep.
  const auto apart = at[i_rho_sep] > zero;
  const auto touching = !apart || inc.density >= at[i_rho_sep];
  const T strain_total = -trace(inc.strain);  // Δε_v, compression positive
  const T size = contract(inc.strain, inc.strain);
  const T p_contact = contact_pressure(P);
  T share = one;
  T strain_v = strain_total;
  if (any(apart)) {
    const auto rejoining = apart && touching;
    const T rho_sep = select(apart, at[i_rho_sep], inc.density);
    strain_v = select(rejoining, T(ln(T(inc.density / rho_sep))), strain_total);
    const T whole = select(strain_total > zero, strain_total, one);
    share = select(rejoining, T(strain_v / whole), one);
    share = select(share > one, one, share);
  }
  const T p_n = select(apart, p_contact, T(pressure(stress) + P.p_shift));
  Sym<T, N> s_n = deviator(stress);
  for (int i = 0; i < N; ++i) s_n[i] = select(apart, zero, s_n[i]);
  const Sym<T, N> strain_dev = share * deviator(inc.strain);
  const T p_cn = at[i_p_c];
  // a point at rest, be it on the yield surface, keeps its stress to the last bit
  const auto moving = apart || size > zero;

  // κ* of the step: exact on ln v – ln p lines, and on v – ln p lines with the mean
  // v = (v_n − v)/Δε_v, for which κ* ln(p/p_n) = Δε_v is κ ln(p/p_n) = v_n − v
  const T v = specific_volume(P, inc.density);
  const T kappa =
      compression == Compression::ln_v_ln_p ? P.kappa : kappa_star(P, T(v * expm1_over(strain_v)));

  // Elastic predictor, exact for a proportional increment: p = p_n e^x, s = s_n + 2Ḡ Δe   (MCC-4)
  const T x_trial = strain_v / kappa;
  const T g_n = P.shear_ratio() * p_n / kappa;
  const ExpPair<T> growth = exp_pair(x_trial);
  T mean_growth = expm1_over(x_trial, growth);
  const T p_trial = p_n * growth.whole;
  const T Q0 = T(1.5) * contract(s_n, s_n);
  const T Q1 = T(6.0) * contract(s_n, strain_dev);
  const T Q2 = T(6.0) * contract(strain_dev, strain_dev);
  // With a G that is held, a compression by more than 30κ in one step has no use for one that grows
  // with e^x.
  const bool round_cone = cone::is_circle(P.shape);
  if (!round_cone && any(x_trial > T(30.0)))
    mean_growth = select(x_trial > T(30.0), expm1_over(T(30.0)), mean_growth);
  const T G_trial = g_n * mean_growth;
  const T M = round_cone ? P.M : P.slope(s_n + (T(2.0) * G_trial) * strain_dev);
  const T q2_trial = Q0 + G_trial * (Q1 + G_trial * Q2);
  const T q2_M2 = q2_trial / square(M);
  const T F = q2_M2 - p_trial * (p_cn - p_trial);  // MCC-1
  // Outside by more than round-off; written so that an overflowed trial (∞ − ∞ = NaN) goes to the
  // return, which needs no trial.
  const T round_off(16.0 * std::numeric_limits<double>::epsilon());
  const auto yields =
      touching && moving && !(F - round_off * (q2_M2 + p_trial * (p_cn + p_trial)) <= zero);

  T p = p_trial;
  T x = x_trial;  // ln(p/p_n)
  T p_c = p_cn;
  T G = G_trial;
  T q_ratio = one;
  T torn_fall = zero;
  Mask<T> torn = yields && !yields;
  Mask<T> failed =
      !(finite(strain_total) && finite(size) && finite(T(contract(stress, stress))) &&
        finite(T(inc.density + at[i_rho_sep])) && inc.density > zero && p_n > zero && p_cn > zero);
  if (any(yields)) {
    const T a = P.kappa / P.lambda;
    const T ln_ratio = ln(T(p_cn / (T(2.0) * p_n)));
    const T L = x_trial - ln_ratio;
    // Dilation so large that even critical state (y = 0, the highest p on the dry side) lies below
    // p_sep: contact is lost for certain, nothing to solve. It is lost at p = p_sep, p_c = 2p_sep,
    // after a volumetric strain of κ ln(p_sep/p_n) + (λ−κ) ln(2p_sep/p_cn) = Δε_v − κ
    // ln_critical/a. (e^{aL} >= 1 + aL spares most steps the logarithm.)
    torn = yields && L < zero && T(0.5) * p_cn * (one + a * L) < p_contact;
    if (any(torn)) {
      const T ln_critical = ln(T(T(0.5) * p_cn / p_contact)) + a * L;
      torn = torn && ln_critical < zero;
      torn_fall = select(torn, T(-ln_critical / a), zero);
    }
    const auto plastic = yields && !torn;
    if (any(plastic)) {
      const T unit = one / (M * p_n);
      const T G_unit = g_n * unit;
      const CamClayReturn<T> eq{a,
                                L,
                                ln_ratio,
                                T(T(3.0) * P.shear_ratio() * (one - a) / square(M)),
                                T((round_cone ? Q0 : q2_trial) * unit * unit),
                                round_cone ? T(Q1 * unit * G_unit) : zero,
                                round_cone ? T(Q2 * G_unit * G_unit) : zero,
                                round_cone ? zero : mean_growth};
      auto active = plastic && !failed;
      typename CamClayReturn<T>::Point end;
      if constexpr (ScalarTraits<T>::is_dual) {
        // solve on values, then differentiate the converged root by one Newton step in T
        const auto plain = eq.values();
        const auto root =
            bracketed_root(plain, plain.at(1.0), plain.bracket_end(), active, evaluations);
        const T residual = eq.at(T(root.w)).H;
        end = eq.at(T(root.w) - (residual - T(value(residual))) / T(root.slope));
      } else {
        const T g = one / growth.whole;
        const T h = T(0.5) * p_cn / p_n * g;
        const auto trial = eq.point(one, x_trial, {g, g - one}, L, {h, h - one});
        end = bracketed_root(eq, trial, eq.bracket_end(), active, evaluations);
      }
      failed = failed || active;  // a root exists; only an overflow beyond any stress ends here
      const T end_growth = one / end.g;
      p = select(plastic, T(p_n * end_growth), p);
      x = select(plastic, end.x, x);
      p_c = select(plastic, T(T(2.0) * p_n * end_growth * end.h), p_c);
      G = select(plastic, T(g_n * end.f * end_growth), G);
      q_ratio = select(plastic, T(end.w / end.D), q_ratio);
    }
  }

  // Loss of contact: what was dilated beyond p_sep is kept as the way back, in units of κ  (MCC-7)
  const auto parting = torn || (touching && moving && p < p_contact);
  const auto bears = touching && !parting;
  T rho_sep = select(touching, zero, at[i_rho_sep]);
  if (any(parting)) {
    // down the swelling line from p_sep; and where p_c has sunk below p_sep, up the compression
    // line to p_sep first, so that v, p and p_c meet again on the law's own lines
    const T sunk = select(!torn && p_c < p_contact, T(p_contact / p_c), one);
    const T fall = select(torn, torn_fall,
                          T(ln(T(p_contact / p_n)) - x + (P.lambda / P.kappa - one) * ln(sunk)));
    const T gone = P.kappa * select(parting, fall, zero);
    const T back = compression == Compression::ln_v_ln_p ? T(inc.density * exp_pair(gone).whole)
                                                         : T(P.rho_p / (v - gone));
    rho_sep = select(parting, back, rho_sep);
    failed = failed || (parting && !(back > zero && finite(back)));
    p_c = select(torn, T(T(2.0) * p_contact), select(parting && p_c < p_contact, p_contact, p_c));
  }

  // pressures beyond the square root of the number range cannot be squared in the yield condition
  failed = failed || (touching && !torn && !(p + p_c < T(1e100)));
  const Sym<T, N> s = q_ratio * (s_n + (T(2.0) * G) * strain_dev);
  const Sym<T, N> next = s - Sym<T, N>::isotropic(p - P.p_shift);
  failed = failed || (bears && !finite(T(contract(next, next))));
  const auto keeps = failed || (touching && !moving);
  if (spent != nullptr) {
    const auto works = touching && moving && !torn;
    const T p_end = select(p > T(1e-200), p, T(1e-200));  // of a point that parts, perhaps 0
    // Δe^p = (1 − r) s_tr/2Ḡ with the r = q/q_tr of the return, Δε_v^p = κ(x_tr − x):
    // s_n:s_tr and s_tr:s_tr are polynomials in Ḡ
    const T third(1.0 / 3.0);
    const T n_trial = third * (T(2.0) * Q0 + G * Q1);
    const T trial2 = T(2.0) * third * (Q0 + G * (Q1 + G * Q2));
    const T plastic_v = kappa * (x_trial - x);
    const T mean_p = T(0.5) * (p_n + p) - P.p_shift;
    const T quarter_G = T(0.25) / G;
    const T flow = quarter_G * (one - q_ratio) * (n_trial + q_ratio * trial2) + mean_p * plastic_v;
    spent->plastic = select(works, flow, zero);
    // ∫ψ_s d ln G along the step, G from g_n to g_n p/p_n
    const T quarter_g = T(0.25) / g_n;
    const T s2_n = T(2.0) * third * Q0;
    const T s2 = square(q_ratio) * trial2;
    const T shear_n = quarter_g * s2_n;
    const T shear_end = quarter_g * s2 * p_n / p_end;
    T path = quarter_G * (s2 - s2_n) - (shear_end - shear_n);
    if (compression == Compression::ln_v_ln_p) {
      T stored = kappa / (one - kappa) * mean_p;
      if (any(P.p_shift > zero))
        stored = T(0.5) * (compression_energy(P, p_n, kappa) + compression_energy(P, p_end, kappa));
      path = path + T(0.5) * (shear_n + shear_end) * strain_v + stored * plastic_v;
    }
    spent->hypoelastic = select(works, path, zero);
    // A point that parts has gone through the step as if it bore to the end, and drops then what it
    // carries: its stored energy, and the share of its stress in the work of the step.
    if (any(parting))
      spent->separation = select(
          parting && works,
          T(compression_energy(P, p_end, kappa) + shear_end - T(0.5) * contract(next, inc.strain)),
          zero);
    // One that touches again has the work of p_sep and of σ over a share of the strain, and gets
    // the energy of p_sep for nothing.
    if (any(apart)) {
      const T skipped = T(0.5) * (one - share) * contract(next, inc.strain) +
                        T(0.5) * (p_contact - P.p_shift) * share * trace(inc.strain) -
                        compression_energy(P, p_contact, kappa);
      spent->separation = spent->separation + select(apart && works, skipped, zero);
    }
  }
  for (int i = 0; i < N; ++i) stress[i] = select(keeps, stress[i], T(select(bears, next[i], zero)));
  at[i_p_c] = select(keeps || !touching, at[i_p_c], p_c);
  at[i_rho_sep] = select(keeps, at[i_rho_sep], rho_sep);
  return failed;
}

template <Compression compression>
template <class T, int N>
void ModifiedCamClay<compression>::rate(const Params<T>& P, const Sym<T, N>& stress,
                                        const State<T>& at, const T& density, const Sym<T, N>& D,
                                        Branch branch, Sym<T, N>& stress_rate,
                                        State<T>& state_rate) {
  const T p = pressure(stress) + P.p_shift;
  const T p_c = at[i_p_c];
  const T v = specific_volume(P, density);
  const T kappa = kappa_star(P, v);
  const T K = p / kappa;
  const T G = P.shear_ratio() * K;
  const Sym<T, N> s = deviator(stress);
  const Sym<T, N> e_rate = deviator(D);
  const T strain_rate_v = -trace(D);
  state_rate[i_p_c] = T(0.0);
  state_rate[i_rho_sep] = T(0.0);
  T elastic_v = strain_rate_v;
  Sym<T, N> s_rate = (T(2.0) * G) * e_rate;
  if (branch == Branch::plastic) {
    // consistency dF = (3/M²) s:ds − 2(q/M)² d ln M + (2p − p_c) dp − p dp_c = 0 with MCC-2, MCC-3;
    // flow along s does not turn s, and M changes with its direction alone
    const T three_M2 = T(3.0) / square(P.slope(s));
    const T volumetric = T(2.0) * p - p_c;
    const T hardening = p_c * P.kappa / ((P.lambda - P.kappa) * kappa);  // p_c/(λ* − κ*)
    T load = volumetric * K * strain_rate_v + three_M2 * T(2.0) * G * contract(s, e_rate);
    if (!cone::is_circle(P.shape))
      load = load - three_M2 * contract(s, s) * cone::share_rate(P.shape, P.M, s, s_rate);
    const T stiffness = volumetric * volumetric * K +
                        square(three_M2) * T(2.0) * G * contract(s, s) + p * volumetric * hardening;
    const T multiplier = load / stiffness;
    elastic_v = strain_rate_v - multiplier * volumetric;
    s_rate = s_rate - (T(2.0) * G * multiplier * three_M2) * s;
    state_rate[i_p_c] = hardening * multiplier * volumetric;
  }
  stress_rate = s_rate - Sym<T, N>::isotropic(K * elastic_v);
}

}  // namespace repose
