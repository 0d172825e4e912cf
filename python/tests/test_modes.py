# SPDX-License-Identifier: BSD-3-Clause
"""Modes: breakpoints, jumps by impulses, impacts."""

import numpy as np
import pytest

import sfdae


def capacitors(t, x, xdot, closed=1.0):
    """1 and 3 F; charge is kept where a switch closes."""
    v1, v2, i = x
    return [xdot[0] + v1 + i, 3 * xdot[1] - i, closed * (v1 - v2) + (1 - closed) * i]


def step(t):
    return np.array([0, -1.0 if t >= 0.5 else 0.0])


def driven(**more):
    """x1' = x2, 0 = x1 - s(t), s a step from 0 to 1 at t = 1/2: mu = 1, x2 has an impulse there."""
    return sfdae.LinearProblem(
        E=np.array([[1.0, 0], [0, 0]]),
        A=np.array([[0, 1.0], [1, 0]]),
        f=lambda t, order: step(t) if order == 0 else np.zeros(2),
        **more,
    )


def test_charge_is_kept():
    problem = sfdae.NonlinearProblem(capacitors, 3, names=["v1", "v2", "i"])
    solver = sfdae.Solver(problem, parameters={"closed": 0.0}, rtol=1e-9, atol=1e-9)
    solver.start(0, {"v1": 2}, 1)
    open_switch = solver.advance(0.5)
    assert open_switch.x == pytest.approx([2 * np.exp(-0.5), 0, 0], abs=1e-8)
    solver.set_parameters(closed=1.0)
    jump = solver.jump(0.5, open_switch.x, 1, orders=2)
    assert jump.after[:2] == pytest.approx(open_switch.x[0] / 4 * np.ones(2), abs=1e-12)
    assert jump.impulses[2, 0] == pytest.approx(0.75 * open_switch.x[0])
    assert not jump.impulses[:, 1].any()
    assert jump.before == pytest.approx(open_switch.x)
    point = solver.start(0.5, jump.after, 1)
    assert point.x[:2] == pytest.approx(jump.after[:2], abs=1e-12)


def test_impact():
    problem = sfdae.MultibodyProblem(1, mass=[2], constraints=lambda t, q: [q[0]])
    solver = sfdae.Solver(problem)
    jump = solver.impact(0, [0, -3, 0], [0.5])
    assert jump.after == pytest.approx([0, 1.5, 0])
    assert jump.impulses[2, 0] == pytest.approx(-9)
    assert solver.impact(0, [0, -3, 0]).after[1] == pytest.approx(0)
    with pytest.raises(ValueError, match="2 entries for 1 constraints"):
        solver.impact(0, [0, -3, 0], [0.5, 0.5])
    with pytest.raises(sfdae.Error, match="restitution"):
        solver.impact(0, [0, -3, 0], [-0.5])


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_jumps_of_data(method):
    solver = sfdae.Solver(driven(), method=method)
    solver.set_breakpoints([0.5], "jump")
    solver.start(0, [0, 0], 1)
    with pytest.raises(sfdae.Error, match="no jump"):
        solver.last_jump
    assert solver.advance(1).x == pytest.approx([1, 0], abs=1e-9)
    jump = solver.last_jump
    assert jump.t == pytest.approx(0.5)
    assert (jump.before[0], jump.after[0]) == pytest.approx((0, 1), abs=1e-12)
    assert jump.impulses[1, 0] == pytest.approx(1)


def test_bad_breakpoints():
    solver = sfdae.Solver(driven())
    with pytest.raises(sfdae.Error, match="breakpoints must be in order"):
        solver.set_breakpoints([1, 0.5])
    with pytest.raises(ValueError, match="2 kinds for 1 breakpoints"):
        solver.set_breakpoints([1], ["kink", "kink"])
    with pytest.raises(ValueError, match="'bend'"):
        solver.set_breakpoints([1], "bend")
    solver.set_breakpoints([])


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_breakpoints_of_solve(method):
    sol = sfdae.solve(driven(), (0, 1), [0, 0], method=method, breakpoints={0.5: "jump"})
    assert sol.success
    assert sol(0.4)[0] == pytest.approx(0, abs=1e-9) and sol(0.6)[0] == pytest.approx(1, abs=1e-9)
    sol = sfdae.solve(
        lambda t, x, xdot: [xdot[0] - x[1], x[0] - sfdae.maximum(t - 0.5, 0)],
        (0, 1),
        [0, 0],
        method=method,
        breakpoints=[0.5],
        t_eval=[0.25, 0.75],
    )
    assert sol.x == pytest.approx(np.array([[0, 0.25], [0, 1]]), abs=1e-6)
    with pytest.raises(ValueError, match="'bend'"):
        sfdae.solve(driven(), (0, 1), [0, 0], breakpoints={0.5: "bend"})


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_switches_of_conditions(method):
    def divider(t, x, xdot):
        i, vs, vm = x
        current = xdot[1] - xdot[2]
        return [i - current, current - xdot[2] - vm, vs - np.where(t > 1, 1, 0)]

    sol = sfdae.solve(divider, (0, 2), [0, 0, 0], method=method)
    (switch,) = sol.switches
    assert switch.t == pytest.approx(1, abs=1e-12) and switch.jumps
    assert (switch.condition, switch.before, switch.after) == ("t - 1.0 > 0", 0, 1)
    # Times of the exact solution, over the restart of an event, too.
    restart = sfdae.Event(lambda t, x: t - 5, action=lambda t, x: x)
    sol = sfdae.solve(
        lambda t, x, xdot: [xdot[0] - np.cos(t), xdot[1] - abs(x[0])],
        (0.5, 10),
        [np.sin(0.5), 0],
        method=method,
        events=[restart],
        rtol=1e-8,
        atol=1e-8,
    )
    times = [switch.t for switch in sol.switches if switch.t > 0.5]
    assert times == pytest.approx([np.pi, 2 * np.pi, 3 * np.pi], abs=1e-5)
    assert "switches: " in repr(sol)
