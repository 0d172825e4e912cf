# SPDX-License-Identifier: BSD-3-Clause
"""Formulas: what is recorded has the value that numpy computes."""

import copy
import math
import operator
import pickle

import numpy as np
import pytest

import sfdae
from models import value_of
from sfdae._functions import OF_SCIPY, UFUNCS

T = 0.3


def close(value, expected):
    return value == pytest.approx(expected, rel=1e-14, abs=1e-15)


COMPARISONS = ("greater", "greater_equal", "less", "less_equal")
TRUTH_VALUES = ("bitwise_and", "bitwise_or", "bitwise_xor", "invert")


@pytest.mark.parametrize("name", sorted(UFUNCS.keys() - OF_SCIPY.keys() - {"clip", "divmod"}))
def test_every_ufunc_has_the_value_of_numpy(name):
    ufunc = getattr(np, name)
    if name in COMPARISONS:
        value = value_of(lambda t: np.where(ufunc(t, 0.2), 1.0, 2.0))
        assert value == (1.0 if ufunc(T, 0.2) else 2.0)
        return
    if name.startswith("logical"):
        arguments = [0.2] * (ufunc.nin - 1)
        assert value_of(lambda t: ufunc(t, *arguments)) == float(ufunc(T, *arguments))
        return
    if name in TRUTH_VALUES:
        for limit in (0.2, 0.4):
            arguments = [True] * (ufunc.nin - 1)
            found = value_of(lambda t: ufunc(t > limit, *arguments))
            assert found == float(ufunc(np.bool_(T > limit), *arguments))
        return
    shift = 1.0 if name == "arccosh" else 0.0
    if ufunc.nin == 2:
        assert close(value_of(lambda t: ufunc(t, 0.7)), ufunc(T, 0.7))
        assert close(value_of(lambda t: ufunc(0.7, t)), ufunc(0.7, T))
        return
    assert close(value_of(lambda t: ufunc(t + shift)), ufunc(T + shift))


@pytest.mark.parametrize("name", sorted(OF_SCIPY))
def test_functions_of_scipy_have_their_values_and_derivatives(name):
    special = pytest.importorskip("scipy.special")
    ufunc = getattr(special, name)
    for t in (-1.5, 0.0, 0.4, 3.0):
        a = t * t + 0.1 if ufunc.nin == 2 else t
        more = [0.7] * (ufunc.nin - 1)
        assert close(
            value_of(lambda s: ufunc(s * s + 0.1 if more else s, *more), t), ufunc(a, *more)
        )
    h = 1e-5
    slope = (ufunc(0.4 + h, *more) - ufunc(0.4 - h, *more)) / (2 * h)
    found = value_of(lambda t: sfdae.time_derivative(ufunc(t, *more)), 0.4)
    assert found == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize(
    "op", [operator.add, operator.sub, operator.mul, operator.truediv, operator.pow]
)
@pytest.mark.parametrize(
    "other", [2, 2.5, np.float64(1.5), np.int32(3), np.float32(0.5), np.array(1.25), True]
)
def test_operators_with_every_kind_of_number(op, other):
    assert close(value_of(lambda t: op(t, other)), op(T, float(other)))
    assert close(value_of(lambda t: op(other, t)), op(float(other), T))


def test_unary_operators():
    assert value_of(lambda t: -t) == -T
    assert value_of(lambda t: +t) == T
    assert value_of(lambda t: abs(t - 1)) == 1 - T


def test_vectors_and_matrices():
    M = np.array([[1.0, 2.0], [3.0, 4.0]])

    def formula(t):
        v = np.array([t, t**2])
        assert (M @ v).shape == (2,)
        return (
            (M @ v) @ v
            + np.dot(v, v)
            + np.cross([t, 0, 0], [0, t, 0])[2]
            + np.sum(v * [1, 2])
            + v.sum()
        )

    v = np.array([T, T**2])
    assert close(value_of(formula), (M @ v) @ v + v @ v + T**2 + v @ [1, 2] + v.sum())


def test_functions_of_arrays_of_expressions():
    assert close(value_of(lambda t: np.sin(np.array([t, 2 * t])).sum()), np.sin([T, 2 * T]).sum())
    assert close(value_of(lambda t: np.linalg.norm(np.array([t, 2 * t]))), math.sqrt(5) * T)
    assert close(
        value_of(lambda t: np.arctan2(np.array([t, 1 + t]), np.array([1 + t, t])).sum()),
        math.pi / 2,
    )


