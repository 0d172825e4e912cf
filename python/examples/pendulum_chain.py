# SPDX-License-Identifier: BSD-3-Clause
"""A chain of pendulums in Cartesian coordinates, as it is written down: strangeness index 2.

    p_k' = v_k,  v_k' = (0, -g) - lambda_k (p_k - p_{k-1}) + lambda_{k+1} (p_{k+1} - p_k),
    0 = |p_k - p_{k-1}|^2 - 1,   k = 1 ... N,  p_0 = 0

Solvers of index-1 problems, such as IDA, fail on these equations; here nothing has to be
differentiated by hand. Check: the energy is constant, the links keep their lengths, and velocities
are tangential to rounding."""

from typing import Any

import numpy as np

import sfdae
from sfdae import Expression, ExpressionArray

N, g = 4, 9.81


def chain(t: Expression, x: ExpressionArray, xdot: ExpressionArray) -> list[Any]:
    p, v, force = x[: 2 * N].reshape(N, 2), x[2 * N : 4 * N].reshape(N, 2), x[4 * N :]
    link = p - np.vstack([[0, 0], p[:-1]])
    pull = -force[:, None] * link
    pull[:-1] += force[1:, None] * link[1:]
    velocity, acceleration = xdot[: 2 * N].reshape(N, 2), xdot[2 * N : 4 * N].reshape(N, 2)
    return [velocity - v, acceleration - pull - [0, -g], (link * link).sum(axis=1) - 1]


names = [f"{q}{k}" for q in ("p", "v") for k in range(2 * N)] + [f"force{k}" for k in range(N)]
straight = np.column_stack([np.arange(1, N + 1), np.zeros(N)]).ravel()  # horizontal, at rest
problem = sfdae.NonlinearProblem(chain, names=names)
sol = sfdae.solve(
    problem, (0, 5), np.r_[straight, np.zeros(3 * N)], method="radau", rtol=1e-8, atol=1e-8
)

p, v = sol.x[: 2 * N].reshape(N, 2, -1), sol.x[2 * N : 4 * N].reshape(N, 2, -1)
link = np.diff(p, axis=0, prepend=0)
speed = np.diff(v, axis=0, prepend=0)
energy = (v**2).sum(axis=(0, 1)) / 2 + g * p[:, 1].sum(axis=0)
print(f"{sol.message}; {sol.steps.t.size} steps, {sol.report!r}")
print(f"energy {np.abs(energy).max():.1e}, lengths {np.abs((link**2).sum(axis=1) - 1).max():.1e}")
index = sol.report.characteristics
assert sol.success and index is not None and index.strangeness_index == 2
assert np.abs(energy).max() < 1e-4
assert np.abs((link**2).sum(axis=1) - 1).max() < 1e-12
assert np.abs((link * speed).sum(axis=1)).max() < 1e-10
sol.plot(*names[:2], *names[2 * N - 2 : 2 * N])
