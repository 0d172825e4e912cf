# SPDX-License-Identifier: BSD-3-Clause
"""Sensitivities: x1' = p x2, x2' = -p x1, 0 = z^3 + z - c x1, x1 = x1(0) cos p t."""

import numpy as np
import pytest

import sfdae


def oscillator(t, x, xdot, p=1.5, c=2.0):
    return [xdot[0] - p * x[1], xdot[1] + p * x[0], x[2] ** 3 + x[2] - c * x[0]]


NAMES = ["a", "b", "z"]
TIGHT = {"rtol": 1e-9, "atol": 1e-9}


def exact(t):
    """dx1/dp and dx1/dx1(0)."""
    return np.array([-t * np.sin(1.5 * t), np.cos(1.5 * t)])


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_solve_returns_them_at_outputs(method):
    times = np.linspace(0, 3, 7)
    sol = sfdae.solve(
        oscillator, (0, 3), [1, 0, 0], names=NAMES, t_eval=times, method=method,
        sensitivities=["p", "a"], **TIGHT,
    )
    assert sol.S.shape == (3, 2, 7)
    assert sol.S[0] == pytest.approx(exact(times), abs=1e-6)
    slope = 1 / (3 * sol["z"] ** 2 + 1)
    assert sol.S[2] == pytest.approx(2 * slope * exact(times), abs=1e-6)


def test_every_step_is_an_output_without_times():
    sol = sfdae.solve(oscillator, (0, 1), [1, 0, 0], sensitivities=["p"], **TIGHT)
    assert sol.S.shape == (3, 1, sol.t.size)
    assert sol.S[0, 0] == pytest.approx(exact(sol.t)[0], abs=1e-6)
    assert sfdae.solve(oscillator, (0, 1), [1, 0, 0]).S is None


def test_times_that_do_not_begin_at_the_start():
    sol = sfdae.solve(
        oscillator, (0, 2), [1, 0, 0], t_eval=[0.5, 1.5], sensitivities=["p"], **TIGHT
    )
    assert sol.S[0, 0] == pytest.approx(exact(np.array([0.5, 1.5]))[0], abs=1e-6)


def test_error_test_of_every_method():
    # x rests, dx/dp does not.
    def rests(t, x, xdot, p=0.0):
        return [xdot[0] - p * sfdae.cos(10 * t)]

    for method in ["bdf", "radau", "automatic"]:
        solver = sfdae.Solver(
            sfdae.NonlinearProblem(rests, 1), rtol=1e-6, atol=1e-6, method=method
        )
        for error_test in [False, True]:
            solver.set_sensitivities(["p"], error_test=error_test)
            solver.start(0, [0], 5)
            point = solver.advance(5)
            error = abs(solver.sensitivities(point.t)[0][0, 0] - np.sin(50) / 10)
            assert error < 1e-3 if error_test else error > 1e-2


def test_step_by_step():
    solver = sfdae.Solver(sfdae.NonlinearProblem(oscillator, 3, names=NAMES), **TIGHT)
    solver.set_sensitivities(["c", "a"], directions=np.zeros((3, 2)), error_test=True, scales=[2, 1])
    solver.start(0, [1, 0, 0], 3)
    solver.set_events(lambda t, x, xdot: x[0])
    point = solver.advance(3)
    assert point.status == sfdae.Status.EVENT
    S, Sdot = solver.sensitivities(point.t)
    assert S.shape == Sdot.shape == (3, 2)
    assert Sdot[:2, 1] == pytest.approx([1.5 * S[1, 1], -1.5 * S[0, 1]], abs=1e-8)
    alone, nothing = solver.sensitivities(point.t, slopes=False)
    assert alone == pytest.approx(S, abs=1e-8)
    assert nothing is None
    dt = solver.event_sensitivities(point.t, 0, [1, 0, 0])
    assert dt == pytest.approx([0, 0], abs=1e-6)
    dt = solver.event_sensitivities(point.t, 0, [1, 0, 0], [0, -1])  # of x1 = level
    assert dt[1] == pytest.approx(-1 / 1.5, abs=1e-6)
    assert solver.sensitivity_statistics.count == 2
    solver.set_sensitivities([])
    with pytest.raises(sfdae.Error, match="sfdae_set_sensitivities"):
        solver.sensitivities(point.t)


