# SPDX-License-Identifier: BSD-3-Clause
"""Nonlinear and linear problems, parameters, names; what is refused, and how it is said."""

import math

import numpy as np
import pytest

import sfdae
from models import PENDULUM_NAMES, energy, forced_mass, oscillator, pendulum, pendulum_problem

EXACT = {"rtol": 1e-9, "atol": 1e-9}


# ---- Nonlinear problems --------------------------------------------------------------------------


def test_the_index_of_the_pendulum():
    c = sfdae.analyze(pendulum_problem(), 0.0, {"px": 0.6, "py": -0.8}).characteristics
    assert (c.strangeness_index, c.differential, c.algebraic, c.undetermined, c.redundant) == (
        2,
        2,
        3,
        0,
        0,
    )


def test_equations_may_be_nested_arrays():
    def equations(t, x, xdot):
        p, v, force = x[:2], x[2:4], x[4]
        return [xdot[:2] - v, xdot[2:4] + 2 * p * force + np.array([0, 9.81]), p @ p - 1]

    sol = sfdae.solve(equations, (0, 1), [0.6, -0.8, 0, 0, 0], **EXACT)
    assert np.abs(energy(sol.x)).max() < 1e-6


def test_equations_are_counted():
    """More equations than unknowns: the third follows from the first two."""

    def equations(t, x, xdot):
        return [
            xdot[0] - x[1],
            xdot[1] + x[0],
            xdot[0] * x[1] + xdot[1] * x[1] - x[1] ** 2 + x[0] * x[1],
        ]

    problem = sfdae.NonlinearProblem(equations, 2)
    solver = sfdae.Solver(problem)
    assert problem.num_equations == 3
    c = solver.analyze(0.0, 1.0, [1.0, 0.5])
    assert (c.differential, c.algebraic, c.redundant) == (2, 0, 1)
    assert sfdae.solve(problem, (0, 1), [1.0, 0.0], **EXACT).x[0, -1] == pytest.approx(
        np.cos(1), abs=1e-6
    )


def test_a_wrong_count_is_refused():
    with pytest.raises(ValueError, match="returned 2 formulas, not 3"):
        sfdae.Solver(sfdae.NonlinearProblem(oscillator, 2, num_equations=3))


def test_residual_evaluates_the_same_function():
    problem = pendulum_problem()
    F = problem.residual(0.0, [0.6, -0.8, 1, 2, 3], [1, 2, 3, 4, 0], g=2.0)
    assert F == pytest.approx([0, 0, 3 + 2 * 0.6 * 3, 4 - 2 * 0.8 * 3 + 2, 0])


@pytest.mark.parametrize(
    "equations, error, text",
    [
        (lambda t, x, xdot: None, TypeError, "returned nothing"),
        (lambda t, x, xdot: "ab", TypeError, "returned str"),
        (lambda t, x, xdot: [x[0], "b"], TypeError, "returned str"),
        (lambda t, x, xdot: [x[0], object()], TypeError, "expression or a real number"),
        (lambda t, x, xdot: [x[2], x[0]], IndexError, "out of bounds"),
        (lambda t, x: [x[0], x[1]], TypeError, r"accept \(t, x, xdot\)"),
        (3, TypeError, "function of"),
    ],
)
def test_mistakes_in_equations(equations, error, text):
    with pytest.raises(error, match=text):
        sfdae.Solver(sfdae.NonlinearProblem(equations, 2))


def test_an_exception_in_equations_has_its_traceback():
    def equations(t, x, xdot):
        return [x[0] / undefined_name, x[1]]  # noqa: F821

    with pytest.raises(NameError) as caught:
        sfdae.Solver(sfdae.NonlinearProblem(equations, 2))
    assert any(entry.name == "equations" for entry in caught.traceback)


def test_an_unknown_that_equations_leave_free_can_be_prescribed():
    """x' = u with u = cos: x = sin."""
    problem = sfdae.NonlinearProblem(
        lambda t, x, xdot: [xdot[0] - x[1]],
        names=["x", "u"],
        num_equations=1,
        prescribed={"u": np.cos},
    )
    sol = sfdae.solve(problem, (0, 2), [0, 1], **EXACT)
    assert sol["x"] == pytest.approx(np.sin(sol.t), abs=1e-7)
    assert sol["u"] == pytest.approx(np.cos(sol.t), abs=1e-12)


