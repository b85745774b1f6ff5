/* A UMAT that is elastic and writes what it was called with into STATEV(1 .. 44), in the order in which they stand below. */
#include <math.h>
#include <stddef.h>
#include <string.h>

void umat_(double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd,
           double* rpl, double* ddsddt, double* drplde, double* drpldt, double* stran,
           double* dstran, double* time, double* dtime, double* temp, double* dtemp, double* predef,
           double* dpred, char* cmname, int* ndi, int* nshr, int* ntens, int* nstatv, double* props,
           int* nprops, double* coords, double* drot, double* pnewdt, double* celent,
           double* dfgrd0, double* dfgrd1, int* noel, int* npt, int* layer, int* kspt, int* jstep,
           int* kinc, size_t cmname_length) {
  (void)sse, (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt;
  (void)predef, (void)dpred, (void)coords, (void)layer, (void)kspt;
  const int n = *ntens;
  double* s = statev;
  for (int i = 0; i < 6; ++i) *s++ = i < n ? stress[i] : 0.0;
  for (int i = 0; i < 6; ++i) *s++ = i < n ? stran[i] : 0.0;
  for (int i = 0; i < 6; ++i) *s++ = i < n ? dstran[i] : 0.0;
  for (int i = 0; i < 9; ++i) *s++ = drot[i];
  const double others[17] = {time[0],
                             time[1],
                             *dtime,
                             *ndi,
                             *nshr,
                             n,
                             *nstatv,
                             *nprops,
                             *noel,
                             *npt,
                             *kinc,
                             jstep[0],
                             (double)cmname_length,
                             memcmp(cmname, "SAND  ", 6) == 0,
                             *pnewdt,
                             dfgrd0[0] + dfgrd0[4] + dfgrd0[8] + fabs(dfgrd1[1]),
                             *temp + *dtemp + *celent};
  memcpy(s, others, sizeof others);
  for (int i = 0; i < n; ++i) {
    ddsdde[i * n + i] = i < 3 ? props[0] : 0.5 * props[0];
    stress[i] += ddsdde[i * n + i] * dstran[i];
  }
}
