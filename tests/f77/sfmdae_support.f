c SPDX-License-Identifier: BSD-3-Clause
c
c What the Fortran tests of SFMDAE share: two masses of 1 kg and 2 kg on
c rods of 1 m and 0.8 m, hanging from a point that moves by
c RPAR(2) sin t along the first axis.
c
c IPAR: 1 calls, 2 IERR to return for T > RPAR(1), 3 a mistake in CJAC:
c 1 the sign of GQ(2,3), 2 GT forgotten.

c Off the vertical, at rest; arrays contain garbage.
      subroutine mbinit(method)
      implicit none
      integer method, i
      include 'sfmdae.inc'
      nq = mq
      nl = ml
      t = 0
      tout = 1
      rtol = 1d-8
      atol = 1d-8
      meth = method
      liw = mostiw
      lrw = mostrw
      iwarn = 5
      ierr = 99
      rpar(1) = 1d300
      rpar(2) = 0
      do 10 i = 1, nx
        x(i) = 0
        xprime(i) = 17
   10 continue
      x(1) = 0.6d0
      x(2) = -0.8d0
      x(3) = 1.4d0
      x(4) = -0.8d0
      do 20 i = 1, 20
        info(i) = 0
   20 continue
      do 30 i = 1, mostiw
        iwork(i) = -1234567
   30 continue
      do 40 i = 1, mostrw
        rwork(i) = -1d300
   40 continue
      do 50 i = 1, 5
        cval(i) = -77
   50 continue
      do 60 i = 1, 3
        ipar(i) = 0
   60 continue
      end

      subroutine mbcall
      implicit none
      external mbmass, mbforc, mbcons, mbcjac
      include 'sfmdae.inc'
      call sfmdae(mbmass, mbforc, mbcons, mbcjac, nq, nl, t, tout, x,
     $            xprime, cval, ipar, rpar, iwork, liw, rwork, lrw,
     $            rtol, atol, meth, info, iwarn, ierr)
      end

      subroutine mbmass(t, nq, q, m, ldm, ipar, rpar, ierr)
      implicit none
      integer nq, ldm, ipar(*), ierr
      double precision t, q(nq), m(ldm,nq), rpar(*)
      ipar(1) = ipar(1) + 1
      if (t .gt. rpar(1)) ierr = ipar(2)
      m(1,1) = 1
      m(2,2) = 1
      m(3,3) = 2
      m(4,4) = 2
c     What is an input here need not stay as it is.
      q(1) = 1d300
      end

      subroutine mbforc(t, nq, q, v, f, ipar, rpar, ierr)
      implicit none
      integer nq, ipar(*), ierr
      double precision t, q(nq), v(nq), f(nq), rpar(*)
      ipar(1) = ipar(1) + 1
      if (t .gt. rpar(1)) ierr = ipar(2)
      f(2) = -9.81d0
      f(4) = -2 * 9.81d0
      end

      subroutine mbcons(t, nq, nl, q, g, ipar, rpar, ierr)
      implicit none
      integer nq, nl, ipar(*), ierr
      double precision t, q(nq), g(nl), rpar(*), s
      ipar(1) = ipar(1) + 1
      if (t .gt. rpar(1)) ierr = ipar(2)
      s = q(1) - rpar(2) * sin(t)
      g(1) = (s**2 + q(2)**2 - 1) / 2
      g(2) = ((q(3) - q(1))**2 + (q(4) - q(2))**2 - 0.64d0) / 2
      end

      subroutine mbcjac(t, nq, nl, q, gq, ldgq, gt, ipar, rpar, ierr)
      implicit none
      integer nq, nl, ldgq, ipar(*), ierr
      double precision t, q(nq), gq(ldgq,nq), gt(nl), rpar(*), s
      ipar(1) = ipar(1) + 1
      if (t .gt. rpar(1)) ierr = ipar(2)
      s = q(1) - rpar(2) * sin(t)
      gq(1,1) = s
      gq(1,2) = q(2)
      gq(2,1) = q(1) - q(3)
      gq(2,2) = q(2) - q(4)
      gq(2,3) = q(3) - q(1)
      gq(2,4) = q(4) - q(2)
      gt(1) = -s * rpar(2) * cos(t)
      if (ipar(3) .eq. 1) gq(2,3) = -gq(2,3)
      if (ipar(3) .eq. 2) gt(1) = 0
      end
