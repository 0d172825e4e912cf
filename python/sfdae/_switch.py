# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces between modes of a hybrid system."""

from __future__ import annotations

from typing import Any, Callable

from ._arrays import vector
from ._callbacks import callback
from ._expression import Expression, Recording, as_expression
from ._formula import Formula, parameter_values
from ._problem import Problem


class Switch:
    """A surface g(t, x) = 0 between two modes, and the mode of the motion along it if both lead
    toward it. See sfdae_add_switch.

    Parameters
    ----------
    below, above : str
        Modes, of recorded equations, for g < 0 and for g > 0.
    surface : callable
        ``surface(t, x, ...)`` returns the formula g. Its other arguments are named parameters:
        those that are also in the modes have the same value there, and others keep their defaults.
    name : str
        Name of the sliding mode.
    """

    def __init__(
        self, below: str, above: str, surface: Callable[..., Any], name: str = "sliding"
    ) -> None:
        self.below, self.above, self.name = below, above, name
        self.surface = Formula(surface, ("t", "x"), "surface")


class SurfaceState:
    """The `user` argument of the callback of a switch."""

    def __init__(self, switch: Switch, problem: Problem) -> None:
        switch.surface.arguments.require_same_defaults(problem.parameters, problem.parameters)
        known = {k: v for k, v in problem.parameters.items() if k in switch.surface.defaults}
        self.values = parameter_values([switch.surface], known)
        self.switch, self.n = switch, problem.num_unknowns
        self.exception: BaseException | None = None
        self.functions: dict[Any, Any] = {}  # handles of functions that the formula calls


@callback("python_equations_function")
def _surface(state: SurfaceState, record: Any, t: Any, x: Any, xdot: Any, residual: Any) -> None:
    with Recording(record, state) as recording:
        arguments = Expression(t, recording), vector(x, state.n, recording)
        value = state.switch.surface(*arguments, values=state.values)
        residual[0] = as_expression(value)._c
