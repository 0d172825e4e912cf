# SPDX-License-Identifier: BSD-3-Clause
"""Initial value problems for differential-algebraic equations of arbitrary index.

    F(t, x, x') = 0   or   E(t) x' = A(t) x + f(t),   m equations, n unknowns

Equations are written once, as a Python function of expressions; the library records and
differentiates them, finds the strangeness index, makes the initial values consistent and integrates
so that all constraints, hidden ones included, hold::

    import sfdae

    def pendulum(t, x, xdot, g=9.81):
        px, py, u, v, force = x
        balance = [xdot[2] + 2 * px * force, xdot[3] + 2 * py * force + g]
        return [xdot[0] - u, xdot[1] - v, *balance, px**2 + py**2 - 1]

    sol = sfdae.solve(pendulum, (0, 10), [0.6, -0.8, 0, 0, 0])
    sol.plot()

Functions: solve, solve_ensemble, analyze, make_consistent. Problems: NonlinearProblem,
LinearProblem, MultibodyProblem. Step by step: Solver. Functions of expressions, beside numpy's:
sfdae.sin, ..., sfdae.choose.

Small matrices run fastest with one BLAS thread: set OPENBLAS_NUM_THREADS=1 before the first import
of numpy.
"""

import importlib
from typing import TYPE_CHECKING

try:
    from . import _binding as _compiled  # noqa: F401
except ImportError as error:
    raise ImportError(
        f"sfdae in {__path__[0]} has no compiled module ({error}). Install the package with "
        "pip install ./python, or put <build>/python on the path; Python must not run in the "
        "directory of its sources"
    ) from error

from ._arrays import ExpressionArray
from ._derivative_array import split_derivative_array
from ._ensemble import EnsembleSolution, solve_ensemble
from ._events import Event, EventRecord
from ._expression import Condition, Expression, parameter
from ._functions import PUBLIC as _PUBLIC
from ._functions import choose, derivative, external, time_derivative
from ._inspection import (
    ConditionSwitch,
    DerivativeArray,
    ExtendedSystem,
    Projectors,
    StrangenessFreeSystem,
    Structure,
)
from ._hybrid import Hybrid
from ._linearization import Descriptor, Spectrum
from ._branches import SingularPoint
from ._modes import Jump
from ._multibody import MultibodyProblem
from ._options import OPTION_NAMES, choices
from ._linear_problem import LinearProblem
from ._problem import NonlinearProblem, Problem
from ._recorded_solution import RecordedSolution
from ._report import Report
from ._solution import Solution, Steps
from ._solve import analyze, make_consistent, solve
from ._points import Point, Progress
from ._solver import Solver
from ._status import (
    CannotEvaluate,
    Error,
    InitialValuesWarning,
    IntegrationWarning,
    SfdaeWarning,
    Status,
    status_name,
    version,
)
from ._structs import Struct
from ._switch import Switch
from ._table import table
from ._transition import Passage, Transition
from ._types import Function as _Function

sqrt: _Function
exp: _Function
log: _Function
log10: _Function
sin: _Function
cos: _Function
tan: _Function
arcsin: _Function
arccos: _Function
arctan: _Function
arctan2: _Function
sinh: _Function
cosh: _Function
tanh: _Function
absolute: _Function
minimum: _Function
maximum: _Function
sign: _Function
floor: _Function
mod: _Function
globals().update(_PUBLIC)  # sin, cos, exp, ... of expressions, numbers and arrays



if not TYPE_CHECKING:  # type checkers would accept any name

    def __getattr__(name: str) -> object:
        """Imports sfdae.torch when it is used, since PyTorch is large and may be missing."""
        if name == "torch":
            return importlib.import_module(".torch", __name__)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__version__ = version()
__all__ = [
    "CannotEvaluate", "Condition", "ConditionSwitch", "DerivativeArray", "Descriptor", "EnsembleSolution", "Error",
    "Event", "EventRecord", "Expression", "ExpressionArray", "ExtendedSystem", "Hybrid", "InitialValuesWarning",
    "IntegrationWarning", "Jump", "LinearProblem", "MultibodyProblem", "NonlinearProblem", "OPTION_NAMES",
    "Passage", "Point", "Problem", "Progress", "Projectors", "RecordedSolution", "Report", "SfdaeWarning",
    "SingularPoint",
    "Solution", "Solver", "Spectrum",
    "Status", "Steps", "StrangenessFreeSystem", "Struct", "Structure", "analyze", "choices", "choose",
    "derivative", "external", "table", "time_derivative", "Transition", "Switch",
    "make_consistent", "parameter", "solve", "solve_ensemble", "split_derivative_array", "status_name", "version",
    *_PUBLIC,
]  # fmt: skip
