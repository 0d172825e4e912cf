#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the C source of the module sfdae._binding from the headers of sfdae.

    build_binding.py --compiler cc --include <dir> [--include <dir> ...] --output binding.c

The headers are preprocessed by the C compiler and read by cffi: structs, functions and constants
are those of C, nothing is repeated here. For every callback, a member of a struct or an argument of
a function, a C function is added that calls Python: python_<struct>_<member>, python_<type>."""

import argparse
import pathlib
import re
import subprocess

import cffi

PREAMBLE = "#include <sfdae/sfdae.h>\n#include <sfdae/modes.h>\n#include <sfdae/hybrid.h>\n#include <sfdae/branches.h>\n"

# What is done in C because it is done at every step or output: see binding_support.c.
SUPPORT = pathlib.Path(__file__).resolve().parent / "binding_support.c"
SUPPORT_DECLARATIONS = """
typedef struct python_recorder {
  double* steps;
  size_t count, capacity;
  int records, calls_python;
  double next_call;
  void* user;
} python_recorder;
int python_record_step(const sfdae_progress* progress, void* recorder);
void python_free_steps(python_recorder* recorder);
typedef struct python_limit {
  sfdae_options* options;
  long attempts;
  long each;
  double direction;
  double end;
} python_limit;
double python_seconds(void);
int python_advance(sfdae_solver* solver, const python_limit* limit, int one_step, double tout,
                   double* t, double* x, double* xdot);
int python_advance_through(sfdae_solver* solver, const python_limit* limit, const double* times,
                           long count, long* done, double* t, double* x, double* xdot, size_t n);
int python_evaluate_solution(const sfdae_solution* solution, const double* times, long count,
                             double* x, double* xdot, size_t n);
"""


def preprocess(compiler: list[str], includes: list[str]) -> str:
    """The declarations of the headers of sfdae, without those of the system, and their integer
    constants.
    """
    command = [
        *compiler,
        "-E",
        "-dD",
        "-x",
        "c",
        *(f"-I{directory}" for directory in includes),
        "-",
    ]
    text = subprocess.run(
        command, input=PREAMBLE, capture_output=True, text=True, check=True
    ).stdout
    lines = []
    is_ours = False
    for line in text.splitlines():
        marker = re.match(r'#(?:line)? \d+ "(.*?)"', line)
        if marker:
            is_ours = pathlib.PurePath(marker[1]).parent.name == "sfdae"
        elif is_ours and line.startswith("#"):
            constant = re.fullmatch(r"#define (SFDAE_\w+) \(?-?\d+\)?", line)
            if constant:
                lines.append(f"#define {constant[1]} ...")
        elif is_ours:
            lines.append(line)
    return re.sub(r"__attribute__\s*\(\(.*?\)\)\s*\)?", "", "\n".join(lines))


def declaration(ffi: cffi.FFI, name: str, function: object) -> str:
    """Of a C function that calls the Python function `name`."""
    arguments = ", ".join(ffi.getctype(argument) for argument in function.args)
    return f'extern "Python" {ffi.getctype(function.result)} {name}({arguments});'


def callbacks(text: str) -> str:
    """One declaration for every member of a struct and every argument that is a function."""
    ffi = cffi.FFI()
    ffi.cdef(re.sub(r"#define (\w+) \.\.\.", "", text))
    result = []
    for struct in sorted(re.findall(r"^\} (sfdae_\w+);", text, re.MULTILINE)):
        for member, field in ffi.typeof(struct).fields or []:
            if field.type.kind == "function":  # so cffi calls pointers to functions
                result.append(
                    declaration(ffi, f"python_{struct.removeprefix('sfdae_')}_{member}", field.type)
                )
    in_structs = set(re.findall(r"^\s+(sfdae_\w+_function) \w+;", text, re.MULTILINE))
    in_arguments = set(re.findall(r"\b(sfdae_\w+_function) \w+[,)]", text))
    for name in re.findall(r"\(\*(sfdae_\w+_function)\)", text):
        if name not in in_structs or name in in_arguments:
            result.append(
                declaration(ffi, f"python_{name.removeprefix('sfdae_')}", ffi.typeof(name))
            )
    return "\n".join(result)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--compiler", required=True, nargs="+")
    parser.add_argument("--include", required=True, action="append")
    parser.add_argument("--output", required=True)
    arguments = parser.parse_args()

    text = preprocess(arguments.compiler, arguments.include)
    ffi = cffi.FFI()
    ffi.cdef(text)
    ffi.cdef(callbacks(text))
    ffi.cdef(SUPPORT_DECLARATIONS)
    ffi.set_source("sfdae._binding", PREAMBLE + SUPPORT.read_text())
    ffi.emit_c_code(arguments.output)


if __name__ == "__main__":
    main()
