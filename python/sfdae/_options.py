# SPDX-License-Identifier: BSD-3-Clause
"""Options by name, as in sfdae_options."""

from __future__ import annotations

import difflib
import functools
from typing import Any, Iterable, Mapping

import numpy as np

from ._binding import ffi, lib
from ._problem import Problem
from ._unknowns import by_name

_FIELDS = dict(ffi.typeof("sfdae_options").fields)
# Set elsewhere: by the solver, and by arrays given for rtol and atol.
_NOT_GIVEN = {"size", "monitor", "monitor_user", "rtol_vector", "atol_vector"}
#: Names of all options.
OPTION_NAMES = tuple(name for name in _FIELDS if name not in _NOT_GIVEN)


# Other constants in the headers begin like those of these options.
_CHOICES = {
    "structure": ("off", "automatic", "required"),
    "conditions": ("smooth", "events"),
}


@functools.lru_cache(maxsize=None)
def choices(option: str) -> dict[str, int]:
    """The constants SFDAE_<OPTION>_<CHOICE> of an option in the headers, in lower case."""
    prefix = f"SFDAE_{option.split('_')[0].upper()}_"
    found = {
        name.removeprefix(prefix).lower(): getattr(lib, name)
        for name in dir(lib)
        if name.startswith(prefix)
    }
    return {name: found[name] for name in _CHOICES.get(option, found)}


def constant(option: str, value: Any) -> int:
    """The number of a choice given by its name, such as ``"radau"`` for method, or by its number.

    Raises
    ------
    ValueError
        If there is no such choice.
    """
    known = choices(option)
    if isinstance(value, str):
        if value.lower() not in known:
            raise ValueError(f"{option} has to be one of {', '.join(known)}, not {value!r}")
        return known[value.lower()]
    return int(value)


def check_names(options: Iterable[str]) -> None:
    """TypeError for an unknown option, with the most similar name."""
    for name in options:
        if name not in OPTION_NAMES:
            nearest = difflib.get_close_matches(name, OPTION_NAMES, n=1)
            hint = (
                f"; did you mean {nearest[0]!r}?"
                if nearest
                else f"; there are {', '.join(OPTION_NAMES)}"
            )
            raise TypeError(f"there is no option {name!r}{hint}")


def c_options(problem: Problem, options: Mapping[str, Any], keep: list[Any]) -> Any:
    """A struct sfdae_options; arrays that it points to are added to `keep`.

    Raises
    ------
    TypeError, ValueError, KeyError
        For unknown names, choices and unknowns, and wrong shapes; the library checks ranges.
    """
    check_names(options)
    c = ffi.new("sfdae_options*")
    lib.sfdae_options_init(c, ffi.sizeof("sfdae_options"))
    for name, value in options.items():
        if value is None:
            continue
        value = by_name(value)
        if name in ("rtol", "atol") and (isinstance(value, Mapping) or np.ndim(value) > 0):
            c_values = _doubles(problem, value, name, keep, getattr(c, name))
            setattr(c, f"{name}_vector", c_values)
        elif name == "fixed":
            c.fixed = _flags(problem, value, keep)
            if options.get("initial_values") is None:
                c.initial_values = lib.SFDAE_INITIAL_FIXED
        elif _FIELDS[name].type.kind == "pointer":
            setattr(c, name, _doubles(problem, value, name, keep))
        elif isinstance(value, str):
            setattr(c, name, constant(name, value))
        else:
            setattr(c, name, _number(name, value))
            if name == "stop_time" and options.get("use_stop_time") is None:
                c.use_stop_time = 1
    return c


def _number(name: str, value: Any) -> Any:
    if _FIELDS[name].type.cname == "double":
        return float(value)
    if int(value) != value:
        raise TypeError(f"{name} has to be an integer, not {value!r}")
    return int(value)


def _doubles(
    problem: Problem, value: Any, name: str, keep: list[Any], missing: float = 0.0
) -> Any:
    keep.append(ffi.new("double[]", problem.values(value, name, missing).tolist()))
    return keep[-1]


def _flags(problem: Problem, value: Any, keep: list[Any]) -> Any:
    """n flags from names or indices of unknowns, from flags by name, or from n booleans."""
    flags = [0] * problem.num_unknowns
    if isinstance(value, Mapping):
        value = [name for name, flag in value.items() if flag]
    entries = [value] if isinstance(value, str) else list(value)
    if len(entries) == problem.num_unknowns and all(
        isinstance(entry, (bool, np.bool_)) for entry in entries
    ):
        flags = [int(entry) for entry in entries]
    else:
        for unknown in entries:
            if isinstance(unknown, (bool, np.bool_)):
                raise ValueError(
                    f"fixed has {len(entries)} flags for {problem.num_unknowns} unknowns"
                )
            flags[problem.index(unknown)] = 1
    keep.append(ffi.new("int[]", flags))
    return keep[-1]
