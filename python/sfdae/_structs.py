# SPDX-License-Identifier: BSD-3-Clause
"""Structs that the library fills, as Python objects with the same members."""

from __future__ import annotations

import functools
import types
from typing import Any, Callable

from ._binding import ffi, lib


class Struct(types.SimpleNamespace):
    """Members of a struct of the library by name; the headers explain them."""

    def _asdict(self) -> dict[str, Any]:
        """The members as a dictionary."""
        return dict(vars(self))


def prepared(name: str) -> Any:
    """A struct sfdae_<name> that its init function has prepared."""
    struct = ffi.new(f"sfdae_{name}*")
    getattr(lib, f"sfdae_{name}_init")(struct, ffi.sizeof(struct[0]))
    return struct


@functools.lru_cache(maxsize=None)
def _names(struct_type: Any) -> tuple[str, ...]:
    """Members that are numbers or characters, except the size."""
    fields = struct_type.item.fields
    return tuple(
        name for name, field in fields if name != "size" and field.type.kind == "primitive"
    )


def members(struct: Any) -> Struct:
    """All members except the size; characters as strings of one letter, "" for none."""
    values = {name: getattr(struct, name) for name in _names(ffi.typeof(struct))}
    if isinstance(values.get("function"), bytes):
        values["function"] = values["function"].decode("ascii").strip("\0")
    return Struct(**values)


def filled(name: str, fill: Callable[[Any], Any]) -> Struct:
    """The members of a struct sfdae_<name> that `fill` has written."""
    struct = prepared(name)
    fill(struct)
    return members(struct)
