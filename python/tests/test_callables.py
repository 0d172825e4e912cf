# SPDX-License-Identifier: BSD-3-Clause
"""How equations may be written: returned, written to an array, as M x' = f(t, x), and without a
recording.
"""

import math
import traceback

import numpy as np
import pytest

import sfdae
from models import oscillator, pendulum

EXACT = {"rtol": 1e-9, "atol": 1e-9}


def end_of(*arguments, **more):
    return sfdae.solve(*arguments, **{**EXACT, **more}).x[:, -1]


# ---- Residuals in an array -----------------------------------------------------------------------


def in_place(t, x, xdot, res, k=1.0):
    res[0] = xdot[0] - x[1]
    res[1] = xdot[1] + k * x[0]


def in_place_with_a_flag(t, y, yp, result):
    result[:] = [yp[0] - y[1], yp[1] + y[0]]
    return 0


def in_place_and_returned(t, x, xdot, out):
    out[0], out[1:] = xdot[0] - x[1], xdot[1:] + x[:1]
    return out


def step_by_step(t, x, xdot):
    r = np.zeros(2, like=x)
    r[0] = xdot[0] - x[1]
    r[1] += xdot[1]
    r[1] += x[0]
    return r


def by_a_matrix(t, x, xdot):
    A = np.zeros((2, 2), like=x)
    A[0, 1], A[1, 0] = 1.0 + 0 * t, -1.0
    return xdot - A @ x


WRITTEN = [in_place, in_place_with_a_flag, in_place_and_returned, step_by_step, by_a_matrix]


@pytest.mark.parametrize("record", [True, False])
@pytest.mark.parametrize("equations", WRITTEN)
def test_residuals_may_be_written_to_an_array(equations, record):
    assert end_of(equations, (0, 1), [1, 0], record=record) == pytest.approx(
        [np.cos(1), -np.sin(1)], abs=1e-7
    )
    residual = sfdae.NonlinearProblem(equations, 2).residual(0.0, [1.0, 2.0], [3.0, 4.0])
    assert residual.tolist() == [1.0, 5.0]


def test_arrays_of_residuals_beside_parameters():
    found = end_of(in_place, (0, 1), [1, 0], parameters={"k": 4.0})
    assert found == pytest.approx([np.cos(2), -2 * np.sin(2)], abs=1e-7)

    def with_names(t, x, xdot, res):
        place, speed = x
        in_place(t, x, xdot, res)

    sol = sfdae.solve(with_names, (0, 1), {"speed": 0, "place": 1}, **EXACT)
    assert sol["speed"][-1] == pytest.approx(-np.sin(1), abs=1e-7)

    def more_equations(t, x, xdot, res):
        in_place(t, x, xdot, res)
        res[2] = x[2] - x[0]

    problem = sfdae.NonlinearProblem(more_equations, 3)
    assert end_of(problem, (0, 1), [1, 0, 0])[2] == pytest.approx(np.cos(1), abs=1e-7)


def test_residuals_that_are_missing_are_named():
    def forgotten(t, x, xdot, res):
        res[0] = xdot[0] - x[1]

    with pytest.raises(TypeError, match="did not write entry 1 of res"):
        sfdae.solve(forgotten, (0, 1), [1, 0])
    with pytest.raises(sfdae.Error, match="NOT_FINITE"):
        sfdae.solve(forgotten, (0, 1), [1, 0], record=False)
    with pytest.raises(IndexError):
        sfdae.solve(in_place, (0, 1), [1])

    def failing(t, x, xdot, res):
        return -1

    with pytest.raises(RuntimeError, match="equations returned -1"):
        sfdae.solve(failing, (0, 1), [1])
    with pytest.raises(TypeError, match="'k' has no value.* is called res"):
        sfdae.solve(lambda t, x, xdot, k: [xdot[0] + k * x[0]], (0, 1), [1])


# ---- Mass matrices -------------------------------------------------------------------------------


def rates(t, y, k1=0.04):
    """Robertson's reaction: the sum of all is 1."""
    a, b, c = y
    return [-k1 * a + 1e4 * b * c, k1 * a - 1e4 * b * c - 3e7 * b**2, a + b + c - 1]


def robertson(t, x, xdot):
    f = rates(t, x)
    return [xdot[0] - f[0], xdot[1] - f[1], f[2]]


