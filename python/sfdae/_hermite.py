# SPDX-License-Identifier: BSD-3-Clause
"""Polynomials through values and derivatives at the ends of steps, many at once."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import chebyshev

DEGREE = 7  # through four ends of steps: two orders more than BDF has

# A step next to one that is shorter by this factor does not help: its errors would be magnified by
# the cube of that. One that is longer does no harm, up to where matrices become singular.
_SHORTER, _LONGER = 8.0, 64.0


class HermiteNodes:
    """Ends of steps, t, x and x', in segments between which the solution may jump."""

    def __init__(self) -> None:
        self._t: list[float] = []
        self._x: list[np.ndarray] = []
        self._xdot: list[np.ndarray] = []
        self._segment: list[int] = []
        self._arrays: tuple[np.ndarray, ...] | None = None

    def add(self, t: float, x: np.ndarray, xdot: np.ndarray, is_new_segment: bool) -> int:
        """Adds an end; its index."""
        previous = self._segment[-1] if self._segment else 0
        self._t.append(t)
        self._x.append(x)
        self._xdot.append(xdot)
        self._segment.append(previous + int(is_new_segment))
        self._arrays = None
        return len(self._t) - 1

    def polynomials(self, left: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Polynomials of the steps from the ends `left` (P indices) to those after them.

        Returns
        -------
        coefficients : numpy.ndarray
            P x 8 x n, of Chebyshev polynomials in [-1, 1].
        differences : numpy.ndarray
            P x n, to the polynomial through one end less: larger than what the polynomial errs by.
        """
        if self._arrays is None:
            columns = (self._t, self._x, self._xdot, self._segment)
            self._arrays = tuple(np.array(column) for column in columns)
        t, x, _, segment = self._arrays
        last = t.size - 1
        before, after = np.maximum(left - 1, 0), np.minimum(left + 2, last)
        h = t[left + 1] - t[left]
        has_before = (before < left) & (segment[before] == segment[left])
        has_before &= _is_comparable(t[left] - t[before], h)
        has_after = (after > left + 1) & (segment[after] == segment[left])
        has_after &= _is_comparable(t[after] - t[left + 1], h)
        coefficients = np.zeros((left.size, DEGREE + 1, x.shape[1]))
        differences = np.zeros((left.size, x.shape[1]))
        for use_before in (False, True):
            for use_after in (False, True):
                chosen = np.flatnonzero((has_before == use_before) & (has_after == use_after))
                if chosen.size:
                    result = self._with_neighbours(left[chosen], use_before, use_after)
                    coefficients[chosen], differences[chosen] = result
        return coefficients, differences

    def _with_neighbours(
        self, left: np.ndarray, before: bool, after: bool
    ) -> tuple[np.ndarray, np.ndarray]:
        ends = [left, left + 1]
        full = self._through(
            left, [*ends, *([left - 1] if before else []), *([left + 2] if after else [])]
        )
        if before and after:
            parts = [self._through(left, [*ends, left - 1]), self._through(left, [*ends, left + 2])]
        elif before or after:
            parts = [self._through(left, ends)]
        else:  # 4 c3 (s - 1) (s + 1)^2: to the parabola that does without one of the derivatives
            return full, 4.75 * np.abs(full[:, 3])
        return full, np.min([np.abs(full - part).sum(axis=1) for part in parts], axis=0)

    def _through(self, left: np.ndarray, nodes: list[np.ndarray]) -> np.ndarray:
        """Chebyshev coefficients, in the step from `left`, of the polynomials through all nodes."""
        t, x, xdot, _ = self._arrays
        degree = 2 * len(nodes) - 1
        half = 0.5 * (t[left + 1] - t[left])
        middle = 0.5 * (t[left + 1] + t[left])
        matrices = np.empty((left.size, degree + 1, degree + 1))
        values = np.empty((left.size, degree + 1, x.shape[1]))
        slopes = _DERIVATIVE[: degree + 1, : degree + 1]
        for k, node in enumerate(nodes):
            s = (t[node] - middle) / half
            basis = chebyshev.chebvander(s, degree)
            scale = 1.0 / np.abs(basis).max(axis=1)
            matrices[:, 2 * k] = basis * scale[:, None]
            values[:, 2 * k] = x[node] * scale[:, None]
            matrices[:, 2 * k + 1] = (basis @ slopes) * scale[:, None]
            values[:, 2 * k + 1] = xdot[node] * (half * scale)[:, None]
        result = np.zeros((left.size, DEGREE + 1, x.shape[1]))
        result[:, : degree + 1] = np.linalg.solve(matrices, values)
        return result

    def size(self, left: np.ndarray) -> np.ndarray:
        """The larger |x| of both ends of each step, P x n."""
        x = np.array(self._x) if self._arrays is None else self._arrays[1]
        return np.maximum(np.abs(x[left]), np.abs(x[left + 1]))


def _is_comparable(step: np.ndarray, h: np.ndarray) -> np.ndarray:
    ratio = np.abs(step / h)
    return (ratio <= _LONGER) & (ratio >= 1.0 / _SHORTER)


def _derivative_matrix() -> np.ndarray:
    """basis @ matrix: the derivatives of Chebyshev polynomials, from the polynomials."""
    result = np.zeros((DEGREE + 1, DEGREE + 1))
    for k in range(1, DEGREE + 1):
        unit = np.zeros(DEGREE + 1)
        unit[k] = 1.0
        result[:DEGREE, k] = chebyshev.chebder(unit)
    return result


_DERIVATIVE = _derivative_matrix()


def derivative_coefficients(coefficients: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Of the derivatives of polynomials of steps of size 2 half: P x 8 x n."""
    return np.einsum("ij,pjn->pin", _DERIVATIVE, coefficients) / half[:, None, None]
