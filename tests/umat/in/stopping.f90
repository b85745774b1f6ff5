! A UMAT that is elastic until increment PROPS(1), and stops there.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &
                time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, &
                nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, &
                kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc, i
  double precision :: stress(ntens), statev(*), ddsdde(ntens, ntens), sse, spd, scd, rpl, &
                      ddsddt(ntens), drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), &
                      dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), drot(3, 3), &
                      pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  do i = 1, ntens
    ddsdde(i, i) = merge(1d7, 5d6, i <= 3)
    stress(i) = stress(i) + ddsdde(i, i)*dstran(i)
  end do
  if (kinc >= nint(props(1))) stop 'the material has had enough'
end subroutine
