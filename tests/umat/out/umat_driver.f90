! Drives a UMAT along a path as a finite element program would drive one element under a uniform strain:
! each component is given its strain or its stress, and the strains that are left follow by Newton's
! method with DDSDDE. It knows nothing of repose; it calls the UMAT that it is linked with.
!
! Standard input, each on lines of its own, behind which a line may go on with words:
!   the material's name in quotes
!   ndi nshr nprops nstatv
!   props; stress, tension positive, 11 22 33 12 13 23; statev       as many numbers as said
!   the number of legs, and per leg:
!     steps, duration of a step
!     per component 1 where the stress is given, 0 where the strain is
!     per component the change of that stress or (logarithmic, shear: engineering) strain over the leg
! Standard output, a line per step:
!   iterations, largest residual of each of the last three over the largest stress, stress, strain,
!   statev, sse, spd, scd
! Exit status: 1 where a step cannot be done, 2 where the input cannot be read.
program umat_driver
  implicit none
  integer, parameter :: dp = kind(1.0d0), most_iterations = 30
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nprops, nstatv, legs, leg, steps, step, kstep, kinc, status
  integer, allocatable :: stress_given(:)
  real(dp), allocatable :: props(:), stress(:), statev(:), change(:), ddsdde(:, :), stran(:), dstran(:)
  real(dp), allocatable :: start(:), last(:)
  real(dp) :: dtime, time(2), energy(3)

  read (*, *, iostat=status) cmname
  if (status /= 0) call refuse('the name')
  read (*, *, iostat=status) ndi, nshr, nprops, nstatv
  if (status /= 0) call refuse('ndi, nshr, nprops, nstatv')
  ntens = ndi + nshr
  allocate (props(nprops), stress(ntens), statev(nstatv), change(ntens), stress_given(ntens))
  allocate (ddsdde(ntens, ntens), stran(ntens), dstran(ntens), start(ntens), last(ntens))
  read (*, *, iostat=status) props
  if (status /= 0) call refuse('props')
  read (*, *, iostat=status) stress
  if (status /= 0) call refuse('stress')
  read (*, *, iostat=status) statev
  if (status /= 0) call refuse('statev')
  read (*, *, iostat=status) legs
  if (status /= 0) call refuse('the number of legs')
  stran = 0
  last = 0
  time = 0
  energy = 0
  kinc = 0
  do leg = 1, legs
    read (*, *, iostat=status) steps, dtime
    if (status /= 0) call refuse('steps, duration of a leg')
    read (*, *, iostat=status) stress_given
    if (status /= 0) call refuse('which stresses a leg gives')
    read (*, *, iostat=status) change
    if (status /= 0) call refuse('the changes of a leg')
    kstep = leg
    start = stress
    do step = 1, steps
      kinc = kinc + 1
      call find_step(real(step, dp) / steps)
      time = time + dtime
    end do
  end do

contains

  subroutine refuse(what)
    character(len=*), intent(in) :: what
    write (0, '(2a)') 'umat_driver: cannot read ', what
    stop 2
  end subroutine refuse

  ! The strain increments that bring the given stresses to their share of the leg's change.
  subroutine find_step(share)
    real(dp), intent(in) :: share
    real(dp) :: stress_now(ntens), statev_now(nstatv), energy_now(3), pnewdt
    real(dp) :: jacobian(ntens, ntens), residual(ntens), scale, misses(3), spread
    integer :: iteration, i, given

    if (step == 1) then
      ! an isochoric guess for the strains that are not given; later those of the step before
      given = count(stress_given(1:ndi) == 1)
      spread = 0
      if (given > 0) spread = -sum(change(1:ndi), mask=stress_given(1:ndi) == 0) / (steps * given)
      last = 0
      where (stress_given(1:ndi) == 1) last(1:ndi) = spread
    end if
    dstran = merge(last, change / steps, stress_given == 1)
    misses = huge(1.0_dp)
    do iteration = 1, most_iterations
      stress_now = stress
      statev_now = statev
      energy_now = energy
      call call_umat(stress_now, statev_now, energy_now, pnewdt)
      if (pnewdt < 1) then
        write (0, '(a, i0, a, f5.2)') 'umat_driver: step ', step, ': the UMAT asks for PNEWDT =', pnewdt
        stop 1
      end if
      scale = maxval(abs(stress_now))
      residual = 0
      where (stress_given == 1) residual = stress_now - (start + share * change)
      misses = [misses(2), misses(3), maxval(abs(residual)) / max(scale, tiny(1.0_dp))]
      ! round-off: it is met, and no longer comes closer
      if (misses(3) <= 0 .or. (misses(3) < 1e-10_dp .and. misses(3) >= 0.1_dp * misses(2))) exit
      if (iteration == most_iterations) then
        write (0, '(a, i0, a, es9.2)') 'umat_driver: step ', step, ': no convergence, residual', misses(3)
        stop 1
      end if
      jacobian = ddsdde
      do i = 1, ntens
        if (stress_given(i) == 1) cycle
        jacobian(i, :) = 0
        jacobian(:, i) = 0
        jacobian(i, i) = 1
      end do
      call solve(jacobian, residual)
      where (stress_given == 1) dstran = dstran - residual
    end do
    stress = stress_now
    statev = statev_now
    energy = energy_now
    stran = stran + dstran
    last = dstran
    write (*, '(i0, *(1x, es24.16e3))') iteration, misses, stress, stran, statev, energy
  end subroutine find_step

  subroutine call_umat(stress_now, statev_now, energy_now, pnewdt)
    real(dp), intent(inout) :: stress_now(ntens), statev_now(nstatv), energy_now(3)
    real(dp), intent(out) :: pnewdt
    external :: umat
    real(dp) :: rpl, ddsddt(ntens), drplde(ntens), drpldt, temp, dtemp, predef(1), dpred(1), coords(3)
    real(dp) :: drot(3, 3), celent, dfgrd0(3, 3), dfgrd1(3, 3)
    integer :: jstep(4)
    rpl = 0
    ddsddt = 0
    drplde = 0
    drpldt = 0
    temp = 0
    dtemp = 0
    predef = 0
    dpred = 0
    coords = 0
    drot = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
    dfgrd0 = drot
    dfgrd1 = drot
    celent = 1
    jstep = [kstep, 0, 0, 0]
    pnewdt = 1e10_dp
    ddsdde = 0
    call umat(stress_now, statev_now, ddsdde, energy_now(1), energy_now(2), energy_now(3), rpl, ddsddt, &
              drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, &
              ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, 1, 1, 1, 1, &
              jstep, kinc)
  end subroutine call_umat

  ! Gaussian elimination with row pivoting; the solution replaces b.
  subroutine solve(a, b)
    real(dp), intent(inout) :: a(:, :), b(:)
    real(dp) :: row(size(b)), x
    integer :: n, i, j, pivot
    n = size(b)
    do i = 1, n
      pivot = i - 1 + maxloc(abs(a(i:n, i)), 1)
      row = a(i, :)
      a(i, :) = a(pivot, :)
      a(pivot, :) = row
      x = b(i)
      b(i) = b(pivot)
      b(pivot) = x
      do j = i + 1, n
        x = a(j, i) / a(i, i)
        a(j, i:) = a(j, i:) - x * a(i, i:)
        b(j) = b(j) - x * b(i)
      end do
    end do
    do i = n, 1, -1
      b(i) = (b(i) - dot_product(a(i, i + 1:), b(i + 1:))) / a(i, i)
    end do
  end subroutine solve

end program umat_driver
