C     SPDX-License-Identifier: BSD-3-Clause
C     The helper routines called one after the other, the way of a
C     program that reduces a system at one point by itself:
C
C        [0 0; 1 -t] x' = [-1 t; 0 0] x + (exp(-t), 0)
C
C     x = ((1+t) exp(-t), exp(-t)); mu = 1, d = 0, a = 2, u = 0.
      PROGRAM CHAIN
      INTEGER N, LMAX, NM, LRW
      PARAMETER (N=2, LMAX=2, NM=N*(LMAX+1), LRW=3*NM*NM+6*NM)
      EXTERNAL EDIF, ADIF, FDIF
      INTEGER M, ID, IA, IU, IREQ, IERR, NQ, IPAR(1), I, J, L
      INTEGER R0, A0, S0, D0, U0, MQ, IDQ, IAQ, IUQ, NFAIL
      DOUBLE PRECISION T, AH(NM,NM), EQ(NM,NM), AQ(NM,N), FQ(NM)
      DOUBLE PRECISION ZQ(NM,NM), Z1(N,N), E(N,N), A(N,N), F(N)
      DOUBLE PRECISION WQ(NM,N), EQ2(NM,NM), AQ2(NM,N), FQ2(NM)
      DOUBLE PRECISION RPAR(1), RWORK(LRW), X(N), XP(N), XE(N), D(N)
      DOUBLE PRECISION V(N), TOL, R
      COMMON /FAILS/ NFAIL
      NFAIL = 0
      TOL = 1.0D2*DBLE(NM)*2.3D-16
      T = 0.5D0
      XE(1) = (1.0D0+T)*EXP(-T)
      XE(2) = EXP(-T)
C
      IERR = 0
      CALL DNFIND (EDIF, ADIF, FDIF, N, T, LMAX, M, ID, IA, IU, IREQ,
     $             AH, NM, EQ, NM, AQ, NM, FQ, ZQ, NM, IPAR, RPAR,
     $             RWORK, LRW, IERR)
      CALL EXPECT ('DNFIND IERR', IERR, 0)
      CALL EXPECT ('DNFIND M', M, 1)
      CALL EXPECT ('DNFIND D', ID, 0)
      CALL EXPECT ('DNFIND A', IA, 2)
      CALL EXPECT ('DNFIND U', IU, 0)
      NQ = (M+1)*N
C
C     The array is that of DNFPEN.
      IERR = 0
      DO 10 L = 0, M
        CALL DNFPEN (EDIF, ADIF, FDIF, N, T, L, WQ, NM, EQ2, NM, AQ2,
     $               NM, FQ2, IPAR, RPAR, IERR)
        CALL EXPECT ('DNFPEN IERR', IERR, 0)
   10 CONTINUE
      DO 30 J = 1, NQ
        DO 20 I = 1, NQ
          IF (EQ(I,J) .NE. EQ2(I,J)) CALL EXPECT ('EQ', I, -J)
   20   CONTINUE
        IF (FQ(J) .NE. FQ2(J)) CALL EXPECT ('FQ', J, 0)
   30 CONTINUE
C
C     Rank and null space are those of DNFVAL.
      CALL DNFVAL (N, NQ, EQ, NM, AQ, NM, R0, A0, S0, D0, U0, EQ2, NM,
     $             RWORK, LRW, IERR)
      CALL EXPECT ('DNFVAL IERR', IERR, 0)
      CALL EXPECT ('DNFVAL R', R0, IREQ)
      CALL DNFVAL (N, NQ, EQ, NM, AQ, NM, R0, A0, S0, D0, U0, EQ2, NM,
     $             RWORK, 3*NQ*NQ+6*NQ-1, IERR)
      CALL EXPECT ('DNFVAL short', IERR, -5)
C
C     0 = A2 x + f2 for the solution.
      CALL DNFRED (N, NQ, ID, IA, IU, IREQ, EQ, NM, AQ, NM, FQ, ZQ, NM,
     $             Z1, N, E, N, A, N, F, AH, NM, RWORK, LRW, IERR)
      CALL EXPECT ('DNFRED IERR', IERR, 0)
      DO 40 I = 1, N
        R = A(I,1)*XE(1) + A(I,2)*XE(2) + F(I)
        IF (ABS(R) .GT. TOL) CALL EXPECT ('DNFRED residual', I, 0)
   40 CONTINUE
C
C     Two algebraic equations leave one consistent value.
      X(1) = 5.0D0
      X(2) = -3.0D0
      CALL DNFINI (N, ID, IA, IU, X, E, N, A, N, F, D, V, RWORK, LRW,
     $             0, IERR)
      CALL EXPECT ('DNFINI IERR', IERR, 0)
      DO 50 I = 1, N
        IF (ABS(X(I)-XE(I)) .GT. 1.0D1*TOL)
     $    CALL EXPECT ('DNFINI X', I, 0)
   50 CONTINUE
