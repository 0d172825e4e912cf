c SPDX-License-Identifier: BSD-3-Clause
c
c SFMDAE by both methods: values against the equations of the angles,
c constraints, calls one step at a time and in turns with another
c problem, failures of the subroutines, derivatives that are wrong,
c illegal input.
      program swing
      implicit none
      integer m
      do 10 m = 1, 2
        call follow(m)
        call driven(m)
        call turns(m)
        call values(m)
        call fail(m)
        call wrong(m)
        call refuse(m)
   10 continue
      call finish
      end

c Accelerations of the angles from the vertical, rods a = 1, b = 0.8,
c masses 1 and 2 (any textbook).
      subroutine angles(y, f)
      implicit none
      double precision y(4), f(4), c, s, m11, m12, m22, r1, r2, det, g,
     $                 b
      parameter (g = 9.81d0, b = 0.8d0)
      c = cos(y(1) - y(2))
      s = sin(y(1) - y(2))
      m11 = 3
      m12 = 2 * b * c
      m22 = 2 * b**2
      r1 = -2 * b * s * y(4)**2 - 3 * g * sin(y(1))
      r2 = 2 * b * s * y(3)**2 - 2 * g * b * sin(y(2))
      det = m11 * m22 - m12**2
      f(1) = y(3)
      f(2) = y(4)
      f(3) = (m22 * r1 - m12 * r2) / det
      f(4) = (m11 * r2 - m12 * r1) / det
      end

c Their values at t = 1, in steps of order 4 that are small enough.
      subroutine refer(y)
      implicit none
      integer i, j, steps
      parameter (steps = 20000)
      double precision y(4), z(4), k1(4), k2(4), k3(4), k4(4), h
      h = 1d0 / steps
      y(1) = atan2(0.6d0, 0.8d0)
      y(2) = acos(0d0)
      y(3) = 0
      y(4) = 0
      do 50 i = 1, steps
        call angles(y, k1)
        do 10 j = 1, 4
          z(j) = y(j) + h/2 * k1(j)
   10   continue
        call angles(z, k2)
        do 20 j = 1, 4
          z(j) = y(j) + h/2 * k2(j)
   20   continue
        call angles(z, k3)
        do 30 j = 1, 4
          z(j) = y(j) + h * k3(j)
   30   continue
        call angles(z, k4)
        do 40 j = 1, 4
          y(j) = y(j) + h/6 * (k1(j) + 2*k2(j) + 2*k3(j) + k4(j))
   40   continue
   50 continue
      end

      double precision function length()
      implicit none
      double precision g(2)
      include 'sfmdae.inc'
      call mbcons(t, nq, nl, x, g, ipar, rpar, ierr)
      length = max(abs(g(1)), abs(g(2)))
      end

c What is left of M v' = f - GQ**T lambda.
      double precision function balance()
      implicit none
      double precision m(4), r
      integer i
      include 'sfmdae.inc'
      data m /1, 1, 2, 2/
      balance = 0
      do 10 i = 1, 4
        r = m(i) * xprime(4+i)
        if (i .eq. 2 .or. i .eq. 4) r = r + 9.81d0 * m(i)
        if (i .eq. 1) r = r + x(9) * (x(1) - rpar(2) * sin(t))
     $                      + x(10) * (x(1) - x(3))
        if (i .eq. 2) r = r + x(9) * x(2) + x(10) * (x(2) - x(4))
        if (i .eq. 3) r = r + x(10) * (x(3) - x(1))
        if (i .eq. 4) r = r + x(10) * (x(4) - x(2))
        balance = max(balance, abs(r))
   10 continue
      end

      subroutine follow(method)
      implicit none
      integer method, i
      double precision y(4), e, length, balance
      include 'sfmdae.inc'
      call refer(y)
      call mbinit(method)
      x(9) = -1d3
      x(10) = 1d3
      tout = 0
      call mbcall
      call check(ierr .eq. 4 .and. info(1) .eq. 2, 'start', ierr)
      call check(cval(1) .eq. 2 .and. cval(2) .eq. 4 .and. cval(3)
     $           .eq. 6 .and. cval(4) .eq. 0 .and. cval(5) .eq. 0,
     $           'CVAL', cval(1))
      call check(x(1) .eq. 0.6d0 .and. x(4) .eq. -0.8d0,
     $           'what holds stays', method)
      call check(balance() .le. 1d-12 * 30, 'forces', method)
      tout = 1
      call mbcall
      call check(ierr .eq. 3 .and. t .eq. 1, 'TOUT reached', ierr)
      call check(iwarn .eq. 0, 'IWARN', iwarn)
      e = max(abs(x(1) - sin(y(1))), abs(x(2) + cos(y(1))),
     $        abs(x(3) - sin(y(1)) - 0.8d0 * sin(y(2))),
     $        abs(x(4) + cos(y(1)) + 0.8d0 * cos(y(2))),
     $        abs(x(5) - cos(y(1)) * y(3)))
      call check(e .le. 100 * 1d-8 * (1 + abs(y(3)) + abs(y(4))), 'X',
     $           method)
      call check(length() .le. 1d-14 * 4, 'length', method)
      i = iwork(11)
      call check(i .gt. 5 .and. iwork(12) .ge. i, 'counts', i)
      end

