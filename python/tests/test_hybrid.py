# SPDX-License-Identifier: BSD-3-Clause
"""Hybrid systems: transitions, jumps, accumulation, exceptions."""

import numpy as np
import pytest

import sfdae


def capacitors(t, x, xdot, closed=0.0):
    v1, v2, i = x
    return [xdot[0] + v1 + i, 3 * xdot[1] - i, closed * (v1 - v2) + (1 - closed) * i]


def switched(*transitions, **options):
    problem = sfdae.NonlinearProblem(capacitors, 3, names=["v1", "v2", "i"])
    return sfdae.Hybrid(
        {"open": problem, "closed": sfdae.Solver(problem, parameters={"closed": 1.0}, **options)},
        transitions,
        **options,
    )


def ball(e, **options):
    problem = sfdae.NonlinearProblem(lambda t, x, xdot: [xdot[0] - x[1], xdot[1] + 9.81], 2)
    bounce = sfdae.Transition(
        "flight", "flight", zero=lambda t, x: x[0], direction=-1, jump=lambda t, x: [0, -e * x[1]]
    )
    return sfdae.Hybrid({"flight": problem}, [bounce], **options)


def test_charge_is_kept():
    close = sfdae.Transition("open", "closed", lambda t, x: 2 - x[0] + x[1])
    system = switched(close, rtol=1e-9, atol=1e-9)
    solution = sfdae.RecordedSolution()
    system.record(solution)
    system.start("open", 0, {"v1": 4}, 2)
    point = system.advance_to_transition(2)
    assert point.status == sfdae.Status.EVENT
    assert point.t == pytest.approx(np.log(2), abs=1e-7)
    assert point.x[:2] == pytest.approx([0.5, 0.5], abs=1e-7)
    assert system.mode == "closed"
    checkpoint = system.save_checkpoint()
    end = system.advance(2)
    assert end.x[0] == pytest.approx(0.5 * np.exp(-(2 - np.log(2)) / 4), abs=1e-6)
    passage = system.passage(0)
    assert (passage.source, passage.target, passage.impulse_component) == ("open", "closed", 2)
    assert passage.largest_impulse == pytest.approx(1.5, abs=1e-6)
    assert system.last_jump.impulses[2, 0] == pytest.approx(1.5, abs=1e-6)
    assert system.modes["closed"].strangeness_index == 1
    assert system.modes["open"].num_analyses == 1
    assert system.statistics.steps == sum(mode.steps for mode in system.modes.values())
    assert "mode 1 (closed)" in system.report()
    assert solution(0.5)[0] == pytest.approx(4 * np.exp(-0.5), abs=1e-6)
    system.restore_checkpoint(checkpoint)
    assert (system.advance(2).x == end.x).all()


def test_transitions_at_times_and_guards():
    guarded = sfdae.Transition("open", "closed", time=0.5, guard=lambda t, x: x[0] - 3)
    system = switched(guarded, sfdae.Transition("open", "closed", time=1.0))
    system.start("open", 0, {"v1": 4}, 2)
    assert system.advance(0.9).x[1] == 0
    assert system.mode == "open"
    point = system.advance(1)
    assert point.x[1] == pytest.approx(np.exp(-1), abs=1e-5)
    assert system.passage(0).t == 1


def test_bounces_accumulate():
    system = ball(0.7)
    system.start("flight", 0, [0, 5], 10)
    with pytest.raises(sfdae.Error, match="accumulate") as caught:
        system.advance(10)
    limit = 2 * 5 / (9.81 * (1 - 0.7))
    assert caught.value.status == sfdae.Status.ZENO
    assert caught.value.point.t < limit
    assert system.accumulation == pytest.approx(limit, rel=1e-3)


def test_sensitivities_go_over_transitions():
    system = ball(0.7, rtol=1e-9, atol=1e-9)
    system.set_sensitivities(system.solvers["flight"].problem.names[:1])
    system.start("flight", 0, [2, 0], 1)
    system.advance(1)
    first = np.sqrt(4 / 9.81)
    slope = 1 / (9.81 * first)
    S, Sdot = system.sensitivities(1)
    assert S[:, 0] == pytest.approx(
        [slope * 9.81 * (0.7 * (1 - 2 * first) + 1 - first), slope * 9.81 * 1.7], abs=1e-7
    )
    assert Sdot[0] == pytest.approx(S[1], abs=1e-8)
    assert system.sensitivities(1, slopes=False)[1] is None
    assert system.passage_sensitivities == pytest.approx([slope], abs=1e-8)
    system.set_sensitivities(system.solvers["flight"].problem.names[:1], adjoint=True)
    system.start("flight", 0, [2, 0], 1)
    system.advance(1)
    assert system.gradient([1], [[1], [0]]) == pytest.approx(S[0], abs=1e-7)
    assert system.gradient([0, 1], [[[1, 0], [0, 0]], [[0, 0], [0, 1]]])[1] == pytest.approx(
        S[1], abs=1e-7
    )
    with pytest.raises(ValueError, match="shape"):
        system.gradient([1], [[1, 0]])
    with pytest.raises(sfdae.Error, match="sfdae_set_hybrid_sensitivities"):
        system.solvers["flight"].set_sensitivities([])
    system.set_sensitivities([])
    with pytest.raises(sfdae.Error, match="sfdae_set_hybrid_sensitivities"):
        system.sensitivities(1)


