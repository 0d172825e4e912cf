# SPDX-License-Identifier: BSD-3-Clause
"""sfdae.solve: outputs, dense output, options, progress, what happens when it ends early."""

import os
import pickle
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

import sfdae
from models import (
    PENDULUM_NAMES,
    PENDULUM_START,
    energy,
    forced_mass,
    oscillator,
    pendulum,
    pendulum_problem,
)

METHODS = ["bdf", "radau", "automatic"]
Status = sfdae.Status


def oscillation(t):
    return np.array([np.cos(t), -np.sin(t)])


# ---- Outputs -------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("t_span", [(0, 4), (4, 0), (-2, 2)])
def test_outputs_at_given_times(method, t_span):
    times = np.linspace(*t_span, 9)
    sol = sfdae.solve(
        oscillator,
        t_span,
        oscillation(t_span[0]),
        method=method,
        t_eval=times,
        rtol=1e-9,
        atol=1e-9,
    )
    assert sol.success and sol.status == Status.OK
    assert np.array_equal(sol.t, times)
    assert sol.x.shape == sol.xdot.shape == (2, 9)
    assert sol.x == pytest.approx(oscillation(times), abs=1e-6)
    assert sol.xdot[0] == pytest.approx(sol.x[1], abs=1e-6)
    assert sol.dense is None
    with pytest.raises(ValueError, match="dense_output=True"):
        sol(1.0)


@pytest.mark.parametrize("method", METHODS)
def test_outputs_at_the_ends_of_steps(method):
    sol = sfdae.solve(oscillator, (0, 4), [1, 0], method=method, rtol=1e-8, atol=1e-8)
    assert sol.t[0] == 0 and sol.t[-1] == 4
    assert np.all(np.diff(sol.t) > 0)
    assert sol.steps.t.size == sol.report.statistics.steps == sol.t.size - 1
    assert sol.x == pytest.approx(oscillation(sol.t), abs=1e-5)
    assert sol.last.t == 4 and np.array_equal(sol.last.x, sol.x[:, -1])
    assert set(sol.steps.order) <= set(range(1, 14))


@pytest.mark.parametrize("dense_output", [False, True])
@pytest.mark.parametrize("times", [[], [0.0], [1.0], [0.0, 1.0], [0.5], [0.25, 0.5]])
def test_few_outputs(times, dense_output):
    sol = sfdae.solve(
        oscillator, (0, 1), [1, 0], t_eval=times, dense_output=dense_output, rtol=1e-8, atol=1e-8
    )
    assert sol.t.tolist() == times and sol.x.shape == (2, len(times))
    assert sol.x == pytest.approx(oscillation(sol.t), abs=1e-5)
    assert sol.last.t == 1.0


@pytest.mark.parametrize(
    "arguments, text",
    [
        (dict(t_span=(0, 0)), "two different finite times"),
        (dict(t_span=(0, np.inf)), "two different finite times"),
        (dict(t_span=(0, 1, 2)), r"has to be \(start, end\)"),
        (dict(t_span=1), r"has to be \(start, end\)"),
        (dict(t_eval=[0, 2]), "outside of t_span"),
        (dict(t_eval=[np.nan]), "outside of t_span"),
        (dict(t_eval=[1, 0]), "order of integration"),
        (dict(t_eval=[0, 0]), "without repetitions"),
        (dict(t_eval=[[0, 1]]), "vector of times"),
        (dict(method="euler"), "method has to be one of automatic, bdf, radau"),
        (dict(rtol=[1e-6] * 3), r"rtol has shape \(3,\), not \(2,\)"),
        (dict(fixed=[True, False, True]), "3 flags for 2 unknowns"),
    ],
)
def test_wrong_values_of_arguments(arguments, text):
    with pytest.raises(ValueError, match=text):
        sfdae.solve(oscillator, **{"t_span": (0, 1), "x0": [1, 0], **arguments})


