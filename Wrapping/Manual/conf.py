# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The pages of the source tree as one book; built by the target `manual` (Wrapping/Manual/CMakeLists.txt)."""

import pathlib
import re

ROOT = pathlib.Path(__file__).parents[2]

project = "Explica"
author = "The Explica developers"
copyright = author
release = re.search(r"VERSION (\d+\.\d+\.\d+)", (ROOT / "CMakeLists.txt").read_text())[1]
extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "Wrapping/Manual/index"
include_patterns = ["*.md", "Applications/**.md", "ExampleData/**.md", "Modules/**.md", "Testing/**.md", "Wrapping/**.md"]
exclude_patterns = ["build*/**"]
myst_heading_anchors = 4
html_theme = "furo"
html_title = f"Explica {release}"
smartquotes = False
html_show_sourcelink = False
html_extra_path = ["index.html"]
autodoc_default_options = {"members": True, "imported-members": True}


def fitted(app, name, source):
    """A page of the tree as one of the book: links to folders go to their pages, headings begin at the first level."""
    folder = (ROOT / name).parent

    def link(match):
        words, target = match.groups()
        place = folder / target
        if "://" in target or not place.is_dir():
            return match[0]
        page = place / "README.md"
        return f"[{words}]({target.rstrip('/')}/README.md)" if page.exists() else words

    text = re.sub(r"\[([^\]]+)\]\(([^)#\s]+)\)", link, source[0])
    headings = re.findall(r"^(#+) ", re.sub(r"```.*?```", "", text, flags=re.DOTALL), flags=re.MULTILINE)
    if headings and headings[0] == "##":
        text = re.sub(r"^#(#+ )", r"\1", text, flags=re.MULTILINE)
    source[0] = text


def plain(app, what, name, thing, options, lines):
    """Names that end in an underscore, as Python's of --lambda, are no links."""
    lines[:] = [re.sub(r"(\w)_(?=\W|$)", r"\1\\_", line) for line in lines]


def setup(app):
    app.connect("autodoc-process-docstring", plain)
    app.connect("source-read", fitted)
