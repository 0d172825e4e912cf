c SPDX-License-Identifier: BSD-3-Clause
c
c INFO(2) ... INFO(10) of DGELDA, one after the other, both methods.
      program options
      implicit none
      integer m
      do 10 m = 1, 2
        call arrays(m)
        call output(m)
        call stops(m)
        call consts(m)
        call unused(m)
        call limit(m)
        call first(m)
        call orders(m)
        call index(m)
   10 continue
      call finish
      end

c INFO(2): tolerances for each component.
      subroutine arrays(m)
      implicit none
      include 'arguments.inc'
      integer m
      double precision y(2), z(2), zero
      call prepare(3, m)
c     Scalars: only the first elements count.
      zero = 0
      rtol(2) = zero / zero
      atol(2) = zero / zero
      call solve(1d0)
      call check(ierr .eq. 3, 'INFO(2) = 0: IERR', ierr)
      y(1) = x(1)
      y(2) = x(2)
c     Arrays of equal elements are the same.
      call prepare(3, m)
      info(2) = 1
      call solve(1d0)
      call check(ierr .eq. 3, 'INFO(2) = 1: IERR', ierr)
      call check(x(1) .eq. y(1) .and. x(2) .eq. y(2),
     $           'arrays of equal tolerances', m)
c     x2 has a tolerance of its own, relative and absolute.
      call prepare(3, m)
      info(2) = 1
      rtol(1) = 1d-2
      atol(1) = 1d-2
      rtol(2) = 1d-8
      atol(2) = 1d-9
      call solve(1d0)
      call exact(n, t, ipar, z)
      call check(ierr .eq. 3, 'different tolerances: IERR', ierr)
      call check(abs(x(2) - z(2)) .le. 10*(1d-8*abs(z(2)) + 1d-9),
     $           'component with the tight tolerance', m)
      end

c INFO(3) = 1: return after every step; switched between calls.
      subroutine output(m)
      implicit none
      include 'arguments.inc'
      integer m, k, steps
      double precision before, worst
      call prepare(3, m)
      info(3) = 1
      steps = 0
      do 10 k = 1, 10000
        before = t
        call solve(1d0)
        if (ierr .ne. 1) goto 20
        call check(iwork(11) .eq. steps + 1, 'one step a call', m)
        call check(t .gt. before .and. t .lt. 1, 'T of a step', m)
        call check(rwork(4) .eq. t, 'RWORK(4) = T at a step', m)
        call check(abs(rwork(7) - (t - before)) .le.
     $             4 * 2d0**(-52) * t, 'RWORK(7), the step', m)
        call check(worst(n, t, x, ipar, 1d-6) .le. 10,
     $             'error at a step', m)
        steps = iwork(11)
   10 continue
   20 call check(steps .ge. 3, 'number of steps', steps)
      call check(ierr .eq. 3, 'INFO(3) = 1: IERR at TOUT', ierr)
      call check(t .eq. 1, 'INFO(3) = 1: T = TOUT', m)
      call check(rwork(4) .ge. t, 'RWORK(4) >= TOUT', m)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'error at TOUT', m)
      info(3) = 0
      call solve(2d0)
      call check(ierr .eq. 3, 'switched off: IERR', ierr)
      call check(t .eq. 2, 'switched off: T', m)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10,
     $           'switched off: error', m)
      info(3) = 1
      call solve(20d0)
      call check(ierr .eq. 1, 'switched on: IERR', ierr)
      call check(t .gt. 2 .and. t .lt. 20, 'switched on: T', m)
      end

c INFO(4) = 1: nothing is evaluated beyond RWORK(1).
      subroutine stops(m)
      implicit none
      include 'arguments.inc'
      integer m, k
      double precision worst, direct
      do 10 k = 1, 2
        direct = 3 - 2*k
        call prepare(3, m)
        info(4) = 1
        rwork(1) = direct
        call solve(0.9d0 * direct)
        call check(ierr .eq. 3, 'INFO(4) = 1: IERR', ierr)
        call solve(direct)
        call check(ierr .eq. 2 .or. ierr .eq. 3, 'TOUT = TSTOP', ierr)
        call check(t .eq. direct, 'T = TSTOP', m)
        if (k .eq. 1) call check(rpar(3) .le. 1, 'beyond TSTOP', m)
        if (k .eq. 2) call check(rpar(2) .ge. -1, 'beyond -TSTOP', m)
        call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'at TSTOP', m)
