# SPDX-License-Identifier: BSD-3-Clause
"""Descriptor systems E x' = A x + B u, y = C x + D u: poles, zeros, transfer functions."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from ._binding import ffi, lib
from ._status import Error, Status
from ._structs import Struct, members, prepared


def _real_matrix(name: str, values: Any, rows: int | None, columns: int | None) -> np.ndarray:
    array = np.array(values, dtype=float, order="F")
    expected = tuple("any" if size is None else size for size in (rows, columns))
    fits = array.ndim == 2 and all(e in ("any", s) for s, e in zip(array.shape, expected))
    if not fits:
        raise ValueError(f"{name} has shape {array.shape}, not {expected}")
    return array


def _doubles(array: np.ndarray | None) -> Any:
    return ffi.NULL if array is None else ffi.cast("double*", array.ctypes.data)


class Spectrum(NamedTuple):
    """Finite eigenvalues of a pencil, sorted by size, with estimates of their absolute errors and
    other properties: num_infinite, strangeness_index, ...; see sfdae_get_poles.
    """

    values: np.ndarray
    errors: np.ndarray
    summary: Struct


class Descriptor:
    """A descriptor system: E x' = A x + B u, y = C x + D u. Solver.linearize derives them from
    problems; this class constructs one from matrices. E may be singular, of any index.

    Parameters
    ----------
    E, A : array_like
        m x n.
    B, C, D : array_like, optional
        m x q, p x n, p x q; by default there are no inputs, no outputs, and D is 0.
    rank_tol : float, optional
        As in the options, for poles and zeros.

    Raises
    ------
    ValueError
        For shapes that do not match.
    Error
        ``ILLEGAL_ARGUMENT`` for numbers that are not finite.
    """

    def __init__(
        self, E: Any, A: Any, B: Any = None, C: Any = None, D: Any = None, *, rank_tol: float = 0.0
    ) -> None:
        E = _real_matrix("E", E, None, None)
        m, n = E.shape
        B = np.zeros((m, 0), order="F") if B is None else _real_matrix("B", B, m, None)
        C = np.zeros((0, n), order="F") if C is None else _real_matrix("C", C, None, n)
        shape = (C.shape[0], B.shape[1])
        arrays = {"E": E, "A": _real_matrix("A", A, m, n), "B": B, "C": C}
        arrays["D"] = np.zeros(shape, order="F") if D is None else _real_matrix("D", D, *shape)
        c = prepared("descriptor_matrices")
        c.num_equations, c.num_unknowns, c.num_outputs, c.num_inputs = m, n, *shape
        c.rank_tol = rank_tol
        for name, array in arrays.items():
            setattr(c, name, _doubles(array) if array.size else ffi.NULL)
        box = ffi.new("sfdae_descriptor**")
        status = lib.sfdae_create_descriptor(c, box)
        if status < 0:
            raise Error(Status(status), ffi.string(lib.sfdae_message(ffi.NULL)).decode())
        self._take(box)

    def _take(self, box: Any) -> None:
        self._box = ffi.gc(box, lib.sfdae_destroy_descriptor)

    @classmethod
    def _of(cls, box: Any) -> Descriptor:
        descriptor = cls.__new__(cls)
        descriptor._take(box)
        return descriptor

    def __reduce__(self) -> tuple[Any, ...]:
        return Descriptor, (self.E, self.A, self.B, self.C, self.D)

    def _checked(self, status: int) -> None:
        if status < 0:
            text = ffi.string(lib.sfdae_descriptor_message(self._box[0])).decode(errors="replace")
            raise Error(Status(status), text)

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """m, n, q, p: numbers of equations, unknowns, inputs and outputs."""
        sizes = ffi.new("int[4]")
        lib.sfdae_get_descriptor_sizes(self._box[0], sizes, sizes + 1, sizes + 2, sizes + 3)
        return tuple(sizes)

    def _matrix(self, which: int) -> np.ndarray:
        m, n, q, p = self.shape
        result = np.zeros([(m, n), (m, n), (m, q), (p, n), (p, q)][which], order="F")
        places = [ffi.NULL] * 5
        places[which] = _doubles(result)
        lib.sfdae_get_descriptor_matrices(self._box[0], *places)
        return result

    @property
    def E(self) -> np.ndarray:
        """m x n."""
        return self._matrix(0)

    @property
    def A(self) -> np.ndarray:
        """m x n."""
        return self._matrix(1)

    @property
    def B(self) -> np.ndarray:
        """m x q."""
        return self._matrix(2)

    @property
    def C(self) -> np.ndarray:
        """p x n."""
        return self._matrix(3)

    @property
    def D(self) -> np.ndarray:
        """p x q."""
        return self._matrix(4)

    def _spectrum(self, function: Callable[..., int]) -> Spectrum:
        parts = np.zeros((3, self.shape[1]))
        struct = prepared("spectrum")
        self._checked(function(self._box[0], struct, *(_doubles(part) for part in parts)))
        count = struct.num_finite
        return Spectrum(parts[0, :count] + 1j * parts[1, :count], parts[2, :count], members(struct))

    def poles(self) -> Spectrum:
        """The finite eigenvalues of lambda E - A; the summary has the number of infinite ones.

        Raises
        ------
        Error
            ``SINGULAR`` for a singular pencil, ``RANK_UNCLEAR``, ``INDEX_TOO_HIGH``,
            ``CHARACTERISTICS_CHANGED`` if solutions have another number of modes.
        """
        return self._spectrum(lib.sfdae_get_poles)

    def zeros(self) -> Spectrum:
        """Invariant zeros: the finite eigenvalues of [s E - A, -B; C, D], square or not."""
        return self._spectrum(lib.sfdae_get_zeros)

    def transfer(self, s: Any) -> np.ndarray:
        """H(s) = C (s E - A)^-1 B + D.

        Parameters
        ----------
        s : array_like
            Complex numbers, ``1j * omega`` for a frequency response.

        Returns
        -------
        ndarray
            The shape of s, followed by p x q.

        Raises
        ------
        Error
            ``SINGULAR`` if one of them is a pole.
        """
        numbers = np.array(s, dtype=complex)
        flat = numbers.reshape(-1)
        real, imaginary = flat.real.copy(), flat.imag.copy()
        _, _, q, p = self.shape
        parts = np.zeros((2, flat.size, q, p))
        self._checked(
            lib.sfdae_get_transfer(
                self._box[0], flat.size, *(_doubles(a) for a in (real, imaginary, *parts))
            )
        )
        H = (parts[0] + 1j * parts[1]).transpose(0, 2, 1)
        return H.reshape(*numbers.shape, p, q)


class Linearizing:
    """The part of a solver that linearizes its problem."""

    problem: Any
    _call: Callable[..., int]

    def linearize(
        self,
        t: float = 0.0,
        *,
        x: Any = None,
        xdot: Any = None,
        input_parameters: Sequence[str] = (),
        input_unknowns: Sequence[Any] = (),
        input_columns: Any = None,
        output_unknowns: Sequence[Any] = (),
        output_rows: Any = None,
    ) -> Descriptor:
        """The descriptor system of the problem, linearized at a point; see sfdae_linearize.

        Parameters
        ----------
        t : float
        x : array_like or mapping, optional
            n values; by default the solution at t.
        xdot : array_like, optional
            n values; by default those of the solution through x.
        input_parameters : sequence of str
            Named parameters that are inputs, before all other inputs.
        input_unknowns : sequence of int or str
            Unknowns that are inputs: one more equation each.
        input_columns : array_like, optional
            m x k right-hand sides.
        output_unknowns : sequence of int or str
            Unknowns that are outputs, before all other outputs.
        output_rows : array_like, optional
            k x n combinations of unknowns.

        Returns
        -------
        Descriptor
            It does not depend on the solver and does not change with it.
        """
        m, n = self.problem.num_equations, self.problem.num_unknowns
        c = prepared("linearization")
        keep: list[Any] = []

        def kept(values: Any) -> Any:
            keep.append(values)
            return values

        c.t = t
        if x is not None:
            c.x = _doubles(kept(self.problem.values(x, "x")))
        if xdot is not None:
            c.xdot = _doubles(kept(self.problem.values(xdot, "xdot")))
        texts = [kept(ffi.new("char[]", name.encode())) for name in input_parameters]
        c.num_input_parameters = len(texts)
        c.input_parameters = kept(ffi.new("char*[]", texts))
        inputs = [self.problem.index(unknown) for unknown in input_unknowns]
        c.num_input_unknowns, c.input_unknowns = len(inputs), kept(ffi.new("int[]", inputs))
        outputs = [self.problem.index(unknown) for unknown in output_unknowns]
        c.num_output_unknowns, c.output_unknowns = len(outputs), kept(ffi.new("int[]", outputs))
        if input_columns is not None:
            columns = kept(_real_matrix("input_columns", input_columns, m, None))
            c.num_input_columns, c.input_columns = columns.shape[1], _doubles(columns)
        if output_rows is not None:
            rows = kept(_real_matrix("output_rows", output_rows, None, n))
            c.num_output_rows, c.output_rows = rows.shape[0], _doubles(rows)
        box = ffi.new("sfdae_descriptor**")
        self._call(lib.sfdae_linearize, c, box)
        return Descriptor._of(box)
