c SPDX-License-Identifier: BSD-3-Clause
c
c Every code of SFNDAE for illegal input, in the order of testing: with
c the input for code number i and all later ones wrong, code number i
c comes back. Nothing is changed but INFO(1), IWORK, RWORK and IERR.
      program refuse
      implicit none
      integer m
      do 10 m = 1, 2
        call order(m)
        call switch(m)
        call length(m)
        call again(m)
   10 continue
      call finish
      end

      subroutine order(method)
      implicit none
      integer method, i, k, count, codes(21)
      parameter (count = 21)
      include 'sfndae.inc'
      data codes /-101, -102, -133, -103, -104, -105, -111, -120, -121,
     $            -122, -123, -107, -108, -109, -10, -115, -114, -112,
     $            -113, -116, -110/
      do 20 i = 1, count
        call sfinit(method)
        t = 1
        tout = 2
        do 10 k = count, i, -1
          call spoil(codes(k))
   10   continue
        call sfcall
        call check(ierr .eq. codes(i), 'IERR, not this one', ierr)
        call check(ierr .eq. codes(i), 'this one', codes(i))
        call check(info(1) .eq. -1, 'INFO(1)', codes(i))
        call check(t .eq. 1, 'T untouched', codes(i))
        call check(x(1) .eq. 1 .and. x(2) .eq. 0, 'X untouched',
     $             codes(i))
        call check(iwarn .eq. 0, 'IWARN', codes(i))
        if (i .gt. 15) goto 20
        call check(xprime(1) .eq. 17, 'XPRIME untouched', codes(i))
        call check(cval(1) .eq. -77, 'CVAL untouched', codes(i))
        if (i .lt. 15) call check(ipar(1) .eq. 0, 'nothing called',
     $                            codes(i))
   20 continue
      call sfinit(method)
      info(5) = 1
      call sfcall
      call check(ierr .eq. -101, 'INFO(5) = 1', ierr)
      call sfinit(3)
      call sfcall
      call check(ierr .eq. -132, 'METHOD = 3', ierr)
      call sfinit(method)
      tout = t
      call sfcall
      call check(ierr .eq. 4, 'IERR = 4', ierr)
      call sfcall
      call check(ierr .eq. -119, 'TOUT = T again', ierr)
      call sfinit(method)
      x(1) = 1d300 * 1d300
      call sfcall
      call check(ierr .eq. -24, 'X infinite', ierr)
      end

c Makes an argument wrong.
      subroutine spoil(code)
      implicit none
      integer code
      include 'sfndae.inc'
      if (code .eq. -101) info(12) = 2
      if (code .eq. -102) n = 0
      if (code .eq. -133) m = 5001
      if (code .eq. -103) info(9) = 1
      if (code .eq. -103) iwork(3) = 6
      if (code .eq. -104) info(10) = 1
      if (code .eq. -104) iwork(4) = -1
      if (code .eq. -105) lrw = mostrw - 1
      if (code .eq. -111) info(7) = 1
      if (code .eq. -111) rwork(2) = 0
      if (code .eq. -120) info(14) = 1
      if (code .eq. -120) iwork(20) = 0
      if (code .eq. -121 .or. code .eq. -122) then
        info(16) = 1
        rwork(11) = 0.9d0
        rwork(12) = 0.5d0
        rwork(13) = 0.125d0
        if (code .eq. -121) rwork(11) = 1
      end if
      if (code .eq. -123) then
        info(17) = 1
        rwork(14) = 1.5d0
        rwork(15) = 2
      end if
      if (code .eq. -107) rtol = -1
      if (code .eq. -108) atol = -1
      if (code .eq. -109) rtol = 0
      if (code .eq. -109 .or. code .eq. -114) atol = 0
      if (code .eq. -10) ipar(2) = -1
      if (code .eq. -115) tout = t * (1 + 2d0**(-51))
      if (code .eq. -112 .or. code .eq. -113) then
        info(8) = 1
        rwork(3) = 0
        if (code .eq. -112) rwork(3) = -0.1d0
      end if
      if (code .eq. -116 .or. code .eq. -110) then
        info(4) = 1
        rwork(1) = 1.5d0
        if (code .eq. -116) rwork(1) = 0.5d0
      end if
      end

c INFO(2) ... INFO(20) are 0 or 1, INFO(1) is not below -1.
      subroutine switch(method)
      implicit none
      integer method, i, k
      include 'sfndae.inc'
      do 20 i = 2, 20
        do 10 k = -1, 2, 3
          call sfinit(method)
          info(i) = k
          call sfcall
          call check(ierr .eq. -101, 'INFO(i)', i)
   10   continue
   20 continue
      call sfinit(method)
      info(1) = -2
      call sfcall
      call check(ierr .eq. -101, 'INFO(1) = -2', ierr)
      call sfinit(method)
      info(1) = 1
      call sfcall
      call check(ierr .eq. -101, 'nothing to go on from', ierr)
      end

c The length that is needed is in IWORK(LIW), and suffices.
      subroutine length(method)
      implicit none
      integer method, k
      include 'sfndae.inc'
      do 10 k = 2, 3
        call sfinit(method)
        info(10) = 1
        iwork(4) = k
        lrw = 19
        call sfcall
        call check(ierr .eq. -105, 'LRW = 19', ierr)
        call check(iwork(liw) .eq. 100 + 2*k + m + (30 + 4*k) * n,
     $             'LRW needed', iwork(liw))
        lrw = iwork(liw) - 1
        call sized(method, k, lrw)
        call sfcall
        call check(ierr .eq. -105, 'LRW one too small', ierr)
        call sized(method, k, lrw + 1)
        call sfcall
        call check(ierr .eq. 3, 'LRW as needed', ierr)
   10 continue
      call sfinit(method)
      liw = 19
      call sfcall
      call check(ierr .eq. -106, 'LIW = 19', ierr)
      call check(iwork(19) .eq. 20, 'LIW needed', iwork(19))
      call sfinit(method)
      liw = 1
      call sfcall
      call check(ierr .eq. -106, 'LIW too small', ierr)
      call check(iwork(1) .eq. 20, 'LIW needed', iwork(1))
      call sfinit(method)
      liw = 0
      call sfcall
      call check(ierr .eq. -106, 'LIW = 0', ierr)
      end

      subroutine sized(method, mxindx, length)
      implicit none
      integer method, mxindx, length, wanted
      include 'sfndae.inc'
      wanted = length
      call sfinit(method)
      info(10) = 1
      iwork(4) = mxindx
      lrw = wanted
      end

c After a failure the caller has to set INFO(1).
      subroutine again(method)
      implicit none
      integer method
      include 'sfndae.inc'
      call sfinit(method)
      rtol = -1
      call sfcall
      rtol = 1d-6
      call sfcall
      call check(ierr .eq. -999, 'after illegal input', ierr)
      info(1) = 0
      ipar(2) = -1
      call sfcall
      call check(ierr .eq. -10, 'NDIF fails', ierr)
      call sfcall
      call check(ierr .eq. -998, 'after a failure', ierr)
      info(1) = 0
      ipar(2) = 0
      call sfcall
      call check(ierr .eq. 3, 'a new start', ierr)
      tout = 0.5d0
      call sfcall
      call check(ierr .eq. -112, 'TOUT behind T', ierr)
      call check(t .eq. 1, 'T stays', ierr)
      info(1) = 1
      tout = 1.5d0
      call sfcall
      call check(ierr .eq. 3, 'and on', ierr)
      end
