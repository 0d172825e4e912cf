# SPDX-License-Identifier: BSD-3-Clause
"""What a user of numpy and scipy writes: the recorded formula has the shape and the values that the
same text has at numbers, or the error names what to write instead.
"""

import math

import numpy as np
import pytest

import sfdae
from models import values_of

RANDOM = np.random.default_rng(7)
N = 6
GIVEN = {
    "np": np,
    "math": math,
    "sfdae": sfdae,
    "M": RANDOM.normal(size=(N, N)),
    "N": N,
    "K": RANDOM.normal(size=(3, N)),
    "w": RANDOM.normal(size=N),
    "knots": np.linspace(-4.0, 4.0, 9),
    "heights": RANDOM.normal(size=9),
    "flags": np.array([True, False] * 3),
}


def evaluated(text, t, x):
    """The value of statements, the last of which is an expression, or of an expression."""
    names = {**GIVEN, "t": t, "x": x}
    *statements, last = [part.strip() for part in text.split(";")]
    for statement in statements:
        exec(statement, names)
    return eval(last, names)


WORK = """
np.where(x > 0, x, -x)
np.where((x > 0) & (x < 1), x**2, 3.0)
np.where((x < -0.5) | (x > 0.5), 1.0, x)
np.where(~(x > 0), x, 2 * x)
np.where(flags, x, t)
np.where(x, x**2, t)
np.where([1, 0, -2, 0, 3, 0], x, t)
np.where(x - x, x, t)
np.logical_and(x, x - 1) * 1.0 + np.logical_or(x - x, x) + np.logical_not(x)
np.logical_xor(x, x - x) * 1.0
np.any(x - x) + np.all(x) * 2.0
np.where((x > 0) & flags, x, t)
np.where(x[:, None] > x, x[:, None], x)
np.maximum(x, 0)
np.minimum(x, x[::-1])
np.maximum.reduce(x)
np.sign(x) * np.abs(x)
np.floor(3 * x) + np.ceil(3 * x) + np.trunc(3 * x)
np.fix(3 * x)
np.clip(x, -0.5, t)
x.clip(0, 1)
np.clip(x, None, w)
(x > t).sum()
(x >= 0) * x + (x <= w) * 1.0
np.logical_and(x > 0, x < 1) * 1.0
np.logical_or(x > 1, x < 0) * np.logical_not(x > 2)
((x > 0) ^ (x < 1)) * 1.0
np.logical_xor(x > 0, x < 1) * 1.0
np.sum(x, where=flags)
np.nansum(x) + np.nanmax(x)
np.any(x > 0) * 2.0
np.all(x > -9) * 2.0
out = np.zeros(N, like=x); out[:] = x; out[x < 0] = 0.0; out
out = x.copy(); out *= 2; out += w; out[1:3] -= t; out
np.hstack([x[0], x[2:4], t])
np.hstack((x, w))
np.vstack([x, w])
np.stack([x[:3], x[3:]], axis=1)
np.column_stack([x[:3], w[:3]])
np.dstack([x[:3], x[3:]])
np.block([[x[:2], x[2:4]], [x[4:], w[:2]]])
np.concatenate([x[:2], [t], w])
np.r_[x[0], x[2:], 1.0]
np.c_[x, w]
np.append(x, t)
np.insert(x, 2, t)
np.select([x < -0.5, x < 0.5], [x**2, 2 * x], default=t)
np.piecewise(x, [x < 0, x >= 0], [lambda v: v**2, 3.0])
np.piecewise(t, [t < 0.1, t < 0.5], [1.0, lambda v: 2 * v, 0.0])
np.interp(t, knots, heights)
np.interp(x, knots, heights)
np.interp(5 * x, knots, heights, left=-1.0, right=2.0)
np.interp(x, [0.0, 0.3, 0.7], [1.0, 2.0, -1.0], period=1.0)
np.interp(0.4, np.linspace(0, 1, N), x)
np.interp(x[0], knots[:6] * 2, x)
np.dot(M, x)
np.dot(x, w) * np.dot(x, x)
np.dot(2.0, x)
M @ x
x @ M
K @ M @ x
x @ M @ x
np.matmul(K, x)
np.einsum('ij,j->i', M, x)
np.einsum('i,ij,j', x, M, x)
np.einsum('i,j->ij', x, w)
np.einsum('ii', M * x)
np.einsum('ij->ji', M * x)
np.outer(x, w)
np.inner(x, w)
np.vdot(x, x)
np.kron(x[:2], w[:3])
np.tensordot(M, x, axes=1)
np.cross(x[:3], x[3:])
np.linalg.norm(x)
np.linalg.norm(x, 1) + np.linalg.norm(x, np.inf) + np.linalg.norm(x, 3)
np.linalg.norm(x.reshape(2, 3), axis=1)
np.linalg.norm(x.reshape(2, 3))
np.trace(M * x)
np.diag(x) @ w
np.diag(M * x)
np.tril(M * x) + np.triu(M * x, 1)
x.max() + x.min()
np.max(x) - np.min(x) + np.ptp(x)
x.sum() + x.prod() + x.mean()
np.sum(M * x, axis=0)
np.mean(M * x, axis=1, keepdims=True)
np.var(x) + np.std(x)
np.average(x, weights=w**2)
np.cumsum(x)
x.cumsum()
np.cumprod(x)
np.diff(x)
np.diff(x, n=2)
np.ediff1d(x)
np.roll(x, 2)
np.flip(x) + x[::-1]
np.gradient(x, 0.1)
np.gradient(M * x, 0.1, 0.2)[1]
np.gradient(x, knots[:6], edge_order=2)
np.trapz(x, w) if hasattr(np, 'trapz') else np.trapezoid(x, w)
np.convolve(x, [1.0, -2.0, 1.0], 'valid')
np.log1p(x**2) + np.expm1(x)
np.cbrt(x)
np.heaviside(x, 0.5)
np.round(3 * x) + np.rint(x) + np.round(x, 2)
x.round(1)
round(t) + math.floor(3 * t) + math.ceil(t)
np.hypot(x, w)
np.arctan2(x, w)
np.deg2rad(x) + np.rad2deg(x) + np.radians(x)
np.arcsinh(x) + np.arccosh(1 + x**2) + np.arctanh(x / 5)
np.sinh(x) + np.cosh(x) + np.tanh(x)
np.exp2(x) + np.log2(1 + x**2) + np.log10(1 + x**2)
np.logaddexp(x, w)
np.power(np.abs(x), 1.5) + np.sqrt(np.abs(x)) + np.square(x)
np.mod(x, 0.7) + x % 0.3 + x // 0.3 + np.fmod(x, 0.7)
np.divmod(x, 0.7)[1] + divmod(t, 0.2)[0]
np.copysign(x, w)
np.reciprocal(x) + 1 / x
np.add.reduce(x) + np.multiply.reduce(x)
np.add.outer(x, w)
np.multiply.outer(x, x)
np.subtract.accumulate(x)
out = np.zeros(N, like=x); np.add.at(out, [0, 0, 1], x[:3]); out
np.polyval([1.0, 2.0, 3.0], x)
np.poly1d([1.0, 2.0, 3.0])(t)
np.polynomial.polynomial.polyval(x, [1.0, 2.0, 3.0])
np.polynomial.Polynomial([1.0, 2.0])(x)
np.linalg.solve(M, x)
np.linalg.solve(np.diag(2 + x[:3]) + M[:3, :3], w[:3])
np.linalg.inv(np.diag(2 + x[:4]) + 0.1)
np.linalg.det((M * x)[:4, :4])
x.reshape(2, 3).T @ x[:2]
np.transpose(x.reshape(2, 3)) * w[:3, None]
np.broadcast_to(x, (2, N)) + 1
np.tile(x, 2)
np.repeat(x, 2)
np.meshgrid(x[:2], w[:3])[0] * 2
np.split(x, 2)[1] * 2
np.take(x, [0, 2])
x[[0, 2, 4]] + x.take([1, 2, 3])
x[flags]
np.squeeze(x[None, :]) + x.flatten() + np.ravel(x)
np.expand_dims(x, 0)
np.pad(x, 1)
np.pad(x, (1, 1), mode='edge')
np.zeros_like(x) + np.ones_like(x) * x
np.full_like(x, 2.0) * x
out = np.empty_like(x); out[:] = 3 * x; out
out = np.zeros((2, 2), like=x); out[0, 1] = x[0]; out[1] += x[1:3]; out
np.array([x[0], 2.0, t])
np.array([x[0], -x[1]], like=x) > 0
np.array([[x[0], x[1]], [0, 1]]) @ x[:2]
np.asarray(x) * 2
np.sin(np.array([x[0], t]))
np.apply_along_axis(lambda row: row.sum(), 1, x.reshape(2, 3))
np.vectorize(lambda v: v**2 + 1)(x)
np.fromiter((v**2 for v in x), dtype=object)
np.sum([v**2 for v in x])
sum(v for v in x)
abs(x) + +x - (-x)
2.0**x + x**2 + (1 + x**2)**x
np.float64(2.0) * x + np.float32(0.5) * x[0] + np.int64(3) * t
np.linspace(x[0], x[1], 4)
np.nan_to_num(x)
np.copyto(out := np.zeros(N, like=x), x); out
np.fill_diagonal(out := np.zeros((3, 3), like=x), x[:3]); out
np.moveaxis(M * x, 0, 1)
np.unwrap(np.array([0.0, 1.0])) + t
np.float_power(np.abs(x), 0.5) if hasattr(np, 'float_power') else np.abs(x)**0.5
sfdae.table(t, knots, heights, 1)
"""
IDIOMS = [line for line in WORK.strip().splitlines()]


