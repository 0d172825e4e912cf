# SPDX-License-Identifier: BSD-3-Clause
"""Transitions of hybrid systems."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple

import numpy as np

from ._binding import lib
from ._callbacks import _numbers, _write, callback
from ._events import _with_derivatives


class Transition:
    """A transition from a mode to another one, or to itself. See sfdae_transition.

    Parameters
    ----------
    source, target : str
        Names of modes.
    condition : callable, optional
        ``condition(t, x)`` or ``condition(t, x, xdot)``: the transition happens as soon as it is
        > 0, by more than what the tolerances of x leave unknown; also where the mode begins.
    zero : callable, optional
        A function of the same kind: the transition happens where it passes zero.
    direction : int
        Of zeros: +1 rising ones, -1 falling ones, 0 both.
    time : float, optional
        The transition happens at this time. Exactly one of condition, zero and time is given.
    guard : callable, optional
        A function of the same kind: no transition unless it is > 0 then.
    jump : callable, optional
        ``jump(t, x)`` returns the values after the transition, which are made consistent. None:
        they follow from impulses of the equations, as by Solver.jump.
    """

    def __init__(
        self,
        source: str,
        target: str,
        condition: Callable[..., float] | None = None,
        *,
        zero: Callable[..., float] | None = None,
        direction: int = 0,
        time: float | None = None,
        guard: Callable[..., float] | None = None,
        jump: Callable[..., Any] | None = None,
    ) -> None:
        if sum(given is not None for given in (condition, zero, time)) != 1:
            raise TypeError("a transition needs one of condition, zero and time")
        self.source, self.target = source, target
        self.time, self.direction = time, direction
        self.kind = lib.SFDAE_TRANSITION_TIME
        if condition is not None:
            self.kind = lib.SFDAE_TRANSITION_CONDITION
        elif zero is not None:
            self.kind = lib.SFDAE_TRANSITION_ZERO
        function = condition if condition is not None else zero
        self.function = None if function is None else _with_derivatives(function)
        self.guard = None if guard is None else _with_derivatives(guard)
        self.jump = jump


class Passage(NamedTuple):
    """A transition that happened.

    Attributes
    ----------
    t : float
    source, target : str
        Modes.
    transition : int
        Its number, from 0 on.
    largest_impulse, largest_change : float
        In size; 0 where there is none.
    impulse_component, changed_component : int
        Where; -1 where there is none.
    """

    t: float
    source: str
    target: str
    transition: int
    largest_impulse: float
    impulse_component: int
    largest_change: float
    changed_component: int


class _State:
    """What the callbacks of a transition get as `user`."""

    def __init__(self, transition: Transition, num_unknowns: int) -> None:
        self.transition, self.n = transition, num_unknowns
        self.exception: BaseException | None = None


def _evaluate(state: _State, function: Any, t: float, x: Any, xdot: Any, g: Any) -> None:
    value = function(t, _numbers(x, (state.n,)), _numbers(xdot, (state.n,)))
    _write(g, np.reshape(value, (1,)), (1,), "a function of a transition")


@callback("python_transition_function")
def _function(state: _State, t: float, x: Any, xdot: Any, g: Any) -> None:
    _evaluate(state, state.transition.function, t, x, xdot, g)


@callback("python_transition_guard")
def _guard(state: _State, t: float, x: Any, xdot: Any, g: Any) -> None:
    _evaluate(state, state.transition.guard, t, x, xdot, g)


@callback("python_transition_jump")
def _jump(state: _State, t: float, source: int, target: int, before: Any, after: Any) -> None:
    value = state.transition.jump(t, _numbers(before, (state.n,)).copy())
    _write(after, value, (state.n,), "jump of a transition")
