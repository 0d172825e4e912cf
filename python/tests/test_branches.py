# SPDX-License-Identifier: BSD-3-Clause
"""Singular points: named, and passed where a smooth solution goes on."""

import numpy as np
import pytest

import sfdae


def circle(t, x, xdot):
    """x = sin t, y = cos t; at pi/2 another solution begins, x = 1, y = 0."""
    return [xdot[0] - x[1], x[0] ** 2 + x[1] ** 2 - 1]


def fold(t, x, xdot):
    """y = sqrt(1 - t) ends at t = 1."""
    return [xdot[0] + 1, x[1] ** 2 - x[0]]


def solver_of(equations, x0):
    solver = sfdae.Solver(sfdae.NonlinearProblem(equations, 2), rtol=1e-8, atol=1e-8)
    solver.start(0, x0, 3)
    return solver


def test_crossings_are_passed():
    solver = solver_of(circle, [0, 1])
    with pytest.raises(sfdae.Error) as failure:
        solver.singular_point
    assert failure.value.status == sfdae.Status.NOT_STARTED
    solver.pass_singular_points(1)
    end = solver.advance(3)
    assert end.x == pytest.approx([np.sin(3), np.cos(3)], abs=1e-5)
    point = solver.singular_point
    assert point.t == pytest.approx(np.pi / 2, abs=1e-5)
    assert (point.kind, point.passed, point.count) == ("crossing", True, 1)
    assert point.t_before <= point.t_after


def test_folds_end():
    solver = solver_of(fold, [1, 1])
    solver.pass_singular_points(5)
    with pytest.raises(sfdae.Error, match="fold"):
        solver.advance(2)
    point = solver.singular_point
    assert (point.kind, point.part, point.component) == ("fold", "differential", 1)
    assert point.exponent == pytest.approx(0.5, abs=0.1)
    assert not point.passed


def test_negative_counts_are_refused():
    with pytest.raises(sfdae.Error) as failure:
        solver_of(circle, [0, 1]).pass_singular_points(-1)
    assert failure.value.status == sfdae.Status.ILLEGAL_ARGUMENT
