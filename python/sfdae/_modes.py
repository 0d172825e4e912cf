# SPDX-License-Identifier: BSD-3-Clause
"""Modes: breakpoints of data, and transfer of values when equations change."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from ._binding import ffi, lib

_KINDS = {"kink": lib.SFDAE_BREAKPOINT_KINK, "jump": lib.SFDAE_BREAKPOINT_JUMP}


class Jump(NamedTuple):
    """Values before and after equations or data change.

    Attributes
    ----------
    t : float
    before, after : numpy.ndarray
        n values.
    impulses : numpy.ndarray
        n rows; x = impulses[:, 0] delta(t) + impulses[:, 1] delta'(t) + ... there.
    """

    t: float
    before: np.ndarray
    after: np.ndarray
    impulses: np.ndarray


def _address(array: np.ndarray | None) -> Any:
    return ffi.NULL if array is None else ffi.cast("double*", array.ctypes.data)


class Modes:
    """The part of a solver that handles breakpoints and jumps."""

    problem: Any
    _call: Callable[..., int]

    def set_breakpoints(self, times: Sequence[float], kinds: Any = "kink") -> None:
        """Sets the times at which data have kinks or jumps: steps end there. See
        sfdae_set_breakpoints.

        Parameters
        ----------
        times : sequence of float
            Increasing; none: no breakpoints.
        kinds : str or sequence of str
            "kink": differential variables remain continuous; "jump": x may jump, and values are
            computed from impulses of the equations, as in jump(). One for all, or one for each.
        """
        values = np.array(times, dtype=float, ndmin=1)
        names = [kinds] * values.size if isinstance(kinds, str) else list(kinds)
        if len(names) != values.size:
            raise ValueError(f"there are {len(names)} kinds for {values.size} breakpoints")
        unknown = [name for name in names if name not in _KINDS]
        if unknown:
            raise ValueError(f"a breakpoint is a 'kink' or a 'jump', not {unknown[0]!r}")
        c_kinds = ffi.new("int[]", [_KINDS[name] for name in names])
        self._call(lib.sfdae_set_breakpoints, values.size, _address(values), c_kinds)

    @property
    def last_jump(self) -> Jump:
        """The last jump crossed at a breakpoint, with only the impulse of order 0."""
        n = self.problem.num_unknowns
        t = ffi.new("double*")
        before, after = np.empty((2, n))
        impulses = np.empty((n, 1))
        self._call(
            lib.sfdae_get_jump, t, _address(before), _address(after), _address(impulses)
        )
        return Jump(t[0], before, after, impulses)

    def jump(self, t: float, before: Any, toward: float, orders: int = 1) -> Jump:
        """The initial values of these equations at t after other equations led to `before`, from
        impulses of these equations; to continue, call start() with `after`. See sfdae_jump.

        Parameters
        ----------
        t, toward : float
            Not equal.
        before : array_like or mapping
            n values, or values by name.
        orders : int
            Number of impulses to be computed, of delta, delta', ...
        """
        values = self.problem.values(before, "before")
        after = np.array(values)
        impulses = np.zeros((values.size, max(orders, 0)), order="F")
        self._call(
            lib.sfdae_jump,
            t,
            toward,
            _address(values),
            _address(after),
            orders,
            _address(impulses if orders > 0 else None),
        )
        return Jump(float(t), np.array(values), after, impulses)

    def impact(self, t: float, before: Any, restitution: Any = None) -> Jump:
        """The velocities of a mechanical system after an impact. See sfdae_impact.

        Parameters
        ----------
        t : float
        before : array_like or mapping
            n values, or values by name.
        restitution : array_like, optional
            A coefficient from 0 to 1 for each constraint, holonomic ones first; None: 0.

        Returns
        -------
        Jump
            Impulses of the constraints in the rows of lambda and kappa.
        """
        values = self.problem.values(before, "before")
        after = np.array(values)
        count = 0
        if self.problem.kind == "multibody":
            count = self.problem.num_constraints + self.problem.num_nonholonomic
        coefficients = None
        if restitution is not None:
            coefficients = np.array(restitution, dtype=float, ndmin=1)
            if self.problem.kind == "multibody" and coefficients.shape != (count,):
                raise ValueError(
                    f"restitution has {coefficients.size} entries for {count} constraints"
                )
        impulses = np.zeros((values.size, 1))
        forces = np.zeros(count)
        self._call(
            lib.sfdae_impact,
            t,
            _address(coefficients),
            _address(values),
            _address(after),
            _address(forces if count > 0 else None),
        )
        impulses[values.size - count :, 0] = forces
        return Jump(float(t), np.array(values), after, impulses)
