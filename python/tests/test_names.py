# SPDX-License-Identifier: BSD-3-Clause
"""Names of unknowns: values by name reach the unknown that the function calls so, in whatever order
they are given; where nobody knows, they are refused.
"""

import functools
import sys
import types

import numpy as np
import pytest

import sfdae
from models import oscillator

EXACT = {"rtol": 1e-8, "atol": 1e-8}
# In the order of x the pendulum has p, q, u, v, s.
START = {"q": -0.8, "p": 0.6, "s": 0, "u": 0, "v": 0}


def balance(p, q, u, v, s, xdot, g=9.81):
    return [
        xdot[0] - u,
        xdot[1] - v,
        xdot[2] + 2 * p * s,
        xdot[3] + 2 * q * s + g,
        p**2 + q**2 - 1,
    ]


def pendulum(t, x, xdot, g=9.81):
    p, q, u, v, s = x
    return balance(p, q, u, v, s, xdot, g)


def with_mode(mode, t, x, xdot):
    assert mode == "full"
    p, q, u, v, s = x
    return balance(p, q, u, v, s, xdot)


def passed_on(function):
    @functools.wraps(function)
    def wrapper(*arguments, **named):
        return function(*arguments, **named)

    return wrapper


class Model:
    def method(self, t, x, xdot):
        p, q, u, v, s = x
        return balance(p, q, u, v, s, xdot)

    def __call__(self, t, x, xdot, g=9.81):
        [p, q, u, v, s] = x
        return balance(p, q, u, v, s, xdot, g)

    @staticmethod
    def static(t, x, xdot):
        (p, q, u, v, s) = x
        return balance(p, q, u, v, s, xdot)


def captured(t, x, xdot):
    """p and x belong to inner functions, too."""
    p, q, u, v, s = x

    def length():
        return p**2 + x[1] ** 2

    return [*balance(p, q, u, v, s, xdot)[:4], length() - 1]


def under_another_name(t, unknowns, slopes):
    p, q, u, v, s = unknowns
    return balance(p, q, u, v, s, slopes)


def changed_later(t, x, xdot):
    p, q, u, v, s = x
    s = 1.0 * s
    x = None
    return balance(p, q, u, v, s, xdot)


def twice_the_same(t, x, xdot):
    p, q, u, v, s = x
    if t is not None:
        p, q, u, v, s = x
    return balance(p, q, u, v, s, xdot)


def from_text(text):
    names = {"balance": balance}
    exec(text, names)
    return names["F"]


WITHOUT_SOURCE = from_text(
    "def F(t, x, xdot):\n p, q, u, v, s = x\n return balance(p, q, u, v, s, xdot)"
)
IN_ONE_LINE = from_text("F = lambda t, x, xdot: balance(*x, xdot)")

READABLE = [
    pendulum,
    functools.partial(pendulum, g=9.81),
    functools.partial(with_mode, "full"),
    passed_on(pendulum),
    passed_on(passed_on(Model.static)),
    Model().method,
    Model(),
    Model.static,
    passed_on(Model().method),
    captured,
    under_another_name,
    changed_later,
    twice_the_same,
    WITHOUT_SOURCE,
]


@pytest.fixture(scope="module")
def reference():
    return sfdae.solve(pendulum, (0, 1), [0.6, -0.8, 0, 0, 0], t_eval=[1.0], **EXACT).x[:, 0]


@pytest.mark.parametrize("function", READABLE)
def test_the_order_of_keys_does_not_matter(function, reference):
    sol = sfdae.solve(function, (0, 1), START, t_eval=[1.0], **EXACT)
    assert sol.names == ("p", "q", "u", "v", "s")
    assert np.array_equal(sol.x[:, 0], reference)
    assert sol["p"][0] == reference[0] == pytest.approx(-0.598, abs=1e-3)


def test_unknowns_that_are_not_named_are_guessed_as_0(reference):
    sol = sfdae.solve(pendulum, (0, 1), {"q": -0.8, "p": 0.6}, t_eval=[1.0], **EXACT)
    assert np.array_equal(sol.x[:, 0], reference)


