! A UMAT in Fortran: linear elasticity, perfectly plastic after Mohr and Coulomb, returned in principal
! stresses to the plane, to an edge or to the apex, with the tangent that belongs to the return
! (Clausen, Damkilde & Andersen, International Journal for Numerical Methods in Engineering 66, 2006;
! de Souza Neto, Peric & Owen, Computational Methods for Plasticity, 2008, 8.2).
!
!     gfortran -O2 -shared -fPIC -o libmohr_coulomb.so mohr_coulomb.f90
!
! PROPS: E [Pa], nu, phi [deg] > 0, psi [deg], c [Pa]. No state variables. SSE and SPD are filled.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &
                time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, &
                nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, &
                kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(*), ddsdde(ntens, ntens), sse, spd, scd, rpl, &
                      ddsddt(ntens), drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), &
                      dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), drot(3, 3), &
                      pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision, parameter :: degree = 3.14159265358979323846d0/180d0
  double precision :: shear, bulk, lame, sin_phi, sin_psi, strength
  double precision :: before(6), trial(3), principal(3), axes(3, 3), elastic(3, 3), left(3, 3)
  double precision :: work, plastic, ratio, modulus(3, 3)
  integer :: i, j, a, b

  shear = props(1)/(2d0*(1d0 + props(2)))
  bulk = props(1)/(3d0*(1d0 - 2d0*props(2)))
  lame = bulk - 2d0/3d0*shear
  sin_phi = sin(props(3)*degree)
  sin_psi = sin(props(4)*degree)
  strength = 2d0*props(5)*cos(props(3)*degree)

  before = 0d0
  before(1:ntens) = stress
  do i = 1, ntens
    if (i <= 3) then
      stress(i) = stress(i) + lame*sum(dstran(1:3)) + 2d0*shear*dstran(i)
    else
      stress(i) = stress(i) + shear*dstran(i)
    end if
  end do
  elastic = lame
  do i = 1, 3
    elastic(i, i) = lame + 2d0*shear
  end do

  call spectrum(stress, ntens, trial, axes)
  call return_map(trial, principal, left)
  modulus = matmul(left, elastic)
  if (any(principal /= trial)) call assemble_stress()
  call assemble_tangent()

  work = sum(0.5d0*(before(1:ntens) + stress)*dstran)
  ! what the elastic part keeps: the change of the complementary energy
  plastic = work - (energy(stress) - energy(before(1:ntens)))
  sse = sse + work - plastic
  spd = spd + plastic

