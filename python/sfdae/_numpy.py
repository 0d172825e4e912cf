# SPDX-License-Identifier: BSD-3-Clause
"""numpy functions with special implementations for expressions: those that decide by values, or
that create arrays of numbers internally.
"""

from __future__ import annotations

from typing import Any, Callable, Iterable, Sequence

import numpy as np

from ._arrays import ExpressionArray, elementwise, plain, wrapped
from ._expression import Expression
from ._functions import choose, rounded, where
from ._table import table

_LARGEST_MATRIX = 4  # determinants by minors: 2^n n products


def as_array(value: Any) -> np.ndarray:
    """Expressions and numbers as an ndarray of objects, numbers alone as one of numbers."""
    value = plain(value)
    return value if isinstance(value, np.ndarray) else np.asarray(value)


def _is_recorded(array: np.ndarray) -> bool:
    return array.dtype == object and any(isinstance(entry, Expression) for entry in array.flat)


# ---- Choices -------------------------------------------------------------------------------------


def _where(condition: Any, *branches: Any) -> Any:
    if len(branches) != 2:
        raise TypeError("np.where of expressions needs both values: np.where(a > b, x, y)")
    return where(condition, *branches)


def _select(conditions: Sequence[Any], choices: Sequence[Any], default: Any = 0) -> Any:
    result = default
    for condition, choice in reversed(list(zip(conditions, choices))):
        result = where(condition, choice, result)
    return result


def _piecewise(x: Any, conditions: Any, functions: Sequence[Any], *args: Any, **kw: Any) -> Any:
    if isinstance(conditions, (Expression, bool)) or np.ndim(conditions[0]) < np.ndim(x):
        conditions = [conditions]
    values = [
        function(x, *args, **kw) if callable(function) else function for function in functions
    ]
    result = values.pop() if len(values) > len(conditions) else 0.0
    for condition, value in zip(conditions, values):  # the last one that holds counts
        result = where(condition, value, result)
    return result


def _clip(a: Any, a_min: Any = None, a_max: Any = None, out: Any = None, **kwargs: Any) -> Any:
    a_min, a_max = kwargs.get("min", a_min), kwargs.get("max", a_max)
    result = a if a_min is None else np.maximum(a, a_min)
    result = result if a_max is None else np.minimum(result, a_max)
    if out is None:
        return result
    out[...] = result
    return out


def _round(a: Any, decimals: int = 0, out: Any = None) -> Any:
    result = elementwise(lambda entry: rounded(entry, decimals), (a,))
    if out is None:
        return result
    out[...] = result
    return out


def _interp(
    x: Any, xp: Any, fp: Any, left: Any = None, right: Any = None, period: Any = None
) -> Any:
    """Hat functions if the values are expressions, else a table of degree 1."""
    values = as_array(fp)
    if _is_recorded(values):
        return sum(
            value * _interp(x, xp, unit, *(None if end is None else 0.0 for end in (left, right)))
            for value, unit in zip(values, np.eye(len(values)))
        )
    points, values = np.asarray(xp, dtype=float), np.asarray(values, dtype=float)
    if not _is_recorded(as_array(x)):
        return np.interp(np.asarray(x, dtype=float), points, values, left, right, period)
    if period is not None:
        points = points % period
        order = np.argsort(points)
        points, values = points[order], values[order]
        points = np.concatenate([points[-1:] - period, points, points[:1] + period])
        values = np.concatenate([values[-1:], values, values[:1]])
        return table(x % period, points, values, 1)
    result = table(_clip(x, points[0], points[-1]), points, values, 1)
    result = result if left is None else choose(x < points[0], left, result)
    return result if right is None else choose(x > points[-1], right, result)


def _linspace(
    start: Any, stop: Any, num: int = 50, endpoint: bool = True, **kwargs: Any
) -> ExpressionArray:
    shares = np.linspace(0.0, 1.0, num, endpoint)
    start, stop = np.asarray(plain(start)), np.asarray(plain(stop))
    shares = shares.reshape((-1,) + (1,) * np.broadcast(start, stop).ndim)
    return wrapped(start * (1.0 - shares) + stop * shares)


def _gradient(f: Any, *spacing: Any, axis: Any = None, edge_order: int = 1) -> Any:
    """Linear in f: the matrix of numpy's own gradient, times f, along each axis."""
    f = as_array(f)
    axes = range(f.ndim) if axis is None else np.atleast_1d(axis)
    spacings = list(spacing) * (len(axes) if len(spacing) == 1 else 1) or [1.0] * len(axes)
    results = []
    for k, step in zip(axes, spacings):
        G = np.gradient(np.eye(f.shape[k]), step, axis=0, edge_order=edge_order)
        product = matmul(G, np.moveaxis(f, k, 0).reshape(f.shape[k], -1))
        results.append(np.moveaxis(product.reshape(np.moveaxis(f, k, 0).shape), 0, k))
    return results[0] if len(results) == 1 else results


