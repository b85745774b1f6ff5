#include "umat/in/host/guarded_array.hpp"

#include <algorithm>
#include <cstring>
#include <new>

#include <sys/mman.h>
#include <unistd.h>

namespace repose::umat {
namespace {

constexpr std::uint64_t canary = 0x7ff4'c0de'5afe'c0deULL;  // a signalling NaN, never a result

}  // namespace

GuardedArray::GuardedArray(const char* name, std::size_t doubles) : name_(name), size_(doubles) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t bytes = doubles * sizeof(double);
  const std::size_t pages = std::max<std::size_t>(1, (bytes + page - 1) / page);
  void* const memory =
      ::mmap(nullptr, (pages + 2) * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  begin_ = static_cast<std::byte*>(memory);
  end_ = begin_ + (1 + pages) * page;
  whole_end_ = end_ + page;
  if (::mprotect(begin_ + page, pages * page, PROT_READ | PROT_WRITE) != 0) throw std::bad_alloc();
  data_ = reinterpret_cast<double*>(end_) - doubles;
  canaries_ = std::min<std::size_t>(8, (pages * page - bytes) / sizeof(double));
  for (std::size_t i = 1; i <= canaries_; ++i) std::memcpy(data_ - i, &canary, sizeof canary);
}

bool GuardedArray::intact() const {
  for (std::size_t i = 1; i <= canaries_; ++i)
    if (std::memcmp(data_ - i, &canary, sizeof canary) != 0) return false;
  return true;
}

bool GuardedArray::guards(const void* address) const {
  const auto* const at = static_cast<const std::byte*>(address);
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return (at >= begin_ && at < begin_ + page) || (at >= end_ && at < whole_end_);
}

}  // namespace repose::umat
