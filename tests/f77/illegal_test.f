c SPDX-License-Identifier: BSD-3-Clause
c
c Every code of DGELDA for illegal input, in the documented order of
c testing: with the input for code number i and all later ones wrong,
c code number i comes back. T, X, XPRIME, RTOL, ATOL stay.
      program illegal
      implicit none
      integer m
      do 10 m = 1, 2
        call order(m)
        call switch(m)
        call length(m)
        call bounds(m)
        call again(m)
        call twice(m)
   10 continue
      call methods
      call finish
      end

      subroutine order(m)
      implicit none
      include 'arguments.inc'
      integer m, i, k, codes(21)
      double precision tout, y(2), tol(2)
      data codes /-101, -102, -103, -104, -105, -106, -111, -120,
     $            -121, -122, -123, -107, -108, -109, -22, -115, -114,
     $            -112, -113, -116, -110/
      do 20 i = 1, 21
        call prepare(3, m)
        t = 1
        x(1) = 0
        x(2) = 1
        xprime(1) = 17
        xprime(2) = 18
        tout = 2
        do 10 k = 21, i, -1
          call spoil(codes(k), tout)
   10   continue
        y(1) = x(1)
        y(2) = x(2)
        tol(1) = rtol(1)
        tol(2) = atol(1)
        call solve(tout)
        call check(ierr .eq. codes(i), 'IERR, not the next one', ierr)
        call check(ierr .eq. codes(i), 'the next one', codes(i))
        call check(info(1) .eq. -1, 'INFO(1)', codes(i))
        call check(t .eq. 1, 'T untouched', codes(i))
        call check(x(1) .eq. y(1) .and. x(2) .eq. y(2),
     $             'X untouched', codes(i))
        call check(rtol(1) .eq. tol(1) .and. atol(1) .eq. tol(2),
     $             'RTOL and ATOL untouched', codes(i))
c       The other codes come after the reduction.
        if (i .gt. 14) goto 20
        call check(xprime(1) .eq. 17 .and. xprime(2) .eq. 18,
     $             'XPRIME untouched', codes(i))
        call check(cval(1) .eq. -77, 'CVAL untouched', codes(i))
        call check(ipar(3) + ipar(4) + ipar(5) .eq. 0,
     $             'nothing called', codes(i))
   20 continue
      end

c Makes an argument wrong.
      subroutine spoil(code, tout)
      implicit none
      include 'arguments.inc'
      integer code, minliw, minlrw
      double precision tout
      if (code .eq. -101) info(12) = 2
      if (code .eq. -102) n = 0
      if (code .eq. -103) info(9) = 1
      if (code .eq. -103) iwork(3) = 6
      if (code .eq. -104) info(10) = 1
      if (code .eq. -104) iwork(4) = -1
      if (code .eq. -105) lrw = minlrw(2, method, 5, 3) - 1
      if (code .eq. -106) liw = minliw(2, method) - 1
      if (code .eq. -111) info(7) = 1
      if (code .eq. -111) rwork(2) = 0
      if (code .eq. -120) info(14) = 1
      if (code .eq. -120) iwork(20) = 0
      if (code .eq. -121 .or. code .eq. -122) then
        info(16) = 1
        rwork(11) = 0.9d0
        rwork(12) = 0.5d0
        rwork(13) = 0.125d0
        if (code .eq. -121) rwork(11) = 1
      end if
      if (code .eq. -123) then
        info(17) = 1
        rwork(14) = 1.5d0
        rwork(15) = 2
      end if
      if (code .eq. -107) rtol(1) = -1
      if (code .eq. -108) atol(1) = -1
      if (code .eq. -109) rtol(1) = 0
      if (code .eq. -109 .or. code .eq. -114) atol(1) = 0
c     IERR = -1 from the first call of a user function on
      if (code .eq. -22) then
        ipar(7) = -1
        ipar(8) = -1
        rpar(1) = -1d300
      end if
      if (code .eq. -115) tout = t * (1 + 2d0**(-51))
      if (code .eq. -112 .or. code .eq. -113) then
        info(8) = 1
        rwork(3) = 0
        if (code .eq. -112) rwork(3) = -0.1d0
      end if
      if (code .eq. -116 .or. code .eq. -110) then
        info(4) = 1
        rwork(1) = 1.5d0
        if (code .eq. -116) rwork(1) = 0.5d0
      end if
      end