# Where the same text has no value at numbers: what it is there.
AT_NUMBERS = {"sfdae.table(t, knots, heights, 1)": "np.interp(t, knots, heights)"}


@pytest.mark.parametrize("text", IDIOMS)
def test_idioms_have_the_shape_and_the_values_of_numpy(text):
    for _ in range(3):
        t, x = RANDOM.uniform(0.05, 0.95), RANDOM.normal(size=N)
        expected = np.asarray(evaluated(AT_NUMBERS.get(text, text), t, x), dtype=float)
        found = values_of(lambda time, v: evaluated(text, time, v), t, x, size=expected.size)
        assert found.shape == expected.shape
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-13)


# Text, and a part of the message: the change that makes it work.
REFUSED = [
    ("r = np.zeros(N); r[0] = x[0]; r", r"np.zeros\(n, like=x\)"),
    ("r = np.zeros(N); r[:] = 2 * x; r", r"np.zeros\(n, like=x\)"),
    ("r = np.zeros(N); r[:2] += x[:2]; r", r"np.zeros\(n, like=x\)"),
    ("r = np.zeros(N); np.add(x, 1, out=r); r", r"np.zeros\(n, like=x\)"),
    ("r = np.zeros(N); np.add.at(r, [0], x[0]); r", r"np.zeros\(n, like=x\)"),
    ("np.array([x[0], -x[1]]) > 0", r"np.array\(\[...\], like=x\)"),
    ("np.maximum(np.array([x[0], -x[1]]), 0)", r"np.array\(\[...\], like=x\)"),
    ("np.array([x[0], x[1]], dtype=float)", "record=False"),
    ("x[x > 0]", r"np.where\(a > b"),
    ("np.where(x > 0)", r"np.where\(a > b, x, y\)"),
    ("max(x[0], 0)", r"np.maximum\(a, b\)"),
    ("1 if x[0] > 0 else 2", r"np.where\(a > b"),
    ("x[0] > 0 and x[1] > 0", r"np.where\(a > b"),
    ("math.sin(x[0])", "np.sin"),
    ("int(t)", "record=False"),
    ("x == 0", "== cannot be decided"),
    ("np.asarray(x) == 0; x", "== cannot be decided"),
    ("0 in np.asarray(x); x", "== cannot be decided"),
    ("np.sort(x)", "np.maximum"),
    ("np.argmax(x)", "np.maximum"),
    ("x.argmax()", "np.maximum"),
    ("np.median(x)", "np.where can be"),
    ("np.isnan(x)", "np.isnan cannot be recorded.*record=False"),
    ("np.linalg.eigvals(M * x)", "make the result unknowns.*record=False"),
    ("np.linalg.solve(M * x, x)", "make the solution z .* write the equations A @ z - b"),
    ("np.fft.fft(x)", "record=False"),
    ("x.astype(float)", "record=False"),
    ("x[0].item()", "record=False"),
    ("np.linalg.solve(M, np.asarray(x) * 2)", r"np.array\(\[...\], like=x\)"),
    ("np.linalg.det(np.array([[x[0], 1], [2, x[1]]]))", r"np.array\(\[...\], like=x\)"),
    ("np.interp(0.4, [0, 1], np.array([x[0], x[1]]))", r"np.array\(\[...\], like=x\)"),
    ("[1, 2, 3][t]", "record=False"),
    ("f'{x[0]:.3f}'", "record=False"),
    ("x[:3] @ x[0]", r"use \* for a single expression"),
]
REFUSED_OF_SCIPY = [
    ("S @ x", "write x @ A.T instead"),
    ("S.dot(x)", "write x @ A.T instead"),
    ("spline(t)", r"write sfdae.table\(t, spline\) instead"),
    ("linear(x)", r"write sfdae.table\(t, spline\) instead"),
    ("special.gamma(x)", "np.gamma cannot be recorded.*record=False"),
    ("optimize.brentq(lambda v: v - x[0], -9, 9)", "record=False"),
]