def test_differentiations_limit_the_derivative_array():
    problem = pendulum_problem(differentiations=[1, 1, 0, 0, 2])
    sol = sfdae.solve(problem, (0, 1), {"px": 0.6, "py": -0.8}, **EXACT)
    assert np.abs(energy(sol.x)).max() < 1e-6
    with pytest.raises(ValueError, match="differentiations has 2 entries for 5 equations"):
        sfdae.Solver(pendulum_problem(differentiations=[1, 1]))


def test_total_derivatives_by_hand():
    """F = (x1' - x2, x1 - sin t): total derivatives of order k of x1' - x2 and x1 - sin t."""

    def total_derivative(t, order, jet, jacobians):
        F = [jet[0, order + 1] - jet[1, order], jet[0, order] - np.sin(t + order * np.pi / 2)]
        if not jacobians:
            return F
        is_value = float(order == 0)
        return F, is_value * np.array([[0, -1], [1, 0]]), is_value * np.array([[1, 0], [0, 0]])

    problem = sfdae.NonlinearProblem(num_unknowns=2, total_derivative=total_derivative)
    sol = sfdae.solve(problem, (0, 3), [0, 0], **EXACT)
    assert sol.x[1, -1] == pytest.approx(np.cos(3), abs=1e-9)
    assert not sfdae.Solver(problem).check_derivatives(0.5, 2).suspicious


def array_of_decay(t, order, jet, jacobian):
    """x' + x = 0."""
    F = [jet[0, k + 1] + jet[0, k] for k in range(order + 1)]
    return (F, np.eye(order + 1, order + 2) + np.eye(order + 1, order + 2, 1)) if jacobian else F


def array_of_circle(t, order, jet, jacobian):
    """x2' = x1, x1^2 + x2^2 = 1: order k of each, in rows of two."""
    F = np.zeros((order + 1, 2))
    J = np.zeros((order + 1, 2, order + 2, 2))
    for k in range(order + 1):
        F[k, 0] = jet[1, k + 1] - jet[0, k]
        J[k, 0, k + 1, 1], J[k, 0, k, 0] = 1, -1
        for j in range(k + 1):
            F[k, 1] += math.comb(k, j) * jet[:, j] @ jet[:, k - j]
            J[k, 1, j] = 2 * math.comb(k, j) * jet[:, k - j]
    F[0, 1] -= 1
    return (F, J.reshape(2 * order + 2, 2 * order + 4)) if jacobian else F


def test_a_derivative_array_replaces_total_derivatives():
    problem = sfdae.NonlinearProblem(num_unknowns=2, derivative_array=array_of_circle)
    sol = sfdae.solve(problem, (0, 1), [1, 0], **EXACT)
    assert sol.x[:, -1] == pytest.approx([np.cos(1), np.sin(1)], abs=1e-8)
    assert not sfdae.Solver(problem).check_derivatives(0.5, 2).suspicious
    sol = sfdae.solve(
        sfdae.NonlinearProblem(num_unknowns=1, derivative_array=array_of_decay), (0, 1), [1], **EXACT
    )
    assert sol.x[0, -1] == pytest.approx(np.exp(-1), abs=1e-8)


