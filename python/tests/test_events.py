# SPDX-License-Identifier: BSD-3-Clause
"""Events: where they are, in which order, what they do."""

import numpy as np
import pytest

import sfdae
from models import PENDULUM_START, oscillator, pendulum_problem

METHODS = ["bdf", "radau"]
EXACT = {"rtol": 1e-9, "atol": 1e-9}
HALF_PI = np.pi / 2


def zero_of_x(t, x):
    return x[0]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("t_eval", [None, [0, 1, 2, 9], []])
@pytest.mark.parametrize("direction, expected", [(0, [1, 3, 5]), (1, [3]), (-1, [1, 5])])
def test_zeros_of_the_cosine(method, t_eval, direction, expected):
    event = sfdae.Event(zero_of_x, direction=direction)
    sol = sfdae.solve(
        oscillator, (0, 9), [1, 0], events=event, method=method, t_eval=t_eval, **EXACT
    )
    assert sol.success and sol.last.t == 9
    assert sol.t_events[0] == pytest.approx(HALF_PI * np.array(expected), abs=1e-6)
    assert [record.direction for record in sol.events] == [
        -1 if k % 4 == 1 else 1 for k in expected
    ]
    assert sol.x_events[0].shape == (len(expected), 2)
    assert np.abs(sol.x_events[0][:, 0]).max() < 1e-12
    if t_eval is not None:
        assert sol.t.tolist() == t_eval
    else:
        assert set(sol.t_events[0]) <= set(sol.t)


def test_attributes_of_functions_as_in_solve_ivp():
    def event(t, x):
        return x[0]

    event.terminal = True
    event.direction = 1
    sol = sfdae.solve(oscillator, (0, 9), [1, 0], events=event, **EXACT)
    assert sol.status == sfdae.Status.EVENT and sol.success
    assert sol.t[-1] == sol.last.t == sol.t_events[0][0] == pytest.approx(3 * HALF_PI, abs=1e-6)
    assert "event 'event' ended the integration at t = 4.71" in sol.message


@pytest.mark.parametrize("t_eval", [None, np.linspace(0, 9, 10)])
def test_the_second_event_ends(t_eval):
    event = sfdae.Event(zero_of_x, terminal=2)
    sol = sfdae.solve(oscillator, (0, 9), [1, 0], events=event, t_eval=t_eval, **EXACT)
    assert sol.status == sfdae.Status.EVENT and len(sol.events) == 2
    assert sol.last.t == pytest.approx(3 * HALF_PI, abs=1e-6)
    assert sol.t[-1] <= sol.last.t
    if t_eval is None:
        with pytest.raises(ValueError, match="is outside of"):
            sol(sol.last.t + 0.1)


def test_several_events_in_their_order():
    events = [
        lambda t, x: x[0],
        sfdae.Event(lambda t, x, xdot: xdot[0], name="turn"),
        lambda t, x: t - 2.5,
    ]
    sol = sfdae.solve(oscillator, (0, 4), [1, 0], events=events, **EXACT)
    assert [record.index for record in sol.events] == [0, 2, 1]
    assert [record.t for record in sol.events] == pytest.approx([HALF_PI, 2.5, np.pi], abs=1e-6)
    assert sol.events[2].name == "turn"
    assert [times.size for times in sol.t_events] == [1, 1, 1]


def test_no_events():
    sol = sfdae.solve(oscillator, (0, 1), [1, 0], events=[zero_of_x])
    assert sol.events == [] and sol.t_events[0].size == 0 and sol.x_events[0].shape == (0, 2)
    assert sfdae.solve(oscillator, (0, 1), [1, 0], events=[]).t_events == []


def bead(t, x, xdot, g=9.81):
    """A bead on the wire y = x."""
    return [xdot[0] - x[2], xdot[1] - x[3], xdot[2] + x[4], xdot[3] + g - x[4], x[1] - x[0]]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("t_eval", [None, np.linspace(0, 3, 31)])