c INFO(2) ... INFO(20) are 0 or 1, INFO(1) is not below -1.
      subroutine switch(m)
      implicit none
      include 'arguments.inc'
      integer m, i
      do 10 i = 2, 20
        call prepare(3, m)
        info(i) = 2
        call solve(1d0)
        call check(ierr .eq. -101, 'INFO(i) = 2', i)
        call prepare(3, m)
        info(i) = -1
        call solve(1d0)
        call check(ierr .eq. -101, 'INFO(i) = -1', i)
   10 continue
      call prepare(3, m)
      info(1) = -2
      call solve(1d0)
      call check(ierr .eq. -101, 'INFO(1) = -2', ierr)
      end

c One element less than documented; the length needed is in IWORK(LIW).
      subroutine length(m)
      implicit none
      include 'arguments.inc'
      integer m, minliw, minlrw, k, need
      do 10 k = 0, 3
        call prepare(3, m)
        info(10) = 1
        iwork(4) = k
        need = minlrw(n, m, 5, k)
        lrw = need - 1
        call solve(1d0)
        call check(ierr .eq. -105, 'LRW too small', ierr)
        call check(iwork(liw) .eq. need, 'LRW needed', iwork(liw))
   10 continue
      do 20 k = 1, 5
        call prepare(3, m)
        info(9) = 1
        iwork(3) = k
        need = minlrw(n, m, k, 3)
        lrw = need - 1
        call solve(1d0)
        call check(ierr .eq. -105, 'LRW too small', ierr)
        call check(iwork(liw) .eq. need, 'LRW needed', iwork(liw))
   20 continue
      call prepare(3, m)
      need = minliw(n, m)
      liw = need - 1
      call solve(1d0)
      call check(ierr .eq. -106, 'LIW too small', ierr)
      call check(iwork(liw) .eq. need, 'LIW needed', iwork(liw))
c     No room even for that: nothing is written.
      call prepare(3, m)
      liw = 0
      iwork(1) = 4711
      call solve(1d0)
      call check(ierr .eq. -106, 'LIW = 0', ierr)
      call check(iwork(1) .eq. 4711, 'IWORK of length 0', iwork(1))
      end

c Ends of the ranges.
      subroutine bounds(m)
      implicit none
      integer m
      call range(m, -102, -1d0, 'NEQ = -1')
      call range(m, -103, 0d0, 'MAXORD = 0')
      call range(m, -111, -1d0, 'HMAX = -1')
      call range(m, -120, -1d0, 'NMAX = -1')
      call range(m, -121, 0.001d0, 'SAFE = 0.001')
      call range(m, -121, 1d0, 'SAFE = 1')
      call range(m, -122, 0.99d0, 'FACL = 0.99')
      call range(m, -122, -1.01d0, 'FACR = 1.01')
      call range(m, -123, 1.01d0, 'QUOT1 = 1.01')
      call range(m, -123, -0.99d0, 'QUOT2 = 0.99')
      end

c value: the wrong one; below 0 for FACR and QUOT2.
      subroutine range(m, code, value, text)
      implicit none
      include 'arguments.inc'
      integer m, code
      double precision value
      character*(*) text
      call prepare(3, m)
      if (code .eq. -102) n = nint(value)
      if (code .eq. -103) info(9) = 1
      if (code .eq. -103) iwork(3) = nint(value)
      if (code .eq. -111) info(7) = 1
      if (code .eq. -111) rwork(2) = value
      if (code .eq. -120) info(14) = 1
      if (code .eq. -120) iwork(20) = nint(value)
      if (code .eq. -121 .or. code .eq. -122) info(16) = 1
      if (code .eq. -123) info(17) = 1
      rwork(11) = 0.9d0
      rwork(12) = 5
      rwork(13) = 0.125d0
      rwork(14) = 1
      rwork(15) = 1.2d0
      if (code .eq. -121) rwork(11) = value
      if (code .eq. -122 .and. value .gt. 0) rwork(12) = value
      if (code .eq. -122 .and. value .lt. 0) rwork(13) = -value
      if (code .eq. -123 .and. value .gt. 0) rwork(14) = value
      if (code .eq. -123 .and. value .lt. 0) rwork(15) = -value
      call solve(1d0)
      call check(ierr .eq. code, text, ierr)
      end

c Codes of later calls. The counters stay.
      subroutine again(m)
      implicit none
      include 'arguments.inc'
      integer m
c     After TOUT = T.
      call prepare(3, m)
      call solve(0d0)
      info(4) = 1
      rwork(1) = -1
      call solve(0d0)
      call check(ierr .eq. -119, 'TOUT = T once more', ierr)
      call prepare(3, m)
      call solve(0d0)
      info(4) = 1
      rwork(1) = -1
      call solve(1d0)
      call check(ierr .eq. -116, 'TSTOP behind T', ierr)
