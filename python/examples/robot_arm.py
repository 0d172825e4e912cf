# SPDX-License-Identifier: BSD-3-Clause
"""Which torques u move the hand of a robot arm with two links, one of its joints elastic, along a
given path?

Strangeness index 4 (differentiation index 5); the path determines everything: d = 0, a = 8. The
exact solution has x1 = 1 - e^t and x3 = e^t - t. De Luca, Isidori (1987); Campbell, Griepentrog
(1995). Check: against the exact solution, and the torque at t = 1."""

import numpy as np

import sfdae

NAMES = ["x1", "x2", "x3", "v1", "v2", "v3", "u1", "u2"]


def arm(t, q, qdot):
    x1, x2, x3, v1, v2, v3, u1, u2 = q
    a = 2 / (2 - np.cos(x3) ** 2)
    b, c = a / 2 * np.cos(x3), a / 2 * np.sin(x3)
    d = c * np.cos(x3)
    first, both, spring = v1**2, (v1 + v3) ** 2, 2 * x3 - x2
    return [
        qdot[:3] - q[3:6],
        qdot[3] - (2 * c * both + d * first + spring * (a + 2 * b) + a * (u1 - u2)),
        qdot[4] + 2 * c * both + d * first - spring * (1 - 3 * a - 2 * b) + a * u1 - (a + 1) * u2,
        qdot[5]
        + 2 * c * (both + first)
        + d * (first + both)
        - spring * (a - 9 * b)
        + (a + b) * (u1 - u2),
        np.cos(x1) + np.cos(x1 + x3) - np.cos(1 - np.exp(t)) - np.cos(1 - t),
        np.sin(x1) + np.sin(x1 + x3) - np.sin(1 - np.exp(t)) - np.sin(1 - t),
    ]


problem = sfdae.NonlinearProblem(arm, names=NAMES)
report = sfdae.analyze(problem, 0.0, [0, -2, 1, -1, -4, 0, 0, 0])
print(f"{report!r}; every rank decision is in report.decisions, report.plot() draws them")
assert (report.characteristics.strangeness_index, report.characteristics.differential) == (4, 0)

start = sfdae.make_consistent(
    problem, 0.0, [0, 1, 1, 0, 0, 0, 0, 0]
)  # roughly: consistent values are found
sol = sfdae.solve(problem, (0, 1), start.x, t_eval=np.linspace(0, 1, 101))
exact = {
    "x1": 1 - np.exp(sol.t),
    "x3": np.exp(sol.t) - sol.t,
    "v1": -np.exp(sol.t),
    "v3": np.exp(sol.t) - 1,
}
error = max(np.abs(sol[name] - values).max() for name, values in exact.items())
print(f"torques at t = 1: {sol['u1'][-1]:.10f}, {sol['u2'][-1]:.10f}; error {error:.1e}")
assert error < 1e-10
assert abs(sol["u1"][-1] - 13.59126060175974609888) < 1e-9
report.plot()
sol.plot("u1", "u2")
