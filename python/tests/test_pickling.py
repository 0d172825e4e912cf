# SPDX-License-Identifier: BSD-3-Clause
"""Pickled problems: recorded equations are repeated, so that the results agree in every bit."""

import copy
import pickle
import sys
import threading

import numpy as np
import pytest

import sfdae
from sfdae._binding import ffi, lib
from sfdae._tape import _SPECIAL
from models import PENDULUM_NAMES, PENDULUM_START, pendulum_problem


def again(problem):
    return pickle.loads(pickle.dumps(problem))


def same(a, b, t1, x0, **more):
    """Both problems give the same solution, in every bit."""
    first, second = (sfdae.solve(problem, (0, t1), x0, **more) for problem in (a, b))
    assert np.array_equal(first.t, second.t) and np.array_equal(first.x, second.x)
    assert np.array_equal(first.xdot, second.xdot)
    return second


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_names_parameters_units_and_equation_names_are_kept(method):
    equations = ["p'", "q'", "u'", "v'", "length"]
    problem = pendulum_problem(equation_names=equations, units={"px": "m"}, parameters={"g": 1.62})
    other = again(problem)
    assert other.names == tuple(PENDULUM_NAMES) and other.equation_names == tuple(equations)
    assert other.parameters == {"g": 1.62} and other.units == {"px": "m"}
    assert other.num_equations == 5 and repr(other) == repr(problem)
    for g in (1.62, 9.81):
        same(problem, other, 2, PENDULUM_START, parameters={"g": g}, method=method)
    with pytest.raises(TypeError, match="no parameter 'k'"):
        sfdae.Solver(other, parameters={"k": 1})


def everything():
    """A closure with tables, conditions, arrays of parameters, derivatives and functions."""
    scipy_special = pytest.importorskip("scipy.special")
    CubicSpline = pytest.importorskip("scipy.interpolate").CubicSpline
    limit = 0.25
    spline = CubicSpline([0, 1, 2, 3], [0, 0.1, 0.3, 0.1], bc_type="clamped")

    def equations(t, x, xdot, k=np.array([1.0, 2.0])):
        p, q, u, v, s = x
        load = np.interp(t, [0, 0.7, 3], [0.0, 1.0, 0.0]) + sfdae.table(t, spline)
        friction = sfdae.parameter(t, "friction", 0.1) * scipy_special.erf(u)
        stop = np.where(p > limit, k[0] * (p - limit), 0.0)
        g = p**2 + q**2 - 1
        force = [s * sfdae.derivative(g, unknown) for unknown in (p, q)]
        balance = [xdot[2] + force[0] + friction - load + stop, xdot[3] + force[1] + 9.81 * k[1]]
        return [xdot[:2] - x[2:4], balance, g * 1.0 + 0.0 * t]

    return sfdae.NonlinearProblem(equations, 5)


def test_tables_conditions_arrays_and_functions_are_kept():
    problem = everything()
    other = again(again(problem))
    start = [0.6, -0.8, 0, 0, 0]
    for k in ([1.0, 2.0], [30.0, 1.0]):
        solution = same(problem, other, 3, start, parameters={"k": k})
        assert len(solution.switches) >= 1
    assert sfdae.Solver(other).get_parameter("friction") == 0.1


def test_all_functions_that_make_expressions_can_be_repeated():
    """Those that have other arguments than expressions are listed in _tape."""
    number = ffi.typeof("sfdae_expression")
    others = set()
    for name in dir(lib):
        kind = ffi.typeof(getattr(lib, name)) if name.startswith("sfdae_") else None
        if kind is not None and kind.kind == "function" and kind.result is number:
            others |= {name} if any(argument is not number for argument in kind.args) else set()
    assert others == set(_SPECIAL) | {"sfdae_number"}


