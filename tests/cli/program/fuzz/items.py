"""Equations and when clauses, which a simulation runs in causal order."""

CONDITION = "#{}"  # names of conditions of when clauses and of counters of samples


class Assignment:
    """An equation that gives a variable."""

    def __init__(self, name, expression):
        self.name, self.expression = name, expression

    def run(self, moment):
        moment.values[self.name] = self.expression.value(moment)


class Calls:
    """An equation (a, b) = f(...)."""

    def __init__(self, names, call):
        self.names, self.call = names, call

    def run(self, moment):
        moment.values.update(zip(self.names, self.call(moment)))


class When:
    """A when clause. Branches are (conditions, assignments, reinits); None among the conditions is initial()."""

    def __init__(self, number, branches):
        self.branches = branches
        self.names = [[CONDITION.format(f"{number}.{j}.{k}") for k in range(len(branch[0]))]
                      for j, branch in enumerate(branches)]

    def run(self, moment):
        chosen = None
        for (conditions, assignments, reinits), names in zip(self.branches, self.names):
            is_active = False
            for condition, name in zip(conditions, names):
                if condition is None:
                    is_active = is_active or moment.is_initial
                    continue
                moment.values[name] = condition.value(moment)
                rises = moment.values[name] and not moment.pre.get(name, True)
                is_active = is_active or (rises and moment.is_event)
            if is_active and chosen is None:
                chosen = assignments, reinits
        if chosen:
            moment.num_active += 1
            moment.is_sampling = True
            for name, expression in chosen[0]:
                moment.values[name] = expression.value(moment)
            moment.reinits.update({name: expression.value(moment) for name, expression in chosen[1]})
            moment.is_sampling = False
