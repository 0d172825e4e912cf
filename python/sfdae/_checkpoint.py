# SPDX-License-Identifier: BSD-3-Clause
"""Checkpoints, and hashes of the numbers in the problem that restores them.

The library compares recorded equations and their parameters, but other data only by calling
functions: of a constant matrix it knows only the name. Therefore, hashes of the numbers that only
Python knows follow the checkpoint of the library.
"""

from __future__ import annotations

import hashlib
from typing import Any, Callable, Mapping

import numpy as np

from ._binding import ffi, lib
from ._status import Error, Status

_MARK = 5.0e7 + 4217.0  # plus the number of hashes: no checkpoint ends with this number by chance


def _hash(value: Any) -> float:
    if hasattr(value, "tocsr"):  # scipy.sparse
        csr = value.tocsr()
        parts = [np.array(csr.shape), csr.indptr, csr.indices, csr.data]
    else:
        parts = [np.array(np.shape(value)), np.asarray(value)]
    text = b"".join(np.ascontiguousarray(part, dtype=float).tobytes() for part in parts)
    return float(int.from_bytes(hashlib.sha256(text).digest()[:6], "little"))


def with_numbers(checkpoint: np.ndarray, known: Mapping[str, Any]) -> np.ndarray:
    """A checkpoint of the library followed by hashes of the known numbers. known: by name."""
    if not known:
        return checkpoint
    hashes = [_hash(value) for value in known.values()]
    return np.concatenate([checkpoint, hashes, [_MARK + len(known)]])


def without_numbers(checkpoint: Any, known: Mapping[str, Any]) -> np.ndarray:
    """The checkpoint of the library without the hashes that with_numbers() appended.

    Raises
    ------
    Error
        ``ILLEGAL_ARGUMENT`` if the numbers differ from the known ones.
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
    """The part of a solver that saves and restores checkpoints."""

    problem: Any
    _state: Any
    _call: Callable[..., int]

    def _numbers(self) -> dict[str, Any]:
        return self.problem._numbers(self._state.values)

    def save_checkpoint(self) -> np.ndarray:
        """Analysis and state of the integration as an array of numbers, without problem and
        options.
        """
        length = ffi.new("size_t*")
        self._call(lib.sfdae_get_checkpoint_length, length)
        checkpoint = np.empty(length[0])
        self._call(lib.sfdae_save_checkpoint, _address(checkpoint), length[0])
        return with_numbers(checkpoint, self._numbers())

    def restore_checkpoint(self, checkpoint: Any) -> None:
        """Continues from a checkpoint instead of start(), with the same problem and options.

        Formulas, arrays and parameters are compared with those of the checkpoint. Functions that
        are called with numbers cannot be compared: pass the same ones.

        Raises
        ------
        Error
            ``ILLEGAL_ARGUMENT`` for a checkpoint that is damaged or belongs to another problem or
            other options; see sfdae_restore_checkpoint.
        """
        values = without_numbers(checkpoint, self._numbers())
        self._call(lib.sfdae_restore_checkpoint, _address(values), values.size)


def _address(array: np.ndarray) -> Any:
    return ffi.cast("double*", array.ctypes.data)
