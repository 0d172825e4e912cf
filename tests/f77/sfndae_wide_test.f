c SPDX-License-Identifier: BSD-3-Clause
c
c SFNDAE with INTEGERs of 64 bits, both methods:
c   x2' = x1, 0 = x1**2 + x2**2 - 1;  x = (cos t, sin t)
      program wide
      implicit none
      external ndif
      integer*8 n, liw, lrw
      parameter (n = 2, liw = 20, lrw = 100 + 2*3 + n + (30 + 4*3) * n)
      integer*8 cval(5), ipar(1), iwork(liw), info(20), iwarn, ierr,
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
        x(1) = 1
        x(2) = 0
        rtol = 1d-6
        atol = 1d-6
        ipar(1) = 5000000000_8
        rpar(1) = 0
        call sfndae_64(ndif, n, n, t, tout, x, xprime, cval, ipar,
     $                 rpar, iwork, liw, rwork, lrw, rtol, atol,
     $                 method, info, iwarn, ierr)
        error = max(abs(x(1) - cos(1d0)), abs(x(2) - sin(1d0)))
        if (ierr .ne. 3 .or. error .gt. 10 * (rtol + atol))
     $    good = .false.
        if (cval(1) .ne. 0 .or. cval(2) .ne. 1 .or. cval(3) .ne. 1 .or.
     $      cval(4) .ne. 0 .or. cval(5) .ne. 0) good = .false.
        if (iwork(4) .ne. 3 .or. iwork(20) .ne. 10000) good = .false.
        if (ipar(1) .ne. 5000000000_8 .or. info(1) .ne. 1)
     $    good = .false.
        if (iwarn .ne. 0) good = .false.
   20 continue
      if (good) write (*, *) 'PASSED'
      if (.not. good) write (*, *) 'FAILED', ierr, error, cval
      end

c IPAR arrives in full.
      subroutine ndif(t, k, n, m, x, ldx, f, fx, ldfx, fxp, ldfxp,
     $                ipar, rpar, ierr)
      implicit none
      integer*8 k, n, m, ldx, ldfx, ldfxp, ipar(*), ierr, j
      double precision t, x(ldx,0:*), f(*), fx(ldfx,*), fxp(ldfxp,*),
     $                 rpar(*), c
      if (ipar(1) .ne. 5000000000_8) ierr = -2
      f(1) = x(2,k+1) - x(1,k)
      f(2) = 0
      if (k .eq. 0) f(2) = -1
      c = 1
      do 10 j = 0, k
        f(2) = f(2) + c * (x(1,j) * x(1,k-j) + x(2,j) * x(2,k-j))
        c = c * (k - j) / (j + 1)
   10 continue
      fx(2,1) = 2 * x(1,k)
      fx(2,2) = 2 * x(2,k)
      if (k .gt. 0) return
      fx(1,1) = -1
      fxp(1,2) = 1
      end