contains

  ! sigma : C^-1 : sigma / 2
  double precision function energy(s)
    double precision, intent(in) :: s(ntens)
    double precision :: mean, dev(3)
    mean = sum(s(1:3))/3d0
    dev = s(1:3) - mean
    energy = mean**2/(2d0*bulk) + (sum(dev**2) + 2d0*sum(s(4:)**2))/(4d0*shear)
  end function

  ! Principal stresses in falling order, and their axes as columns: Jacobi's method.
  subroutine spectrum(s, n, values, vectors)
    integer, intent(in) :: n
    double precision, intent(in) :: s(n)
    double precision, intent(out) :: values(3), vectors(3, 3)
    double precision :: m(3, 3), t, c, sn, theta, rotation(3, 3), largest
    integer :: sweep, p, q, order(3), k
    m = 0d0
    do k = 1, 3
      m(k, k) = s(k)
    end do
    m(1, 2) = s(4)
    if (n > 4) then
      m(1, 3) = s(5)
      m(2, 3) = s(6)
    end if
    m(2, 1) = m(1, 2)
    m(3, 1) = m(1, 3)
    m(3, 2) = m(2, 3)
    vectors = 0d0
    do k = 1, 3
      vectors(k, k) = 1d0
    end do
    largest = maxval(abs(m))
    do sweep = 1, 30
      if (abs(m(1, 2)) + abs(m(1, 3)) + abs(m(2, 3)) <= 1d-17*largest) exit
      do p = 1, 2
        do q = p + 1, 3
          if (m(p, q) == 0d0) cycle
          theta = (m(q, q) - m(p, p))/(2d0*m(p, q))
          t = sign(1d0, theta)/(abs(theta) + sqrt(theta**2 + 1d0))
          c = 1d0/sqrt(t**2 + 1d0)
          sn = t*c
          rotation = 0d0
          do k = 1, 3
            rotation(k, k) = 1d0
          end do
          rotation(p, p) = c
          rotation(q, q) = c
          rotation(p, q) = sn
          rotation(q, p) = -sn
          m = matmul(transpose(rotation), matmul(m, rotation))
          m(p, q) = 0d0
          m(q, p) = 0d0
          vectors = matmul(vectors, rotation)
        end do
      end do
    end do
    values = [m(1, 1), m(2, 2), m(3, 3)]
    order = [1, 2, 3]
    if (values(order(1)) < values(order(2))) order([1, 2]) = order([2, 1])
    if (values(order(2)) < values(order(3))) order([2, 3]) = order([3, 2])
    if (values(order(1)) < values(order(2))) order([1, 2]) = order([2, 1])
    values = values(order)
    vectors = vectors(:, order)
  end subroutine

  ! The plane of two principal stresses, the larger one first:
  ! f = (s_i - s_j) + (s_i + s_j) sin(phi) - 2 c cos(phi)
  function normal(i, j, sine) result(v)
    integer, intent(in) :: i, j
    double precision, intent(in) :: sine
    double precision :: v(3)
    v = 0d0
    v(i) = 1d0 + sine
    v(j) = sine - 1d0
  end function

  logical function in_order(s)
    double precision, intent(in) :: s(3)
    double precision :: slack
    slack = 1d-12*maxval(abs(s))
    in_order = s(1) >= s(2) - slack .and. s(2) >= s(3) - slack
  end function

  ! s: returned stresses, keep: d s / d trial
  subroutine return_map(t, s, keep)
    double precision, intent(in) :: t(3)
    double precision, intent(out) :: s(3), keep(3, 3)
    double precision :: n(3, 2), flow(3, 2), f(2), m(2, 2), gamma(2), det, inverse(2, 2)
    integer :: edge, k
    s = t
    keep = 0d0
    do k = 1, 3
      keep(k, k) = 1d0
    end do
    n(:, 1) = normal(1, 3, sin_phi)
    flow(:, 1) = matmul(elastic, normal(1, 3, sin_psi))
    f(1) = dot_product(n(:, 1), t) - strength
    if (f(1) <= 0d0) return
    ! the plane
    gamma(1) = f(1)/dot_product(n(:, 1), flow(:, 1))
    s = t - gamma(1)*flow(:, 1)
    if (in_order(s)) then
      do k = 1, 3
        keep(:, k) = keep(:, k) - flow(:, 1)*n(k, 1)/dot_product(n(:, 1), flow(:, 1))
      end do
      return
    end if
    ! the edges s1 = s2 and s2 = s3
    do edge = 1, 2
      if (edge == 1) then
        n(:, 2) = normal(2, 3, sin_phi)
        flow(:, 2) = matmul(elastic, normal(2, 3, sin_psi))
      else
        n(:, 2) = normal(1, 2, sin_phi)
        flow(:, 2) = matmul(elastic, normal(1, 2, sin_psi))
      end if
      f(2) = dot_product(n(:, 2), t) - strength
      m = matmul(transpose(n), flow)
      det = m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
      inverse = reshape([m(2, 2), -m(2, 1), -m(1, 2), m(1, 1)], [2, 2])/det
      gamma = matmul(inverse, f)
      s = t - matmul(flow, gamma)
      if (all(gamma >= 0d0) .and. in_order(s)) then
        keep = keep - matmul(flow, matmul(inverse, transpose(n)))
        return
      end if
    end do
    s = strength/(2d0*sin_phi)  ! the apex, c cot(phi)
    keep = 0d0
  end subroutine

  subroutine assemble_stress()
    integer :: k
    double precision :: m(3, 3)
    m = 0d0
    do k = 1, 3
      m = m + principal(k)*spread(axes(:, k), 2, 3)*spread(axes(:, k), 1, 3)
    end do
    stress(1:4) = [m(1, 1), m(2, 2), m(3, 3), m(1, 2)]
    if (ntens > 4) stress(5:6) = [m(1, 3), m(2, 3)]
  end subroutine

  ! n_a n_b symmetric, in the order of DDSDDE; against engineering strains a shear counts once.
  function dyad(a, b) result(v)
    integer, intent(in) :: a, b
    double precision :: v(6), m(3, 3)
    m = spread(axes(:, a), 2, 3)*spread(axes(:, b), 1, 3)
    m = 0.5d0*(m + transpose(m))
    v = [m(1, 1), m(2, 2), m(3, 3), m(1, 2), m(1, 3), m(2, 3)]
  end function

  ! Principal stresses change by `modulus`; axes turn with the trial stress, so that a shear between
  ! two of them meets the shear modulus times (s_a - s_b) / (trial_a - trial_b).
  subroutine assemble_tangent()
    double precision :: d(6, 6), va(6), vb(6)
    d = 0d0
    do a = 1, 3
      va = dyad(a, a)
      do b = 1, 3
        vb = dyad(b, b)
        d = d + modulus(a, b)*spread(va, 2, 6)*spread(vb, 1, 6)
      end do
    end do
    do a = 1, 2
      do b = a + 1, 3
        if (abs(trial(a) - trial(b)) > 1d-9*maxval(abs(trial))) then
          ratio = (principal(a) - principal(b))/(trial(a) - trial(b))
        else
          ratio = left(a, a) - left(a, b)
        end if
        va = dyad(a, b)
        d = d + 4d0*shear*ratio*spread(va, 2, 6)*spread(va, 1, 6)
      end do
    end do
    do j = 1, ntens
      ddsdde(:, j) = d(1:ntens, j)
    end do
  end subroutine
end subroutine