c       A stop point may be lifted, and set again.
        info(4) = 0
        call solve(2 * direct)
        call check(ierr .eq. 3 .and. t .eq. 2 * direct,
     $             'without TSTOP again', ierr)
        info(4) = 1
        rwork(1) = 4 * direct
        call solve(3.9d0 * direct)
        call check(ierr .eq. 3, 'TSTOP set anew', ierr)
        if (k .eq. 1) call check(rpar(3) .le. 4, 'new TSTOP', m)
        if (k .eq. 2) call check(rpar(2) .ge. -4, 'new -TSTOP', m)
        call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'at 3.9', m)
   10 continue
c     A stop point that a step has reached before TOUT does, T = 0.
      do 20 k = 0, 1
        call prepare(2, m)
        t = 1
        call exact(n, t, ipar, x)
        info(4) = 1
        info(5) = k
        rwork(1) = 0
        call solve(0.001d0)
        call check(ierr .eq. 3, 'short of TSTOP = 0', ierr)
        call solve(0d0)
        call check(ierr .eq. 2 .or. ierr .eq. 3, 'TSTOP = 0', ierr)
        call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'at 0', m)
        call check(rpar(2) .ge. 0, 'beyond 0', m)
   20 continue
c     The Radau method never passes TOUT.
      if (m .ne. 2) return
      call prepare(3, m)
      call solve(0.7d0)
      call check(rpar(3) .le. 0.7d0, 'Radau beyond TOUT', m)
      call check(rwork(4) .le. 0.7d0, 'Radau: RWORK(4)', m)
      end

c INFO(5) = 1: EDIF and ADIF are called in the first call only.
      subroutine consts(m)
      implicit none
      include 'arguments.inc'
      integer m, problem, ecalls, acalls, start
      double precision worst
      do 20 problem = 2, 4
        do 10 start = 0, 1
          call prepare(problem, m)
          info(5) = 1
          if (start .eq. 1) call solve(0d0)
          if (start .eq. 1) call check(ierr .eq. 4, 'start', ierr)
          if (start .eq. 0) call solve(0.1d0)
          if (start .eq. 0) call check(ierr .eq. 3, 'const.', ierr)
          ecalls = ipar(3)
          acalls = ipar(4)
          call solve(1d0)
          call check(ierr .eq. 3, 'INFO(5) = 1: IERR', ierr)
          call check(ipar(3) .eq. ecalls, 'EDIF called', ipar(3))
          call check(ipar(4) .eq. acalls, 'ADIF called', ipar(4))
          call check(worst(n, t, x, ipar, 1d-6) .le. 10,
     $               'INFO(5) = 1: error', problem)
   10   continue
   20 continue
      end

c INFO(6), INFO(13), INFO(18..20) may be 1 and change nothing.
      subroutine unused(m)
      implicit none
      include 'arguments.inc'
      integer m, k, which(5)
      double precision y(2)
      data which /6, 13, 18, 19, 20/
      call prepare(3, m)
      call solve(1d0)
      y(1) = x(1)
      y(2) = x(2)
      do 10 k = 1, 5
        call prepare(3, m)
        info(which(k)) = 1
        call solve(1d0)
        call check(ierr .eq. 3, 'unused: IERR', ierr)
        call check(x(1) .eq. y(1) .and. x(2) .eq. y(2),
     $             'unused option', which(k))
   10 continue
      end

