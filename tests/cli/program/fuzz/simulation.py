"""A slow and simple simulation of a random model, to compare the program with.

Relations and rounding functions keep their values between events. After each step of the classical Runge-Kutta method
their values are computed anew; if one differs, bisection finds the event, and the event iteration of the Modelica
specification follows.
"""

import itertools

from expressions import CONTINUOUS, DISCRETE, Rejected
from models import DERIVATIVE

EVENT_WIDTH = 1e-13       # of the interval in which an event is found
EVENT_DISTANCE = 0.02     # events have to be as far from each other, unless they are at the same time
MAX_ITERATIONS = 30       # of an event iteration
PERTURBATION = 1e-5       # of start values
MAX_AMPLIFICATION = 20.0  # how much larger errors of start values may become


class Moment:
    """Values at a time, those before the event, and the decisions that hold until the next event."""

    def __init__(self):
        self.values, self.pre, self.reinits, self.trace, self.held = {}, {}, {}, [], None
        self.is_event = self.is_initial = self.is_sampling = False
        self.is_start_exact = True
        self.num_active = self.num_samples = 0  # when clauses, sample() that were true

    def decide(self, literal, margin, varies):
        """A relation or rounding function: its value now, or the one that is held."""
        if self.held is not None:
            self.position += 1
            return self.held[self.position - 1]
        is_doubtful = 0 < margin < 1e-9 if varies == DISCRETE else self.is_sampling and margin < 1e-6
        if self.is_initial and varies == CONTINUOUS:
            is_doubtful = 0 < margin < 1e-6 or (margin == 0 and not self.is_start_exact)
        if is_doubtful:
            raise Rejected("rounding errors decide")
        self.trace.append(literal)
        return literal


class Simulation:
    """Runs a model; afterwards `rows` are the values at the outputs, `events` (time, before, after)."""

    def __init__(self, model, outputs, perturbation=0.0):
        self.model, self.moment, self.rows, self.events, self.last_event = model, Moment(), [], [], None
        self.initialize(perturbation)
        times = [model.start + (model.stop - model.start) * k / outputs for k in range(outputs + 1)]
        for end in times:
            while self.moment.values["time"] < end:
                self.advance(end)
            self.rows.append(self.now())
        if self.last_event is not None and times[-1] - self.last_event < EVENT_DISTANCE:
            raise Rejected("an event at the end")

    def now(self):
        return dict(self.moment.values)

    def evaluate(self, held=None):
        """Runs the equations in causal order, with decisions that are held or new ones."""
        moment = self.moment
        moment.held, moment.position = held, 0
        if held is None:
            moment.trace = []
        for item in self.model.items:
            item.run(moment)
        for name, expression in self.model.derivatives.items():
            moment.values[DERIVATIVE.format(name)] = expression.value(moment)

    def remember(self):
        """pre := the values now."""
        self.moment.pre = self.now()

    def initialize(self, perturbation):
        model, moment = self.model, self.moment
        moment.values["time"] = model.start
        moment.is_start_exact = not model.conditions
        for name, expression in model.parameters:
            moment.values[name] = expression.value(moment)
        for name, sign in zip(model.states, itertools.cycle((1, -1, 1))):
            moment.values[name] = model.states[name].value(moment) + sign * perturbation
        for name, start in model.discretes.items():
            if start is not None:
                moment.values[name] = start.value(moment)
        for name, kind in model.types.items():
            moment.values.setdefault(name, False if kind == "Boolean" else 0)
        self.discretes = [*model.discretes, *(n for n, kind in model.types.items() if kind in ("Boolean", "Integer"))]
        self.remember()
        moment.is_initial = moment.is_event = True
        self.evaluate()
        moment.is_initial = False
        self.initial = self.now()
        self.initial.update({condition.text: condition.value(moment) for condition in model.conditions})
        moment.num_active = moment.num_samples = 0
        self.iterate()
        if moment.num_samples and moment.num_active > moment.num_samples:
            raise Rejected("the order of a sample and another when clause at the start")

    def iterate(self):
        """The event iteration."""
        moment = self.moment
        moment.is_event = True
        self.remember()
        for _ in range(MAX_ITERATIONS):
            moment.reinits = {}
            self.evaluate()
            changes = [name for name in self.discretes if moment.values.get(name) != moment.pre.get(name)]
            is_stable = not moment.reinits and not changes
            moment.values.update(moment.reinits)
            self.remember()
            if is_stable:
                moment.is_event = False
                self.held = moment.trace
                return
        raise Rejected("the event iteration does not end")

    def step(self, start, x, h):
        """One step of the classical Runge-Kutta method."""
        values = self.moment.values
        names = list(self.model.states)

        def rate(c, slopes):
            values["time"] = start + c
            values.update({name: x[name] + c * slopes[name] for name in names})
            self.evaluate(self.held)
            return {name: values[DERIVATIVE.format(name)] for name in names}

        k1 = rate(0.0, dict.fromkeys(names, 0.0))
        k2 = rate(h / 2, k1)
        k3 = rate(h / 2, k2)
        k4 = rate(h, k3)
        values["time"] = start + h
        for name in names:
            values[name] = x[name] + h / 6 * (k1[name] + 2 * k2[name] + 2 * k3[name] + k4[name])

    def decisions_after(self, start, x, h):
        self.step(start, x, h)
        self.evaluate()
        return self.moment.trace

    def advance(self, end):
        """A step to the end or less, or to an event."""
        values = self.moment.values
        start = values["time"]
        x = {name: values[name] for name in self.model.states}
        h = min(self.model.step, end - start)
        if self.decisions_after(start, x, h) != self.held:
            low = 0.0
            while h - low > EVENT_WIDTH:
                middle = (low + h) / 2
                if self.decisions_after(start, x, middle) != self.held:
                    h = middle
                else:
                    low = middle
            self.step(start, x, h)
            self.evaluate(self.held)
            self.happen()
        else:
            self.evaluate(self.held)
            if h == end - start:
                values["time"] = end

    def happen(self):
        """An event now."""
        time = self.moment.values["time"]
        since = self.model.start if self.last_event is None else self.last_event
        if time - since < EVENT_DISTANCE and not (self.last_event is None and time - since < 1e-12):
            raise Rejected("events too close to each other")
        self.last_event = time
        before = self.now()
        self.iterate()
        self.events.append((time, before, self.now()))


def simulate(model, outputs):
    """The simulation, if small errors of the start values stay small."""
    result = Simulation(model, outputs)
    if model.states:
        other = Simulation(model, outputs, PERTURBATION)
        if len(other.events) != len(result.events):
            raise Rejected("the number of events depends on small errors")
        for row, changed in zip(result.rows, other.rows):
            for name in model.states:
                is_near = any(abs(row["time"] - time) < 1e-3 for time, _, _ in result.events)
                if not is_near and abs(row[name] - changed[name]) > MAX_AMPLIFICATION * PERTURBATION:
                    raise Rejected("ill conditioned")
    return result