c     Going on.
      call later(m, 1d0, 0.5d0, -119, 'TOUT = T')
      call later(m, 0.4d0, 0.5d0, -116, 'TSTOP behind T')
      call later(m, 1.5d0, 0.5d0, -116, 'TSTOP behind TN')
      call later(m, 9d0, 8d0, -110, 'TSTOP before TOUT')
      call later(m, 0.4d0, 8d0, -112, 'TOUT behind T')
      call later(m, 1.5d0, -107d0, -107, 'RTOL < 0')
      call later(m, 1.5d0, -108d0, -108, 'ATOL < 0')
      call later(m, 1.5d0, -109d0, -109, 'RTOL = ATOL = 0')
      end

c After a call up to 1. tstop: -107...-109 ask for wrong tolerances
c instead.
      subroutine later(m, tout, tstop, code, text)
      implicit none
      include 'arguments.inc'
      integer m, code, steps
      double precision tout, tstop, y(2), far
      character*(*) text
      call prepare(3, m)
      call solve(1d0)
      steps = iwork(11)
      far = rwork(4)
      y(1) = x(1)
      y(2) = x(2)
      if (tstop .gt. -100) info(4) = 1
      rwork(1) = tstop
      if (code .eq. -107) rtol(1) = -1
      if (code .eq. -108) atol(1) = -1
      if (code .eq. -109) rtol(1) = 0
      if (code .eq. -109) atol(1) = 0
      call solve(tout)
      call check(ierr .eq. code, text, ierr)
      call check(info(1) .eq. -1, 'INFO(1) of a later call', code)
      call check(t .eq. 1 .and. x(1) .eq. y(1) .and. x(2) .eq. y(2),
     $           'T and X of a later call', code)
      call check(iwork(11) .eq. steps .and. rwork(4) .eq. far,
     $           'counters of a later call', code)
      end

c Calling with INFO(1) = -1: -998, after illegal input -999.
      subroutine twice(m)
      implicit none
      include 'arguments.inc'
      integer m
      double precision worst
      call prepare(3, m)
      info(14) = 1
      iwork(20) = 1
      call solve(1d0)
      call check(ierr .eq. -1, 'NMAX = 1', ierr)
      call solve(1d0)
      call check(ierr .eq. -998, 'with INFO(1) = -1', ierr)
      call solve(1d0)
      call check(ierr .eq. -998, 'once more', ierr)
      call check(info(1) .eq. -1, 'INFO(1) after -998', info(1))
c     That was no harm.
      info(1) = 1
      iwork(20) = 1000
      call solve(1d0)
      call check(ierr .eq. 3, 'on after -998', ierr)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'error', m)
      call prepare(3, m)
      n = 0
      call solve(1d0)
      call check(ierr .eq. -102, 'NEQ = 0', ierr)
      call solve(1d0)
      call check(ierr .eq. -999, 'illegal input twice', ierr)
      call check(info(1) .eq. -1, 'INFO(1) after -999', info(1))
      call prepare(3, m)
      call solve(1d0)
      call solve(0.5d0)
      call check(ierr .eq. -112, 'TOUT behind T', ierr)
      call solve(2d0)
      call check(ierr .eq. -999, 'illegal input, then INFO(1)=-1', ierr)
c     INFO(1) = -1 in a first call, garbage everywhere.
      call prepare(3, m)
      info(1) = -1
      call solve(1d0)
      call check(ierr .eq. -998 .or. ierr .eq. -999, 'garbage', ierr)
c     The same for going on with what was never begun.
      call prepare(3, m)
      info(1) = 1
      call solve(1d0)
      call check(ierr .le. -101 .and. ierr .ge. -199, 'begun', ierr)
      call prepare(3, m)
      info(1) = 2
      call solve(1d0)
      call check(ierr .le. -101 .and. ierr .ge. -199, 'known', ierr)
      end

c METHOD is 1 or 2.
      subroutine methods
      implicit none
      include 'arguments.inc'
      integer k, wrong(4)
      data wrong /0, 3, -1, 12345/
      do 10 k = 1, 4
        call prepare(3, 2)
        method = wrong(k)
        call solve(1d0)
        call check(ierr .eq. -132, 'METHOD', method)
        call check(info(1) .eq. -1, 'METHOD: INFO(1)', info(1))
        call check(t .eq. 0 .and. x(1) .eq. 0 .and. x(2) .eq. 1,
     $             'METHOD: T and X', method)
   10 continue
      end
