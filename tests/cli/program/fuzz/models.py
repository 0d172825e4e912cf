"""A random model: its parts as text for the program, and as items that the simulation runs in causal order."""

from expressions import (CONTINUOUS, DISCRETE, TIMED, Expression, Rejected, choice, combined, constant,
                         distance_to_integer, logical, variable)
from items import CONDITION, Assignment, Calls, When

DERIVATIVE = "der({})"


class Model:
    """Collects a model. Methods return the variable that they declare."""

    def __init__(self, random, start, stop):
        self.random, self.start, self.stop = random, start, stop
        self.functions, self.declarations, self.conditions, self.equations, self.algorithms = [], [], [], [], []
        self.parameters, self.items, self.states, self.derivatives, self.discretes = [], [], {}, {}, {}
        self.types, self.count, self.settings = {}, 0, []
        self.method = random.choice(["automatic", "automatic", "bdf", "radau"])
        self.leniency = 1.0         # factor of the allowed error
        self.step = 0.01            # of the simulation
        self.demands_events = True  # no: functions may jump, which makes no events

    def new_name(self, letter, kind):
        self.count += 1
        self.types[f"{letter}{self.count}"] = kind
        return f"{letter}{self.count}"

    def parameter(self, expression, prefix="parameter"):
        name = self.new_name("p", expression.kind)
        self.declarations.append(f"{prefix} {expression.kind} '{name}' = {expression.text}")
        self.parameters.append((name, expression))
        return variable(expression.kind, name)

    def changed_parameter(self, number):
        """A parameter that --set gives this value."""
        name = self.new_name("p", "Real")
        self.declarations.append(f"parameter Real '{name}' = {number + 1.0!r}")
        self.parameters.append((name, constant(number)))
        self.settings.append(f"{name}={number!r}")
        return variable("Real", name)

    def array(self, numbers):
        """A constant array; returns its name."""
        name = self.new_name("c", "")
        texts = ", ".join(constant(number).text for number in numbers)
        self.declarations.append(f"constant Real '{name}'[{len(numbers)}] = {{{texts}}}")
        self.parameters.append((name, Expression("", "", lambda frame: numbers)))
        return name

    def free_parameter(self, number, guess):
        """A parameter that an initial equation has to determine as this number."""
        name = self.new_name("f", "Real")
        self.declarations.append(f"parameter Real '{name}'(fixed = false, start = {guess!r})")
        self.parameters.append((name, constant(number)))
        return variable("Real", name)

    def state(self, start, guess=None):
        """A state that starts with a value, or, if there is a guess, has to be determined as this value."""
        name = self.new_name("x", "Real")
        attributes = f"fixed = true, start = {start.text}" if guess is None else f"start = {guess!r}"
        self.declarations.append(f"Real '{name}'({attributes})")
        self.states[name] = start
        return variable("Real", name, CONTINUOUS)

    def set_derivative(self, state, expression):
        name = state.text.strip("'")
        self.derivatives[name] = expression
        self.add_equation(f"der('{name}')", expression.text)

    def add_equation(self, left, right, is_numeric=True):
        forms = [f"{left} = {right}", f"{left} = {right}", f"{right} = {left}"]
        if is_numeric:
            forms += [f"{left} - {right} = 0", f"2 * {left} = {right} + {left}"]
        self.equations.append(self.random.choice(forms))

    def algebraic(self, expression):
        """A variable with an equation, or with a binding."""
        name = self.new_name("y", expression.kind)
        left = f"'{name}'"
        self.items.append(Assignment(name, expression))
        attributes = ""
        if expression.kind != "Real":  # else pre(y) at the start would be anything
            start = constant(self.random.choice([False, True]) if expression.kind == "Boolean" else 0)
            attributes = f"(fixed = true, start = {start.text})"
            self.discretes[name] = start
        if self.random.random() < 0.3:
            self.declarations.append(f"{expression.kind} {left}{attributes} = {expression.text}")
        else:
            self.declarations.append(f"{expression.kind} {left}{attributes}")
            self.add_equation(left, expression.text, expression.kind == "Real")
        varies = expression.varies if expression.kind == "Real" else DISCRETE
        return variable(expression.kind, name, varies)

    def latch(self, turns_on, stays_on):
        """y = turns_on or (pre(y) and stays_on)."""
        name = self.new_name("y", "Boolean")
        start = constant(self.random.choice([False, True]))
        self.discretes[name] = start
        self.declarations.append(f"Boolean '{name}'(fixed = true, start = {start.text})")
        result = variable("Boolean", name)
        expression = logical("or", turns_on, logical("and", pre(result), stays_on))
        self.add_equation(f"'{name}'", expression.text, False)
        self.items.append(Assignment(name, expression))
        return result

    def if_equation(self, condition, a, b):
        """A variable given by an if-equation."""
        name = self.new_name("y", "Real")
        self.declarations.append(f"Real '{name}'")
        self.equations.append(f"if {condition.text} then\n      '{name}' = {a.text};\n    else\n"
                              f"      {b.text} = '{name}';\n    end if")
        self.items.append(Assignment(name, choice(condition, a, b)))
        return variable("Real", name, CONTINUOUS)

    def coupled(self, f, g, a, b):
        """y = f + a z and z = g + b y for numbers a and b."""
        y, z = self.new_name("y", "Real"), self.new_name("y", "Real")
        self.declarations += [f"Real '{y}'", f"Real '{z}'"]
        self.add_equation(f"'{y}'", f"({f.text} + {a!r} * '{z}')")
        self.add_equation(f"'{z}'", f"({g.text} + {b!r} * '{y}')")
        self.items.append(Assignment(y, combined("Real", "", lambda f, g: (f + a * g) / (1 - a * b), f, g)))
        self.items.append(Assignment(z, combined("Real", "", lambda y, g: g + b * y, variable("Real", y), g)))
        return [variable("Real", name, CONTINUOUS) for name in (y, z)]

    def algebraics(self, kinds, text, call, varies):
        """Variables given by a function with several outputs."""
        names = [self.new_name("y", kind) for kind in kinds]
        self.declarations += [f"{kind} '{name}'" for kind, name in zip(kinds, names)]
        self.equations.append("({}) = {}".format(", ".join(f"'{name}'" for name in names), text))
        self.items.append(Calls(names, call))
        return [variable(kind, name, varies if kind == "Real" else DISCRETE) for kind, name in zip(kinds, names)]

    def discrete(self, start):
        """A variable that when clauses assign."""
        name = self.new_name("d", start.kind)
        prefix = "discrete " if start.kind == "Real" else ""
        self.declarations.append(f"{prefix}{start.kind} '{name}'(fixed = true, start = {start.text})")
        self.discretes[name] = start
        return variable(start.kind, name)

    def when(self, branches):
        """Branches of (conditions, assignments, reinits)."""
        branches = [(conditions, [(left.text.strip("'"), right) for left, right in assignments],
                     [(left.text.strip("'"), right) for left, right in reinits])
                    for conditions, assignments, reinits in branches]
        lines, in_algorithm = [], self.random.random() < 0.2 and not any(branch[2] for branch in branches)
        for conditions, assignments, reinits in branches:
            texts = ["initial()" if condition is None else condition.text for condition in conditions]
            lines.append("{} {} then".format("elsewhen" if lines else "when",
                                             texts[0] if len(texts) == 1 else "{" + ", ".join(texts) + "}"))
            sign = ":=" if in_algorithm else "="
            lines += [f"  '{name}' {sign} {expression.text};" for name, expression in assignments]
            lines += [f"  reinit('{name}', {expression.text});" for name, expression in reinits]
        (self.algorithms if in_algorithm else self.equations).append("\n    ".join([*lines, "end when"]))
        self.count += 1
        clause = When(self.count, branches)
        for names, branch in zip(clause.names, branches):
            self.discretes.update((name, None) for name, condition in zip(names, branch[0]) if condition)
        self.items.append(clause)

    def sample(self, start, interval):
        """sample(start, interval): counts the instants that have passed."""
        self.count += 1
        counter = CONDITION.format(self.count)
        self.discretes[counter] = None

        def value(moment):
            number = (moment.values["time"] - start) / interval
            if moment.is_initial and 0 < distance_to_integer(number) < 1e-9:
                raise Rejected("rounding errors decide whether sample() is true at the start")
            before = int(number // 1)
            if moment.is_initial and number == before:
                before -= 1
            moment.values[counter] = moment.decide(max(before, -1), distance_to_integer(number), TIMED)
            is_due = moment.is_event and moment.values[counter] > moment.pre.get(counter, moment.values[counter])
            moment.num_samples += is_due
            return is_due

        return Expression("Boolean", f"sample({start!r}, {interval!r})", value, TIMED)

    def require_initially(self, expression):
        """An initial equation: this formula has the value that it has for the values wanted."""
        self.conditions.append(expression)

    def text(self, initial):
        """The model in Modelica; `initial` are the values after initialization."""
        equations = self.random.sample(self.equations, len(self.equations))
        declarations = self.random.sample(self.declarations, len(self.declarations))
        lines = ["//! base 0.1.0", "package 'M'", *self.functions, "  model 'M'"]
        lines += [f"    {line};" for line in declarations]
        if self.conditions:
            lines.append("  initial equation")
            lines += [f"    {condition.text} = {initial[condition.text]!r};" for condition in self.conditions]
        lines += ["  equation", *(f"    {line};" for line in equations)]
        for algorithm in self.algorithms:
            lines += ["  algorithm", f"    {algorithm};"]
        lines += ["  end 'M';", "end 'M';", ""]
        return "\n".join(lines)


def pre(name):
    """pre(name) of a variable."""
    key = name.text.strip("'")
    return Expression(name.kind, f"pre({name.text})", lambda moment: moment.pre[key])


def edge(name):
    key = name.text.strip("'")
    return Expression("Boolean", f"edge({name.text})", lambda moment: moment.values[key] and not moment.pre[key])


def change(name):
    key = name.text.strip("'")
    return Expression("Boolean", f"change({name.text})", lambda moment: moment.values[key] != moment.pre[key])


def derivative(state):
    name = state.text.strip("'")
    return variable("Real", DERIVATIVE.format(name), CONTINUOUS, f"der({state.text})")