def test_residuals_for_numbers():
    problem = pendulum_problem()
    point = 0.5, [0.1, 0.2, 0.3, 0.4, 0.5], [1, 2, 3, 4, 5]
    for g in (9.81, 1.0):
        assert np.array_equal(again(problem).residual(*point, g=g), problem.residual(*point, g=g))


def test_equations_with_mass_and_their_parameters():
    problem = sfdae.NonlinearProblem(
        lambda t, x, k=2.0: [-k * x[0], x[0] - x[1]], 2, mass=lambda t, m=1.5: [[m, 0], [0, 0]]
    )
    other = again(problem)
    assert other.parameters == {"k": 2.0, "m": 1.5}
    same(problem, other, 1, [1, 1], parameters={"m": 3.0, "k": 1.0})


def test_linear_and_mechanical_problems():
    linear = sfdae.LinearProblem(
        lambda t: [[1, t], [0, 0]], [[-1.0, 0], [0, -1]], lambda t, a=2.0: [0, a * np.sin(t)]
    )
    same(linear, again(linear), 2, [1, 0], parameters={"a": 3.0})
    offset = 0.5
    mechanical = sfdae.MultibodyProblem(
        2,
        mass=lambda t, q, m=1.0: [m, m],
        forces=lambda t, q, v, g=9.81: [0, -g],
        constraints=lambda t, q: [q[1] + q[0] * offset],
        names=["x", "y", "u", "v", "force"],
        constraint_names=["wire"],
    )
    other = again(mechanical)
    assert other.constraint_names == ("wire",) and other.names == mechanical.names
    same(mechanical, other, 2, [0, 0, 0, 0, 0], parameters={"m": 2.0})


def test_copies_call_the_same_functions():
    problem = pendulum_problem()
    for other in (copy.copy(problem), copy.deepcopy(problem)):
        assert other.equations.function is problem.equations.function
        same(problem, other, 1, PENDULUM_START)


def decay(t, x, xdot, k=1.0):
    return [xdot[0] + k * abs(x[0])]


def rates(t, order):
    return [[-1.0]] if order == 0 else [[0.0]]


def test_functions_called_with_numbers_are_pickled():
    same(*(2 * [sfdae.NonlinearProblem(decay, 1, record=False)]), 1, [1.0])
    problem = sfdae.NonlinearProblem(decay, 1, record=False)
    same(problem, again(problem), 1, [1.0], parameters={"k": 2.0})
    problem = sfdae.LinearProblem([[1.0]], rates)
    same(problem, again(problem), 1, [1.0])


def test_functions_that_cannot_be_pickled_are_named(monkeypatch):
    lock = threading.Lock()

    def locked(t, x, xdot):
        with lock:
            return [xdot[0] + x[0]]

    def value(order, arguments):
        with lock:
            return 1.0

    problem = sfdae.NonlinearProblem(locked, 1, record=False)
    with pytest.raises(TypeError, match="because the function equations, which record=False.*lock"):
        pickle.dumps(problem)
    problem = sfdae.NonlinearProblem(
        lambda t, x, xdot: [xdot[0] - sfdae.external("w", value, x[0])], 1
    )
    with pytest.raises(TypeError, match="external function 'w' of equations.*Define it by def"):
        pickle.dumps(problem)
    monkeypatch.setitem(sys.modules, "cloudpickle", None)  # as if it were not installed
    problem = sfdae.NonlinearProblem(
        lambda t, x, xdot: [xdot[0] + x[0]], 2, num_equations=1, prescribed={1: lambda t: t}
    )
    with pytest.raises(TypeError, match=r"prescribed value of x\[1\].*install cloudpickle"):
        pickle.dumps(problem)
    assert again(pendulum_problem()).names == tuple(PENDULUM_NAMES)


def test_mistakes_in_equations_are_raised():
    problem = sfdae.NonlinearProblem(lambda t, x, xdot: [xdot[0] + undefined], 1)
    with pytest.raises(NameError, match="undefined"):
        pickle.dumps(problem)
