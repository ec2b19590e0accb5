#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Draws lines with measured numbers from the pages, to be measured again by hand.

    Testing/sample-numbers.py SEED [COUNT]

The same seed draws the same lines of the same pages.  Of each: page, line, its section, the commands that the section
names, and the line itself.  Pages that are written by a command are left out.
"""

import pathlib
import random
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGES = ["Modules/*/README.md", "Applications/*/README.md", "Testing/*.md", "Testing/validation/README.md"]
NUMBER = re.compile(r"\d(?:\.\d+)?\s?(?:ms|s|min|minutes|seconds|GB|MB|mm|%|deg)(?!\w)|\d\.\d\d")
COMMAND = re.compile(r"`([^`\n]*(?:explica \w|\.py|\.sh|Benchmark|ctest|--[a-z])[^`\n]*)`|^    (explica .*)$", re.M)


def measured(page):
    """Line number, heading, commands of the section, and line, of every line with a number that was measured."""
    text = page.read_text()
    if text.startswith("<!-- Written by"):
        return
    number = 1
    for section in re.split(r"^(?=#{1,3} )", text, flags=re.M):
        commands = ["".join(found) for found in COMMAND.findall(section)]
        heading = section.partition("\n")[0].lstrip("# ")
        for line in section.splitlines():
            if NUMBER.search(line) and not line.startswith("| `--"):
                yield number, heading, commands, line
            number += 1


def main():
    seed, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 20
    lines = [(page, *found) for pattern in PAGES for page in sorted(ROOT.glob(pattern)) for found in measured(page)]
    print(f"{count} of {len(lines)} lines, seed {seed}")
    for page, number, heading, commands, line in random.Random(seed).sample(lines, count):
        print(f"\n{page.relative_to(ROOT)}:{number}, {heading}\n  {line}")
        print("".join(f"    {command}\n" for command in commands[:6]), end="")


if __name__ == "__main__":
    main()
