# SPDX-License-Identifier: BSD-3-Clause
"""Names of equations and constraints, for messages."""

from __future__ import annotations

from typing import Any, Sequence

from ._binding import ffi


def as_names(given: Sequence[str], what: str) -> tuple[str, ...]:
    if isinstance(given, str):
        raise TypeError(f"{what} has to be a sequence of names, not the string {given!r}")
    return tuple(str(name) for name in given)


def c_names(names: Sequence[str], count: int, what: str, keep: list[Any]) -> Any:
    """Names for C, of `count` items; the memory that they need is added to `keep`."""
    if len(names) != count:
        raise ValueError(f"there are {len(names)} names for {count} {what}")
    texts = [ffi.new("char[]", name.encode()) for name in names]
    keep += [texts, ffi.new("char*[]", texts)]
    return keep[-1]