def test_wrong_names_of_arguments():
    with pytest.raises(TypeError, match="no option 'max_stepp'; did you mean 'max_step'"):
        sfdae.solve(oscillator, (0, 1), [1, 0], max_stepp=1)
    with pytest.raises(TypeError, match="no option 'zzz'; there are rtol, atol"):
        sfdae.solve(oscillator, (0, 1), [1, 0], zzz=1)
    with pytest.raises(TypeError, match="a problem or a function"):
        sfdae.solve([1], (0, 1), [1, 0])
    with pytest.raises(TypeError, match="names and units belong to the problem"):
        sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START, names=PENDULUM_NAMES)
    with pytest.raises(TypeError, match="max_order has to be an integer"):
        sfdae.solve(oscillator, (0, 1), [1, 0], max_order=2.5)


def test_ranges_are_checked_by_the_library():
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT: .*rtol"):
        sfdae.solve(oscillator, (0, 1), [1, 0], rtol=-1.0)
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT: rtol of u is 2"):
        sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START, rtol=[0, 0, 2, 0, 0])


def test_every_option_of_the_library_can_be_set():
    defaults = {
        name: getattr(sfdae._options.c_options(pendulum_problem(), {}, []), name)
        for name in sfdae.OPTION_NAMES
    }
    numbers = {name: value for name, value in defaults.items() if isinstance(value, (int, float))}
    assert {"rtol", "max_index", "stop_time", "min_stages"} <= numbers.keys()
    sfdae.Solver(pendulum_problem(), **numbers)
    assert sfdae.choices("method") == {"bdf": 0, "radau": 1, "automatic": 2}


def test_nothing_is_evaluated_beyond_the_end():
    latest = []

    def f(t, order):
        latest.append(t)
        return [np.cos(t + order * np.pi / 2)]

    sfdae.solve(sfdae.LinearProblem([[1.0]], [[0.0]], f), (0, 1), [0.0])
    assert max(latest) <= 1.0


# ---- Names ---------------------------------------------------------------------------------------


def test_names_of_the_solution():
    sol = sfdae.solve(pendulum_problem(units={"px": "m"}), (0, 1), PENDULUM_START)
    assert np.array_equal(sol["lambda"], sol.x[4])
    assert np.array_equal(sol["t"], sol.t)
    assert sol.names == tuple(PENDULUM_NAMES) and sol.units == {"px": "m"}
    with pytest.raises(KeyError, match="no unknown 'force'; there are px"):
        sol["force"]


def test_names_from_a_dictionary_of_values():
    def equations(t, x, xdot):
        place, speed = x
        return [xdot[0] - speed, xdot[1] + place]

    sol = sfdae.solve(equations, (0, 1), {"place": 1.0, "speed": 0.0})
    assert sol.names == ("place", "speed")


def test_frames():
    pandas = pytest.importorskip("pandas")
    frame = sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START, t_eval=[0, 1]).to_frame()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == PENDULUM_NAMES and frame.index.tolist() == [0, 1]


def test_a_solution_shows_what_it_is_and_can_be_pickled():
    sol = sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START, events=lambda t, x: x[0])
    assert "strangeness index 2" in repr(sol) and "success: True" in repr(sol)
    again = pickle.loads(pickle.dumps(sol))
    assert np.array_equal(again.x, sol.x) and np.array_equal(again(0.5), sol(0.5))
    assert again.report.characteristics == sol.report.characteristics


# ---- Initial values ------------------------------------------------------------------------------


def test_wrong_initial_values_are_corrected_with_a_warning_that_names_them():
    with pytest.warns(sfdae.InitialValuesWarning, match="most of all p. changed"):
        sol = sfdae.solve(pendulum_problem(), (0, 1), {"px": 0.6, "py": -0.9})
    assert sol.x[0, 0] ** 2 + sol.x[1, 0] ** 2 == pytest.approx(1, abs=1e-14)
    assert "changed" in sol.message


