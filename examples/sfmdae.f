c SPDX-License-Identifier: BSD-3-Clause
c
c A double pendulum in SI units: masses of 1 kg and 2 kg at (q1, q2) and
c (q3, q4), on rods of 1 m and 0.8 m, released off the vertical:
c
c     q' = v,   M v' = f - g_q**T lambda,
c     0 = g1 = (q1**2 + q2**2 - 1) / 2
c     0 = g2 = ((q3 - q1)**2 + (q4 - q2)**2 - 0.64) / 2
c
c X = (q, v, lambda); the forces lambda are not known at the start. The
c sum of kinetic and potential energy stays.
      program swing
      external mass, force, constr, cjac
      integer nq, nl, n, liw, lrw
      parameter (nq = 4, nl = 2, n = 2*nq + nl, liw = 20,
     $           lrw = 100 + 34*n)
      integer cval(5), ipar(1), iwork(liw), info(20), iwarn, ierr, k
      double precision t, tout, x(n), xprime(n), rpar(1), rwork(lrw),
     $                 rtol, atol, g(nl), energy, start
c     Positions roughly, at rest, lambda = 0.
      data x /0.61, -0.8, 1.4, -0.75, 4*0, 2*0/, info /20*0/, iwarn /0/
      data rtol, atol /2*1d-8/, t /0/, rpar /9.81d0/
      do 10 k = 0, 4
c       The first call, TOUT = T, makes X consistent.
        tout = 0.5d0*k
        call sfmdae(mass, force, constr, cjac, nq, nl, t, tout, x,
     $              xprime, cval, ipar, rpar, iwork, liw, rwork, lrw,
     $              rtol, atol, 2, info, iwarn, ierr)
        if (ierr .lt. 0) write (*, *) 'IERR =', ierr, ' at t =', t
        if (ierr .lt. 0) stop 1
        write (*, '(a,f4.1,a,4f9.5,a,2f9.4)') ' t =', t, '   q =',
     $    x(1:4), '   lambda =', x(9:10)
        if (k .eq. 0) start = energy(x, rpar)
   10 continue
      call constr(t, nq, nl, x, g, ipar, rpar, ierr)
      write (*, '(a,5i2,a,i4,a,1p,e8.1)') ' mu, d, a, u, v =', cval,
     $  '   steps:', iwork(11), '   energy:', energy(x, rpar) - start
      if (max(abs(g(1)), abs(g(2))) .gt. 1d-13) stop 1
      if (abs(energy(x, rpar) - start) .gt. 1d-5) stop 1
      end

      double precision function energy(x, rpar)
      double precision x(8), rpar(1)
      energy = (x(5)**2 + x(6)**2) / 2 + x(7)**2 + x(8)**2
     $       + rpar(1) * (x(2) + 2*x(4))
      end

c Arrays are zero before each call.
      subroutine mass(t, nq, q, m, ldm, ipar, rpar, ierr)
      integer nq, ldm, ipar(*), ierr
      double precision t, q(nq), m(ldm,nq), rpar(*)
      m(1,1) = 1
      m(2,2) = 1
      m(3,3) = 2
      m(4,4) = 2
      end
      subroutine force(t, nq, q, v, f, ipar, rpar, ierr)
      integer nq, ipar(*), ierr
      double precision t, q(nq), v(nq), f(nq), rpar(*)
      f(2) = -rpar(1)
      f(4) = -2*rpar(1)
      end
      subroutine constr(t, nq, nl, q, g, ipar, rpar, ierr)
      integer nq, nl, ipar(*), ierr
      double precision t, q(nq), g(nl), rpar(*)
      g(1) = (q(1)**2 + q(2)**2 - 1) / 2
      g(2) = ((q(3) - q(1))**2 + (q(4) - q(2))**2 - 0.64d0) / 2
      end
      subroutine cjac(t, nq, nl, q, gq, ldgq, gt, ipar, rpar, ierr)
      integer nq, nl, ldgq, ipar(*), ierr
      double precision t, q(nq), gq(ldgq,nq), gt(nl), rpar(*)
      gq(1,1) = q(1)
      gq(1,2) = q(2)
      gq(2,1) = q(1) - q(3)
      gq(2,2) = q(2) - q(4)
      gq(2,3) = q(3) - q(1)
      gq(2,4) = q(4) - q(2)
      end
