# SPDX-License-Identifier: BSD-3-Clause
"""A two-transistor amplifier as nodal analysis gives it: currents into each node add up to zero.

The signal is 0.1 V sin(200 pi t), the supply 6 V. A transistor with the voltage U between base and
emitter takes 0.01 I(U) from the base and 0.99 I(U) from the collector, I(U) = 1e-6 A (exp(U / 26
mV) - 1). Strangeness index 0, d = 5, a = 3: the matrix of capacitors is singular. Check: reference
values at t = 0.2 of the test set for IVP solvers."""

from typing import Any

import numpy as np

import sfdae
from sfdae import Expression, ExpressionArray

SUPPLY, R0, R = 6.0, 1000.0, 9000.0


def transistor(base: Expression, emitter: Expression) -> Any:
    return 1e-6 * (np.exp((base - emitter) / 0.026) - 1)


def amplifier(t: Expression, U: ExpressionArray, Udot: ExpressionArray) -> list[Any]:
    first, second = transistor(U[1], U[2]), transistor(U[4], U[5])
    current = [
        (0.1 * np.sin(200 * np.pi * t) - U[0]) / R0,
        (SUPPLY - 2 * U[1]) / R - 0.01 * first,
        -U[2] / R + first - 2e-6 * Udot[2],
        (SUPPLY - U[3]) / R - 0.99 * first,
        (SUPPLY - 2 * U[4]) / R - 0.01 * second,
        -U[5] / R + second - 4e-6 * Udot[5],
        (SUPPLY - U[6]) / R - 0.99 * second,
        -U[7] / R,
    ]
    for node, capacity in ((0, 1e-6), (3, 3e-6), (6, 5e-6)):  # from this node to the next
        charging = capacity * (Udot[node + 1] - Udot[node])
        current[node] += charging
        current[node + 1] -= charging
    return current


names = [f"U{k}" for k in range(1, 9)]
problem = sfdae.NonlinearProblem(amplifier, names=names, units=["V"] * 8)
sol = sfdae.solve(problem, (0, 0.2), [0, 3, 3, 6, 3, 3, 6, 0], rtol=1e-7, atol=1e-7)

reference = [
    -0.5562145012262709e-2, 3.006522471903042, 2.849958788608128, 2.926422536206241,
    2.704617865010554, 2.761837778393145, 4.770927631616772, 1.236995868091548,
]  # fmt: skip
error = np.abs(sol.x[:, -1] - reference).max()
print(f"output {sol['U8'][-1]:.6f} V, error {error:.1e} V, {sol.steps.t.size} steps")
assert error < 1e-4
sol.plot("U1", "U5", "U8")
