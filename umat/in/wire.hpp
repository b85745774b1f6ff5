#pragma once
/// \file
/// What goes between repose and the process that runs a foreign UMAT: memory that both see. The
/// numbers in it are in the order and signs of Abaqus/Standard; the process knows no others.

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace repose::umat {

/// What can go wrong in the process, or be seen to have gone wrong with it.
enum class Fault : std::uint32_t {
  none,
  not_loaded,     ///< dlopen failed
  no_symbol,      ///< the library has no such function
  crashed,        ///< a signal (segmentation fault, arithmetic, illegal instruction)
  aborted,        ///< abort(), a failed assertion
  beyond_array,   ///< it touched memory next to one of its arguments
  exited,         ///< it ended its process: STOP, exit()
  too_long,       ///< a call took longer than the time limit
  killed,         ///< the process was ended from outside, or vanished
  not_finite,     ///< a result is NaN or infinite
  not_converged,  ///< it went on asking for smaller increments (PNEWDT < 1)
  no_host,        ///< the program that runs libraries was not found or did not start
};

/// Points per exchange.
inline constexpr std::size_t exchange_capacity = 128;

/// The fields of a point, but for STATEV, which follows it. DDSDDE is column by column, NTENS rows.
struct PointRecord {
  double stress[6];
  double stran[6];
  double dstran[6];
  double drot[9];  ///< column by column
  double time[2];
  double dtime;
  double sse, spd;
  double ddsdde[36];
  double pnewdt;
  std::int32_t kinc;
  std::int32_t noel;
};
static_assert(sizeof(PointRecord) % sizeof(double) == 0);

/// Begins the shared memory; PROPS and the records follow it.
struct Header {
  std::atomic<std::uint32_t> request;  ///< counts up: repose asks
  std::atomic<std::uint32_t> answer;   ///< follows it: the process has answered
  std::atomic<std::uint32_t> calls;    ///< begun since the request, for the time limit
  std::atomic<std::uint32_t> at;       ///< the point that is being worked on
  std::uint32_t count;                 ///< points of the request
  std::uint32_t ntens;                 ///< 4 or 6
  std::uint32_t nstatv, nprops;
  std::uint32_t subdivide;  ///< follow PNEWDT < 1 with smaller increments instead of returning it
  std::uint32_t time_limit_s;
  std::uint32_t parent;  ///< process id of repose
  std::uint32_t fault;   ///< Fault
  std::int32_t detail;   ///< signal, or exit code
  char message[1000];    ///< ended by 0
};

/// Where things lie.
constexpr std::size_t record_bytes(std::size_t nstatv) {
  return sizeof(PointRecord) + nstatv * sizeof(double);
}
constexpr std::size_t props_offset() { return (sizeof(Header) + 63) / 64 * 64; }
constexpr std::size_t records_offset(std::size_t nprops) {
  return (props_offset() + nprops * sizeof(double) + 63) / 64 * 64;
}
constexpr std::size_t shared_bytes(std::size_t nprops, std::size_t nstatv) {
  return records_offset(nprops) + exchange_capacity * record_bytes(nstatv);
}

/// The memory as one side has it mapped.
class Exchange {
 public:
  Exchange() = default;
  explicit Exchange(void* memory) : base_(static_cast<std::byte*>(memory)) {}
  Header& header() const { return *reinterpret_cast<Header*>(base_); }
  double* props() const { return reinterpret_cast<double*>(base_ + props_offset()); }
  PointRecord& point(std::size_t i) const {
    return *reinterpret_cast<PointRecord*>(base_ + records_offset(header().nprops) +
                                           i * record_bytes(header().nstatv));
  }
  double* statev(std::size_t i) const { return reinterpret_cast<double*>(&point(i) + 1); }

 private:
  std::byte* base_ = nullptr;
};

}  // namespace repose::umat
