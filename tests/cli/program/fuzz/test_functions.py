"""Random functions: loops, conditions, arrays, local variables, several outputs, nested calls and recursion, called
with constants, parameters, discrete variables, time and states.

By hand, one model (see comparison.py): SFDAE_PROGRAM=.../sfdae SFDAE_FUZZ_SEED=7 pytest -s test_functions.py
"""

from comparison import run_fuzzer
from expressions import CONTINUOUS, DISCRETE, TIME, TIMED, arithmetic, constant, quotient, relation, total
from function_bodies import Body, recursion
from functions import call, call_text, outputs_of, varies_of, vector
from models import Model, pre


class Functions:
    """Generates one model."""

    def __init__(self, random):
        self.random = random
        self.model = Model(random, random.choice([0.0, 0.0, -1.0, 0.4]), random.choice([1.0, 1.7]))
        self.model.demands_events, self.model.step = False, 0.02
        if self.model.method != "bdf":
            self.model.leniency = 100.0  # kinks and jumps of functions make no events; Radau is less accurate there
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
                result.append(random.choice([*integers, integers[-1], constant(random.randint(-1, 4))]))
                continue
            values = []
            for _ in range(size or 1):
                factors = [random.choice(reals)] if reals and random.random() < 0.8 else []
                values.append(arithmetic("*", self.number(), *factors) if factors else self.number())
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
            self.reals += model.algebraics(["Real", "Real"], call_text(function, arguments),
                                           outputs_of(function, arguments), varies_of(arguments))
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
            forcing = arithmetic("*", self.number(-0.5, 0.5), self.called(CONTINUOUS))
            self.model.set_derivative(state, total([arithmetic("*", self.number(-1, -0.2), state), forcing]))
        return self.model


def test_random_functions():
    run_fuzzer(lambda random: Functions(random).make())
