# SPDX-License-Identifier: BSD-3-Clause
"""Start values: what is known, what is guessed, what has to fit. A four-bar linkage.

    bodies at (x1, y1) and (x2, y2), three rods of given lengths:
    0 = |p1|^2 - a^2,   0 = |p2 - p1|^2 - b^2,   0 = |p2 - (d, 0)|^2 - c^2

The angle of the crank is known, so x1 and y1 are fixed; p2 is guessed, velocities of the crank are
given, forces are not known at all. Check: every constraint, its derivative and the equations of
motion hold for what is returned."""

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sfdae

a, b, c, d, g = 1.0, 2.5, 2.0, 3.0, 9.81


def rods(p: NDArray[Any]) -> NDArray[Any]:
    return np.array([p[0] ** 2 + p[1] ** 2 - a**2, (p[2] - p[0]) ** 2 + (p[3] - p[1]) ** 2 - b**2,
                     (p[2] - d) ** 2 + p[3] ** 2 - c**2])  # fmt: skip


problem = sfdae.MultibodyProblem(
    4,
    forces=lambda t, q, v: [0, -g, 0, -g],
    constraints=lambda t, q: rods(q),
    names=["x1", "y1", "x2", "y2", "u1", "v1", "u2", "v2", "crank", "coupler", "rocker"],
)
angle, omega = 0.7, 2.0
known = {
    "x1": a * np.cos(angle),
    "y1": a * np.sin(angle),
    "u1": -a * omega * np.sin(angle),
    "v1": a * omega * np.cos(angle),
}
guess = {**known, "x2": 2.5, "y2": 2.0}

# Nothing fixed: the nearest consistent point moves all positions a little, and says so.
nearest = sfdae.make_consistent(problem, 0, guess)
print("nearest:", nearest.status.name, "-", nearest.message)
assert nearest.status == sfdae.Status.VALUES_CHANGED

# The crank is where it is: only the rest adapts.
point = sfdae.make_consistent(problem, 0, guess, fixed=list(known))
q, v, force = point.x[:4], point.x[4:8], point.x[8:]
print("fixed crank: p2 =", q[2:], " velocity", v[2:], " forces", force)
assert all(point.x[problem.index(name)] == value for name, value in known.items())
step = 1e-6
assert np.abs(rods(q)).max() < 1e-13
assert np.abs(rods(q + step * v) - rods(q - step * v)).max() / (2 * step) < 1e-8
G = np.array([(rods(q + step * e) - rods(q - step * e)) / (2 * step) for e in np.eye(4)])
assert np.abs(point.xdot[4:8] - ([0, -g, 0, -g] - G @ force)).max() < 1e-7

# Contradictions are errors that say what is wrong.
try:
    sfdae.make_consistent(problem, 0, {**guess, "x2": 9.0}, fixed=["x1", "y1", "x2"])
except sfdae.Error as error:
    print("contradiction:", error)
    assert error.status < 0
else:
    raise AssertionError("a rod of length 2.5 does not reach so far")

# solve() does the same at its start; what had to change is a warning.
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    sol = sfdae.solve(problem, (0, 1), guess, fixed=list(known), rtol=1e-8, atol=1e-8)
assert sol.success and not caught
energy = (sol.x[4:8] ** 2).sum(axis=0) / 2 + g * (sol["y1"] + sol["y2"])
assert np.ptp(energy) < 1e-5