def test_every_function_that_takes_values_by_name():
    swapped = {"q": -0.8, "p": 0.6}
    point = sfdae.make_consistent(pendulum, 0, {**swapped, "v": 0.1}, xdot={"q": 0.0}, fixed=["p"])
    assert point.x[:2] == pytest.approx([0.6, -0.8]) and point.x[2] * 0.6 == pytest.approx(
        0.8 * point.x[3], abs=1e-12
    )
    report = sfdae.analyze(pendulum, 0, swapped)
    assert report.names == ("p", "q", "u", "v", "s")
    assert report.characteristics.strangeness_index == 2
    ensemble = sfdae.solve_ensemble(pendulum, (0, 1), swapped, parameters={"g": [9.81, 1.62]})
    alone = sfdae.solve(pendulum, (0, 1), swapped, parameters={"g": 1.62}, t_eval=[1.0])
    assert np.array_equal(ensemble["p"][1], alone["p"])
    S = sfdae.solve(pendulum, (0, 1), swapped, sensitivities=["p", "g"], t_eval=[1.0], **EXACT).S
    assert S.shape == (5, 2, 1) and S[0, 0, 0] != 0


def test_tolerances_by_name():
    """Unknowns that are not named keep the default."""
    names = ("p", "q", "u", "v", "s")
    atol = dict.fromkeys(names, 1e-6)
    plain = sfdae.solve(pendulum, (0, 1), START)
    assert np.array_equal(sfdae.solve(pendulum, (0, 1), START, atol=atol, rtol={}).x, plain.x)
    assert np.array_equal(sfdae.solve(pendulum, (0, 1), START, atol={"u": 1e-6}).x, plain.x)
    each = sfdae.solve(pendulum, (0, 1), START, atol={"u": 1e-9, "q": 1e-3})
    array = sfdae.solve(pendulum, (0, 1), START, atol=[1e-6, 1e-3, 1e-9, 1e-6, 1e-6])
    assert np.array_equal(each.x, array.x) and each.t.size != plain.t.size
    with pytest.raises(KeyError, match="no unknown 'w'"):
        sfdae.solve(pendulum, (0, 1), START, atol={"w": 1e-6})


# ---- What cannot be known ------------------------------------------------------------------------


def by_index(t, x, xdot):
    return balance(x[0], x[1], x[2], x[3], x[4], xdot)


def by_slices(t, x, xdot):
    p, q = x[:2]
    u, v = x[2:4]
    return balance(p, q, u, v, x[4], xdot)


def with_a_rest(t, x, xdot):
    p, q, *others = x
    return balance(p, q, *others, xdot)


def rearranged(function):
    """The function gets the unknowns in another order than the solver has them."""

    @functools.wraps(function)
    def wrapper(t, x, xdot, **named):
        order = [1, 0, 2, 3, 4]
        return function(t, x[order], xdot[order], **named)

    return wrapper


def reversed_before(t, x, xdot):
    x = x[::-1]
    p, q, u, v, s = x
    return balance(p, q, u, v, s, xdot[::-1])


def in_a_branch_that_is_not_taken(t, x, xdot):
    if xdot is None:
        p, q, u, v, s = x
    else:
        q, p, u, v, s = (x[i] for i in range(5))
    return balance(p, q, u, v, s, xdot)


def under_two_names(t, x, xdot):
    if xdot is None:
        q, p, u, v, s = x
    else:
        p, q, u, v, s = x
    return balance(p, q, u, v, s, xdot)


def scaled(t, x, xdot):
    x = 2 * x
    p, q, u, v, s = x
    return balance(p, q, u, v, s, 2 * xdot)


def all_in_one(*arguments):
    return pendulum(*arguments)


UNREADABLE = [by_index, by_slices, with_a_rest, under_two_names, IN_ONE_LINE, all_in_one]
UNCONFIRMED = [rearranged(pendulum), reversed_before, in_a_branch_that_is_not_taken, scaled]


@pytest.mark.parametrize("function", [*UNREADABLE, *UNCONFIRMED])
@pytest.mark.parametrize("start", [START, {"p": 0.6, "q": -0.8, "u": 0, "v": 0, "s": 0}])
def test_names_that_are_not_known_are_refused(function, start):
    text = "not confirmed" if function in UNCONFIRMED else "cannot be read"
    text += r".* names=\[\.\.\.\], the names of x\[0\], x\[1\]"
    for call in (
        lambda: sfdae.solve(function, (0, 1), start),
        lambda: sfdae.analyze(function, 0, start),
        lambda: sfdae.make_consistent(function, 0, start),
        lambda: sfdae.solve_ensemble(function, (0, 1), start),
    ):
        with pytest.raises(TypeError, match=text):
            call()


@pytest.mark.parametrize("function", UNREADABLE)
def test_names_say_what_x_is(function, reference):
    names = ["p", "q", "u", "v", "s"]
    sol = sfdae.solve(function, (0, 1), START, names=names, t_eval=[1.0], **EXACT)
    assert np.array_equal(sol.x[:, 0], reference)