def test_errors_of_derivative_arrays_are_named():
    def solve(function, unknowns=2):
        problem = sfdae.NonlinearProblem(num_unknowns=unknowns, derivative_array=function)
        return sfdae.solve(problem, (0, 1), [1.0] + [0.0] * (unknowns - 1))

    def contradicting(t, order, jet, jacobian):
        result = array_of_circle(t, order, jet, jacobian)
        if jacobian:
            result[1][0, -1] += 0.5 * (order == 1)
        return result

    with pytest.raises(sfdae.Error, match="row 0, column 5 of the Jacobian") as caught:
        solve(contradicting)
    assert caught.value.status == sfdae.Status.WRONG_DERIVATIVES
    with pytest.raises(ValueError, match=r"J of derivative_array returned an array of shape \(1, 1\)"):
        solve(lambda t, order, jet, jacobian: ([0.0] * (order + 1), [[1.0]]), 1)
    with pytest.raises(TypeError, match=r"has to return \(F, J\)"):
        solve(lambda t, order, jet, jacobian: [0.0] * (order + 1), 1)
    with pytest.raises(sfdae.Error) as caught:
        solve(lambda t, order, jet, jacobian: None, 1)
    assert caught.value.status == sfdae.Status.ORDER_MISSING
    with pytest.raises(ZeroDivisionError):
        solve(lambda t, order, jet, jacobian: 1 / 0)
    with pytest.raises(TypeError, match="or derivative_array"):
        sfdae.NonlinearProblem(lambda t, x, xdot: x, 1, derivative_array=array_of_decay)


def test_jacobians_of_derivative_arrays_are_split():
    jet = np.cos(np.arange(8.0)).reshape(2, 4)
    F, J = array_of_circle(0, 2, jet, True)
    F_x, F_xdot = sfdae.split_derivative_array(J, 2)
    assert F_x.shape == F_xdot.shape == (3, 2, 2)
    assert np.array_equal(F_x[1], [[0, 0], 2 * jet[:, 1]])
    assert np.array_equal(F_xdot, [[[0, 1], [0, 0]], np.zeros((2, 2)), np.zeros((2, 2))])
    J[0, 5] = 1
    with pytest.raises(sfdae.Error, match="row 0, column 5"):
        sfdae.split_derivative_array(J, 2)
    with pytest.raises(ValueError, match="no Jacobian"):
        sfdae.split_derivative_array(J, 3)
    with pytest.raises(ValueError, match="no Jacobian"):
        sfdae.split_derivative_array(J[0], 0)
    with pytest.raises(sfdae.Error, match="order = 14"):
        sfdae.split_derivative_array(np.zeros((15, 16)), 14)


# ---- Sparsity patterns ---------------------------------------------------------------------------

# x0' = -x1, 0 = x1^3 + x1 - x0: log x1 + 3/2 x1^2 + t stays.
CUBIC = {"F_x_pattern": ([0, 1, 3], [1, 0, 1]), "F_xdot_pattern": ([0, 1, 1], [0])}


@pytest.mark.parametrize("matrices", ["dense", "compressed", "differences"])
def test_total_derivatives_with_patterns(matrices):
    asked = []

    def total_derivative(t, order, jet, jacobians):
        if order > 0:
            return None
        x, xdot = jet[:, 0], jet[:, 1]
        F = [xdot[0] + x[1], x[1] ** 3 + x[1] - x[0]]
        if not jacobians:
            return F
        asked.append(order)
        slope = 3 * x[1] ** 2 + 1
        if matrices == "compressed":
            return F, [-1, 1, slope], [1]
        return F, [[0, 1], [-1, slope]], [[1, 0], [0, 0]]

    problem = sfdae.NonlinearProblem(
        num_unknowns=2, total_derivative=total_derivative, matrices=matrices, **CUBIC
    )
    sol = sfdae.solve(
        problem, (0, 1), [2, 1], structure="required", difference_derivatives=True, **EXACT
    )
    v = sol.x[1, -1]
    assert np.log(v) + 1.5 * v**2 + 1 == pytest.approx(1.5, abs=1e-6)
    assert bool(asked) == (matrices != "differences")


def test_linear_problems_with_entries():
    """x0' = -x0, 0 = x0 - x1."""
    problem = sfdae.LinearProblem(
        [1.0],
        lambda t, order: [-1.0, 1.0, -1.0] if order == 0 else [0.0] * 3,
        E_pattern=([0, 1, 1], [0]),
        A_pattern=([0, 2, 3], [0, 1, 1]),
        matrices="compressed",
    )
    assert problem.num_unknowns == 2
    sol = sfdae.solve(problem, (0, 1), [1, 1], structure="required", **EXACT)
    assert sol.x[:, -1] == pytest.approx(np.exp(-1) * np.ones(2), abs=1e-7)


