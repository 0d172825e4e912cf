# SPDX-License-Identifier: BSD-3-Clause
"""The result of sfdae.solve."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ._events import EventRecord
from ._inspection import ConditionSwitch
from ._report import Report
from ._points import Point
from ._recorded_solution import RecordedSolution
from ._status import Status


class Steps(NamedTuple):
    """All accepted steps: ends, signed sizes, orders."""

    t: np.ndarray
    size: np.ndarray
    order: np.ndarray


class Solution:
    """The result of an integration.

    Attributes
    ----------
    t : numpy.ndarray
        N times: those of t_eval, or the start, the ends of all steps and the events.
    x, xdot : numpy.ndarray
        n x N, the unknowns at these times and their derivatives. x satisfies all constraints to
        machine precision.
    S : numpy.ndarray or None
        n x p x N: derivatives of x at these times with respect to the p parameters or start values
        in ``sensitivities``.
    status : Status
        ``OK``: the end was reached; ``EVENT``: a terminal event; ``STOPPED``: by the monitor or
        Ctrl-C; negative: a failure.
    success : bool
        The end, or a terminal event, was reached.
    message : str
        The reason for the end of the integration, and the message of the library.
    last : Point
        The last point reached, whether or not it is among the outputs.
    events : list of EventRecord
        All events in order: t, x, xdot, index, name, direction.
    t_events, x_events : list of numpy.ndarray
        Times of the events of each function, and values there, (number of events) x n.
    switches : list of ConditionSwitch
        Switches of conditions in the equations: t, condition, before, after, jumps.
    report : Report
        Index analysis, initial values, statistics.
    steps : Steps
        Ends, sizes and orders of all accepted steps.
    dense : RecordedSolution or None
        The solution evaluated by ``sol(t)``; ``dense.accuracy`` is its error in units of the
        tolerances. ``dense.save()`` converts it to numbers, RecordedSolution.load reads them.
    names : tuple of str
        Names of the unknowns.
    units : dict
        Units by name.
    """

    t: np.ndarray
    x: np.ndarray
    xdot: np.ndarray
    S: np.ndarray | None
    status: Status
    message: str
    last: Point
    events: list[EventRecord]
    t_events: list[np.ndarray]
    x_events: list[np.ndarray]
    switches: list[ConditionSwitch]
    report: Report
    steps: Steps
    dense: RecordedSolution | None
    names: tuple[str, ...]
    units: dict[str, str]

    def __init__(self, **members: Any) -> None:
        vars(self).update(members)

    @property
    def success(self) -> bool:
        """True if the end, or a terminal event, was reached."""
        return self.status >= 0 and self.status != Status.STOPPED

    def __call__(self, t: Any) -> np.ndarray:
        """The solution at a time, shape (n,), or at N times, shape (n, N), within the integrated
        interval.

        It agrees with the integrator's own values to a part of the tolerances rtol |x| + atol if
        the solution is smooth within steps; ``sol.dense.accuracy`` is the largest expected
        difference in units of the tolerances, with a warning if it is above 10. Constraints hold to
        the same accuracy, at sol.t to machine precision.

        Raises
        ------
        ValueError
            For times that were not reached, and if there is no dense output.
        """
        return self._recorded()(t)

    def derivative(self, t: Any) -> np.ndarray:
        """x' at a time, shape (n,), or at N times, shape (n, N); less accurate than x by about a
        factor 1 / step.
        """
        return self._recorded().derivative(t)

    def _recorded(self) -> RecordedSolution:
        if self.dense is None:
            raise ValueError("no dense output was recorded: call solve with dense_output=True")
        if self.dense.is_empty:
            raise ValueError("no step was taken: there is no dense output")
        return self.dense

    def __getitem__(self, name: str) -> np.ndarray:
        """One unknown at the times t, N values, by its name (or the time, by ``"t"`` if no unknown
        has this name).
        """
        if name in self.names:
            return self.x[self.names.index(name)]
        if name == "t":
            return self.t
        raise KeyError(f"there is no unknown {name!r}; there are {', '.join(self.names)}")

    def to_frame(self) -> Any:
        """The outputs as a pandas frame: one column for each unknown, times as index.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        import pandas

        return pandas.DataFrame(
            self.x.T, columns=list(self.names), index=pandas.Index(self.t, name="t")
        )

    def plot(self, *names: str, ax: Any = None) -> Any:
        """Draws unknowns over time, one axis for each unit.

        Parameters
        ----------
        *names : str
            Unknowns; all if none is given.
        ax : matplotlib.axes.Axes, optional
            The axes; by default a new figure.

        Returns
        -------
        matplotlib.figure.Figure
            Its ``axes`` are a list; ``savefig`` writes a file.
        """
        from ._plots import plot_solution

        return plot_solution(self, names, ax)

    def plot_steps(self, ax: Any = None) -> Any:
        """Draws step size and order over time; matplotlib's axes of the step size."""
        from ._plots import plot_steps

        return plot_steps(self, ax)

    def __repr__(self) -> str:
        known = ", ".join(self.names[:10]) + (", ..." if len(self.names) > 10 else "")
        times = f"from {self.t[0]:g} to {self.t[-1]:g}" if self.t.size else ""
        lines = [
            f" message: {self.message}",
            f" success: {self.success}",
            f"  status: {self.status!r}",
            f"       t: {self.t.size} times {times}",
            f"       x: {len(self.names)} unknowns ({known})",
            f"  events: {len(self.events)}",
            f"switches: {len(self.switches)}",
            f"   steps: {self.steps.t.size}",
            f"  report: {self.report!r}",
        ]
        return "\n".join(lines)