def test_names_of_rearranged_unknowns():
    """The solver has (s, v, u, q, p) and (q, p, u, v, s)."""
    sol = sfdae.solve(reversed_before, (0, 1), START, names=["s", "v", "u", "q", "p"], **EXACT)
    assert sol.x[4, 0] == 0.6 and sol["p"][-1] == pytest.approx(-0.598, abs=1e-3)
    sol = sfdae.solve(rearranged(pendulum), (0, 1), START, names=list("qpuvs"), **EXACT)
    assert sol.x[1, 0] == 0.6 and sol["p"][-1] == pytest.approx(-0.598, abs=1e-3)


def test_values_by_index_need_no_names(reference):
    sol = sfdae.solve(by_index, (0, 1), {1: -0.8, 0: 0.6, 4: 0, 3: 0, 2: 0}, t_eval=[1.0], **EXACT)
    assert np.array_equal(sol.x[:, 0], reference) and sol.names[1] == "x[1]"
    sol = sfdae.solve(pendulum, (0, 1), {1: -0.8, "p": 0.6}, t_eval=[1.0], **EXACT)
    assert np.array_equal(sol.x[:, 0], reference)
    with pytest.raises(TypeError, match="cannot be read"):
        sfdae.solve(by_index, (0, 1), {1: -0.8, 0: 0.6, 7: 0})


def test_keys_that_are_no_unknowns():
    with pytest.raises(KeyError, match="no unknown 'force': pendulum unpacks x as p, q, u, v, s"):
        sfdae.solve(pendulum, (0, 1), {"p": 0.6, "q": -0.8, "force": 0})
    with pytest.raises(KeyError, match="no unknown 'force'; there are p, q"):
        sfdae.solve(by_index, (0, 1), {**START, "force": 0}, names=["p", "q", "u", "v", "s"])
    with pytest.raises(ValueError, match="two values for p"):
        sfdae.solve(pendulum, (0, 1), {"p": 0.6, "q": -0.8, 0: 0.8})
    with pytest.raises(KeyError, match=r"no unknown 'q'; there are x\[0\], .*: give names="):
        sfdae.solve(sfdae.NonlinearProblem(pendulum, 5), (0, 1), START)


# ---- Contradictions ------------------------------------------------------------------------------


def test_names_that_contradict_the_function():
    text = r"names contradict pendulum: 'p' is the name of x\[1\], but .* unpacks x\[0\] as p"
    for names in (list("qpuvs"), list("pqvus"), ["a", "p", "u", "v", "s"]):
        for start in (dict.fromkeys(names, 0.5), [0.6, -0.8, 0, 0, 0]):
            with pytest.raises(ValueError, match="names contradict pendulum"):
                sfdae.solve(pendulum, (0, 1), start, names=names)
    with pytest.raises(ValueError, match=text):
        sfdae.Solver(sfdae.NonlinearProblem(pendulum, names=list("qpuvs")))
    for function in (by_slices, with_a_rest, WITHOUT_SOURCE, Model().method, passed_on(pendulum)):
        with pytest.raises(ValueError, match="names contradict"):
            sfdae.solve(function, (0, 1), START, names=list("qpuvs"))


def test_series_of_pandas_are_values_by_name(reference):
    """Their order counted."""
    pandas = pytest.importorskip("pandas")
    start = pandas.Series(START)
    sol = sfdae.solve(pendulum, (0, 1), start, t_eval=[1.0], **EXACT)
    assert np.array_equal(sol.x[:, 0], reference)
    tight = pandas.Series(dict.fromkeys(START, 1e-8))
    problem = sfdae.NonlinearProblem(pendulum, names=list("pquvs"))
    solver = sfdae.Solver(problem, rtol=tight, atol=tight[::-1])
    solver.start(0, start, 1)
    assert solver.advance(1).x == pytest.approx(reference, abs=1e-6)
    ensemble = sfdae.solve_ensemble(pendulum, (0, 1), start, **EXACT)
    assert ensemble.x[0, :, 0] == pytest.approx(reference, abs=1e-6)
    numbered = pandas.Series([-0.8, 0.6, 0, 0, 0], index=[1, 0, 2, 3, 4])
    assert np.array_equal(problem.values(numbered), [0.6, -0.8, 0, 0, 0])
    with pytest.raises(TypeError, match="cannot be read"):
        sfdae.solve(lambda t, x, xdot: oscillator(t, x, xdot), (0, 1), start[:2])
    with pytest.raises(ValueError, match="'q' has two values"):
        problem.values(pandas.Series([1, 2], index=["q", "q"]))


