#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the public names of the module sfdae with those that users are promised: all of sfdae_types,
sfdae_expressions and sfdae_arrays, and the list below. Names of other modules of the library must not reach users.

    public_names_test.py <directory of .mod files>     of gfortran: gzip'ed text
    public_names_test.py --list <file.mod>             prints the public names of one module"""

import gzip
import pathlib
import re
import sys

OWN_NAMES = """
    dae_descriptor dae_ensemble dae_ensemble_monitor dae_ensemble_results dae_events dae_hybrid dae_linearization
    dae_monitor dae_options dae_sensitivities dae_solution dae_solver dae_switch dae_transition derivative_array_dae
    derivative_dae
    kinematic_multibody_dae linear_dae multibody_dae multibody_formulas nonlinear_dae recorded_linear_dae
    recorded_multibody_dae sfdae_check_linear sfdae_check_multibody sfdae_check_nonlinear
    sfdae_split_derivative_array sfdae_status_name sfdae_version sparsity_pattern
    """.split()


def lists_of(text):
    """Nested lists of the words in parentheses."""
    stack = [[]]
    for word in re.findall(r"[()]|'[^']*'|[^\s()']+", text):
        if word == "(":
            stack.append([])
        elif word == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(word.strip("'"))
    return stack[0]


def public_names(path):
    """Names that `use` makes known, operators and assignment by their number in the compiler's list."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        header, text = file.readline(), file.read()
    if not header.startswith("GFORTRAN module"):
        sys.exit(f"{path} is not a module file of gfortran")
    operators, _, generics, *_, names = lists_of(text)
    found = {f"operator {position} ({len(known)})" for position, known in enumerate(operators) if known}
    found |= {generic[0] for generic in generics} | set(names[::3])
    return {name.lower() for name in found if not name.startswith("__")}


def main():
    if sys.argv[1] == "--list":
        print("\n".join(sorted(public_names(sys.argv[2]))))
        return
    directory = pathlib.Path(sys.argv[1])
    found = public_names(directory / "sfdae.mod")
    passed_on = set()
    for name in "types", "expressions", "arrays":
        passed_on |= public_names(directory / f"sfdae_{name}.mod")
    promised = passed_on.union(OWN_NAMES)
    missing, surplus = promised - found, found - promised
    for text, names in ("missing", missing), ("not promised", surplus):
        if names:
            print(f"{text}: {' '.join(sorted(names))}")
    if missing or surplus:
        sys.exit(1)
    print(f"{len(found)} public names, as promised")


if __name__ == "__main__":
    main()
