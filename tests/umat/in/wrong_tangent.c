/* A UMAT that is elastic (PROPS(1), nu = 0) and returns twice its tangent. */
#include <stddef.h>

void umat_(double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd,
           double* rpl, double* ddsddt, double* drplde, double* drpldt, double* stran,
           double* dstran, double* time, double* dtime, double* temp, double* dtemp, double* predef,
           double* dpred, char* cmname, int* ndi, int* nshr, int* ntens, int* nstatv,
           double* props) {
  (void)statev, (void)sse, (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde;
  (void)drpldt, (void)stran, (void)time, (void)dtime, (void)temp, (void)dtemp, (void)predef;
  (void)dpred, (void)cmname, (void)ndi, (void)nshr, (void)nstatv;
  for (int i = 0; i < *ntens; ++i) {
    const double stiffness = (i < 3 ? 1.0 : 0.5) * props[0];
    stress[i] += stiffness * dstran[i];
    ddsdde[i * *ntens + i] = 2.0 * stiffness;
  }
}