def test_flags_by_name():
    """The names in a dictionary were fixed whatever their flags."""
    problem = sfdae.NonlinearProblem(pendulum, names=list("pquvs"))
    solver = sfdae.Solver(problem, fixed={"q": True, "p": False})
    x = solver.make_consistent(0, {"p": 0.5, "q": -0.8}).x
    assert x[:2] == pytest.approx([0.6, -0.8])


def test_other_names_than_those_of_the_function(reference):
    names = ["px", "py", "u", "v", "lambda"]
    sol = sfdae.solve(
        pendulum, (0, 1), {"py": -0.8, "px": 0.6}, names=names, t_eval=[1.0], **EXACT
    )
    assert np.array_equal(sol.x[:, 0], reference)


def test_names_that_stand_for_several_unknowns_contradict_nothing():
    """Two oscillators, in a loop that calls the place of each x and its speed v."""

    def equations(t, x, xdot):
        result = []
        for k in range(2):
            a, v = x[2 * k : 2 * k + 2]
            result += [xdot[2 * k] - v, xdot[2 * k + 1] + a]
        return result

    sol = sfdae.solve(equations, (0, 1), {"b": 1, "a": 0}, names=["w", "v", "b", "a"], **EXACT)
    assert sol["b"][-1] == pytest.approx(np.cos(1), abs=1e-6) and not sol["w"].any()


def test_names_of_mechanical_systems():
    def constraint(t, q):
        y, x = q
        return [x**2 + y**2 - 1]

    arguments = dict(forces=[0, -9.81], constraints=constraint)
    start = {"y": -0.8, "x": 0.6}
    with pytest.raises(ValueError, match="names contradict"):
        problem = sfdae.MultibodyProblem(2, names=["x", "y", "u", "v", "s"], **arguments)
        sfdae.solve(problem, (0, 1), start)
    problem = sfdae.MultibodyProblem(2, names=["a", "b", "u", "v", "s"], **arguments)
    assert sfdae.solve(problem, (0, 1), {"b": -0.8, "a": 0.6}).success

    def drag(t, q, v):
        v, u = v
        return [-u, -9.81 - v]

    with pytest.raises(ValueError, match="names contradict"):
        problem = sfdae.MultibodyProblem(2, names=["x", "y", "u", "v"], forces=drag)
        sfdae.Solver(problem)


def test_events_that_contradict_the_names():
    def low(t, x):
        q, p, u, v, s = x
        return q + 0.9

    with pytest.raises(ValueError, match="names contradict .*low"):
        sfdae.solve(pendulum, (0, 1), START, events=low)
    with pytest.raises(ValueError, match="names contradict .*low"):
        sfdae.solve(pendulum, (0, 1), START, events=sfdae.Event(lambda t, x: x[0], action=low))
    solver = sfdae.Solver(sfdae.NonlinearProblem(pendulum, names=list("pquvs")))
    with pytest.raises(ValueError, match="names contradict .*low"):
        solver.set_events(low)


def test_functions_are_called_as_often_as_without_names():
    calls = []

    def equations(t, x, xdot):
        place, speed = x
        calls.append(type(x).__name__)
        return oscillator(t, x, xdot)

    sfdae.solve(equations, (0, 1), {"speed": 0, "place": 1})
    assert len(calls) == 1


def turned_in_place(t, x, xdot):
    x[:] = x[::-1].copy()
    speed, place = x
    return [xdot[0] - speed, xdot[1] + place]


def turned_where_nobody_goes(t, x, xdot):
    if t < 0:
        speed, place = x
    return [xdot[0] - x[1], xdot[1] + x[0]]


def turned(function):
    @functools.wraps(function)
    def wrapper(t, x, xdot):
        return function(t, x[::-1], xdot[::-1])

    return wrapper


@turned
def turned_by_a_wrapper(t, x, xdot):
    speed, place = x
    return [xdot[1] - speed, xdot[0] + place]


@pytest.mark.parametrize(
    "function", [turned_in_place, turned_where_nobody_goes, turned_by_a_wrapper]
)
def test_names_that_numbers_do_not_confirm(function):
    start = {"speed": 0, "place": 1}
    with pytest.raises(TypeError, match="not confirmed"):
        sfdae.solve(function, (0, 1), start, record=False)
    with pytest.raises(TypeError, match="not confirmed"):
        sfdae.make_consistent(function, 0, start, record=False)


def place_and_speed(t, x, xdot):
    place, speed = x
    return [xdot[0] - speed, xdot[1] + place]


