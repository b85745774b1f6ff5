#pragma once
/// \file
/// One call of a UMAT by the signature of Abaqus/Standard (Abaqus 6.14, User Subroutines Reference
/// Guide, 1.1.41 UMAT), its arguments in guarded memory.

#include <array>
#include <memory>
#include <vector>

#include <sys/types.h>

#include "umat/in/host/guarded_array.hpp"
#include "umat/in/wire.hpp"

namespace repose::umat {

extern "C" {
/// 37 arguments, and the length of CMNAME, which Fortran compilers pass behind them.
using UmatFunction = void(double* stress, double* statev, double* ddsdde, double* sse, double* spd,
                          double* scd, double* rpl, double* ddsddt, double* drplde, double* drpldt,
                          double* stran, double* dstran, double* time, double* dtime, double* temp,
                          double* dtemp, double* predef, double* dpred, char* cmname, int* ndi,
                          int* nshr, int* ntens, int* nstatv, double* props, int* nprops,
                          double* coords, double* drot, double* pnewdt, double* celent,
                          double* dfgrd0, double* dfgrd1, int* noel, int* npt, int* layer,
                          int* kspt, int* jstep, int* kinc, std::size_t cmname_length);
}

class UmatCall {
 public:
  UmatCall(UmatFunction* function, const Header& header, const char* cmname);

  /// Calls it for the point: what goes in is taken from the record, what comes out left there. With
  /// header.subdivide an increment that the UMAT finds too large (PNEWDT < 1) is gone through in
  /// smaller ones. What is wrong (Fault::beyond_array, not_converged), or none.
  Fault run(const Header& header, const double* props, PointRecord& record, double* statev);

  /// The array next to which an address lies, for a signal handler; null for none.
  const GuardedArray* guarding(const void* address) const;
  /// The array whose surroundings are not what they were; null for none.
  const GuardedArray* damaged() const;

 private:
  /// Over the share `part` of the increment, from share `done` on.
  void call(const Header& header, const double* props, const PointRecord& record, double done,
            double part);

  UmatFunction* function_;
  std::size_t ntens_;
  GuardedArray stress_, statev_, ddsdde_, ddsddt_, drplde_, stran_, dstran_, time_, predef_, dpred_,
      props_, coords_, drot_, dfgrd0_, dfgrd1_, scalars_, integers_, cmname_;
  std::array<const GuardedArray*, 18> all_;
  std::array<char, 80> name_;
  std::vector<double> kept_statev_;
  pid_t self_;
};

}  // namespace repose::umat
