c SPDX-License-Identifier: BSD-3-Clause
c
c SFNDAF, which is given the derivative array, and SFNDAE, which is
c given order by order: the same pendulum (mu = 2) and the same circuit
c (mu = 1) by both methods; and arrays that are wrong.
c
c IPAR: 1 calls, 2 what is wrong, 3 highest order asked for.
      program arrays
      implicit none
      integer method
      do 10 method = 1, 2
        call swing(method)
        call charge(method)
        call missing(method)
        call wrong(method)
   10 continue
      call finish
      end

c The pendulum: F_x' is constant, and all bits are the same.
      subroutine swing(method)
      implicit none
      external pendul, pendar
      integer method, i, k, lrw
      parameter (lrw = 106 + 5 + 42*5)
      integer cval(5,2), ipar(3,2), iwork(20,2), info(20,2), iwarn(2),
     $        ierr(2)
      double precision t(2), x(5,2), xp(5,2), rpar(1), rwork(lrw,2), tol
      call arrini(t, x, info, iwarn, ipar, 5)
      rpar(1) = 1d300
      tol = 1d-8
      do 20 k = 0, 5
        call sfndae(pendul, 5, 5, t(1), 0.3d0*k, x(1,1), xp(1,1),
     $              cval(1,1), ipar(1,1), rpar, iwork(1,1), 20,
     $              rwork(1,1), lrw, tol, tol, method, info(1,1),
     $              iwarn(1), ierr(1))
        call sfndaf(pendar, 5, 5, t(2), 0.3d0*k, x(1,2), xp(1,2),
     $              cval(1,2), ipar(1,2), rpar, iwork(1,2), 20,
     $              rwork(1,2), lrw, tol, tol, method, info(1,2),
     $              iwarn(2), ierr(2))
        call check(ierr(2) .eq. 3 .or. k .eq. 0 .and. ierr(2) .eq. 4,
     $             'IERR of the pendulum', ierr(2))
        call check(ierr(1) .eq. ierr(2), 'the same IERR', ierr(1))
        do 10 i = 1, 5
          call check(x(i,1) .eq. x(i,2), 'the same X', i)
          call check(xp(i,1) .eq. xp(i,2), 'the same XPRIME', i)
          call check(cval(i,1) .eq. cval(i,2), 'the same CVAL', i)
   10   continue
        if (k .gt. 0) call check(iwork(11,1) .eq. iwork(11,2) .and.
     $    iwork(12,1) .eq. iwork(12,2), 'the same counts', iwork(12,2))
   20 continue
      call check(cval(1,2) .eq. 2 .and. cval(2,2) .eq. 2 .and.
     $           cval(3,2) .eq. 3, 'CVAL of the pendulum', cval(1,2))
      call check(abs(x(1,2)**2 + x(2,2)**2 - 1) .le. 1d-13, 'length',
     $           method)
      call check(ipar(3,2) .eq. ipar(3,1), 'orders', ipar(3,2))
      call check(ipar(1,2) .lt. ipar(1,1), 'fewer calls', ipar(1,2))
      end

c A source sin t charges the capacitance 1 + v**2 in parallel to a coil
c with a resistor:
c
c   (1 + v**2) v' + j - i = 0,  j' + j - v = 0,  v = sin t
c
c x = (v, i, j), mu = 1, d = 1, a = 2. F_x' varies: J_k1 - k F_x^(k-1)
c is F_x'^(k) but for rounding errors.
      subroutine charge(method)
      implicit none
      external circui, circar
      integer method, i, k, lrw
      parameter (lrw = 106 + 3 + 42*3)
      integer cval(5,2), ipar(3,2), iwork(20,2), info(20,2), iwarn(2),
     $        ierr(2)
      double precision t(2), x(5,2), xp(5,2), rpar(1), rwork(lrw,2),
     $                 tol, exact(3), tk
      call arrini(t, x, info, iwarn, ipar, 3)
      rpar(1) = 1d300
      tol = 1d-8
      do 20 k = 0, 5
        tk = 0.4d0*k
        call sfndae(circui, 3, 3, t(1), tk, x(1,1), xp(1,1),
     $              cval(1,1), ipar(1,1), rpar, iwork(1,1), 20,
     $              rwork(1,1), lrw, tol, tol, method, info(1,1),
     $              iwarn(1), ierr(1))
        call sfndaf(circar, 3, 3, t(2), tk, x(1,2), xp(1,2),
     $              cval(1,2), ipar(1,2), rpar, iwork(1,2), 20,
     $              rwork(1,2), lrw, tol, tol, method, info(1,2),
     $              iwarn(2), ierr(2))
        call check(ierr(2) .eq. 3 .or. k .eq. 0 .and. ierr(2) .eq. 4,
     $             'IERR of the circuit', ierr(2))
        call check(ierr(1) .eq. ierr(2), 'the same IERR', ierr(1))
        exact(1) = sin(tk)
        exact(3) = (sin(tk) - cos(tk) + exp(-tk)) / 2
        exact(2) = (1 + exact(1)**2) * cos(tk) + exact(3)
        do 10 i = 1, 3
