# SPDX-License-Identifier: BSD-3-Clause
"""How does the period of a pendulum depend on how far it swings? One run for each amplitude, in
threads.

    m p'' = -2 p lambda - (0, m g),  0 = |p|^2 - L^2

The library works without Python's lock: runs in threads are parallel. Check: the period is that of
the complete elliptic integral, 4 sqrt(L / g) K(sin(amplitude / 2)), by the arithmetic-geometric
mean."""

import concurrent.futures

import numpy as np

import sfdae

g, L = 9.81, 0.7

problem = sfdae.MultibodyProblem(
    2,
    forces=lambda t, q, v, g=g: [0, -g],
    constraints=lambda t, q, L=L: [q @ q - L**2],
    names=["x", "y", "u", "v", "force"],
)


def period(amplitude: float) -> float:
    start = {"x": L * np.sin(amplitude), "y": -L * np.cos(amplitude)}
    turn = sfdae.Event(lambda t, x: x[0] * x[3] - x[1] * x[2], direction=-1, terminal=True)
    sol = sfdae.solve(
        problem, (0, 20), start, events=turn, parameters={"L": L}, rtol=1e-9, atol=1e-9, t_eval=[]
    )
    return sol.last.t


def exact_period(amplitude: float) -> float:
    a, b = 1.0, np.cos(amplitude / 2)
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2, np.sqrt(a * b)
    return float(2 * np.pi * np.sqrt(L / g) / a)


amplitudes = np.radians([10, 30, 60, 90, 120, 150, 170])
with concurrent.futures.ThreadPoolExecutor() as pool:
    periods = list(pool.map(period, amplitudes))
exact = [exact_period(amplitude) for amplitude in amplitudes]
for amplitude, T, expected in zip(np.degrees(amplitudes), periods, exact):
    print(f"amplitude {amplitude:4.0f} degrees: period {T:.6f} s, exact {expected:.6f} s")
assert np.abs(np.array(periods) - exact).max() < 1e-5
