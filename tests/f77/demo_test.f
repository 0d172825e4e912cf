c SPDX-License-Identifier: BSD-3-Clause
c
c The demonstration in the documentation of DGELDA 1.1.1: characteristic
c values, counters and errors are no worse than those of the original.
c   RTOL = ATOL = 1e-5, first TOUT = T = 0 with X = 0, then 0.1(0.1)1
      program demo
      implicit none
c     Steps of the original: BDF; Radau after a call with TOUT = T and
c     without.
      call run(1, .true., 28)
      call run(1, .false., 28)
      call run(2, .true., 69)
      call run(2, .false., 14)
      call finish
      end

c start: with the call TOUT = T.
      subroutine run(method, start, marks)
      implicit none
      integer method, marks
      logical start
      external edif, adif, fdif
      integer n, liw, lrw
      parameter (n = 2, liw = 20 + 6*n, lrw = 20 + 71*n + 114*n**2)
      integer cval(4), ipar(10), iwork(liw), info(20), iwarn, ierr, k
      double precision t, tout, x(n), xprime(n), rpar(4), rwork(lrw),
     $                 rtol, atol, y(n), error, eps
      parameter (eps = 2.0d0**(-52))

      call choose(1, ipar, rpar)
      call fresh(n, t, x, xprime, cval, iwork, liw, rwork, lrw, info,
     $           iwarn, ierr)
      rtol = 1d-5
      atol = 1d-5
      if (start) then
        tout = 0
        call dgelda(edif, adif, fdif, n, t, tout, x, xprime, cval, ipar,
     $              rpar, iwork, liw, rwork, lrw, rtol, atol, method,
     $              info, iwarn, ierr)
        call check(ierr .eq. 4, 'IERR of TOUT = T', ierr)
        call check(info(1) .eq. 2, 'INFO(1) of TOUT = T', info(1))
        call check(t .eq. 0, 'T of TOUT = T', method)
        call check(iwork(11) .eq. 0, 'no step yet', iwork(11))
        call check(abs(x(1) - 1) .le. 100*eps .and.
     $             abs(x(2) - 1) .le. 100*eps, 'X(0) = (1, 1)', method)
c       x' = (-t e^-t, -e^-t). Derivatives of order 2 are not asked
c       for: differences.
        call check(abs(xprime(1)) .le. 1d4 * eps**0.8d0 .and.
     $             abs(xprime(2) + 1) .le. 1d4 * eps**0.8d0,
     $             'XPRIME(0) = (0, -1)', method)
      end if
      do 20 k = 1, 10
        tout = k / 10d0
        call dgelda(edif, adif, fdif, n, t, tout, x, xprime, cval, ipar,
     $              rpar, iwork, liw, rwork, lrw, rtol, atol, method,
     $              info, iwarn, ierr)
        call check(ierr .eq. 3, 'IERR', ierr)
        call check(info(1) .eq. 1, 'INFO(1)', info(1))
        call check(t .eq. tout, 'T = TOUT', k)
        call check(rwork(4) .ge. t, 'RWORK(4) is the farthest point', k)
        call check(rwork(3) .gt. 0 .and. rwork(7) .gt. 0,
     $             'step sizes point forward', k)
c       A purely algebraic problem: nothing but rounding.
        call exact(n, t, ipar, y)
        error = max(abs(x(1) - y(1)), abs(x(2) - y(2)))
        call check(error .le. 100*eps, 'error at output', k)
        if (method .eq. 1) then
          call check(iwork(7) .ge. 1 .and. iwork(7) .le. 5,
     $               'next order', iwork(7))
          call check(iwork(8) .ge. 1 .and. iwork(8) .le. 5,
     $               'last order', iwork(8))
        end if
   20 continue
      call check(cval(1) .eq. 1, 'mu', cval(1))
      call check(cval(2) .eq. 0, 'd', cval(2))
      call check(cval(3) .eq. 2, 'a', cval(3))
      call check(cval(4) .eq. 0, 'u', cval(4))
      call check(iwork(11) .ge. 1 .and. iwork(11) .le. marks,
     $           'number of steps', iwork(11))
      call check(iwork(12) .ge. iwork(11), 'evaluations', iwork(12))
      call check(iwork(14) .ge. 0 .and. iwork(14) .le. 1,
     $           'error test failures', iwork(14))
      call check(iwork(15) .eq. 0, 'other failures', iwork(15))
      call check(iwork(3) .eq. 5 .and. iwork(4) .eq. 3 .and.
     $           iwork(20) .eq. 10000, 'defaults in IWORK', method)
      call check(rwork(11) .eq. 0.9d0 .and. rwork(12) .eq. 5 .and.
     $           rwork(13) .eq. 0.125d0 .and. rwork(14) .eq. 1 .and.
     $           rwork(15) .eq. 1.2d0, 'defaults in RWORK', method)
      call check(ipar(6) .le. 3, 'orders up to MXINDX', ipar(6))
      call check(ipar(9) .eq. 0, 'arguments of EDIF...', ipar(9))
      end
