#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the Fortran mirror of the C API from include/sfdae/*.h:

    fortran_bindings/sfdae_types.f90   constants and structs, which the module sfdae passes on
    fortran_bindings/sfdae_c.f90       interfaces of callbacks and functions, for the modules of sfdae alone

    generate_fortran_mirror.py           writes both
    generate_fortran_mirror.py --check   compares with them, shows differences, fails if there are any

Only declarations count, not their order, layout, comments, or the header that they stand in. One that is not
understood ends the program with a HeaderError that names the file, the line and the declaration."""

import argparse
import ast
import collections
import difflib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# ---- What headers do not say --------------------------------------------------------------------------------

# Names of Fortran where lower case is not enough: H and h are one there, and `expression` is what programs write.
TYPE_NAMES = {"sfdae_expression": "expression"}
MEMBER_NAMES = {
    ("sfdae_statistics", "evaluations_F"): "evaluations_residual",
    ("sfdae_multibody_formulas", "M"): "mass",
    ("sfdae_multibody_formulas", "f"): "forces",
    ("sfdae_multibody_formulas", "g"): "constraints",
    ("sfdae_multibody_formulas", "S"): "kinematics",
    ("sfdae_multibody_formulas", "H"): "nonholonomic_matrix",
    ("sfdae_multibody_formulas", "h"): "nonholonomic_offset",
}

# Pointers to numbers among the arguments of functions are arrays, but for these: a single number,
SINGLE = {
    ("sfdae_add_mode", "mode"),
    ("sfdae_add_switch", "mode"),
    ("sfdae_add_transition", "number"),
    ("sfdae_advance_hybrid", "t"),
    ("sfdae_advance_to_transition", "t"),
    ("sfdae_get_accumulation", "t"),
    ("sfdae_get_current_mode", "mode"),
    ("sfdae_get_hybrid_checkpoint_length", "length"),
    ("sfdae_get_num_passages", "count"),
    ("sfdae_report_hybrid", "needed"),
    ("sfdae_advance", "t"),
    ("sfdae_step", "t"),
    ("sfdae_get_checkpoint_length", "length"),
    ("sfdae_get_jump", "t"),
    ("sfdae_get_num_decisions", "count"),
    ("sfdae_get_solution_length", "length"),
    ("sfdae_get_descriptor_sizes", "num_equations"),
    ("sfdae_get_descriptor_sizes", "num_unknowns"),
    ("sfdae_get_descriptor_sizes", "num_inputs"),
    ("sfdae_get_descriptor_sizes", "num_outputs"),
    ("sfdae_get_solution_accuracy", "accuracy"),
    ("sfdae_get_solution_accuracy", "t"),
    ("sfdae_get_solution_range", "num_unknowns"),
    ("sfdae_get_solution_range", "start"),
    ("sfdae_get_solution_range", "end"),
    ("sfdae_get_parameter", "value"),
    ("sfdae_certify", "distance"),
    ("sfdae_get_strangeness_free", "residual"),
    ("sfdae_get_strangeness_free_at", "residual"),
    ("sfdae_report", "needed"),
    ("sfdae_get_num_switches", "count"),
    ("sfdae_get_switch", "needed"),
    ("sfdae_export_source", "needed"),
}
# or an array for which the modules may pass NULL.
ADDRESSES = {
    ("sfdae_advance_hybrid", "xdot"),
    ("sfdae_advance_to_transition", "xdot"),
    ("sfdae_get_passage_values", "impulse"),
    ("sfdae_start_hybrid", "xdot"),
    ("sfdae_advance", "xdot"),
    ("sfdae_evaluate_solution", "xdot"),
    ("sfdae_get_extended_system", "x"),
    ("sfdae_get_jet", "x"),
    ("sfdae_get_jump", "impulse"),
    ("sfdae_get_projectors", "Z2"),
    ("sfdae_get_projectors", "Z3"),
    ("sfdae_get_projectors", "vhat"),
    ("sfdae_get_projectors_at", "Z2"),
    ("sfdae_get_projectors_at", "Z3"),
    ("sfdae_get_projectors_at", "vhat"),
    ("sfdae_impact", "impulses"),
    ("sfdae_impact", "restitution"),
    ("sfdae_interpolate", "xdot"),
    ("sfdae_jump", "impulses"),
    ("sfdae_make_consistent", "xdot"),
    ("sfdae_get_event_sensitivities", "g_p"),
    ("sfdae_get_hybrid_sensitivities", "Sdot"),
    ("sfdae_get_sensitivities", "Sdot"),
    ("sfdae_set_breakpoints", "kinds"),
    ("sfdae_set_events", "directions"),
    ("sfdae_set_hybrid_sensitivities", "directions"),
    ("sfdae_set_sensitivities", "directions"),
    ("sfdae_start", "xdot"),
    ("sfdae_step", "xdot"),
}

NUMBERS = {  # C type: Fortran type and the value that a fresh member has
    "char": ("character(kind=c_char)", "' '"),
    "double": ("real(c_double)", "0"),
    "int": ("integer(c_int)", "0"),
    "long": ("integer(c_long)", "0"),
    "size_t": ("integer(c_size_t)", "0"),
}
ADDRESS = ("type(c_ptr)", "c_null_ptr")
FUNCTION_ADDRESS = ("type(c_funptr)", "c_null_funptr")


class HeaderError(Exception):
    """A declaration that this script does not understand."""


# ---- Reading: headers to declarations -----------------------------------------------------------------------

Token = collections.namedtuple("Token", "text place")
Variable = collections.namedtuple("Variable", "name base pointers const place")
Function = collections.namedtuple("Function", "result arguments")  # result: a Variable whose name is the function's


class Api:
    """What the headers declare."""

    def __init__(self):
        self.constants = {}  # name: value
        self.structs = {}    # name: list of Variable
        self.opaque = set()  # names of structs
        self.callbacks = {}  # name: Function
        self.functions = {}  # name: Function

    def add(self, kind, name, what, place):
        """Adds a declaration. The same one again is allowed, as in C."""
        known = getattr(self, kind)
        if name in known and strip_places(known[name]) != strip_places(what):
            raise HeaderError(f"{place}: {name} is declared twice, in different ways")
        known.setdefault(name, what)


def strip_places(what):
    """A declaration without the lines where it stands, for comparisons."""
    if isinstance(what, Variable):
        return what._replace(place=None)
    if isinstance(what, (list, Function)):
        return [strip_places(part) for part in what]
    return what


def without_comments(text):
    """C code without comments and with continued lines joined; a vertical tab stands for each newline lost."""
    comment = re.compile(r"/\*.*?\*/|//[^\n]*", flags=re.DOTALL)
    text = comment.sub(lambda match: " " + "\v" * match.group().count("\n"), text)
    return text.replace("\\\n", " \v")


def read_header(path, api):
    """Adds what a header declares."""
    conditions = []  # of the #if that are open: "guard", "C++" or "other"
    tokens = []
    number = 1
    for line in without_comments(path.read_text(encoding="utf-8")).split("\n"):
        place = f"{path.name}:{number}"
        number += 1 + line.count("\v")
        if line.lstrip().startswith("#"):
            read_directive(line.strip(), place, conditions, api)
        elif line.strip() and "C++" not in conditions:
            if "other" in conditions:
                raise HeaderError(f"{place}: depends on a condition: {line.strip()}")
            tokens += [Token(text, place) for text in re.findall(r"\w+|\S", line)]
    if conditions:
        raise HeaderError(f"{path.name}: an #if is not closed")
    while tokens:
        read_declaration(take_declaration(tokens), api)


def read_directive(line, place, conditions, api):
    """Adds a constant, or follows conditions."""
    if re.match(r"#\s*if", line):
        if re.fullmatch(r"#\s*ifdef\s+__cplusplus", line):
            conditions.append("C++")
        else:
            conditions.append("guard" if re.fullmatch(r"#\s*ifndef\s+SFDAE_\w*H", line) else "other")
    elif re.match(r"#\s*(else|elif)", line) and conditions[-1:] == ["other"]:
        pass
    elif re.match(r"#\s*endif", line) and conditions:
        conditions.pop()
    elif re.match(r"#\s*define\s+SFDAE_(API\b.*|\w*H)$", line) or re.match(r"#\s*include\b", line):
        pass
    elif match := re.fullmatch(r"#\s*define\s+(SFDAE_\w+)\s+(\(?\s*-?\s*\d+\s*\)?)", line):
        if conditions and conditions[-1] != "guard":
            raise HeaderError(f"{place}: depends on a condition: {line}")
        api.add("constants", match[1], int(ast.literal_eval(re.sub(r"\s", "", match[2]))), place)
    else:
        raise HeaderError(f"{place}: not understood: {line}")


def take_declaration(tokens):
    """Takes the tokens up to a semicolon outside of braces."""
    depth = 0
    for position, token in enumerate(tokens):
        depth += {"{": 1, "}": -1}.get(token.text, 0)
        if token.text == ";" and depth == 0:
            declaration = tokens[:position]
            del tokens[:position + 1]
            return declaration
    raise HeaderError(f"{tokens[0].place}: no semicolon ends what begins with {tokens[0].text}")


def read_declaration(tokens, api):
    """Adds a typedef, a struct or a function."""
    place = tokens[0].place if tokens else ""
    text = " ".join(token.text for token in tokens)
    if match := re.fullmatch(r"(?:typedef )?struct (\w+)(?: (\w+))?", text):
        if match[2] in (None, match[1]):
            api.opaque.add(match[1])
            return
    elif match := re.fullmatch(r"typedef struct (\w+) \{.*\} (\w+)", text):
        if match[1] == match[2]:
            api.add("structs", match[1], read_members(tokens[4:-2]), place)
            return
    elif match := re.fullmatch(r"typedef (.*) \( \* (\w+) \) \((.*)\)", text):
        star = text[:match.start(2)].count(" ") - 1
        arguments = read_arguments(tokens[star + 4:-1])
        api.add("callbacks", match[2], Function(read_variable(tokens[1:star - 1] + [tokens[star + 1]]), arguments),
                place)
        return
    elif match := re.fullmatch(r"SFDAE_API ([^(]*) (sfdae_\w+) \((.*)\)", text):
        name = text[:match.start(2)].count(" ")
        function = Function(read_variable(tokens[1:name + 1]), read_arguments(tokens[name + 2:-1]))
        api.add("functions", match[2], function, place)
        return
    raise HeaderError(f"{place}: not understood: {text}")


def read_members(tokens):
    """Members of a struct; `int a, b;` are two."""
    members = []
    while tokens:
        first, *others = split_at_commas(take_declaration(tokens))
        members.append(read_variable(first))
        for other in others:
            if len(other) != 1 or members[-1].pointers:
                raise HeaderError(f"{other[0].place if other else first[0].place}: declare pointers one by one")
            members.append(members[-1]._replace(name=other[0].text))
    return members


def read_arguments(tokens):
    """Arguments of a function."""
    if [token.text for token in tokens] == ["void"]:
        return []
    return [read_variable(part) for part in split_at_commas(tokens)]


def split_at_commas(tokens):
    """Lists of tokens between commas."""
    parts = [[]]
    for token in tokens:
        if token.text == ",":
            parts.append([])
        else:
            parts[-1].append(token)
    return parts


def read_variable(tokens):
    """[const] type [*...] name; `const` after a star says nothing about what is pointed to."""
    text = " ".join(token.text for token in tokens)
    match = re.fullmatch(r"(?:(const) )?(?:struct )?([a-z]\w*)( const)?((?: \*(?: const)?)*) ([A-Za-z]\w*)", text)
    if not match or match[2] == "const":
        raise HeaderError(f"{tokens[0].place if tokens else 'argument'}: not understood: {text}")
    return Variable(match[5], match[2], match[4].count("*"), bool(match[1] or match[3]), tokens[0].place)


# ---- Writing: declarations to Fortran -----------------------------------------------------------------------

def fortran_name(owner, name):
    """Name of a member or an argument of `owner`."""
    return MEMBER_NAMES.get((owner, name), name.lower())


def type_name(struct):
    return TYPE_NAMES.get(struct, struct)


def check_distinct(owner, names):
    """Fortran tells names by their letters alone."""
    for name in names:
        if names.count(name) > 1:
            raise HeaderError(f"{owner}: two names become {name} in Fortran: add one to MEMBER_NAMES")


def mirror(variable, api):
    """Fortran type of a variable as C holds it, and its value where it is fresh."""
    base = variable.base
    if variable.pointers and (base in NUMBERS or base == "void" or base in api.structs or base in api.opaque):
        return ADDRESS
    if not variable.pointers and base in NUMBERS:
        return NUMBERS[base]
    if not variable.pointers and base in api.callbacks:
        return FUNCTION_ADDRESS
    if not variable.pointers and base in api.structs:
        return f"type({type_name(base)})", f"{type_name(base)}()"
    raise HeaderError(f"{variable.place}: {variable.name}: no type of Fortran for {base} {'*' * variable.pointers}")


def argument_line(owner, variable, api, is_callback):
    """Declaration of a dummy argument. Callbacks get addresses, which they give a shape."""
    name = fortran_name(owner, variable.name)
    intent = "in" if variable.const else "inout"
    pointee = mirror(variable._replace(pointers=0), api)[0] if pointee_is_known(variable, api) else None
    if variable.pointers == 1 and variable.base in api.structs and not (is_callback and variable.base in TYPE_NAMES):
        shape = "(*)" if variable.base in TYPE_NAMES else ""
        return f"{pointee}, intent({intent}) :: {name}{shape}"
    if variable.pointers == 1 and variable.base in NUMBERS and not is_callback:
        if (owner, variable.name) in SINGLE:
            return f"{pointee}, intent({intent}) :: {name}"
        if (owner, variable.name) not in ADDRESSES:
            return f"{pointee}, intent({intent}) :: {name}(*)"
    if variable.pointers == 2 and variable.base in api.opaque and not variable.const:
        return f"{ADDRESS[0]}, intent(inout) :: {name}"
    if variable.pointers == 2 and variable.base == "char" and variable.const and not is_callback:
        return f"{ADDRESS[0]}, intent(in) :: {name}(*)"  # texts
    if variable.pointers > 1:
        raise HeaderError(f"{variable.place}: {variable.name}: a pointer to a pointer to {variable.base}")
    return f"{mirror(variable, api)[0]}, value :: {name}"


def pointee_is_known(variable, api):
    return variable.base in NUMBERS or variable.base in api.structs


def joined(head, words, tail, indent):
    """head word, word, ... tail, in lines of at most 100 columns."""
    lines, line = [], head
    for position, word in enumerate(words):
        word += "," if position < len(words) - 1 else tail
        if len(line) + 1 + len(word) > 98:
            lines.append(line + " &")
            line = indent + "  " + word
        else:
            line += ("" if line.endswith("(") else " ") + word
    return lines + [line] if words else [head + tail]


def kinds_in(lines):
    """Names of types and kinds that lines use, for `import` and `use`."""
    return sorted(set(re.findall(r"\((?:kind=)?(c_\w+|sfdae_\w+|expression)\)", "\n".join(lines)))
                  | set(re.findall(r"= (c_null_\w+)", "\n".join(lines))))


def function_lines(c_name, name, function, binding, api):
    """Interface of a function or callback."""
    arguments = [fortran_name(c_name, argument.name) for argument in function.arguments]
    check_distinct(c_name, arguments + [name])
    declarations = [argument_line(c_name, argument, api, not binding) for argument in function.arguments]
    declarations.append(f"{mirror(function.result, api)[0]} :: {name}")
    suffix = f'bind(c, name="{binding}")' if binding else "bind(c)"
    head = joined(f"    function {name}(", arguments, ")", "    ")
    if len(head[-1]) + 1 + len(suffix) <= 100:
        head[-1] += " " + suffix
    else:
        head = head[:-1] + [head[-1] + " &", "      " + suffix]
    imports = joined("      import ::", kinds_in(declarations), "", "      ")
    return ["", *head, *imports, *("      " + line for line in declarations), f"    end function {name}"]


def struct_lines(name, members, api):
    """A struct as a type."""
    names = [fortran_name(name, member.name) for member in members]
    check_distinct(name, names)
    lines = ["", f"  type, bind(c), public :: {type_name(name)}"]
    for member, fortran in zip(members, names):
        kind, fresh = mirror(member, api)
        lines.append(f"    {kind} :: {fortran} = {fresh}")
    return lines + [f"  end type {type_name(name)}"]


def in_order(structs):
    """Names of structs, sorted, but those that are parts of others before these."""
    order = []

    def place(name, users):
        if name in users:
            raise HeaderError(f"{name} contains itself")
        for member in structs[name]:
            if not member.pointers and member.base in structs and member.base not in order:
                place(member.base, users + [name])
        if name not in order:
            order.append(name)

    for name in sorted(structs):
        place(name, [])
    return order


def module_lines(name, purpose, used, lines):
    """A module with its head."""
    return ["! SPDX-License-Identifier: BSD-3-Clause", "!",
            "! Written by scripts/generate_fortran_mirror.py from the headers in include/sfdae: do not edit.",
            *("! " + line for line in purpose), f"module {name}", *used, "  implicit none", "  private",
            *lines, "", f"end module {name}"]


def use_intrinsic(lines):
    kinds = [kind for kind in kinds_in(lines) if kind.startswith("c_")]
    return joined("  use, intrinsic :: iso_c_binding, only:", kinds, "", "  ")


def types_module(api):
    """Constants and structs."""
    constants = [f"  integer(c_int), parameter, public :: {name.lower()} = {value}"
                 for name, value in sorted(api.constants.items())]
    structs = [line for name in in_order(api.structs) for line in struct_lines(name, api.structs[name], api)]
    return module_lines("sfdae_types", ["Constants and structs; the header explains them."],
                        use_intrinsic(constants + structs), ["", *constants, *structs])


def functions_module(api):
    """Interfaces of callbacks and functions; for each kind of callback a function that takes its address."""
    interfaces, addresses = ["", "  abstract interface"], []
    for name, callback in sorted(api.callbacks.items()):
        interfaces += function_lines(name, name, callback, None, api)
        address = "address_of_" + name[len("sfdae_"):]
        addresses += ["", f"  !> Address of a {name}; the compiler compares its arguments.",
                      f"  function {address}(callback) result(address)",
                      f"    procedure({name}) :: callback", "    type(c_funptr) :: address", "",
                      "    address = c_funloc(callback)", f"  end function {address}"]
    interfaces += ["", "  end interface", "", "  interface"]
    for name, function in sorted(api.functions.items()):
        interfaces += function_lines(name, "c_" + name[len("sfdae_"):], function, name, api)
    interfaces += ["", "  end interface"]
    public = re.findall(r"  function (c_\w+|address_of_\w+)\(", "\n".join(interfaces + addresses))
    types = [kind for kind in kinds_in(interfaces) if not kind.startswith("c_")]
    used = use_intrinsic(interfaces + addresses + ["(c_funloc)"])
    used += joined("  use sfdae_types, only:", types, "", "  ")
    return module_lines(
        "sfdae_c", ["Callbacks and functions of C; the header explains them and their arguments."], used,
        ["", *joined("  public ::", public, "", "  "), *interfaces, "", "contains", *addresses])


def check_tables(api):
    """Entries of the tables above that nothing in the headers needs are mistakes."""
    owned = {(name, member.name) for name, members in api.structs.items() for member in members}
    owned |= {(name, argument.name) for name, function in api.functions.items() for argument in function.arguments}
    for entry in sorted((set(MEMBER_NAMES) | SINGLE | ADDRESSES) - owned):
        raise HeaderError(f"{entry[0]} has no member or argument {entry[1]}, but a table of this script names it")
    for name in sorted(set(TYPE_NAMES) - set(api.structs)):
        raise HeaderError(f"there is no struct {name}, but TYPE_NAMES names it")


def mirror_of(directory):
    """Names and texts of the files for the headers in a directory."""
    api = Api()
    headers = sorted(directory.glob("*.h"))
    if not headers:
        raise HeaderError(f"no headers in {directory}")
    for path in headers:
        read_header(path, api)
    check_tables(api)
    files = {"sfdae_types.f90": types_module(api), "sfdae_c.f90": functions_module(api)}
    for name, lines in files.items():
        for line in lines:
            if len(line) > 100:
                raise HeaderError(f"{name}: more than 100 columns: {line.strip()}")
    return {name: "\n".join(lines) + "\n" for name, lines in files.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare, do not write")
    parser.add_argument("--headers", type=pathlib.Path, default=ROOT / "include" / "sfdae")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "fortran_bindings")
    options = parser.parse_args()
    try:
        files = mirror_of(options.headers)
    except HeaderError as error:
        sys.exit(f"HeaderError: {error}")
    differ = False
    for name, text in files.items():
        path = options.output / name
        if not options.check:
            path.write_text(text, encoding="utf-8")
            continue
        old = path.read_text(encoding="utf-8") if path.exists() else ""
        differences = list(difflib.unified_diff(old.splitlines(), text.splitlines(), str(path), "headers", lineterm=""))
        differ = differ or bool(differences)
        print("\n".join(differences) if differences else f"{name} mirrors the headers")
    if differ:
        sys.exit("The mirror is out of date: run scripts/generate_fortran_mirror.py and commit what it writes.")


if __name__ == "__main__":
    main()
