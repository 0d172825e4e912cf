c SPDX-License-Identifier: BSD-3-Clause
c
c The codes of DGELDA for what happens while it integrates, -1 ... -26,
c and how to go on. Not among them, because nothing produces them: -8
c (E1; A2 is nonsingular, so the matrix of a step is, if the step is
c small enough), -23 (was: work space), -25 (likewise).
      program codes
      implicit none
      integer m
      do 10 m = 1, 2
        call nsteps(m)
        call tight(m)
        call weight(m)
        call small(m)
        call failed(m)
        call absent(m)
        call start(m)
        call contra(m)
        call change(m)
   10 continue
      call finish
      end

c What every interruption leaves behind: IERR = code, INFO(1) = -1,
c T = TN within [low, high], X the solution there.
      subroutine after(code, low, high)
      implicit none
      include 'arguments.inc'
      integer code
      double precision low, high, worst
      call check(ierr .eq. code, 'IERR, not the next one', ierr)
      call check(ierr .eq. code, 'the next one', code)
      call check(info(1) .eq. -1, 'INFO(1)', code)
      call check(t .ge. low .and. t .le. high, 'T', code)
      call check(rwork(4) .eq. t, 'T = TN = RWORK(4)', code)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'X', code)
      call check(iwork(11) .ge. 0 .and. iwork(11) .le. 10000 .and.
     $           iwork(12) .ge. 0 .and. iwork(12) .le. 100000 .and.
     $           iwork(13) .ge. 0 .and. iwork(13) .le. 100000 .and.
     $           iwork(14) .ge. 0 .and. iwork(14) .le. 10000,
     $           'counters', code)
      call check(ipar(9) .eq. 0, 'arguments of EDIF...', code)
      end

      subroutine nsteps(m)
      implicit none
      include 'arguments.inc'
      integer m
      call prepare(3, m)
      info(14) = 1
      iwork(20) = 3
      call solve(1d0)
      call after(-1, 0d0, 1d0)
      call check(iwork(11) .ge. 1 .and. iwork(11) .le. 3, '3', m)
      iwork(20) = 10000
      info(1) = 1
      call solve(1d0)
      call check(ierr .eq. 3, 'on after -1', ierr)
      call check(iwork(11) .gt. 3, 'counters go on', iwork(11))
c     Or afresh, from a new point.
      info(1) = 0
      call exact(n, t, ipar, x)
      call solve(2d0)
      call check(ierr .eq. 3 .and. t .eq. 2, 'afresh', ierr)
      end

c Tolerances of 1e-16: multiplied by 100 eps times the norm of X = (1,
c 1) in units of 2e-16.
      subroutine tight(m)
      implicit none
      include 'arguments.inc'
      integer m, k
      double precision factor, tol, worst
      call prepare(2, m)
      rtol(1) = 1d-16
      atol(1) = 1d-16
      call solve(0.1d0)
      call after(-2, 0d0, 0d0)
      factor = 100 * 2d0**(-52) / 2d-16
      tol = 1d-16 * factor
      call check(abs(rtol(1) - tol) .le. 1d-12*tol, 'RTOL times', m)
      call check(abs(atol(1) - tol) .le. 1d-12*tol, 'ATOL times', m)
      do 10 k = 1, 20
        info(1) = 1
        call solve(0.1d0)
        if (ierr .ne. -2 .and. ierr .ne. -1) goto 20
   10 continue
   20 call check(ierr .eq. 3, 'on after -2', ierr)
c     Rounding errors of some hundred steps come on top.
      call check(worst(n, t, x, ipar, rtol(1)) .le. 100, '-2: error', m)
c     Arrays: every element, by the same factor.
      call prepare(2, m)
      info(2) = 1
      rtol(1) = 1d-17
      rtol(2) = 3d-17
      atol(1) = 1d-17
      atol(2) = 1d-17
      call solve(0.1d0)
      call after(-2, 0d0, 0d0)
      factor = rtol(1) / 1d-17
      call check(factor .gt. 1, 'factor', m)
      call check(abs(rtol(2)/3d-17 - factor) .le. 1d-12*factor .and.
     $           abs(atol(1)/1d-17 - factor) .le. 1d-12*factor .and.
     $           abs(atol(2)/1d-17 - factor) .le. 1d-12*factor,
     $           'all by the same factor', m)
      end

c X(1) becomes 0 at 1/2 while ATOL(1) = 0.
      subroutine weight(m)
      implicit none
      include 'arguments.inc'
      integer m
      call prepare(10, m)
      info(2) = 1
      x(1) = 0.125d0
      x(2) = 1
      atol(1) = 0
      call solve(2d0)
      call check(ierr .eq. -3, 'weight 0: IERR', ierr)
      call check(info(1) .eq. -1, 'weight 0: INFO(1)', info(1))
      call check(t .ge. 0.5d0 .and. t .lt. 2, 'weight 0: T', m)
      call check(x(1) .eq. 0 .and. x(2) .eq. 1, 'weight 0: X', m)
      atol(1) = 1d-6
      info(1) = 1
      call solve(2d0)
      call check(ierr .eq. 3 .and. t .eq. 2, 'on after -3', ierr)
      end

c x1' jumps by 1e30 at 1/2: no step over it is small enough.
      subroutine small(m)
      implicit none
      include 'arguments.inc'
      integer m
      call prepare(9, m)
      x(1) = 1
      x(2) = 1
      call solve(1d0)
      call check(ierr .eq. -6, 'step size: IERR', ierr)
      call check(info(1) .eq. -1, 'step size: INFO(1)', info(1))
      call check(t .le. 0.5d0, 'step size: T <= 1/2', m)
