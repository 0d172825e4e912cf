c SPDX-License-Identifier: BSD-3-Clause
c
c SFMDAE with INTEGERs of 64 bits: a pendulum of length 1 at rest below,
c pushed, that stays on the circle; both methods.
      program wide
      implicit none
      external mass, force, constr, cjac
      integer*8 nq, nl, n, liw, lrw
      parameter (nq = 2, nl = 1, n = 5, liw = 20, lrw = 100 + 34*n)
      integer*8 cval(5), ipar(1), iwork(liw), info(20), iwarn, ierr,
     $          method, i
      double precision t, tout, x(n), xprime(n), rpar(1), rwork(lrw),
     $                 rtol, atol, energy
      logical good
      good = .true.
      do 20 method = 1, 2
        do 10 i = 1, 20
          info(i) = 0
   10   continue
        do 15 i = 1, n
          x(i) = 0
   15   continue
        t = 0
        tout = 1
        x(2) = -1
        x(3) = 1
        rtol = 1d-8
        atol = 1d-8
        ipar(1) = 5000000000_8
        rpar(1) = 9.81d0
        call sfmdae_64(mass, force, constr, cjac, nq, nl, t, tout, x,
     $                 xprime, cval, ipar, rpar, iwork, liw, rwork, lrw,
     $                 rtol, atol, method, info, iwarn, ierr)
        energy = (x(3)**2 + x(4)**2 - 1) / 2 + rpar(1) * (x(2) + 1)
        if (ierr .ne. 3 .or. abs(energy) .gt. 1d-5) good = .false.
        if (abs(x(1)**2 + x(2)**2 - 1) .gt. 1d-14) good = .false.
        if (cval(1) .ne. 2 .or. cval(2) .ne. 2 .or. cval(3) .ne. 3 .or.
     $      cval(4) .ne. 0 .or. cval(5) .ne. 0) good = .false.
        if (ipar(1) .ne. 5000000000_8 .or. info(1) .ne. 1)
     $    good = .false.
   20 continue
      if (good) write (*, *) 'PASSED'
      if (.not. good) write (*, *) 'FAILED', ierr, energy, cval
      end

      subroutine mass(t, nq, q, m, ldm, ipar, rpar, ierr)
      implicit none
      integer*8 nq, ldm, ipar(*), ierr
      double precision t, q(nq), m(ldm,nq), rpar(*)
      m(1,1) = 1
      m(2,2) = 1
      end
      subroutine force(t, nq, q, v, f, ipar, rpar, ierr)
      implicit none
      integer*8 nq, ipar(*), ierr
      double precision t, q(nq), v(nq), f(nq), rpar(*)
      f(2) = -rpar(1)
      end
c IPAR arrives in full.
      subroutine constr(t, nq, nl, q, g, ipar, rpar, ierr)
      implicit none
      integer*8 nq, nl, ipar(*), ierr
      double precision t, q(nq), g(nl), rpar(*)
      g(1) = (q(1)**2 + q(2)**2 - 1) / 2
      if (ipar(1) .ne. 5000000000_8) ierr = -1
      end
      subroutine cjac(t, nq, nl, q, gq, ldgq, gt, ipar, rpar, ierr)
      implicit none
      integer*8 nq, nl, ldgq, ipar(*), ierr
      double precision t, q(nq), gq(ldgq,nq), gt(nl), rpar(*)
      gq(1,1) = q(1)
      gq(1,2) = q(2)
      end