def test_a_bead_bounces(method, t_eval):
    """Falls for T = 2 / sqrt(g), then flies for 2 r T, 2 r^2 T, ...; the velocities are (-r) times
    those before.
    """
    r, T = 0.8, 2 / np.sqrt(9.81)
    stop = sfdae.Event(lambda t, x: x[1], direction=-1, action=lambda t, x: x * [1, 1, -r, -r, 1])
    sol = sfdae.solve(
        bead, (0, 3), [1, 1, 0, 0, 0], events=stop, method=method, t_eval=t_eval, **EXACT
    )
    impacts = T + np.concatenate([[0], np.cumsum(2 * T * r ** np.arange(1, 20))])
    assert sol.success and sol.t_events[0] == pytest.approx(impacts[impacts <= 3], abs=1e-5)
    flight = np.searchsorted(impacts, sol.t - 1e-9)
    start = np.where(flight > 0, impacts[np.maximum(flight - 1, 0)], -T)
    speed = np.where(flight > 0, 9.81 * T / 2 * r ** np.maximum(flight, 0), 9.81 * T / 2)
    height = speed * (sol.t - start) - 9.81 / 4 * (sol.t - start) ** 2
    assert sol.x[1] == pytest.approx(height, abs=1e-4)
    assert np.abs(sol.x[0] - sol.x[1]).max() < 1e-12
    if t_eval is None:  # both points of an impact, and the dense output has the later one
        k = int(np.flatnonzero(sol.t == sol.t_events[0][0])[0])
        assert sol.t[k] == sol.t[k + 1] and sol.x[3, k + 1] == pytest.approx(-r * sol.x[3, k])
        assert sol(sol.t[k])[3] == pytest.approx(sol.x[3, k + 1])
        assert sol(sol.t[k] - 1e-9)[3] == pytest.approx(sol.x[3, k], abs=1e-6)


def test_an_action_may_look_and_leave_everything():
    seen = []
    event = sfdae.Event(zero_of_x, action=lambda t, x, xdot: seen.append((t, xdot[0])))
    plain = sfdae.solve(oscillator, (0, 9), [1, 0], events=zero_of_x)
    sol = sfdae.solve(oscillator, (0, 9), [1, 0], events=event)
    assert len(seen) == 3 and np.array_equal(sol.x, plain.x)


@pytest.mark.parametrize("t_eval", [None, [1.0]])
def test_an_exception_in_an_event(t_eval):
    def event(t, x):
        raise ArithmeticError("no event") if t > 0.5 else None

    with pytest.raises((ArithmeticError, ValueError)):
        sfdae.solve(oscillator, (0, 1), [1, 0], events=lambda t, x: "a", t_eval=t_eval)
    with pytest.raises((ArithmeticError, TypeError)):
        sfdae.solve(oscillator, (0, 1), [1, 0], events=event, t_eval=t_eval)


def test_wrong_events():
    with pytest.raises(TypeError, match="has to be a function"):
        sfdae.solve(oscillator, (0, 1), [1, 0], events=[3])
    with pytest.raises(ValueError, match="event pair returned .* not a number"):

        def pair(t, x):
            return [1.0, 2.0]

        sfdae.solve(oscillator, (0, 1), [1, 0], events=pair)
    with pytest.raises(ValueError, match="bool or a number"):
        sfdae.Event(zero_of_x, terminal=-1)


def test_wrong_values_of_an_action():
    event = sfdae.Event(zero_of_x, action=lambda t, x: [1.0])
    with pytest.raises(ValueError, match="x of the action of event 'zero_of_x' has shape"):
        sfdae.solve(oscillator, (0, 9), [1, 0], events=event)


def test_values_that_an_action_leaves_inconsistent_are_reported():
    """Only one of both velocities is reversed: the wire does not allow that."""
    stop = sfdae.Event(lambda t, x: x[1], direction=-1, action=lambda t, x: x * [1, 1, 1, -0.8, 1])
    # Before the next impact, at 0.698: pytest 8 hands on warnings that do not match.
    with pytest.warns(sfdae.InitialValuesWarning, match="after an event at t = 0.638"):
        sol = sfdae.solve(bead, (0, 0.69), [1, 1, 0, 0, 0], events=stop)
    assert np.abs(sol.x[2] - sol.x[3]).max() < 1e-12


def test_an_event_at_an_output():
    sol = sfdae.solve(
        oscillator, (0, 2), [1, 0], events=lambda t, x: t - 1.0, t_eval=[0.5, 1.0, 1.5], **EXACT
    )
    assert sol.t_events[0] == pytest.approx([1.0]) and sol.x[0] == pytest.approx(
        np.cos(sol.t), abs=1e-6
    )


def test_turning_points_of_the_pendulum():
    sol = sfdae.solve(
        pendulum_problem(), (0, 5), PENDULUM_START, events=lambda t, x: x[2], rtol=1e-8, atol=1e-8
    )
    assert np.abs(sol.x_events[0][:, 0]) == pytest.approx(0.6, abs=1e-5)
