# SPDX-License-Identifier: BSD-3-Clause
"""Reports on a run: index analysis, initial values, statistics."""

from __future__ import annotations

from typing import Any, Callable

from ._status import Error
from ._structs import Struct


class Report:
    """Index analysis, initial values and statistics; ``print(report)`` shows the text of the
    library.

    Attributes
    ----------
    text : str
        The diagnostics report.
    characteristics : Struct or None
        strangeness_index, differential, algebraic, undetermined, redundant, ...; None if the
        analysis failed.
    decisions : list of Struct
        Every rank decision: t, level, stage, what, rows, columns, rank, kept, dropped, noise,
        threshold, gap, verdict.
    initial : Struct or None
        Changes of the initial values: residual_before, residual_after, largest_change, component,
        ...
    statistics : Struct or None
        steps, reductions, factorizations, evaluations, ...
    multibody : Struct or None
        For mechanical systems: redundant, degrees_of_freedom, condition, ...
    names : tuple of str
        Names of the unknowns.
    """

    def __init__(self, solver: Any) -> None:
        self.names = solver.problem.names
        self.text: str = _or_none(solver.report) or ""
        self.characteristics: Struct | None = _or_none(lambda: solver.characteristics)
        self.decisions: list[Struct] = _or_none(lambda: solver.decisions) or []
        self.initial: Struct | None = _or_none(lambda: solver.initial_report)
        self.statistics: Struct | None = _or_none(lambda: solver.statistics)
        self.multibody: Struct | None = None
        if solver.problem.kind == "multibody":
            self.multibody = _or_none(lambda: solver.multibody_report)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        c = self.characteristics
        if c is None:
            return "Report(no analysis)"
        index = c.strangeness_index
        return f"Report(strangeness index {index}, d = {c.differential}, a = {c.algebraic})"

    def plot(self, ax: Any = None) -> Any:
        """Draws the rank decisions: smallest value kept, largest dropped, noise, on a logarithmic
        axis.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            A new figure if it is not given.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from ._plots import plot_decisions

        return plot_decisions(self, ax)


def _or_none(function: Callable[[], Any]) -> Any:
    """None if the result is not available yet, as before an analysis."""
    try:
        return function()
    except Error:
        return None
