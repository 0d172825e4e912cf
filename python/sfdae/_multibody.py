# SPDX-License-Identifier: BSD-3-Clause
"""Mechanical systems with constraints."""

from __future__ import annotations

from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ._binding import lib
from ._expression import Expression
from ._formula import Formula, flatten, parameter_values, probe
from ._options import constant
from ._names import as_names, c_names
from ._problem import Problem
from ._unknowns import Watch, require_same_names

# Functions that can be recorded, with the members of sfdae_multibody_formulas that receive them.
FORMULA_PLACES = {
    "mass": "M",
    "forces": "f",
    "constraints": "g",
    "kinematics": "S",
    "nonholonomic_matrix": "H",
    "nonholonomic_offset": "h",
}
# Functions that belong to callbacks only.
_DERIVATIVES = (
    "constraint_jacobian",
    "constraint_rate",
    "constraint_curvature",
    "nonholonomic_curvature",
)


class MultibodyProblem(Problem):
    """q' = S v,  M v' = f - G^T lambda - H^T kappa,  0 = g,  0 = H v + h; the unknowns are (q, v,
    lambda, kappa).

    The functions are called with expressions when a solver is created, and recorded; arguments
    after t, q and v are named parameters. With ``record=False`` they are called at every point with
    numbers, and the derivatives of the constraints must be given, too. A constant function may be
    replaced by an array; a vector in place of a square matrix is its diagonal.

    Parameters
    ----------
    num_positions : int
        nq.
    mass : array_like or callable, optional
        M, nv x nv, ``mass(t, q)``; by default the identity.
    forces : array_like or callable, optional
        f, nv entries, ``forces(t, q, v)``; by default 0.
    constraints : callable, optional
        g, nl entries, ``constraints(t, q)``.
    kinematics : array_like or callable, optional
        S, nq x nv, ``kinematics(t, q)``; by default the identity.
    nonholonomic_matrix, nonholonomic_offset : array_like or callable, optional
        H, nk x nv, and h, nk entries, of (t, q).
    num_velocities : int, optional
        nv; by default nq.
    num_constraints, num_nonholonomic : int, optional
        nl and nk; counted by default.
    record : bool
        False: functions of numbers, called at every point.
    constraint_jacobian, constraint_rate : array_like or callable, optional
        With ``record=False``: g_q, nl x nq, and g_t, nl entries (by default 0), of (t, q).
    constraint_curvature, nonholonomic_curvature : array_like or callable, optional
        With ``record=False``: gamma, nl entries, and eta, nk entries, of (t, q, v), see
        sfdae_multibody_problem; by default computed by finite differences.
    coordinates : str
        ``"orthogonal"`` or ``"permutation"``.
    constraint_names : sequence of str, optional
        For messages of the library, holonomic constraints first: "holonomic constraint 1 (length of
        the rod)"; "" for those without one.
    names, units : sequence of str, optional
        Names and units of all unknowns. By default ``q[0]``, ..., ``v[0]``, ..., ``lambda[0]``,
        ..., ``kappa[0]``, ...
    parameters : dict, optional
        Values of named parameters that replace defaults.
    """

    kind = "multibody"

    def __init__(
        self,
        num_positions: int,
        *,
        mass: Any = None,
        forces: Any = None,
        constraints: Callable[..., Any] | None = None,
        kinematics: Any = None,
        nonholonomic_matrix: Any = None,
        nonholonomic_offset: Any = None,
        num_velocities: int | None = None,
        num_constraints: int | None = None,
        num_nonholonomic: int | None = None,
        record: bool = True,
        constraint_jacobian: Any = None,
        constraint_rate: Any = None,
        constraint_curvature: Any = None,
        nonholonomic_curvature: Any = None,
        coordinates: str = "orthogonal",
        constraint_names: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        units: Mapping[str, str] | Sequence[str] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        given = {
            "mass": mass,
            "forces": forces,
            "constraints": constraints,
            "kinematics": kinematics,
            "nonholonomic_matrix": nonholonomic_matrix,
            "nonholonomic_offset": nonholonomic_offset,
            "constraint_jacobian": constraint_jacobian,
            "constraint_rate": constraint_rate,
            "constraint_curvature": constraint_curvature,
            "nonholonomic_curvature": nonholonomic_curvature,
        }
        self.records = bool(record)
        self._has_checked_names: set[str] = set()  # of functions
        self.coordinates = constant("coordinates", coordinates)
        self.num_positions = int(num_positions)
        self.num_velocities = self.num_positions if num_velocities is None else int(num_velocities)
        self._set_functions(
            {name: value for name, value in given.items() if value is not None}, parameters
        )
        self.num_constraints = self._count("constraints", num_constraints)
        self.num_nonholonomic = self._count("nonholonomic_matrix", num_nonholonomic)
        sizes = {"q": self.num_positions, "v": self.num_velocities}
        sizes.update({"lambda": self.num_constraints, "kappa": self.num_nonholonomic})
        if names is None:
            names = [f"{letter}[{i}]" for letter, size in sizes.items() for i in range(size)]
        self._set_unknowns(sum(sizes.values()), names, units)
        self.num_equations = self.num_unknowns
        self.constraint_names = (
            None if constraint_names is None else as_names(constraint_names, "constraint_names")
        )

    def _set_functions(self, given: dict[str, Any], parameters: Mapping[str, Any] | None) -> None:
        superfluous = [name for name in _DERIVATIVES if name in given and self.records]
        if superfluous:
            raise TypeError(
                f"{superfluous[0]} is computed from recorded formulas: give it with "
                "record=False only"
            )
        if not self.records and "constraints" in given and "constraint_jacobian" not in given:
            raise TypeError("constraint_jacobian is needed with record=False")
        if not self.records:
            given.setdefault("forces", np.zeros(self.num_velocities))
        self.functions: dict[str, Any] = {}
        formulas = []
        for name, value in given.items():
            if not callable(value):
                self.functions[name] = np.array(value, dtype=float)
                continue
            arguments = (
                ("t", "q", "v") if name == "forces" or name.endswith("curvature") else ("t", "q")
            )
            self.functions[name] = Formula(value, arguments, name)
            formulas.append(self.functions[name])
        if not self.records and parameters:
            raise TypeError("named parameters need recorded formulas")
        self.parameters = parameter_values(formulas, parameters)

    def _count(self, name: str, given: int | None) -> int:
        """Number of rows of a function: given, or counted."""
        if given is not None:
            return int(given)
        function = self.functions.get(name)
        if function is None:
            return 0
        if isinstance(function, np.ndarray):
            return function.shape[0]
        t, q = (
            (probe(1)[0], probe(self.num_positions))
            if self.records
            else (0.0, np.ones(self.num_positions))
        )
        value = function(t, q, values=self.parameters)
        return len(flatten(value, name)) if name == "constraints" else len(value)

    def _written(
        self, name: str, t: Any, parts: Sequence[np.ndarray], values: Mapping[str, Any]
    ) -> Any:
        """Calls a function, with expressions or numbers, and checks that it unpacks q and v under
        the names that the unknowns have: in each recording, and in the first call with numbers.
        parts: q, and v for functions of it.
        """
        function = self.functions[name]
        if name in self._has_checked_names and not isinstance(t, Expression):
            return function(t, *parts, values=values)
        watch = Watch(function.function)
        firsts = (0, self.num_positions)
        watched = [watch.over(part, first) for part, first in zip(parts, firsts)]
        result = function(t, *watched, values=values)
        require_same_names(function.function, self.names, watch.names())
        self._has_checked_names.add(name)
        return result

    def shape(self, name: str) -> tuple[int, ...]:
        """Shape of the result of a function."""
        nq, nv, nl, nk = (
            self.num_positions,
            self.num_velocities,
            self.num_constraints,
            self.num_nonholonomic,
        )
        return {
            "mass": (nv, nv),
            "forces": (nv,),
            "constraints": (nl,),
            "kinematics": (nq, nv),
            "nonholonomic_matrix": (nk, nv),
            "nonholonomic_offset": (nk,),
            "constraint_jacobian": (nl, nq),
            "constraint_rate": (nl,),
            "constraint_curvature": (nl,),
            "nonholonomic_curvature": (nk,),
        }[name]

    def _numbers(self, values: Mapping[str, Any]) -> dict[str, Any]:
        if self.records:
            return {}
        arrays = {name: part for name, part in self.functions.items() if not callable(part)}
        return {**values, **arrays}

    def _fill(self, c: Any, keep: list[Any]) -> None:
        c.num_positions, c.num_velocities = self.num_positions, self.num_velocities
        c.num_constraints, c.num_nonholonomic = self.num_constraints, self.num_nonholonomic
        c.coordinates = self.coordinates
        if self.constraint_names is not None:
            count = self.num_constraints + self.num_nonholonomic
            c.constraint_names = c_names(self.constraint_names, count, "constraints", keep)
        if self.records:
            c.equations = lib.python_multibody_problem_equations
            return
        for name in self.functions:
            setattr(c, name, getattr(lib, f"python_multibody_problem_{name}"))
