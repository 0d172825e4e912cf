c SPDX-License-Identifier: BSD-3-Clause
c
c The pendulum by both methods: values, constraints, calls one step at
c a time, in turns with another problem, and after failures of NDIF.
      program swing
      implicit none
      integer m
      do 10 m = 1, 2
        call follow(m)
        call turns(m)
        call fail(m)
   10 continue
      call finish
      end

c Reference at t = 1 by the equation of the angle, phi'' = -g sin phi
c from the horizontal, in steps of order 4 that are small enough.
      subroutine angle(phi, omega)
      implicit none
      integer i, steps
      parameter (steps = 20000)
      double precision phi, omega, h, a, b, c, d, g, p, q, r
      parameter (g = 9.81d0)
      phi = acos(0d0)
      omega = 0
      h = 1d0 / steps
      do 10 i = 1, steps
        a = -g * sin(phi)
        p = omega + h/2 * a
        b = -g * sin(phi + h/2 * omega)
        q = omega + h/2 * b
        c = -g * sin(phi + h/2 * p)
        r = omega + h * c
        d = -g * sin(phi + h * q)
        phi = phi + h/6 * (omega + 2*p + 2*q + r)
        omega = omega + h/6 * (a + 2*b + 2*c + d)
   10 continue
      end

      subroutine follow(method)
      implicit none
      integer method, i
      double precision phi, omega, e
      include 'sfndae.inc'
      call angle(phi, omega)
      call sfinit(method)
      x(1) = 1.2d0
      x(3) = 0.5d0
      tout = 0
      call sfcall
      call check(ierr .eq. 4 .and. info(1) .eq. 2, 'start', ierr)
      call check(cval(1) .eq. 2 .and. cval(2) .eq. 2 .and. cval(3)
     $           .eq. 3 .and. cval(4) .eq. 0 .and. cval(5) .eq. 0,
     $           'CVAL', cval(1))
      call check(abs(x(1) - 1) + abs(x(2)) + abs(x(3)) + abs(x(4))
     $           .le. 1d-12, 'X is consistent', method)
      call check(abs(xprime(4) + 9.81d0) .le. 1d-12, 'XPRIME', method)
      tout = 1
      call sfcall
      call check(ierr .eq. 3 .and. t .eq. 1, 'TOUT reached', ierr)
      call check(iwarn .eq. 0, 'IWARN', iwarn)
      e = max(abs(x(1) - sin(phi)), abs(x(2) + cos(phi)),
     $        abs(x(3) - omega * cos(phi)),
     $        abs(x(4) - omega * sin(phi)))
      call check(e .le. 20 * 1d-6 * (1 + abs(omega)), 'X', method)
      call check(abs(x(1)**2 + x(2)**2 - 1) .le. 1d-13, 'length',
     $           method)
      call check(abs(x(1)*x(3) + x(2)*x(4)) .le. 1d-12, 'velocity',
     $           method)
      call check(abs(x(3)**2 + x(4)**2 - 9.81d0*x(2) - x(5)) .le.
     $           1d-11, 'force', method)
      call check(ipar(3) .le. 4, 'orders', ipar(3))
      i = iwork(11)
      call check(i .gt. 5 .and. iwork(12) .ge. i, 'counts', i)
      end

c The same bits one step at a time, with another problem in between.
      subroutine turns(method)
      implicit none
      external circle
      integer method, i, lcr
      parameter (lcr = 100 + 2*3 + 2 + (30 + 4*3) * 2)
      integer ccval(5), cipar(1), ciwork(20), cinfo(20), ciwarn, cierr
      double precision y(5), ct, cx(2), cxp(2), crpar(1), crw(lcr),
     $                 ctol
      include 'sfndae.inc'
      call sfinit(method)
      call sfcall
      do 10 i = 1, nx
        y(i) = x(i)
   10 continue
      do 20 i = 1, 20
        cinfo(i) = 0
   20 continue
      ct = 0
      cx(1) = 1
      cx(2) = 0
      ctol = 1d-6
      ciwarn = 0
      call sfinit(method)
      info(14) = 1
      iwork(20) = 1
   30 continue
        call sfcall
        call sfndae(circle, 2, 2, ct, ct + 0.01d0, cx, cxp, ccval,
     $              cipar, crpar, ciwork, 20, crw, lcr, ctol, ctol,
     $              3 - method, cinfo, ciwarn, cierr)
        call check(cierr .eq. 3, 'the other problem', cierr)
        info(1) = 1
      if (ierr .eq. -1) goto 30
      call check(ierr .eq. 3, 'TOUT reached', ierr)
      do 40 i = 1, nx
        call check(x(i) .eq. y(i), 'the same bits', i)
   40 continue
      call check(abs(cx(1) - cos(ct)) + abs(cx(2) - sin(ct)) .le. 2d-5,
     $           'the other X', method)
      call check(ct .gt. 0.1d0, 'many turns', method)
      end

c x2' = x1, 0 = x1**2 + x2**2 - 1: x = (cos t, sin t) up to pi/2.
      subroutine circle(t, k, n, m, x, ldx, f, fx, ldfx, fxp, ldfxp,
     $                  ipar, rpar, ierr)
      implicit none
      integer k, n, m, ldx, ldfx, ldfxp, ipar(*), ierr, j
      double precision t, x(ldx,0:*), f(*), fx(ldfx,*), fxp(ldfxp,*),
     $                 rpar(*), c
      f(1) = x(2,k+1) - x(1,k)
      f(2) = 0
      if (k .eq. 0) f(2) = -1
      c = 1
      do 10 j = 0, k
        f(2) = f(2) + c * (x(1,j) * x(1,k-j) + x(2,j) * x(2,k-j))
        c = c * (k - j) / (j + 1)
   10 continue
      fx(2,1) = 2 * x(1,k)
      fx(2,2) = 2 * x(2,k)
      if (k .gt. 0) return
      fx(1,1) = -1
      fxp(1,2) = 1
      end

c NDIF returns IERR = -1 or -2 beyond t = 0.5, or from the start.
      subroutine fail(method)
      implicit none
      integer method
      include 'sfndae.inc'
      call sfinit(method)
      rpar(1) = 0.5d0
      ipar(2) = -1
      call sfcall
      call check(ierr .eq. -10 .and. info(1) .eq. -1, 'IERR', ierr)
      call check(t .gt. 0.4d0 .and. t .le. 0.5d0, 'T', method)
      call check(abs(x(1)**2 + x(2)**2 - 1) .le. 1d-5, 'X', method)
      ipar(2) = 0
      info(1) = 1
      call sfcall
      call check(ierr .eq. 3 .and. t .eq. 1, 'and on', ierr)
      call sfinit(method)
      rpar(1) = 0.5d0
      ipar(2) = -2
      call sfcall
      call check(ierr .eq. -21 .and. t .le. 0.5d0, 'missing', ierr)
      call sfinit(method)
      ipar(2) = -2
      call sfcall
      call check(ierr .eq. -21 .and. t .eq. 0, 'at the start', ierr)
      end