def masses():
    sparse = pytest.importorskip("scipy.sparse")
    M = np.diag([1.0, 1.0, 0.0])
    return [
        M,
        M.tolist(),
        [1, 1, 0],
        sparse.csr_matrix(M),
        sparse.coo_matrix(M),
        lambda t: M,
        lambda t, y: M,
        lambda t: sparse.csc_matrix(M),
    ]


@pytest.mark.parametrize("record", [True, False])
@pytest.mark.parametrize("which", range(8))
def test_mass_matrices(which, record):
    start, span = {"a": 1}, (0, 1)
    expected = end_of(robertson, span, [1, 0, 0])
    found = end_of(rates, span, start, mass=masses()[which], record=record)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_mass_matrices_of_states_and_numbers():
    """(1 + y^2) y' = -y - y^3 is y' = -y."""

    def f(t, y):
        return -y - y**3

    for mass in (lambda t, y: [[1 + y[0] ** 2]], lambda t, y: 1 + y**2):
        assert end_of(f, (0, 1), [1.0], mass=mass) == pytest.approx([np.exp(-1)], abs=1e-7)
    assert end_of(lambda t, y: -3 * y, (0, 1), [1.0], mass=3) == pytest.approx(
        [np.exp(-1)], abs=1e-7
    )
    report = sfdae.analyze(rates, 0.0, [1.0, 0, 0], mass=[1, 1, 0])
    assert report.characteristics.differential == 2
    point = sfdae.make_consistent(rates, 0.0, [0.9, 0, 0], mass=[1, 1, 0])
    assert point.x.sum() == pytest.approx(1, abs=1e-12)
    problem = sfdae.NonlinearProblem(rates, 3, mass=[1, 1, 0])
    assert problem.residual(0, [1, 0, 0], [2, 3, 4]).tolist() == [2.04, 2.96, 0]


def test_functions_of_two_arguments_without_a_mass_matrix():
    with pytest.raises(TypeError, match=r"f\(t, x\) add mass=1, for M x' = f\(t, x\) add mass=M"):
        sfdae.solve(rates, (0, 1), [1, 0, 0])
    with pytest.raises(TypeError, match="parameter 'xdot' has no value"):
        sfdae.solve(oscillator, (0, 1), [1, 0], mass=1)
    with pytest.raises(ValueError, match=r"mass has shape \(2, 2\), not \(m, 3\)"):
        sfdae.solve(rates, (0, 1), [1, 0, 0], mass=np.eye(2))
    with pytest.raises(TypeError, match="mass and record belong to the problem"):
        sfdae.solve(sfdae.NonlinearProblem(oscillator, 2), (0, 1), [1, 0], record=False)


# ---- Without a recording -------------------------------------------------------------------------


