"""Random rounding functions in every place of a model: floor, ceil, integer, div, mod, rem, abs, sign, min, max of
parameters, discrete variables, time and states.

By hand, one model (see comparison.py): SFDAE_PROGRAM=.../sfdae SFDAE_FUZZ_SEED=7 pytest -s test_rounding.py
"""

from comparison import run_fuzzer
from expressions import (DISCRETE, TIME, TIMED, arithmetic, choice, constant, element, kinked, quotient, relation,
                         rounding, smooth_function, total, variable)
from functions import Assign, Function, call
from models import Model, pre


class Operands:
    """Variables for formulas."""

    def __init__(self):
        self.reals, self.integers = [], []

    def without(self, texts):
        result = Operands()
        result.reals = [one for one in self.reals if one.text not in texts]
        result.integers = [one for one in self.integers if one.text not in texts]
        return result

    def limited(self, varies):
        result = Operands()
        result.reals = [one for one in self.reals if one.varies <= varies]
        result.integers = [one for one in self.integers if one.varies <= varies]
        return result


class Rounding:
    """Generates one model."""

    def __init__(self, random):
        self.random = random
        start = random.choice([0.0, 0.0, -1.0, -0.5, 0.3])
        self.model = Model(random, start, start + random.choice([1.3, 2.1]))
        self.computed = []  # parameters that initial equations determine: they cannot select among arrays
        self.operands, self.arrays, self.functions, self.states = Operands(), [], [], []

    def number(self, low=-1.0, high=1.0):
        return constant(round(self.random.uniform(low, high), 3))

    def divisor(self, is_integer):
        if is_integer:
            return constant(self.random.choice([2, 3, 5, -2, -3]))
        return constant(self.random.choice([0.5, 0.7, 1.3, 2.0, -0.6, -1.1]))

    def of_time(self):
        """Jumps of rounding functions of it are at exact numbers, zero among them."""
        slope = self.random.choice([1.0, 1.0, 2.0, 3.0, 0.5, -1.0, -2.0, -0.5])
        offset = self.random.choice([0.0, 0.0, 0.25, -0.5, 0.37])
        result = arithmetic("*", constant(slope), TIME) if slope != 1.0 else TIME
        return arithmetic("+", result, constant(offset)) if offset != 0.0 else result

    def plain_real(self, operands):
        """Without rounding functions, of size about 1."""
        random = self.random
        choices = [one for one in (operands.reals, operands.integers) if one]
        if not choices:
            return self.number()
        one = random.choice(random.choice(choices))
        if one.text == "time":
            return self.of_time()
        form = random.randrange(4)
        if form == 0:
            return arithmetic("*", self.number(0.6, 2.5), one)
        if form == 1:
            return arithmetic("-", self.number(), one)
        if form == 2:
            return arithmetic("+", arithmetic("*", self.number(-2, 2), one), self.number())
        return one

    def notice(self, operand, jumps):
        """Kinks and jumps of abs, min, max, sign and functions make no events; Radau is less accurate there."""
        if operand.varies == DISCRETE:
            return
        if self.model.method != "bdf":
            self.model.leniency = 100.0
        self.model.demands_events = self.model.demands_events and not jumps

    def integer(self, operands, depth=0):
        random = self.random
        form = random.randrange(8)
        if form == 0 and operands.integers:
            return random.choice(operands.integers)
        if form == 1:
            return kinked("sign", self.real(operands.limited(DISCRETE), depth + 1))  # makes no event
        if form == 2 and depth < 2:
            bound = constant(random.randint(-1, 2))
            return kinked(random.choice(["min", "max"]), self.integer(operands, depth + 1), bound)
        if form == 3 and depth < 2:
            return kinked("abs", self.integer(operands, depth + 1))
        if form in (4, 5) and depth < 2:
            name = random.choice(["div", "mod", "rem"])
            return quotient(name, self.integer(operands, depth + 1), self.divisor(True))
        if form == 6 and depth < 2:
            return arithmetic(random.choice("+-"), self.integer(operands, depth + 1), constant(random.randint(1, 3)))
        return rounding("integer", self.real(operands, depth + 1))

    def real(self, operands, depth=0):
        random = self.random
        form = random.randrange(9)
        if depth >= 2 or form == 0:
            return self.plain_real(operands)
        inner = self.real(operands, depth + 1)
        if form in (1, 2):
            return rounding(random.choice(["floor", "ceil"]), inner)
        if form in (3, 4, 5):
            return quotient(random.choice(["div", "mod", "rem"]), inner, self.divisor(False))
        if form == 6:
            self.notice(inner, False)
            return kinked(random.choice(["min", "max"]), inner, self.real(operands.limited(inner.varies), depth + 1))
        if form == 7 and self.arrays:
            name, size = random.choice(self.arrays)
            index = self.integer(operands.without(self.computed), depth + 1)
            subscript = arithmetic("+", constant(1), quotient("mod", index, constant(size)))
            return element("Real", name, subscript)
        if form == 8 and self.functions:
            self.notice(inner, True)
            return call(random.choice(self.functions), [inner, self.integer(operands.limited(DISCRETE), depth + 1)])
        is_sign = random.random() < 0.5
        self.notice(inner, is_sign)
        if not is_sign:
            return kinked("abs", inner)
        return arithmetic("*", self.number(), kinked("sign", inner))

    def condition(self, operands):
        random = self.random
        form = random.randrange(3)
        if form == 0:
            number = constant(random.randint(-1, 2))
            return relation(random.choice(["==", "<>", ">=", "<"]), self.integer(operands, 1), number)
        if form == 1:
            return relation(random.choice([">=", "<", ">", "<="]), self.real(operands, 1), self.number())
        return relation("==", quotient("mod", self.integer(operands, 1), constant(2)), constant(random.randint(0, 1)))

    def make_parameters(self):
        model, random, operands = self.model, self.random, self.operands
        for _ in range(random.randint(1, 2)):
            operands.integers.append(model.parameter(constant(random.choice([-7, -5, -3, -1, 0, 2, 3, 4, 7, 8]))))
            operands.reals.append(model.parameter(self.number(-4, 4)))
        if random.random() < 0.4:
            free = model.free_parameter(round(random.uniform(-2.9, 2.9), 3), random.choice([0.0, 1.0]))
            shift = self.real(operands)
            model.require_initially(arithmetic("+", arithmetic("*", constant(2.0), free), shift))
            operands.reals.append(free)
            self.computed.append(free.text)
        self.arrays = [(model.array([round(random.uniform(-1, 1), 2) for _ in range(size)]), size) for size in (2, 4)]
        for _ in range(random.randint(0, 2)):
            for kind, formula in ((operands.reals, self.real(operands)), (operands.integers, self.integer(operands))):
                kind.append(model.parameter(formula))
                if any(text in formula.text for text in self.computed):
                    self.computed.append(kind[-1].text)

    def make_functions(self):
        """v := a formula of the inputs u and n."""
        for k in range(self.random.randint(0, 2)):
            inside = Rounding(self.random)
            inside.operands.reals = [variable("Real", "u", TIMED)]
            inside.operands.integers = [variable("Integer", "n")]
            body = inside.real(inside.operands)
            function = Function(f"g{k}", [("Real", "u", None, None), ("Integer", "n", None, None)],
                                [("Real", "v", None, None)], [], [Assign("v", body)])
            self.functions.append(function)
            self.model.functions.append(function.text())

    def make_states(self):
        for _ in range(self.random.randint(1, 2)):
            start = arithmetic("+", self.number(), arithmetic("*", constant(0.3), self.real(self.operands)))
            self.states.append(self.model.state(start))

    def make_when(self):
        model, random, operands = self.model, self.random, self.operands
        count = model.discrete(constant(random.randint(-3, 3)))
        held = model.discrete(self.number(-2, 2))
        stepped = arithmetic("+", pre(count), constant(random.choice([1, 1, -1, 2])))
        form = random.randrange(3)
        if form == 0:
            trigger = model.sample(random.choice([0.0, 0.11]), random.choice([0.23, 0.41]))
        elif form == 1:
            last = model.discrete(constant(-100))
            clock = rounding("integer", arithmetic("*", constant(random.choice([2.0, 3.7])), TIME))
            assignments = [(last, clock), (count, stepped), (held, self.real(operands))]
            model.when([([relation("<>", clock, pre(last))], assignments, [])])
            trigger = None
        else:
            trigger = self.condition(operands)
        if trigger is not None:
            if random.random() < 0.4:
                stepped = self.integer(operands)
            model.when([([trigger], [(count, stepped), (held, self.real(operands))], [])])
        operands.integers.append(count)
        operands.reals.append(held)

    def make_algebraic(self):
        random, operands = self.random, self.operands
        form = random.randrange(4)
        if form == 0:
            operands.integers.append(self.model.algebraic(self.integer(operands)))
        elif form == 1:
            self.model.algebraic(self.condition(operands))
        elif form == 2:
            self.model.algebraic(choice(self.condition(operands), self.real(operands), self.real(operands)))
        else:
            operands.reals.append(self.model.algebraic(self.real(operands)))

    def make(self):
        random, operands = self.random, self.operands
        self.make_functions()
        self.make_parameters()
        self.make_states()
        operands.reals += [TIME, TIME, *self.states]
        makers = [self.make_algebraic] * random.randint(2, 5) + [self.make_when] * random.randint(0, 2)
        random.shuffle(makers)
        for make in makers:
            make()
        for state in self.states:
            forcing = smooth_function("tanh", self.real(operands)) if random.random() < 0.3 else self.real(operands)
            rate = [arithmetic("*", self.number(-1, -0.2), state), arithmetic("*", self.number(), forcing)]
            self.model.set_derivative(state, total(rate))
        return self.model


def test_random_rounding_functions():
    run_fuzzer(lambda random: Rounding(random).make())
