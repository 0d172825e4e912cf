# SPDX-License-Identifier: BSD-3-Clause
"""Results of a solver: index analysis, report, statistics, objects of the theory, checks of
derivatives.
"""

from __future__ import annotations

from typing import Any, Callable, NamedTuple

import numpy as np

from ._binding import ffi, lib
from ._structs import Struct, filled, members, prepared


class DerivativeArray(NamedTuple):
    """M y = N x + g of a linear problem, M dy = N dx + g of others: sfdae_get_derivative_array."""

    M: np.ndarray
    N: np.ndarray
    g: np.ndarray


class Projectors(NamedTuple):
    """Projectors with orthonormal columns; see sfdae_get_projectors."""

    Z1: np.ndarray
    Z2: np.ndarray | None
    Z3: np.ndarray | None
    T2: np.ndarray


class StrangenessFreeSystem(NamedTuple):
    """E1 x' = A1 x + f1, 0 = A2 x + f2, or that for changes; see sfdae_get_strangeness_free."""

    E1: np.ndarray
    A1: np.ndarray
    f1: np.ndarray
    A2: np.ndarray
    f2: np.ndarray
    residual: float


class ExtendedSystem(NamedTuple):
    """The extended system of a mechanical system; see sfdae_get_extended_system."""

    Qq: np.ndarray
    Qv: np.ndarray
    E: np.ndarray
    A: np.ndarray
    f: np.ndarray
    w: np.ndarray


class Structure(NamedTuple):
    """The structure of recorded equations; see sfdae_get_structure."""

    summary: Struct
    differentiations: np.ndarray
    orders: np.ndarray
    assigned: np.ndarray
    block: np.ndarray
    words: str


class ConditionSwitch(NamedTuple):
    """A switch of recorded equations; see sfdae_get_switch.

    Attributes
    ----------
    t : float
        The zero of the condition: located, or from linear interpolation within the step.
    condition : str
        ``"sin(t) - x[0] > 0"``, as text of C.
    before, after : float
        Branches: 1 if the condition holds, else 0; the integer of a floor or remainder of t; the
        number of knots of a table of t up to there.
    jumps : bool
        Differential unknowns jump there, by impulses.
    """

    t: float
    condition: str
    before: float
    after: float
    jumps: bool


def _matrix(rows: int, columns: int) -> np.ndarray:
    return np.zeros((rows, columns), order="F")


def _address(array: np.ndarray | None) -> Any:
    return ffi.NULL if array is None else ffi.cast("double*", array.ctypes.data)