c The point of suspension moves.
      subroutine driven(method)
      implicit none
      integer method
      double precision length, balance
      include 'sfmdae.inc'
      call mbinit(method)
      rpar(2) = 0.3d0
      call mbcall
      call check(ierr .eq. 3, 'driven', ierr)
      call check(length() .le. 1d-14 * 4, 'its length', method)
      call check(balance() .le. 1d-3, 'its forces', method)
      end

c The same bits one step at a time, with another problem in between,
c that of a mass without constraints: q = t**2 / 2.
      subroutine turns(method)
      implicit none
      external onmass, onforc, oncons, oncjac
      integer method, i, lcr
      parameter (lcr = 100 + 34*2)
      integer ccval(5), cipar(1), ciwork(20), cinfo(20), ciwarn, cierr
      double precision y(10), ct, cx(2), cxp(2), crpar(1), crw(lcr),
     $                 ctol
      include 'sfmdae.inc'
      call mbinit(method)
      call mbcall
      do 10 i = 1, nx
        y(i) = x(i)
   10 continue
      do 20 i = 1, 20
        cinfo(i) = 0
   20 continue
      ct = 0
      cx(1) = 0
      cx(2) = 0
      ctol = 1d-6
      ciwarn = 0
      call mbinit(method)
      info(14) = 1
      iwork(20) = 1
   30 continue
        call mbcall
        call sfmdae(onmass, onforc, oncons, oncjac, 1, 0, ct,
     $              ct + 0.01d0, cx, cxp, ccval, cipar, crpar, ciwork,
     $              20, crw, lcr, ctol, ctol, 3 - method, cinfo, ciwarn,
     $              cierr)
        call check(cierr .eq. 3, 'the other problem', cierr)
        info(1) = 1
      if (ierr .eq. -1) goto 30
      call check(ierr .eq. 3, 'TOUT reached', ierr)
      do 40 i = 1, nx
        call check(x(i) .eq. y(i), 'the same bits', i)
   40 continue
      call check(abs(cx(1) - ct**2 / 2) .le. 1d-5, 'the other X',
     $           method)
      call check(ct .gt. 0.1d0, 'many turns', method)
      call check(ccval(1) .eq. 0 .and. ccval(2) .eq. 2, 'other CVAL',
     $           ccval(1))
      end
      subroutine onmass(t, nq, q, m, ldm, ipar, rpar, ierr)
      implicit none
      integer nq, ldm, ipar(*), ierr
      double precision t, q(nq), m(ldm,nq), rpar(*)
      m(1,1) = 1
      end
      subroutine onforc(t, nq, q, v, f, ipar, rpar, ierr)
      implicit none
      integer nq, ipar(*), ierr
      double precision t, q(nq), v(nq), f(nq), rpar(*)
      f(1) = 1
      end
      subroutine oncons(t, nq, nl, q, g, ipar, rpar, ierr)
      implicit none
      integer nq, nl, ipar(*), ierr
      double precision t, q(nq), g(*), rpar(*)
      call check(.false., 'no constraints', nl)
      end
      subroutine oncjac(t, nq, nl, q, gq, ldgq, gt, ipar, rpar, ierr)
      implicit none
      integer nq, nl, ldgq, ipar(*), ierr
      double precision t, q(nq), gq(ldgq,nq), gt(*), rpar(*)
      call check(.false., 'no constraints', nl)
      end