def test_fixed_values_stay():
    sol = sfdae.solve(pendulum_problem(), (0, 1), {"px": 0.6, "py": -0.9}, fixed=["px"])
    assert sol.x[0, 0] == 0.6 and sol.x[1, 0] == pytest.approx(-0.8)
    same = sfdae.make_consistent(
        pendulum_problem(), 0, {"px": 0.6, "py": -0.9}, fixed=[True] + 4 * [False]
    )
    assert same.x[:2] == pytest.approx([0.6, -0.8])


def test_contradicting_fixed_values_are_an_error():
    with pytest.raises(sfdae.Error) as caught:
        sfdae.solve(pendulum_problem(), (0, 1), {"px": 0.6, "py": -0.9}, fixed=["px", "py"])
    assert caught.value.status in (Status.FIXED_VALUES, Status.NO_CONSISTENT_VALUES)


def test_make_consistent_of_a_function():
    point = sfdae.make_consistent(forced_mass, 0.5, [np.sin(0.5), np.cos(0.5), 0.0])
    assert point.x == pytest.approx([np.sin(0.5), np.cos(0.5), -np.sin(0.5)], abs=1e-14)
    assert point.xdot == pytest.approx([np.cos(0.5), -np.sin(0.5), -np.cos(0.5)], abs=1e-12)


def test_a_guess_of_the_derivative_chooses_a_solution():
    """x'^2 = 1: two solutions."""
    for guess in (1.0, -1.0):
        sol = sfdae.solve(
            lambda t, x, xdot: [xdot[0] ** 2 - 1], (0, 1), [0.0], xdot0=[guess], t_eval=[1.0]
        )
        assert sol.x[0, 0] == pytest.approx(guess, abs=1e-9)


def test_solutions_that_are_not_unique_are_reported():
    problem = sfdae.NonlinearProblem(lambda t, x, xdot: [xdot[0] - x[1]], 2, num_equations=1)
    with pytest.warns(sfdae.InitialValuesWarning, match="not unique"):
        sfdae.solve(problem, (0, 1), [0, 1])


# ---- Dense output --------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("tol", [1e-4, 1e-7, 1e-10])
@pytest.mark.parametrize("t_span", [(0, 6), (6, 0)])
def test_dense_output_is_as_accurate_as_the_outputs(method, tol, t_span):
    sol = sfdae.solve(oscillator, t_span, oscillation(t_span[0]), method=method, rtol=tol, atol=tol)
    times = np.linspace(*t_span, 1001)
    error_at_outputs = np.abs(sol.x - oscillation(sol.t)).max()
    error = np.abs(sol(times) - oscillation(times)).max()
    # |x| <= 1: rtol |x| + atol <= 2 tol. What the integrator's own interpolation may err by comes
    # on top.
    assert error <= error_at_outputs + (max(sol.dense.accuracy, 0.3) + 1) * 2 * tol
    assert sol.dense.accuracy < 10


@pytest.mark.parametrize("method", METHODS)
def test_dense_output_agrees_with_outputs_of_the_same_steps(method):
    with_outputs = sfdae.solve(
        pendulum_problem(),
        (0, 3),
        PENDULUM_START,
        t_eval=np.linspace(0, 3, 50),
        dense_output=True,
        method=method,
    )
    weights = 1e-6 * np.abs(with_outputs.x) + 1e-6
    differences = np.abs(with_outputs(with_outputs.t) - with_outputs.x) / weights
    assert differences.max() <= max(with_outputs.dense.accuracy, 0.3) + 1


def test_dense_output_is_exact_at_the_ends_of_steps():
    sol = sfdae.solve(oscillator, (0, 6), [1, 0])
    assert sol(sol.t) == pytest.approx(sol.x, abs=1e-13)
    # The slope of a polynomial of degree 4 or more that errs by up to a tolerance, in steps > 0.01.
    assert sol.derivative(sol.t) == pytest.approx(sol.xdot, abs=16 * 2e-6 / 0.01)