def is_refused(text, message):
    with pytest.raises(Exception, match=f"(?is){message}"):
        values_of(lambda time, v: evaluated(text, time, v), 0.3, RANDOM.normal(size=N), size=N)


@pytest.mark.parametrize("text, message", REFUSED)
def test_what_cannot_be_recorded_names_the_change(text, message):
    is_refused(text, message)


def with_scipy():
    interpolate = pytest.importorskip("scipy.interpolate")
    knots, heights = GIVEN["knots"], GIVEN["heights"]
    GIVEN["S"] = pytest.importorskip("scipy.sparse").csr_matrix(np.round(GIVEN["M"]))
    GIVEN["special"] = pytest.importorskip("scipy.special")
    GIVEN["optimize"] = pytest.importorskip("scipy.optimize")
    GIVEN["spline"] = interpolate.CubicSpline(knots, heights)
    GIVEN["natural"] = interpolate.CubicSpline(knots, heights, bc_type="natural")
    GIVEN["curve"] = interpolate.CubicSpline(knots, np.stack([heights, knots], axis=1))
    GIVEN["pchip"] = interpolate.PchipInterpolator(knots, heights)
    GIVEN["univariate"] = interpolate.UnivariateSpline(knots, heights, s=0)
    GIVEN["linear"] = interpolate.interp1d(knots, heights)
    GIVEN["cubic"] = interpolate.interp1d(knots, heights, kind="cubic")


