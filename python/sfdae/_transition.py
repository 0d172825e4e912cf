# SPDX-License-Identifier: BSD-3-Clause
"""Transitions of hybrid systems."""

from __future__ import annotations

from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np

from ._arguments import PointFunction
from ._binding import lib
from ._callbacks import _numbers, _write, callback
from ._problem import Problem


class Transition:
    """A transition from a mode to another one, or to itself. See sfdae_transition.

    Parameters
    ----------
    source, target : str
        Names of modes.
    condition : callable, optional
        ``condition(t, x)`` or ``condition(t, x, xdot)``: the transition happens as soon as it
        exceeds 0 by more than the uncertainty from the tolerances of x; also at the start of the
        mode. xdot is passed by this name. Other arguments are named parameters: those that are also
        in the equations of the source have the same value there, and others keep their defaults.
    zero : callable, optional
        A function of the same kind: the transition happens at its zeros.
    direction : int
        Direction of zeros: +1 rising, -1 falling, 0 both.
    time : float, optional
        The transition happens at this time. Exactly one of condition, zero and time is given.
    guard : callable, optional
        A function of the same kind: the transition requires that it is > 0.
    jump : callable, optional
        ``jump(t, x)``, with named parameters as above, returns the values after the transition,
        which are made consistent. None: they follow from impulses of the equations, as in
        Solver.jump.
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
        kind = "condition" if condition is not None else "zero"
        way = f"of the transition from {source!r} to {target!r}"
        self.function = None if function is None else PointFunction(function, f"{kind} {way}")
        self.guard = None if guard is None else PointFunction(guard, f"guard {way}")
        self.jump = None if jump is None else PointFunction(jump, f"jump {way}", has_xdot=False)


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
        Absolute values; 0 if there is none.
    impulse_component, changed_component : int
        Their components; -1 if there is none.
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
    """The callbacks of a transition get this as `user`. problem, known: the problem of the source,
    and the values of its parameters.
    """

    def __init__(self, transition: Transition, problem: Problem, known: Mapping[str, Any]) -> None:
        self.transition, self.n, self.known = transition, problem.num_unknowns, known
        self.exception: BaseException | None = None
        given = (transition.function, transition.guard, transition.jump)
        self.functions = [function for function in given if function is not None]
        for function in self.functions:
            function.check(problem, known)

    def require_independence(self, names: Sequence[str]) -> None:
        """ValueError if a function has one of these parameters: its derivative would be missing."""
        wanted = {name.split("[")[0] for name in names}
        for function in self.functions:
            for name in wanted & self.known.keys() & function.arguments.defaults.keys():
                raise ValueError(
                    f"{function.name} has the parameter {name}, so that the derivative by {name} "
                    f"is not known: make it an unknown with the equation {name}' = 0 and ask for "
                    "the sensitivity by its start value"
                )


def _evaluate(state: _State, function: PointFunction, t: float, x: Any, xdot: Any, g: Any) -> None:
    value = function(t, _numbers(x, (state.n,)), _numbers(xdot, (state.n,)), state.known)
    _write(g, np.reshape(value, (1,)), (1,), function.name)


@callback("python_transition_function")
def _function(state: _State, t: float, x: Any, xdot: Any, g: Any) -> None:
    _evaluate(state, state.transition.function, t, x, xdot, g)


@callback("python_transition_guard")
def _guard(state: _State, t: float, x: Any, xdot: Any, g: Any) -> None:
    _evaluate(state, state.transition.guard, t, x, xdot, g)


@callback("python_transition_jump")
def _jump(state: _State, t: float, source: int, target: int, before: Any, after: Any) -> None:
    jump = state.transition.jump
    value = jump(t, _numbers(before, (state.n,)).copy(), None, state.known)
    _write(after, value, (state.n,), jump.name)
