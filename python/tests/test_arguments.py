# SPDX-License-Identifier: BSD-3-Clause
"""Arguments of user-supplied functions: xdot by its name, others are parameters."""

import functools

import numpy as np
import pytest

import sfdae
from models import oscillator

EXACT = {"rtol": 1e-9, "atol": 1e-9}
SPAN, START = (0, 4), [1, 0]  # cos t, with the speed -sin t
LEVEL = np.arccos(0.5)


class Level:
    def __call__(self, t, x, c=0.5):
        return x[0] - c

    def method(self, t, x, c=0.5):
        return x[0] - c


def with_any_more(t, x, *others):
    return x[0] - 0.5 if not others else None


def by_keyword(t, x, *, c=0.5):
    return x[0] - c


def after_xdot(t, x, xdot, c=0.5):
    return x[0] - c + 0 * xdot[0]


def before_xdot(t, x, c=0.5, xdot=None):
    return x[0] - c + 0 * xdot[0]


def difference(t, x, c):
    return x[0] - c


@pytest.mark.parametrize(
    "event",
    [
        lambda t, x, c=0.5: x[0] - c,
        lambda t, x, c=0.5, d=1.0: d * (x[0] - c),
        lambda time, place, level=0.5: place[0] - level,
        Level(),
        Level().method,
        with_any_more,
        by_keyword,
        after_xdot,
        before_xdot,
        functools.partial(difference, c=0.5),
    ],
)
def test_further_arguments_of_events_are_parameters(event):
    sol = sfdae.solve(oscillator, SPAN, START, events=event, **EXACT)
    assert sol.t_events[0] == pytest.approx([LEVEL], abs=1e-7)
    solver = sfdae.Solver(sfdae.NonlinearProblem(oscillator, 2), **EXACT)
    solver.set_events(event)
    solver.start(0, START, 4)
    assert solver.advance(4).t == pytest.approx(LEVEL, abs=1e-7)


def test_values_of_the_parameters_of_events():
    event = sfdae.Event(lambda t, x, c=0.5: x[0] - c, action=lambda t, x, turn=-1.0: turn * x)
    sol = sfdae.solve(oscillator, SPAN, START, events=event, parameters={"c": 0.0}, **EXACT)
    assert sol.t_events[0][0] == pytest.approx(np.pi / 2, abs=1e-7)
    sol = sfdae.solve(
        oscillator, (0, 1.6), START, events=event, parameters={"c": 0.0, "turn": 2.0}, **EXACT
    )
    assert sol.x[1, -1] == pytest.approx(-2 * np.sin(1.6), abs=1e-6)
    with pytest.raises(TypeError, match="no parameter 'd'"):
        sfdae.solve(oscillator, SPAN, START, events=event, parameters={"d": 0.0})
    with pytest.raises(TypeError, match="'c' has to be a number"):
        sfdae.solve(oscillator, SPAN, START, events=event, parameters={"c": "half"})


@pytest.mark.parametrize("event", [lambda t, x, k: x[0] - k / 8, lambda t, x, k=1.0: x[0] - k / 8])
def test_parameters_of_the_equations_have_the_same_value_in_events(event):
    """x = cos 2t, level 1/2."""
    sol = sfdae.solve(oscillator, (0, 1), START, events=event, parameters={"k": 4.0}, **EXACT)
    assert sol.t_events[0] == pytest.approx([LEVEL / 2], abs=1e-7)
    solver = sfdae.Solver(sfdae.NonlinearProblem(oscillator, 2), **EXACT)
    solver.set_events(event)
    solver.set_parameters(k=4.0)
    solver.start(0, START, 4)
    assert solver.advance(4).t == pytest.approx(LEVEL / 2, abs=1e-7)


def test_other_defaults_than_values_of_the_parameters_are_not_disturbed():
    found = []
    event = sfdae.Event(
        lambda t, x, unknowns=(0,), nothing=None: x[unknowns[0]] if nothing is None else 1.0,
        action=lambda t, x, log=found: log.append(t),
    )
    sfdae.solve(oscillator, SPAN, START, events=event, **EXACT)
    assert found == pytest.approx([np.pi / 2], abs=1e-7)


