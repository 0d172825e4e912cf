"""Random functions: loops, conditions, arrays, local variables, several outputs, nested calls and recursion, called with
constants, parameters, discrete variables, time and states.

By hand, the model of one seed: SFDAE_PROGRAM=.../sfdae SFDAE_FUZZ_SEED=7 pytest -s test_functions.py (see comparison.py).
"""

from comparison import run_fuzzer
from expressions import (CONTINUOUS, DISCRETE, TIME, TIMED, arithmetic, choice, constant, element, kinked, logical, negation,
                         quotient, relation, rounding, smooth_function, total, variable)
from functions import Assign, AssignOutputs, For, Function, If, Leave, While, call, call_text, outputs_of, varies_of, vector
from models import Model, pre


def local(kind, name):
    return variable(kind, name, TIMED if kind == "Real" else DISCRETE)


class Body:
    """Generates the algorithm of one function. All Reals stay bounded, Integers small."""

    def __init__(self, random, callable_functions):
        self.random, self.callable_functions = random, callable_functions
        self.reals, self.integers, self.arrays, self.targets, self.others = [], [], [], [], []
        self.counters = self.loops = 0

    def number(self, low=-1.0, high=1.0):
        return constant(round(self.random.uniform(low, high), 2))

    def subscript(self, size):
        if self.random.random() < 0.5:
            return constant(self.random.randint(1, size))
        return arithmetic("+", constant(1), quotient("mod", self.integer(1), constant(size)))

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
            result = relation(random.choice(["==", "<>", "<", ">="]), self.integer(depth + 1), constant(random.randint(-1, 3)))
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
            branches = [(self.condition(1), self.block(depth + 1, in_loop)) for _ in range(random.randint(1, 2))]
            return [If(branches + ([(None, self.block(depth + 1, in_loop))] if random.random() < 0.7 else []))]
        if form in (1, 2) and depth < 2:
            self.loops += 1
            result = [self.loop(depth)] if form == 1 else self.while_loop(depth)
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
            return [If([(self.condition(1), [Leave("return")])])]
        if form == 7 and len(self.targets) > 1 and self.loops == 0:
            several = [one for one in self.callable_functions if len(one.outputs) == 2]
            if several:
                function = random.choice(several)
                return [AssignOutputs(random.sample(self.targets, 2), function, self.arguments(function, 1))]
        return [Assign(random.choice(self.targets), self.bounded())]

    def bounded(self):
        """A Real that does not grow in loops."""
        return arithmetic("*", constant(0.5), self.real()) if self.random.random() < 0.5 else smooth_function("sin", self.real())

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

    def while_loop(self, depth):
        self.counters += 1
        name = f"k{self.counters}"
        self.others.append(("Integer", name, None, constant(0)))
        counter = local("Integer", name)
        condition = relation("<", counter, constant(self.random.randint(1, 3)))
        if self.loops == 1 and self.random.random() < 0.5:  # many rounds become formulas: no loops in it
            condition, depth = logical("and", condition, self.condition(1)), 1
        self.integers.append(counter)
        count = Assign(name, arithmetic("+", counter, constant(1)))
        return [Assign(name, constant(0)), While(condition, [count, *self.block(depth + 1, True)])]

    def make(self, name):
        random = self.random
        inputs = [("Real", "u", None, None)] + random.choice([[], [("Real", "v", None, None)]])
        inputs += random.choice([[], [("Integer", "n", None, None)]]) + random.choice([[], [], [("Real", "a", 3, None)]])
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
        body.append(Assign("y", arithmetic("+", local("Real", "y"), arithmetic("*", self.number(), local("Real", "s")))))
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


class Functions:
    """Generates one model."""

    def __init__(self, random):
        self.random = random
        self.model = Model(random, random.choice([0.0, 0.0, -1.0, 0.4]), random.choice([1.0, 1.7]))
        self.model.demands_events, self.model.step = False, 0.02
        self.functions, self.recursive, self.states = [], [], []
        self.reals, self.integers = [], []

    def number(self, low=-1.5, high=1.5):
        return constant(round(self.random.uniform(low, high), 2))

    def called(self, varies):
        """A call with arguments that do not vary more."""
        reals = [one for one in self.reals if one.varies <= varies]
        function = self.random.choice(self.functions)
        return call(function, self.arguments(function, reals, self.integers))

    def arguments(self, function, reals, integers):
        random, result = self.random, []
        for kind, _, size, _ in function.inputs:
            if kind == "Integer":
                result.append(random.choice([*integers, constant(random.randint(-1, 4))]))
                continue
            values = [arithmetic("*", self.number(), random.choice(reals)) if reals and random.random() < 0.8 else self.number()
                      for _ in range(size or 1)]
            result.append(vector(values) if size else values[0])
        return result

    def make_functions(self):
        for k in range(self.random.randint(1, 3)):
            self.functions.append(Body(self.random, list(self.functions)).make(f"f{k}"))
        if self.random.random() < 0.3:
            self.recursive.append(recursion(self.random, "r"))
        texts = [function.text() for function in self.functions + self.recursive]
        self.model.functions += self.random.sample(texts, len(texts))

    def make_parameters(self):
        model, random = self.model, self.random
        self.integers.append(model.parameter(constant(random.randint(0, 4))))
        self.reals.append(model.parameter(self.number()))
        for _ in range(random.randint(0, 2)):
            self.reals.append(model.parameter(self.called(DISCRETE)))
        for function in self.recursive:
            self.reals.append(model.parameter(call(function, [self.reals[0], self.integers[0]])))

    def make_when(self):
        model, random = self.model, self.random
        count, held = model.discrete(constant(random.randint(0, 2))), model.discrete(self.number())
        trigger = random.choice([model.sample(0.15, 0.37), relation(">=", TIME, constant(0.533))])
        step = quotient("mod", arithmetic("+", pre(count), constant(1)), constant(4))
        model.when([([trigger], [(count, step), (held, self.called(CONTINUOUS))], [])])
        self.integers.append(count)
        self.reals.append(held)

    def make_algebraic(self):
        model, random = self.model, self.random
        several = [function for function in self.functions if len(function.outputs) == 2]
        if several and random.random() < 0.4:
            function = random.choice(several)
            arguments = self.arguments(function, self.reals, self.integers)
            self.reals += model.algebraics(["Real", "Real"], call_text(function, arguments), outputs_of(function, arguments),
                                           varies_of(arguments))
        elif self.recursive and random.random() < 0.3:
            self.reals.append(model.algebraic(call(self.recursive[0], [random.choice(self.reals), self.integers[0]])))
        else:
            self.reals.append(model.algebraic(self.called(random.choice([DISCRETE, TIMED, CONTINUOUS]))))

    def make(self):
        random = self.random
        self.make_functions()
        self.make_parameters()
        for _ in range(random.randint(1, 2)):
            self.states.append(self.model.state(self.called(DISCRETE) if random.random() < 0.5 else self.number()))
        self.reals += [TIME, *self.states]
        makers = [self.make_algebraic] * random.randint(2, 4) + [self.make_when] * random.randint(0, 1)
        random.shuffle(makers)
        for make in makers:
            make()
        for state in self.states:
            rate = [arithmetic("*", self.number(-1, -0.2), state), arithmetic("*", self.number(-0.5, 0.5), self.called(CONTINUOUS))]
            self.model.set_derivative(state, total(rate))
        return self.model


def test_random_functions():
    run_fuzzer(lambda random: Functions(random).make())
