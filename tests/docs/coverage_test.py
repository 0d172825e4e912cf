#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Everything public is documented: coverage_test.py <source tree> [--site <html folder>].

Counts the functions that the library exports (cmake/sfdae.map) against the comments of the headers, and what the Fortran
modules and the Python package make public against their comments. The guide explains every status. With a site: every
function of C is on its pages."""

import argparse
import ast
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs" / "site"))
import fortran_reference  # noqa: E402


class Count:
    """How many things there are, and which of them are not documented."""

    def __init__(self, what, at_least):
        self.what, self.at_least, self.names, self.missing = what, at_least, [], []

    def add(self, name, is_documented):
        self.names.append(name)
        if not is_documented:
            self.missing.append(name)

    def complaints(self):
        print(f"{self.what}: {len(self.names) - len(self.missing)} of {len(self.names)}")
        if self.missing:
            yield f"{self.what}: not documented: {', '.join(self.missing)}"
        if len(self.names) < self.at_least:
            yield f"{self.what}: only {len(self.names)} were found: this test looks in the wrong place"


def headers(root):
    return "\n".join(path.read_text() for path in sorted((root / "include" / "sfdae").glob("*.h")))


def c_functions(text):
    """(name, whether a comment belongs to it) of the functions of the headers."""
    for match in re.finditer(r"^SFDAE_API [^;]*?\b(sfdae_\w+)\([^;]*;([^\n]*)", text, re.MULTILINE | re.DOTALL):
        above = text[:match.start()].rstrip("\n")
        comment = above[above.rfind("/*"):] if above.endswith("*/") and text[match.start() - 2] != "\n" else ""
        yield match[1], comment.startswith("/** ") or match[2].strip().startswith("/**< ")


def c_types(text):
    """(name, whether a comment belongs to it) of structs and of types of functions."""
    for match in re.finditer(r"^typedef (?:struct (\w+)|[^;{]*?\(\*(\w+)\))", text, re.MULTILINE):
        above = text[:match.start()]
        yield match[1] or match[2], above.endswith("*/\n") and above[above.rfind("/*"):].startswith("/** ")


def check_c(root):
    text = headers(root)
    functions, types = Count("functions of C", 80), Count("types of C", 25)
    for name, is_documented in c_functions(text):
        functions.add(name, is_documented)
    documented = {}  # a type may be declared again where a header needs it
    for name, is_documented in c_types(text):
        documented[name] = documented.get(name) or is_documented
    for name, is_documented in documented.items():
        types.add(name, is_documented)
    exported = re.findall(r"(\w+\*?)[_;]*;", (root / "cmake" / "sfdae.map").read_text())
    fortran_77 = Count("routines of Fortran 77", 10)
    manual = (root / "docs" / "moving_from_gelda.md").read_text()
    manual += (root / "docs" / "guide" / "moving.md").read_text()
    for name in sorted({re.sub(r"(_64)?_*$", "", name) for name in exported if not name.endswith("*")}):
        fortran_77.add(name, re.search(rf"\b{name.upper()}\b", manual))
    return [*functions.complaints(), *types.complaints(), *fortran_77.complaints()]


def check_helpers(root):
    """The argument lists of DGELDA's helpers in its manual are those of the entries."""
    manual = (root / "docs" / "moving_from_gelda.md").read_text()
    shown = {match[1]: re.findall(r"\w+", match[2]) for match in
             re.finditer(r"^      (?:SUBROUTINE|DOUBLE PRECISION FUNCTION) (\w+) \((.*?)\)", manual, re.DOTALL | re.MULTILINE)}
    entries = (root / "tests" / "f77" / "entries.h").read_text()
    count = Count("argument lists of Fortran 77", 10)
    for name, arguments in re.findall(r"using (\w+) = (?:void|double)\((.*?)\) noexcept;", entries, re.DOTALL):
        names = [argument.split()[-1].lstrip("*").upper() for argument in arguments.split(",")]
        count.add(name.upper(), shown.get(name.upper()) == names)
    return list(count.complaints())


def check_cpp(root):
    """Public functions of classes and of the namespace: those with a name that are not `detail`."""
    count = Count("public functions of the class Solver of C++", 30)
    text = (root / "include" / "sfdae" / "sfdae.hpp").read_text()
    body = re.search(r"^class Solver \{\n public:\n(.*?)^ private:", text, re.DOTALL | re.MULTILINE)[1]
    for match in re.finditer(r"^  (?=\S)(?!return|template|if|//|\})[\w:<>&* ,]*?\b(\w+)\([^;{]*(?:;|\{|$)", body, re.MULTILINE):
        above = body[:match.start()].rstrip("\n").rsplit("\n", 1)[-1]
        overload = match[1] in count.names or " = default" in match[0] or " = delete" in match[0]
        count.add(match[1], above.strip().startswith(("///", "template")) or overload or match[1].startswith("~"))
    return list(count.complaints())


def check_fortran(root):
    count = Count("public names of Fortran", 40)
    bindings = Count("procedures of the solver in Fortran", 35)
    for module in fortran_reference.modules(root):
        text = (root / "fortran_bindings" / f"{module}.f90").read_text()
        found = fortran_reference.entities(text)
        for name in fortran_reference.public_names(text):
            if name.lower() in found and not name.endswith(("_holder", "_callback", "_in_c")):
                count.add(name, found[name.lower()].comment)
        if module == "sfdae_solver":
            for binding, target in re.findall(r"procedure :: (\w+) => (solver_\w+)", text):
                bindings.add(binding, target in found and found[target].comment)
    return [*count.complaints(), *bindings.complaints()]


