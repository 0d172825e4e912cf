# SPDX-License-Identifier: BSD-3-Clause
"""Branches: singular points of solutions, their kinds, and continuation after them."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple

from ._binding import ffi, lib

_KINDS = {
    lib.SFDAE_SINGULAR_UNDETERMINED: "undetermined",
    lib.SFDAE_SINGULAR_FOLD: "fold",
    lib.SFDAE_SINGULAR_CROSSING: "crossing",
    lib.SFDAE_SINGULAR_UNBOUNDED: "unbounded",
}
_PARTS = {
    lib.SFDAE_PART_UNDETERMINED: "undetermined",
    lib.SFDAE_PART_CONSTRAINTS: "constraints",
    lib.SFDAE_PART_DIFFERENTIAL: "differential",
    lib.SFDAE_PART_BOTH: "both",
}


class SingularPoint(NamedTuple):
    """A singular point that an integration has met.

    Attributes
    ----------
    t : float
        Its time.
    kind : str
        "fold": the solution turns around and none continues; "crossing": it is smooth, branches may
        cross; "unbounded": it grows without bound; or "undetermined".
    part : str
        The part that loses rank: "constraints", "differential" (equations), "both" or
        "undetermined".
    component : int
        The component of x that reveals a fold, or grows; -1: none.
    exponent : float
        The solution follows this power of the distance from the point.
    passed : bool
        The integration continued after it.
    t_before, t_after : float
        The last time before it and the first one after it.
    count : int
        Singular points passed since start().
    """

    t: float
    kind: str
    part: str
    component: int
    exponent: float
    passed: bool
    t_before: float
    t_after: float
    count: int


class Branches:
    """The part of a solver that handles singular points."""

    _call: Callable[..., int]

    def pass_singular_points(self, max_points: int) -> None:
        """Lets integrations pass at most this many singular points at which a smooth continuation
        is confirmed; 0, the default, ends them at the first one. See sfdae_pass_singular_points.

        Parameters
        ----------
        max_points : int
            Counted from start() on.
        """
        self._call(lib.sfdae_pass_singular_points, max_points)

    @property
    def singular_point(self) -> SingularPoint:
        """The last singular point, whether it ended a call or was passed. Raises Error with
        Status.NOT_STARTED if there was none since start().
        """
        found: Any = ffi.new("sfdae_singular_point*")
        lib.sfdae_singular_point_init(found, ffi.sizeof("sfdae_singular_point"))
        self._call(lib.sfdae_get_singular_point, found)
        return SingularPoint(
            found.t,
            _KINDS[found.kind],
            _PARTS[found.part],
            found.component,
            found.exponent,
            bool(found.passed),
            found.t_before,
            found.t_after,
            found.count,
        )
