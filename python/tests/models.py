# SPDX-License-Identifier: BSD-3-Clause
"""Problems with exact solutions or invariants, for all tests."""

import numpy as np

import sfdae

PENDULUM_NAMES = ["px", "py", "u", "v", "lambda"]
PENDULUM_START = {"px": 0.6, "py": -0.8}


def pendulum(t, x, xdot, g=9.81):
    """Length and mass 1; strangeness index 2, d = 2, a = 3."""
    px, py, u, v, force = x
    return [
        xdot[0] - u,
        xdot[1] - v,
        xdot[2] + 2 * px * force,
        xdot[3] + 2 * py * force + g,
        px**2 + py**2 - 1,
    ]


def pendulum_problem(**more):
    return sfdae.NonlinearProblem(pendulum, names=PENDULUM_NAMES, **more)


def energy(x, g=9.81):
    """Of the pendulum, n x N; 0 for PENDULUM_START at rest."""
    return (x[2] ** 2 + x[3] ** 2) / 2 + g * (x[1] + 0.8)


def forced_mass(t, x, xdot):
    """Which force moves a unit mass along sin t? mu = 2, d = 0: position sin, velocity cos, force
    -sin.
    """
    return [xdot[0] - x[1], xdot[1] - x[2], x[0] - np.sin(t)]


def oscillator(t, x, xdot, k=1.0):
    """x'' = -k x."""
    return [xdot[0] - x[1], xdot[1] + k * x[0]]


def value_of(formula, t=0.3):
    """A formula in t as the library computes it: x with 0 = x - formula(t)."""
    problem = sfdae.NonlinearProblem(lambda time, x, xdot: [x[0] - formula(time)], 1)
    return sfdae.Solver(problem).make_consistent(t, [0.0]).x[0]


def values_of(formula, t, x, size):
    """An array of `size` formulas in t and x as the library computes it, with its shape."""
    shapes, n = [], len(x)

    def equations(time, z, zdot):
        result = formula(time, z[:n])
        shapes.append(np.shape(result))
        return [zdot[:n], z[n:] - np.ravel(result)]

    problem = sfdae.NonlinearProblem(equations, n + size)
    point = sfdae.Solver(problem).make_consistent(t, [*x, *np.zeros(size)])
    return point.x[n:].reshape(shapes[0])