# Functions of C that are something else in Fortran: operators and assignments, or part of another procedure.
IN_FORTRAN = {
    "number": "assignment(=)", "parameter": "named_parameter", "add": "operator(+)", "subtract": "operator(-)",
    "negate": "operator(-)", "multiply": "operator(*)", "divide": "operator(/)", "power": "operator(**)",
    "create_linear": "create", "create_nonlinear": "create", "create_multibody": "create",
    "get_derivative_array_at": "get_derivative_array", "get_projectors_at": "get_projectors",
    "get_strangeness_free_at": "get_strangeness_free", "get_checkpoint_length": "save_checkpoint",
    "less": "operator(<)", "less_equal": "operator(<=)", "greater": "operator(>)", "greater_equal": "operator(>=)",
    "and": "operator(.and.)", "or": "operator(.or.)", "not": "operator(.not.)", "external": "external_value",
    "create_solution": "create", "destroy_solution": "destroy", "record_solution": "record",
    "evaluate_solution": "evaluate", "get_solution_range": "get_range", "get_solution_length": "save",
    "get_solution_accuracy": "get_accuracy", "cut_solution": "cut",
    "save_solution": "save", "load_solution": "load",
    "create_hybrid": "create", "destroy_hybrid": "destroy", "get_hybrid_message": "message", "start_hybrid": "start",
    "advance_hybrid": "advance", "record_hybrid": "record", "request_stop_hybrid": "request_stop",
    "get_hybrid_statistics": "get_statistics", "report_hybrid": "report",
    "get_hybrid_checkpoint_length": "save_checkpoint", "save_hybrid_checkpoint": "save_checkpoint",
    "restore_hybrid_checkpoint": "restore_checkpoint", "set_hybrid_sensitivities": "set_sensitivities",
    "get_hybrid_sensitivities": "get_sensitivities", "get_hybrid_gradient": "get_gradient",
    "create_descriptor": "create", "destroy_descriptor": "destroy", "descriptor_message": "message",
    "get_descriptor_sizes": "get_sizes", "get_descriptor_matrices": "get_matrices",
}


def check_functions_in_fortran(root):
    """Every function of C has its counterpart in the modules, with a comment. Structs need no init there."""
    documented = set()
    for module in fortran_reference.modules(root):
        text = (root / "fortran_bindings" / f"{module}.f90").read_text()
        documented |= set(re.findall(r"!>[^\n]*\n  interface ((?:operator|assignment)\([^)]*\))", text))
        found = fortran_reference.entities(text)
        documented |= {name for name, entity in found.items() if entity.comment}
        for binding, target in re.findall(r"procedure :: (\w+) => (\w+)", text):
            if target in found and found[target].comment:
                documented.add(binding)
    count = Count("functions of C in Fortran", 60)
    for function, _ in c_functions(headers(root)):
        name = function.removeprefix("sfdae_")
        if not name.endswith("_init"):
            count.add(function, {name, function, IN_FORTRAN.get(name)} & documented)
    return list(count.complaints())


def check_python(root):
    """Classes and functions that __init__ takes from the modules, and their public members."""
    package = root / "python" / "sfdae"
    wanted = {alias.name for node in ast.walk(ast.parse((package / "__init__.py").read_text()))
              if isinstance(node, ast.ImportFrom) for alias in node.names}
    count = Count("public classes, functions and methods of Python", 60)
    for path in sorted(package.glob("*.py")):
        for node in ast.parse(path.read_text()).body:
            if not isinstance(node, (ast.ClassDef, ast.FunctionDef)) or node.name not in wanted:
                continue
            count.add(node.name, ast.get_docstring(node))
            for member in node.body if isinstance(node, ast.ClassDef) else []:
                if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                    count.add(f"{node.name}.{member.name}", ast.get_docstring(member) or node.name == "Expression")
    return list(count.complaints())


def statuses(root):
    """Names and numbers of the statuses of the header: constants that sfdae_status_name knows."""
    text = (root / "include" / "sfdae" / "sfdae.h").read_text()
    section = text[text.index("---- Status ----"):text.index("sfdae_status_name")]
    return {name: int(number.strip("()")) for name, number in
            re.findall(r"^#define (SFDAE_\w+) (\(?-?\d+\)?)", section, re.MULTILINE)}


def check_statuses(root):
    """The page about statuses has a section for each, with its number, and none for others."""
    page = (root / "docs" / "guide" / "status.md").read_text()
    sections = dict(re.findall(r"^### (SFDAE_\w+) \((-?\d+)\)$", page, re.MULTILINE))
    count = Count("statuses in the guide", 30)
    for name, number in statuses(root).items():
        count.add(name, sections.pop(name, None) == str(number))
    yield from count.complaints()
    if sections:
        yield f"the guide explains what is no status, or with another number: {', '.join(sections)}"


def check_site(root, site):
    anchors = set()
    for path in (site / "reference").glob("c_*.html"):
        anchors |= set(re.findall(r'id="c\.(\w+)"', path.read_text()))
    count = Count("functions of C on the site", 80)
    for name, _ in c_functions(headers(root)):
        count.add(name, name in anchors)
    yield from count.complaints()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--site", type=pathlib.Path)
    options = parser.parse_args()
    if options.site:
        complaints = list(check_site(options.root, options.site))
    else:
        complaints = [complaint for check in (check_c, check_helpers, check_cpp, check_fortran, check_functions_in_fortran, check_python, check_statuses)
                      for complaint in check(options.root)]
    sys.exit("\n".join(complaints) or None)


if __name__ == "__main__":
    main()
