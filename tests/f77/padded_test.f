c SPDX-License-Identifier: BSD-3-Clause
c
c INTEGERs of 32 bits that look like ones of 64: in words of their own
c with zeros behind. DGELDA asks the subroutines, and goes on.
      program padded
      implicit none
      external edif, adif, fdif
      integer mostn, mostiw, mostrw, i, k
      parameter (mostn = 3, mostiw = 38, mostrw = 50 + 71*3 + 114*9)
      double precision t, tout, x(mostn), xprime(mostn), rpar(1),
     $                 rwork(mostrw), tol
      integer n, zero1, liw, zero2, lrw, zero3, method, zero4, ierr,
     $        zero5, info(20), cval(4), iwork(mostiw), ipar(1), iwarn
      common /pad/ t, n, zero1, liw, zero2, lrw, zero3, method, zero4,
     $             ierr, zero5, info
      logical good
      good = bit_size(n) .eq. 32
      do 20 k = 1, 2
        method = k
        t = 0
        tout = 1
        n = mostn
        liw = mostiw
        lrw = mostrw
        zero1 = 0
        zero2 = 0
        zero3 = 0
        zero4 = 0
        zero5 = 0
        tol = 1d-6
        ipar(1) = 0
        iwarn = 0
        do 10 i = 1, 20
          info(i) = 0
   10   continue
        do 15 i = 1, mostn
          x(i) = 0
   15   continue
        call dgelda(edif, adif, fdif, n, t, tout, x, xprime, cval, ipar,
     $              rpar, iwork, liw, rwork, lrw, tol, tol, method,
     $              info, iwarn, ierr)
        if (ierr .ne. 3 .or. abs(x(2) - cos(1d0)) .gt. 2d-5)
     $    good = .false.
        if (cval(1) .ne. 2 .or. cval(2) .ne. 0 .or. cval(3) .ne. 3 .or.
     $      cval(4) .ne. 0) good = .false.
        if (zero5 .ne. 0 .or. info(1) .ne. 1 .or. info(2) .ne. 0)
     $    good = .false.
   20 continue
      if (good) write (*, *) 'PASSED'
      if (.not. good) write (*, *) 'FAILED', ierr, cval, x
      end

c x1' = x2, x2' = x3, 0 = x1 - sin t.
      subroutine edif(n, t, k, e, lde, ipar, rpar, ierr)
      implicit none
      integer n, k, lde, ipar(*), ierr
      double precision t, e(lde,*), rpar(*)
      call clear(n, e, lde)
      if (k .eq. 0) e(1,1) = 1
      if (k .eq. 0) e(2,2) = 1
      end
      subroutine adif(n, t, k, a, lda, ipar, rpar, ierr)
      implicit none
      integer n, k, lda, ipar(*), ierr
      double precision t, a(lda,*), rpar(*)
      call clear(n, a, lda)
      if (k .eq. 0) a(1,2) = 1
      if (k .eq. 0) a(2,3) = 1
      if (k .eq. 0) a(3,1) = 1
      end
      subroutine fdif(n, t, k, f, ipar, rpar, ierr)
      implicit none
      integer n, k, ipar(*), ierr
      double precision t, f(*), rpar(*)
      f(1) = 0
      f(2) = 0
      f(3) = -sin(t + k * acos(0d0))
      end
      subroutine clear(n, a, lda)
      implicit none
      integer n, lda, i, j
      double precision a(lda,n)
      do 20 j = 1, n
        do 10 i = 1, n
          a(i,j) = 0
   10   continue
   20 continue
      end
