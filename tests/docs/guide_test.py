#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the programs of the guide and compares what they print with what the guide shows.

    guide_test.py --settings settings.json page.md ...            compares
    guide_test.py --settings settings.json --update page.md ...   writes what they print into the pages

A program is a block of code below a line <!-- program: name.ext -->, ext being py, c, cpp, f90 or m (Octave); what it prints is a
block below <!-- output: name.ext ... -->, one for all programs that are named. A line ... there stands for any number of lines. <!-- fails: name.ext --> says
that the program ends with a status other than 0. A file that programs read is below <!-- file: name.ext -->. <!-- needs: name.py
module ... --> before a program names modules of Python; the program is not run where one of them is missing.

Words have to agree exactly, numbers with a point or an exponent to two units of the last digit shown, but not closer than
1e-4 of themselves, whole numbers above 30 to 10 %. Lines about the course of an integration have to agree to 30 % or to 3. Numbers below 1e-9 are rounding errors as
long as they stay below it, numbers above 1e9 the inverse of rounding errors."""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MARK = re.compile(r"^<!-- (program|output|fails|file|needs): (\S+(?: \S+)*) -->\n(?:```(\w*)\n(.*?)^```\n)?", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"[-+]?\d+\.\d*(?:[eE][-+]?\d+)?|[-+]?\d+[eE][-+]?\d+|[-+]?\d+")
COURSE = re.compile(r"\bsteps\b|factorizations|last step|partition number|steps attempted")
ROUNDING = 1e-9


def unit_of_last_digit(text):
    """Of a number as it is printed."""
    mantissa, _, exponent = text.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals)


def numbers_agree(shown, printed):
    a, b = float(shown), float(printed)
    if shown == printed:
        return True
    if re.fullmatch(r"[-+]?\d+", shown) and re.fullmatch(r"[-+]?\d+", printed):
        return abs(a) > 30 and abs(a - b) <= 0.1 * abs(a)
    if max(abs(a), abs(b)) < ROUNDING or min(abs(a), abs(b)) > 1 / ROUNDING:
        return True
    return abs(a - b) <= max(2.001 * min(unit_of_last_digit(shown), unit_of_last_digit(printed)), 1e-4 * abs(a))


def counts_agree(shown, printed):
    """Numbers of steps and the like, which rounding errors may change."""
    return numbers_agree(shown, printed) or abs(float(shown) - float(printed)) <= max(3, 0.3 * abs(float(shown)))


def lines_agree(shown, printed):
    """Whether two lines agree in their words and in their numbers."""
    if " ".join(NUMBER.sub("0", shown).split()) != " ".join(NUMBER.sub("0", printed).split()):
        return False
    agree = counts_agree if COURSE.search(shown) else numbers_agree
    return all(map(agree, NUMBER.findall(shown), NUMBER.findall(printed)))


def first_difference(shown, printed):
    """None if the lines agree, else what differs."""
    if not shown:
        return f"not shown: {printed[0]!r}" if printed else None
    if shown[0].strip() == "...":
        for skipped in range(len(printed) + 1):
            if first_difference(shown[1:], printed[skipped:]) is None:
                return None
        return f"nothing printed fits what follows ...: {shown[1:2]}"
    if not printed:
        return f"not printed: {shown[0]!r}"
    if not lines_agree(shown[0], printed[0]):
        return f"\n  shown:   {shown[0]}\n  printed: {printed[0]}"
    return first_difference(shown[1:], printed[1:])


class Runner:
    """Compiles and runs programs."""

    def __init__(self, settings, folder):
        self.settings, self.folder = settings, folder

    def can_run(self, name, modules=()):
        command = self.settings.get(pathlib.Path(name).suffix.lstrip("."))
        if not command or not modules:
            return bool(command)
        finds = f"import importlib.util as u, sys; sys.exit(any(u.find_spec(m) is None for m in {list(modules)!r}))"
        return subprocess.run([*command, "-c", finds]).returncode == 0

    def run(self, name):
        """(status, output). What goes to stderr belongs to the output."""
        path = self.folder / name
        command = list(self.settings[path.suffix.lstrip(".")])
        if path.suffix in (".py", ".m"):
            command.append(str(path))
        else:
            program = self.folder / path.stem
            position = command.index("SOURCE")
            compiled = subprocess.run([*command[:position], str(path), *command[position + 1:], "-o", str(program)],
                                      cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            if compiled.returncode:
                sys.exit(f"{name} does not compile:\n{compiled.stdout}")
            command = [str(program)]
        environment = dict(os.environ, **self.settings.get("environment", {}))
        result = subprocess.run(command, cwd=self.folder, env=environment, timeout=300, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True)
        return result.returncode, result.stdout.replace(str(self.folder) + "/", "")


def printed_lines(output):
    return [line.rstrip() for line in output.rstrip("\n").split("\n")]


def check_page(page, runner, update):
    """Complaints about a page. With update the page is written anew."""
    text = page.read_text()
    complaints, outputs, skipped = [], {}, []
    fails = {match[2] for match in MARK.finditer(text) if match[1] == "fails"}
    needs = {name: modules for match in MARK.finditer(text) if match[1] == "needs"
             for name, *modules in [match[2].split()]}
    for match in MARK.finditer(text):
        if match[1] in ("program", "file"):
            (runner.folder / match[2]).write_text(match[4])
        if match[1] != "program":
            continue
        if not runner.can_run(match[2], needs.get(match[2], ())):
            skipped.append(match[2])
            continue
        status, outputs[match[2]] = runner.run(match[2])
        if (status != 0) != (match[2] in fails):
            complaints.append(f"{page.name}: {match[2]} ended with status {status}:\n{outputs[match[2]]}")

    def compare(match):
        if match[1] != "output":
            return match[0]
        shown = printed_lines(match[4])
        for name in match[2].split():
            printed = printed_lines(outputs[name]) if name in outputs else shown
            difference = first_difference(shown, printed)
            if difference is None:
                continue
            if update and "..." not in (line.strip() for line in shown):
                return f"<!-- output: {match[2]} -->\n```{match[3]}\n" + "\n".join(printed) + "\n```\n"
            complaints.append(f"{page.name}: {name}: {difference}\nIt printed:\n" + "\n".join(printed))
        return match[0]

    changed = MARK.sub(compare, text)
    if update and changed != text:
        page.write_text(changed)
    shown = {name for match in MARK.finditer(text) if match[1] == "output" for name in match[2].split()}
    complaints += [f"{page.name}: {name} is shown, but there is no such program"
                   for name in sorted(shown - outputs.keys() - set(skipped))]
    print(f"{page.name}: {len(outputs)} programs ran" + (f", not built: {', '.join(skipped)}" if skipped else ""))
    return complaints


def test_comparisons():
    """The rules of comparison are what the text above says."""
    assert numbers_agree("1.234", "1.236") and not numbers_agree("1.234", "1.237")
    assert numbers_agree("1.2e-16", "3.3e-14") and not numbers_agree("1.2e-16", "1e-8")
    assert numbers_agree("0.999997180948", "0.999997181") and numbers_agree("7e+13", "3.1e12")
    assert numbers_agree("137", "141") and not numbers_agree("2", "3") and not numbers_agree("137", "160")
    assert lines_agree("714 steps, 1 failed", "690 steps, 3 failed") and not lines_agree("index 1", "index 3")
    assert lines_agree("t = 1.0  x", "t =  1.0 x") and not lines_agree("level 1 clear", "level 1 unclear")
    assert first_difference(["a", "...", "b"], ["a", "x", "y", "b"]) is None
    assert first_difference(["a", "...", "b"], ["a", "x", "y"]) is not None
    assert first_difference(["a"], ["a", "b"]) is not None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--settings", type=pathlib.Path, required=True)
    parser.add_argument("--update", action="store_true")
    parser.add_argument("pages", type=pathlib.Path, nargs="+")
    options = parser.parse_args()
    test_comparisons()
    complaints = []
    for page in options.pages:
        with tempfile.TemporaryDirectory() as folder:
            runner = Runner(json.loads(options.settings.read_text()), pathlib.Path(folder))
            complaints += check_page(page, runner, options.update)
    if complaints:
        sys.exit("\n".join(complaints) + "\n\nIf what is printed is right, --update writes it into the pages.")


if __name__ == "__main__":
    main()
