#include "bench/roofline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <map>
#include <stdexcept>
#include <type_traits>

#include <xsimd/xsimd.hpp>

namespace repose::bench {
namespace {

/// Makes the compiler believe that x is read and written here.
template <class T>
void touch(T& x) {
  asm volatile("" : "+m"(x) : : "memory");
}

/// CPU time of this thread [s]: other programs on the core do not count.
double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// The shortest of several passes [s].
template <class F>
double shortest(int passes, F&& pass) {
  double best = HUGE_VAL;
  for (int k = 0; k < passes; ++k) {
    const double start = thread_seconds();
    pass();
    best = std::min(best, thread_seconds() - start);
  }
  return best;
}

template <class Register>
double measured_peak() {
  // 12 chains: more than latency × units needs (4 × 2), few enough for 16 registers of AVX2
  constexpr std::size_t chains = 12;
  constexpr int rounds = 400'000;
  std::array<Register, chains> sum;
  double a = 0.999999, b = 1e-6;
  touch(a);
  touch(b);
  const Register factor(a), shift(b);
  for (Register& s : sum) s = Register(1.0);
  const double seconds = shortest(7, [&] {
    for (int k = 0; k < rounds; ++k) {
#pragma GCC unroll 12
      for (std::size_t c = 0; c < chains; ++c) sum[c] = xsimd::fma(sum[c], factor, shift);
    }
    touch(sum);
  });
  return 2.0 * static_cast<double>(chains * Register::size) * rounds / seconds;
}

using Widest = xsimd::batch<double>;
/// Four doubles where a register holds them.
using Quad = std::conditional_t<Widest::size == 2, Widest,
                                typename xsimd::make_sized_batch<double, 4>::type>;

double measured_triad(double bytes) {
  const auto n = static_cast<std::size_t>(bytes / 24.0) / 64 * 64;
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  const int repeats = std::max(1, static_cast<int>(5e8 / bytes));
  const double seconds = shortest(5, [&] {
    for (int k = 0; k < repeats; ++k) {
      const Widest s(1.0 + 1e-9 * k);
      for (std::size_t i = 0; i < n; i += Widest::size)
        xsimd::fma(s, Widest::load_unaligned(c.data() + i), Widest::load_unaligned(b.data() + i))
            .store_unaligned(a.data() + i);
      touch(a);
    }
  });
  return 24.0 * static_cast<double>(n) * repeats / seconds;
}

}  // namespace

std::vector<std::size_t> register_widths() {
  if constexpr (Widest::size > Quad::size) return {Quad::size, Widest::size};
  return {Quad::size};
}

double peak_flops(std::size_t width) {
  if (width == Quad::size) return measured_peak<Quad>();
  if (width == Widest::size) return measured_peak<Widest>();
  throw std::invalid_argument("peak_flops: no register of that width");
}

double peak_flops() {
  static const double best = [] {
    double most = 0.0;
    for (const std::size_t width : register_widths()) most = std::max(most, peak_flops(width));
    return most;
  }();
  return best;
}

double triad_bandwidth(double bytes) {
  static std::map<int, double> measured;  // by the power of two
  const int power = std::clamp(static_cast<int>(std::lround(std::log2(bytes))), 18, 29);
  const auto found = measured.find(power);
  if (found != measured.end()) return found->second;
  return measured[power] = measured_triad(std::ldexp(1.0, power));
}

}  // namespace repose::bench