def test_checkpoints():
    problem = sfdae.NonlinearProblem(oscillator, 3, names=NAMES)
    solvers = [sfdae.Solver(problem, **TIGHT) for _ in range(2)]
    for solver in solvers:
        solver.set_sensitivities(["p", "a"])
    solvers[0].start(0, [1, 0, 0], 3)
    solvers[0].advance(0.7)
    solvers[1].restore_checkpoint(solvers[0].save_checkpoint())
    results = [(solver.advance(3).x, solver.sensitivities(3)[0]) for solver in solvers]
    assert np.array_equal(results[0][0], results[1][0])
    assert np.array_equal(results[0][1], results[1][1])


def test_mistakes_are_named():
    with pytest.raises(sfdae.Error, match="no parameter \"q\""):
        sfdae.solve(oscillator, (0, 1), [1, 0, 0], sensitivities=["q"])


def test_gradients_by_the_adjoint():
    solver = sfdae.Solver(sfdae.NonlinearProblem(oscillator, 3, names=NAMES), **TIGHT)
    solver.set_sensitivities(["p", "a"], adjoint=True)
    solver.start(0, [1, 0, 0], 2)
    z = [solver.advance(t).x[2] for t in (0.5, 2.0)]
    weights = np.zeros((2, 3, 2))
    weights[0] = [[1, 1], [0, 0], [0, 3]]  # x1(0.5) + x1(2) + 3 z(2)
    weights[1, 0, 0] = -1  # -x1(0.5)
    gradient = solver.gradient([0.5, 2.0], weights)
    assert gradient.shape == (2, 2)
    slope = 2 / (3 * z[1] ** 2 + 1)
    assert gradient[0] == pytest.approx(exact(0.5) + (1 + 3 * slope) * exact(2.0), abs=1e-5)
    assert gradient[1] == pytest.approx(-exact(0.5), abs=1e-6)
    assert solver.gradient([0.5, 2.0], weights[0]) == pytest.approx(gradient[0])
    assert solver.gradient(2.0, [1, 0, 0]) == pytest.approx(exact(2.0), abs=1e-6)
    assert solver.sensitivity_statistics.kept_steps > 10
    short = sfdae.Solver(solver.problem, **TIGHT)
    short.set_sensitivities(["p", "a"], adjoint=True, max_kept_steps=40)
    short.start(0, [1, 0, 0], 2)
    for t in (0.5, 2.0):
        short.advance(t)
    assert (short.gradient([0.5, 2.0], weights) == gradient).all()
    assert short.sensitivity_statistics.repeated_steps > 10
    with pytest.raises(ValueError, match="shape"):
        solver.gradient([0.5, 2.0], [1, 0, 0])
    # Within a step, and beyond the last one.
    assert solver.gradient(0.7, [1, 0, 0]) == pytest.approx(exact(0.7), abs=1e-6)
    with pytest.raises(sfdae.Error, match="2.5"):
        solver.gradient(2.5, [1, 0, 0])
    with pytest.raises(sfdae.Error, match="sensitivities"):
        solver.sensitivities(2.0)


@pytest.mark.parametrize("action", [lambda t, x: 1.0 * x, lambda t, x: {"a": 0.5 * x[0]}])
def test_actions_that_change_x_are_refused(action):
    event = sfdae.Event(lambda t, x: t - 1, action=action)
    with pytest.raises(ValueError, match="sfdae.Hybrid"):
        sfdae.solve(
            oscillator, (0, 2), [1, 0, 0], names=NAMES, events=event, sensitivities=["p"], **TIGHT
        )


def test_actions_that_only_look_do_no_harm():
    event = sfdae.Event(lambda t, x: t - 1, action=lambda t, x: None)
    sol = sfdae.solve(
        oscillator, (0, 2), [1, 0, 0], names=NAMES, events=event, sensitivities=["p"], **TIGHT
    )
    assert sol.S[0, 0, -1] == pytest.approx(exact(2)[0], abs=1e-6)
