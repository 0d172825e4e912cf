c SPDX-License-Identifier: BSD-3-Clause
c
c What the Fortran tests of SFNDAE share: the pendulum
c
c   x1' = x3,  x2' = x4,  x3' = -x5 x1,  x4' = -x5 x2 - g,
c   0 = x1**2 + x2**2 - 1
c
c IPAR: 1 calls of NDIF, 2 IERR to return for T > RPAR(1), 3 highest
c order asked for.

c From the horizontal; arrays contain garbage.
      subroutine sfinit(method)
      implicit none
      integer method, i
      include 'sfndae.inc'
      n = nx
      m = nx
      t = 0
      tout = 1
      rtol = 1d-6
      atol = 1d-6
      meth = method
      liw = mostiw
      lrw = mostrw
      iwarn = 5
      ierr = 99
      rpar(1) = -1d300
      do 10 i = 1, nx
        x(i) = 0
        xprime(i) = 17
        cval(i) = -77
   10 continue
      x(1) = 1
      do 20 i = 1, 20
        info(i) = 0
   20 continue
      do 30 i = 1, mostiw
        iwork(i) = -1234567
   30 continue
      do 40 i = 1, mostrw
        rwork(i) = -1d300
   40 continue
      do 50 i = 1, 3
        ipar(i) = 0
   50 continue
      end

      subroutine sfcall
      implicit none
      external pendul
      include 'sfndae.inc'
      call sfndae(pendul, n, m, t, tout, x, xprime, cval, ipar, rpar,
     $            iwork, liw, rwork, lrw, rtol, atol, meth, info, iwarn,
     $            ierr)
      end

c Leibniz: the derivatives of products are sums of c * products.
      subroutine pendul(t, k, n, m, x, ldx, f, fx, ldfx, fxp, ldfxp,
     $                ipar, rpar, ierr)
      implicit none
      integer k, n, m, ldx, ldfx, ldfxp, ipar(*), ierr, j
      double precision t, x(ldx,0:*), f(*), fx(ldfx,*), fxp(ldfxp,*),
     $                 rpar(*), c
      ipar(1) = ipar(1) + 1
      ipar(3) = max(ipar(3), k)
      if (t .gt. rpar(1)) ierr = ipar(2)
      f(1) = x(1,k+1) - x(3,k)
      f(2) = x(2,k+1) - x(4,k)
      f(3) = x(3,k+1)
      f(4) = x(4,k+1)
      f(5) = 0
      if (k .eq. 0) f(4) = f(4) + 9.81d0
      if (k .eq. 0) f(5) = -1
      c = 1
      do 10 j = 0, k
        f(3) = f(3) + c * x(5,j) * x(1,k-j)
        f(4) = f(4) + c * x(5,j) * x(2,k-j)
        f(5) = f(5) + c * (x(1,j) * x(1,k-j) + x(2,j) * x(2,k-j))
        c = c * (k - j) / (j + 1)
   10 continue
      fx(3,1) = x(5,k)
      fx(3,5) = x(1,k)
      fx(4,2) = x(5,k)
      fx(4,5) = x(2,k)
      fx(5,1) = 2 * x(1,k)
      fx(5,2) = 2 * x(2,k)
      if (k .gt. 0) return
      fx(1,3) = -1
      fx(2,4) = -1
      do 20 j = 1, 4
        fxp(j,j) = 1
   20 continue
      end