def test_dense_output_without_differential_equations():
    """A single step from 0 to 20, in which the solution oscillates."""
    sol = sfdae.solve(forced_mass, (0, 20), [0, 1, 0])
    times = np.linspace(0, 20, 777)
    assert np.abs(sol(times)[2] + np.sin(times)).max() < 1e-6
    assert sol.steps.t.size == 1 and sol.dense.accuracy <= 0.3


def test_a_jump_within_a_step_is_reported():
    def equations(t, x, xdot):
        return [x[0] - np.where(x[1] > np.pi, 1.0, 0.0), xdot[1] - 1.0]

    with pytest.warns(sfdae.IntegrationWarning, match="dense output differs .* jump or a kink"):
        sol = sfdae.solve(equations, (0, 7), [0.0, 0.0])
    assert sol.dense.accuracy > 10
    assert sol([1.0, 3.1, 3.2])[0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)


def test_a_step_of_t_is_no_jump_within_a_step():
    sol = sfdae.solve(lambda t, x, xdot: [x[0] - np.where(t > np.pi, 1.0, 0.0)], (0, 7), [0.0])
    assert sol([1.0, 3.1, 3.2])[0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)


# Two equal capacitors in a divider, the lower one with a resistor: half of the step gets through, in no time.
@pytest.mark.parametrize("method", ["bdf", "radau"])
@pytest.mark.parametrize(
    "step",
    [
        lambda t: np.where(t > 1, 1, 0),
        lambda t: np.clip(np.floor(t), 0, 1),
        lambda t: np.where((t % 2 >= 1) & (t < 2), 1, 0),
        lambda t: np.clip((t - 1) / 1e-6, 0, 1),
        lambda t: (1 + np.sign(t - 1)) / 2,
    ],
)
def test_steps_that_are_differentiated_jump_by_impulses(step, method):
    def divider(t, x, xdot):
        (i, vs, vm), (_, dvs, dvm) = x, xdot
        return [i - (dvs - dvm), (dvs - dvm) - dvm - vm, vs - step(t)]

    sol = sfdae.solve(divider, (0, 1.9), [0, 0, 0], method=method)
    assert sol.x[2][-1] == pytest.approx(0.5 * np.exp(-0.45), abs=2e-5)


@pytest.mark.parametrize("t", [-0.1, 1.1, np.nan, [0.5, 2.0]])
def test_dense_output_ends_where_the_run_ended(t):
    sol = sfdae.solve(oscillator, (0, 1), [1, 0])
    with pytest.raises(ValueError, match="is outside of"):
        sol(t)
    assert (sol.dense.t_min, sol.dense.t_max) == (0, 1)


def test_shapes_of_dense_output():
    sol = sfdae.solve(oscillator, (0, 1), [1, 0])
    assert sol(0.5).shape == (2,)
    assert sol([0.7, 0.2, 0.9]).shape == (2, 3)
    assert sol([]).shape == (2, 0)
    assert np.array_equal(sol([0.7, 0.2])[:, 1], sol(0.2))
    assert sol.derivative(0.5)[0] == pytest.approx(sol(0.5)[1], abs=1e-6)
    with pytest.raises(ValueError, match="number or a vector"):
        sol([[0.1]])


def test_dense_output_is_saved_and_loaded():
    sol = sfdae.solve(oscillator, (0, 3), [1, 0], t_eval=[1.0], dense_output=True)
    times = np.linspace(0, 3, 100)
    for copy in (
        sfdae.RecordedSolution.load(sol.dense.save()),
        pickle.loads(pickle.dumps(sol.dense)),
    ):
        assert np.array_equal(copy(times), sol(times))
        assert (copy.t_max, copy.accuracy) == (sol.dense.t_max, sol.dense.accuracy)


def test_dense_output_changes_nothing():
    times = np.linspace(0, 3, 20)
    with_it, without = (
        sfdae.solve(oscillator, (0, 3), [1, 0], t_eval=times, dense_output=dense)
        for dense in (True, False)
    )
    assert np.array_equal(with_it.x, without.x) and with_it.dense and without.dense is None


