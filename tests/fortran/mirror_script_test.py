#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The script that writes the Fortran mirror: what changes its result, what does not, what it refuses."""

import importlib.util
import pathlib
import re
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # the source tree stays as it is
ROOT = pathlib.Path(__file__).resolve().parents[2]
spec = importlib.util.spec_from_file_location("mirror", ROOT / "scripts" / "generate_fortran_mirror.py")
mirror = importlib.util.module_from_spec(spec)
spec.loader.exec_module(mirror)

HEADERS = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "include" / "sfdae").glob("*.h")}


def mirror_of(headers):
    with tempfile.TemporaryDirectory() as directory:
        for name, text in headers.items():
            (pathlib.Path(directory) / name).write_text(text, encoding="utf-8")
        return mirror.mirror_of(pathlib.Path(directory))


def with_lines(*lines):
    """The headers and one more."""
    return {**HEADERS, "zz.h": "\n".join(["#ifndef SFDAE_ZZ_H", "#define SFDAE_ZZ_H", *lines, "#endif", ""])}


class Result(unittest.TestCase):
    def test_does_not_depend_on_comments_and_layout(self):
        squeezed = {}
        for name, text in HEADERS.items():
            text = mirror.without_comments(text).replace("\v", " ")
            lines = [re.sub(r"\s+", "  ", line) for line in text.split("\n")]
            squeezed[name] = "\n/* #define SFDAE_NO 1\n int no; */\n".join(
                line if line.lstrip().startswith("#") else line.replace(",", " // one\n ,\n").replace(";", "\n;\n")
                for line in lines)
        self.assertEqual(mirror_of(squeezed), mirror_of(HEADERS))

    def test_does_not_depend_on_the_header_a_declaration_stands_in(self):
        declarations = []
        for text in HEADERS.values():
            text = mirror.without_comments(text).replace("\v", " ")
            text = re.sub(r"#ifdef __cplusplus.*?#endif|#if defined\(_WIN32\).*?#endif", "", text, flags=re.DOTALL)
            declarations += [line for line in text.split("\n") if line.startswith("#define SFDAE_")
                             and not re.fullmatch(r"#define SFDAE_\w*H\s*", line)]
            text = re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE)
            declarations += [part.strip() + ";" for part in re.split(r";(?![^{}]*\})", text) if part.strip()]
        self.assertGreater(len(declarations), 150)
        moved = {"c.h": "\n".join(declarations[::-3]), "a.h": "\n".join(declarations[-2::-3]),
                 "b.h": "\n".join(declarations[-3::-3])}
        self.assertEqual(mirror_of(moved), mirror_of(HEADERS))

    def test_holds_what_is_added(self):
        files = mirror_of(with_lines(
            "#define SFDAE_EXTRA \\", "  ( -7 ) /* why,", "not */", "struct sfdae_shell;",
            "typedef struct sfdae_shell { double a, b; sfdae_core core; sfdae_hook hook; } sfdae_shell;",
            "typedef struct sfdae_core { long n; const struct sfdae_shell *shell; } sfdae_core;",
            "typedef int (*sfdae_hook)(const double *x, sfdae_shell *shell);",
            "SFDAE_API const char *sfdae_open(const sfdae_solver *solver, size_t N, const int *list);"))
        types, functions = files["sfdae_types.f90"], files["sfdae_c.f90"]
        self.assertIn("integer(c_int), parameter, public :: sfdae_extra = -7\n", types)
        self.assertLess(types.index(":: sfdae_core\n"), types.index(":: sfdae_shell\n"))
        self.assertIn("    real(c_double) :: b = 0\n    type(sfdae_core) :: core = sfdae_core()\n"
                      "    type(c_funptr) :: hook = c_null_funptr\n", types)
        self.assertIn("    function sfdae_hook(x, shell) bind(c)\n      import :: c_int, c_ptr, sfdae_shell\n"
                      "      type(c_ptr), value :: x\n      type(sfdae_shell), intent(inout) :: shell\n", functions)
        self.assertIn('    function c_open(solver, n, list) bind(c, name="sfdae_open")\n'
                      "      import :: c_int, c_ptr, c_size_t\n      type(c_ptr), value :: solver\n"
                      "      integer(c_size_t), value :: n\n      integer(c_int), intent(in) :: list(*)\n"
                      "      type(c_ptr) :: c_open\n", functions)


class Refusal(unittest.TestCase):
    def refuses(self, words, *lines):
        with self.assertRaisesRegex(mirror.HeaderError, words):
            mirror_of(with_lines(*lines))

    def test_names_what_is_not_understood(self):
        self.refuses(r"zz.h:3: not understood: enum colour \{ red \}", "enum colour { red };")
        self.refuses("zz.h:6: not understood: typedef int number", "/* two", "lines */", "", "typedef int number;")
        self.refuses("zz.h:3: not understood: extern int x", "extern int x;")
        self.refuses("zz.h:3: not understood: int x \\[ 3", "typedef struct sfdae_s { int x[3]; } sfdae_s;")
        self.refuses("zz.h:3: not understood: unsigned int n", "SFDAE_API int sfdae_f(unsigned int n);")
        self.refuses("zz.h:3: not understood: #define SFDAE_TWO 2.0", "#define SFDAE_TWO 2.0")
        self.refuses("zz.h:4: depends on a condition", "#ifdef X", "#define SFDAE_X 1", "#endif")
        self.refuses("zz.h:4: depends on a condition", "#if X", "SFDAE_API int sfdae_f(int n);", "#endif")
        self.refuses("zz.h:3: no semicolon", "SFDAE_API int sfdae_f(int n)")

    def test_names_what_fortran_has_no_word_for(self):
        self.refuses("zz.h:3: x: no type of Fortran for float", "SFDAE_API int sfdae_f(float x);")
        self.refuses("zz.h:3: sfdae_f: no type of Fortran for void", "SFDAE_API void sfdae_f(int n);")
        self.refuses("zz.h:3: x: a pointer to a pointer to double", "SFDAE_API int sfdae_f(double **x);")
        self.refuses("sfdae_s: two names become n", "typedef struct sfdae_s { int n, N; } sfdae_s;")

    def test_names_contradictions(self):
        self.refuses("zz.h:3: SFDAE_OK is declared twice, in different ways", "#define SFDAE_OK 1")
        self.refuses("sfdae_destroy is declared twice", "SFDAE_API int sfdae_destroy(sfdae_solver *solver);")
        self.refuses("sfdae_s contains itself", "typedef struct sfdae_s { sfdae_s s; } sfdae_s;")

    def test_names_entries_of_its_tables_that_nothing_needs(self):
        headers = {name: text.replace("double* residual)", "double* rest)") for name, text in HEADERS.items()}
        with self.assertRaisesRegex(mirror.HeaderError, "sfdae_get_strangeness_free has no member or argument residual"):
            mirror_of(headers)


if __name__ == "__main__":
    unittest.main()
