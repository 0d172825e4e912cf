# SPDX-License-Identifier: BSD-3-Clause
"""Comparisons, jumps, derivatives, tables and functions of Python in formulas; recorded solutions."""

import math
import operator

import numpy as np
import pytest

import sfdae
from models import pendulum_problem, value_of

T = 0.3


@pytest.mark.parametrize("op", [operator.lt, operator.le, operator.gt, operator.ge])
@pytest.mark.parametrize("other", [0.2, T, 0.4])
def test_comparisons_are_one_or_zero(op, other):
    assert value_of(lambda t: 2 * op(t, other)) == 2 * op(T, other)
    assert value_of(lambda t: op(other, t) + 1) == op(other, T) + 1


def test_conditions_are_combined():
    assert value_of(lambda t: (t > 0.2) & (t < 0.4)) == 1
    assert value_of(lambda t: (t > 0.4) | (t < 0.2)) == 0
    assert value_of(lambda t: ~(t > 0.4)) == 1
    assert value_of(lambda t: np.where((t > 0.2) & ~(t > 0.4), t, -t)) == T
    both = np.array([0.2, 0.4])
    assert value_of(lambda t: sfdae.choose(np.logical_and(t > both, t < 1.0), 1.0, 0.0).sum()) == 1
    with pytest.raises(TypeError, match="neither true nor false"):
        value_of(lambda t: 1.0 if t > 0.2 else 0.0)


def test_jumps():
    assert value_of(lambda t: np.floor(10 * t + 0.5)) == 3
    assert value_of(lambda t: np.sign(t - 1)) == -1
    assert value_of(lambda t: sfdae.sign(t) + sfdae.floor(2.5)) == 3
    assert value_of(lambda t: (t - 1) % 0.5) == (T - 1) % 0.5
    assert value_of(lambda t: 1 % t) == 1 % T
    assert value_of(lambda t: np.mod(t, 0.25)) == pytest.approx(np.mod(T, 0.25), rel=1e-14)
    assert value_of(lambda t: t // 0.25 + 1 // t) == T // 0.25 + 1 // T
    assert value_of(lambda t: np.log10(t)) == pytest.approx(math.log10(T), rel=1e-14)


def test_derivatives_replace_the_jacobian_of_constraints():
    def derived(t, x, xdot, g=9.81):
        px, py, u, v, force = x
        reaction = sfdae.derivative(force * (px**2 + py**2 - 1), x[:2])
        balance = xdot[2:4] + reaction + np.array([0, g])
        return [xdot[0] - u, xdot[1] - v, balance, px**2 + py**2 - 1]

    start = [0.6, -0.8, 0, 0, 0]
    expected = sfdae.solve(pendulum_problem(), (0, 1), start, rtol=1e-8, atol=1e-8)
    found = sfdae.solve(derived, (0, 1), start, rtol=1e-8, atol=1e-8)
    assert found.report.characteristics.strangeness_index == 2
    assert found.x[:, -1] == pytest.approx(expected.x[:, -1], abs=1e-6)
    assert value_of(lambda t: sfdae.time_derivative(t**3)) == pytest.approx(3 * T**2, rel=1e-14)
    with pytest.raises(sfdae.Error, match="the variable is a formula"):
        value_of(lambda t: sfdae.derivative(t, t * t))


def test_tables():
    x = np.linspace(-1, 1, 9)
    for degree in (1, 3, 5, 7):
        value = value_of(lambda t: sfdae.table(t, x, x**degree + x, degree))
        assert value == pytest.approx(T**degree + T, abs=0.01 if degree == 1 else 1e-12)
    assert sfdae.table(0.25, x, x**3)._c.value == pytest.approx(0.25**3, abs=1e-14)
    with pytest.raises(ValueError, match="shapes"):
        sfdae.table(0.25, x, x[1:])
    with pytest.raises(sfdae.Error, match="has to be 1, 3, 5 or 7"):
        value_of(lambda t: sfdae.table(t, x, x, degree=2))
    with pytest.raises(sfdae.Error, match="outside of its data"):
        value_of(lambda t: sfdae.table(10 * t, x, x))


def test_functions_of_python():
    def product(order, a):  # a0 a1
        return [a[0] * a[1], a[::-1], [[0, 1], [1, 0]], np.zeros((2, 2, 2))][order]

    def equations(t, x, xdot):
        return [xdot[0] - sfdae.external("product", product, x[0], np.cos(t))]

    sol = sfdae.solve(equations, (0, 2), [1.0], rtol=1e-8, atol=1e-8)
    assert sol.x[0, -1] == pytest.approx(math.exp(math.sin(2)), rel=1e-6)
    assert sfdae.external("product", product, 2.0, 3.0)._c.value == 6

    def failing(order, a):
        raise ZeroDivisionError("no value")

    def missing(order, a):
        return a[0] if order == 0 else None

    with pytest.raises(ZeroDivisionError, match="no value"):
        value_of(lambda t: sfdae.external("failing", failing, t))
    with pytest.raises(sfdae.Error, match="missing has no derivatives of order 1"):
        sfdae.solve(
            lambda t, x, xdot: [x[0] + sfdae.external("missing", missing, x[0])], (0, 1), [0]
        )


def test_recorded_solutions():
    solver = sfdae.Solver(pendulum_problem(), rtol=1e-8, atol=1e-8)
    solution = sfdae.RecordedSolution()
    with pytest.raises(sfdae.Error, match="nothing was recorded"):
        solution(0.0)
    solver.record(solution)
    solver.start(0.0, {"px": 0.6, "py": -0.8}, 1.0)
    point = solver.advance(1.0)
    solver.record(None)
    assert solution.start == 0 and solution.end >= 1
    assert solution(1.0) == pytest.approx(point.x, abs=1e-6)
    times = np.linspace(0, 1, 20)
    assert solution(times).shape == (5, 20)
    assert np.abs((solution(times)[:2] ** 2).sum(axis=0) - 1).max() < 1e-6
    assert solution.derivative(times)[0] == pytest.approx(solution(times)[2], abs=1e-4)
    assert solution.accuracy <= 0.3 and 0 <= solution.worst_t <= 1
    loaded = sfdae.RecordedSolution.load(solution.save())
    assert (loaded(times) == solution(times)).all()
    with pytest.raises(ValueError, match="outside"):
        solution(-1.0)
    solution.cut(0.5)
    assert solution.end == 0.5 and (solution(0.5) == loaded(0.5)).all()
    with pytest.raises(ValueError, match="outside"):
        solution(0.6)
    with pytest.raises(ValueError, match="outside"):
        solution.cut(0.6)
    with pytest.raises(sfdae.Error, match="damaged"):
        sfdae.RecordedSolution.load(solution.save()[:-1])