c What INFO(11) and INFO(12) do to values that violate constraints.
      subroutine values(method)
      implicit none
      integer method
      double precision length
      include 'sfmdae.inc'
      call mbinit(method)
      x(1) = 0.61d0
      tout = 0
      call mbcall
      call check(ierr .eq. 4, 'nearest', ierr)
      call check(length() .le. 1d-14 * 4, 'made consistent', method)
      call mbinit(method)
      x(1) = 0.61d0
      tout = 0
      info(11) = 1
      call mbcall
      call check(ierr .eq. -24, 'INFO(11)', ierr)
      call mbinit(method)
      x(1) = 0.61d0
      tout = 0
      info(12) = 1
      call mbcall
      call check(ierr .eq. -24 .and. x(1) .eq. 0.61d0, 'INFO(12)', ierr)
      call mbinit(method)
      tout = 0
      info(12) = 1
      call mbcall
      call check(ierr .eq. 4 .and. x(1) .eq. 0.6d0, 'fixed', ierr)
      call check(abs(x(10)) .gt. 1, 'lambda follows', method)
      end

c Subroutines return IERR = -1 beyond t = 0.5, or from the start.
      subroutine fail(method)
      implicit none
      integer method
      double precision length
      include 'sfmdae.inc'
      call mbinit(method)
      rpar(1) = 0.5d0
      ipar(2) = -1
      call mbcall
      call check(ierr .eq. -10 .and. info(1) .eq. -1, 'IERR', ierr)
      call check(t .gt. 0.4d0 .and. t .le. 0.5d0, 'T', method)
      call check(length() .le. 1d-12, 'X', method)
      ipar(2) = 0
      info(1) = 1
      call mbcall
      call check(ierr .eq. 3 .and. t .eq. 1, 'and on', ierr)
      call mbinit(method)
      rpar(1) = -1d300
      ipar(2) = -1
      call mbcall
      call check(ierr .eq. -10 .and. t .eq. 0, 'at the start', ierr)
      end

c Row and column of the derivative that is wrong.
      subroutine wrong(method)
      implicit none
      integer method
      include 'sfmdae.inc'
      call mbinit(method)
      ipar(3) = 1
      call mbcall
      call check(ierr .eq. -27, 'wrong GQ', ierr)
      call check(iwork(1) .eq. 2 .and. iwork(2) .eq. 3, 'its place',
     $           iwork(2))
      call mbinit(method)
      ipar(3) = 2
      rpar(2) = 0.3d0
      call mbcall
      call check(ierr .eq. -27, 'wrong GT', ierr)
      call check(iwork(1) .eq. 1 .and. iwork(2) .eq. 0, 'its place too',
     $           iwork(2))
      call mbinit(method)
      ipar(3) = 2
      rpar(2) = 0.3d0
      info(18) = 1
      call mbcall
      call check(ierr .ne. -27, 'INFO(18)', ierr)
      end

      subroutine refuse(method)
      implicit none
      integer method
      include 'sfmdae.inc'
      call mbinit(method)
      nq = 0
      call mbcall
      call check(ierr .eq. -102, 'NQ = 0', ierr)
      call mbinit(method)
      nl = -1
      call mbcall
      call check(ierr .eq. -133, 'NL = -1', ierr)
      call check(ipar(1) .eq. 0, 'nothing called', ipar(1))
      call mbinit(method)
      nq = 2500
      call mbcall
      call check(ierr .eq. -102, 'NQ too large', ierr)
      call mbinit(method)
      info(5) = 1
      call mbcall
      call check(ierr .eq. -101, 'INFO(5)', ierr)
      call mbinit(method)
      lrw = mostrw - 1
      call mbcall
      call check(ierr .eq. -105 .and. iwork(liw) .eq. mostrw, 'LRW',
     $           ierr)
      call mbinit(3)
      call mbcall
      call check(ierr .eq. -132, 'METHOD', ierr)
      end
