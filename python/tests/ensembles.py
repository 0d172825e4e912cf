# SPDX-License-Identifier: BSD-3-Clause
"""An ensemble of pendula for tests of executors."""

import numpy as np

import sfdae

COUNT = 60
ANGLES = np.linspace(-1.2, 1.2, COUNT)
STARTS = np.stack([np.sin(ANGLES), -np.cos(ANGLES), *np.zeros((3, COUNT))], axis=1)
GRAVITY = np.linspace(1.6, 9.8, COUNT)


def pendula(**more):
    """Pendula of a function that cannot be pickled by its name."""
    one = 1.0

    def equations(t, x, xdot, g=9.81):
        p, q, u, v, s = x
        balance = [xdot[2] + 2 * p * s, xdot[3] + 2 * q * s + g]
        return [xdot[0] - u, xdot[1] - v, *balance, p**2 + q**2 - one]

    return sfdae.solve_ensemble(
        equations, (0, 1), STARTS, parameters={"g": GRAVITY}, t_eval=[0.5, 1.0], xdot=True, **more
    )


def require_equal(a, b):
    assert np.array_equal(a.x, b.x, equal_nan=True)
    assert np.array_equal(a.xdot, b.xdot, equal_nan=True)
    assert a.status == b.status and a.messages == b.messages and a.names == b.names
