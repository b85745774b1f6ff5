/* A UMAT in C: linear elasticity with von Mises' yield stress and linear isotropic hardening, radial
 * return and consistent tangent (Simo & Hughes, Computational Inelasticity, 1998, box 3.1 and 3.2).
 *
 *     cc -O2 -shared -fPIC -o libvon_mises.so von_mises.c -lm
 *
 * PROPS: E [Pa], nu, and unless it is to stay elastic sigma_y [Pa] and H [Pa], the hardening modulus.
 * STATEV(1): equivalent plastic strain. SSE and SPD are filled. */
#include <math.h>
#include <stddef.h>

void umat_(double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd,
           double* rpl, double* ddsddt, double* drplde, double* drpldt, const double* stran,
           const double* dstran, const double* time, const double* dtime, const double* temp,
           const double* dtemp, const double* predef, const double* dpred, const char* cmname,
           const int* ndi, const int* nshr, const int* ntens, const int* nstatv,
           const double* props, const int* nprops, const double* coords, const double* drot,
           double* pnewdt, const double* celent, const double* dfgrd0, const double* dfgrd1,
           const int* noel, const int* npt, const int* layer, const int* kspt, const int* jstep,
           const int* kinc, size_t cmname_length) {
  (void)scd, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)stran, (void)time;
  (void)dtime, (void)temp, (void)dtemp, (void)predef, (void)dpred, (void)cmname, (void)ndi;
  (void)nshr, (void)coords, (void)drot, (void)pnewdt, (void)celent, (void)dfgrd0, (void)dfgrd1;
  (void)noel, (void)npt, (void)layer, (void)kspt, (void)jstep, (void)kinc, (void)cmname_length;
  const int n = *ntens;
  const double E = props[0], nu = props[1];
  const double G = E / (2.0 * (1.0 + nu)), K = E / (3.0 * (1.0 - 2.0 * nu));
  double before[6], normal[6];
  double volume = 0.0, mean = 0.0, size2 = 0.0;
  for (int i = 0; i < 3; ++i) volume += dstran[i];
  for (int i = 0; i < n; ++i) {
    before[i] = stress[i];
    stress[i] += i < 3 ? 2.0 * G * (dstran[i] - volume / 3.0) + K * volume : G * dstran[i];
  }
  for (int i = 0; i < 3; ++i) mean += stress[i] / 3.0;
  for (int i = 0; i < n; ++i) {
    normal[i] = stress[i] - (i < 3 ? mean : 0.0);
    size2 += (i < 3 ? 1.0 : 2.0) * normal[i] * normal[i];
  }
  const double size = sqrt(size2);
  double theta = 1.0, beta = 0.0; /* shares of 2G that are left across and along the normal */
  double plastic = 0.0;
  if (*nprops >= 3 && *nstatv >= 1) {
    const double H = *nprops >= 4 ? props[3] : 0.0;
    const double radius = sqrt(2.0 / 3.0) * (props[2] + H * statev[0]);
    if (size > radius) {
      const double gamma = (size - radius) / (2.0 * G + 2.0 / 3.0 * H);
      theta = 1.0 - 2.0 * G * gamma / size;
      beta = 1.0 / (1.0 + H / (3.0 * G)) - (1.0 - theta);
      statev[0] += sqrt(2.0 / 3.0) * gamma;
      for (int i = 0; i < n; ++i) {
        normal[i] /= size;
        stress[i] -= 2.0 * G * gamma * normal[i];
      }
      /* 1/2 (s_n + s_n+1) : d eps_p */
      for (int i = 0; i < n; ++i)
        plastic += (i < 3 ? 1.0 : 2.0) * 0.5 * (before[i] + stress[i]) * gamma * normal[i];
    }
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      double d = i < 3 && j < 3 ? K - 2.0 / 3.0 * G * theta : 0.0;
      if (i == j) d += i < 3 ? 2.0 * G * theta : G * theta;
      ddsdde[j * n + i] = d - 2.0 * G * beta * (beta != 0.0 ? normal[i] * normal[j] : 0.0);
    }
  double work = 0.0;
  for (int i = 0; i < n; ++i) work += 0.5 * (before[i] + stress[i]) * dstran[i];
  *spd += plastic;
  *sse += work - plastic;
}
