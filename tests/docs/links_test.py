#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Links lead somewhere.

    links_test.py --site <html folder>      links and pictures of the site, with their anchors, stay within it
    links_test.py --sources <source tree>   relative links of the Markdown files of the sources"""

import argparse
import html.parser
import pathlib
import re
import sys
import urllib.parse

# Hosts that the site may name. Nothing is loaded from them.
HOSTS = {"www.sphinx-doc.org", "pradyunsg.me", "github.com", "keepachangelog.com", "semver.org"}


class Page(html.parser.HTMLParser):
    """The links and anchors of a page, and what it loads."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.anchors = [], [], {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[key] for key in ("id", "name") if values.get(key)}
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        if tag in ("img", "script") and "src" in values:
            self.loaded.append(values["src"])
        if tag == "link" and values.get("rel") in ("stylesheet", "icon"):
            self.loaded.append(values["href"])


def broken_in_site(site):
    """Links of a built site that lead nowhere."""
    pages = {path.resolve(): Page(path.read_text()) for path in site.rglob("*.html")}
    count = 0
    for path, page in sorted(pages.items()):
        for link in page.links + page.loaded:
            count += 1
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                if link in page.loaded or parts.netloc not in HOSTS:
                    yield f"{path.relative_to(site)}: {link} is elsewhere"
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                yield f"{path.relative_to(site)}: there is no {link}"
            elif target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
                yield f"{path.relative_to(site)}: there is no anchor {link}"
    if count < 1000:
        yield f"only {count} links were found: something is wrong with the site or with this test"


def broken_in_sources(root):
    """Relative links in Markdown files that lead nowhere."""
    folders = [root, *(root / name for name in ("docs", "python", "fortran_bindings", "tests", "examples", "cli"))]
    files = {path for folder in folders for path in folder.glob("*.md" if folder == root else "**/*.md")}
    for path in sorted(files):
        text = re.sub(r"^(```.*?^```|    .*?)$", "", path.read_text(), flags=re.DOTALL | re.MULTILINE)
        for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "", text)):
            if not re.match(r"[a-z]+:|#", link) and not (path.parent / link.split("#")[0]).exists():
                yield f"{path.relative_to(root)}: there is no {link}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--site", type=pathlib.Path)
    parser.add_argument("--sources", type=pathlib.Path)
    options = parser.parse_args()
    broken = list(broken_in_site(options.site.resolve())) if options.site else []
    broken += broken_in_sources(options.sources.resolve()) if options.sources else []
    sys.exit("\n".join(broken) or None)


if __name__ == "__main__":
    main()
