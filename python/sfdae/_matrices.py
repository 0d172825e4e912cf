# SPDX-License-Identifier: BSD-3-Clause
"""Matrices that callbacks return: coefficients of linear problems, sparsity patterns."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from ._arguments import Arguments
from ._binding import ffi
from ._formula import Formula

MATRICES = ("dense", "compressed", "differences")  # in the order of SFDAE_MATRICES_...


class Matrices:
    """Patterns of the matrices of a problem by name, and the format that functions return."""

    num_equations: int | None
    num_unknowns: int
    coefficients: dict[str, Any]

    def _set_patterns(self, given: Mapping[str, Any], matrices: str) -> None:
        self.patterns = {
            name: as_pattern(pattern, self.num_unknowns, f"{name}_pattern")
            for name, pattern in given.items()
            if pattern is not None
        }
        if matrices not in MATRICES:
            raise ValueError(f"matrices is {matrices!r}, not one of {', '.join(MATRICES)}")
        self.matrices = matrices

    def matrix_shape(self, name: str) -> tuple[int, ...]:
        """Shape of the matrix of this name as returned by functions: m x n, or the entries."""
        if self.matrices == "dense":
            return (int(self.num_equations or 0), self.num_unknowns)
        return (len(self.patterns[name][1]),)

    def _fill_patterns(self, c: Any, keep: list[Any]) -> None:
        c.matrices = MATRICES.index(self.matrices)
        for name, (col_start, row_index) in self.patterns.items():
            arrays = [ffi.new("int[]", part.tolist()) for part in (col_start, row_index)]
            keep += arrays
            setattr(c, f"{name}_entries", len(row_index))
            setattr(c, f"{name}_col_start", arrays[0])
            setattr(c, f"{name}_row_index", arrays[1])

    def _check_entries(self) -> None:
        if self.matrices == "differences":
            raise ValueError("E and A cannot be differences: matrices is 'dense' or 'compressed'")
        for part in ("E", "A"):
            array = self.coefficients[part]
            if part not in self.patterns:
                raise TypeError(f"{part}_pattern is needed where matrices are compressed")
            expected = self.matrix_shape(part)
            if isinstance(array, np.ndarray) and array.shape != expected:
                raise ValueError(f"{part} has shape {array.shape}, not {expected}")


def coefficient(name: str, given: Any, dimension: int, parameters: Mapping[str, Any] | None) -> Any:
    """An array of numbers, a function of (t, order), or a Formula in t."""
    if not callable(given):
        try:
            array = np.array(given, dtype=float)
        except (TypeError, ValueError):
            raise TypeError(
                f"{name} has to be an array of numbers or a function, not {given!r}"
            ) from None
        if array.ndim != dimension:
            raise ValueError(
                f"{name} has shape {array.shape}: it has to be a "
                f"{'vector' if dimension == 1 else 'matrix'}"
            )
        return array
    arguments = Arguments(given, ("t",), name, ("order",))
    if not arguments.by_name:
        missing = [other for other in arguments.required if other not in (parameters or {})]
        if missing:
            raise TypeError(
                f"the argument {missing[0]} of {name} has no value. If it is the order of the "
                f"derivative, call it order: {name}(t, order); a parameter needs a default, or "
                f"parameters={{{missing[0]!r}: ...}}"
            )
        return Formula(given, ("t",), name)
    if arguments.required:
        raise TypeError(
            f"the argument {arguments.required[0]} of {name} has no value: functions of (t, order) "
            "have no parameters but those with defaults"
        )
    return _FunctionOfOrder(given)


class _FunctionOfOrder:
    """A function of (t, order) whose second argument may stand at any place."""

    def __init__(self, function: Any) -> None:
        self.function = function

    def __call__(self, t: float, order: int) -> Any:
        return self.function(t, order=order)


def as_pattern(given: Any, n: int, name: str) -> tuple[np.ndarray, np.ndarray]:
    """(col_start, row_index) of n columns, as given or from a matrix; the library reports other
    errors in it.
    """
    if hasattr(given, "tocsc"):
        matrix = given.tocsc()
        given = (matrix.indptr, matrix.indices)
    elif isinstance(given, np.ndarray) and given.ndim == 2:
        columns, rows = np.nonzero(given.T)
        given = (np.searchsorted(columns, np.arange(given.shape[1] + 1)), rows)
    parts = tuple(np.asarray(part) for part in given)
    if len(parts) != 2:
        raise ValueError(f"{name} has to be a pair (col_start, row_index)")
    for part, what in zip(parts, ("col_start", "row_index")):
        if part.ndim != 1 or (part.size > 0 and not np.issubdtype(part.dtype, np.integer)):
            raise ValueError(f"{what} of {name} has to be a vector of integers")
    if len(parts[0]) != n + 1:
        raise ValueError(
            f"col_start of {name} has {len(parts[0])} numbers for {n} unknowns: {n + 1} are needed"
        )
    return parts[0].astype(np.intc), parts[1].astype(np.intc)