def test_dense_output_of_one_step():
    sol = sfdae.solve(
        oscillator, (0, 1), [1, 0], monitor=lambda progress: True, dense_output=True
    )
    assert not sol.success and len(sol.t) == 2 and sol.dense.t_max == sol.t[-1]
    assert sol(sol.t[-1] / 2)[0] == pytest.approx(np.cos(sol.t[-1] / 2), abs=1e-6)


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_dense_output_without_steps(method):
    def nowhere(t, x, xdot):
        return [xdot[0] - sfdae.sqrt(-t)]

    with pytest.warns(sfdae.IntegrationWarning, match="sqrt of -"):
        sol = sfdae.solve(nowhere, (0, 1), [1], method=method, dense_output=True)
    assert list(sol.t) == [0] and sol.dense.is_empty
    with pytest.raises(ValueError, match="no step was taken"):
        sol(0.0)


def test_recorded_solution_of_no_run():
    empty = sfdae.RecordedSolution()
    assert empty.is_empty
    for ask in (lambda: empty.t_min, lambda: empty.accuracy, lambda: empty.cut(0.0)):
        with pytest.raises(sfdae.Error, match="nothing was recorded"):
            ask()


# ---- Ends before the end -------------------------------------------------------------------------


def explosion(t, x, xdot):
    """x' = x^2, x(0) = 1: x = 1 / (1 - t)."""
    return [xdot[0] - x[0] ** 2]


@pytest.mark.parametrize("t_eval", [None, [0, 0.5, 2]])
def test_a_failure_returns_what_there_is(t_eval):
    with pytest.warns(sfdae.IntegrationWarning, match="the integration ended at t = 0.99|1.0"):
        sol = sfdae.solve(explosion, (0, 2), [1.0], t_eval=t_eval, max_steps=3000)
    assert not sol.success and sol.status < 0
    assert sol.last.t == pytest.approx(1.0, abs=0.01)
    if t_eval:
        assert sol.t.tolist() == [0, 0.5] and sol.x[0, 1] == pytest.approx(2.0, abs=1e-4)
    else:
        assert sol(0.5)[0] == pytest.approx(2.0, abs=1e-4)


def test_a_problem_that_cannot_be_started_is_an_error():
    with pytest.raises(sfdae.Error) as caught:
        sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START, max_index=1)
    assert caught.value.status == Status.INDEX_TOO_HIGH
    assert pickle.loads(pickle.dumps(caught.value)).status == Status.INDEX_TOO_HIGH
    with pytest.raises(sfdae.Error) as caught:
        sfdae.analyze(pendulum_problem(), 0.0, PENDULUM_START, max_index=1)
    assert caught.value.report.decisions


@pytest.mark.parametrize("t_eval", [None, np.linspace(0, 50, 5)])
def test_a_monitor_stops(t_eval):
    seen = []

    def monitor(progress):
        seen.append(progress)
        return progress.steps >= 7

    sol = sfdae.solve(pendulum_problem(), (0, 50), PENDULUM_START, monitor=monitor, t_eval=t_eval)
    assert sol.status == Status.STOPPED and not sol.success
    assert [progress.steps for progress in seen] == list(range(1, 8))
    assert sol.last.t == seen[-1].t and sol.last.x == pytest.approx(seen[-1].x, abs=1e-12)
    assert "stopped at t" in sol.message


