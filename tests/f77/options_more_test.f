c SPDX-License-Identifier: BSD-3-Clause
c
c INFO(11) ... INFO(17) of DGELDA, one after the other, both methods.
      program more
      implicit none
      integer m
      do 10 m = 1, 2
        call accept(m)
        call variant(m)
        call slopes(m)
        call count(m)
        call control(m)
        call factors(m)
        call quotas(m)
   10 continue
      call finish
      end

c INFO(11): 0: the nearest consistent point; 1: X is taken as it is.
      subroutine accept(m)
      implicit none
      include 'arguments.inc'
      integer m
      double precision eps
      parameter (eps = 2d0**(-52))
c     0 = x1 - x2; (1, 0.5) is nearest to itself in (0.75, 0.75).
      call prepare(2, m)
      x(2) = 0.5d0
      call solve(0d0)
      call check(ierr .eq. 4, 'INFO(11) = 0: IERR', ierr)
      call check(max(abs(x(1) - 0.75d0), abs(x(2) - 0.75d0)) .le.
     $           10*eps, 'nearest consistent point', m)
      call prepare(2, m)
      info(11) = 1
      call solve(0d0)
      call check(ierr .eq. 4, 'INFO(11) = 1: IERR', ierr)
      call check(x(1) .eq. 1 .and. x(2) .eq. 1, 'X as given', m)
      call solve(1d0)
      call check(ierr .eq. 3, 'INFO(11) = 1: IERR at TOUT', ierr)
      call check(abs(x(1) - exp(-1d0)) .le. 10 * 1d-6 * (1+exp(-1d0)),
     $           'INFO(11) = 1: X(1) at TOUT', m)
      end

c INFO(12) = 1: the differential components stay.
      subroutine variant(m)
      implicit none
      include 'arguments.inc'
      integer m, k
      double precision worst, eps
      parameter (eps = 2d0**(-52))
      do 10 k = 1, 2
        call prepare(2, m)
        info(12) = 1
        x(2) = -7
        if (k .eq. 1) call solve(0d0)
        if (k .eq. 1) call check(ierr .eq. 4, 'INFO(12): 4', ierr)
        if (k .eq. 1) call check(abs(x(1) - 1) .le. eps, 'X(1)', m)
        if (k .eq. 1) call check(abs(x(2)-1) .le. 10*eps, 'X(2)', m)
        call solve(1d0)
        call check(ierr .eq. 3, 'INFO(12) = 1: IERR', ierr)
        call check(worst(n, t, x, ipar, 1d-6) .le. 10,
     $             'the solution through X(1) = 1', m)
   10 continue
c     d = 0: the null space of E1 is everything.
      call prepare(1, m)
      x(1) = 5
      x(2) = -3
      info(12) = 1
      call solve(0d0)
      call check(ierr .eq. 4, 'd = 0: IERR', ierr)
      call check(max(abs(x(1) - 1), abs(x(2) - 1)) .le. 100*eps,
     $           'd = 0: X', m)
      end

c XPRIME after the start is the derivative of the solution: x' = -x.
c It takes a difference quotient of order 4 of the constraint.
      subroutine slopes(m)
      implicit none
      include 'arguments.inc'
      integer m
      double precision bound
      bound = 1d4 * 2d0**(-52 * 0.8d0)
      call prepare(2, m)
      call solve(0d0)
      call check(abs(xprime(1) + 1) .le. bound, 'XPRIME(1) = -1', m)
      call check(abs(xprime(2) + 1) .le. bound, 'XPRIME(2) = -1', m)
c     (cos t, -sin t, -cos t)
      call prepare(4, m)
      call solve(0d0)
      call check(abs(xprime(1) - 1) .le. bound, 'XPRIME(1) = 1', m)
      call check(abs(xprime(2)) .le. bound, 'XPRIME(2) = 0', m)
      call check(abs(xprime(3) + 1) .le. bound, 'XPRIME(3) = -1', m)
      end

c INFO(14) = 1: at most IWORK(20) steps in one call, then IERR = -1 and
c on with INFO(1) = 1.
      subroutine count(m)
      implicit none
      include 'arguments.inc'
      integer m, k, before, calls
      double precision worst
      call prepare(3, m)
      info(14) = 1
      iwork(20) = 4
      before = 0
      calls = 0
      do 10 k = 1, 1000
        call solve(3d0)
        if (ierr .ne. -1) goto 20
        calls = calls + 1
        call check(info(1) .eq. -1, 'INFO(1) after -1', info(1))
        call check(iwork(11) - before .ge. 1 .and.
     $             iwork(11) - before .le. 4, 'NMAX steps', iwork(11))
        call check(t .eq. rwork(4), 'T = TN after -1', k)
        call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'X', k)
        before = iwork(11)
        info(1) = 1
   10 continue
   20 call check(calls .ge. 2, 'interruptions', calls)
      call check(ierr .eq. 3, 'INFO(14) = 1: IERR', ierr)
      call check(info(1) .eq. 1, 'INFO(14) = 1: INFO(1)', info(1))
      call check(iwork(20) .eq. 4, 'NMAX kept', iwork(20))
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'NMAX: error', m)
      end

