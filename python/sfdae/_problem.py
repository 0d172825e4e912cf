# SPDX-License-Identifier: BSD-3-Clause
"""Problems: their common part, and nonlinear problems."""

from __future__ import annotations

import re
from typing import Any, Callable, Iterable, Mapping, Sequence, Union

import numpy as np

from ._arguments import Arguments
from ._binding import ffi, lib
from ._conditions import BRANCHES, Conditions, HasConditions
from ._equations import Equations
from ._expression import Expression
from ._formula import flatten, parameter_values
from ._matrices import MATRICES, Matrices
from ._names import as_names, c_names
from ._pickling import Picklable
from ._types import Values
from ._unknowns import Watch, by_name, require_confirmed, require_same_names

_MOST_UNKNOWNS = 50_000  # limit of the library, which checks it when a solver is created

_MISSING_ORDER = "Provide it, or set the option difference_derivatives."
_NOT_RECORDED = (
    "With record=False no equation can be differentiated: the differentiation index has to be at "
    "most 1. Record the equations, or differentiate the constraints by hand."
)

Prescribed = Mapping[Union[str, int], Callable[[float], float]]


class Problem(Picklable):
    """The common part of all problems: sizes, names and units of the unknowns, parameters.

    Attributes
    ----------
    kind : str
        ``"linear"``, ``"nonlinear"`` or ``"multibody"``: the C interface that solves it.
    num_equations, num_unknowns : int
        m and n. num_equations may be None until it is counted when a solver is created.
    names : tuple of str
        Names of the unknowns, by default ``x[0]``, ``x[1]``, ...
    units : dict
        Units by name, for plots.
    parameters : dict
        Named parameters of recorded equations and their values.
    """

    kind = ""
    records = True  # functions write formulas once, or callbacks have their derivatives
    default_options: Mapping[str, Any] = {}  # of solvers, unless others are given
    num_equations: int | None
    num_unknowns: int

    def _set_unknowns(
        self,
        count: int,
        names: Sequence[str] | None,
        units: Mapping[str, str] | Sequence[str] | None,
    ) -> None:
        if count > _MOST_UNKNOWNS:  # before creating this many names
            raise ValueError(f"{count} unknowns are too many: at most {_MOST_UNKNOWNS}")
        self._has_names = names is not None
        if names is None:
            names = [f"x[{i}]" for i in range(count)]
        elif isinstance(names, str):
            raise TypeError(f"names has to be a sequence of names, not the string {names!r}")
        self.names = tuple(str(name) for name in names)
        if len(self.names) != count:
            raise ValueError(f"there are {len(self.names)} names for {count} unknowns")
        if len(set(self.names)) != count:
            twice = next(name for name in self.names if self.names.count(name) > 1)
            raise ValueError(f"the name {twice!r} is given twice")
        self.num_unknowns = count
        units = by_name(units)
        if units is not None and not isinstance(units, Mapping):
            units = dict(zip(self.names, units))
        self.units = {name: str(unit) for name, unit in (units or {}).items() if unit}
        for name in self.units:
            if name != "t":  # the time may have one, too
                self.index(name)

    def index(self, unknown: str | int) -> int:
        """Index of an unknown given by its name or its index.

        Raises
        ------
        KeyError
            For an unknown name.
        IndexError
            For an index out of range.
        """
        if isinstance(unknown, str):
            if unknown not in self.names:
                hint = "" if self._has_names else ": give names=[...] to use others"
                known = ", ".join(self.names)
                raise KeyError(f"there is no unknown {unknown!r}; there are {known}{hint}")
            return self.names.index(unknown)
        i = int(unknown)
        if not -self.num_unknowns <= i < self.num_unknowns:
            raise IndexError(f"there is no unknown {i}: the problem has {self.num_unknowns}")
        return i % self.num_unknowns

    def values(self, given: Values, name: str = "x0", missing: Any = 0.0) -> np.ndarray:
        """Values of all unknowns as a new array.

        Parameters
        ----------
        given : array_like or mapping
            n numbers, or values by name or index, also a Series of pandas; all others have the
            value, or values, `missing`.
        name : str
            Description of the values, for messages.
        """
        given = by_name(given)
        if isinstance(given, Mapping):
            result = np.zeros(self.num_unknowns) + missing
            indices = [self.index(unknown) for unknown in given]
            if len(set(indices)) < len(indices):
                twice = next(i for i in indices if indices.count(i) > 1)
                raise ValueError(f"{name} has two values for {self.names[twice]}")
            for i, value in zip(indices, given.values()):
                result[i] = value
            return result
        result = np.array(given, dtype=float, ndmin=1)
        if result.shape != (self.num_unknowns,):
            raise ValueError(f"{name} has shape {result.shape}, not ({self.num_unknowns},)")
        return result

    def with_names(self, text: str) -> str:
        """A message of the library with names of unknowns in place of their indices."""
        if not self._has_names:
            return text

        def name(found: re.Match[str]) -> str:
            i = int(found[1])
            return self.names[i] if i < self.num_unknowns else found[0]

        return re.sub(r"\b(?:x\[|component )(\d+)\b\]?", name, text)

    def _set_equation_names(self, names: Sequence[str] | None) -> None:
        self.equation_names = None if names is None else as_names(names, "equation_names")

    def _fill_equation_names(self, c: Any, keep: list[Any]) -> None:
        if self.equation_names is not None:
            c.equation_names = c_names(self.equation_names, self.num_equations, "equations", keep)

    def _set_prescribed(self, prescribed: Prescribed | None) -> None:
        self.prescribed = {self.index(unknown): f for unknown, f in (prescribed or {}).items()}
        for unknown, function in self.prescribed.items():
            if not callable(function):
                raise TypeError(
                    f"{self.names[unknown]} is prescribed by {function!r}, which is no function"
                )
            name = f"the prescribed value of {self.names[unknown]}"
            Arguments(function, ("t",), name).require_others(self.parameters)

    def _fill_prescribed(self, c: Any, keep: list[Any]) -> None:
        c.num_prescribed = len(self.prescribed)
        if self.prescribed:
            keep.append(ffi.new("int[]", list(self.prescribed)))
            c.prescribed = keep[-1]
            c.prescribed_values = getattr(lib, f"python_{self.kind}_problem_prescribed_values")

    def _c_problem(self, keep: list[Any]) -> Any:
        """The struct of C without `user`; memory that it points to is added to `keep`."""
        c = ffi.new(f"sfdae_{self.kind}_problem*")
        getattr(lib, f"sfdae_{self.kind}_problem_init")(c, ffi.sizeof(c[0]))
        self._fill(c, keep)
        return c

    def _fill(self, c: Any, keep: list[Any]) -> None:
        raise NotImplementedError

    def _numbers(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Numbers of the problem, by name, that only Python knows; checkpoints compare them.
        values: of the parameters.
        """
        return {}

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.num_unknowns} unknowns: {', '.join(self.names[:8])})"


class NonlinearProblem(HasConditions, Matrices, Problem):
    """F(t, x, x') = 0, m equations for n unknowns.

    Parameters
    ----------
    equations : callable, optional
        ``equations(t, x, xdot, ...)`` returns the m formulas, a list or an array, nested as you
        like. It is called when a solver is created, with expressions: t, x (n) and xdot (n); the
        library records and differentiates. Further arguments are named parameters: ``def F(t, x,
        xdot, g=9.81)``. A fourth argument called ``res`` or ``out`` is an array that takes the
        residuals: ``def F(t, x, xdot, res)``.
    num_unknowns : int, optional
        n; not required if names are given.
    names, units : sequence of str, optional
        Names and units of the unknowns. units may be a dict by name, with ``"t"`` for the time.
    equation_names : sequence of str, optional
        m names for messages of the library, which then say "equation 7 (balance of mass)"; "" for
        equations without one.
    num_equations : int, optional
        m; counted by default.
    parameters : dict, optional
        Values of named parameters that replace defaults; an array makes an array of parameters.
    total_derivative : callable, optional
        Instead of equations: ``total_derivative(t, order, derivatives, jacobians)`` returns the
        total derivative of this order of F along a jet, or if jacobians is true ``(F, F_x,
        F_xdot)``, total derivatives of F (m) and of its Jacobians (m x n); None if the order is not
        available. derivatives: n x (order + 2), column k is the k-th derivative of x. num_equations
        is then n by default.
    derivative_array : callable, optional
        Instead of equations: ``derivative_array(t, order, derivatives, jacobian)`` returns F and
        all its total derivatives up to this order, (order + 1) m values one order after the other,
        or if jacobian is true ``(F, J)``. J is their Jacobian by x, x', ..., (order + 1) m x (order
        + 2) n; its blocks are C(k, j) F_x^(k-j) + C(k, j-1) F_xdot^(k-j+1).
    mass : float, array_like, matrix of scipy.sparse, or callable, optional
        M of M x' = f(t, x), m x n, a diagonal, a number, or a function ``M(t)`` or ``M(t, x)``; the
        equations are then ``f(t, x, ...)``. Further arguments of M are named parameters, too.
    record : bool
        False: the equations are called with numbers at every point, and Jacobians are central
        differences, so that branches, interpolators and other programs work. Each Jacobian costs
        6 n calls, fewer with patterns, and no equation can be differentiated: for differentiation
        index 0 and 1 only.
    prescribed : dict, optional
        Unknowns that the equations leave free (u > 0) as functions of time: ``{"input": np.sin}``.
        They have no parameters of the equations.
    differentiations : sequence of int, optional
        Maximum number of differentiations of each equation; see sfdae_nonlinear_problem.
    F_x_pattern, F_xdot_pattern : pair of array_like, numpy.ndarray or scipy.sparse matrix, optional
        For callbacks or record=False: sparsity by compressed columns, ``(col_start, row_index)``
        with n + 1 numbers and one row per entry, from 0, or an m x n matrix that is nonzero there:
        both matrices or none.
    matrices : {"dense", "compressed", "differences"}, optional
        Format of F_x and F_xdot from total_derivative. "compressed": the entries in the order of
        the pattern; "differences": finite differences of F are used, and jacobians is always false.
    conditions : callable or sequence of callable, optional
        For callbacks or record=False: functions ``g(t, x)`` or ``g(t, x, xdot)``, which are
        events as conditions in recorded equations are. The equations do not compare values but read
        ``branches``, an argument of this name with record=False (an array of bool) or the
        attribute: ``branches[k]`` is true if g_k > 0, or is held slightly beyond the zero.
    """

    kind = "nonlinear"

    def __init__(
        self,
        equations: Callable[..., Any] | None = None,
        num_unknowns: int | None = None,
        *,
        names: Sequence[str] | None = None,
        units: Mapping[str, str] | Sequence[str] | None = None,
        equation_names: Sequence[str] | None = None,
        num_equations: int | None = None,
        parameters: Mapping[str, Any] | None = None,
        total_derivative: Callable[..., Any] | None = None,
        derivative_array: Callable[..., Any] | None = None,
        mass: Any = None,
        record: bool = True,
        prescribed: Prescribed | None = None,
        differentiations: Iterable[int] | None = None,
        F_x_pattern: Any = None,
        F_xdot_pattern: Any = None,
        matrices: str = "dense",
        conditions: Conditions | None = None,
    ) -> None:
        if num_unknowns is None and names is None:
            raise TypeError("the number of unknowns is needed: num_unknowns or names")
        count = len(names) if num_unknowns is None else int(num_unknowns)
        if num_unknowns is not None and count != num_unknowns:
            raise TypeError(f"num_unknowns has to be an integer, not {num_unknowns!r}")
        self._set_unknowns(count, names, units)
        self._set_equation_names(equation_names)
        if num_equations is None and equation_names is not None:
            num_equations = len(equation_names)
        if [equations, total_derivative, derivative_array].count(None) != 2:
            raise TypeError("either equations or total_derivative is needed, or derivative_array")
        self.records = bool(record) or equations is None
        if not self.records:  # else finite differences would be compared with themselves
            self.default_options = {"check_derivatives": 0}
        self._counts = num_equations is None and equations is not None
        self.num_equations = self.num_unknowns if num_equations is None else int(num_equations)
        self.equations = equations if isinstance(equations, Equations) else None
        if equations is not None and self.equations is None:
            self.equations = Equations(equations, mass)
        self.total_derivative, self.derivative_array = total_derivative, derivative_array
        self._set_conditions(conditions)
        if self.conditions and self.equations is not None and self.records:
            raise TypeError("conditions are for functions called with numbers: record=False")
        self._set_parameters(parameters)
        self._must_confirm_names = False  # they were read from the equations
        self._has_checked_names = False
        self._set_prescribed(prescribed)
        self.differentiations = (
            None if differentiations is None else [int(count) for count in differentiations]
        )
        self._set_patterns({"F_x": F_x_pattern, "F_xdot": F_xdot_pattern}, matrices)

    def _set_parameters(self, given: Mapping[str, Any] | None) -> None:
        formulas = self.equations.formulas if self.equations else []
        self._takes_branches = bool(self.conditions) and any(
            BRANCHES in formula.defaults for formula in formulas
        )
        own = {BRANCHES: 0.0} if self._takes_branches else {}
        self.parameters = parameter_values(formulas, {**(given or {}), **own})
        self.parameters.pop(BRANCHES if own else "", None)

    def residual(self, t: float, x: Values, xdot: Values, **parameters: Any) -> np.ndarray:
        """Evaluates F(t, x, x') for numbers with the function that writes the equations.

        Parameters
        ----------
        t : float
        x, xdot : array_like
            n values.
        **parameters
            Values that replace those of the problem.
        """
        if self.equations is None:
            raise TypeError(
                "there are no equations to evaluate: the problem is given by its derivatives"
            )
        values = {**self.parameters, **parameters}
        if self._takes_branches:
            values.setdefault(BRANCHES, self.branches)
        values = parameter_values(self.equations.formulas, values)
        return self._evaluated(float(t), self.values(x, "x"), self.values(xdot, "xdot"), values)

    def _evaluated(self, t: float, x: Any, xdot: Any, values: Mapping[str, Any]) -> np.ndarray:
        result = self._written((t, x, xdot), values)
        if isinstance(result, np.ndarray) and result.dtype == float:
            return result.ravel()
        entries = np.array(flatten(result, "equations"))
        if np.iscomplexobj(entries):
            raise TypeError("equations returned complex values; sfdae is real")
        return entries.astype(float)

    def _written(self, arguments: tuple[Any, ...], values: Mapping[str, Any]) -> Any:
        """Calls the equations, with expressions or numbers, and checks that they unpack x under the
        names that the unknowns have: in each recording, and in the first call with numbers.
        """
        equations, (t, x, xdot) = self.equations, arguments
        count = self.num_equations
        if not self._has_names or self._has_checked_names and not isinstance(t, Expression):
            return equations(t, x, xdot, values=values, count=count)
        watch = Watch(equations.function)
        result = equations(t, watch.over(x), xdot, values=values, count=count)
        require = require_confirmed if self._must_confirm_names else require_same_names
        require(equations.function, self.names, watch.names())
        self._has_checked_names = True
        return result

    def with_names(self, text: str) -> str:
        """A message of the library; remarks on missing derivatives are adapted to record=False."""
        if not self.records:
            text = text.replace(_MISSING_ORDER, _NOT_RECORDED)
        return super().with_names(text)

    def _numbers(self, values: Mapping[str, Any]) -> dict[str, Any]:
        if self.records or self.equations is None:
            return {}
        mass = self.equations.mass
        has_mass = mass is not None and not callable(mass)
        return {**values, **({"mass": mass} if has_mass else {})}

    def _fill(self, c: Any, keep: list[Any]) -> None:
        c.num_equations, c.num_unknowns = self.num_equations, self.num_unknowns
        if self.equations is not None and self.records:
            c.equations = lib.python_nonlinear_problem_equations
        elif self.derivative_array is not None:
            c.derivative_array = lib.python_nonlinear_problem_derivative_array
        else:
            c.total_derivative = lib.python_nonlinear_problem_total_derivative
        self._fill_prescribed(c, keep)
        self._fill_conditions(c, keep)
        self._fill_equation_names(c, keep)
        if self.differentiations is not None:
            if len(self.differentiations) != self.num_equations:
                given, m = len(self.differentiations), self.num_equations
                raise ValueError(f"differentiations has {given} entries for {m} equations")
            keep.append(ffi.new("int[]", self.differentiations))
            c.differentiations = keep[-1]
        self._fill_patterns(c, keep)
        if not self.records:
            c.matrices = MATRICES.index("differences")