C
C     All at once.
      X(1) = 0.0D0
      X(2) = 0.0D0
      IERR = 0
      CALL DGEINI (EDIF, ADIF, FDIF, N, T, LMAX, X, XP, M, ID, IA, IU,
     $             IREQ, EQ, NM, AQ, NM, FQ, E, N, A, N, F, Z1, N, ZQ,
     $             NM, D, AH, NM, V, IPAR, RPAR, RWORK, LRW, 0, IERR)
      CALL EXPECT ('DGEINI IERR', IERR, 0)
      DO 60 I = 1, N
        IF (ABS(X(I)-XE(I)) .GT. 1.0D1*TOL)
     $    CALL EXPECT ('DGEINI X', I, 0)
        IF (XP(I) .NE. 0.0D0) CALL EXPECT ('DGEINI XPRIME', I, 0)
   60 CONTINUE
C
C     With values known, and with values that are wrong.
      CALL DNFIX1 (EDIF, ADIF, FDIF, N, T, LMAX, M, ID, IA, IU, IREQ,
     $             MQ, IDQ, IAQ, IUQ, E, N, A, N, F, EQ, NM, AQ, NM,
     $             FQ, Z1, N, ZQ, NM, AH, NM, IPAR, RPAR, RWORK, LRW,
     $             .FALSE., IERR)
      CALL EXPECT ('DNFIX1 IERR', IERR, 0)
      DO 70 I = 1, N
        R = A(I,1)*XE(1) + A(I,2)*XE(2) + F(I)
        IF (ABS(R) .GT. TOL) CALL EXPECT ('DNFIX1 residual', I, 0)
   70 CONTINUE
      CALL DNFIX1 (EDIF, ADIF, FDIF, N, T, LMAX, M, 1, 1, IU, IREQ,
     $             MQ, IDQ, IAQ, IUQ, E, N, A, N, F, EQ, NM, AQ, NM,
     $             FQ, Z1, N, ZQ, NM, AH, NM, IPAR, RPAR, RWORK, LRW,
     $             .FALSE., IERR)
      CALL EXPECT ('DNFIX1 changed', IERR, -26)
      CALL EXPECT ('DNFIX1 IAQ', IAQ, 2)
C
C     The index is above the limit.
      IERR = 0
      CALL DNFIND (EDIF, ADIF, FDIF, N, T, 0, M, ID, IA, IU, IREQ,
     $             AH, NM, EQ, NM, AQ, NM, FQ, ZQ, NM, IPAR, RPAR,
     $             RWORK, LRW, IERR)
      CALL EXPECT ('DNFIND limit IERR', IERR, 0)
      CALL EXPECT ('DNFIND limit M', M, -1)
C
      IF (NFAIL .EQ. 0) WRITE (*,*) 'PASSED'
      END
C
      SUBROUTINE EXPECT (WHAT, IS, WANTED)
      CHARACTER*(*) WHAT
      INTEGER IS, WANTED, NFAIL
      COMMON /FAILS/ NFAIL
      IF (IS .EQ. WANTED) RETURN
      NFAIL = NFAIL + 1
      WRITE (*,*) 'FAILED ', WHAT, ': ', IS, ' instead of ', WANTED
      END
C
      SUBROUTINE EDIF (N, T, IDIF, E, LDE, IPAR, RPAR, IERR)
      INTEGER N, IDIF, LDE, IPAR(*), IERR
      DOUBLE PRECISION T, E(LDE,*), RPAR(*)
      E(1,1) = 0.0D0
      E(1,2) = 0.0D0
      E(2,1) = 0.0D0
      E(2,2) = 0.0D0
      IF (IDIF .EQ. 0) THEN
        E(2,1) = 1.0D0
        E(2,2) = -T
      ELSE IF (IDIF .EQ. 1) THEN
        E(2,2) = -1.0D0
      END IF
      END
C
      SUBROUTINE ADIF (N, T, IDIF, A, LDA, IPAR, RPAR, IERR)
      INTEGER N, IDIF, LDA, IPAR(*), IERR
      DOUBLE PRECISION T, A(LDA,*), RPAR(*)
      A(1,1) = 0.0D0
      A(1,2) = 0.0D0
      A(2,1) = 0.0D0
      A(2,2) = 0.0D0
      IF (IDIF .EQ. 0) THEN
        A(1,1) = -1.0D0
        A(1,2) = T
      ELSE IF (IDIF .EQ. 1) THEN
        A(1,2) = 1.0D0
      END IF
      END
C
      SUBROUTINE FDIF (N, T, IDIF, F, IPAR, RPAR, IERR)
      INTEGER N, IDIF, IPAR(*), IERR
      DOUBLE PRECISION T, F(*), RPAR(*)
      F(1) = EXP(-T)
      IF (MOD(IDIF,2) .EQ. 1) F(1) = -F(1)
      F(2) = 0.0D0
      END
