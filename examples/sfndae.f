c SPDX-License-Identifier: BSD-3-Clause
c
c A pendulum of length 1 and mass 1, swinging from the horizontal:
c position (x1, x2), velocity (x3, x4), force x5 in the rod
c
c     x1' = x3,   x2' = x4,   x3' = -x5 x1,   x4' = -x5 x2 - g,
c     0 = x1**2 + x2**2 - 1
c
c mu = 2, d = 2, a = 3. The energy stays: (x3**2 + x4**2)/2 + g x2 = 0.
      program swing
      external ndif
      integer n, liw, lrw
      parameter (n = 5, liw = 20, lrw = 106 + n + 42*n)
      integer cval(5), ipar(1), iwork(liw), info(20), iwarn, ierr, k
      double precision t, tout, x(n), xprime(n), rpar(1), rwork(lrw),
     $                 rtol, atol, length, energy
      data info /20*0/, iwarn /0/, x /1.1, 0, 0, 0, 0/
      data rtol, atol /2*1d-8/, t /0/, rpar /9.81d0/
      do 10 k = 0, 4
c       The first call, TOUT = T, makes X consistent.
        tout = 0.5d0*k
        call sfndae(ndif, n, n, t, tout, x, xprime, cval, ipar, rpar,
     $              iwork, liw, rwork, lrw, rtol, atol, 1, info, iwarn,
     $              ierr)
        if (ierr .lt. 0) write (*, *) 'IERR =', ierr, ' at t =', t
        if (ierr .lt. 0) stop 1
        write (*, '(a,f4.1,a,5f10.6)') ' t =', t, '   x =', x
   10 continue
      length = x(1)**2 + x(2)**2
      energy = (x(3)**2 + x(4)**2) / 2 + rpar(1)*x(2)
      write (*, '(a,5i2,a,i4,a,1p,e8.1)') ' mu, d, a, u, v =', cval,
     $  '   steps:', iwork(11), '   energy:', energy
      if (abs(length - 1) .gt. 1d-13) stop 1
      if (abs(energy) .gt. 100 * (rtol + atol) * rpar(1)) stop 1
      end

c Total derivatives of order k of F, F_x and F_x', given x(i,j), those
c of order j of x(i). Products by Leibniz' rule, c the binomials.
      subroutine ndif(t, k, n, m, x, ldx, f, fx, ldfx, fxp, ldfxp,
     $                ipar, g, ierr)
      integer k, n, m, ldx, ldfx, ldfxp, ipar(*), ierr, j
      double precision t, x(ldx,0:k+1), f(m), fx(ldfx,n), fxp(ldfxp,n),
     $                 g, c
      f(1) = x(1,k+1) - x(3,k)
      f(2) = x(2,k+1) - x(4,k)
      f(3) = x(3,k+1)
      f(4) = x(4,k+1)
      if (k .eq. 0) f(4) = f(4) + g
      if (k .eq. 0) f(5) = -1
      c = 1
      do 10 j = 0, k
        f(3) = f(3) + c * x(5,j) * x(1,k-j)
        f(4) = f(4) + c * x(5,j) * x(2,k-j)
        f(5) = f(5) + c * (x(1,j) * x(1,k-j) + x(2,j) * x(2,k-j))
        c = c * (k - j) / (j + 1)
   10 continue
c     Arrays are zero before the call.
      fx(3,1) = x(5,k)
      fx(3,5) = x(1,k)
      fx(4,2) = x(5,k)
      fx(4,5) = x(2,k)
      fx(5,1) = 2 * x(1,k)
      fx(5,2) = 2 * x(2,k)
      if (k .eq. 0) fx(1,3) = -1
      if (k .eq. 0) fx(2,4) = -1
      do 20 j = 1, 4
        if (k .eq. 0) fxp(j,j) = 1
   20 continue
      end