@pytest.mark.parametrize("t_eval", [None, [0, 1e9]])
@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_ctrl_c_returns_what_there_is(t_eval, method):
    """The signal comes while the library integrates recorded equations: no Python code runs but the
    monitor.
    """
    has_started, has_ended = threading.Event(), threading.Event()

    def press_ctrl_c():
        has_started.wait()
        os.kill(os.getpid(), signal.SIGINT)
        while not has_ended.wait(10):  # a busy interpreter may lose it, for example in a destructor
            os.kill(os.getpid(), signal.SIGINT)

    def monitor(progress):
        if progress.steps == 10:
            has_started.set()

    thread = threading.Thread(target=press_ctrl_c)
    thread.start()
    sol = sfdae.solve(
        pendulum_problem(),
        (0, 1e9),
        PENDULUM_START,
        t_eval=t_eval,
        method=method,
        max_steps=10**9,
        monitor=monitor,
    )
    has_ended.set()
    thread.join()
    assert sol.status == Status.STOPPED and "interrupted" in sol.message
    assert 0 < sol.last.t < 1e9
    if t_eval is None:
        assert sol.t[-1] == sol.last.t and sol(sol.last.t) == pytest.approx(
            sol.last.x, rel=1e-6, abs=1e-6
        )


def test_ctrl_c_in_an_event_function():
    def event(t, x):
        if t > 1:
            raise KeyboardInterrupt
        return 1.0

    sol = sfdae.solve(oscillator, (0, 10), [1, 0], events=event)
    assert sol.status == Status.STOPPED and sol.t[-1] <= sol.last.t < 10


def test_other_exceptions_of_a_monitor_are_raised():
    def monitor(progress):
        raise LookupError("lost")

    with pytest.raises(LookupError, match="lost") as caught:
        sfdae.solve(oscillator, (0, 10), [1, 0], monitor=monitor)
    assert any(entry.name == "monitor" for entry in caught.traceback)


# ---- The limit of steps --------------------------------------------------------------------------


def attempts(sol):
    statistics = sol.report.statistics
    return statistics.steps + statistics.error_failures + statistics.other_failures


LIMITED = [dict(), dict(t_eval=[100]), dict(t_eval=np.linspace(0, 100, 1001)), dict(t_eval=[])]
LIMITED += [dict(sensitivities=["k"]), dict(t_eval=[1, 50, 100], sensitivities=["k"])]


@pytest.mark.parametrize("method", ["bdf", "radau"])
@pytest.mark.parametrize("arguments", LIMITED)
def test_max_steps_limits_the_whole_run(method, arguments):
    limit = 100 if method == "bdf" else 15
    text = rf"ended at t = .*: {limit} steps attempted .*, the limit max_steps, .* t = 100\."
    with pytest.warns(sfdae.IntegrationWarning, match=text):
        sol = sfdae.solve(
            oscillator, (0, 100), [1, 0], method=method, max_steps=limit, rtol=1e-8, **arguments
        )
    assert sol.status == Status.MAX_STEPS and not sol.success
    assert attempts(sol) == limit
    assert 0 < sol.last.t < 100 and sol.last.t == sol.steps.t[-1]
    assert sol.last.x == pytest.approx(oscillation(sol.last.t), abs=1e-4)
    assert sol.x == pytest.approx(oscillation(sol.t), abs=1e-4)
    if "t_eval" in arguments:
        times = np.array(arguments["t_eval"])
        assert sol.t.tolist() == times[times <= sol.last.t].tolist()
    else:
        assert sol.t[-1] == sol.last.t and sol(sol.last.t / 2) == pytest.approx(
            oscillation(sol.last.t / 2), abs=1e-4
        )
    if "sensitivities" in arguments:
        assert sol.S.shape == (2, 1, sol.t.size)


@pytest.mark.parametrize("t_eval", [None, [0.5, 3.0, 10.0], np.linspace(0, 10, 301)])
def test_the_same_steps_below_the_limit(t_eval):
    plain = sfdae.solve(oscillator, (0, 10), [1, 0], t_eval=t_eval)
    needed = attempts(plain)
    enough = sfdae.solve(oscillator, (0, 10), [1, 0], t_eval=t_eval, max_steps=needed)
    assert enough.success and np.array_equal(enough.x, plain.x)
    assert np.array_equal(enough.steps.t, plain.steps.t)
    with pytest.warns(sfdae.IntegrationWarning, match=f"{needed - 1} steps"):
        less = sfdae.solve(oscillator, (0, 10), [1, 0], t_eval=t_eval, max_steps=needed - 1)
    assert less.status == Status.MAX_STEPS and attempts(less) == needed - 1
    assert np.array_equal(less.x, plain.x[:, : less.t.size]) and less.t.size < plain.t.size


