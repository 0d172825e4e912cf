# SPDX-License-Identifier: BSD-3-Clause
"""Events: zeros of functions along the solution, and their actions."""

from __future__ import annotations

from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np

from ._arguments import PointFunction


class Event:
    """A zero of a function along the solution.

    Parameters
    ----------
    function : callable
        xdot is passed by this name. Other arguments are named parameters, as in equations: a
        parameter that is also in the equations has the same value in both.
    direction : float
        > 0: only rising zeros count, < 0: only falling ones, 0: both.
    terminal : bool or int
        True: the integration ends at the first event; a number: after this many events.
    action : callable, optional
        ``action(t, x)`` or ``action(t, x, xdot)``, with arguments as above, is called at the event
        and returns the values with which the integration restarts, an array or a dict of those that
        change; they are made consistent according to the options. None: the integration continues
        without a restart.
    name : str, optional
        For messages; by default the name of the function.

    Notes
    -----
    A plain function can be used, too; ``terminal``, ``direction`` and ``action`` may be attributes
    of it.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        *,
        direction: float = 0,
        terminal: bool | int = False,
        action: Callable[..., Any] | None = None,
        name: str | None = None,
    ) -> None:
        if not callable(function):
            raise TypeError(f"an event has to be a function of (t, x), not {function!r}")
        self.name = name or getattr(function, "__name__", "event")
        self.function = PointFunction(function, f"event {self.name!r}")
        self.direction = int(np.sign(direction))
        self.limit = float("inf") if terminal is False else int(terminal)
        if self.limit < 0:
            raise ValueError(f"terminal has to be a bool or a number >= 0, not {terminal!r}")
        if self.limit == 0:
            self.limit = float("inf")
        self.action: PointFunction | None = None
        if action is not None:
            self.action = PointFunction(action, f"the action of event {self.name!r}")

    @property
    def functions(self) -> list[PointFunction]:
        """The function, and the action if there is one."""
        return [self.function] if self.action is None else [self.function, self.action]


class EventRecord(NamedTuple):
    """An event that happened.

    Attributes
    ----------
    t : float
    x, xdot : numpy.ndarray
        n values, before the action.
    index : int
        Index of the event function.
    name : str
    direction : int
        +1: rising, -1: falling.
    """

    t: float
    x: np.ndarray
    xdot: np.ndarray
    index: int
    name: str
    direction: int


def as_events(events: Any) -> list[Event]:
    """None, an event or a sequence of them, each a function or an Event."""
    if events is None:
        return []
    given: Sequence[Any] = (
        [events] if callable(events) or isinstance(events, Event) else list(events)
    )
    result = []
    for event in given:
        if not isinstance(event, Event):
            attributes = {
                name: getattr(event, name)
                for name in ("direction", "terminal", "action")
                if hasattr(event, name)
            }
            event = Event(event, **attributes)
        result.append(event)
    return result


def joined(events: Sequence[Event], known: Mapping[str, Any]) -> Callable[..., list[float]]:
    """One function that returns the values of all events. known: values of parameters."""

    def evaluate(t: float, x: np.ndarray, xdot: np.ndarray) -> list[float]:
        values = []
        for event in events:
            value = event.function(t, x, xdot, known)
            if np.size(value) != 1:
                raise ValueError(f"event {event.name} returned {value!r}, not a number")
            values.append(float(np.reshape(value, ())))
        return values

    return evaluate
