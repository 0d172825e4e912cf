# SPDX-License-Identifier: BSD-3-Clause
"""Settings of Sphinx. build.py lays out the sources and sets the variables of the environment used here."""

import os

from pygments.lexers.special import TextLexer

project = "sfdae"
author = "the authors of sfdae"
project_copyright = "the authors of sfdae"
version = release = os.environ["SFDAE_DOCS_VERSION"]
html_title = f"sfdae {release}"

extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
root_doc = "index"
html_theme = "furo"
html_copy_source = False
html_show_sourcelink = False
html_static_path = ["static"]
html_css_files = ["site.css"]
smartquotes = False  # x' is a derivative
# Nothing is loaded from elsewhere: the site is read from the disk, without a network.
html_theme_options = {"sidebar_hide_name": False}

myst_enable_extensions = []
myst_heading_anchors = 4

breathe_projects = {"sfdae": os.environ["SFDAE_DOCS_XML"]}
breathe_default_project = "sfdae"
breathe_domain_by_extension = {"h": "c", "hpp": "cpp"}
breathe_show_include = False
breathe_show_define_initializer = True
primary_domain = None
highlight_language = "none"
suppress_warnings = ["misc.highlighting_failure"]  # Fortran in fixed form, programs with ... in them
c_extra_keywords = []
cpp_index_common_prefix = ["sfdae::"]

autodoc_typehints = "none"  # signatures stay short, and docstrings name the types
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True


def keep_bars(app, what, name, thing, options, lines):
    """In docstrings |x| is the size of x."""
    lines[:] = [line.replace("|", "\\|") for line in lines]


def setup(app):
    app.add_lexer("mermaid", TextLexer)  # shown as text
    app.connect("autodoc-process-docstring", keep_bars)
    return {"parallel_read_safe": True}