c         Values and slopes are of size 1; the arrays differ by
c         rounding errors.
          call check(abs(x(i,1) - x(i,2)) .le. 1d-13, 'digits of X', i)
          call check(abs(xp(i,1) - xp(i,2)) .le. 1d-11,
     $               'digits of XPRIME', i)
          call check(abs(x(i,2) - exact(i)) .le. 20 * tol,
     $               'solution', i)
   10   continue
   20 continue
      call check(cval(1,2) .eq. 1 .and. cval(2,2) .eq. 1 .and.
     $           cval(3,2) .eq. 2, 'CVAL of the circuit', cval(1,2))
      end

c The pendulum starts from the horizontal, the circuit from i = v' = 1.
      subroutine arrini(t, x, info, iwarn, ipar, n)
      implicit none
      integer info(20,2), iwarn(2), ipar(3,2), n, i, k
      double precision t(2), x(5,2)
      do 30 k = 1, 2
        t(k) = 0
        iwarn(k) = 0
        do 10 i = 1, 20
          info(i,k) = 0
   10   continue
        do 20 i = 1, 5
          x(i,k) = 0
          if (i .le. 3) ipar(i,k) = 0
   20   continue
        if (n .eq. 5) x(1,k) = 1
        if (n .eq. 3) x(2,k) = 1
   30 continue
      end

c The array of order mu + 1 need not be available; that of order mu
c must be.
      subroutine missing(method)
      implicit none
      integer method, ipar(3), iwork(20), ierr, cval(5), info(20), k
      double precision t, x(5), xp(5)
      do 10 k = 2, 1, -1
        ipar(2) = -20 - k
        call once(method, ipar, t, x, xp, cval, iwork, info, ierr)
        if (k .eq. 2) call check(ierr .eq. 3, 'up to mu', ierr)
        if (k .eq. 1) call check(ierr .eq. -21, 'below mu', ierr)
   10 continue
      end

c Entries that do not follow from F_x and F_x', one that is infinite, and
c a subroutine that fails. T, X, XPRIME and CVAL stay as they were.
      subroutine wrong(method)
      implicit none
      integer method, ipar(3), iwork(20), ierr, cval(5), info(20), k, i,
     $        row(3), column(3)
      double precision t, x(5), xp(5)
      data row /11, 4, 11/, column /14, 11, 11/
      do 20 k = 1, 3
        ipar(2) = k
        call once(method, ipar, t, x, xp, cval, iwork, info, ierr)
        call check(ierr .eq. -28, 'IERR = -28', ierr)
        call check(info(1) .eq. -1, 'INFO(1)', info(1))
        call check(iwork(1) .eq. row(k), 'row', iwork(1))
        call check(iwork(2) .eq. column(k), 'column', iwork(2))
        call check(t .eq. 0, 'T untouched', k)
        do 10 i = 1, 5
          call check(x(i) .eq. 1d0/i, 'X untouched', i)
          call check(xp(i) .eq. 17, 'XPRIME untouched', i)
   10   continue
   20 continue
      ipar(2) = 4
      call once(method, ipar, t, x, xp, cval, iwork, info, ierr)
      call check(ierr .eq. -10, 'not finite', ierr)
      ipar(2) = -1
      call once(method, ipar, t, x, xp, cval, iwork, info, ierr)
      call check(ierr .eq. -10, 'fails', ierr)
      end

c One call for the pendulum.
      subroutine once(method, ipar, t, x, xp, cval, iwork, info, ierr)
      implicit none
      external pendar
      integer method, i, lrw
      parameter (lrw = 106 + 5 + 42*5)
      integer cval(5), ipar(3), iwork(20), info(20), iwarn, ierr
      double precision t, x(5), xp(5), rpar(1), rwork(lrw), tol
      t = 0
      tol = 1d-6
      iwarn = 0
      rpar(1) = -1
      do 10 i = 1, 5
        x(i) = 1d0/i
        xp(i) = 17
        cval(i) = -77
   10 continue
      do 20 i = 1, 20
        info(i) = 0
        iwork(i) = 0
   20 continue
      call sfndaf(pendar, 5, 5, t, 0.5d0, x, xp, cval, ipar, rpar,
     $            iwork, 20, rwork, lrw, tol, tol, method, info, iwarn,
     $            ierr)
      end

