# SPDX-License-Identifier: BSD-3-Clause
"""Comments of sources as reStructuredText: paragraphs, lists, formulas set apart by indentation."""

import re


def escaped(text):
    """Text whose special characters mean nothing."""
    return re.sub(r"([\\*`|_<>])", r"\\\1", text)


def blocks(lines):
    """Blocks of lines between empty ones."""
    block = []
    for line in [*lines, ""]:
        if line.strip():
            block.append(line)
        elif block:
            yield block
            block = []


def as_rst(lines):
    """A comment without its marks. Blocks whose lines all begin with four spaces or more are shown as they stand."""
    result = []
    for block in blocks(lines):
        if all(line.startswith("    ") for line in block):
            result += ["::", "", *block, ""]
            continue
        for line in block:
            item = re.match(r"\s*- (.*)", line)
            if item:
                if result and result[-1] and not result[-1].startswith(("- ", "  ")):
                    result.append("")
                result.append("- " + escaped(item[1].strip()))
            elif result and result[-1].startswith(("- ", "  ")):
                result.append("  " + escaped(line.strip()))
            else:
                result.append(escaped(line.strip()))
        result.append("")
    return result


def title(text, underline="="):
    return [text, underline * len(text), ""]