@pytest.mark.parametrize("text, message", REFUSED_OF_SCIPY)
def test_what_scipy_cannot_do_names_the_change(text, message):
    with_scipy()
    is_refused(text, message)


OF_SCIPY = """
x @ S.T
x.reshape(1, N) @ S
special.erf(x) + special.erfc(x) * special.expit(x)
sfdae.table(t, spline) | spline(t)
sfdae.table(x, spline) | spline(x)
sfdae.table(t, curve) | curve(t)
sfdae.table(x, natural) | natural(x)
sfdae.table(t, pchip) | pchip(t)
sfdae.table(x, univariate) | univariate(x)
sfdae.table(x, linear) | linear(x)
sfdae.table(t, cubic) | cubic(t)
"""


@pytest.mark.parametrize("text", OF_SCIPY.strip().splitlines())
def test_idioms_of_scipy(text):
    with_scipy()
    text, _, at_numbers = text.partition(" | ")
    t, x = RANDOM.uniform(0.05, 0.95), RANDOM.uniform(-2, 2, size=N)
    expected = np.asarray(evaluated(at_numbers or text, t, x), dtype=float)
    found = values_of(lambda time, v: evaluated(text, time, v), t, x, size=expected.size)
    assert found.shape == expected.shape and found == pytest.approx(expected, rel=1e-11, abs=1e-12)


