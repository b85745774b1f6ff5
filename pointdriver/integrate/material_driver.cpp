#include "pointdriver/integrate/material_driver.hpp"

#include <cmath>

#include "models/dual.hpp"
#include "pointdriver/integrate/drive.hpp"
#include "pointdriver/integrate/plain_rows.hpp"

namespace repose::point {
namespace {

/// As many as a law from outside may have.
constexpr std::size_t states = most_state_variables;

/// The Material that this thread is driving.
thread_local const Material* driven = nullptr;

class Driving {
 public:
  explicit Driving(const Material& material) : before_(driven) { driven = &material; }
  ~Driving() { driven = before_; }
  Driving(const Driving&) = delete;
  Driving& operator=(const Driving&) = delete;

 private:
  const Material* before_;
};

template <class T>
Sym<double, 6> plain(const Sym<T, 6>& a) {
  Sym<double, 6> r;
  for (std::size_t k = 0; k < 6; ++k) r.c[k] = value(a.c[k]);
  return r;
}

/// A few points of one padded batch.
template <std::size_t n>
struct SmallBatch {
  static constexpr std::size_t room = padded(n);

  void put(std::size_t i, const Sym<double, 6>& s, std::span<const double> variables, double rho,
           const Sym<double, 6>& step) {
    for (std::size_t k = 0; k < 6; ++k) {
      stress[k][i] = s.c[k];
      strain[k][i] = step.c[k];
    }
    for (std::size_t k = 0; k < states; ++k) state[k][i] = variables[k];
    density[i] = rho;
  }
  SpatialBatch batch(double dt) {
    for (std::size_t i = n; i < room; ++i) {
      for (std::size_t k = 0; k < 6; ++k) {
        stress[k][i] = stress[k][n - 1];
        strain[k][i] = strain[k][n - 1];
      }
      for (std::size_t k = 0; k < states; ++k) state[k][i] = state[k][n - 1];
      density[i] = density[n - 1];
    }
    SpatialBatch all;
    all.count = n;
    all.dt = dt;
    for (std::size_t k = 0; k < 6; ++k) {
      all.stress[k] = stress[k].data();
      all.strain[k] = strain[k].data();
    }
    for (std::size_t k = 0; k < states; ++k) all.state[k] = state[k].data();
    all.density = density.data();
    return all;
  }

  std::array<std::array<double, room>, 6> stress{}, strain{};
  std::array<std::array<double, room>, states> state{};
  std::array<double, room> density{};
};

/// A law whose physics is that of the Material being driven. To the integrator it is one whose
/// stress follows from the update alone: it has no rate form.
struct DrivenLaw : LawDefaults {
  static constexpr bool has_stress_memory = false;
  static constexpr std::array<ParamInfo, 2> parameters{
      {{"rho_p", "rho_p", "kg/m3", "of the grains", Need::optional},
       {"d", "d", "m", "of a grain", Need::optional}}};
  static constexpr std::array<StateField, states> state{};
  template <class T>
  struct Params {
    T rho_p, d;
    static Params from(std::span<const T> t) { return {t[0], t[1]}; }
  };
  template <class T>
  using State = std::array<T, states>;

