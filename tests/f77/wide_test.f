c SPDX-License-Identifier: BSD-3-Clause
c
c DGELDA with INTEGERs of 64 bits, both methods:
c   x1' = x2, x2' = x3, 0 = x1 - sin t;  x = (sin t, cos t, -sin t)
      program wide
      implicit none
      external edif, adif, fdif
      integer*8 n, liw, lrw
      parameter (n = 3, liw = 20 + 6*n, lrw = 20 + 71*n + 114*n**2)
      integer*8 cval(4), ipar(1), iwork(liw), info(20), iwarn, ierr,
     $          method, i
      double precision t, tout, x(n), xprime(n), rpar(1), rwork(lrw),
     $                 rtol, atol, error
      logical good
      good = .true.
      do 20 method = 1, 2
        do 10 i = 1, 20
          info(i) = 0
   10   continue
        t = 0
        tout = 1
        x(1) = 0
        x(2) = 1
        x(3) = 0
        rtol = 1d-6
        atol = 1d-6
        ipar(1) = 5000000000_8
        rpar(1) = 0
        call dgelda_64(edif, adif, fdif, n, t, tout, x, xprime, cval,
     $                 ipar, rpar, iwork, liw, rwork, lrw, rtol, atol,
     $                 method, info, iwarn, ierr)
        error = max(abs(x(1) - sin(1d0)), abs(x(2) - cos(1d0)),
     $              abs(x(3) + sin(1d0)))
        if (ierr .ne. 3 .or. error .gt. 10 * (rtol + atol))
     $    good = .false.
        if (cval(1) .ne. 2 .or. cval(2) .ne. 0 .or. cval(3) .ne. 3 .or.
     $      cval(4) .ne. 0) good = .false.
        if (iwork(4) .ne. 3 .or. iwork(20) .ne. 10000) good = .false.
        if (ipar(1) .ne. 5000000000_8 .or. info(1) .ne. 1)
     $    good = .false.
   20 continue
      if (good) write (*, *) 'PASSED'
      if (.not. good) write (*, *) 'FAILED', ierr, error, cval
      end

      subroutine edif(n, t, idif, e, lde, ipar, rpar, ierr)
      implicit none
      integer*8 n, idif, lde, ipar(*), ierr
      double precision t, e(lde,*), rpar(*)
      call clear(n, e, lde)
      if (idif .eq. 0) e(1,1) = 1
      if (idif .eq. 0) e(2,2) = 1
      ierr = 0
      end

      subroutine adif(n, t, idif, a, lda, ipar, rpar, ierr)
      implicit none
      integer*8 n, idif, lda, ipar(*), ierr
      double precision t, a(lda,*), rpar(*)
      call clear(n, a, lda)
      if (idif .eq. 0) a(1,2) = 1
      if (idif .eq. 0) a(2,3) = 1
      if (idif .eq. 0) a(3,1) = 1
      ierr = 0
      end

c IPAR arrives in full.
      subroutine fdif(n, t, idif, f, ipar, rpar, ierr)
      implicit none
      integer*8 n, idif, ipar(*), ierr
      double precision t, f(*), rpar(*)
      f(1) = 0
      f(2) = 0
      f(3) = -sin(t + idif * acos(0d0))
      ierr = 0
      if (ipar(1) .ne. 5000000000_8) ierr = -2
      end

      subroutine clear(n, a, lda)
      implicit none
      integer*8 n, lda, i, j
      double precision a(lda,n)
      do 20 j = 1, n
        do 10 i = 1, n
          a(i,j) = 0
   10   continue
   20 continue
      end
