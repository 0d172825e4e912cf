c SPDX-License-Identifier: BSD-3-Clause
c
c What the tests of DGELDA share: problems with known solutions as
c EDIF, ADIF, FDIF, their solution, arrays full of garbage, checks.
c
c IPAR chooses the problem, counts the calls and tells what to do wrong:
c   1  problem:
c        1  0 = -x1 + t x2 + e^-t, x1' - t x2' = 0      (1, 0, 2, 0)
c           x = ((1+t) e^-t, e^-t)
c        2  x1' = -x1, 0 = x1 - x2                      (0, 1, 1, 0)
c           x = (e^-t, e^-t)
c        3  x1' = x2, x2' = -x1, x = (sin t, cos t)     (0, 2, 0, 0)
c        4  x1' = x2, x2' = x3, 0 = x1 - sin t          (2, 0, 3, 0)
c           x = (sin t, cos t, -sin t)
c        5  any n: x(i+1)' = x(i) - sin t, i = 1..mu,
c           0 = x(mu+1) - sin t, x(i)' = cos t + sin t - x(i) for the
c           rest: x(mu+1) = sin t, x(i) = x(i+1)' + sin t, the rest
c           sin t                             (mu, n-mu-1, mu+1, 0)
c        6  x1' = -x1, s(t) x2' = cos t - s(t) sin t - x2, s = 1 for
c           t < 0.4, 0 from there: x = (e^-t, cos t)
c                                   (0, 2, 0, 0), then (0, 1, 1, 0)
c        7  x1' = -x1, 0 = r(t): solvable if r = RPAR(4) is 0
c           x = (e^-t, X2 at the start)                 (0, 1, 0, 1)
c        8  x1' = -x1, RPAR(4) x2' = -x2
c        9  x1' = j(t), j = 0 up to t = 1/2, 1e30 from there; x2' = 0
c       10  0 = x1 - p(t), p = (1/2 - t)^3 up to 1/2, 0 from there;
c           x2' = 0, x2 = 1
c   2  mu of problem 5
c   3, 4, 5  number of calls of EDIF, ADIF, FDIF
c   6  highest order asked for
c   7  IERR to return for t > RPAR(1); 99: NaN instead
c   8  how often to do so; negative: always
c   9  number of calls with arguments that the interface excludes
c  10  number of such returns so far
c RPAR: 1 see IPAR(7); 2, 3 smallest and largest t asked for; 4 see above

      subroutine edif(n, t, idif, e, lde, ipar, rpar, ierr)
      implicit none
      integer n, idif, lde, ipar(*), ierr
      double precision t, e(lde,*), rpar(*)
      integer i, mu
      call record(3, n, t, idif, lde, ipar, rpar, ierr)
      call clear(n, n, e, lde)
      if (ipar(1) .eq. 1) then
        if (idif .eq. 0) e(2,1) = 1
        if (idif .eq. 0) e(2,2) = -t
        if (idif .eq. 1) e(2,2) = -1
      else if (idif .eq. 0) then
        mu = ipar(2)
        do 10 i = 1, n
          if (ipar(1) .ne. 5) e(i,i) = 1
          if (ipar(1) .eq. 5 .and. i .gt. mu+1) e(i,i) = 1
          if (ipar(1) .eq. 5 .and. i .le. mu) e(i,i+1) = 1
   10   continue
        if (ipar(1) .eq. 2 .or. ipar(1) .eq. 7) e(2,2) = 0
        if (ipar(1) .eq. 4) e(3,3) = 0
        if (ipar(1) .eq. 6 .and. t .ge. 0.4d0) e(2,2) = 0
        if (ipar(1) .eq. 8) e(2,2) = rpar(4)
        if (ipar(1) .eq. 10) e(1,1) = 0
      end if
      call misuse(t, e, ipar, rpar, ierr)
      end

      subroutine adif(n, t, idif, a, lda, ipar, rpar, ierr)
      implicit none
      integer n, idif, lda, ipar(*), ierr
      double precision t, a(lda,*), rpar(*)
      integer i, mu
      call record(4, n, t, idif, lda, ipar, rpar, ierr)
      call clear(n, n, a, lda)
      if (ipar(1) .eq. 1) then
        if (idif .eq. 0) a(1,1) = -1
        if (idif .eq. 0) a(1,2) = t
        if (idif .eq. 1) a(1,2) = 1
      else if (idif .eq. 0) then
        mu = ipar(2)
        if (ipar(1) .eq. 2) then
          a(1,1) = -1
          a(2,1) = 1
          a(2,2) = -1
        else if (ipar(1) .eq. 3) then
          a(1,2) = 1
          a(2,1) = -1
        else if (ipar(1) .eq. 4) then
          a(1,2) = 1
          a(2,3) = 1
          a(3,1) = 1
        else if (ipar(1) .eq. 5) then
          do 10 i = 1, n
            a(i,i) = -1
            if (i .le. mu+1) a(i,i) = 1
   10     continue
        else if (ipar(1) .eq. 6 .or. ipar(1) .eq. 8) then
          a(1,1) = -1
          a(2,2) = -1
        else if (ipar(1) .eq. 7) then
          a(1,1) = -1
        else if (ipar(1) .eq. 10) then
          a(1,1) = 1
        end if
      end if
      call misuse(t, a, ipar, rpar, ierr)
      end

      subroutine fdif(n, t, idif, f, ipar, rpar, ierr)
      implicit none
      integer n, idif, ipar(*), ierr
      double precision t, f(*), rpar(*)
      integer i, mu
      double precision s, c, shift, e
      call record(5, n, t, idif, n, ipar, rpar, ierr)
      call clear(n, 1, f, n)
