! A UMAT in Fortran: hypoplastic sand after von Wolffersdorff (Mechanics of Cohesive-Frictional
! Materials 1, 1996, 251-271), written from the paper's equations:
!
!   T' = f_b f_e / tr(T_^2) [F^2 D + a^2 T_ tr(T_ D) + f_d a F (T_ + T_*) |D|]       T_ = T / tr T
!   T_* = T_ - 1/3,   a = sqrt(3) (3 - sin phi_c) / (2 sqrt(2) sin phi_c)
!   F = sqrt(tan^2 psi / 8 + (2 - tan^2 psi) / (2 + sqrt(2) tan psi cos 3 theta)) - tan psi / (2 sqrt 2)
!   tan psi = sqrt(3) |T_*|,   cos 3 theta = -sqrt(6) tr(T_*^3) / tr(T_*^2)^(3/2)
!   e_i / e_i0 = e_c / e_c0 = e_d / e_d0 = exp(-(3p / h_s)^n)
!   f_d = ((e - e_d) / (e_c - e_d))^alpha,   f_e = (e_c / e)^beta
!   f_b = h_s / n (e_i0 / e_c0)^beta (1 + e_i) / e_i (3p / h_s)^(1 - n)
!         / (3 + a^2 - sqrt(3) a ((e_i0 - e_d0) / (e_c0 - e_d0))^alpha)
!   e' = (1 + e) tr D
!
!     gfortran -O2 -shared -fPIC -o libhypoplastic_sand.so hypoplastic_sand.f90
!
! PROPS: phi_c [deg], h_s [Pa], n, e_d0, e_c0, e_i0, alpha, beta. STATEV(1): void ratio.
! Integrated over the increment by Bogacki and Shampine's pair of orders 3 and 2 (Applied Mathematics
! Letters 2, 1989) with steps that keep the error of each to `tolerance` of the stress; DDSDDE is made
! of differences of this integration, gone through in the same steps. Below a pressure of 1e-9 h_s the
! grains are held to be apart: the stress is that small pressure.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &
                time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, &
                nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, &
                kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, &
                      ddsddt(ntens), drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), &
                      dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), drot(3, 3), &
                      pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision, parameter :: degree = 3.14159265358979323846d0/180d0, tolerance = 1d-7
  integer, parameter :: most_steps = 2000
  double precision :: h_s, n, e_d0, e_c0, e_i0, alpha, beta, a, of_f_b, least
  double precision :: y0(7), y(7), moved(7), d(6), disturbed(6), steps(most_steps), size
  integer :: j, count

  h_s = props(2)
  n = props(3)
  e_d0 = props(4)
  e_c0 = props(5)
  e_i0 = props(6)
  alpha = props(7)
  beta = props(8)
  a = sqrt(3d0)*(3d0 - sin(props(1)*degree))/(2d0*sqrt(2d0)*sin(props(1)*degree))
  of_f_b = h_s/n*(e_i0/e_c0)**beta &
           /(3d0 + a**2 - sqrt(3d0)*a*((e_i0 - e_d0)/(e_c0 - e_d0))**alpha)
  least = 1d-9*h_s

  ! tensor components in the order of UMAT; the void ratio follows the stress
  y0 = 0d0
  y0(1:ntens) = stress
  y0(7) = statev(1)
  call hold(y0)
  d = 0d0
  d(1:3) = dstran(1:3)
  d(4:ntens) = 0.5d0*dstran(4:ntens)
  call integrate(y0, d, y, steps, count)
  if (count < 0) then
    pnewdt = 0.25d0
    return
  end if

  size = maxval(abs(d))
  if (size == 0d0) size = 1d-8
  do j = 1, ntens
    disturbed = d
    disturbed(j) = disturbed(j) + 1d-4*size
    call replay(y0, disturbed, moved, steps, count)
    ddsdde(:, j) = (moved(1:ntens) - y(1:ntens))/(1d-4*size)
    if (j > 3) ddsdde(:, j) = 0.5d0*ddsdde(:, j)
  end do
  stress = y(1:ntens)
  statev(1) = y(7)

