# SPDX-License-Identifier: BSD-3-Clause
"""Status codes, errors and warnings."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

from ._binding import ffi, lib


def status_name(status: int) -> str:
    """Name of a status, for example ``"SFDAE_STEP_TOO_SMALL"``."""
    return ffi.string(lib.sfdae_status_name(status)).decode()


def version() -> str:
    """Version of the library in use, for example ``"0.2.0"``."""
    return ffi.string(lib.sfdae_version()).decode()


def _status_codes() -> dict[str, int]:
    """All constants SFDAE_<NAME> of the headers that are status codes, by name."""
    codes = {}
    for name in dir(lib):
        value = getattr(lib, name) if name.startswith("SFDAE_") else None
        if isinstance(value, int) and status_name(value) == name:
            codes[name.removeprefix("SFDAE_")] = value
    return codes


if TYPE_CHECKING:

    class _Names(enum.EnumMeta):
        def __getattr__(cls, name: str) -> Status:
            ...

    class Status(enum.IntEnum, metaclass=_Names):
        """The members are those of C."""

else:
    Status = enum.IntEnum("Status", _status_codes(), module=__name__)
    Status.__doc__ = (
        """What a call returned: ``OK`` (0), a warning (> 0) or a failure (< 0), as in C."""
    )


class Error(RuntimeError):
    """A failure of the library.

    Attributes
    ----------
    status : Status
        The failure, for example ``Status.INDEX_TOO_HIGH``.
    message : str
        The failure, its place, the numbers and a remedy.
    """

    def __init__(self, status: int, message: str = "") -> None:
        try:
            self.status = Status(status)
        except ValueError:
            self.status = status
        self.message = message or status_name(status)
        super().__init__(status, message)

    def __str__(self) -> str:
        name = status_name(self.status)
        return name if self.message == name else f"{name}: {self.message}"


class SfdaeWarning(UserWarning):
    """The call succeeded in part, and the result needs attention."""


class InitialValuesWarning(SfdaeWarning):
    """Initial values of differential variables were changed, or the solution through them is not
    unique.
    """


class IntegrationWarning(SfdaeWarning):
    """The integration ended early, or equations that contradict each other were ignored."""


class CannotEvaluate(Exception):
    """Raised by a callback that cannot evaluate at this point: the library tries a smaller step."""