def test_mistakes_are_named():
    with pytest.raises(TypeError, match="one of condition, zero and time"):
        sfdae.Transition("a", "b")
    with pytest.raises(ValueError, match="no mode 'b'"):
        switched(sfdae.Transition("open", "b", time=1))
    with pytest.raises(sfdae.Error, match="time is inf"):
        switched(sfdae.Transition("open", "closed", time=np.inf))
    system = switched()
    with pytest.raises(sfdae.Error, match="sfdae_start_hybrid"):
        system.advance(1)
    with pytest.raises(ValueError, match="no mode"):
        system.start("ajar", 0, [1, 0, 0], 1)


def test_modes_with_unknowns_in_other_orders():
    def problem(*names):
        return sfdae.NonlinearProblem(lambda t, x, xdot: [xdot[0] - x[1], xdot[1]], names=names)

    text = r"'v' is the name of x\[1\] in mode 'up' and of x\[0\] in mode 'down'"
    with pytest.raises(ValueError, match=text):
        sfdae.Hybrid({"up": problem("h", "v"), "down": problem("v", "h")})
    sfdae.Hybrid({"up": problem("h", "v"), "down": problem("h", "speed")})


def test_exceptions_are_passed_on():
    def fail(t, x):
        raise KeyError("no jump")

    system = switched(sfdae.Transition("open", "closed", time=0.5, jump=fail))
    system.start("open", 0, [1, 0, 0], 1)
    with pytest.raises(KeyError):
        system.advance(1)


def corner(t, x, xdot, right=0.0):
    """x' = x > y ? -2 : 2,  y' = y > x ? -3 : 1.5."""
    return [xdot[0] - 2 + 4 * right, xdot[1] + 3 - 4.5 * right]


def sliding(surface, name="along", **options):
    problem = sfdae.NonlinearProblem(corner, 2)
    right = sfdae.Solver(problem, parameters={"right": 1.0}, **options)
    switch = sfdae.Switch("left", "right", surface, name)
    return sfdae.Hybrid({"left": problem, "right": right}, switches=[switch], **options)


def test_motion_along_a_surface():
    system = sliding(lambda t, x: x[0] - x[1], rtol=1e-9, atol=1e-9)
    system.start("right", 0, [1.5, 1], 1)
    assert system.advance(1).x == pytest.approx([217 / 238, 217 / 238], abs=1e-8)
    assert system.mode == "along"
    passage = system.passage(0)
    assert (passage.source, passage.target, passage.transition) == ("right", "along", 1)
    assert passage.t == pytest.approx(1 / 7, abs=1e-8)
    assert system.modes["along"].visits == 1


def test_parameters_of_a_surface():
    # Along x - y = 1/2.
    system = sliding(lambda t, x, gap=0.5: x[0] - x[1] - gap, rtol=1e-9, atol=1e-9)
    system.set_sensitivities(["gap"])
    system.start("left", 0, [1.2, 1], 1)
    x = system.advance(1).x
    assert x[0] - x[1] == pytest.approx(0.5, abs=1e-8)
    # It is met after (gap - 0.2) / 5, and x' is -6/17 along it.
    S, _ = system.sensitivities(1)
    assert S[:, 0] == pytest.approx([(2 + 6 / 17) / 5, (2 + 6 / 17) / 5 - 1], abs=1e-8)
    assert system.passage_sensitivities == pytest.approx([0.2], abs=1e-8)


def test_what_a_surface_returns():
    with pytest.raises(sfdae.Error, match="depends on x'|does not depend on x"):
        sliding(lambda t, x: t)
    with pytest.raises(ZeroDivisionError):
        sliding(lambda t, x: x[0] / 0 if 1 / 0 else x[1])
    with pytest.raises(sfdae.Error, match="already"):
        sliding(lambda t, x: x[0] - x[1], name="left")
    with pytest.raises(TypeError, match="surface has to accept"):
        sfdae.Switch("left", "right", lambda t: t)
    with pytest.raises(ValueError, match="there is no mode"):
        sfdae.Hybrid(
            {"left": sfdae.NonlinearProblem(corner, 2)},
            switches=[sfdae.Switch("left", "right", lambda t, x: x[0])],
        )