def test_an_entry_that_a_pattern_lacks():
    problem = sfdae.LinearProblem(
        np.eye(2),
        lambda t, order: np.eye(2),
        E_pattern=([0, 1, 2], [0, 1]),
        A_pattern=([0, 1, 1], [0]),
    )
    with pytest.raises(sfdae.Error, match="A has the entry 1 in row 1, column 1"):
        sfdae.solve(problem, (0, 1), [1, 1])


@pytest.mark.parametrize(
    "change, error, text",
    [
        ({"F_x_pattern": ([0, 1], [1])}, ValueError, "2 numbers for 2 unknowns: 3 are needed"),
        ({"F_x_pattern": ([0, 1, 3], [0.5, 0, 1])}, ValueError, "vector of integers"),
        ({"F_x_pattern": ([0, 1, 3],)}, ValueError, "pair"),
        ({"matrices": "sparse"}, ValueError, "not one of dense"),
        ({"F_x_pattern": ([0, 1, 3], [1, 0, 2])}, sfdae.Error, "rows are 0 ... 1"),
    ],
)
def test_wrong_patterns(change, error, text):
    with pytest.raises(error, match=text):
        sfdae.Solver(
            sfdae.NonlinearProblem(
                num_unknowns=2, total_derivative=lambda *_: None, **{**CUBIC, **change}
            )
        )


# ---- Names and values ----------------------------------------------------------------------------


def test_names_are_used_everywhere():
    problem = pendulum_problem(units={"px": "m", "lambda": "N/m"})
    assert problem.index("lambda") == 4 and problem.index(-1) == 4
    assert problem.units == {"px": "m", "lambda": "N/m"}
    assert problem.values({"py": 2, 0: 1}).tolist() == [1, 2, 0, 0, 0]
    with pytest.raises(KeyError, match="no unknown 'angle'; there are px, py"):
        problem.index("angle")
    with pytest.raises(IndexError, match="no unknown 5"):
        problem.index(5)
    with pytest.raises(KeyError, match="no unknown 'z'"):
        pendulum_problem(units={"z": "m"})


@pytest.mark.parametrize(
    "names, error, text",
    [
        (["a"], ValueError, "1 names for 2"),
        (["a", "a"], ValueError, "'a' is given twice"),
        ("ab", TypeError, "sequence of names"),
    ],
)
def test_wrong_names(names, error, text):
    with pytest.raises(error, match=text):
        sfdae.NonlinearProblem(oscillator, 2, names=names)


def test_default_names_and_missing_sizes():
    assert sfdae.NonlinearProblem(oscillator, 2).names == ("x[0]", "x[1]")
    with pytest.raises(TypeError, match="number of unknowns"):
        sfdae.NonlinearProblem(oscillator)
    with pytest.raises(TypeError, match="either equations or total_derivative"):
        sfdae.NonlinearProblem(num_unknowns=2)


@pytest.mark.parametrize("x0", [[1.0], [1.0, 2.0, 3.0], [[1.0, 2.0]], 1.0])
def test_wrong_shapes_of_values(x0):
    with pytest.raises(ValueError, match=r"x0 has shape .*, not \(2,\)"):
        sfdae.solve(sfdae.NonlinearProblem(oscillator, 2), (0, 1), x0)


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_values_that_are_not_finite(bad):
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT"):
        sfdae.solve(oscillator, (0, 1), [bad, 0.0])


# ---- Parameters ----------------------------------------------------------------------------------


def test_parameters_have_defaults_and_can_be_changed():
    """x'' = -k x: x = cos(sqrt(k) t)."""
    solver = sfdae.Solver(sfdae.NonlinearProblem(oscillator, 2), **EXACT)
    for k in (1.0, 4.0):
        solver.set_parameters(k=k)
        assert solver.get_parameter("k") == k
        solver.start(0.0, [1.0, 0.0], 1.0)
        assert solver.advance(1.0).x[0] == pytest.approx(np.cos(np.sqrt(k)), abs=1e-7)
    assert solver.parameters == {"k": 4.0}


def test_solve_takes_parameters():
    x = sfdae.solve(oscillator, (0, 1), [1, 0], parameters={"k": 9.0}, **EXACT).x[0, -1]
    assert x == pytest.approx(np.cos(3), abs=1e-7)