# ---- Products ------------------------------------------------------------------------------------


def _rows(matrix: Any) -> Iterable[tuple[Sequence[int], Sequence[Any]]] | None:
    """Columns and values of the nonzero entries, row by row, of a matrix of numbers."""
    if hasattr(matrix, "tocsr"):  # scipy.sparse
        matrix = matrix.tocsr()
        ends = list(zip(matrix.indptr[:-1], matrix.indptr[1:]))
        return [(matrix.indices[a:b].tolist(), matrix.data[a:b].tolist()) for a, b in ends]
    if isinstance(matrix, np.ndarray) and matrix.dtype != object and matrix.ndim == 2:
        columns = [np.flatnonzero(row) for row in matrix]
        return [(k.tolist(), row[k].tolist()) for k, row in zip(columns, matrix)]
    return None


def _times_vector(rows: Iterable[tuple[Sequence[int], Sequence[Any]]], x: np.ndarray) -> np.ndarray:
    result = np.empty(len(rows), dtype=object)  # type: ignore[arg-type]
    for i, (columns, values) in enumerate(rows):
        result[i] = sum(
            (x[j] if value == 1.0 else value * x[j] for j, value in zip(columns, values)), 0.0
        )
    return result


def matmul(a: Any, b: Any, out: Any = None) -> Any:
    """a @ b. Zeros in matrices of numbers, including scipy.sparse, are skipped."""
    a, b = plain(a), plain(b)
    for first, second in ((a, b), (b, a)):
        if isinstance(second, np.ndarray) and second.ndim == 0 or np.isscalar(second):
            raise TypeError("matmul: @ needs vectors or matrices, use * for a single expression")
    if hasattr(b, "tocsr") or _rows(a) is None and _rows(b) is not None and b.shape[0] > 0:
        if a.ndim <= 2 and a.shape[-1] == b.shape[0]:  # a b = (b' a')'
            return wrapped(plain(matmul(b.T, a.T)).T)
    rows = _rows(a) if b.ndim <= 2 and a.shape[-1] == b.shape[0] else None
    if rows is None:
        return wrapped(np.matmul(plain(np.asarray(a, dtype=object)), np.asarray(b, dtype=object)))
    if b.ndim == 1:
        return wrapped(_times_vector(rows, b))
    columns = [_times_vector(rows, column) for column in b.T]
    return wrapped(np.stack(columns, axis=1) if columns else np.empty((len(rows), 0), object))


def _dot(a: Any, b: Any, out: Any = None) -> Any:
    a, b = plain(a), plain(b)
    if hasattr(a, "tocsr") or hasattr(b, "tocsr") or 1 <= np.ndim(a) <= 2 and 1 <= np.ndim(b) <= 2:
        return matmul(
            a if hasattr(a, "tocsr") else as_array(a), b if hasattr(b, "tocsr") else as_array(b)
        )
    return np.dot(as_array(a).astype(object), as_array(b).astype(object))


def _einsum(subscripts: str, *operands: Any, **kwargs: Any) -> Any:
    """All operands in the space of all letters, multiplied, and summed over omitted letters."""
    if not isinstance(subscripts, str) or "." in subscripts:
        raise TypeError("np.einsum of expressions needs letters, as in np.einsum('ij,j->i', A, x)")
    text = subscripts.replace(" ", "")
    terms, arrow, result = text.partition("->")
    if not arrow:
        result = "".join(sorted(c for c in set(terms) - {","} if terms.count(c) == 1))
    letters = result + "".join(sorted(set(terms) - set(result) - {","}))
    product: Any = 1.0
    for term, operand in zip(terms.split(","), operands):
        array = as_array(operand).astype(object)
        for letter in sorted(set(term)):
            while term.count(letter) > 1:  # a diagonal, whose axis numpy puts last
                first = term.index(letter)
                second = term.index(letter, first + 1)
                array = np.diagonal(array, axis1=first, axis2=second)
                term = term[:first] + term[first + 1 : second] + term[second + 1 :] + letter
        order = [term.index(letter) for letter in letters if letter in term]
        shape = iter(array.transpose(order).shape)
        product = product * array.transpose(order).reshape(
            [next(shape) if letter in term else 1 for letter in letters]
        )
    return product.sum(axis=tuple(range(len(result), len(letters))))


# ---- Linear algebra ------------------------------------------------------------------------------


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    x = wrapped(as_array(x))
    if ord in (None, 2, "fro") and (axis is not None or ord != 2 or x.ndim == 1):
        return np.sqrt((x * x).sum(axis=axis, keepdims=keepdims))
    if axis is None and x.ndim == 2 or not np.isscalar(ord) or isinstance(ord, str):
        raise TypeError(f"np.linalg.norm of a matrix of expressions with ord={ord!r}: use 'fro'")
    if np.isinf(ord):
        return (np.max if ord > 0 else np.min)(abs(x), axis=axis, keepdims=keepdims)
    return ((abs(x) ** ord).sum(axis=axis, keepdims=keepdims)) ** (1.0 / ord)


