/* A UMAT that is elastic (E = 10 MPa, nu = 0) until increment PROPS(2), and then does what PROPS(1)
 * says. */
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum deed {
  nan_stress = 1,
  nan_tangent,
  endless_loop,
  call_abort,
  call_exit,
  call_underscore_exit,
  null_pointer,
  behind_statev,
  before_stress,
  far_behind_props,
  smaller_for_ever,
  kill_itself,
  deep_recursion,
  talk_and_exit,
  half_increments,
  divide_by_zero,
  fork_and_return,
  fork_and_exit
};

static int deeper(int depth) {
  volatile char room[4096];
  room[0] = (char)depth;
  return depth < 0 ? 0 : deeper(depth + 1) + room[0];
}

static volatile int zero = 0;

void umat_(double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd,
           double* rpl, double* ddsddt, double* drplde, double* drpldt, double* stran,
           double* dstran, double* time, double* dtime, double* temp, double* dtemp, double* predef,
           double* dpred, char* cmname, int* ndi, int* nshr, int* ntens, int* nstatv, double* props,
           int* nprops, double* coords, double* drot, double* pnewdt, double* celent,
           double* dfgrd0, double* dfgrd1, int* noel, int* npt, int* layer, int* kspt, int* jstep,
           int* kinc, size_t cmname_length) {
  (void)sse, (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)stran;
  (void)time, (void)temp, (void)dtemp, (void)predef, (void)dpred, (void)cmname, (void)ndi;
  (void)nshr, (void)coords, (void)drot, (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel;
  (void)npt, (void)layer, (void)kspt, (void)jstep, (void)cmname_length;
  const int n = *ntens;
  const double E = 1e7;
  for (int i = 0; i < n; ++i) {
    stress[i] += (i < 3 ? E : 0.5 * E) * dstran[i];
    ddsdde[i * n + i] = i < 3 ? E : 0.5 * E;
  }
  if (*nstatv > 0) statev[0] += *dtime;
  if (*nprops < 2 || *kinc < (int)props[1]) return;
  switch ((enum deed)(int)props[0]) {
    case nan_stress:
      stress[1] = NAN;
      break;
    case nan_tangent:
      ddsdde[n] = INFINITY;
      break;
    case endless_loop:
      while (zero == 0) {
      }
      break;
    case call_abort:
      abort();
    case call_exit:
      exit(0);
    case call_underscore_exit:
      _exit(0);
    case null_pointer:
      *(volatile double*)(ptrdiff_t)zero = 1.0;
      break;
    case behind_statev:
      statev[*nstatv] = 1.0;
      break;
    case before_stress:
      stress[-1] = 1.0;
      break;
    case far_behind_props:
      stress[0] += props[*nprops + 3];
      break;
    case smaller_for_ever:
      *pnewdt = 0.5;
      break;
    case kill_itself:
      raise(SIGKILL);
      break;
    case deep_recursion:
      stress[0] += deeper(1);
      break;
    case talk_and_exit:
      printf("no such material:\n\tgravel\n");
      exit(3);
    case half_increments:
      /* a step of more than 1e-4 is too large for it */
      for (int i = 0; i < 3; ++i)
        if (fabs(dstran[i]) > 1e-4) *pnewdt = 0.5;
      break;
    case divide_by_zero:
      stress[0] += *kinc / zero;
      break;
    case fork_and_return:
      if (*kinc == (int)props[1]) fork();
      break;
    case fork_and_exit:
      if (*kinc == (int)props[1] && fork() == 0) exit(4);
      break;
  }
}