def test_code_with_branches_runs_without_a_recording():
    """A ball in a fluid: the drag is linear or quadratic, and comes from a loop and a table."""
    knots, drag = np.array([0.0, 1.0, 20.0]), np.array([0.0, 1.0, 20.0])

    def branching(t, x, xdot, g=9.81):
        height, speed = x
        force = 0.0
        for _ in range(int(abs(speed) // 100) + 1):
            force += float(np.searchsorted(knots, abs(speed)) > -1) * np.interp(
                abs(float(speed)), knots, drag
            )
        if speed < 0:
            force = -force
        return [xdot[0] - speed, xdot[1] + g + force]

    with pytest.raises(TypeError, match="record=False"):
        sfdae.solve(branching, (0, 1), [10, 0])
    found = end_of(branching, (0, 1), [10, 0], record=False, rtol=1e-7, atol=1e-7)
    speed = -9.81 * (1 - np.exp(-1))  # v' = -g - v
    assert found[1] == pytest.approx(speed, abs=1e-5)
    found = end_of(branching, (0, 1), [10, 0], record=False, parameters={"g": 1.0})
    assert found[1] == pytest.approx(-(1 - np.exp(-1)), abs=1e-6)


def index_1(t, x, xdot):
    """The pendulum with the acceleration of the constraint in place of the constraint."""
    p, q, u, v, s = x
    return [
        xdot[0] - u,
        xdot[1] - v,
        xdot[2] + 2 * p * s,
        xdot[3] + 2 * q * s + 9.81,
        u**2 + v**2 - 2 * s * (p**2 + q**2) - 9.81 * q,
    ]


def test_index_1_without_a_recording_and_names_of_unknowns():
    start = {"q": -0.8, "p": 0.6}
    sol = sfdae.solve(index_1, (0, 1), start, record=False, rtol=1e-7, atol=1e-7)
    assert sol.x[:, -1] == pytest.approx(end_of(index_1, (0, 1), start), abs=1e-5)
    assert sol.names == tuple("pquvs") and sol.report.characteristics.strangeness_index == 0
    with pytest.raises(KeyError, match="no unknown 'angle'"):
        sfdae.solve(index_1, (0, 1), {"angle": 1}, record=False)

    def turned(t, x, xdot):
        x = x[::-1]
        s, v, u, q, p = x
        return index_1(t, [p, q, u, v, s], xdot[::-1])

    with pytest.raises(TypeError, match="not confirmed"):
        sfdae.solve(turned, (0, 1), start, record=False)


def test_what_has_to_be_differentiated_has_to_be_recorded():
    with pytest.raises(sfdae.Error, match="index has to be at most 1. Record the equations"):
        sfdae.solve(pendulum, (0, 1), [0.6, -0.8, 0, 0, 0], record=False)


def test_exceptions_without_a_recording_keep_their_traceback():
    def deep():
        raise LookupError("no such entry")

    def equations(t, x, xdot):
        if t > 0.5:
            deep()
        return xdot + x

    with pytest.raises(LookupError, match="no such entry") as caught:
        sfdae.solve(equations, (0, 1), [1.0], record=False)
    assert traceback.extract_tb(caught.value.__traceback__)[-1].name == "deep"
    with pytest.raises(TypeError, match="complex values"):
        sfdae.solve(lambda t, x, xdot: xdot + 1j, (0, 1), [1.0], record=False)
    with pytest.raises(ValueError, match="1 residuals, not 2"):
        sfdae.solve(lambda t, x, xdot: xdot[:1], (0, 1), [1.0, 0.0], record=False)

    def rejecting(t, x, xdot):
        if x[0] < 0:
            raise sfdae.CannotEvaluate
        return xdot - np.sqrt(x)

    assert end_of(rejecting, (0, 1), [1.0], record=False)[0] == pytest.approx(2.25, abs=1e-5)


def test_branches_may_switch_at_the_start_or_later():
    def slope(t, x, xdot, level):
        return [xdot[0] + (1.0 if x[0] >= level else 2.0)]

    for level in (0.5, 1.0):
        found = end_of(slope, (0, 1), [1.0], parameters={"level": level}, record=False)
        assert found[0] == pytest.approx(1 - (1 - level) - 2 * level, abs=1e-5)


def test_parameters_without_a_recording():
    solver = sfdae.Solver(sfdae.NonlinearProblem(in_place, 2, record=False), **EXACT)
    solver.start(0, [1, 0], 1)
    solver.set_parameters(k=4.0)
    assert solver.get_parameter("k") == 4.0
    solver.start(0, [1, 0], 1)
    assert solver.advance(1).x[0] == pytest.approx(np.cos(2), abs=1e-7)
    with pytest.raises(sfdae.Error, match='no parameter "j"'):
        solver.get_parameter("j")
    problem = sfdae.NonlinearProblem(in_place, 2, record=False)
    with pytest.raises(sfdae.Error, match="sensitivities need recorded equations"):
        sfdae.solve(problem, (0, 1), [1, 0], sensitivities=["k"])


def test_steps_of_differences_stay_where_the_function_has_values():
    """x = 1e-9 is closer to 0 than the usual step."""

    def equations(t, x, xdot):
        return [xdot[0] + x[0], x[1] - np.log(x[0])]

    with np.errstate(invalid="ignore"):
        found = end_of(equations, (0, 1), [1e-9, np.log(1e-9)], record=False, atol=1e-15)
    assert found[1] == pytest.approx(np.log(1e-9) - 1, abs=1e-4)


# ---- Arguments -----------------------------------------------------------------------------------


def decay(t, x, xdot, k):
    return [xdot[0] + k * x[0]]


def test_parameters_without_defaults_have_the_values_given():
    expected = pytest.approx([np.exp(-2)], abs=1e-7)
    assert end_of(decay, (0, 1), [1.0], parameters={"k": 2}) == expected
    assert end_of(decay, (0, 1), [1.0], parameters={"k": 2}, record=False) == expected


def test_numbers_that_overflow_cannot_be_evaluated():
    def junction(t, x, xdot):  # nanocoulombs, guessed as 0
        charge, current = x
        return [xdot[0] - current,
                charge / 1e-9 + 1e6 * current + math.exp(charge / 1e-9) - 1 - math.sin(t)]

    found = end_of(junction, (0, 1), [0, 0], record=False, rtol=1e-6, atol=1e-15)
    assert found[0] == pytest.approx(3.79580321e-10, abs=1e-15)

    def logarithm(t, x, xdot):  # guessed far from 1, so that trial values are negative
        return [xdot[0] + x[0], math.log(x[1]) - x[0]]

    found = end_of(logarithm, (0, 1), [1, 10], record=False, rtol=1e-6, atol=1e-6)
    assert found == pytest.approx([np.exp(-1), np.exp(np.exp(-1))], abs=1e-5)


@pytest.mark.parametrize("is_sparse", [False, True])
def test_patterns_may_be_matrices(is_sparse):
    form = pytest.importorskip("scipy.sparse").csr_matrix if is_sparse else np.asarray
    n = 40
    calls = []

    def cells(t, x, xdot):
        calls.append(t)
        beside = np.concatenate(([1.0], x, [0.0]))
        return xdot - (beside[:-2] - 2 * x + beside[2:])

    line = np.eye(n) + np.eye(n, k=1) + np.eye(n, k=-1)
    problem = sfdae.NonlinearProblem(
        cells, n, record=False, F_x_pattern=form(line), F_xdot_pattern=form(np.eye(n))
    )
    found = end_of(problem, (0, 1), np.zeros(n), rtol=1e-6, atol=1e-6)
    with_patterns, calls[:] = len(calls), []
    assert found == pytest.approx(end_of(cells, (0, 1), np.zeros(n), record=False), abs=1e-4)
    assert 3 * with_patterns < len(calls)
    assert sfdae.make_consistent(decay, 0.0, [1.0], parameters={"k": 2}).xdot[0] == -2
    report = sfdae.analyze(decay, 0.0, [1.0], parameters={"k": 2})
    assert report.characteristics.differential == 1
    many = sfdae.solve_ensemble(decay, (0, 1), [1.0], parameters={"k": [1.0, 2.0]}, **EXACT)
    assert many.x[:, 0, -1] == pytest.approx(np.exp([-1, -2]), abs=1e-7)
    event = sfdae.Event(lambda t, x, level: x[0] - level, terminal=True)
    sol = sfdae.solve(decay, (0, 1), [1.0], parameters={"k": 2, "level": 0.5}, events=event)
    assert sol.t[-1] == pytest.approx(np.log(2) / 2, abs=1e-5)
    for missing in ({}, {"j": 1}):
        with pytest.raises(TypeError, match="parameter 'k' has no value"):
            sfdae.solve(decay, (0, 1), [1.0], parameters=missing)


def test_tolerances_by_name():
    def two(t, x, xdot):
        a, b = x
        return [xdot[0] + a, xdot[1] + b]

    loose = sfdae.solve(two, (0, 1), {"a": 1, "b": 1e-3}, rtol=1e-3, atol=1e-3)
    tight = sfdae.solve(two, (0, 1), {"a": 1, "b": 1e-3}, rtol={"a": 1e-9}, atol={"a": 1e-9})
    assert abs(tight["a"][-1] - np.exp(-1)) < 1e-7 < abs(loose["a"][-1] - np.exp(-1))
    with pytest.raises(KeyError, match="no unknown 'c'"):
        sfdae.solve(two, (0, 1), {"a": 1}, atol={"c": 1})


def test_the_order_of_linear_coefficients_has_its_name():
    with pytest.raises(
        TypeError, match=r"argument o of f has no value.* call it order: f\(t, order\)"
    ):
        sfdae.LinearProblem([[1.0]], [[1.0]], lambda t, o: [np.sin(t + o * np.pi / 2)])
    problem = sfdae.LinearProblem([[1.0]], [[1.0]], lambda t, o: [o * t], parameters={"o": 0.0})
    assert end_of(problem, (0, 1), [1.0]) == pytest.approx([np.e], rel=1e-7)


@pytest.mark.parametrize("count", [2**31, 2**40, 50_001])
def test_too_many_unknowns_are_refused_at_once(count):
    with pytest.raises(ValueError, match="too many: at most 50000"):
        sfdae.NonlinearProblem(oscillator, count)
    with pytest.raises(ValueError, match="too many: at most 50000"):
        sfdae.LinearProblem(lambda t: 1, lambda t: 1, num_unknowns=count)


def test_the_most_unknowns_are_those_of_the_library():
    ffi, lib = sfdae._binding.ffi, sfdae._binding.lib
    c, text = ffi.new("sfdae_nonlinear_problem*"), ffi.new("char[]", 500)
    lib.sfdae_nonlinear_problem_init(c, ffi.sizeof(c[0]))
    c.num_equations = c.num_unknowns = 50_001
    assert lib.sfdae_check_nonlinear(c, ffi.NULL, text, 500) < 0
    assert b"1 ... 50000" in ffi.string(text)
    with pytest.raises(TypeError, match="num_unknowns has to be an integer, not 2.5"):
        sfdae.NonlinearProblem(oscillator, 2.5)


def test_conditions_are_declared():
    def heated(t, x, xdot, branches, power=2.0):
        temperature, clock = x
        return [xdot[0] + temperature - (power if branches[0] else 0.0), xdot[1] - 1]

    def recorded(t, x, xdot, power=2.0):
        temperature, clock = x
        heat = np.where(np.sin(3 * clock) > 0, power, 0)
        return [xdot[0] + temperature - heat, xdot[1] - 1]

    problem = sfdae.NonlinearProblem(
        heated,
        names=["temperature", "clock"],
        record=False,
        conditions=lambda t, x: np.sin(3 * x[1]),
    )
    assert problem.parameters == {"power": 2.0}
    options = {"rtol": 1e-7, "atol": 1e-7, "parameters": {"power": 3.0}}
    found = sfdae.solve(problem, (0, 5), [0, 0], **options)
    expected = sfdae.solve(recorded, (0, 5), [0, 0], **options)
    assert found.x[:, -1] == pytest.approx(expected.x[:, -1], abs=1e-5)
    assert [each.t for each in found.switches] == pytest.approx(
        [each.t for each in expected.switches], abs=1e-5
    )
    assert found.switches[0].condition == "condition 0 of the callbacks"
    with pytest.raises(TypeError, match="record=False"):
        sfdae.NonlinearProblem(recorded, 2, conditions=lambda t, x: x[0])


def test_conditions_of_matrices():
    E = np.array([[-1.0, 1, 0], [1, -2, 0], [0, 0, 0]])  # vs, vm, i of a divider
    A = np.array([[0.0, 0, -1], [0, 1, 0], [-1, 0, 0]])
    divider = sfdae.LinearProblem(
        E,
        A,
        lambda t, order: (order == 0) * np.array([0, 0, divider.branches[0]]),
        conditions=[lambda t, x: t - 1],
    )
    solution = sfdae.solve(divider, (0, 2), [0, 0, 0])
    assert solution.x[1, -1] == pytest.approx(0.5 * np.exp(-0.5), abs=1e-5)
    assert solution.switches[0].jumps


def test_conditions_may_count_as_smooth():
    def divider(t, x, xdot):
        vs, vm, i = x
        return [
            i - (xdot[0] - xdot[1]),
            xdot[0] - xdot[1] - xdot[1] - vm,
            vs - np.where(t > 1, 1, 0),
        ]

    exact = 0.5 * np.exp(-0.5)
    right = sfdae.solve(divider, (0, 2), [0, 0, 0]).x[1, -1]
    with pytest.warns(sfdae.IntegrationWarning, match="a jump or a kink"):
        smooth = sfdae.solve(divider, (0, 2), [0, 0, 0], conditions="smooth").x[1, -1]
    assert right == pytest.approx(exact, abs=1e-5)
    assert abs(smooth - exact) > 0.05
    with pytest.raises(ValueError, match="smooth, events"):
        sfdae.solve(divider, (0, 2), [0, 0, 0], conditions="none")
