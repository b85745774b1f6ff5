#pragma once
/// \file
/// Waiting for a number in shared memory to change: a short while awake, then asleep.

#include <atomic>
#include <climits>
#include <cstdint>
#include <ctime>

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace repose::umat {

inline void wake(std::atomic<std::uint32_t>& word) {
  ::syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), FUTEX_WAKE, INT_MAX, nullptr,
            nullptr, 0);
}

/// Returns when the word differs from `old`, or after about `milliseconds`.
inline void wait_for_change(std::atomic<std::uint32_t>& word, std::uint32_t old,
                            long milliseconds) {
  // a pause is some 100 cycles: 20 µs or so, four times what falling asleep and waking up costs
  for (int i = 0; i < 600; ++i) {
    if (word.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  const timespec limit{milliseconds / 1000, milliseconds % 1000 * 1'000'000};
  ::syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), FUTEX_WAIT, old, &limit, nullptr,
            0);
}

}  // namespace repose::umat
