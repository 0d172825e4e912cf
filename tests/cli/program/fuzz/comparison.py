"""Runs random models through the program and through the simulation, and compares.

Environment: SFDAE_PROGRAM is the program; SFDAE_FUZZ_SEED=N tries only the model with that seed and prints it;
SFDAE_FUZZ_COUNT=N tries the seeds 0 ... N - 1; SFDAE_TEST_SCALE multiplies that number.
"""

import json
import os
import random
import subprocess
import tempfile

from expressions import Rejected
from simulation import simulate

PROGRAM = os.environ["SFDAE_PROGRAM"]
TOLERANCE = 1e-8
ALLOWED = 100 * TOLERANCE  # relative to the largest value of a variable, or to 1
OUTPUTS = 40
SAME_TIME = 1e-9           # outputs
NEAR_EVENT = 1e-5          # where values at outputs are not compared
EVENT_TIME = 1e-6          # times of events, which follow from states with errors


class Wrong(Exception):
    """A difference between program and simulation."""


class Refused(Exception):
    """The program ended with an error."""


def generate(make, seed):
    """The first suitable model of a seed, its simulation and its text."""
    for attempt in range(200):
        generator = random.Random(f"{seed}.{attempt}")
        model = make(generator)
        try:
            reference = simulate(model, OUTPUTS)
        except (Rejected, OverflowError, ZeroDivisionError):
            continue
        return model, reference, model.text(reference.initial)
    raise AssertionError(f"seed {seed}: no suitable model")


def arguments(model):
    settings = [word for setting in model.settings for word in ("--set", setting)]
    return ["--from", repr(model.start), "--to", repr(model.stop), "--tol", repr(TOLERANCE), "--outputs", str(OUTPUTS),
            "--method", model.method, *settings]


def solve(text, model):
    """Times, and values by name, of variables and of parameters."""
    with tempfile.NamedTemporaryFile("w", suffix=".mo") as file:
        file.write(text)
        file.flush()
        result = subprocess.run(
            [PROGRAM, "solve", file.name, *arguments(model), "--variables", ".*", "--json", "-"],
            capture_output=True, text=True, timeout=300)
    if result.returncode != 0:
        raise Refused(f"exit code {result.returncode}: {result.stderr.replace(file.name, 'model.mo')}")
    data = json.loads(result.stdout)
    values = {parameter["name"]: [parameter["value"]] * len(data["time"]) for parameter in data["parameters"]}
    values.update({one["name"]: one["values"] for one in data["variables"]})
    return data["time"], values


def check(expected, found, k, model, scale, what):
    """Compares all variables in row k."""
    for name, kind in model.types.items():
        if not kind:
            continue
        if name not in found:
            raise Wrong(f"{name} is not among the results")
        value = found[name][k]
        error = abs(value - expected[name]) if value is not None else float("inf")
        if not error <= (model.leniency * ALLOWED * scale[name] if kind == "Real" else 0.0):
            raise Wrong(f"{what}: {name} is {value!r}, expected {expected[name]!r}")


def compare(model, reference, times, found):
    """At the outputs, and before and after each event at which something jumps."""
    names = [name for name, kind in model.types.items() if kind]
    scale = {name: max(1.0, max(abs(row[name]) for row in reference.rows)) for name in names}
    events, missing = reference.events, []
    for row in reference.rows:
        if any(abs(row["time"] - time) < NEAR_EVENT for time, _, _ in events):
            continue
        rows = [k for k, time in enumerate(times) if abs(time - row["time"]) < SAME_TIME]
        if not rows:
            missing.append(row["time"])
            continue
        check(row, found, rows[-1], model, scale, f"t = {row['time']}")
    for time, before, after in events if model.demands_events else []:
        if time - model.start < SAME_TIME or all(abs(after[name] - before[name]) < NEAR_EVENT for name in names):
            continue
        rows = [k for k, t in enumerate(times) if abs(t - time) < EVENT_TIME]
        if len(rows) < 2:
            raise Wrong(f"no event at t = {time}")
        check(before, found, rows[0], model, scale, f"before the event at t = {time}")
        check(after, found, rows[-1], model, scale, f"after the event at t = {time}")
    if missing:
        raise Wrong(f"no output at t = {missing}")


def try_seed(make, seed):
    """Nothing, or a text that says what is wrong, and whether the program refused the model."""
    model, reference, text = generate(make, seed)
    try:
        compare(model, reference, *solve(text, model))
    except (Wrong, Refused) as error:
        run = " ".join(["sfdae solve model.mo", *arguments(model)])
        return f"seed {seed}: {error}\n{run}\n{text}", isinstance(error, Refused)
    return None, False


def run_fuzzer(make):
    """Tries all seeds; at most one in a hundred may be refused with an error, none may be wrong."""
    if "SFDAE_FUZZ_SEED" in os.environ:
        seeds = [int(os.environ["SFDAE_FUZZ_SEED"])]
        print(generate(make, seeds[0])[2])
    else:
        scale = min(1.0, float(os.environ.get("SFDAE_TEST_SCALE", "1")))
        seeds = range(max(5, int(int(os.environ.get("SFDAE_FUZZ_COUNT", "20")) * scale)))
    wrong, refused = [], []
    for seed in seeds:
        message, is_refused = try_seed(make, seed)
        if message:
            print(message)
            (refused if is_refused else wrong).append(seed)
    print(f"{len(seeds)} models, wrong: {wrong}, refused: {refused}")
    assert not wrong
    assert len(refused) <= 0.01 * len(seeds)
