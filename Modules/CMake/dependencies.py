#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The table and picture of Modules/README.md, from the modules' own calls of explica_add_module.

    Modules/CMake/dependencies.py            says whether the page is what CMake says
    Modules/CMake/dependencies.py --update   writes it
"""

import pathlib
import re
import sys

MODULES = pathlib.Path(__file__).resolve().parents[1]
PAGE = MODULES / "README.md"
BEGIN = "<!-- Written by Testing/update-pages.sh from the modules' CMakeLists.txt. -->\n"
END = "<!-- Until here. -->\n"
KEYWORDS = (
    "PURPOSE COMPILE_QUICKLY SOURCES PUBLIC PRIVATE FIND PROPERTY_TESTS SLOW_TESTS OTHER_TESTS "
    "TEST_LINKS"
).split()


def declared(name):
    """Purpose, and links by kind, of a module's explica_add_module call."""
    text = re.sub(r"#.*", "", (MODULES / name / "CMakeLists.txt").read_text())
    found = re.search(r"explica_add_module\(\s*(\w+)(.*?)\n?\)", text, re.DOTALL)
    if not found or found[1] != name:
        raise SystemExit(f"{name}: no call of explica_add_module")
    links = {"PUBLIC": [], "PRIVATE": []}
    purpose, keyword = "", ""
    for word in re.findall(r'"[^"]*"|\S+', found[2]):
        if word in KEYWORDS:
            keyword = word
        elif keyword == "PURPOSE":
            purpose = word.strip('"')
        elif keyword in links:
            links[keyword].append(word)
    return purpose, links


def modules():
    listed = re.search(r"IN ITEMS([\w\s]+)\)", (MODULES / "CMakeLists.txt").read_text())[1]
    return {name: declared(name) for name in sorted(listed.split())}


def own(links):
    """Modules that a module links, publicly or not."""
    words = links["PUBLIC"] + links["PRIVATE"]
    return sorted({w.removeprefix("Explica::") for w in words if w.startswith("Explica::")})


def levels(all_modules):
    """Modules by the length of their longest chain of links.  A circle is refused."""
    depth = {}

    def visit(name, path):
        if name in path:
            raise SystemExit("a circle of links: " + " -> ".join([*path, name]))
        if name not in depth:
            below = [visit(n, [*path, name]) for n in own(all_modules[name][1])]
            depth[name] = 1 + max(below, default=-1)
        return depth[name]

    for name in all_modules:
        visit(name, [])
    rows = [[n for n in all_modules if depth[n] == d] for d in range(max(depth.values()) + 1)]
    return rows[::-1]


def others(words):
    """Libraries of others, by their short names."""
    outside = [w for w in words if not w.startswith(("Explica::", "$", "-"))]
    return sorted({w.split("::")[0] for w in outside})


def section():
    all_modules = modules()
    rule = "─" * 78
    picture = f"\n{rule}\n".join("   ".join(row) for row in levels(all_modules))
    text = f"{BEGIN}\n```\nApplications   Wrapping\n{rule}\n{picture}\n```\n\n"
    text += "| Module | Purpose | Links | Others' libraries |\n|---|---|---|---|\n"
    for name, (purpose, links) in all_modules.items():
        outside = ", ".join(others(links["PUBLIC"] + links["PRIVATE"]))
        text += f"| [{name}]({name}) | {purpose} | {', '.join(own(links)) or 'none'} | {outside} |\n"
    return f"{text}\n{END}"


def main():
    page = PAGE.read_text()
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    wanted = before + section() + after
    if "--update" in sys.argv:
        PAGE.write_text(wanted)
    elif page != wanted:
        raise SystemExit("Modules/README.md is not what CMake says: run Testing/update-pages.sh")


if __name__ == "__main__":
    main()