c INFO(15) = 1: another step size control for Radau, nothing for BDF.
      subroutine control(m)
      implicit none
      include 'arguments.inc'
      integer m
      double precision y(2), worst
      call prepare(3, m)
      call solve(3d0)
      y(1) = x(1)
      y(2) = x(2)
      call prepare(3, m)
      info(15) = 1
      call solve(3d0)
      call check(ierr .eq. 3, 'INFO(15) = 1: IERR', ierr)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'INFO(15)', m)
      if (m .eq. 1) call check(x(1) .eq. y(1) .and. x(2) .eq. y(2),
     $                         'INFO(15) = 1 and BDF', m)
      end

c INFO(16) = 1: Radau's steps grow by no more than 1/FACR = 1.5. Where
c the step is bounded by the error, it is smaller for a smaller SAFE.
      subroutine factors(m)
      implicit none
      include 'arguments.inc'
      integer m, k, steps
      double precision before, y(2), worst
      call prepare(3, m)
      call solve(3d0)
      steps = iwork(11)
      y(1) = x(1)
      y(2) = x(2)
      call prepare(3, m)
      info(3) = 1
      info(8) = 1
      info(16) = 1
      rwork(3) = 1d-6
      rwork(11) = 0.9d0
      rwork(12) = 5
      rwork(13) = 1 / 1.5d0
      before = 1d-6
      do 10 k = 1, 1000
        call solve(3d0)
        if (ierr .ne. 1) goto 20
        if (m .eq. 2) call check(rwork(7) .le. before * 1.5d0 *
     $                           (1 + 2d0**(-40)), 'FACR', k)
        before = rwork(7)
   10 continue
   20 call check(ierr .eq. 3, 'INFO(16) = 1: IERR', ierr)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'INFO(16)', m)
      call prepare(3, m)
      info(16) = 1
      rwork(11) = 0.3d0
      rwork(12) = 5
      rwork(13) = 0.125d0
      call solve(3d0)
      call check(ierr .eq. 3, 'SAFE: IERR', ierr)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'SAFE', m)
      call check(rwork(11) .eq. 0.3d0, 'SAFE kept', m)
      if (m .eq. 2) call check(iwork(11) .gt. steps, 'SAFE', iwork(11))
      if (m .eq. 1) call check(x(1) .eq. y(1) .and. x(2) .eq. y(2),
     $                         'SAFE and BDF', m)
      end

c INFO(17) = 1: with constant matrices Radau keeps H, and with it the
c factorization, if QUOT1 <= HNEW/H <= QUOT2. HNEW/H is at most
c 1/FACR = 8, so with QUOT2 = 10 steps of 0.01, far too small, stay.
      subroutine quotas(m)
      implicit none
      include 'arguments.inc'
      integer m, k
      double precision worst
      call prepare(3, m)
      info(3) = 1
      info(5) = 1
      info(8) = 1
      info(17) = 1
      rwork(3) = 0.01d0
      rwork(14) = 0.5d0
      rwork(15) = 10
      do 10 k = 1, 1000
        call solve(0.5d0)
        if (ierr .ne. 1) goto 20
        if (m .eq. 2) call check(abs(rwork(7) - 0.01d0) .le. 1d-15,
     $                           'H kept', k)
   10 continue
   20 call check(ierr .eq. 3, 'INFO(17) = 1: IERR', ierr)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'INFO(17)', m)
      if (m .eq. 1) return
c     The last step may be cut or stretched by rounding.
      call check(abs(iwork(11) - 50) .le. 1, 'steps', iwork(11))
c     In one call: without the option two for each of the 50 steps.
      call prepare(3, m)
      info(5) = 1
      info(8) = 1
      info(17) = 1
      rwork(3) = 0.01d0
      rwork(14) = 0.5d0
      rwork(15) = 10
      call solve(0.5d0)
      call check(abs(iwork(11) - 50) .le. 1, 'steps', iwork(11))
      call check(iwork(13) .le. 25, 'factorizations', iwork(13))
      end