@pytest.mark.parametrize("t_eval", [None, np.linspace(0, 100, 11)])
def test_max_steps_counts_those_before_restarts(t_eval):
    """Each zero turns the solution around, and the integration begins anew."""
    turn = sfdae.Event(lambda t, x: x[0], action=lambda t, x: [1.0, 0.0])
    with pytest.warns(sfdae.IntegrationWarning, match="500 steps attempted in the whole run"):
        sol = sfdae.solve(
            oscillator, (0, 100), [1, 0], events=turn, max_steps=500, t_eval=t_eval
        )
    assert sol.status == Status.MAX_STEPS and len(sol.events) > 5
    # The steps in which an event lies go beyond it, and those are attempted, too.
    assert 400 < sol.steps.t.size <= 500


def friction(t, x, xdot):
    """A block on a table that is pulled less than friction holds: it comes to rest."""
    place, speed = x
    return [xdot[0] - speed, xdot[1] + np.sign(speed) - 0.5 * np.sin(t)]


@pytest.mark.parametrize("t_eval", [None, [10.0]])
@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_friction_that_holds(t_eval, method):
    """Both branches of the sign lead back to rest, where the block stays."""
    sol = sfdae.solve(friction, (0, 10), [0, 1e-3], t_eval=t_eval, method=method)
    assert sol.success and attempts(sol) < 500
    assert abs(sol.last.x[1]) < 1e-6 and 4.9e-7 < sol.last.x[0] < 2e-5


def wild(t, x, xdot):
    """The solution changes within the first steps by far more than the tolerances."""
    return [xdot[0] - 1e6 * np.cos(1e6 * t)]


@pytest.mark.parametrize("t_eval", [None, [10.0]])
def test_equations_that_are_too_fast_end_at_the_limit(t_eval):
    with pytest.warns(sfdae.IntegrationWarning):
        sol = sfdae.solve(wild, (0, 10), [0.0], t_eval=t_eval, max_steps=2000)
    assert not sol.success and attempts(sol) <= 2000


def test_the_limit_without_max_steps(monkeypatch):
    """Without t_eval there is one, too."""
    original = sfdae._solver.c_options

    def small(*arguments):
        c = original(*arguments)
        if c.max_steps == 100000:
            c.max_steps = 50
        return c

    monkeypatch.setattr(sfdae._solver, "c_options", small)
    with pytest.warns(sfdae.IntegrationWarning, match="50 steps attempted in the whole run"):
        sol = sfdae.solve(oscillator, (0, 100), [1, 0])
    assert sol.status == Status.MAX_STEPS and attempts(sol) == 50
    assert sfdae.solve(oscillator, (0, 10), [1, 0], t_eval=np.linspace(0, 10, 11)).success
    with pytest.warns(sfdae.IntegrationWarning, match="50 steps attempted without reaching tout"):
        sfdae.solve(oscillator, (0, 100), [1, 0], t_eval=[100.0])
    monkeypatch.setattr(sfdae._run, "_SPANS_OF_RUN", 3)
    with pytest.warns(sfdae.IntegrationWarning, match="150 steps attempted in the whole run"):
        sol = sfdae.solve(oscillator, (0, 100), [1, 0], t_eval=np.linspace(0, 100, 1001))
    assert sol.status == Status.MAX_STEPS and attempts(sol) == 150
    assert sol.t[-1] < sol.last.t < sol.t[-1] + 0.1


