# SPDX-License-Identifier: BSD-3-Clause
"""Arguments of user-supplied functions: those that the library passes, and named parameters."""

from __future__ import annotations

import inspect
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ._unknowns import read_names, require_same_names

_ORDINALS = ("first", "second", "third", "fourth")


class Arguments:
    """The arguments of a function, read from its signature. The library passes the first ones by
    position, and some by name if the function has them. All others are named parameters.

    Attributes
    ----------
    by_name : tuple of str
        The arguments of the function that are passed by name.
    defaults : dict
        Default values of the named parameters, None without a default.
    required : tuple of str
        The named parameters without a default.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        positional: Sequence[str],
        name: str,
        by_name: Sequence[str] = (),
    ) -> None:
        self.name = name
        self.by_name: tuple[str, ...] = ()
        self.defaults: dict[str, Any] = {}
        self.required: tuple[str, ...] = ()
        call = ", ".join(positional)
        if not callable(function):
            raise TypeError(f"{name} has to be a function of ({call}), not {function!r}")
        try:
            signature = inspect.signature(function)
        except (TypeError, ValueError):  # functions of C have none
            return
        places = signature.parameters.values()
        in_order = [p for p in places if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
        takes_any = any(p.kind == p.VAR_POSITIONAL for p in places)
        if len(in_order) < len(positional) and not takes_any:
            raise TypeError(f"{name} has to accept ({call}), but its arguments are {signature}")
        for i, (place, expected) in enumerate(zip(in_order, positional)):
            if place.name == expected:
                continue
            if place.name in positional or place.name in by_name:
                raise TypeError(
                    f"{name} is called with ({call}), but its arguments are {signature}: put them "
                    "in this order"
                )
            if place.default is not place.empty:
                raise TypeError(
                    f"{name} is called with ({call}), but its {_ORDINALS[i]} argument is the "
                    f"parameter {place}: put parameters after {positional[-1]}"
                )
        others = [p for p in in_order[len(positional) :] if p.kind != p.POSITIONAL_ONLY]
        others += [p for p in places if p.kind == p.KEYWORD_ONLY]
        self.by_name = tuple(p.name for p in others if p.name in by_name)
        named = [p for p in others if p.name not in by_name]
        self.required = tuple(p.name for p in named if p.default is p.empty)
        self.defaults = {p.name: None if p.default is p.empty else p.default for p in named}

    def require_others(self, equations: Mapping[str, Any]) -> None:
        """TypeError for a parameter without a default, or one that is also in the equations."""
        for name in self.required:
            raise TypeError(f"{self.name} is a function of t alone: give {name} a default")
        for name in self.defaults.keys() & equations.keys():
            raise TypeError(
                f"{self.name} is a function of t alone, but its argument {name} is a parameter of "
                "the equations, too, whose value it does not get: choose another name"
            )

    def require_same_defaults(self, equations: Mapping[str, Any], now: Mapping[str, Any]) -> None:
        """TypeError for a parameter that is also in the equations and has another default here.
        equations: original values of their parameters; now: current values.
        """
        for name, default in self.defaults.items():
            if name in self.required or name not in equations:
                continue
            if not is_same(default, equations[name]) and not is_same(default, now[name]):
                raise TypeError(
                    f"{self.name} has the default {name}={default!r}, but {name} is a parameter of "
                    f"the equations with the value {now[name]!r}: choose another name, or leave "
                    "out the default if the same parameter is meant"
                )


def is_same(a: Any, b: Any) -> bool:
    try:
        return np.array_equal(np.asarray(a, dtype=float), np.asarray(b, dtype=float))
    except (TypeError, ValueError):
        return False


class PointFunction:
    """A user-supplied function of (t, x), called with numbers: an event, a condition, a jump.

    It gets xdot if it has an argument of this name. Other arguments are named parameters: those
    that are also in the equations have the same value there, and others keep their defaults.
    """

    def __init__(self, function: Callable[..., Any], name: str, has_xdot: bool = True) -> None:
        self.function = function
        self.name = name
        self.arguments = Arguments(function, ("t", "x"), name, ("xdot",))
        self._takes_xdot = bool(self.arguments.by_name)
        if self._takes_xdot and not has_xdot:
            raise TypeError(f"{name} is a function of (t, x): xdot is not known there")

    def check(self, problem: Any, known: Mapping[str, Any]) -> None:
        """TypeError for a parameter without a value, or with two; ValueError for unknowns under the
        names of others. known: values of the parameters of the equations.
        """
        names = read_names(self.function)
        if names is not None and problem._has_names:
            unpacked = {name: i for i, name in enumerate(names)}
            require_same_names(self.function, problem.names, unpacked)
        for name in self.arguments.required:
            if name not in known:
                hint = ""
                if self.arguments.required == (name,) and not self._takes_xdot:
                    hint = "; if x' is meant, call it xdot"
                raise TypeError(
                    f"the argument {name} of {self.name} has no value: it is neither xdot nor a "
                    f"parameter of the equations ({', '.join(known) or 'there are none'}). Give it "
                    f"a default{hint}"
                )
        self.arguments.require_same_defaults(problem.parameters, known)

    def __call__(self, t: float, x: Any, xdot: Any, known: Mapping[str, Any]) -> Any:
        named = {name: known[name] for name in self.arguments.defaults if name in known}
        if self._takes_xdot:
            named["xdot"] = xdot
        return self.function(t, x, **named)
