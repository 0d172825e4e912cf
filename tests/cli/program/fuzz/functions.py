"""Random functions: statements have their text in Modelica and run in Python on the variables of a call."""

from expressions import Expression


class Break(Exception):
    """Ends a loop."""


class Return(Exception):
    """Ends a function."""


class Frame:
    """The variables of a call."""

    def __init__(self, caller, varies):
        self.values, self.caller, self.varies = {}, caller, varies

    def decide(self, literal, margin, _):
        return self.caller.decide(literal, margin, self.varies)


def indented(statements):
    return ["  " + line for statement in statements for line in statement.lines()]


def run_all(statements, frame):
    for statement in statements:
        statement.run(frame)


class Assign:
    """name := expression, or name[subscript] := expression."""

    def __init__(self, name, expression, subscript=None):
        self.name, self.expression, self.subscript = name, expression, subscript

    def lines(self):
        subscript = f"[{self.subscript.text}]" if self.subscript else ""
        return [f"'{self.name}'{subscript} := {self.expression.text};"]

    def run(self, frame):
        value = self.expression.value(frame)
        if self.subscript:
            frame.values[self.name][self.subscript.value(frame) - 1] = value
        else:
            frame.values[self.name] = value


class AssignOutputs:
    """(a, b) := f(...)."""

    def __init__(self, names, function, arguments):
        self.names, self.function, self.arguments = names, function, arguments

    def lines(self):
        names = ", ".join(f"'{name}'" if name else "" for name in self.names)
        return [f"({names}) := {call_text(self.function, self.arguments)};"]

    def run(self, frame):
        outputs = outputs_of(self.function, self.arguments)(frame)
        frame.values.update({name: value for name, value in zip(self.names, outputs) if name})


class If:
    """Branches of (condition, statements), the last one without a condition or not."""

    def __init__(self, branches):
        self.branches = branches

    def lines(self):
        result = []
        for condition, body in self.branches:
            word = "elseif" if result else "if"
            result += [f"{word} {condition.text} then" if condition else "else", *indented(body)]
        return [*result, "end if;"]

    def run(self, frame):
        for condition, body in self.branches:
            if condition is None or condition.value(frame):
                run_all(body, frame)
                return


class For:
    """for name in first:step:last loop."""

    def __init__(self, name, first, step, last, body):
        self.name, self.first, self.step, self.last, self.body = name, first, step, last, body

    def lines(self):
        numbers = [self.first.text, *([str(self.step)] if self.step != 1 else []), self.last.text]
        return [f"for '{self.name}' in {':'.join(numbers)} loop", *indented(self.body), "end for;"]

    def run(self, frame):
        end = self.last.value(frame) + (1 if self.step > 0 else -1)
        try:
            for k in range(self.first.value(frame), end, self.step):
                frame.values[self.name] = k
                run_all(self.body, frame)
        except Break:
            pass


class While:
    """while condition loop."""

    def __init__(self, condition, body):
        self.condition, self.body = condition, body

    def lines(self):
        return [f"while {self.condition.text} loop", *indented(self.body), "end while;"]

    def run(self, frame):
        try:
            while self.condition.value(frame):
                run_all(self.body, frame)
        except Break:
            pass


class Leave:
    """break or return."""

    def __init__(self, word):
        self.word = word

    def lines(self):
        return [self.word + ";"]

    def run(self, frame):
        raise Break() if self.word == "break" else Return()


class Function:
    """Inputs, outputs and locals are (kind, name, size, binding); size None means a scalar, binding may be None."""

    def __init__(self, name, inputs, outputs, others, body):
        self.name, self.inputs, self.outputs, self.others, self.body = name, inputs, outputs, others, body

    def text(self):
        lines = [f"function '{self.name}'"]
        for word, variables in (("input ", self.inputs), ("output ", self.outputs), ("", self.others)):
            for kind, name, size, binding in variables:
                sizes = f"[{size}]" if size else ""
                lines.append(f"  {word}{kind} '{name}'{sizes}" + (f" = {binding.text};" if binding else ";"))
        return "\n".join("  " + line for line in [*lines, "algorithm", *indented(self.body), f"end '{self.name}';"])

    def run(self, caller, arguments, varies):
        frame = Frame(caller, varies)
        for (_, name, _, _), value in zip(self.inputs, arguments):
            frame.values[name] = list(value) if isinstance(value, list) else value
        for _, name, size, binding in [*self.outputs, *self.others]:
            frame.values[name] = binding.value(frame) if binding else [0.0] * size if size else None
        try:
            run_all(self.body, frame)
        except Return:
            pass
        return [frame.values[name] for _, name, _, _ in self.outputs]


def call_text(function, arguments):
    return f"'{function.name}'({', '.join(argument.text for argument in arguments)})"


def varies_of(arguments):
    return max((argument.varies for argument in arguments), default=0)


def outputs_of(function, arguments):
    """A Python function of a frame that computes all outputs."""
    return lambda frame: function.run(frame, [argument.value(frame) for argument in arguments],
                                      max(getattr(frame, "varies", 0), varies_of(arguments)))


def call(function, arguments):
    """The first output."""
    outputs = outputs_of(function, arguments)
    return Expression(function.outputs[0][0], call_text(function, arguments), lambda frame: outputs(frame)[0],
                      varies_of(arguments))


def vector(elements):
    """{a, b, c}."""
    return Expression("Vector", "{" + ", ".join(one.text for one in elements) + "}",
                      lambda frame: [float(one.value(frame)) for one in elements], varies_of(elements))