def test_own_functions_serve_numbers_expressions_and_mixed_arrays():
    assert sfdae.sin(0.5) == np.sin(0.5)
    assert np.array_equal(sfdae.exp([0.0, 1.0]), np.exp([0.0, 1.0]))
    mixed = value_of(lambda t: sfdae.cos([t, 0.0]).sum())
    assert close(mixed, math.cos(T) + 1)
    assert close(value_of(lambda t: sfdae.maximum([t, 0.1], 0.2).sum()), 0.5)
    assert close(value_of(lambda t: np.float64(2.0) * t), 2 * T)
    assert close(value_of(lambda t: (np.array([1.0, 2.0]) * t).sum()), 3 * T)


@pytest.mark.parametrize(
    "condition",
    [
        lambda t: t > 0.2,
        lambda t: t >= 0.2,
        lambda t: t < 0.4,
        lambda t: 0.4 > t,
        lambda t: ~(t > 0.4),
        lambda t: t,
    ],
)
def test_choices(condition):
    assert value_of(lambda t: sfdae.choose(condition(t), 5 * t, t)) == 5 * T
    if not isinstance(
        condition(sfdae.Expression(sfdae._expression._as_c(0.0), None)), sfdae.Expression
    ):
        assert value_of(lambda t: np.where(condition(t), 5 * t, t)) == 5 * T


def test_equality_at_the_boundary_belongs_to_ge_and_le():
    zero = lambda t: t - t  # noqa: E731
    assert value_of(lambda t: sfdae.choose(zero(t) >= 0, 1, 2)) == 1
    assert value_of(lambda t: sfdae.choose(zero(t) <= 0, 1, 2)) == 1
    assert value_of(lambda t: sfdae.choose(zero(t) > 0, 1, 2)) == 2
    assert value_of(lambda t: sfdae.choose(zero(t) < 0, 1, 2)) == 2


def test_comparisons_with_arrays():
    limits = np.array([0.2, 0.4])
    assert value_of(lambda t: sfdae.choose(t > limits, [1, 2], [30, 40]).sum()) == 41
    assert value_of(lambda t: sfdae.choose(limits >= t, [1, 2], [30, 40]).sum()) == 32


def test_choose_of_numbers_and_arrays():
    assert sfdae.choose(1.0, 2.0, 3.0) == 2.0
    assert sfdae.choose(-1.0, 2.0, 3.0) == 3.0
    assert list(sfdae.choose(np.array([1.0, -1.0]), 2.0, 3.0)) == [2.0, 3.0]
    assert sfdae.choose(True, 2.0, 3.0) == 2.0


@pytest.mark.parametrize(
    "use",
    [
        bool,
        float,
        int,
        math.sin,
        lambda t: t == 0,
        lambda t: t != 0,
        lambda t: 1 if t > 0 else 2,
        lambda t: max(t, 0),
    ],
)
def test_values_are_refused_with_an_explanation(use):
    with pytest.raises(TypeError, match="no value while equations are recorded"):
        value_of(lambda t: use(t))


def test_unknown_functions_are_named():
    with pytest.raises(TypeError, match="np.spacing cannot be recorded; these can: .*sin"):
        value_of(np.spacing)


def test_an_array_of_floats_cannot_hold_expressions():
    def formula(t):
        a = np.zeros(2)
        a += t
        return a[0]

    with pytest.raises(TypeError, match=r"np.zeros\(n, like=x\)"):
        value_of(formula)


@pytest.mark.parametrize("wrong", ["1", None, 1j, [1.0], {}])
def test_wrong_operands(wrong):
    with pytest.raises(TypeError):
        value_of(lambda t: t + wrong)


def test_numbers_that_are_not_finite_are_refused():
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT"):
        value_of(lambda t: t * float("nan"))
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT"):
        value_of(lambda t: t + sfdae.log(sfdae._functions.as_expression(-1.0)))


def test_expressions_that_outlive_their_recording_are_refused():
    kept = []
    value_of(lambda t: kept.append(t) or t)
    for use in (
        lambda t: t + 1,
        lambda t: 1 + t,
        lambda t: -t,
        np.sin,
        lambda t: sfdae.parameter(t, "k", 1.0),
    ):
        with pytest.raises(RuntimeError, match="recording that has ended"):
            use(kept[0])
    with pytest.raises(RuntimeError, match="recording that has ended"):
        value_of(lambda t: t * kept[0])


def test_expressions_cannot_be_pickled_or_copied():
    kept = []
    value_of(lambda t: kept.append(t) or t)
    for make in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match="belong to a recording"):
            make(kept[0])


def test_expressions_show_what_they_are():
    shown = []
    value_of(lambda t: shown.append(repr(t)) or t)
    assert shown == ["Expression(recorded)"]
    assert repr(sfdae._functions.as_expression(2.0)) == "Expression(2.0)"
