# SPDX-License-Identifier: BSD-3-Clause
"""Checkpoints, and the numbers that they have in common with the problem that restores them.

The library compares recorded equations and their parameters, but calls functions for all else: of a
constant matrix it knows no more than the name. So hashes of the numbers that only Python knows
follow the checkpoint of the library.
"""

from __future__ import annotations

import hashlib
from typing import Any, Callable, Mapping

import numpy as np

from ._binding import ffi, lib
from ._status import Error, Status

_MARK = 5.0e7 + 4217.0  # plus the number of hashes: no number that a checkpoint ends with by chance


def _hash(value: Any) -> float:
    if hasattr(value, "tocsr"):  # scipy.sparse
        csr = value.tocsr()
        parts = [np.array(csr.shape), csr.indptr, csr.indices, csr.data]
    else:
        parts = [np.array(np.shape(value)), np.asarray(value)]
    text = b"".join(np.ascontiguousarray(part, dtype=float).tobytes() for part in parts)
    return float(int.from_bytes(hashlib.sha256(text).digest()[:6], "little"))


def with_numbers(checkpoint: np.ndarray, known: Mapping[str, Any]) -> np.ndarray:
    """A checkpoint of the library, and what tells known numbers apart. known: by their names."""
    if not known:
        return checkpoint
    hashes = [_hash(value) for value in known.values()]
    return np.concatenate([checkpoint, hashes, [_MARK + len(known)]])


def without_numbers(checkpoint: Any, known: Mapping[str, Any]) -> np.ndarray:
    """The checkpoint of the library in one that with_numbers() has made.

    Raises
    ------
    Error
        ``ILLEGAL_ARGUMENT`` if the numbers are not those that are known.
    """
    values = np.array(checkpoint, dtype=float, ndmin=1)
    if not known:
        return values
    end = values.size - 1 - len(known)
    if end < 0 or values[-1] != _MARK + len(known):
        raise Error(
            Status.ILLEGAL_ARGUMENT,
            "this is not a checkpoint of this version, or one of another problem, or it is damaged",
        )
    for (name, value), saved in zip(known.items(), values[end:-1]):
        if _hash(value) != saved:
            raise Error(
                Status.ILLEGAL_ARGUMENT,
                f"the checkpoint was made with other values of {name} than those of this problem: "
                "give those that it was made with",
            )
    return values[:end]


class Checkpoints:
    """The part of a solver that is saved and restored."""

    problem: Any
    _state: Any
    _call: Callable[..., int]

    def _numbers(self) -> dict[str, Any]:
        return self.problem._numbers(self._state.values)

    def save_checkpoint(self) -> np.ndarray:
        """Analysis and state of the integration as an array of numbers; problem and options are not
        in it.
        """
        length = ffi.new("size_t*")
        self._call(lib.sfdae_get_checkpoint_length, length)
        checkpoint = np.empty(length[0])
        self._call(lib.sfdae_save_checkpoint, _address(checkpoint), length[0])
        return with_numbers(checkpoint, self._numbers())

    def restore_checkpoint(self, checkpoint: Any) -> None:
        """Continues from a checkpoint instead of start(), with the same problem and options.

        Formulas, arrays and parameters are compared with those that it was made with. Functions
        that are called with numbers cannot be compared: give the same ones.

        Raises
        ------
        Error
            ``ILLEGAL_ARGUMENT`` for a checkpoint that is damaged or was made with another problem
            or other options; see sfdae_restore_checkpoint.
        """
        values = without_numbers(checkpoint, self._numbers())
        self._call(lib.sfdae_restore_checkpoint, _address(values), values.size)


def _address(array: np.ndarray) -> Any:
    return ffi.cast("double*", array.ctypes.data)
