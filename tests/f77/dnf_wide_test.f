C     SPDX-License-Identifier: BSD-3-Clause
C     Helper routines with INTEGERs of 64 bits:
C
C        [0 1; 0 0] x' = x - (sin t, cos t),   mu = 1, a = 2
      PROGRAM WIDE
      INTEGER*8 N, LMAX, NM, LRW, ZERO
      PARAMETER (N=2, LMAX=1, NM=4, LRW=72, ZERO=0)
      EXTERNAL EDIF, ADIF, FDIF, NARROW
      INTEGER*8 M, ID, IA, IU, IREQ, IERR, IPAR(1), I
      INTEGER*8 MQ, IDQ, IAQ, IUQ
      LOGICAL*8 MCONST
      DOUBLE PRECISION T, AH(NM,NM), EQ(NM,NM), AQ(NM,N), FQ(NM)
      DOUBLE PRECISION ZQ(NM,NM), Z1(N,N), E(N,N), A(N,N), F(N), R
      DOUBLE PRECISION RPAR(1), RWORK(LRW), X(N), XP(N), D(N), V(N)
      DOUBLE PRECISION XE(N), DGENRM_64
      LOGICAL GOOD
      GOOD = .TRUE.
      T = 0.3D0
C     x2 = cos t, x1 = x2' + sin t = 0
      XE(1) = 0.0D0
      XE(2) = COS(T)
      X(1) = 1.0D0
      X(2) = 1.0D0
      IERR = 0
      CALL DGEINI_64 (EDIF, ADIF, FDIF, N, T, LMAX, X, XP, M, ID, IA,
     $             IU, IREQ, EQ, NM, AQ, NM, FQ, E, N, A, N, F, Z1, N,
     $             ZQ, NM, D, AH, NM, V, IPAR, RPAR, RWORK, LRW, ZERO,
     $             IERR)
      IF (IERR .NE. 0 .OR. M .NE. 1 .OR. IA .NE. 2) GOOD = .FALSE.
      DO 10 I = 1, N
        IF (ABS(X(I)-XE(I)) .GT. 1.0D-13) GOOD = .FALSE.
   10 CONTINUE
C     Constant matrices: f alone at another point.
      T = 0.9D0
      XE(2) = COS(T)
      MCONST = .TRUE.
      CALL DNFIX1_64 (EDIF, ADIF, FDIF, N, T, LMAX, M, ID, IA, IU,
     $             IREQ, MQ, IDQ, IAQ, IUQ, E, N, A, N, F, EQ, NM, AQ,
     $             NM, FQ, Z1, N, ZQ, NM, AH, NM, IPAR, RPAR, RWORK,
     $             LRW, MCONST, IERR)
      IF (IERR .NE. 0) GOOD = .FALSE.
      DO 20 I = 1, N
        R = A(I,1)*XE(1) + A(I,2)*XE(2) + F(I)
        IF (ABS(R) .GT. 1.0D-13) GOOD = .FALSE.
   20 CONTINUE
C     A subroutine with INTEGERs of 32 bits is noticed.
      IERR = 0
      CALL DNFIND_64 (NARROW, ADIF, FDIF, N, T, LMAX, M, ID, IA, IU,
     $             IREQ, AH, NM, EQ, NM, AQ, NM, FQ, ZQ, NM, IPAR,
     $             RPAR, RWORK, LRW, IERR)
      IF (IERR .NE. -140) GOOD = .FALSE.
      V(1) = 3.0D0
      V(2) = 4.0D0
      D(1) = 1.0D0
      D(2) = 1.0D0
      R = DGENRM_64 (N, V, D)
      IF (ABS(R-SQRT(12.5D0)) .GT. 1.0D-14) GOOD = .FALSE.
      IF (GOOD) THEN
        WRITE (*,*) 'PASSED'
      ELSE
        WRITE (*,*) 'FAILED'
      END IF
      END
C
      SUBROUTINE EDIF (N, T, IDIF, E, LDE, IPAR, RPAR, IERR)
      INTEGER*8 N, IDIF, LDE, IPAR(*), IERR
      DOUBLE PRECISION T, E(LDE,*), RPAR(*)
      E(1,1) = 0.0D0
      E(2,1) = 0.0D0
      E(2,2) = 0.0D0
      E(1,2) = 0.0D0
      IF (IDIF .EQ. 0) E(1,2) = 1.0D0
      END
C
      SUBROUTINE ADIF (N, T, IDIF, A, LDA, IPAR, RPAR, IERR)
      INTEGER*8 N, IDIF, LDA, IPAR(*), IERR
      DOUBLE PRECISION T, A(LDA,*), RPAR(*)
      A(2,1) = 0.0D0
      A(1,2) = 0.0D0
      A(1,1) = 0.0D0
      IF (IDIF .EQ. 0) A(1,1) = 1.0D0
      A(2,2) = A(1,1)
      END
C
C     Derivatives of -(sin t, cos t).
      SUBROUTINE FDIF (N, T, IDIF, F, IPAR, RPAR, IERR)
      INTEGER*8 N, IDIF, IPAR(*), IERR
      DOUBLE PRECISION T, F(*), RPAR(*)
      IF (IDIF .EQ. 0) THEN
        F(1) = -SIN(T)
        F(2) = -COS(T)
      ELSE IF (IDIF .EQ. 1) THEN
        F(1) = -COS(T)
        F(2) = SIN(T)
      ELSE
        IERR = -2
      END IF
      END
C
      SUBROUTINE NARROW (N, T, IDIF, E, LDE, IPAR, RPAR, IERR)
      INTEGER*4 N, IDIF, LDE, IPAR(*), IERR
      DOUBLE PRECISION T, E(LDE,*), RPAR(*)
      IERR = -1
      END
