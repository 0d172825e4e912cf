# SPDX-License-Identifier: BSD-3-Clause
"""Pages of the C and C++ reference: what Doxygen found in the headers, in the order of the headers.

Declarations are shown by Breathe; sections and comments that belong to several declarations come from the header."""

import re
import xml.etree.ElementTree

from headers import as_rst, title

# Headings where the name of a header is not enough, in the order of the pages. Others follow.
C_HEADINGS = {"sfdae": "Life cycle, options, linear problems", "expression": "Expressions, nonlinear problems",
              "multibody": "Mechanical systems", "ensemble": "Ensembles", "sensitivity": "Sensitivities",
              "linearization": "Linearization, descriptor systems",
              "modes": "Switches, impacts, breakpoints", "hybrid": "Hybrid systems",
              "branches": "Singular points, branches"}
CPP_HEADINGS = {"sfdae": "The solver", "problem": "Problems", "expression": "Expressions",
                "results": "Options, points, results, errors", "ensemble": "Ensembles", "sensitivity": "Sensitivities",
                "linearization": "Linearization, descriptor systems", "complex": "Complex problems",
                "hybrid": "Hybrid systems"}
NOT_FOR_USERS = {"callbacks.hpp"}
NOT_SHOWN = r"SFDAE_API|SFDAE_\w+_H|SFDAE_VERSION_\w+"


def plain_comments(text):
    """(line, lines of the comment) of sections and of comments that belong to no single declaration."""
    for match in re.finditer(r"^/\*(?:\* @file)?(?!\*)(.*?)\*/", text, re.DOTALL | re.MULTILINE):
        if "SPDX" in match[1]:
            continue
        lines = [re.sub(r"^ ?\* ?", "", line).rstrip() for line in match[1].strip("\n ").split("\n")]
        yield text.count("\n", 0, match.start()) + 1, lines


def members(xml_file):
    """(line, kind, name) of what a header declares."""
    tree = xml.etree.ElementTree.parse(xml_file)
    for member in tree.iter("memberdef"):
        line = int(member.find("location").get("line"))
        yield line, member.get("kind"), member.findtext("name")


def structs(xml_folder, header):
    """(line, kind, name) of the structs and classes of a header."""
    for path in sorted(xml_folder.glob("struct*.xml")) + sorted(xml_folder.glob("class*.xml")):
        compound = xml.etree.ElementTree.parse(path).getroot().find("compounddef")
        location = compound.find("location")
        if location.get("file").endswith("/sfdae/" + header):
            yield int(location.get("line")), compound.get("kind"), compound.findtext("compoundname")


def directive(kind, name):
    directives = {"function": "doxygenfunction", "define": "doxygendefine", "typedef": "doxygentypedef",
                  "struct": "doxygenstruct", "class": "doxygenclass"}
    lines = [f".. {directives[kind]}:: {name}"]
    if kind in ("struct", "class"):
        lines.append("   :members:")
    return [*lines, ""]


def c_page(root, xml_folder, name, heading):
    """A page for a header of C."""
    header = f"{name}.h"
    found = list(structs(xml_folder, header))
    struct_names = {struct for _, _, struct in found}
    parts = [(line, directive(kind, struct)) for line, kind, struct in found]
    for line, kind, member in members(xml_folder / f"{name}_8h.xml"):
        if not re.fullmatch(NOT_SHOWN, member) and member not in struct_names:
            parts.append((line, directive(kind, member)))
    for line, lines in plain_comments((root / "include" / "sfdae" / header).read_text()):
        section = re.fullmatch(r"-+ (.*?) -+", lines[0])
        parts.append((line, title(section[1], "-") if section else as_rst(lines)))
    parts.sort(key=lambda part: part[0])
    return [*title(f"{heading}: sfdae/{header}"), *(line for _, lines in parts for line in lines)]


def cpp_page(root, xml_folder, name, heading):
    """A page for a header of C++."""
    header = f"{name}.hpp"
    text = (root / "include" / "sfdae" / header).read_text()
    comment = re.search(r"^// (?!SPDX).*?(?=^[^/\n])", text, re.DOTALL | re.MULTILINE)[0]
    introduction = as_rst([re.sub(r"^// ?", "", line) for line in comment.split("\n")])
    found = list(structs(xml_folder, header))
    names = {struct for _, _, struct in found}
    # Those within others are shown with their members.
    parts = [(line, directive(kind, struct)) for line, kind, struct in found
             if "detail" not in struct and struct.rpartition("::")[0] not in names]
    return [*title(f"{heading}: sfdae/{header}"), *introduction, *(line for _, lines in sorted(parts) for line in lines)]


def headers(root, suffix, headings):
    """Names and headings of the headers of a language."""
    found = [path.stem for path in sorted((root / "include" / "sfdae").glob("*" + suffix))
             if path.name not in NOT_FOR_USERS]
    order = [name for name in headings if name in found] + [name for name in found if name not in headings]
    return {name: headings.get(name, name.replace("_", " ").capitalize()) for name in order}


def contents(heading, text, names):
    return [*title(heading), text, "", ".. toctree::", "", *(f"   {name}" for name in names)]


def pages(root, xml_folder):
    """Names and texts of the pages."""
    result = {}
    c_headers, cpp_headers = headers(root, ".h", C_HEADINGS), headers(root, ".hpp", CPP_HEADINGS)
    for name, heading in c_headers.items():
        result[f"c_{name}.rst"] = c_page(root, xml_folder, name, heading)
    for name, heading in cpp_headers.items():
        result[f"cpp_{name}.rst"] = cpp_page(root, xml_folder, name, heading)
    result["c.rst"] = contents("C", "Programs include ``sfdae/sfdae.h``, which includes the others but ``sfdae/modes.h``, "
                               "``sfdae/hybrid.h`` and ``sfdae/branches.h``.",
                               [f"c_{name}" for name in c_headers])
    result["cpp.rst"] = contents("C++", "Programs include ``sfdae/sfdae.hpp``, which includes the others but "
                                 "``sfdae/hybrid.hpp``.",
                                 [f"cpp_{name}" for name in cpp_headers])
    return {name: "\n".join(lines) + "\n" for name, lines in result.items()}