def test_arrays_of_parameters():
    def equations(t, x, xdot, rates=np.array([1.0, 2.0])):
        return xdot + rates * x

    solver = sfdae.Solver(sfdae.NonlinearProblem(equations, 2), **EXACT)
    solver.set_parameters(rates=[3.0, 4.0])
    assert solver.get_parameter("rates[1]") == 4.0
    solver.start(0.0, [1.0, 1.0], 1.0)
    assert solver.advance(1.0).x == pytest.approx(np.exp([-3.0, -4.0]), abs=1e-8)
    with pytest.raises(TypeError, match=r"shape \(2,\), not \(3,\)"):
        solver.set_parameters(rates=[1, 2, 3])


def test_a_parameter_of_the_recording_itself():
    def equations(t, x, xdot):
        return [xdot[0] - sfdae.parameter(t, "speed", 2.0)]

    solver = sfdae.Solver(sfdae.NonlinearProblem(equations, 1))
    assert solver.get_parameter("speed") == 2.0
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT"):
        solver.get_parameter("length")


def test_a_parameter_without_a_value():
    def equations(t, x, xdot, mass):
        return [mass * xdot[0] - 1]

    with pytest.raises(TypeError, match="parameter 'mass' has no value"):
        sfdae.NonlinearProblem(equations, 1)
    problem = sfdae.NonlinearProblem(equations, 1, parameters={"mass": 2.0})
    assert sfdae.solve(problem, (0, 1), [0.0]).x[0, -1] == pytest.approx(0.5)


@pytest.mark.parametrize(
    "parameters, error, text",
    [
        ({"q": 1.0}, TypeError, "no parameter 'q'"),
        ({"k": "a"}, TypeError, "number or an array"),
        ({"k": float("nan")}, ValueError, "not finite"),
    ],
)
def test_wrong_parameters(parameters, error, text):
    with pytest.raises(error, match=text):
        sfdae.NonlinearProblem(oscillator, 2, parameters=parameters)
    with pytest.raises(error, match=text):
        sfdae.Solver(sfdae.NonlinearProblem(oscillator, 2)).set_parameters(**parameters)


# ---- Linear problems -----------------------------------------------------------------------------

E = [[1, 0, 0], [0, 1, 0], [0, 0, 0]]
A = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]


def f_recorded(t):
    return [0, 0, -np.sin(t)]


def f_callback(t, order):
    return [0, 0, -np.sin(t + order * np.pi / 2)]


@pytest.mark.parametrize(
    "coefficients, kind",
    [
        ((E, A, f_callback), "linear"),
        ((E, A, f_recorded), "nonlinear"),
        ((lambda t, order: np.array(E) * (order == 0), A, f_callback), "linear"),
        ((lambda t: E, A, f_recorded), "nonlinear"),
    ],
)
def test_linear_problems_in_all_forms(coefficients, kind):
    """The forced mass: x = (sin, cos, -sin), mu = 2, d = 0."""
    problem = sfdae.LinearProblem(*coefficients)
    assert problem.kind == kind
    sol = sfdae.solve(problem, (0, 2), [0, 1, 0], t_eval=[0, 1, 2])
    assert sol.x == pytest.approx(
        np.array([np.sin(sol.t), np.cos(sol.t), -np.sin(sol.t)]), abs=1e-12
    )
    c = sol.report.characteristics
    assert (c.strangeness_index, c.differential, c.algebraic) == (2, 0, 3)


def test_the_same_as_a_nonlinear_problem():
    sol = sfdae.solve(forced_mass, (0, 2), [0, 1, 0], t_eval=[2.0])
    assert sol.x[:, 0] == pytest.approx([np.sin(2), np.cos(2), -np.sin(2)], abs=1e-12)


def test_linear_formulas_with_parameters():
    problem = sfdae.LinearProblem([[1.0]], lambda t, rate=1.0: [[-rate]], num_unknowns=1)
    x = sfdae.solve(problem, (0, 1), [1.0], parameters={"rate": 2.0}, **EXACT).x[0, -1]
    assert x == pytest.approx(np.exp(-2), abs=1e-8)