@pytest.mark.parametrize(
    "event, text",
    [
        (lambda t, x, v: v[0], "the argument v of .*<lambda>' has no value.*call it xdot"),
        (lambda t, x, k=2.0: x[0] - k, "has the default k=2.0, but k is a parameter .* value 1.0"),
        (lambda t, x, k=None: x[0], "has the default k=None, but k is a parameter"),
        (lambda x, t: x[0], r"called with \(t, x\), but its arguments are \(x, t\)"),
        (lambda t, xdot: xdot[0], r"called with \(t, x\), but its arguments are \(t, xdot\)"),
        (lambda t, c=0.5: c, "its second argument is the parameter c=0.5"),
        (lambda t: t, r"has to accept \(t, x\)"),
    ],
)
def test_mistakes_in_the_arguments_of_events(event, text):
    with pytest.raises(TypeError, match=text):
        sfdae.solve(oscillator, SPAN, START, events=event)
    with pytest.raises(TypeError, match=text):
        sfdae.solve(
            oscillator, SPAN, START, events=sfdae.Event(lambda t, x: x[0], action=event)
        )
    with pytest.raises(TypeError, match=text.replace("<lambda>'", "")):
        sfdae.Solver(sfdae.NonlinearProblem(oscillator, 2)).set_events(event)
    for part in ("condition", "zero"):
        with pytest.raises(TypeError, match=text.replace("<lambda>'", "")):
            transition = sfdae.Transition("a", "a", **{part: event})
            sfdae.Hybrid({"a": sfdae.NonlinearProblem(oscillator, 2)}, [transition])
    for part in ("guard", "jump"):
        with pytest.raises(TypeError, match=text.replace("<lambda>'", "")):
            transition = sfdae.Transition("a", "a", time=1.0, **{part: event})
            sfdae.Hybrid({"a": sfdae.NonlinearProblem(oscillator, 2)}, [transition])


# ---- Hybrid systems ------------------------------------------------------------------------------


def falling(t, x, xdot, g=9.81):
    return [xdot[0] - x[1], xdot[1] + g]


def falls(*transitions, **parameters):
    problem = sfdae.NonlinearProblem(falling, 2)
    solver = sfdae.Solver(problem, parameters=parameters, **EXACT)
    system = sfdae.Hybrid({"flight": solver}, transitions)
    system.start("flight", 0, [2, 0], 2)
    return system.advance(1)


@pytest.mark.parametrize("part", ["condition", "zero"])
def test_transitions_have_parameters(part):
    """From the height 2 to 1, where the ball is thrown back with the speed it has, times e."""
    sign = -1 if part == "condition" else 1
    g, e = 8.0, 0.75
    functions = {
        part: lambda t, x, height=1.0: sign * (x[0] - height),
        "guard": lambda t, x, latest=0.9: latest - t,
        "jump": lambda t, x, e=0.75: [1.0 + 1e-9, -e * x[1]],
    }
    x = falls(sfdae.Transition("flight", "flight", **functions), g=g).x
    T = np.sqrt(2 / g)
    assert x[0] == pytest.approx(1 + e * g * T * (1 - T) - g / 2 * (1 - T) ** 2, abs=1e-6)
    speed = sfdae.Transition(  # g is that of the equations
        "flight", "flight", **{part: lambda t, x, g, xdot: sign * (g / 2 + xdot[0])},
        jump=lambda t, x, g=9.81: [x[0], 2 * g], guard=lambda t, x, c=0.55: c - t,
    )
    x = falls(speed, g=g).x
    assert x[1] == pytest.approx(2 * g - g / 2, abs=1e-6)


def test_sensitivities_by_parameters_of_transitions_are_refused():
    """The derivative of the transition by g would be missing."""
    problem = sfdae.NonlinearProblem(falling, 2)
    for part in ("zero", "guard", "jump"):
        functions = {"zero": lambda t, x: x[0], part: lambda t, x, g: x - g / 10}
        bounce = sfdae.Transition("flight", "flight", **functions)
        system = sfdae.Hybrid({"flight": problem}, [bounce])
        with pytest.raises(ValueError, match=f"{part} of .* has the parameter g"):
            system.set_sensitivities(["x[0]", "g"])
        system.set_sensitivities(["x[0]"])


def test_jumps_do_not_know_xdot():
    with pytest.raises(TypeError, match="jump .* xdot is not known there"):
        sfdae.Transition("a", "a", time=1.0, jump=lambda t, x, xdot: x)


def test_a_surface_with_another_default():
    problem = sfdae.NonlinearProblem(falling, 2)
    switch = sfdae.Switch("a", "b", lambda t, x, g=1.0: x[0] - g)
    with pytest.raises(TypeError, match="surface has the default g=1.0, but g is a parameter"):
        sfdae.Hybrid({"a": problem, "b": problem}, switches=[switch])


# ---- Equations -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "make, text",
    [
        (
            lambda: sfdae.NonlinearProblem(lambda t, x, c=0.5: [x[0] - c], 1),
            "equations is called with .*, but its third argument is the parameter c=0.5",
        ),
        (
            lambda: sfdae.NonlinearProblem(lambda t, xdot, x: [xdot[0] - x[0]], 1),
            r"called with \(t, x, xdot\), but its arguments are \(t, xdot, x\)",
        ),
        (
            lambda: sfdae.MultibodyProblem(1, forces=lambda t, q, c=0.5: [-c * q[0]]),
            r"forces is called with \(t, q, v\), but its third argument is the parameter c=0.5",
        ),
        (
            lambda: sfdae.MultibodyProblem(1, forces=lambda t, v, q: [-q[0]]),
            "forces is called with",
        ),
        (
            lambda: sfdae.LinearProblem([[1.0]], [[1.0]], lambda t, order, w: [w]),
            "the argument w of f has no value",
        ),
    ],
)
def test_parameters_in_the_places_of_unknowns_are_refused(make, text):
    with pytest.raises(TypeError, match=text):
        make()


