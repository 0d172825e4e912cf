c SPDX-License-Identifier: BSD-3-Clause
c
c All state of DGELDA lies in the caller's arrays: problems may be
c interleaved, arrays copied, what they contain at first does not
c matter. The documented lengths suffice, nothing behind is written.
      program state
      implicit none
      integer m
      do 10 m = 1, 2
        call mixed(m)
        call moved(m)
        call filled(m)
   10 continue
      call inside
      call sizes
      call finish
      end

c Two problems and both methods in turns: the bits of each run alone.
      subroutine mixed(m)
      implicit none
      include 'arguments.inc'
      integer m, k, i, bits
      double precision alone(3,10,2)
      do 20 k = 1, 2
        call begin(k, m)
        do 10 i = 1, 10
          call solve(0.1d0 * i)
          call check(ierr .eq. 3, 'alone: IERR', ierr)
          call keep(alone(1,i,k))
   10   continue
   20 continue
      do 30 k = 1, 2
        call begin(k, m)
        call swap(k)
   30 continue
      do 50 i = 1, 10
        do 40 k = 1, 2
          call swap(k)
          call solve(0.1d0 * i)
          call check(ierr .eq. 3, 'in turns: IERR', ierr)
          call check(bits(alone(1,i,k)) .eq. 0, 'in turns: X', i)
          call swap(k)
   40   continue
   50 continue
      end

c Problem 4 with METHOD = m, or problem 1 with the other one.
      subroutine begin(k, m)
      implicit none
      integer k, m
      if (k .eq. 1) call prepare(4, m)
      if (k .eq. 2) call prepare(1, 3 - m)
      end

      subroutine keep(y)
      implicit none
      include 'arguments.inc'
      integer i
      double precision y(3)
      do 10 i = 1, n
        y(i) = x(i)
   10 continue
      end

c Number of elements of X that are not those of y.
      integer function bits(y)
      implicit none
      include 'arguments.inc'
      integer i
      double precision y(3)
      bits = 0
      do 10 i = 1, n
        if (x(i) .ne. y(i)) bits = bits + 1
   10 continue
      end

c Exchanges the arguments in the common block with set k.
      subroutine swap(k)
      implicit none
      include 'arguments.inc'
      integer k, i, isets(500,2), ihere(500)
      double precision sets(2000,2), here(2000)
      save sets, isets
      call pack(here, ihere)
      call unpack(sets(1,k), isets(1,k))
      do 10 i = 1, 2000
        sets(i,k) = here(i)
   10 continue
      do 20 i = 1, 500
        isets(i,k) = ihere(i)
   20 continue
      end

      subroutine pack(r, j)
      implicit none
      include 'arguments.inc'
      integer i, j(500)
      double precision r(2000)
      r(1) = t
      do 10 i = 1, nmax
        r(1+i) = x(i)
        r(4+i) = xprime(i)
        r(7+i) = rtol(i)
        r(10+i) = atol(i)
   10 continue
      do 20 i = 1, 4
        r(20+i) = rpar(i)
        j(i) = cval(i)
   20 continue
      do 30 i = 1, mostrw
        r(30+i) = rwork(i)
   30 continue
      do 40 i = 1, 20
        j(10+i) = info(i)
   40 continue
      do 50 i = 1, 10
        j(30+i) = ipar(i)
   50 continue
      do 60 i = 1, mostiw
        j(50+i) = iwork(i)
   60 continue
      j(41) = n
      j(42) = liw
      j(43) = lrw
      j(44) = method
      j(45) = ierr
      end

      subroutine unpack(r, j)
      implicit none
      include 'arguments.inc'
      integer i, j(500)
      double precision r(2000)
      t = r(1)
      do 10 i = 1, nmax
        x(i) = r(1+i)
        xprime(i) = r(4+i)
        rtol(i) = r(7+i)
        atol(i) = r(10+i)
   10 continue
      do 20 i = 1, 4
        rpar(i) = r(20+i)
        cval(i) = j(i)
   20 continue
      do 30 i = 1, mostrw
        rwork(i) = r(30+i)
   30 continue
      do 40 i = 1, 20
        info(i) = j(10+i)
   40 continue
      do 50 i = 1, 10
        ipar(i) = j(30+i)
   50 continue
      do 60 i = 1, mostiw
        iwork(i) = j(50+i)
   60 continue
      n = j(41)
      liw = j(42)
      lrw = j(43)
      method = j(44)
      ierr = j(45)
      end