def test_linear_problems_with_a_prescribed_unknown():
    problem = sfdae.LinearProblem([[1, 0]], [[0, 1]], names=["x", "u"], prescribed={"u": np.cos})
    assert sfdae.solve(problem, (0, 1), [0, 1], **EXACT).x[0, -1] == pytest.approx(
        np.sin(1), abs=1e-7
    )


@pytest.mark.parametrize(
    "arguments, error, text",
    [
        (([[1, 2]], [[1]]), ValueError, r"A has shape \(1, 1\), not \(1, 2\)"),
        (([1, 2], [[1]]), ValueError, "E has shape .* has to be a matrix"),
        (([[1]], [[1]], [1, 2]), ValueError, r"f has shape \(2,\), not \(1,\)"),
        (([[1]], [["a"]]), TypeError, "A has to be an array of numbers"),
        ((lambda t: [[1]], lambda t: [[1]]), TypeError, "num_unknowns or names"),
        (([[1]], lambda t: [[1]], lambda t, order: [0]), TypeError, "functions of one kind"),
    ],
)
def test_wrong_linear_problems(arguments, error, text):
    with pytest.raises(error, match=text):
        sfdae.LinearProblem(*arguments)


@pytest.mark.parametrize(
    "wrong, error, text",
    [
        (
            lambda t, order: [0, 0],
            ValueError,
            r"f of order 0 returned an array of shape \(2,\), not \(3,\)",
        ),
        (lambda t, order: None, TypeError, "f returned None for order 0"),
        (lambda t, order: ["a", 0, 0], TypeError, "no array of numbers"),
        (lambda t, order: 1 / 0, ZeroDivisionError, "division"),
    ],
)
def test_mistakes_in_callbacks(wrong, error, text):
    with pytest.raises(error, match=text):
        sfdae.solve(sfdae.LinearProblem(E, A, wrong), (0, 1), [0, 0, 0])


def test_missing_orders_are_an_error_or_computed_by_differences():
    problem = sfdae.LinearProblem(E, A, lambda t, order: f_callback(t, 0) if order == 0 else None)
    with pytest.raises(sfdae.Error) as caught:
        sfdae.solve(problem, (0, 1), [0, 0, 0])
    assert caught.value.status == sfdae.Status.ORDER_MISSING
    sol = sfdae.solve(problem, (0, 1), [0, 1, 0], difference_derivatives=1, t_eval=[1.0])
    assert sol.x[:, 0] == pytest.approx([np.sin(1), np.cos(1), -np.sin(1)], abs=1e-5)


def test_derivatives_that_contradict_their_functions_are_refused():
    problem = sfdae.LinearProblem(lambda t, order: E, A, f_callback)
    with pytest.raises(sfdae.Error, match="derivative 1 of E contradicts differences") as caught:
        sfdae.solve(problem, (0, 1), [0, 1, 0])
    assert caught.value.status == sfdae.Status.WRONG_DERIVATIVES
    # Without the check there is a solution, to other equations.
    assert sfdae.solve(problem, (0, 1), [0, 1, 0], check_derivatives=0).status == sfdae.Status.OK


def test_nan_of_a_callback_is_named():
    problem = sfdae.LinearProblem(E, A, lambda t, order: [0, 0, np.nan])
    with pytest.raises(sfdae.Error) as caught:
        sfdae.solve(problem, (0, 1), [0, 0, 0])
    assert caught.value.status == sfdae.Status.NOT_FINITE


def test_derivatives_by_hand_are_checked():
    right = sfdae.Solver(sfdae.LinearProblem(E, A, f_callback)).check_derivatives(0.5, 3)
    wrong = sfdae.Solver(
        sfdae.LinearProblem(E, A, lambda t, order: [0, 0, -np.sin(t)])
    ).check_derivatives(0.5, 3)
    assert not right.suspicious
    assert (wrong.suspicious, wrong.function, wrong.row) == (1, "f", 2)


