c SPDX-License-Identifier: BSD-3-Clause
c
c Compiled with -fdefault-integer-8: the entries for INTEGERs of 32 bits
c return -140 and leave CVAL alone, although no subroutine writes IERR.
      program wide
      implicit none
      external edif, adif, fdif, ndif, mass, force, constr, cjac
      integer n, liw, lrw
      parameter (n = 3, liw = 20 + 6*n, lrw = 20 + 71*n + 114*n**2)
      integer cval(5), ipar(1), iwork(liw), info(20), iwarn, ierr, k,
     $        method
      double precision t, tout, x(n), xprime(n), rpar(1), rwork(lrw),
     $                 rtol, atol
      logical good
      good = bit_size(n) .eq. 64
      do 20 method = 1, 2
        do 10 k = 1, 5
          call fresh(t, tout, x, rtol, atol, info, cval, ierr)
          if (k .eq. 1 .or. k .eq. 5) info(5) = 1
          if (k .eq. 2) tout = t
          if (k .eq. 1 .or. k .eq. 2 .or. k .eq. 5)
     $      call dgelda(edif, adif, fdif, n, t, tout, x, xprime, cval,
     $                  ipar, rpar, iwork, liw, rwork, lrw, rtol, atol,
     $                  method, info, iwarn, ierr)
          if (k .eq. 3)
     $      call sfndae(ndif, n, n, t, tout, x, xprime, cval, ipar,
     $                  rpar, iwork, liw, rwork, lrw, rtol, atol,
     $                  method, info, iwarn, ierr)
          if (k .eq. 4)
     $      call sfmdae(mass, force, constr, cjac, 1, 1, t, tout, x,
     $                  xprime, cval, ipar, rpar, iwork, liw, rwork,
     $                  lrw, rtol, atol, method, info, iwarn, ierr)
          if (ierr .ne. -140) then
            good = .false.
            write (*, *) 'FAILED', k, method, ierr
          end if
          if (info(1) .ne. -1 .or. cval(1) .ne. -77 .or.
     $        cval(2) .ne. -77) good = .false.
   10   continue
   20 continue
      if (good) write (*, *) 'PASSED'
      if (.not. good) write (*, *) 'FAILED'
      end

      subroutine fresh(t, tout, x, rtol, atol, info, cval, ierr)
      implicit none
      integer info(20), cval(5), ierr, i
      double precision t, tout, x(3), rtol, atol
      do 10 i = 1, 20
        info(i) = 0
   10 continue
      do 20 i = 1, 5
        cval(i) = -77
   20 continue
      ierr = 99
      t = 0
      tout = 1
      x(1) = 0
      x(2) = 0
      x(3) = 0
      rtol = 1d-6
      atol = 1d-6
      end

c x1' = x2, x2' = x3, 0 = x1 - sin t. Dimensions are not looked at.
      subroutine edif(n, t, k, e, lde, ipar, rpar, ierr)
      implicit none
      integer n, k, lde, ipar(*), ierr
      double precision t, e(lde,*), rpar(*)
      e(1,1) = 0
      e(2,2) = 0
      if (k .eq. 0) e(1,1) = 1
      if (k .eq. 0) e(2,2) = 1
      end
      subroutine adif(n, t, k, a, lda, ipar, rpar, ierr)
      implicit none
      integer n, k, lda, ipar(*), ierr
      double precision t, a(lda,*), rpar(*)
      if (k .eq. 0) a(1,2) = 1
      if (k .eq. 0) a(2,3) = 1
      if (k .eq. 0) a(3,1) = 1
      end
      subroutine fdif(n, t, k, f, ipar, rpar, ierr)
      implicit none
      integer n, k, ipar(*), ierr
      double precision t, f(*), rpar(*)
      f(3) = -sin(t + k * acos(0d0))
      end
      subroutine ndif(t, k, n, m, x, ldx, f, fx, ldfx, fxp, ldfxp,
     $                ipar, rpar, ierr)
      implicit none
      integer k, n, m, ldx, ldfx, ldfxp, ipar(*), ierr, i
      double precision t, x(ldx,0:k+1), f(m), fx(ldfx,n), fxp(ldfxp,n),
     $                 rpar(*)
      do 10 i = 1, 3
        f(i) = x(i,k+1) + x(i,k)
        if (k .eq. 0) fx(i,i) = 1
        if (k .eq. 0) fxp(i,i) = 1
   10 continue
      end
      subroutine mass(t, nq, q, m, ldm, ipar, rpar, ierr)
      implicit none
      integer nq, ldm, ipar(*), ierr, i
      double precision t, q(nq), m(ldm,nq), rpar(*)
      do 10 i = 1, nq
        m(i,i) = 1
   10 continue
      end
      subroutine force(t, nq, q, v, f, ipar, rpar, ierr)
      implicit none
      integer nq, ipar(*), ierr
      double precision t, q(nq), v(nq), f(nq), rpar(*)
      f(1) = -1
      end
      subroutine constr(t, nq, nl, q, g, ipar, rpar, ierr)
      implicit none
      integer nq, nl, ipar(*), ierr
      double precision t, q(nq), g(nl), rpar(*)
      g(1) = q(1)
      end
      subroutine cjac(t, nq, nl, q, gq, ldgq, gt, ipar, rpar, ierr)
      implicit none
      integer nq, nl, ldgq, ipar(*), ierr
      double precision t, q(nq), gq(ldgq,nq), gt(nl), rpar(*)
      gq(1,1) = 1
      end