c     sin, cos and e^-t, differentiated idif times
      shift = idif * acos(0.0d0)
      s = sin(t + shift)
      c = cos(t + shift)
      e = (-1)**idif * exp(-t)
      mu = ipar(2)
      if (ipar(1) .eq. 1) then
        f(1) = e
      else if (ipar(1) .eq. 4) then
        f(3) = -s
      else if (ipar(1) .eq. 5) then
        do 10 i = 1, n
          f(i) = c + s
          if (i .le. mu+1) f(i) = -s
   10   continue
      else if (ipar(1) .eq. 6) then
        f(2) = c
        if (t .lt. 0.4d0) f(2) = c - s
      else if (ipar(1) .eq. 7) then
        if (idif .eq. 0) f(2) = rpar(4)
      else if (ipar(1) .eq. 9) then
        if (idif .eq. 0 .and. t .ge. 0.5d0) f(1) = 1d30
      else if (ipar(1) .eq. 10 .and. t .lt. 0.5d0) then
        if (idif .eq. 0) f(1) = -(0.5d0 - t)**3
        if (idif .eq. 1) f(1) = 3 * (0.5d0 - t)**2
        if (idif .eq. 2) f(1) = -6 * (0.5d0 - t)
        if (idif .eq. 3) f(1) = 6
      end if
      call misuse(t, f, ipar, rpar, ierr)
      end

c The exact solution, where there is one.
      subroutine exact(n, t, ipar, x)
      implicit none
      integer n, ipar(*), i
      double precision t, x(n)
      do 10 i = 1, n
        x(i) = sin(t)
        if (ipar(1) .eq. 1 .or. ipar(1) .eq. 2) x(i) = exp(-t)
        if (ipar(1) .ge. 6 .and. ipar(1) .le. 8) x(i) = exp(-t)
   10 continue
      if (ipar(1) .eq. 1) x(1) = (1 + t) * exp(-t)
      if (ipar(1) .eq. 3 .or. ipar(1) .eq. 4) x(2) = cos(t)
      if (ipar(1) .eq. 4) x(3) = -sin(t)
      if (ipar(1) .eq. 6) x(2) = cos(t)
      if (ipar(1) .eq. 5) then
c       x(i) is the sum of the derivatives 0..mu+1-i of the sine
        do 20 i = ipar(2), 1, -1
          x(i) = x(i+1) + sin(t + (ipar(2) + 1 - i) * acos(0.0d0))
   20   continue
      end if
      end

c Notes a call; which: position of its counter.
      subroutine record(which, n, t, idif, ld, ipar, rpar, ierr)
      implicit none
      integer which, n, idif, ld, ipar(*), ierr
      double precision t, rpar(*)
      ipar(which) = ipar(which) + 1
      ipar(6) = max(ipar(6), idif)
      rpar(2) = min(rpar(2), t)
      rpar(3) = max(rpar(3), t)
      if (n .lt. 1 .or. idif .lt. 0 .or. ld .lt. n .or. ierr .ne. 0)
     $  ipar(9) = ipar(9) + 1
      end

c Fails if that is wanted.
      subroutine misuse(t, values, ipar, rpar, ierr)
      implicit none
      integer ipar(*), ierr
      double precision t, values(*), rpar(*), zero
      if (ipar(7) .eq. 0 .or. t .le. rpar(1) .or. ipar(8) .eq. 0) return
      if (ipar(8) .gt. 0) ipar(8) = ipar(8) - 1
      ipar(10) = ipar(10) + 1
      zero = 0
      if (ipar(7) .eq. 99) values(1) = zero / zero
      if (ipar(7) .ne. 99) ierr = ipar(7)
      end

      subroutine clear(rows, cols, a, lda)
      implicit none
      integer rows, cols, lda, i, j
      double precision a(lda,cols)
      do 20 j = 1, cols
        do 10 i = 1, rows
          a(i,j) = 0
   10   continue
   20 continue
      end

