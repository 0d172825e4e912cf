# SPDX-License-Identifier: BSD-3-Clause
"""Pages of the Fortran reference: comments (!>) and declarations of what the modules make public."""

import re

from headers import as_rst, escaped, title

# Headings where the name of a module is not enough, in the order of the pages. Others follow.
HEADINGS = {"sfdae_solver": "The solver", "sfdae_problems": "Problems", "sfdae_multibody": "Mechanical systems",
            "sfdae_control": "Options, monitor, events"}
NOT_FOR_USERS = {"sfdae", "sfdae_types", "sfdae_c", "sfdae_conversions"}


def modules(root):
    """Names and headings of the modules that programs use by way of the module sfdae."""
    listed = (root / "fortran_bindings" / "sources.txt").read_text().split()
    found = [name.removesuffix(".f90") for name in listed if name.removesuffix(".f90") not in NOT_FOR_USERS]
    order = [name for name in HEADINGS if name in found] + [name for name in found if name not in HEADINGS]
    return {name: HEADINGS.get(name, name.removeprefix("sfdae_").capitalize()) for name in order}


def joined(lines):
    """Lines with those that continue them."""
    result = []
    for line in lines:
        if result and result[-1].rstrip().endswith("&"):
            result[-1] = result[-1].rstrip()[:-1].rstrip() + " " + line.strip().lstrip("&").lstrip()
        else:
            result.append(line)
    return result


class Entity:
    """A type, a procedure or a generic name: its comment and its declaration, with the comments within."""

    def __init__(self, name, kind, comment, body):
        self.name, self.kind, self.comment, self.body = name, kind, comment, body


def comment_above(lines, position):
    """The comment that ends above a line."""
    first = position
    while first > 0 and re.match(r"\s*!>", lines[first - 1]):
        first -= 1
    return [re.sub(r"^\s*!> ?", "", line) for line in lines[first:position]]


def entities(text):
    """Types, procedures and generic names of a module, by lower-case name."""
    lines = joined(text.split("\n"))
    found = {}
    for position, line in enumerate(lines):
        if match := re.match(r"\s*type(?:, [^:]*)? :: (\w+)\s*$", line):
            kind, stop = "type", r"\s*end type\b"
        elif match := re.match(r"\s*(?:pure |elemental |recursive |impure )*(?:function|subroutine) (\w+)\(", line):
            kind, stop = "procedure", r"\s*end (?:function|subroutine)\b"
        elif match := re.match(r"\s*interface (\w+)\s*$", line):
            kind, stop = "interface", r"\s*end interface\b"
        else:
            continue
        end = next(i for i in range(position, len(lines)) if re.match(stop, lines[i]))
        found.setdefault(match[1].lower(), Entity(match[1], kind, comment_above(lines, position), lines[position:end]))
    return found


def public_names(text):
    """What a module makes public."""
    names = []
    for line in joined(text.split("\n")):
        if match := re.match(r"\s*public :: (.*)", line):
            names += [name.strip() for name in match[1].split(",")]
    return [name for name in names if re.fullmatch(r"\w+", name)]


def arguments(entity):
    """(names, declaration, comment) of the arguments of a procedure."""
    head = entity.body[0]
    names = [name.strip().lower() for name in re.search(r"\((.*?)\)", head)[1].split(",")]
    result = re.search(r"result\((\w+)\)", head)
    wanted = set(names) | ({result[1].lower()} if result else set())
    for position, line in enumerate(entity.body[1:], 1):
        match = re.match(r"\s*((?:type|class|integer|real|logical|character|procedure)\b.*?) :: (.*)$", line)
        if match and {re.match(r"\w+", part.strip())[0].lower() for part in split(match[2])} & wanted:
            yield match[2].strip(), match[1].strip(), comment_above(entity.body, position)


def split(text):
    """Parts between commas outside of parentheses."""
    return re.split(r",\s*(?![^()]*\))", text)


def procedure_lines(shown_name, entity, underline):
    head = re.sub(r"^\s*(?:recursive |pure |elemental |impure )*", "", entity.body[0])
    if "%" in shown_name:  # as it is called
        head = re.sub(r"\(self(?:, )?", "(", head.replace(entity.name, f"{shown_name.split('%')[1]}", 1))
    lines = [*title(shown_name, underline), ".. code-block:: fortran", "", f"   {head}", "", *as_rst(entity.comment)]
    for names, declaration, comment in arguments(entity):
        if names != "self":
            lines += item_lines(names, declaration, comment)
    return lines


def item_lines(names, declaration, comment):
    """A component or an argument."""
    text = " ".join(" ".join(comment).split())
    return [f"- ``{names}``, {escaped(declaration)}" + (f": {escaped(text)}" if text else ""), ""]


def type_lines(entity, found, underline):
    """A type: components, then the procedures bound to it."""
    lines = [*title(entity.name, underline), ".. code-block:: fortran", "", f"   {entity.body[0].strip()}", "",
             *as_rst(entity.comment)]
    is_private = False
    bindings = []
    for position, line in enumerate(entity.body[1:], 1):
        if re.match(r"\s*private\s*$", line):
            is_private = True
        elif re.match(r"\s*contains\s*$", line):
            is_private = False
        elif match := re.match(r"\s*(procedure|generic)\b(.*?)::\s*(.*)$", line):
            for binding in split(match[3]):
                name, _, target = (part.strip() for part in binding.partition("=>"))
                interface = re.search(r"\((\w+)\)", match[2])
                bindings.append((name, (interface[1] if interface else target or name).lower(),
                                 comment_above(entity.body, position)))
        elif not is_private and (match := re.match(r"\s*(\w.*?) :: (.*)$", line)):
            lines += item_lines(match[2].strip(), match[1].strip(), comment_above(entity.body, position))
    deeper = {"-": "~", "~": "^"}[underline]
    for name, target, comment in bindings:
        if target in found:
            procedure = found[target]
            shown = Entity(procedure.name, "procedure", comment or procedure.comment, procedure.body)
            lines += procedure_lines(f"{entity.name}%{name}", shown, deeper)
    return lines


def introduction(text):
    """The comment above a module."""
    comment = text.split("\nmodule ")[0].split("\n")
    return as_rst([re.sub(r"^! ?", "", line) for line in comment if "SPDX" not in line])


def module_page(text, name, heading):
    found = entities(text)
    lines = [*title(f"{heading}: module {name}"), *introduction(text)]
    for public in dict.fromkeys(public_names(text)):
        entity = found.get(public.lower())
        if not entity:
            continue
        if entity.kind == "type":
            lines += type_lines(entity, found, "-")
        elif entity.kind == "procedure":
            lines += procedure_lines(public, entity, "-")
        else:
            lines += [*title(public, "-"), *as_rst(entity.comment)]
    return "\n".join(lines) + "\n"


def pages(root):
    """Names and texts of the pages."""
    folder = root / "fortran_bindings"
    result = {f"fortran_{name}.rst": module_page((folder / f"{name}.f90").read_text(), name, heading)
              for name, heading in modules(root).items()}
    lines = [*title("Fortran"), *introduction((folder / "sfdae.f90").read_text()), ".. toctree::", "",
             *(f"   {name.removesuffix('.rst')}" for name in result)]
    result["fortran.rst"] = "\n".join(lines) + "\n"
    return result