c The array of the pendulum, formed from the partial derivatives of its
c terms. IPAR(2) = 1, 2, 3: an entry is wrong; 4: one is infinite;
c -1: it fails; -20 - k: arrays above order k are not available.
      subroutine pendar(t, mu, n, m, x, ldx, f, fj, ldfj, ipar, rpar,
     $                ierr)
      implicit none
      integer mu, n, m, ldx, ldfj, ipar(*), ierr, k, l
      double precision t, x(ldx,0:mu+1), f(m,0:mu),
     $                 fj(m,0:mu,n,0:mu+1), rpar(*), c
      ipar(1) = ipar(1) + 1
      ipar(3) = max(ipar(3), mu)
      if (ipar(2) .eq. -1) ierr = -1
      if (ipar(2) .lt. -20 .and. mu .gt. -20 - ipar(2)) ierr = -2
      if (ldfj .ne. (mu+1)*m .or. ldx .ne. n) ierr = -1
      if (ierr .ne. 0) return
      f(4,0) = 9.81d0
      f(5,0) = -1
      do 20 k = 0, mu
        do 10 l = 1, 4
          fj(l,k,l,k+1) = 1
          f(l,k) = f(l,k) + x(l,k+1)
   10   continue
        f(1,k) = x(1,k+1) - x(3,k)
        fj(1,k,3,k) = -1
        f(2,k) = x(2,k+1) - x(4,k)
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
      if (mu .lt. 2) return
      if (ipar(2) .eq. 1) fj(1,2,4,2) = 1d-3
      if (ipar(2) .eq. 2) fj(4,0,1,2) = fj(4,0,1,2) - 1d-3
      if (ipar(2) .eq. 3) fj(1,2,1,2) = 0.25d0
      if (ipar(2) .eq. 4) fj(2,2,1,2) = 1d300 * 1d300
      end

c The circuit order by order, w = 1 + v**2.
      subroutine circui(t, k, n, m, x, ldx, f, fx, ldfx, fxp, ldfxp,
     $                  ipar, rpar, ierr)
      implicit none
      integer k, n, m, ldx, ldfx, ldfxp, ipar(*), ierr, j
      double precision t, x(ldx,0:*), f(*), fx(ldfx,*), fxp(ldfxp,*),
     $                 rpar(*), c, w, half
      parameter (half = 1.5707963267948966d0)
      f(1) = x(3,k) - x(2,k)
      f(2) = x(3,k+1) + x(3,k) - x(1,k)
      f(3) = x(1,k) - sin(t + k*half)
      c = 1
      do 10 j = 0, k
        f(1) = f(1) + c * w(x, ldx, j) * x(1,k-j+1)
        fx(1,1) = fx(1,1) + 2 * c * x(1,j) * x(1,k-j+1)
        c = c * (k - j) / (j + 1)
   10 continue
      fxp(1,1) = w(x, ldx, k)
      if (k .gt. 0) return
      fx(1,2) = -1
      fx(1,3) = 1
      fx(2,1) = -1
      fx(2,3) = 1
      fx(3,1) = 1
      fxp(2,3) = 1
      end

c The derivative of order k of 1 + x1**2.
      double precision function w(x, ldx, k)
      implicit none
      integer ldx, k, j
      double precision x(ldx,0:*), c
      w = 0
      if (k .eq. 0) w = 1
      c = 1
      do 10 j = 0, k
        w = w + c * x(1,j) * x(1,k-j)
        c = c * (k - j) / (j + 1)
   10 continue
      end

c Its array: the partial derivatives of the terms of f(1,k),
c   f(1,k) = x1^(k+1) + sum c x1^(j) x1^(i-j) x1^(k-i+1) + ...
      subroutine circar(t, mu, n, m, x, ldx, f, fj, ldfj, ipar, rpar,
     $                  ierr)
      implicit none
      integer mu, n, m, ldx, ldfj, ipar(*), ierr, k, i, j
      double precision t, x(ldx,0:mu+1), f(m,0:mu),
     $                 fj(m,0:mu,n,0:mu+1), rpar(*), b, c, half
      parameter (half = 1.5707963267948966d0)
      do 30 k = 0, mu
        f(1,k) = x(1,k+1) + x(3,k) - x(2,k)
        fj(1,k,1,k+1) = 1
        fj(1,k,2,k) = -1
        fj(1,k,3,k) = 1
        f(2,k) = x(3,k+1) + x(3,k) - x(1,k)
        fj(2,k,3,k+1) = 1
        fj(2,k,3,k) = 1
        fj(2,k,1,k) = -1
        f(3,k) = x(1,k) - sin(t + k*half)
        fj(3,k,1,k) = 1
        b = 1
        do 20 i = 0, k
          c = b
          do 10 j = 0, i
            f(1,k) = f(1,k) + c * x(1,j) * x(1,i-j) * x(1,k-i+1)
            fj(1,k,1,j) = fj(1,k,1,j) + c * x(1,i-j) * x(1,k-i+1)
            fj(1,k,1,i-j) = fj(1,k,1,i-j) + c * x(1,j) * x(1,k-i+1)
            fj(1,k,1,k-i+1) = fj(1,k,1,k-i+1) + c * x(1,j) * x(1,i-j)
            c = c * (i - j) / (j + 1)
   10     continue
          b = b * (k - i) / (i + 1)
   20   continue
   30 continue
      end