c Continues from a copy at another address, in every kind of state:
c after TOUT = T, between steps, after an interruption.
      subroutine moved(m)
      implicit none
      include 'arguments.inc'
      integer m, k, i, bits, iraw(500), steps
      double precision y(3), raw(2000), zero
      zero = 0
      do 40 k = 0, 1
        call prepare(4, m)
        info(14) = 1
        iwork(20) = 7
        info(3) = k
        call all(2d0)
        call keep(y)
        steps = iwork(11)
        call prepare(4, m)
        info(14) = 1
        iwork(20) = 7
        info(3) = k
        call solve(0d0)
        do 30 i = 1, 1000
          call pack(raw, iraw)
          call other(raw(31), iraw(51), raw, iraw)
          if (iraw(45) .eq. 3) goto 35
   30   continue
   35   call unpack(raw, iraw)
        call check(ierr .eq. 3 .and. t .eq. 2, 'copy: IERR', ierr)
        call check(bits(y) .eq. 0, 'copy: X', k)
        call check(iwork(11) .eq. steps, 'copy: steps', iwork(11))
   40 continue
      end

c To tout, over all interruptions, after a call with TOUT = T.
      subroutine all(tout)
      implicit none
      include 'arguments.inc'
      integer i
      double precision tout
      call solve(0d0)
      do 10 i = 1, 1000
        if (info(1) .eq. -1) info(1) = 1
        call solve(tout)
        if (ierr .eq. 3) return
   10 continue
      end

c One call with everything in other arrays than the common block; that
c is spoiled first.
      subroutine other(rw, iw, r, j)
      implicit none
      include 'arguments.inc'
      double precision rw(*), r(2000)
      integer iw(*), j(500), i
      external edif, adif, fdif
      do 10 i = 1, mostrw
        rwork(i) = 1d300
   10 continue
      do 20 i = 1, mostiw
        iwork(i) = 99999
   20 continue
      if (j(11) .eq. -1) j(11) = 1
      call dgelda(edif, adif, fdif, j(41), r(1), 2d0, r(2), r(5), j(1),
     $            j(31), r(21), iw, j(42), rw, j(43), r(8), r(11),
     $            j(44), j(11), iwarn, j(45))
      call unpack(r, j)
      end

c BDF: a TOUT within the last step is reached without another one.
      subroutine inside
      implicit none
      include 'arguments.inc'
      integer k, steps
      double precision far, from, worst
      call prepare(3, 1)
      call solve(1d0)
      far = rwork(4)
      from = t
      steps = iwork(11)
      call check(far .gt. t, 'the last step goes past TOUT', steps)
      do 10 k = 1, 4
        call solve(from + 0.25d0 * k * (far - from))
        call check(ierr .eq. 3, 'within the step: IERR', ierr)
        call check(iwork(11) .eq. steps .and. rwork(4) .eq. far,
     $             'within the step: no step', k)
        call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'within', k)
   10 continue
      call solve(far + 1)
      call check(ierr .eq. 3 .and. iwork(11) .gt. steps, 'on', ierr)
      call check(worst(n, t, x, ipar, 1d-6) .le. 10, 'on: X', steps)
      end

c The same bits whatever the arrays contain at first.
      subroutine filled(m)
      implicit none
      include 'arguments.inc'
      integer m, k, i, bits, with(3)
      double precision y(3), zero, what(3)
      data with /0, 1, -2147483647/
      zero = 0
      what(1) = 0
      what(2) = 1 / zero
      what(3) = -1d300
      call prepare(4, m)
      call solve(1d0)
      call check(ierr .eq. 3, 'NaN in RWORK: IERR', ierr)
      call keep(y)
      do 40 k = 1, 3
        call prepare(4, m)
        do 10 i = 1, lrw
          rwork(i) = what(k)
   10   continue
        do 20 i = 1, liw
          iwork(i) = with(k)
   20   continue
        do 30 i = 1, n
          xprime(i) = what(k)
          cval(i) = with(k)
   30   continue
        iwarn = with(k)
        ierr = with(k)
        call solve(1d0)
        call check(ierr .eq. 3, 'other contents: IERR', ierr)
        call check(bits(y) .eq. 0, 'other contents: X', k)
   40 continue
      end

c Minimal lengths for every N, MXINDX and MAXORD.
      subroutine sizes
      implicit none
      integer m, n, mxindx, maxord, const
      do 50 m = 1, 2
        do 40 n = 1, 6
          do 30 mxindx = 0, 4
            do 20 maxord = 1, 5
              do 10 const = 0, 1
                call guard(m, n, mxindx, maxord, const)
   10         continue
   20       continue
   30     continue
   40   continue
   50 continue
      end

