C     SPDX-License-Identifier: BSD-3-Clause
C     Every message is printed, and the program goes on.
      PROGRAM ERRMSG
      INTEGER NC
      PARAMETER (NC=38)
      INTEGER CODES(NC), CVAL(4), IPAR(1), IWORK(30), INFO(20), I
      DOUBLE PRECISION X(2), XPRIME(2), RPAR(1), RWORK(50), RTOL, ATOL
      EXTERNAL EDIF
      DATA CODES /-1, -2, -3, -6, -8, -10, -21, -22, -23, -24, -25,
     $  -26, -101, -102, -103, -104, -105, -106, -107, -108, -109,
     $  -110, -111, -112, -113, -114, -115, -116, -119, -120, -121,
     $  -122, -123, -132, -140, -998, -999, -4711/
      DATA CVAL /1, 0, 2, 0/, IWORK /30*0/, INFO /20*0/
      DATA RWORK /50*0.0D0/, X /2*0.0D0/, XPRIME /2*0.0D0/
      RTOL = 1.0D-5
      ATOL = 0.0D0
      DO 10 I = 1, NC
        CALL DGEERM (EDIF, EDIF, EDIF, 2, 0.0D0, 1.0D0, X, XPRIME,
     $    CVAL, IPAR, RPAR, IWORK, 30, RWORK, 50, RTOL, ATOL, 1,
     $    INFO, 0, CODES(I))
   10 CONTINUE
      WRITE (*,*) 'PASSED'
      END
C
      SUBROUTINE EDIF
      END
