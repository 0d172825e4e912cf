C     SPDX-License-Identifier: BSD-3-Clause
C     The weighted norm: sqrt( mean( (v(i) rwt(i))**2 ) ).
      PROGRAM NORM
      DOUBLE PRECISION DGENRM, V(3), RWT(3), R, EPS
      LOGICAL GOOD
      EXTERNAL DGENRM
      EPS = 2.3D-16
      GOOD = .TRUE.
      V(1) = 1.0D0
      V(2) = -2.0D0
      V(3) = 2.0D0
      RWT(1) = 2.0D0
      RWT(2) = 1.0D0
      RWT(3) = 0.5D0
      R = DGENRM (3, V, RWT)
      IF (ABS(R-SQRT(3.0D0)) .GT. 8.0D0*EPS) GOOD = .FALSE.
      V(1) = 1.0D300
      V(2) = 1.0D300
      V(3) = 1.0D300
      RWT(1) = 1.0D0
      RWT(3) = 1.0D0
      R = DGENRM (3, V, RWT)
      IF (ABS(R/1.0D300-1.0D0) .GT. 8.0D0*EPS) GOOD = .FALSE.
      V(1) = 0.0D0
      V(2) = 0.0D0
      V(3) = 0.0D0
      IF (DGENRM (3, V, RWT) .NE. 0.0D0) GOOD = .FALSE.
      IF (GOOD) THEN
        WRITE (*,*) 'PASSED'
      ELSE
        WRITE (*,*) 'FAILED'
      END IF
      END