contains

  double precision function dot(x, z)
    double precision, intent(in) :: x(6), z(6)
    dot = sum(x(1:3)*z(1:3)) + 2d0*sum(x(4:6)*z(4:6))
  end function

  ! Grains that are apart carry the least pressure and nothing else.
  subroutine hold(at)
    double precision, intent(inout) :: at(7)
    if (sum(at(1:3)) > -3d0*least) then
      at(1:3) = -least
      at(4:6) = 0d0
    end if
  end subroutine

  ! d(stress, e) for the strain increment d, which takes the place of D dt
  subroutine rate(at, d, change)
    double precision, intent(in) :: at(7), d(6)
    double precision, intent(out) :: change(7)
    double precision :: t(6), s(6), p3, decay, e, e_i, e_c, e_d, f_d, f_e, f_b, f, tan_psi, cos_3, &
                        s2, s3, norm_d
    p3 = max(-sum(at(1:3)), 3d0*least)
    t = -at(1:6)/p3
    s = t
    s(1:3) = s(1:3) - 1d0/3d0
    decay = exp(-(p3/h_s)**n)
    e_i = e_i0*decay
    e_c = e_c0*decay
    e_d = e_d0*decay
    e = at(7)
    f_d = max(0d0, (e - e_d)/(e_c - e_d))**alpha
    f_e = (e_c/max(e, e_d))**beta
    f_b = of_f_b*(1d0 + e_i)/e_i*(p3/h_s)**(1d0 - n)
    s2 = dot(s, s)
    tan_psi = sqrt(3d0*s2)
    cos_3 = 1d0
    if (s2 > 1d-24) then
      s3 = s(1)**3 + s(2)**3 + s(3)**3 + 3d0*(s(1)*(s(4)**2 + s(5)**2) + s(2)*(s(4)**2 + s(6)**2) &
           + s(3)*(s(5)**2 + s(6)**2)) + 6d0*s(4)*s(5)*s(6)
      cos_3 = min(1d0, max(-1d0, -sqrt(6d0)*s3/s2**1.5d0))
    end if
    f = sqrt(max(0d0, tan_psi**2/8d0 + (2d0 - tan_psi**2)/(2d0 + sqrt(2d0)*tan_psi*cos_3))) &
        - tan_psi/(2d0*sqrt(2d0))
    norm_d = sqrt(dot(d, d))
    change(1:6) = f_b*f_e/dot(t, t)*(f**2*d + a**2*t*dot(t, d) + f_d*a*f*(t + s)*norm_d)
    change(7) = (1d0 + e)*sum(d(1:3))
  end subroutine

  ! One step over the share h of the increment; k1 is the rate at its start, k4 that at its end.
  subroutine step(from, d, h, k1, to, k4, error)
    double precision, intent(in) :: from(7), d(6), h, k1(7)
    double precision, intent(out) :: to(7), k4(7), error
    double precision :: k2(7), k3(7), miss(7)
    call rate(from + 0.5d0*h*k1, d, k2)
    call rate(from + 0.75d0*h*k2, d, k3)
    to = from + h*(2d0/9d0*k1 + 1d0/3d0*k2 + 4d0/9d0*k3)
    call hold(to)
    call rate(to, d, k4)
    miss = h*(-5d0/72d0*k1 + 1d0/12d0*k2 + 1d0/9d0*k3 - 1d0/8d0*k4)
    error = sqrt(dot(miss(1:6), miss(1:6)))/max(sqrt(dot(to(1:6), to(1:6))), 1d3*least)
  end subroutine

  ! count: of the steps taken, -1 if there would be too many
  subroutine integrate(from, d, to, steps, count)
    double precision, intent(in) :: from(7), d(6)
    double precision, intent(out) :: to(7), steps(most_steps)
    integer, intent(out) :: count
    double precision :: done, h, k1(7), k4(7), next(7), error, factor
    to = from
    done = 0d0
    h = 1d0
    count = 0
    call rate(to, d, k1)
    do while (done < 1d0)
      h = min(h, 1d0 - done)
      call step(to, d, h, k1, next, k4, error)
      factor = 4d0
      if (error > 0d0) factor = min(4d0, max(0.2d0, 0.9d0*(tolerance/error)**(1d0/3d0)))
      if (.not. (error <= tolerance)) then
        if (.not. (error > 0d0)) factor = 0.2d0
        h = h*factor
        if (h < 1d-8) then
          count = -1
          return
        end if
        cycle
      end if
      if (count == most_steps) then
        count = -1
        return
      end if
      count = count + 1
      steps(count) = h
      done = done + h
      if (1d0 - done < 1d-12) done = 1d0
      to = next
      k1 = k4
      h = h*factor
    end do
  end subroutine

  subroutine replay(from, d, to, steps, count)
    double precision, intent(in) :: from(7), d(6), steps(most_steps)
    double precision, intent(out) :: to(7)
    integer, intent(in) :: count
    double precision :: k1(7), k4(7), next(7), error
    integer :: k
    to = from
    call rate(to, d, k1)
    do k = 1, count
      call step(to, d, steps(k), k1, next, k4, error)
      to = next
      k1 = k4
    end do
  end subroutine
end subroutine
