# SPDX-License-Identifier: BSD-3-Clause
"""Plots by matplotlib."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

_POINTS_PER_STEP = 8  # of dense output in a plot
_MOST_POINTS = 20000


def _new_axes(count: int = 1) -> Any:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(count, 1, sharex=True, layout="constrained", squeeze=False)
    return axes[:, 0]


def _curve(solution: Any) -> tuple[np.ndarray, np.ndarray]:
    """Times and values to draw: of dense output if available, between the outputs."""
    t = solution.t
    if solution.dense is None or solution.dense.is_empty or t.size < 2:
        return t, solution.x
    count = min(_POINTS_PER_STEP, max(_MOST_POINTS // t.size, 1))
    pieces = [np.linspace(a, b, count, endpoint=False) for a, b in zip(t[:-1], t[1:])]
    within = np.concatenate([*(piece[1:] for piece in pieces if piece.size > 1), np.empty(0)])
    within = within[(within > solution.dense.t_min) & (within < solution.dense.t_max)]
    times = np.concatenate([t, within])
    order = np.argsort(times if t[-1] > t[0] else -times, kind="stable")
    values = np.concatenate([solution.x, solution(within)], axis=1) if within.size else solution.x
    return times[order], values[:, order]


def plot_solution(solution: Any, names: Sequence[str], ax: Any) -> Any:
    """The figure with curves of unknowns over time: one axis for each unit, labelled with names and
    unit.
    """
    chosen = list(names) or list(solution.names)
    for name in chosen:
        if name not in solution.names:
            raise KeyError(f"there is no unknown {name!r}; there are {', '.join(solution.names)}")
    units = list(dict.fromkeys(solution.units.get(name, "") for name in chosen))
    axes = [ax] * len(units) if ax is not None else list(_new_axes(len(units)))
    t, x = _curve(solution)
    for unit, axis in zip(units, axes):
        group = [name for name in chosen if solution.units.get(name, "") == unit]
        for name in group:
            axis.plot(t, x[solution.names.index(name)], label=name)
        text = ", ".join(group) if len(group) <= 4 else "unknowns"
        axis.set_ylabel(f"{text} [{unit}]" if unit else text)
        axis.legend(loc="best")
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel(_with_unit_of_time("t", solution))
    for event in solution.events:
        for axis in axes:
            axis.axvline(event.t, color="0.6", linewidth=0.8, linestyle=":")
    for switch in solution.switches:
        for axis in axes:
            axis.axvline(switch.t, ymax=0.03, color="0.3", linewidth=0.8)
    return axes[0].figure


def _with_unit_of_time(text: str, solution: Any) -> str:
    unit = solution.units.get("t", "")
    return f"{text} [{unit}]" if unit else text


def plot_steps(solution: Any, ax: Any) -> Any:
    """Step size on a logarithmic axis and order, over time."""
    axis = _new_axes()[0] if ax is None else ax
    steps = solution.steps
    axis.semilogy(steps.t, np.abs(steps.size), color="C0", label="step size")
    axis.set_xlabel(_with_unit_of_time("t", solution))
    axis.set_ylabel(_with_unit_of_time("step size", solution), color="C0")
    other = axis.twinx()
    other.step(steps.t, steps.order, where="pre", color="C1", label="order")
    other.set_ylabel("order", color="C1")
    other.set_ylim(0, max(int(steps.order.max(initial=1)), 5) + 1)
    return axis


def plot_decisions(report: Any, ax: Any) -> Any:
    """Rank decisions: smallest value kept, largest dropped, noise and threshold, relative to the
    data.
    """
    from matplotlib.ticker import MaxNLocator

    axis = _new_axes()[0] if ax is None else ax
    decisions = report.decisions
    number = np.arange(1, len(decisions) + 1)
    floor = 1e-17  # zeros are drawn at this value, below all rounding errors
    for member, marker, color, label in (
        ("kept", "^", "C0", "smallest kept"),
        ("dropped", "v", "C3", "largest dropped"),
        ("noise", "_", "0.4", "noise"),
    ):
        values = np.array([getattr(decision, member) for decision in decisions], dtype=float)
        is_there = np.array([_is_there(decision, member) for decision in decisions], dtype=bool)
        axis.semilogy(
            number[is_there], np.maximum(values[is_there], floor), marker, color=color, label=label
        )
    for i, decision in zip(number, decisions):
        if decision.verdict == 2:  # SFDAE_VERDICT_UNCLEAR
            axis.axvspan(i - 0.5, i + 0.5, color="C3", alpha=0.2)
    axis.xaxis.set_major_locator(MaxNLocator(integer=True))
    axis.set_xlabel("rank decision")
    axis.set_ylabel("value relative to the data")
    c = report.characteristics
    if c is not None:
        axis.set_title(
            f"strangeness index {c.strangeness_index}, d = {c.differential}, a = {c.algebraic}"
        )
    axis.legend(loc="best")
    axis.grid(alpha=0.3)
    return axis


def _is_there(decision: Any, member: str) -> bool:
    """True if the member exists: nothing is kept if the rank is 0, or dropped if it is full."""
    if member == "kept":
        return decision.rank > 0
    if member == "dropped":
        return decision.rank < min(decision.rows, decision.columns)
    return True
