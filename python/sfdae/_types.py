# SPDX-License-Identifier: BSD-3-Clause
"""Types of arguments that can be given in several ways."""

from __future__ import annotations

from typing import Any, Mapping, Protocol, Sequence, SupportsFloat, Union, overload

from numpy.typing import ArrayLike, NDArray

from ._arrays import ExpressionArray
from ._expression import Expression

#: Numbers of all unknowns, or by name or index.
Values = Union[ArrayLike, Mapping[str, SupportsFloat], Mapping[int, SupportsFloat]]
#: One number for all unknowns, n of them, or some by name.
Tolerance = Union[float, ArrayLike, Mapping[str, SupportsFloat], Mapping[int, SupportsFloat]]
#: Unknowns by name or index, or n flags, or flags by name or index.
Unknowns = Union[
    str, Sequence[Union[str, int, bool]], NDArray[Any], Mapping[str, bool], Mapping[int, bool]
]
#: Units of the unknowns in their order, or by name.
Units = Union[Sequence[str], Mapping[str, str]]
#: Times, or times with ``"kink"`` or ``"jump"``.
Breakpoints = Union[ArrayLike, Mapping[float, str]]


class Function(Protocol):
    """A function of expressions, numbers, or arrays that contain both."""

    @overload
    def __call__(self, *arguments: float) -> float:
        ...

    @overload
    def __call__(self, *arguments: Union[Expression, float]) -> Expression:
        ...

    @overload
    def __call__(self, *arguments: ExpressionArray) -> ExpressionArray:
        ...

    @overload
    def __call__(self, *arguments: Any) -> NDArray[Any]:
        ...

    def __call__(self, *arguments: Any) -> Any:
        """The values."""