def test_splines_have_their_derivatives_and_others_are_refused():
    with_scipy()
    for name in ("spline", "natural", "pchip"):
        spline = GIVEN[name]
        found = values_of(lambda t, x: sfdae.time_derivative(sfdae.table(t, spline)), 0.3, [1.0], 1)
        assert found == pytest.approx(float(spline(0.3, nu=1)), rel=1e-11)
    interpolate = pytest.importorskip("scipy.interpolate")
    nearest = interpolate.interp1d(GIVEN["knots"], GIVEN["heights"], kind="nearest")
    with pytest.raises(TypeError, match="kind 'nearest' cannot be recorded: use 'cubic'"):
        sfdae.table(0.3, nearest)
    with pytest.raises(TypeError, match="needs points x and y, or a spline"):
        sfdae.table(0.3, [1.0, 2.0])
    grid = interpolate.RegularGridInterpolator((GIVEN["knots"],), GIVEN["heights"])
    for function in (grid, np.sin):
        with pytest.raises(TypeError, match="use sfdae.external, or solve with record=False"):
            sfdae.table(0.3, function)
    several = interpolate.PchipInterpolator(GIVEN["knots"], np.ones((9, 2)))
    with pytest.raises(TypeError, match="has to be recorded one by one"):
        sfdae.table(0.3, several)


def test_derivatives_above_the_degree_of_a_spline_are_zero():
    """The third derivative of x**2 in an equation of index 3: x = spline(t), v = x', w = v', z = w'."""
    interpolate = pytest.importorskip("scipy.interpolate")
    knots = np.linspace(0, 2, 9)
    parabola = interpolate.UnivariateSpline(knots, knots**2, k=2, s=0)

    def equations(t, x, xdot):
        return [x[0] - sfdae.table(t, parabola), *(xdot[:3] - x[1:])]

    point = sfdae.make_consistent(equations, 0.5, np.zeros(4))
    assert point.x == pytest.approx([0.25, 1, 2, 0], abs=1e-9)


def test_exceptions_of_other_kinds_stay_as_they_are():
    optimize = pytest.importorskip("scipy.optimize")

    def fails(v):
        raise LookupError

    with pytest.raises(LookupError) as caught:
        values_of(lambda t, x: optimize.brentq(fails, 0, 1), 0.3, [1.0], 1)
    assert caught.value.args == ()
    with pytest.raises(KeyError, match="^'mode'$"):
        values_of(lambda t, x: {}["mode"] * x, 0.3, [1.0], 1)


def test_zeros_of_matrices_are_no_dependence():
    """A matrix of numbers, dense or sparse, couples only what it has entries for."""
    chain = np.diag(np.ones(4)) + np.diag(np.ones(3), 1)
    for product in (lambda x: chain @ x, lambda x: x @ chain.T, lambda x: np.dot(chain, x)):
        solver = sfdae.Solver(sfdae.NonlinearProblem(lambda t, x, xdot: product(x) - 1.0, 4))
        solver.start(0.0, np.ones(4), 1.0)
        assert solver.structure().summary.num_blocks == 4
