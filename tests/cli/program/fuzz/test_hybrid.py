"""Random hybrid models: states, discrete variables in when clauses, if-expressions, free parameters.

By hand, one model (see comparison.py): SFDAE_PROGRAM=.../sfdae SFDAE_FUZZ_SEED=7 pytest -s test_hybrid.py
"""

from comparison import run_fuzzer
from expressions import (TIME, arithmetic, choice, constant, kinked, logical, negation, relation, smooth_function,
                         total)
from models import Model, change, derivative, edge, pre

THRESHOLDS = [0.0, 0.0, 0.137, 0.381, 0.613, 0.871, -0.229, -0.457, 1.093, 1.379]


class Hybrid:
    """Generates one model."""

    def __init__(self, random):
        self.random = random
        start = random.choice([0.0, 0.0, 0.0, -0.5, -1.0, 0.25])
        self.model = Model(random, start, start + 2.0)
        # Relations with a threshold change all at that time (>=, <), or all right after it (>, <=).
        self.thresholds = [*THRESHOLDS, start]
        self.strict = {threshold: random.random() < 0.3 for threshold in self.thresholds}
        self.zero = 0.05 if self.strict[0.0] else 0.0  # of samples: they are no events right after a time
        self.states, self.reals, self.discretes, self.parameters, self.has_reinit = [], [], [], [], set()
        self.triggers = []

    def number(self, low=-1.0, high=1.0):
        return constant(round(self.random.uniform(low, high), 3))

    def of_kind(self, kind):
        return [one for one in self.discretes if one.kind == kind]

    def make_parameters(self):
        model, random = self.model, self.random
        for _ in range(random.randint(1, 3)):
            self.parameters.append(model.parameter(self.number(0.3, 1.5)))
        if random.random() < 0.5:
            self.parameters.append(model.parameter(arithmetic("*", self.number(0.5, 1.2), self.parameters[0])))
        self.factors = self.parameters + [model.changed_parameter(round(random.uniform(0.3, 1.5), 3))]
        for _ in range(random.choice([0, 0, 1, 2])):
            free = model.free_parameter(round(random.uniform(0.3, 1.5), 3), random.choice([0.0, 1.0, 5.0]))
            scale = constant(random.choice([1.0, 1.0, 2.5, 1e-3, 1e-9, 1e-14, 1e5]))
            formula = arithmetic("+", free, arithmetic("*", constant(0.2), smooth_function("sin", self.parameters[-1])))
            model.require_initially(arithmetic("*", scale, formula))
            self.parameters.append(free)
            if random.random() < 0.4:
                self.parameters.append(model.parameter(arithmetic("+", free, self.number(0.1, 0.5))))

    def make_states(self):
        model, random = self.model, self.random
        for _ in range(random.randint(1, 3)):
            start = self.number()
            if random.random() < 0.3:
                start = arithmetic("+", arithmetic("*", constant(0.7), random.choice(self.parameters)), self.number())
            if random.random() < 0.2:
                state = model.state(self.number(), random.choice([0.0, 2.0]))
                scale = constant(random.choice([1.0, 3.0, 1e-9]))
                others = [arithmetic("*", constant(0.5), other) for other in self.states[-1:]]
                model.require_initially(arithmetic("*", scale, total([state, *others])))
            else:
                state = model.state(start)
            self.states.append(state)
        self.reals = list(self.states)

    def make_steady_state(self):
        """A state whose start value follows from its derivative."""
        state = self.model.state(self.number(), 0.0)
        cosine = smooth_function("cos", arithmetic("*", self.number(0.5, 3.0), TIME))
        rate = arithmetic("*", self.number(-1.5, -0.3), state)
        self.model.set_derivative(state, total([rate, arithmetic("*", self.random.choice(self.factors), cosine)]))
        self.model.require_initially(derivative(state))
        self.reals.append(state)

    def time_condition(self):
        threshold = self.random.choice(self.thresholds)
        symbol = self.random.choice([">", "<="] if self.strict[threshold] else [">=", "<"])
        form = self.random.randrange(4)
        if form == 0:
            return relation({">": "<", "<=": ">=", ">=": "<=", "<": ">"}[symbol], constant(threshold), TIME)
        if form == 1:
            return relation(symbol, arithmetic("-", TIME, constant(threshold)), constant(0.0))
        if form == 2:
            return relation(symbol, arithmetic("*", constant(2.0), TIME), constant(2.0 * threshold))
        return relation(symbol, TIME, constant(threshold))

    def state_condition(self):
        left = self.random.choice(self.reals)
        if self.random.random() < 0.3:
            left = arithmetic("-", left, arithmetic("*", constant(0.3), self.random.choice(self.states)))
        return relation(self.random.choice([">", ">=", "<", "<="]), left, self.number())

    def discrete_condition(self):
        """Without events of its own."""
        booleans, integers = self.of_kind("Boolean"), self.of_kind("Integer")
        if booleans and self.random.random() < 0.5:
            one = self.random.choice(booleans)
            return self.random.choice([one, negation(one)])
        if integers:
            symbol = self.random.choice(["==", "<>", ">", "<="])
            return relation(symbol, self.random.choice(integers), constant(self.random.randint(0, 3)))
        return relation(">", self.random.choice(self.parameters), self.number(0.3, 1.5))

    def condition(self):
        make = self.random.choices([self.time_condition, self.state_condition, self.discrete_condition], [3, 3, 2])[0]
        result = make()
        if self.random.random() < 0.15:
            result = logical(self.random.choice(["and", "or"]), result, self.discrete_condition())
        return result

    def term(self):
        """A bounded Real."""
        random = self.random
        form = random.randrange(8)
        if form == 0:
            return arithmetic("*", self.number(), smooth_function("sin", random.choice(self.reals)))
        if form == 1:
            return arithmetic("*", self.number(), smooth_function("cos", arithmetic("*", self.number(0.5, 3.0), TIME)))
        if form == 2:
            return choice(self.condition(), self.number(), self.number())
        if form == 3:
            return choice(self.condition(), arithmetic("*", self.number(), random.choice(self.factors)), self.number())
        if form == 4 and self.of_kind("Real"):
            return arithmetic("*", self.number(), random.choice(self.of_kind("Real")))
        if form == 5 and self.of_kind("Integer"):
            return arithmetic("*", self.number(-0.3, 0.3), random.choice(self.of_kind("Integer")))
        if form == 6:
            return kinked(random.choice(["min", "max"]), random.choice(self.reals), self.number())
        return arithmetic("*", self.number(), random.choice(self.factors))

    def make_algebraic(self):
        random = self.random
        form = random.randrange(12)
        if form < 3:
            self.discretes.append(self.model.algebraic(self.condition()))
        elif form == 10:
            self.discretes.append(self.model.latch(self.condition(), self.condition()))
        elif form == 11:
            self.discretes.append(self.model.algebraic(self.model.sample(0.07, round(random.uniform(0.3, 0.7), 3))))
        elif form == 3:
            condition = random.choice([self.time_condition, self.state_condition])()
            self.reals.append(self.model.if_equation(condition, self.term(), self.term()))
        elif form == 4:
            factors = random.choice([0.5, -0.8]), random.choice([0.4, -0.3])
            integers = self.of_kind("Integer")
            jumps = integers and random.random() < 0.5
            one = arithmetic("*", self.number(), random.choice(integers if jumps else self.reals))
            self.reals += self.model.coupled(one, self.term(), *factors)
        else:
            expression = total([arithmetic("*", self.number(), random.choice(self.reals)), self.term()])
            self.reals.append(self.model.algebraic(expression))

    def assigned(self, variable):
        """The new value of a variable in a when clause."""
        random = self.random
        if variable.kind == "Boolean":
            return random.choice([negation(pre(variable)), self.discrete_condition(), constant(True), constant(False)])
        if variable.kind == "Integer":
            step = constant(random.choice([1, 1, 2, -1]))
            return arithmetic("+", pre(variable), step)
        booleans = self.of_kind("Boolean")
        if booleans and random.random() < 0.2:
            one = random.choice(booleans)
            return choice(random.choice([edge(one), change(one)]), self.number(), self.term())
        if random.random() < 0.5:
            return total([arithmetic("*", constant(0.5), pre(variable)), self.term()])
        return total([arithmetic("*", self.number(), random.choice(self.reals)), self.number()])

    def trigger(self):
        """A condition of a when clause."""
        random = self.random
        form = random.randrange(10)
        booleans = self.of_kind("Boolean")
        if form == 0 and booleans:
            return edge(random.choice(booleans))
        if form == 1 and self.discretes:
            one = random.choice([one for one in self.discretes if one.kind != "Real"] or [None])
            return change(one) if one else self.time_condition()
        if form == 2 and booleans:
            return logical("and", pre(random.choice(booleans)), self.time_condition())
        if form == 3:
            return self.model.sample(random.choice([self.zero, 0.1, -0.31]), round(random.uniform(0.15, 0.6), 3))
        return self.condition()

    def repeated_trigger(self):
        """A condition, now and then that of another when clause: both act at the same instants."""
        if not self.triggers or self.random.random() < 0.7:
            self.triggers.append(self.trigger())
            return self.triggers[-1]
        return self.random.choice(self.triggers)

    def make_sampler(self):
        """when time >= pre(next) then next = pre(next) + period; ..."""
        following = self.model.discrete(constant(self.random.choice([self.zero, 0.063, -0.3])))
        period = self.random.choice([0.111, 0.27, 0.452])
        value = self.model.discrete(self.number())
        step = following, arithmetic("+", pre(following), constant(period))
        self.model.when([([relation(">=", TIME, pre(following))], [step, (value, self.assigned(value))], [])])
        self.discretes.append(value)

    def make_when(self):
        random, model = self.random, self.model
        targets = []
        for _ in range(random.randint(1, 2)):
            starts = [self.number(), constant(random.randint(0, 2)), constant(random.random() < 0.5)]
            targets.append(model.discrete(random.choice(starts)))
        branches = []
        free = [state for state in self.states if state.text not in self.has_reinit]
        reset = random.choice(free) if free and random.random() < 0.3 else None
        for _ in range(random.choice([1, 1, 2, 3])):
            conditions = [self.trigger() if branches else self.repeated_trigger()]
            if random.random() < 0.2:
                conditions.append(self.trigger())
            if random.random() < 0.2 and not branches and reset is None:
                conditions.append(None)
            reinits = []
            if reset is not None:
                self.has_reinit.add(reset.text)
                reinits = [(reset, total([arithmetic("*", self.number(-0.8, 0.8), pre(reset)), self.number()]))]
            branches.append((conditions, [(target, self.assigned(target)) for target in targets], reinits))
        model.when(branches)
        self.discretes += targets

    def make_same_instant(self):
        """A when clause counts; another one holds an unknown of equations that contain the count."""
        model, trigger = self.model, self.trigger()
        count, held = model.discrete(constant(self.random.randint(0, 2))), model.discrete(self.number())
        model.when([([trigger], [(count, self.assigned(count))], [])])
        unknowns = model.coupled(arithmetic("*", self.number(), count), self.term(), 0.5, -0.3)
        new = arithmetic("*", self.number(), self.random.choice(unknowns))
        model.when([([trigger], [(held, total([arithmetic("*", constant(0.5), pre(held)), new]))], [])])
        self.discretes += [count, held]
        self.reals += unknowns

    def make_derivatives(self):
        for state in self.states:
            rate = arithmetic("*", self.number(-1.5, 0.2), state)
            terms = [self.term() for _ in range(self.random.randint(1, 2))]
            self.model.set_derivative(state, total([rate, *terms]))

    def make(self):
        self.make_parameters()
        self.make_states()
        if self.random.random() < 0.15:
            self.make_steady_state()
        makers = [self.make_algebraic] * self.random.randint(2, 5) + [self.make_when] * self.random.randint(1, 3)
        makers += [self.make_sampler] * self.random.choice([0, 0, 1])
        makers += [self.make_same_instant] * self.random.choice([0, 0, 0, 1])
        self.random.shuffle(makers)
        for make in makers:
            make()
        self.make_derivatives()
        return self.model


def test_random_hybrid_models():
    run_fuzzer(lambda random: Hybrid(random).make())