def test_places_of_unknowns_may_have_other_names_and_defaults():
    sol = sfdae.solve(lambda t, y, yp: [yp[0] - y[0]], (0, 1), [1.0], **EXACT)
    assert sol.x[0, -1] == pytest.approx(np.e, abs=1e-6)
    sol = sfdae.solve(lambda t, x, xdot=None: [xdot[0] - x[0]], (0, 1), [1.0], **EXACT)
    assert sol.x[0, -1] == pytest.approx(np.e, abs=1e-6)

    def collected(*places, rate=2.0):
        t, x, xdot = places
        return [xdot[0] - rate * x[0]]

    sol = sfdae.solve(collected, (0, 1), [1.0], parameters={"rate": 0.5}, **EXACT)
    assert sol.x[0, -1] == pytest.approx(np.exp(0.5), abs=1e-6)


def test_the_order_is_passed_by_its_name():
    """x' = -x + w with w = 2: the derivatives of f are 0."""
    problem = sfdae.LinearProblem(
        [[1.0]], [[-1.0]], lambda t, w=2.0, order=0: [w if order == 0 else 0.0]
    )
    sol = sfdae.solve(problem, (0, 1), [0.0], **EXACT)
    assert sol.x[0, -1] == pytest.approx(2 * (1 - np.exp(-1)), abs=1e-7)


# ---- Functions beside the equations --------------------------------------------------------------


def decay(t, x, m=1.0):
    return [-x[0]]


@pytest.mark.parametrize("record", [True, False])
@pytest.mark.parametrize(
    "mass",
    [
        lambda t, m=1.0: m,
        lambda t, m: m,
        lambda t, x, m=1.0: m,
        lambda t, y, m: m,
        lambda t, *, m: m,
        lambda time, m: [[m]],
    ],
)
def test_the_mass_has_the_parameters_of_the_equations(mass, record):
    """m x' = -x with m = 2."""
    options = dict(record=record, t_eval=[1.0], rtol=1e-8, atol=1e-8)
    sol = sfdae.solve(decay, (0, 1), [1.0], mass=mass, parameters={"m": 2.0}, **options)
    assert sol.x[0] == pytest.approx(np.exp(-0.5), abs=1e-6)


def test_a_mass_may_have_parameters_of_its_own():
    sol = sfdae.solve(
        lambda t, x: -x, (0, 1), [1.0], mass=lambda t, m=1.0: [m], parameters={"m": 2.0},
        sensitivities=["m"], t_eval=[1.0], rtol=1e-8, atol=1e-8,
    )  # fmt: skip
    assert sol.x[0] == pytest.approx(np.exp(-0.5), abs=1e-6)
    assert sol.S[0, 0] == pytest.approx(np.exp(-0.5) / 4, abs=1e-5)


@pytest.mark.parametrize(
    "mass, message",
    [
        (lambda x, t: 2.0, "put them in this order"),
        (lambda x: 2.0, r"has to accept \(t, x\)"),
        (lambda t, m=3.0: m, "m' has two defaults, 1.0 of equations and 3.0 of mass"),
    ],
)
def test_arguments_of_a_mass_that_mislead(mass, message):
    with pytest.raises(TypeError, match=message):
        sfdae.solve(decay, (0, 1), [1.0], mass=mass)


def test_two_defaults_of_one_parameter():
    functions = dict(mass=lambda t, q, m=1.0: [m], forces=lambda t, q, v, m=2.0: [m])
    with pytest.raises(TypeError, match="'m' has two defaults, 1.0 of mass and 2.0 of forces"):
        sfdae.MultibodyProblem(1, **functions)
    problem = sfdae.MultibodyProblem(1, **functions, parameters={"m": 2.0})
    assert sfdae.solve(problem, (0, 1), [0, 0], t_eval=[1.0]).x[1, 0] == pytest.approx(1.0)


def test_prescribed_values_do_not_hide_parameters():
    def equations(t, x, xdot, k=1.0):
        return [xdot[0] - k * x[1]]

    with pytest.raises(TypeError, match="value of x.1. .* argument k is a parameter"):
        sfdae.NonlinearProblem(equations, 2, prescribed={1: lambda t, k=1.0: k * t})
    problem = sfdae.NonlinearProblem(equations, 2, prescribed={1: lambda t, c=2.0: c * t})
    assert sfdae.solve(problem, (0, 1), [0, 0], t_eval=[1.0]).x[0, 0] == pytest.approx(1, abs=1e-5)