c INFO(7) = 1: no step larger than RWORK(2).
      subroutine limit(m)
      implicit none
      include 'arguments.inc'
      integer m, k
      call prepare(3, m)
      info(3) = 1
      info(7) = 1
      rwork(2) = 0.01d0
      do 10 k = 1, 1000
        call solve(0.5d0)
        call check(abs(rwork(7)) .le. 0.01d0 * (1 + 2d0**(-50)),
     $             'step above HMAX', k)
        if (ierr .ne. 1) goto 20
   10 continue
   20 call check(ierr .eq. 3, 'INFO(7) = 1: IERR', ierr)
      call check(iwork(11) .ge. 50, 'INFO(7) = 1: steps', iwork(11))
      end

c INFO(8) = 1: RWORK(3) is the first step, in either direction, also
c after a call with TOUT = T.
      subroutine first(m)
      implicit none
      include 'arguments.inc'
      integer m, k, start
      double precision h
      do 20 k = 1, 2
        do 10 start = 0, 1
          h = 1d-5
          if (k .eq. 2) h = -1d-5
          call prepare(3, m)
          info(3) = 1
          info(8) = 1
          rwork(3) = h
          if (start .eq. 1) then
            call solve(0d0)
            call check(ierr .eq. 4, 'H0: IERR of TOUT = T', ierr)
            call check(rwork(3) .eq. h, 'H0 kept', k)
          end if
          call solve(h * 1d5)
          call check(ierr .eq. 1, 'H0: IERR', ierr)
          call check(t .eq. h, 'H0: T', start)
          call check(rwork(7) .eq. h, 'H0: RWORK(7)', start)
   10   continue
   20 continue
      end

c INFO(9) = 1: highest order in IWORK(3), which is reached. In low
c orders the errors of the steps, each about a tolerance, add up.
      subroutine orders(m)
      implicit none
      include 'arguments.inc'
      integer m, k, highest, maxord
      double precision worst
      do 30 maxord = 1, 5
        call prepare(3, m)
        info(3) = 1
        info(9) = 1
        iwork(3) = maxord
        rtol(1) = 1d-4
        atol(1) = 1d-4
        highest = 0
        do 10 k = 1, 10000
          call solve(3d0)
          if (m .eq. 1) highest = max(highest, iwork(8))
          if (m .eq. 1) call check(iwork(7) .le. maxord, 'next', k)
          if (ierr .ne. 1) goto 20
   10   continue
   20   call check(ierr .eq. 3, 'MAXORD: IERR', ierr)
        call check(iwork(3) .eq. maxord, 'MAXORD kept', iwork(3))
        call check(worst(n, t, x, ipar, 1d-4) .le. max(10, iwork(11)),
     $             'MAXORD: error', maxord)
        if (m .eq. 1) call check(highest .le. maxord, 'above', maxord)
c       Order 3 pays at this tolerance; what is above may.
        if (m .eq. 1) call check(highest .ge. min(maxord, 3),
     $                           'MAXORD is used', maxord)
   30 continue
      end

c INFO(10) = 1: largest index in IWORK(4), and no derivative above it.
      subroutine index(m)
      implicit none
      include 'arguments.inc'
      integer m, mxindx, problem, mu(4)
      data mu /1, 0, 0, 2/
      do 20 problem = 1, 4
        do 10 mxindx = 0, 3
          call prepare(problem, m)
          info(10) = 1
          iwork(4) = mxindx
          call solve(0d0)
          call check(ipar(6) .le. mxindx, 'order asked for', ipar(6))
          call check(iwork(4) .eq. mxindx, 'MXINDX kept', iwork(4))
          if (mxindx .lt. mu(problem)) then
            call check(ierr .eq. -22, 'index too high', ierr)
            call check(cval(1) .eq. -1, 'CVAL(1)', cval(1))
          else
            call check(ierr .eq. 4, 'index found', ierr)
            call check(cval(1) .eq. mu(problem), 'index', cval(1))
            ipar(6) = 0
            call solve(1d0)
            call check(ierr .eq. 3, 'MXINDX: IERR', ierr)
            call check(ipar(6) .le. mu(problem), 'later', ipar(6))
          end if
   10   continue
   20 continue
      end
