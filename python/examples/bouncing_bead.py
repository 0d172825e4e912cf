# SPDX-License-Identifier: BSD-3-Clause
"""A bead slides without friction down a straight wire y = x and bounces off a stop at y = 0.

    x' = u,  y' = v,  u' = -force,  v' = -g + force,  0 = y - x         strangeness index 2

The stop is an event with an action: it keeps the part r of the velocities, and the integration is
started anew. Check: y'' = -g/2; impact k is at T (1 + 2 r + ... + 2 r^(k-1)) with T = 2 / sqrt(g).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

import sfdae
from sfdae import Expression, ExpressionArray

g, r = 9.81, 0.8


def bead(t: Expression, x: ExpressionArray, xdot: ExpressionArray) -> list[Any]:
    px, py, u, v, force = x
    return [xdot[0] - u, xdot[1] - v, xdot[2] + force, xdot[3] + g - force, py - px]


def bounce(t: float, x: NDArray[np.float64]) -> Any:
    return x * [1, 1, -r, -r, 1]


problem = sfdae.NonlinearProblem(
    bead,
    names=["x", "y", "u", "v", "force"],
    units={"x": "m", "y": "m", "u": "m/s", "v": "m/s", "force": "N"},
)
stop = sfdae.Event(lambda t, x: x[1], direction=-1, action=bounce, name="stop")
sol = sfdae.solve(problem, (0, 3), {"x": 1, "y": 1}, events=stop, rtol=1e-8, atol=1e-8)

T = 2 / np.sqrt(g)
impacts = T * (1 + 2 * np.cumsum(r ** np.arange(0, 20)) - 2)
impacts = impacts[(impacts > 0) & (impacts <= 3)]
error = np.abs(sol.t_events[0] - impacts).max()
print(f"{len(sol.events)} impacts, the last at t = {sol.events[-1].t:.6f}; error {error:.1e}")
assert len(sol.events) == len(impacts) and error < 1e-5
assert np.abs(sol["x"] - sol["y"]).max() < 1e-12
sol.plot("y", "v")
