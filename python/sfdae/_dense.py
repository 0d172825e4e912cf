# SPDX-License-Identifier: BSD-3-Clause
"""Dense output: the solution over the whole run as piecewise polynomials."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.polynomial import chebyshev

from ._hermite import HermiteNodes, derivative_coefficients

# Degrees tried one after the other: the points of one are among those of the next.
_DEGREES = (4, 8, 16)
# What the last two coefficients may amount to, in units of the tolerances: they bound what the
# polynomial errs by, as coefficients of smooth functions decrease. The integrator's own
# interpolation errs by up to half a tolerance.
_TAIL = 0.3
# Steps of problems without differential equations are as long as the interval: they are halved up
# to this often.
_HALVINGS = 10
_BATCH = 4096  # polynomials made at once

Sample = Callable[[float], "tuple[np.ndarray, np.ndarray]"]


def _points(degree: int) -> np.ndarray:
    """-cos(pi j / degree), from -1 to 1."""
    return -np.cos(np.pi * np.arange(degree + 1) / degree)


_MATRICES = {  # from values at the points to the coefficients of the polynomial through them
    degree: np.linalg.inv(chebyshev.chebvander(_points(degree), degree)) for degree in _DEGREES
}


class DenseOutput:
    """The solution at any time between the start and the last point reached.

    Steps of BDF: polynomials of degree 7 through x and x' at four ends of steps around. Steps of
    Radau, and of problems without differential equations: polynomials through values that the
    integrator interpolates and puts on the constraints, at as many Chebyshev points as are needed
    until what is left out falls below 0.3 tolerances.

    Attributes
    ----------
    t_min, t_max : float
        Where it is defined.
    accuracy : float
        The largest difference to the integrator's own values that is to be expected, in units of
        rtol |x| + atol: of BDF what one end of a step less would change, which says too much. Large
        where the solution has jumps or kinks within a step.
    worst_t : float
        The start of the step where that is.
    """

    def __init__(
        self, num_unknowns: int, rtol: Any, atol: Any, t0: float, direction: float
    ) -> None:
        self._n = num_unknowns
        self._rtol, self._atol = rtol, atol
        self._direction = direction
        self._starts: list[float] = []  # of panels, times `direction`: increasing
        self._ends: list[tuple[float, float]] = []  # (a, b), the polynomial's interval
        self._coefficients: list[np.ndarray | None] = []  # of x and x', None: of `_nodes`
        self._left: list[int] = []  # index of a in `_nodes`, -1: none
        self._nodes = HermiteNodes()
        self._t0 = self._end = t0
        self._is_new_segment = True
        self.accuracy = 0.0
        self.worst_t = t0

    # ---- Recording -------------------------------------------------------------------------------

    def add_ends(
        self, start: tuple[float, np.ndarray, np.ndarray], end: tuple[float, np.ndarray, np.ndarray]
    ) -> None:
        """Adds the step between two points (t, x, xdot), known by these and by steps around."""
        if self._is_new_segment or self._left[-1] < 0:
            self._nodes.add(*start, is_new_segment=True)
        left = self._nodes.add(*end, is_new_segment=False) - 1
        self._add_panel(start[0], end[0], None, left)

    def add_step(
        self, start: tuple[float, np.ndarray, np.ndarray], b: float, sample: Sample
    ) -> None:
        """Adds the step from a point (t, x, xdot) to b; sample(t) returns x and x' at any t after
        the point up to b.
        """
        a, x, xdot = start
        known = {a: np.concatenate([x, xdot])}
        self._add((a, b), self._fit(a, b, known, sample), known, sample, _HALVINGS)

    def cut(self, t: float) -> None:
        """The run ended, or was started anew, at t within the last step."""
        self._end = t
        self._is_new_segment = True

    def _add_panel(self, a: float, b: float, coefficients: np.ndarray | None, left: int) -> None:
        self._starts.append(a * self._direction)
        self._ends.append((a, b))
        self._coefficients.append(coefficients)
        self._left.append(left)
        self._end = b
        self._is_new_segment = False

    def _fit(
        self, a: float, b: float, known: dict[float, np.ndarray], sample: Sample
    ) -> tuple[np.ndarray, float]:
        """Coefficients in [a, b] and what the last of them amount to, in tolerances."""
        for degree in _DEGREES:
            times = [_time(a, b, s) for s in _points(degree)]
            for t in times:
                if t not in known:
                    known[t] = np.concatenate(sample(t))
            values = np.array([known[t] for t in times])
            coefficients = _MATRICES[degree] @ values
            weights = self._rtol * np.abs(values[:, : self._n]).max(axis=0) + self._atol
            tail = float((np.abs(coefficients[-2:, : self._n]).sum(axis=0) / weights).max())
            if tail <= _TAIL:
                break
        return coefficients, tail

    def _add(
        self,
        interval: tuple[float, float],
        fit: tuple[np.ndarray, float],
        known: dict[float, np.ndarray],
        sample: Sample,
        halvings: int,
    ) -> None:
        """Adds an interval as it is, or in halves if that helps at least one of them, as it does
        with a jump.
        """
        (a, b), (coefficients, tail) = interval, fit
        middle = _time(a, b, 0.0)
        if tail > _TAIL and halvings > 0 and middle not in (a, b):
            halves = [(a, middle), (middle, b)]
            fits = [self._fit(*half, known, sample) for half in halves]
            if min(part[1] for part in fits) < 0.5 * tail:
                for half, part in zip(halves, fits):
                    self._add(half, part, known, sample, halvings - 1)
                return
        if tail > self.accuracy:
            self.accuracy, self.worst_t = tail, a
        self._add_panel(a, b, coefficients, -1)

    def finish(self) -> None:
        """Estimates how accurate the polynomials between ends of steps are."""
        left = np.array([i for i in self._left if i >= 0], dtype=int)
        times = np.array([ends[0] for ends, i in zip(self._ends, self._left) if i >= 0])
        for first in range(0, left.size, _BATCH):
            part = left[first : first + _BATCH]
            _, differences = self._nodes.polynomials(part)
            errors = (differences / (self._rtol * self._nodes.size(part) + self._atol)).max(axis=1)
            worst = int(errors.argmax())
            if errors[worst] > self.accuracy:
                self.accuracy, self.worst_t = float(errors[worst]), float(times[first + worst])

    # ---- Evaluation ------------------------------------------------------------------------------

    @property
    def t_min(self) -> float:
        """The earliest time."""
        return min(self._t0, self._end)

    @property
    def t_max(self) -> float:
        """The latest time."""
        return max(self._t0, self._end)

    def __call__(self, t: Any) -> np.ndarray:
        """x at a time, shape (n,), or at N times in any order, shape (n, N).

        Where the run was started anew by the action of an event, these are the values after it.

        Raises
        ------
        ValueError
            For times outside [t_min, t_max].
        """
        return self._evaluate(t, slice(0, self._n))

    def derivative(self, t: Any) -> np.ndarray:
        """x' at a time, shape (n,), or at N times, shape (n, N); its error is about that of x over
        the step size.
        """
        return self._evaluate(t, slice(self._n, 2 * self._n))

    def _evaluate(self, t: Any, part: slice) -> np.ndarray:
        times = np.array(t, dtype=float)
        if times.ndim > 1:
            raise ValueError(f"t has shape {times.shape}: it has to be a number or a vector")
        if not self._starts:
            raise ValueError("no step was taken: there is no dense output")
        flat = np.atleast_1d(times)
        slack = 4 * np.finfo(float).eps * max(abs(self.t_min), abs(self.t_max))
        outside = ~((flat >= self.t_min - slack) & (flat <= self.t_max + slack))  # also NaN
        if outside.any():
            raise ValueError(
                f"t = {flat[outside][0]} is outside of [{self.t_min}, {self.t_max}], where the "
                "solution is known"
            )
        which = np.searchsorted(self._starts, flat * self._direction, side="right") - 1
        which = np.clip(which, 0, len(self._starts) - 1)
        result = np.empty((self._n, flat.size))
        order = np.argsort(which, kind="stable")
        groups = [
            group
            for group in np.split(order, np.flatnonzero(np.diff(which[order])) + 1)
            if group.size
        ]
        for first in range(0, len(groups), _BATCH):
            batch = groups[first : first + _BATCH]
            for group, coefficients in zip(
                batch, self._polynomials([which[group[0]] for group in batch])
            ):
                a, b = self._ends[which[group[0]]]
                s = np.clip((2 * flat[group] - (a + b)) / (b - a), -1.0, 1.0)
                result[:, group] = chebyshev.chebval(s, coefficients[:, part])
        return result[:, 0] if times.ndim == 0 else result

    def _polynomials(self, panels: list[int]) -> list[np.ndarray]:
        """Coefficients of x and x' of some panels."""
        result = [self._coefficients[panel] for panel in panels]
        between = [k for k, panel in enumerate(panels) if self._left[panel] >= 0]
        if between:
            ends = np.array([self._ends[panels[k]] for k in between])
            x, _ = self._nodes.polynomials(np.array([self._left[panels[k]] for k in between]))
            xdot = derivative_coefficients(x, 0.5 * (ends[:, 1] - ends[:, 0]))
            for k, both in zip(between, np.concatenate([x, xdot], axis=2)):
                result[k] = both
        return result


def _time(a: float, b: float, s: float) -> float:
    """From s in [-1, 1]; the ends are exact."""
    return a if s == -1.0 else b if s == 1.0 else a + (b - a) * 0.5 * (1.0 + s)
