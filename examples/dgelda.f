c SPDX-License-Identifier: BSD-3-Clause
c
c A program written for GELDA, linked with sfdae instead. Which force
c x3 moves a unit mass along sin t?
c
c     x1' = x2,   x2' = x3,   0 = x1 - sin t
c
c mu = 2, d = 0, a = 3, u = 0. Solution: (sin t, cos t, -sin t).
      program mass
      external edif, adif, fdif
      integer n, liw, lrw
      parameter (n = 3, liw = 20 + 2*n, lrw = 50 + 68*n + 105*n**2)
      integer cval(4), ipar(1), iwork(liw), info(20), iwarn, ierr, k
      double precision t, tout, x(n), xprime(n), rpar(1), rwork(lrw),
     $                 rtol, atol, error
      data info /20*0/, iwarn /0/, x /0, 0, 0/
      data rtol, atol /2*1d-6/, t /0/
      do 10 k = 0, 4
c       The first call, TOUT = T, makes X consistent.
        tout = 2*k
        call dgelda(edif, adif, fdif, n, t, tout, x, xprime, cval, ipar,
     $              rpar, iwork, liw, rwork, lrw, rtol, atol, 1, info,
     $              iwarn, ierr)
        if (ierr .lt. 0) write (*, *) 'IERR =', ierr, ' at t =', t
        if (ierr .lt. 0) stop 1
        write (*, '(a,f4.1,a,3f10.6)') ' t =', t, '   x =', x
   10 continue
      error = max(abs(x(1) - sin(t)), abs(x(2) - cos(t)),
     $            abs(x(3) + sin(t)))
      write (*, '(a,4i2,a,i3,a,1p,e8.1)') ' mu, d, a, u =', cval,
     $  '   steps:', iwork(11), '   error:', error
      if (error .gt. 10 * (rtol + atol)) stop 1
      end

c Derivatives of order k. Every entry is written.
      subroutine edif(n, t, k, e, lde, ipar, rpar, ierr)
      integer n, k, lde, ipar(*), ierr
      double precision t, e(lde,*), rpar(*)
      call zero(n, e, lde)
      if (k .eq. 0) e(1,1) = 1
      if (k .eq. 0) e(2,2) = 1
      end
      subroutine adif(n, t, k, a, lda, ipar, rpar, ierr)
      integer n, k, lda, ipar(*), ierr
      double precision t, a(lda,*), rpar(*)
      call zero(n, a, lda)
      if (k .eq. 0) a(1,2) = 1
      if (k .eq. 0) a(2,3) = 1
      if (k .eq. 0) a(3,1) = 1
      end
      subroutine fdif(n, t, k, f, ipar, rpar, ierr)
      integer n, k, ipar(*), ierr
      double precision t, f(*), rpar(*)
      f(1) = 0
      f(2) = 0
      f(3) = -sin(t + k * acos(0d0))
      end
      subroutine zero(n, a, lda)
      integer n, lda, i, j
      double precision a(lda,*)
      do 20 j = 1, n
        do 10 i = 1, n
          a(i,j) = 0
   10   continue
   20 continue
      end
