# SPDX-License-Identifier: BSD-3-Clause
"""Jacobians of functions that are called with numbers, by central differences."""

from __future__ import annotations

from typing import Callable

import numpy as np

# Balances the error of truncation, h^2, with that of rounding, eps / h.
_STEP = float(np.finfo(float).eps) ** (1 / 3)


def jacobian(function: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    """The derivative of a vector by x, m x n. Unknowns below 1 are moved as if they were 1, unless
    the function has no value there.
    """
    columns = [_column(function, x, j) for j in range(len(x))]
    return np.stack(columns, axis=1)


def _column(function: Callable[[np.ndarray], np.ndarray], x: np.ndarray, j: int) -> np.ndarray:
    for size in (max(abs(x[j]), 1.0), abs(x[j])):
        above, below = x.copy(), x.copy()
        above[j] += _STEP * size
        below[j] -= _STEP * size
        if above[j] == below[j]:
            break
        result = (function(above) - function(below)) / (above[j] - below[j])
        if np.all(np.isfinite(result)):
            break
    return result