class Inspection:
    """The part of a solver that returns results. The headers explain the members of structs."""

    problem: Any
    _call: Callable[..., int]
    _box: Any

    def _filled(self, name: str, function: Callable[..., int]) -> Struct:
        return filled(name, lambda struct: self._call(function, struct))

    # ---- Results ---------------------------------------------------------------------------------

    @property
    def characteristics(self) -> Struct:
        """The characteristic values in use: strangeness_index, differential, algebraic,
        undetermined, ...
        """
        return self._filled("characteristics", lib.sfdae_get_characteristics)

    @property
    def decisions(self) -> list[Struct]:
        """All rank decisions of the last analysis, successful or not."""
        count = ffi.new("int*")
        self._call(lib.sfdae_get_num_decisions, count)
        struct = prepared("decision")
        result = []
        for i in range(count[0]):
            self._call(lib.sfdae_get_decision, i, struct)
            result.append(members(struct))
        return result

    @property
    def change(self) -> Struct:
        """The place of the last ``CHARACTERISTICS_CHANGED``."""
        return self._filled("change", lib.sfdae_get_change)

    @property
    def initial_report(self) -> Struct:
        """Changes of the initial values by the last start() or make_consistent()."""
        return self._filled("initial_report", lib.sfdae_get_initial_report)

    @property
    def statistics(self) -> Struct:
        """Counts and step sizes of the current integration."""
        return self._filled("statistics", lib.sfdae_get_statistics)

    @property
    def switches(self) -> list[ConditionSwitch]:
        """Switches of conditions that the integration has passed since start() or
        restore_checkpoint(), ordered by time.
        """
        count = ffi.new("long*")
        self._call(lib.sfdae_get_num_switches, count)
        struct, needed = prepared("switch"), ffi.new("size_t*")
        conditions: dict[int, str] = {}
        result = []
        for i in range(count[0]):
            self._call(lib.sfdae_get_switch, i, struct, ffi.NULL, 0, ffi.NULL)
            condition = conditions.get(struct.condition)
            if condition is None:
                self._call(lib.sfdae_get_switch, i, struct, ffi.NULL, 0, needed)
                text = ffi.new("char[]", needed[0])
                self._call(lib.sfdae_get_switch, i, struct, text, needed[0], needed)
                condition = conditions[struct.condition] = ffi.string(text).decode()
            branches = (struct.before, struct.after)
            result.append(ConditionSwitch(struct.t, condition, *branches, bool(struct.jumps)))
        return result

    @property
    def multibody_report(self) -> Struct:
        """Constraints, freedom and partition of a mechanical system at the point reached."""
        return self._filled("multibody_report", lib.sfdae_get_multibody_report)

    def report(self) -> str:
        """The diagnostics report as text: index analysis with every rank decision, initial values,
        integration.
        """
        needed = ffi.new("size_t*")
        self._call(lib.sfdae_report, ffi.NULL, 0, needed)
        text = ffi.new("char[]", needed[0])
        self._call(lib.sfdae_report, text, needed[0], ffi.NULL)
        return self.problem.with_names(ffi.string(text).decode(errors="replace"))

    def export_source(self, name: str, language: str = "c") -> str:
        """Source text of a strangeness-free system F(t, z, z') = 0 with the solutions of recorded
        equations, for use without the library; see sfdae_export_source.

        Parameters
        ----------
        name
            Prefix of its function names: letters, digits and underscores, beginning with a letter.
        language
            "c" (C99) or "fortran" (a module of Fortran 2008).
        """
        languages = {"c": lib.SFDAE_SOURCE_C, "fortran": lib.SFDAE_SOURCE_FORTRAN}
        if language not in languages:
            raise ValueError(f"language is {language!r}, none of {', '.join(languages)}")
        arguments = (languages[language], name.encode())
        needed = ffi.new("size_t*")
        self._call(lib.sfdae_export_source, *arguments, ffi.NULL, 0, needed)
        text = ffi.new("char[]", needed[0])
        self._call(lib.sfdae_export_source, *arguments, text, needed[0], ffi.NULL)
        return ffi.string(text).decode(errors="replace")

    def certify(self) -> float:
        """Certifies the ranks of the analysis.

        Returns
        -------
        float
            The approximate smallest relative change of the data that changes the characteristic
            values; at most 1.
        """
        distance = ffi.new("double*")
        self._call(lib.sfdae_certify, distance)
        return distance[0]

    def structure(self) -> Structure:
        """Structural analysis of recorded equations and its numerical confirmation.

        Returns
        -------
        Structure
            For square systems.
        """
        n = self.problem.num_unknowns
        arrays = [np.zeros(n, dtype=np.intc) for _ in range(4)]
        summary = self._filled(
            "structure",
            lambda solver, struct: lib.sfdae_get_structure(
                solver, struct, *(ffi.cast("int*", array.ctypes.data) for array in arrays)
            ),
        )
        agrees = summary.has_assignment and summary.verdict <= lib.SFDAE_STRUCTURE_CERTIFIED
        return Structure(summary, *arrays, words="" if agrees else self.message)

    # ---- The theory's objects --------------------------------------------------------------------

    def jet(self, t: float, level: int, x: Any = None) -> np.ndarray:
        """The derivatives x, x', ..., x^(level+1) for which F and its derivatives vanish, n x
        (level + 2).

        Parameters
        ----------
        t : float
        level : int
            0 ... 12.
        x : array_like or mapping, optional
            Consistent values; by default the solution at t within the last step.
        """
        result = _matrix(self.problem.num_unknowns, level + 2)
        values = None if x is None else self.problem.values(x, "x")
        self._call(lib.sfdae_get_jet, t, _address(values), level, _address(result))
        return result

    def derivative_array(self, t: float, level: int, jet: Any = None) -> DerivativeArray:
        """The derivative array of a level, 0 ... 12, at t, or for changes of a jet, n x (level +
        2).
        """
        m, n = self.problem.num_equations, self.problem.num_unknowns
        rows = (level + 1) * m
        M, N, g = _matrix(rows, (level + 1) * n), _matrix(rows, n), np.zeros(rows)
        results = (level, _address(M), _address(N), _address(g))
        if jet is None:
            self._call(lib.sfdae_get_derivative_array, t, *results)
        else:
            jet = self._jet(jet, level + 2)
            self._call(lib.sfdae_get_derivative_array_at, t, _address(jet), *results)
        return DerivativeArray(M, N, g)

    def _jet(self, jet: Any, columns: int) -> np.ndarray:
        array = np.array(jet, dtype=float, order="F")
        expected = (self.problem.num_unknowns, columns)
        if array.shape != expected:
            raise ValueError(f"jet has shape {array.shape}, not {expected}")
        return array

    def projectors(self, t: float, jet: Any = None, with_array: bool = True) -> Projectors:
        """Z1, Z2, Z3 and T2 at t, or at a jet, n x (mu + 2).

        If with_array is False, Z2 and Z3 are None: callbacks of mechanical systems have no
        derivative array.
        """
        c = self.characteristics
        m, n = self.problem.num_equations, self.problem.num_unknowns
        rows = (c.strangeness_index + 1) * m
        if jet is None:
            start: tuple[Any, ...] = (lib.sfdae_get_projectors, t)
        else:
            jet = self._jet(jet, c.strangeness_index + 2)
            start = (lib.sfdae_get_projectors_at, t, _address(jet))
        Z2 = Z3 = None
        if with_array:
            vhat = ffi.new("int*")
            self._call(*start, ffi.NULL, ffi.NULL, ffi.NULL, ffi.NULL, vhat)
            Z2, Z3 = _matrix(rows, c.algebraic), _matrix(rows, vhat[0])
        Z1, T2 = _matrix(m, c.differential), _matrix(n, n - c.algebraic)
        self._call(*start, _address(Z1), _address(Z2), _address(Z3), _address(T2), ffi.NULL)
        return Projectors(Z1, Z2, Z3, T2)

    def strangeness_free_system(self, t: float, jet: Any = None) -> StrangenessFreeSystem:
        """The strangeness-free system at t, or for changes of a jet, n x (mu + 2), for mechanical
        systems n x 2.
        """
        c = self.characteristics
        n = self.problem.num_unknowns
        E1, A1, f1 = (
            _matrix(c.differential, n),
            _matrix(c.differential, n),
            np.zeros(c.differential),
        )
        A2, f2, residual = _matrix(c.algebraic, n), np.zeros(c.algebraic), ffi.new("double*")
        results = [_address(part) for part in (E1, A1, f1, A2, f2)]
        if jet is None:
            self._call(lib.sfdae_get_strangeness_free, t, *results, residual)
        else:
            columns = 2 if self.problem.kind == "multibody" else c.strangeness_index + 2
            jet = self._jet(jet, columns)
            self._call(lib.sfdae_get_strangeness_free_at, t, _address(jet), *results, residual)
        return StrangenessFreeSystem(E1, A1, f1, A2, f2, residual[0])

    def extended_system(self, t: float, x: Any = None) -> ExtendedSystem:
        """The extended system of a mechanical system at (t, x), by default at the solution at t."""
        report = self.multibody_report
        nq, nv = self.problem.num_positions, self.problem.num_velocities
        dependent = nq - report.position_freedom + nv - report.degrees_of_freedom
        size = self.problem.num_unknowns + dependent
        result = ExtendedSystem(
            _matrix(nq, nq), _matrix(nv, nv), _matrix(size, size), _matrix(size, size),
            np.zeros(size), np.zeros(dependent),
        )  # fmt: skip
        values = None if x is None else self.problem.values(x, "x")
        self._call(
            lib.sfdae_get_extended_system, t, _address(values), *(_address(part) for part in result)
        )
        return result

    # ---- Checks of derivatives -------------------------------------------------------------------

    def check_derivatives(self, t: float, max_order: int, jet: Any = None) -> Struct:
        """Compares derivatives from callbacks with finite differences; returns the worst mismatch.

        Parameters
        ----------
        t : float
        max_order : int
            Highest order to be compared.
        jet : array_like, optional
            For total_derivative: n x (max_order + 2), preferably without zeros.
        """
        if self.problem.kind == "linear":
            return filled(
                "derivative_check",
                lambda struct: self._call(lib.sfdae_check_derivatives, t, max_order, struct),
            )
        n = self.problem.num_unknowns
        default = 1.0 / (2.0 + np.arange(n * (max_order + 2)).reshape(n, max_order + 2))
        values = self._jet(default if jet is None else jet, max_order + 2)
        return filled(
            "derivative_check",
            lambda struct: self._call(
                lib.sfdae_check_total_derivatives, t, _address(values), max_order, struct
            ),
        )

    def check_multibody_derivatives(self, t: float, q: Any, v: Any) -> Struct:
        """Compares derivatives of constraints from callbacks with finite differences near (t, q,
        v).
        """
        positions, velocities = np.array(q, dtype=float, ndmin=1), np.array(v, dtype=float, ndmin=1)
        sizes = (
            (self.problem.num_positions, self.problem.num_velocities)
            if self.problem.kind == "multibody"
            else None
        )
        if sizes is None:
            raise TypeError("check_multibody_derivatives is for mechanical systems")
        if (positions.size, velocities.size) != sizes:
            raise ValueError(
                f"q and v have {positions.size} and {velocities.size} entries, not {sizes[0]} and "
                f"{sizes[1]}"
            )
        return filled(
            "derivative_check",
            lambda struct: self._call(
                lib.sfdae_check_multibody_derivatives,
                t,
                _address(positions),
                _address(velocities),
                struct,
            ),
        )