def test_many_steps_between_many_outputs_end_at_the_limit(monkeypatch):
    """Never 100,000 attempts between two outputs, but at each of them."""
    monkeypatch.setattr(sfdae._run, "_SPANS_OF_RUN", 1)
    with pytest.warns(sfdae.IntegrationWarning, match="100000 steps attempted in the whole run"):
        sol = sfdae.solve(oscillator, (0, 1), [1, 0], t_eval=np.arange(0, 1, 1e-4), max_step=2e-6)
    assert sol.status == Status.MAX_STEPS


@pytest.mark.parametrize("max_steps", [0, -1, 2.5])
def test_wrong_limits(max_steps):
    with pytest.raises((sfdae.Error, TypeError), match="max_steps"):
        sfdae.solve(oscillator, (0, 1), [1, 0], max_steps=max_steps)


# ---- Progress ------------------------------------------------------------------------------------


def test_a_progress_bar(capsys):
    pytest.importorskip("tqdm")
    sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START, progress=True)
    text = capsys.readouterr().err
    assert "100%" in text and "t=1," in text and "steps" in text


def test_a_progress_bar_without_tqdm(capsys, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "tqdm", None)
    sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START, progress=True)
    text = capsys.readouterr().err
    assert "100.0 %" in text and text.endswith("\n")


def test_nothing_is_printed_otherwise(capfd):
    sfdae.solve(pendulum, (0, 1), [0.6, -0.8, 0, 0, 0])
    assert capfd.readouterr() == ("", "")


def test_the_energy_is_kept():
    sol = sfdae.solve(
        pendulum_problem(), (0, 10), PENDULUM_START, method="radau", rtol=1e-10, atol=1e-10
    )
    assert np.abs(energy(sol.x)).max() < 1e-8
    px, py, u, v, _ = sol.x
    assert np.abs(px**2 + py**2 - 1).max() < 1e-13 and np.abs(px * u + py * v).max() < 1e-12


def test_notes_events_and_the_end_are_logged(caplog):
    """Of the logger sfdae, level INFO; nothing is seen unless it is asked for."""

    with caplog.at_level("INFO", logger="sfdae"):
        sfdae.solve(lambda t, x, xdot: xdot - 1, (0, 1), [0.0], events=lambda t, x: x[0] - 0.5)
        with pytest.warns(sfdae.InitialValuesWarning):
            sfdae.solve(lambda t, x, xdot: [xdot[0] - x[1], x[0] - np.sin(t)], (0, 1), [1.0, 0.0])
    texts = [record.getMessage() for record in caplog.records]
    assert texts[0].endswith("at t = 0.5") and texts[1] == "the end of the interval was reached"
    assert "adjusted" in texts[2] or "changed" in texts[2]
    assert all(record.levelname == "INFO" for record in caplog.records)


def test_the_module_prints_versions_and_files():
    result = subprocess.run(
        [sys.executable, "-m", "sfdae"], capture_output=True, text=True, check=True
    )
    lines = dict(line.split(maxsplit=1) for line in result.stdout.splitlines())
    assert lines["sfdae"] == sfdae.version() and lines["numpy"] == np.__version__
    assert lines["module"].endswith(".so") and result.stderr == ""


def test_max_seconds_limits_the_whole_run():
    def oscillation(t, x, xdot):
        return [xdot[0] - x[1], xdot[1] + x[0]]

    with pytest.raises(sfdae.Error, match="max_seconds") as failure:
        sfdae.solve(oscillation, (0, 1), [1, 0], max_seconds=1e-9)
    assert failure.value.status == sfdae.Status.STOPPED
    for t_eval in (None, np.linspace(0, 1e9, 100_001)):
        with pytest.warns(sfdae.IntegrationWarning, match="max_seconds"):
            sol = sfdae.solve(
                oscillation, (0, 1e9), [1, 0], max_seconds=0.2, max_steps=10**9, t_eval=t_eval
            )
        assert sol.status == sfdae.Status.STOPPED and 0 <= sol.t[-1] < 1e9
    assert sfdae.solve(oscillation, (0, 1), [1, 0], max_seconds=1e6).success
