# SPDX-License-Identifier: BSD-3-Clause
"""Conditions in functions that are called with numbers."""

from __future__ import annotations

from typing import Any, Callable, Mapping, Sequence, Union

import numpy as np

from ._arguments import PointFunction
from ._binding import ffi, lib

Conditions = Union[Callable[..., Any], Sequence[Callable[..., Any]]]
BRANCHES = "branches"  # the argument of equations that receives them


class HasConditions:
    """A problem whose functions read branches of conditions.

    Attributes
    ----------
    branches : ndarray of int
        1 if a condition holds, else 0; the library writes it before each call.
    """

    kind: str
    parameters: Mapping[str, Any]

    def _set_conditions(self, given: Conditions | None) -> None:
        functions = [given] if callable(given) else list(given or [])
        self.conditions = [
            PointFunction(function, f"condition {k}") for k, function in enumerate(functions)
        ]
        self.branches = np.zeros(len(functions), dtype=np.intc)

    def _fill_conditions(self, c: Any, keep: list[Any]) -> None:
        if not self.conditions:
            return
        for condition in self.conditions:
            condition.check(self, self.parameters)
        keep.append(ffi.from_buffer("int[]", self.branches, require_writable=True))
        c.num_conditions, c.branches = len(self.conditions), keep[-1]
        c.conditions = getattr(lib, f"python_{self.kind}_problem_conditions")
