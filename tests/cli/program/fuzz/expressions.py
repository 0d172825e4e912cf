"""Formulas of random models: each has its text in Modelica and a Python function that computes its value.

The functions take a frame: `frame.values` are the variables by name, and `frame.decide(...)` is called for every
relation and every rounding function, so that a simulation can hold these between events.
"""

import math
import operator

DISCRETE, TIMED, CONTINUOUS = 0, 1, 2  # changes at events only; with time alone; with states


class Rejected(Exception):
    """The random model is not suitable: rounding errors decide, or events come too close to each other."""


class Expression:
    """A formula. `kind` is Real, Integer or Boolean, `varies` one of DISCRETE, TIMED, CONTINUOUS."""

    def __init__(self, kind, text, value, varies=DISCRETE):
        self.kind, self.text, self.value, self.varies = kind, text, value, varies


def constant(value):
    """Booleans, Integers and Reals as Modelica writes them, negative ones in parentheses."""
    kind = {bool: "Boolean", int: "Integer", float: "Real"}[type(value)]
    text = str(value).lower() if kind == "Boolean" else repr(value)
    return Expression(kind, f"({text})" if text.startswith("-") else text, lambda frame: value)


def variable(kind, name, varies=DISCRETE, text=None):
    return Expression(kind, text or f"'{name}'", lambda frame: frame.values[name], varies)


TIME = variable("Real", "time", TIMED, "time")


def element(kind, array, subscript, varies=DISCRETE):
    """An element of a one-dimensional array."""
    return Expression(kind, f"'{array}'[{subscript.text}]",
                      lambda frame: frame.values[array][subscript.value(frame) - 1], max(varies, subscript.varies))


def combined(kind, text, function, *operands):
    """A formula that computes `function` from the values of its operands."""
    values = [operand.value for operand in operands]
    return Expression(kind, text, lambda frame: function(*[value(frame) for value in values]),
                      max(operand.varies for operand in operands))


def arithmetic(symbol, a, b):
    """a + b, a - b, a * b, a / b."""
    function = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}[symbol]
    kind = "Integer" if a.kind == b.kind == "Integer" and symbol != "/" else "Real"
    return combined(kind, f"({a.text} {symbol} {b.text})", function, a, b)


def total(terms):
    result = terms[0]
    for term in terms[1:]:
        result = arithmetic("+", result, term)
    return result


def smooth_function(name, a):
    """sin, cos, tanh, atan, exp, sqrt."""
    return combined("Real", f"{name}({a.text})", getattr(math, name), a)


def relation(symbol, a, b):
    function = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq,
                "<>": operator.ne}[symbol]
    varies = max(a.varies, b.varies)
    is_exact = a.kind != "Real" and b.kind != "Real"

    def value(frame):
        x, y = a.value(frame), b.value(frame)
        return frame.decide(function(x, y), 1.0 if is_exact else abs(x - y), varies)

    return Expression("Boolean", f"({a.text} {symbol} {b.text})", value, varies)


def logical(symbol, a, b):
    """`and`, `or`; the second operand is not needed where the first one decides."""
    if symbol == "and":
        value = lambda frame: a.value(frame) and b.value(frame)
    else:
        value = lambda frame: a.value(frame) or b.value(frame)
    return Expression("Boolean", f"({a.text} {symbol} {b.text})", value, max(a.varies, b.varies))


def negation(a):
    return combined("Boolean", f"(not {a.text})", operator.not_, a)


def choice(condition, a, b):
    """An if-expression; only the branch taken is computed."""
    kind = a.kind if a.kind == b.kind else "Real"
    return Expression(kind, f"(if {condition.text} then {a.text} else {b.text})",
                      lambda frame: a.value(frame) if condition.value(frame) else b.value(frame),
                      max(condition.varies, a.varies, b.varies))


def distance_to_integer(quotient):
    return abs(quotient - round(quotient))


def rounding(name, a):
    """floor, ceil and integer."""
    def value(frame):
        x = a.value(frame)
        result = frame.decide(math.ceil(x) if name == "ceil" else math.floor(x),
                              1.0 if a.kind == "Integer" else distance_to_integer(x), a.varies)
        return result if name == "integer" else float(result)

    return Expression("Integer" if name == "integer" else "Real", f"{name}({a.text})", value, a.varies)


def quotient(name, a, b):
    """div, mod and rem: div truncates, mod(x, y) = x - floor(x / y) y, rem(x, y) = x - div(x, y) y."""
    is_integer = a.kind == b.kind == "Integer"
    varies = max(a.varies, b.varies)

    def value(frame):
        x, y = a.value(frame), b.value(frame)
        if is_integer:
            floor = x // y
            result = floor if name == "mod" or floor >= 0 else -(-x // y)
            margin = 1.0
        else:
            result = math.floor(x / y) if name == "mod" else math.trunc(x / y)
            margin = distance_to_integer(x / y) if name == "mod" or abs(x / y) > 0.5 else 1.0
        result = frame.decide(result, margin, varies)
        if name == "div":
            return result if is_integer else float(result)
        return x - result * y

    return Expression("Integer" if is_integer else "Real", f"{name}({a.text}, {b.text})", value, varies)


def kinked(name, a, b=None):
    """abs and sign of a, min and max of a and b: no events in Modelica, but kinks and jumps."""
    kind = a.kind if b is None or a.kind == b.kind else "Real"
    if name == "sign":
        kind = "Integer"
    varies = a.varies if b is None else max(a.varies, b.varies)

    def value(frame):
        x, y = a.value(frame), 0 if b is None else b.value(frame)
        order = frame.decide((x > y) - (x < y), abs(x - y) if name == "sign" else 1.0, varies)
        if name in ("abs", "sign"):
            return order if name == "sign" else (x if order >= 0 else -x)
        result = x if (order >= 0) == (name == "max") else y
        return float(result) if kind == "Real" else result

    operands = a.text if b is None else f"{a.text}, {b.text}"
    return Expression(kind, f"{name}({operands})", value, varies)
