"""Random functions."""

from expressions import (DISCRETE, TIMED, arithmetic, choice, constant, element, kinked, logical, negation, quotient,
                         relation, rounding, smooth_function, total, variable)
from functions import Assign, AssignOutputs, For, Function, If, Leave, While, call, vector


def local(kind, name):
    return variable(kind, name, TIMED if kind == "Real" else DISCRETE)


class Body:
    """Generates the algorithm of one function. All Reals stay bounded, Integers small."""

    def __init__(self, random, callable_functions):
        self.random, self.callable_functions = random, callable_functions
        self.reals, self.integers, self.arrays, self.targets, self.others = [], [], [], [], []
        self.counters = self.loops = 0
        self.may_return = False  # loops after a return become many rounds, too

    def number(self, low=-1.0, high=1.0):
        return constant(round(self.random.uniform(low, high), 2))

    def subscript(self, size):
        if self.random.random() < 0.3:
            return constant(self.random.randint(1, size))
        index = self.integer(1) if self.random.random() < 0.3 else self.random.choice(self.integers)
        bounded = quotient("mod", index, constant(size))
        return self.random.choice([arithmetic("+", constant(1), bounded), arithmetic("-", constant(size), bounded)])

    def integer(self, depth=0):
        random = self.random
        form = random.randrange(5)
        if form == 0 and depth < 2:
            return arithmetic(random.choice("+-"), self.integer(depth + 1), constant(random.randint(0, 3)))
        if form == 1 and depth < 2:
            name = random.choice(["div", "mod", "rem"])
            return quotient(name, self.integer(depth + 1), constant(random.choice([2, 3, -4])))
        if form == 2 and depth < 2:
            return kinked(random.choice(["min", "max"]), self.integer(depth + 1), constant(random.randint(-2, 4)))
        if form == 3 and depth < 2:
            return rounding("integer", self.real(depth + 1))
        return random.choice([*self.integers, constant(random.randint(-2, 4))])

    def real(self, depth=0):
        random = self.random
        form = random.randrange(12)
        if form == 0 and self.arrays:
            name, size = random.choice(self.arrays)
            return element("Real", name, self.subscript(size), TIMED)
        if depth > 2 or form == 1:
            return random.choice([*self.reals, self.number()])
        if form == 2:
            return arithmetic("*", constant(0.1), self.integer(depth + 1))
        inner = self.real(depth + 1)
        if form in (3, 4):
            return total([arithmetic("*", self.number(), inner), arithmetic("*", self.number(), self.real(depth + 1))])
        if form == 5:
            return smooth_function(random.choice(["sin", "cos", "tanh", "atan"]), inner)
        if form == 6:
            return arithmetic("/", inner, arithmetic("+", constant(1.0), arithmetic("*", self.reals[0], self.reals[0])))
        if form == 7:
            return choice(self.condition(depth + 1), inner, self.real(depth + 1))
        if form == 8:
            return kinked(random.choice(["min", "max"]), inner, self.number())
        if form == 9:
            return random.choice([kinked("abs", inner), rounding(random.choice(["floor", "ceil"]), inner)])
        if form == 10 and self.callable_functions and self.loops == 0:
            function = random.choice(self.callable_functions)
            return call(function, self.arguments(function, depth + 1))
        return arithmetic(random.choice("+-"), inner, self.number())

    def arguments(self, function, depth=0):
        result = []
        for kind, _, size, _ in function.inputs:
            if size:
                result.append(vector([self.real(depth + 1) for _ in range(size)]))
            else:
                result.append(self.real(depth) if kind == "Real" else self.integer(depth))
        return result

    def condition(self, depth=0):
        random = self.random
        if random.random() < 0.3:
            number = constant(random.randint(-1, 3))
            result = relation(random.choice(["==", "<>", "<", ">="]), self.integer(depth + 1), number)
        else:
            result = relation(random.choice(["<", "<=", ">", ">="]), self.real(depth + 1), self.number())
        if random.random() < 0.15:
            result = logical(random.choice(["and", "or"]), result, self.condition(depth + 1))
        return negation(result) if random.random() < 0.1 else result

    def statement(self, depth, in_loop):
        """One statement, or a few that belong together."""
        random = self.random
        form = random.randrange(10)
        if form == 0 and depth < 2:
            conditions = [self.condition(1) for _ in range(random.randint(1, 2))] + random.choice([[], [None]])
            return [If([(condition, self.block(depth + 1, in_loop)) for condition in conditions])]
        if depth < 2 and (form == 1 or (form == 2 and self.loops == 0 and not self.may_return)):
            self.loops += 1
            result = [self.loop(depth)] if form == 1 else self.while_loop()
            self.loops -= 1
            return result
        if form == 3 and self.arrays:
            name, size = random.choice(self.arrays)
            return [Assign(name, self.bounded(), self.subscript(size))]
        if form == 4 and self.integers_to_assign:
            modulus = constant(random.choice([3, 5, 7]))
            return [Assign(random.choice(self.integers_to_assign), quotient("mod", self.integer(), modulus))]
        if form == 5 and in_loop:
            return [If([(self.condition(1), [Leave("break")])])]
        if form == 6 and depth < 2 and random.random() < 0.3:
            self.may_return = True
            return [If([(self.condition(1), [Leave("return")])])]
        if form == 7 and len(self.targets) > 1 and self.loops == 0:
            several = [one for one in self.callable_functions if len(one.outputs) == 2]
            if several:
                function = random.choice(several)
                return [AssignOutputs(random.sample(self.targets, 2), function, self.arguments(function, 1))]
        return [Assign(random.choice(self.targets), self.bounded())]

    def bounded(self):
        """A Real that does not grow in loops."""
        if self.random.random() < 0.5:
            return arithmetic("*", constant(0.5), self.real())
        return smooth_function("sin", self.real())

    def block(self, depth, in_loop):
        return [one for _ in range(self.random.randint(1, 2)) for one in self.statement(depth, in_loop)]

    def loop(self, depth):
        self.counters += 1
        name = f"i{self.counters}"
        first, last, step = self.random.choice([(1, 2, 1), (1, 3, 1), (2, 4, 2), (3, 1, -1), (2, 1, 1)])
        iterator = local("Integer", name)
        self.integers.append(iterator)
        body = self.block(depth + 1, True)
        self.integers.remove(iterator)
        return For(name, constant(first), step, constant(last), body)

    def while_loop(self):
        """The program expands it to many rounds: it contains little."""
        self.counters += 1
        name = f"k{self.counters}"
        self.others.append(("Integer", name, None, constant(0)))
        counter = local("Integer", name)
        condition = relation("<", counter, constant(self.random.randint(1, 3)))
        self.integers.append(counter)
        body = self.block(2, False)
        if self.random.random() < 0.5:
            condition = logical("and", condition, self.condition(1))
            target = local("Real", self.random.choice(self.targets))
            body = [Assign(target.text.strip("'"), smooth_function("sin", arithmetic("+", target, self.number())))]
        count = Assign(name, arithmetic("+", counter, constant(1)))
        return [Assign(name, constant(0)), While(condition, [count, *body])]

    def make(self, name):
        random = self.random
        inputs = [("Real", "u", None, None)] + random.choice([[], [("Real", "v", None, None)]])
        inputs += random.choice([[], [("Integer", "n", None, None)], [("Integer", "n", None, None)]])
        inputs += random.choice([[], [], [("Real", "a", 3, None)]])
        outputs = [("Real", "y", None, self.number())] + random.choice([[], [("Real", "z", None, self.number())]])
        self.others += [("Real", "s", None, self.number()), ("Integer", "m", None, constant(random.randint(0, 3)))]
        if random.random() < 0.5:
            self.others.append(("Real", "b", 4, vector([self.number() for _ in range(4)])))
        for kind, one, size, _ in [*inputs, *outputs, *self.others]:
            if size:
                self.arrays.append((one, size))
            else:
                (self.reals if kind == "Real" else self.integers).append(local(kind, one))
        self.targets = [one for _, one, _, _ in outputs] + ["s"]
        self.integers_to_assign = ["m"]
        arrays, self.arrays = self.arrays, [one for one in self.arrays if one[0] != "a"]
        first = [Assign("s", element("Real", "a", constant(2), TIMED))] if arrays != self.arrays else []
        body = first + [one for _ in range(random.randint(2, 5)) for one in self.statement(0, False)]
        last = arithmetic("*", self.number(), local("Real", "s"))
        body.append(Assign("y", arithmetic("+", local("Real", "y"), last)))
        return Function(name, inputs, outputs, self.others, body)


def recursion(random, name):
    """y := if n <= 0 then u else a f(sin(u) + n / 10, n - 1)."""
    inputs = [("Real", "u", None, None), ("Integer", "n", None, None)]
    function = Function(name, inputs, [("Real", "y", None, None)], [], [])
    u, n = local("Real", "u"), local("Integer", "n")
    next_u = arithmetic("+", smooth_function("sin", u), arithmetic("*", constant(0.1), n))
    inner = call(function, [next_u, arithmetic("-", n, constant(random.choice([1, 2])))])
    more = Assign("y", arithmetic("*", constant(round(random.uniform(0.3, 0.9), 2)), inner))
    function.body = [If([(relation("<=", n, constant(0)), [Assign("y", u)]), (None, [more])])]
    return function