c     Steps that end before the jump succeed, those over it are cut.
      call check(t .ge. 0.5d0 - 1d-6, 'step size: T', m)
      call check(rwork(4) .eq. t, 'step size: RWORK(4)', m)
      call check(max(abs(x(1) - 1), abs(x(2) - 1)) .le. 1d-5,
     $           'step size: X', m)
      call check(iwork(14) .ge. 1, 'error test failures', iwork(14))
      end

c Functions that return -1, other codes, NaN: smaller steps, then -10.
      subroutine failed(m)
      implicit none
      include 'arguments.inc'
      integer m, k, codes(5), times(3), j
      double precision worst
      data codes /-1, 1, 7, -3, 99/
      data times /1, 3, -1/
      do 20 k = 1, 5
        do 10 j = 1, 3
          call prepare(4, m)
          ipar(7) = codes(k)
          ipar(8) = times(j)
          rpar(1) = 0.5d0
          call solve(0.5d0)
          if (ierr .eq. 3) call solve(1d0)
          if (times(j) .gt. 0) then
            call check(ierr .eq. 3, 'retried', ierr)
            call check(ipar(10) .eq. times(j), 'returned', ipar(10))
            call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'X', k)
          else
            call after(-10, 0d0, 0.5d0)
            call check(iwork(15) .ge. 1, 'other failures', iwork(15))
c           The user repairs his function.
            ipar(7) = 0
            info(1) = 1
            call solve(1d0)
            call check(ierr .eq. 3, 'on after -10', ierr)
            call check(worst(n, t, x, ipar, 1d-6) .le. 10, '-10', k)
          end if
   10   continue
   20 continue
      end

c Functions that return -2: at once -21, at the start too.
      subroutine absent(m)
      implicit none
      include 'arguments.inc'
      integer m
      call prepare(4, m)
      ipar(7) = -2
      ipar(8) = -1
      rpar(1) = 0.5d0
      call solve(1d0)
      call after(-21, 0d0, 0.5d0)
      call check(ipar(10) .eq. 1, 'calls that returned -2', ipar(10))
      call prepare(4, m)
      ipar(7) = -2
      ipar(8) = -1
      rpar(1) = -1
      call solve(1d0)
      call check(ierr .eq. -21, '-2 at the start', ierr)
      call check(ipar(10) .eq. 1, 'calls that returned -2', ipar(10))
      call check(info(1) .eq. -1, '-21: INFO(1)', info(1))
c     With constant matrices.
      call prepare(4, m)
      info(5) = 1
      ipar(7) = -2
      ipar(8) = -1
      rpar(1) = 0.5d0
      call solve(1d0)
      call after(-21, 0d0, 0.5d0)
      end

c -22: no index: a function fails, is NaN, the index is above MXINDX,
c a rank is unclear.
      subroutine start(m)
      implicit none
      include 'arguments.inc'
      integer m, k, codes(4)
      data codes /-1, 1, -3, 99/
      do 10 k = 1, 4
        call prepare(4, m)
        ipar(7) = codes(k)
        ipar(8) = -1
        rpar(1) = -1
        call solve(1d0)
        call after(-22, 0d0, 0d0)
        call check(iwork(11) .eq. 0, 'no step', iwork(11))
   10 continue
      call prepare(4, m)
      info(10) = 1
      iwork(4) = 1
      call solve(1d0)
      call after(-22, 0d0, 0d0)
      call check(cval(1) .eq. -1, 'CVAL(1) above MXINDX', cval(1))
c     diag(1, 1e-14) x' = -x: the second equation is as likely algebraic.
      call prepare(8, m)
      rpar(4) = 1d-14
      call solve(1d0)
      call after(-22, 0d0, 0d0)
      end

c 0 = r with u = 1.
      subroutine contra(m)
      implicit none
      include 'arguments.inc'
      integer m, k
      double precision worst
      do 10 k = 0, 1
        call prepare(7, m)
        info(5) = k
        rpar(4) = 1
        call solve(1d0)
        call after(-24, 0d0, 0d0)
        call prepare(7, m)
        info(5) = k
        call solve(0.5d0)
        call check(ierr .eq. 3, 'r = 0', ierr)
        call check(cval(1) .eq. 0 .and. cval(2) .eq. 1 .and. cval(3)
     $             .eq. 0 .and. cval(4) .eq. 1, '(0, 1, 0, 1)', m)
        call check(worst(1, t, x, ipar, 1d-6) .le. 10, 'X(1)', m)
c       x2 = 1 is free, and held up to rounding in every step.
        call check(abs(x(2) - 1) .le. iwork(11) * 100 * 2d0**(-52),
     $             'X(2)', m)
        rpar(4) = 1
        call solve(9d0)
        call check(ierr .eq. -24, 'r = 1 later', ierr)
        call check(info(1) .eq. -1, 'r = 1 later: INFO(1)', info(1))
        call check(rwork(4) .eq. t, 'r = 1 later: T = TN', m)
   10 continue
      end

c The characteristic values change at 0.4.
      subroutine change(m)
      implicit none
      include 'arguments.inc'
      integer m
      double precision worst
      call prepare(6, m)
      call solve(1d0)
      call after(-26, 0.39d0, 0.4d0)
      call check(cval(1) .eq. 0 .and. cval(2) .eq. 1 .and. cval(3)
     $           .eq. 1 .and. cval(4) .eq. 0, 'new CVAL', cval(2))
c     A new problem from there.
      t = 0.4d0
      call exact(n, t, ipar, x)
      info(1) = 0
      call solve(1d0)
      call check(ierr .eq. 3 .and. t .eq. 1, 'afresh after -26', ierr)
      call check(cval(2) .eq. 1 .and. cval(3) .eq. 1, 'CVAL', cval(2))
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'error', m)
      end