def test_names_that_contradict_functions_of_numbers():
    names = ["speed", "place"]
    with pytest.raises(ValueError, match="names contradict place_and_speed"):
        sfdae.solve(place_and_speed, (0, 1), [1, 0], names=names, record=False)
    problem = sfdae.NonlinearProblem(place_and_speed, names=names, record=False)
    for _ in range(2):
        with pytest.raises(ValueError, match="names contradict place_and_speed"):
            problem.residual(0, {"place": 1}, {})

    def low(t, q):
        y, x = q
        return [x**2 + y**2 - 1]

    arguments = dict(constraints=low, constraint_jacobian=lambda t, q: [2 * q], record=False)
    with pytest.raises(ValueError, match="names contradict .*low"):
        problem = sfdae.MultibodyProblem(2, names=["x", "y", "u", "v", "s"], **arguments)
        sfdae.solve(problem, (0, 1), {"y": -0.8, "x": 0.6})
    problem = sfdae.MultibodyProblem(2, names=["y", "x", "v", "u", "s"], **arguments)
    assert sfdae.solve(problem, (0, 1), {"x": 0.6, "y": -0.8}).success


def test_functions_of_numbers_get_numbers():
    """Also in the first call, in which x tells how it is unpacked."""
    kinds = []

    def equations(t, x, xdot):
        place, speed = x
        parts = [place, x[0], x.sum(), np.sqrt(x[1] ** 2), x @ x, 2 * x, np.linalg.norm(x), x > 0]
        kinds.append([type(part) for part in parts])
        return [xdot[0] - speed, xdot[1] + place]

    by_name = sfdae.solve(equations, (0, 1), {"speed": 0, "place": 1}, record=False)
    by_order = sfdae.solve(equations, (0, 1), [1, 0], record=False)
    assert np.array_equal(by_name.x, by_order.x) and kinds.count(kinds[0]) == len(kinds)


def unpacked_otherwise(t, x, xdot):
    """Neither of these unpacks x itself."""
    q, p, u, v, s = list(x)
    for u in x:
        pass
    q, p = sorted(x[:2], key=lambda unknown: 0)
    v, u = [unknown for unknown in x[2:4]]
    s, v, u, q, p = (unknown for unknown in x)
    return balance(p, q, u, v, s, [*xdot][::-1])


def test_only_unpacking_of_x_itself_counts():
    with pytest.raises(TypeError, match="cannot be read"):
        sfdae.solve(unpacked_otherwise, (0, 1), START)
    names = ["s", "v", "u", "q", "p"]
    sol = sfdae.solve(unpacked_otherwise, (0, 1), START, names=names, **EXACT)
    assert sol["p"][-1] == pytest.approx(-0.598, abs=1e-3)


def test_loads_and_stores_that_are_joined_in_one_instruction(monkeypatch):
    """As Python 3.13 and later have them: y = t; p, q, u = x; z = u."""
    listed = [
        ("LOAD_FAST", "t", 0),
        ("STORE_FAST_LOAD_FAST", ("y", "x"), 2),
        ("UNPACK_SEQUENCE", 3, 4),
        ("STORE_FAST_STORE_FAST", ("p", "q"), 6),
        ("STORE_FAST_LOAD_FAST", ("u", "u"), 8),
        ("STORE_FAST", "z", 10),
    ]
    instructions = [
        types.SimpleNamespace(opname=opname, argval=argument, arg=argument, offset=offset)
        for opname, argument, offset in listed
    ]
    module = sys.modules["sfdae._unknowns"]
    monkeypatch.setattr(module.dis, "get_instructions", lambda code: instructions)

    def function(t, x):
        pass

    assert module.read_names(function) == ("p", "q", "u")


def test_actions_may_return_what_changes():
    """The other unknowns stay."""

    def equations(t, x, xdot):
        place, speed = x
        return oscillator(t, x, xdot)

    turn = sfdae.Event(lambda t, x: t - 1, action=lambda t, x: {"speed": -x[1]})
    sol = sfdae.solve(
        equations, (0, 2), {"speed": 0, "place": 1}, events=turn, t_eval=[2.0], **EXACT
    )
    assert sol["place"][0] == pytest.approx(1, abs=1e-6)  # cos(2 - t) from there on


def test_large_vectors_of_unknowns():
    """More names than fit into one byte of the code."""
    n = 300
    names = [f"y{i}" for i in range(n)]
    equations = from_text(
        f"def F(t, x, xdot):\n {', '.join(names)} = x\n return [*(xdot - x)[:-1], y{n - 1} - y0]"
    )
    start = {name: 1.0 for name in reversed(names)}
    start["y7"] = 2.0
    sol = sfdae.solve(equations, (0, 0.1), start, t_eval=[0.1])
    assert sol["y7"][0] == pytest.approx(2 * np.exp(0.1), abs=1e-4)
    assert sol["y299"] == pytest.approx(sol["y0"])
