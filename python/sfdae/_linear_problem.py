# SPDX-License-Identifier: BSD-3-Clause
"""Linear problems E(t) x' = A(t) x + f(t)."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np

from ._binding import lib
from ._conditions import Conditions, HasConditions
from ._formula import Formula, parameter_values
from ._matrices import Matrices, coefficient
from ._problem import Prescribed, Problem


class LinearProblem(HasConditions, Matrices, Problem):
    """E(t) x' = A(t) x + f(t), m equations for n unknowns.

    Each of E, A and f is an array, or a function: of ``(t)``, which is called when a solver is
    created and returns formulas in the expression t (further arguments are named parameters); or of
    ``(t, order)``, which is called at every point and returns the derivative of this order as
    numbers, or None if it is not available. If one of them is a function of ``(t, order)``, all
    have to be such functions or arrays.

    Parameters
    ----------
    E, A : array_like or callable
        m x n.
    f : array_like or callable, optional
        m entries; 0 by default.
    num_equations, num_unknowns : int, optional
        Required if neither E nor A is an array; m is n by default.
    names, units, equation_names, parameters, prescribed
        As for NonlinearProblem.
    E_pattern, A_pattern : pair of array_like, optional
        For functions of (t, order): sparsity, as F_x_pattern of NonlinearProblem.
    matrices : {"dense", "compressed"}, optional
        "compressed": E and A, arrays or functions, are the entries in the order of their patterns.
    conditions : callable or sequence of callable, optional
        For functions of (t, order): as for NonlinearProblem, read from the attribute ``branches``.
    """

    def __init__(
        self,
        E: Any,
        A: Any,
        f: Any = None,
        *,
        num_equations: int | None = None,
        num_unknowns: int | None = None,
        names: Sequence[str] | None = None,
        units: Mapping[str, str] | Sequence[str] | None = None,
        equation_names: Sequence[str] | None = None,
        parameters: Mapping[str, Any] | None = None,
        prescribed: Prescribed | None = None,
        E_pattern: Any = None,
        A_pattern: Any = None,
        matrices: str = "dense",
        conditions: Conditions | None = None,
    ) -> None:
        dimension = 1 if matrices == "compressed" else 2
        self.coefficients = {
            "E": coefficient("E", E, dimension, parameters),
            "A": coefficient("A", A, dimension, parameters),
        }
        if f is not None:
            self.coefficients["f"] = coefficient("f", f, 1, parameters)
        patterns = {"E": E_pattern, "A": A_pattern}
        if num_unknowns is None and names is None and E_pattern is not None:
            num_unknowns = len(E_pattern[0]) - 1
        m, n = self._shape(num_equations, num_unknowns, names, matrices == "compressed")
        self._set_unknowns(n, names, units)
        self._set_equation_names(equation_names)
        self.num_equations = m
        self._set_patterns(patterns, matrices)
        if matrices != "dense":
            self._check_entries()
        functions = {name: part for name, part in self.coefficients.items() if callable(part)}
        callbacks = [
            name for name, function in functions.items() if not isinstance(function, Formula)
        ]
        formulas = [name for name in functions if name not in callbacks]
        if callbacks and formulas:
            raise TypeError(
                f"{formulas[0]} is a function of t, which is recorded, and {callbacks[0]} one of "
                "(t, order), which is called at every point: give functions of one kind"
            )
        self.kind = "linear" if callbacks or not formulas else "nonlinear"
        if self.patterns and self.kind != "linear":
            raise TypeError("patterns are for functions of (t, order): those of formulas are known")
        self.parameters = parameter_values([functions[name] for name in formulas], parameters)
        self._set_conditions(conditions)
        if self.conditions and self.kind != "linear":
            raise TypeError("conditions are for functions of (t, order)")
        self._set_prescribed(prescribed)

    def _shape(
        self, m: int | None, n: int | None, names: Sequence[str] | None, is_compressed: bool
    ) -> tuple[int, int]:
        if n is None and names is not None:
            n = len(names)
        for part in () if is_compressed else ("E", "A"):
            matrix = self.coefficients[part]
            if isinstance(matrix, np.ndarray):
                m = matrix.shape[0] if m is None else m
                n = matrix.shape[1] if n is None else n
        if n is None:
            raise TypeError("num_unknowns or names is needed where neither E nor A is an array")
        m = n if m is None else m
        for part, expected in (("E", (m, n)), ("A", (m, n)), ("f", (m,))):
            if is_compressed and part != "f":
                continue
            array = self.coefficients.get(part)
            if isinstance(array, np.ndarray) and array.shape != expected:
                raise ValueError(f"{part} has shape {array.shape}, not {expected}")
        return int(m), int(n)

    def _numbers(self, values: Mapping[str, Any]) -> dict[str, Any]:
        if self.kind != "linear":
            return {}
        return {name: part for name, part in self.coefficients.items() if not callable(part)}

    def _fill(self, c: Any, keep: list[Any]) -> None:
        c.num_equations, c.num_unknowns = self.num_equations, self.num_unknowns
        self._fill_prescribed(c, keep)
        self._fill_conditions(c, keep)
        self._fill_equation_names(c, keep)
        if self.kind == "nonlinear":
            c.linear_equations = lib.python_nonlinear_problem_linear_equations
            return
        for part in self.coefficients:
            setattr(c, part, getattr(lib, f"python_linear_problem_{part}"))
        c.constant_E = isinstance(self.coefficients["E"], np.ndarray)
        c.constant_A = isinstance(self.coefficients["A"], np.ndarray)
        self._fill_patterns(c, keep)
