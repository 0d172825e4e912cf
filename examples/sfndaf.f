c SPDX-License-Identifier: BSD-3-Clause
c
c The pendulum of sfndae.f, given by its derivative array: one
c subroutine writes F, F', ..., all total derivatives up to order MU,
c and their Jacobian with respect to x, x', ..., as for GENDA.
c
c     x1' = x3,   x2' = x4,   x3' = -x5 x1,   x4' = -x5 x2 - g,
c     0 = x1**2 + x2**2 - 1
c
c mu = 2, d = 2, a = 3. The energy stays: (x3**2 + x4**2)/2 + g x2 = 0.
      program swing
      external narr
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
        call sfndaf(narr, n, n, t, tout, x, xprime, cval, ipar, rpar,
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

c f(i,k) is the derivative of order k of F(i), fj(i,k,j,l) that of
c f(i,k) with respect to x(j,l), the derivative of order l of x(j).
c Products by Leibniz' rule, c the binomials. Arrays are zero before.
      subroutine narr(t, mu, n, m, x, ldx, f, fj, ldfj, ipar, g, ierr)
      integer mu, n, m, ldx, ldfj, ipar(*), ierr, k, l
      double precision t, x(ldx,0:mu+1), f(m,0:mu),
     $                 fj(m,0:mu,n,0:mu+1), g, c
      f(4,0) = g
      f(5,0) = -1
      do 20 k = 0, mu
        do 10 l = 1, 4
          fj(l,k,l,k+1) = 1
          f(l,k) = f(l,k) + x(l,k+1)
   10   continue
        f(1,k) = f(1,k) - x(3,k)
        fj(1,k,3,k) = -1
        f(2,k) = f(2,k) - x(4,k)
        fj(2,k,4,k) = -1
        c = 1
        do 20 l = 0, k
          f(3,k) = f(3,k) + c * x(5,l) * x(1,k-l)
          fj(3,k,5,l) = c * x(1,k-l)
          fj(3,k,1,l) = c * x(5,k-l)
          f(4,k) = f(4,k) + c * x(5,l) * x(2,k-l)
          fj(4,k,5,l) = c * x(2,k-l)
          fj(4,k,2,l) = c * x(5,k-l)
          f(5,k) = f(5,k) + c * (x(1,l) * x(1,k-l) + x(2,l) * x(2,k-l))
          fj(5,k,1,l) = 2 * c * x(1,k-l)
          fj(5,k,2,l) = 2 * c * x(2,k-l)
          c = c * (k - l) / (l + 1)
   20 continue
      end