  template <class T>
  static bool update(const Params<T>&, const Increment<T, 6>& inc, Sym<T, 6>& stress,
                     State<T>& variables, StepWork<T>* spent = nullptr) {
    constexpr double delta = 1e-7;
    constexpr std::size_t slopes = [] {
      if constexpr (ScalarTraits<T>::is_dual)
        return static_cast<std::size_t>(T::DIMENSION);
      else
        return std::size_t{0};
    }();
    const Sym<double, 6> start = plain(stress), strain = plain(inc.strain);
    std::array<double, states> at{};
    for (std::size_t k = 0; k < states; ++k) at[k] = value(variables[k]);
    const double rho = value(inc.density) * std::exp(trace(strain));
    SmallBatch<2 * slopes + 1> points;
    points.put(0, start, at, rho, strain);
    if constexpr (slopes > 0)
      for (std::size_t j = 0; j < slopes; ++j) {
        Sym<double, 6> along;
        for (std::size_t k = 0; k < 6; ++k)
          along.c[k] = delta * inc.strain.c[k].v[static_cast<int>(j)];
        points.put(2 * j + 1, start, at, rho, strain + along);
        points.put(2 * j + 2, start, at, rho, strain - along);
      }
    SpatialBatch batch = points.batch(value(inc.dt));
    std::array<double, decltype(points)::room> plastic{}, viscous{}, hypoelastic{};
    if (spent != nullptr) {
      batch.plastic = plastic.data();
      batch.viscous = viscous.data();
      batch.hypoelastic = hypoelastic.data();
    }
    if (!driven->update(batch).ok()) return true;
    const auto after = [&](const auto& column) {
      T x(column[0]);
      if constexpr (slopes > 0)
        for (std::size_t j = 0; j < slopes; ++j)
          x.v[static_cast<int>(j)] = (column[2 * j + 1] - column[2 * j + 2]) / (2.0 * delta);
      return x;
    };
    for (std::size_t k = 0; k < 6; ++k) stress.c[k] = after(points.stress[k]);
    for (std::size_t k = 0; k < states; ++k) variables[k] = after(points.state[k]);
    if (spent != nullptr) {
      const bool memory = driven->law().has_stress_memory;
      spent->plastic = T(memory ? plastic[0] : 0.0);
      spent->viscous = T(memory ? 0.0 : viscous[0]);
      spent->hypoelastic = T(hypoelastic[0]);
    }
    return false;
  }
  template <class T>
  static void rate(const Params<T>&, const Sym<T, 6>&, const State<T>&, const T&, const Sym<T, 6>&,
                   Branch, Sym<T, 6>& stress_rate, State<T>& state_rate) {
    stress_rate = Sym<T, 6>::isotropic(T(0.0));
    for (T& x : state_rate) x = T(0.0);
  }
  template <class T>
  static T stored_energy(const Params<T>&, const Sym<T, 6>& stress, const State<T>& variables,
                         const T& rho) {
    std::array<double, states> at{};
    for (std::size_t k = 0; k < states; ++k) at[k] = value(variables[k]);
    SmallBatch<1> point;
    point.put(0, plain(stress), at, value(rho), {});
    std::array<double, SmallBatch<1>::room> energy{};
    driven->stored_energy(point.batch(0.0), energy.data());
    return T(energy[0]);
  }
};

using Make = std::function<std::unique_ptr<Material>(std::vector<double>)>;

class MaterialDriver final : public OutsideDriver {
 public:
  MaterialDriver(const LawInfo& info, std::function<void(std::vector<double>&)> complete, Make make)
      : info_(info),
        complete_(std::move(complete)),
        make_(std::move(make)) {}

  Method method_for(Method method) const override {
    return method == Method::automatic || method == Method::adaptive ? Method::implicit : method;
  }

  std::vector<double> start(std::span<const double> theta, const PointTest& test) const override {
    std::vector<double> numbers(theta.begin(), theta.end());
    complete_(numbers);
    const InitialPoint point = make_(numbers)->initial(test.initial);
    numbers.insert(numbers.end(), point.stress.c.begin(), point.stress.c.end());
    numbers.insert(numbers.end(), point.state.begin(), point.state.end());
    numbers.push_back(point.density);
    return numbers;
  }

  Outcome drive(std::span<const double> numbers, const PointTest& test,
                Curve& curve) const override {
    const std::size_t n = info_.parameters.size();
    const auto parameter = [&](std::string_view name) {
      const int i = parameter_index(info_.parameters, name);
      return i < 0 ? std::nan("") : numbers[static_cast<std::size_t>(i)];
    };
    const std::unique_ptr<Material> material =
        make_(std::vector<double>(numbers.begin(), numbers.begin() + static_cast<long>(n)));
    const Driving driving(*material);
    ElementStart<DrivenLaw, double> start;
    start.parameters = start.plain = {parameter("rho_p"), parameter("d")};
    for (std::size_t i = 0; i < 6 + info_.state.size(); ++i)
      start.stress_and_state[i] = numbers[n + i];
    start.density = numbers.back();
    return drive_path<DrivenLaw, double>(start, test.path, test.settings, curve);
  }

  Outcome drive(std::span<const double> numbers, std::span<const double> slopes,
                const PointTest& test, Curve& curve,
                std::vector<Curve>& slope_curves) const override {
    const Outcome outcome = drive(numbers, test, curve);
    // an update is exact to round-off but for what a law of anybody's may iterate: 1e-5 leaves
    // eleven digits of a difference, and a cut-off error of 1e-10 of the third derivative
    slopes_by_differences(
        numbers, slopes, 1e-5, curve,
        [&](std::span<const double> there, Curve& to) { return drive(there, test, to); },
        slope_curves);
    return outcome;
  }

 private:
  const LawInfo& info_;
  std::function<void(std::vector<double>&)> complete_;
  Make make_;
};

}  // namespace

std::shared_ptr<const OutsideDriver> material_driver(
    const LawInfo& info, std::function<void(std::vector<double>&)> complete, Make make) {
  return std::make_shared<MaterialDriver>(info, std::move(complete), std::move(make));
}

}  // namespace repose::point