def _square(A: Any, name: str) -> np.ndarray:
    A = as_array(A)
    if A.ndim != 2 or A.shape[0] != A.shape[1]:
        raise ValueError(f"np.linalg.{name} of expressions needs a square matrix, not {A.shape}")
    if _is_recorded(A) and len(A) > _LARGEST_MATRIX:
        raise TypeError(
            f"np.linalg.{name} of {A.shape} expressions would be a long formula: make the solution z "
            "of A z = b unknowns, and write the equations A @ z - b"
        )
    return A


def _minors(A: np.ndarray) -> Any:
    """The determinant, by minors of the first rows: each set of columns is computed once."""
    n = len(A)
    minors: dict[int, Any] = {0: 1.0}
    for i in range(n):
        larger: dict[int, Any] = {}
        for chosen, minor in minors.items():
            for j in range(n):
                entry = A[i, j]
                if chosen >> j & 1 or type(entry) in (int, float) and entry == 0:
                    continue
                term = entry * minor
                is_odd = bin(chosen >> (j + 1)).count("1") % 2
                key = chosen | 1 << j
                before = larger.get(key, 0.0)
                larger[key] = before - term if is_odd else before + term
        minors = larger
    return minors.get((1 << n) - 1, 0.0)


def _det(A: Any) -> Any:
    return _minors(_square(A, "det").astype(object))


def _inv(A: Any) -> Any:
    A = _square(A, "inv").astype(object)
    n = len(A)
    inverse, det = np.empty((n, n), dtype=object), _minors(A)
    for i in range(n):
        for j in range(n):
            rest = np.delete(np.delete(A, j, axis=0), i, axis=1)
            inverse[i, j] = (-1) ** (i + j) * _minors(rest) / det
    return inverse


def _solve(A: Any, b: Any) -> Any:
    A, b = _square(A, "solve"), as_array(b)
    if not _is_recorded(A):
        return matmul(np.linalg.inv(A.astype(float)), b)
    return matmul(_inv(A), b)


# ---- Arrays --------------------------------------------------------------------------------------


def _made(function: Callable[..., Any]) -> Callable[..., Any]:
    """np.zeros(n, like=x) and its relatives: an array that can hold expressions."""

    def make(*args: Any, dtype: Any = None, **kwargs: Any) -> Any:
        if function is np.empty:
            return np.empty(*args, dtype=object, **kwargs)
        args = tuple(plain(argument) for argument in args)
        return np.asarray(function(*args, **kwargs)).astype(object).view(ExpressionArray)

    return make


def _not_recorded(name: str, instead: str) -> Callable[..., Any]:
    def refuse(*args: Any, **kwargs: Any) -> Any:
        raise TypeError(
            f"{name} depends on values and cannot be recorded: {instead}; record=False calls the "
            "function with numbers instead of recording it"
        )

    return refuse


OWN: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.select: _select,
    np.piecewise: _piecewise,
    np.clip: _clip,
    np.round: _round,
    np.interp: _interp,
    np.linspace: _linspace,
    np.gradient: _gradient,
    np.fix: np.trunc,
    np.dot: _dot,
    np.einsum: _einsum,
    np.linalg.norm: _norm,
    np.linalg.det: _det,
    np.linalg.inv: _inv,
    np.linalg.solve: _solve,
    np.nan_to_num: lambda x, *args, **kwargs: x,
}
OWN.update({getattr(np, name): _round for name in ("around", "round_") if hasattr(np, name)})
for _name in (
    "array asarray asanyarray ascontiguousarray asfortranarray empty zeros ones full eye identity "
    "arange"
).split():
    OWN[getattr(np, _name)] = _made(getattr(np, _name))
_MATRICES = "make the result unknowns, and write the equations that it satisfies"
_ORDER = "np.maximum, np.minimum and np.where can be"
for (
    _name
) in "eig eigh eigvals eigvalsh svd qr cholesky lstsq pinv matrix_rank cond slogdet".split():
    OWN[getattr(np.linalg, _name)] = _not_recorded(f"np.linalg.{_name}", _MATRICES)
for _name in (
    "sort argsort argmax argmin median percentile quantile unique nonzero argwhere flatnonzero "
    "searchsorted digitize histogram count_nonzero isclose allclose array_equal partition lexsort "
    "isin in1d intersect1d setdiff1d"
).split():
    if hasattr(np, _name):
        OWN[getattr(np, _name)] = _not_recorded(f"np.{_name}", _ORDER)
for _name in "sum prod max min mean".split():  # no value of an expression is NaN
    OWN[getattr(np, f"nan{_name}")] = getattr(np, _name)