def test_arrays_of_callbacks_can_be_kept():
    """What a callback gets is a copy: keeping it is safe, changing it is refused."""
    kept = []

    def total_derivative(t, order, jet, jacobians):
        kept.append(jet)
        with pytest.raises(ValueError):
            jet[0, 0] = 1.0
        F = [jet[0, order + 1] + jet[0, order]]
        return (F, [[float(order == 0)]], [[float(order == 0)]]) if jacobians else F

    sfdae.solve(
        sfdae.NonlinearProblem(num_unknowns=1, total_derivative=total_derivative), (0, 1), [1.0]
    )
    assert all(np.all(np.isfinite(jet)) for jet in kept)


def test_repr_names_unknowns():
    assert repr(pendulum_problem()) == f"NonlinearProblem(5 unknowns: {', '.join(PENDULUM_NAMES)})"
    assert pendulum.__doc__


# ---- Names of equations --------------------------------------------------------------------------


def test_messages_have_names_of_equations():
    def equations(t, x, xdot):
        return [xdot[0] + x[0], x[1] - np.log(x[0] - 0.5)]

    names = ["balance of mass", "Füllstand"]
    problem = sfdae.NonlinearProblem(equations, names=["mass", "level"], equation_names=names)
    assert problem.equation_names == tuple(names)
    with pytest.raises(sfdae.Error, match=r"log of -0.25 in equation 1 \(Füllstand\)"):
        sfdae.solve(problem, (0, 1), [0.25, 0])


def test_contradicting_linear_equations_have_names():
    def f(t, order):
        return np.array([-np.sin(t), -np.sin(t) - 0.5]) if order == 0 else None

    for free_of_callbacks in (True, False):
        problem = sfdae.LinearProblem(
            np.zeros((2, 1)),
            np.ones((2, 1)),
            (lambda t: [-sfdae.sin(t), -sfdae.sin(t) - 0.5]) if free_of_callbacks else f,
            equation_names=["path", ""],
        )
        with pytest.raises(sfdae.Error, match=r"It is equations 0 \(path\) and 1 that cannot hold"):
            sfdae.solve(problem, (0, 1), [0])


def test_constraints_have_names():
    """Two rods to one point, of different lengths."""
    problem = sfdae.MultibodyProblem(
        2,
        constraints=lambda t, q: [q @ q - 1, q @ q - 4],
        forces=lambda t, q, v: [0, -1],
        constraint_names=["short rod", "long rod"],
    )
    with pytest.raises(sfdae.Error, match=r"holonomic constraint [01] \((short|long) rod\)"):
        sfdae.solve(problem, (0, 1), [1, 0, 0, 0, 0, 0])


def test_names_of_equations_are_as_many_as_equations():
    def two(t, x, xdot):
        return [xdot[0] + x[0], x[1] - x[0]]

    with pytest.raises(ValueError, match="equations returned 2 formulas, not 1"):
        sfdae.solve(sfdae.NonlinearProblem(two, 2, equation_names=["one"]), (0, 1), [0, 0])
    problem = sfdae.NonlinearProblem(two, 2, num_equations=2, equation_names=["one"])
    with pytest.raises(ValueError, match="there are 1 names for 2 equations"):
        sfdae.solve(problem, (0, 1), [0, 0])
    with pytest.raises(TypeError, match="not the string 'ab'"):
        sfdae.NonlinearProblem(two, 2, equation_names="ab")


@pytest.mark.parametrize("capacity", [1e-6, 1e-12, 1e-17])
def test_units_do_not_ask_for_derivatives(capacity):
    """q' = (1 - v) / R and q = C v: no derivative of E, A or f is needed, however small C is."""
    resistance = 1e3

    def of_order_zero(values):
        return lambda t, order: np.array(values) if order == 0 else None

    problem = sfdae.LinearProblem(
        of_order_zero([[1.0, 0.0], [0.0, 0.0]]),
        of_order_zero([[0.0, -1 / resistance], [-1.0, capacity]]),
        of_order_zero([1 / resistance, 0.0]),
        num_unknowns=2,
        num_equations=2,
    )
    end = 2 * resistance * capacity
    sol = sfdae.solve(problem, (0, end), [0, 0], rtol=1e-6, atol=[1e-6 * capacity, 1e-6])
    assert sol.x[1, -1] == pytest.approx(1 - np.exp(-2), abs=1e-5)