c Runs problem 5 with mu as high as MXINDX and N allow. 20 elements
c before and behind every array keep what they are.
      subroutine guard(m, n, mxindx, maxord, const)
      implicit none
      integer m, n, mxindx, maxord, const
      integer g, biggest
      parameter (g = 20, biggest = 6700)
      external edif, adif, fdif
      integer minliw, minlrw, liw, lrw, number, cval(2*g + 4),
     $        ipar(2*g + 10), iwork(2*g + 56), info(2*g + 20), method,
     $        neq, iwarn, ierr, k
      double precision x(2*g + 6), xprime(2*g + 6), rpar(2*g + 4),
     $                 rwork(2*g + biggest), rtol, atol, t, tout, worst
      liw = minliw(n, m)
      lrw = minlrw(n, m, maxord, mxindx)
      number = 10000*m + 1000*n + 100*mxindx + 10*maxord + const
      call choose(5, ipar(g+1), rpar(g+1))
      ipar(g+2) = min(mxindx, n-1)
      call fresh(n, t, x(g+1), xprime(g+1), cval(g+1), iwork(g+1), liw,
     $           rwork(g+1), lrw, info(g+1), iwarn, ierr)
      call exact(n, t, ipar(g+1), x(g+1))
      call dmarks(x, n, .true., number)
      call dmarks(xprime, n, .true., number)
      call dmarks(rpar, 4, .true., number)
      call dmarks(rwork, lrw, .true., number)
      call imarks(cval, 4, .true., number)
      call imarks(ipar, 10, .true., number)
      call imarks(iwork, liw, .true., number)
      call imarks(info, 20, .true., number)
      info(g+5) = const
      info(g+9) = 1
      info(g+10) = 1
      iwork(g+3) = maxord
      iwork(g+4) = mxindx
      rtol = 1d-3
      atol = 1d-3
      method = m
      neq = n
      do 10 k = 0, 2
        tout = 0.5d0 * k
        call dgelda(edif, adif, fdif, neq, t, tout, x(g+1),
     $              xprime(g+1), cval(g+1), ipar(g+1), rpar(g+1),
     $              iwork(g+1), liw, rwork(g+1), lrw, rtol, atol,
     $              method, info(g+1), iwarn, ierr)
        if (k .eq. 0) call check(ierr .eq. 4, 'sizes: start', number)
        if (k .gt. 0) call check(ierr .eq. 3, 'sizes: IERR', number)
        if (ierr .lt. 0) call check(.false., 'IERR', ierr)
        call check(worst(n, t, x(g+1), ipar(g+1), rtol) .le. 10,
     $             'sizes: X', number)
   10 continue
      call check(cval(g+1) .eq. ipar(g+2) .and.
     $           cval(g+2) .eq. n - 1 - ipar(g+2) .and.
     $           cval(g+3) .eq. ipar(g+2) + 1 .and. cval(g+4) .eq. 0,
     $           'sizes: CVAL', number)
      call check(ipar(g+6) .le. mxindx, 'sizes: orders', number)
      call check(ipar(g+9) .eq. 0, 'sizes: arguments', number)
      call check(neq .eq. n .and. method .eq. m .and. tout .eq. 1
     $           .and. liw .eq. minliw(n, m) .and.
     $           lrw .eq. minlrw(n, m, maxord, mxindx),
     $           'inputs are inputs', number)
      call dmarks(x, n, .false., number)
      call dmarks(xprime, n, .false., number)
      call dmarks(rpar, 4, .false., number)
      call dmarks(rwork, lrw, .false., number)
      call imarks(cval, 4, .false., number)
      call imarks(ipar, 10, .false., number)
      call imarks(iwork, liw, .false., number)
      call imarks(info, 20, .false., number)
      end

c Sets (set) or checks the 20 elements before and behind a.
      subroutine dmarks(a, length, set, number)
      implicit none
      integer length, number, i, g
      parameter (g = 20)
      logical set
      double precision a(*)
      do 10 i = 1, g
        if (set) a(i) = -i
        if (set) a(g+length+i) = i
        if (.not. set) call check(a(i) .eq. -i .and.
     $    a(g+length+i) .eq. i, 'outside a DOUBLE PRECISION', number)
   10 continue
      end

      subroutine imarks(a, length, set, number)
      implicit none
      integer length, number, i, g, a(*)
      parameter (g = 20)
      logical set
      do 10 i = 1, g
        if (set) a(i) = -i
        if (set) a(g+length+i) = i
        if (.not. set) call check(a(i) .eq. -i .and.
     $    a(g+length+i) .eq. i, 'outside an INTEGER array', number)
   10 continue
      end