c Chooses a problem that does nothing wrong.
      subroutine choose(problem, ipar, rpar)
      implicit none
      integer problem, ipar(10), i
      double precision rpar(4)
      do 10 i = 1, 10
        ipar(i) = 0
   10 continue
      ipar(1) = problem
      rpar(1) = 0
      rpar(2) = 1d300
      rpar(3) = -1d300
      rpar(4) = 0
      end

c Arguments of a first call: defaults, garbage where contents do not
c matter.
      subroutine fresh(n, t, x, xprime, cval, iwork, liw, rwork, lrw,
     $                 info, iwarn, ierr)
      implicit none
      integer n, cval(4), liw, iwork(liw), lrw, info(20), iwarn, ierr, i
      double precision t, x(n), xprime(n), rwork(lrw), zero, nan
      zero = 0
      nan = zero / zero
      t = 0
      do 10 i = 1, n
        x(i) = 0
        xprime(i) = nan
   10 continue
      do 20 i = 1, 4
        cval(i) = -77
   20 continue
      do 30 i = 1, liw
        iwork(i) = -1234567891
   30 continue
      do 40 i = 1, lrw
        rwork(i) = nan
   40 continue
      do 50 i = 1, 20
        info(i) = 0
   50 continue
      iwarn = 0
      ierr = -77
      end

c Prepares the arguments in the common block for a first call: the
c problem at its exact solution at T = 0, RTOL = ATOL = 1e-6, minimal
c lengths, otherwise as fresh does.
      subroutine prepare(problem, which)
      implicit none
      include 'arguments.inc'
      integer problem, which, minliw, minlrw, i
      n = 2
      if (problem .eq. 4) n = 3
      method = which
      liw = minliw(n, method)
      lrw = minlrw(n, method, 5, 3)
      call choose(problem, ipar, rpar)
      call fresh(n, t, x, xprime, cval, iwork, liw, rwork, lrw, info,
     $           iwarn, ierr)
      call exact(n, t, ipar, x)
      do 10 i = 1, n
        rtol(i) = 1d-6
        atol(i) = 1d-6
   10 continue
      end

c Calls DGELDA with them.
      subroutine solve(tout)
      implicit none
      include 'arguments.inc'
      double precision tout
      external edif, adif, fdif
      call dgelda(edif, adif, fdif, n, t, tout, x, xprime, cval, ipar,
     $            rpar, iwork, liw, rwork, lrw, rtol, atol, method,
     $            info, iwarn, ierr)
      end

c Largest error in x, in units of tol (abs(exact) + 1); 1d300 for NaN.
      double precision function worst(n, t, x, ipar, tol)
      implicit none
      integer n, ipar(*), i
      double precision t, x(n), tol, y(100), error
      call exact(n, t, ipar, y)
      worst = 0
      do 10 i = 1, n
        error = abs(x(i) - y(i)) / (tol * (abs(y(i)) + 1))
        if (.not. error .lt. 1d300) error = 1d300
        worst = max(worst, error)
   10 continue
      end

c Documented minimal lengths of the work arrays.
      integer function minliw(n, method)
      implicit none
      integer n, method
      minliw = 20 + 6*n
      if (method .eq. 1) minliw = 20 + 2*n
      end

      integer function minlrw(n, method, maxord, mxindx)
      implicit none
      integer n, method, maxord, mxindx, q
      q = mxindx + 1
      if (method .eq. 1) then
        minlrw = 50 + (21 + maxord + 14*mxindx)*n
     $           + (6 + mxindx + 6*q**2)*n**2
      else
        minlrw = 20 + (29 + 14*mxindx)*n + (15 + mxindx + 6*q**2)*n**2
      end if
      end

c Counts and prints what is wrong. number: any that helps to find it.
      subroutine check(ok, text, number)
      implicit none
      logical ok
      character*(*) text
      integer number, nfail
      common /tally/ nfail
      if (ok) return
      nfail = nfail + 1
      write (*, '(3a,i12,a)') 'FAILED: ', text, ' (', number, ')'
      end

      subroutine finish
      implicit none
      integer nfail
      common /tally/ nfail
      if (nfail .eq. 0) write (*, '(a)') 'PASSED'
      if (nfail .ne. 0) stop 1
      end

      block data empty
      implicit none
      integer nfail
      common /tally/ nfail
      data nfail /0/
      end
