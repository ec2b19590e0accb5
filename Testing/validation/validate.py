# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Measures again what "How right is it?" (README.md beside this file) states.

    validate.py EXPLICA                 fails where a number is off by more than its tolerance
    validate.py EXPLICA --write         writes the page and its figures anew
    validate.py EXPLICA --only WORD     only the sections whose title holds the word
    validate.py EXPLICA --no-times      times are not judged: the machine has other work
"""

import argparse
import pathlib
import re
import sys
import tempfile

import measures
from harness import Explica, NoRealData

PAGE = pathlib.Path(__file__).resolve().parent / "README.md"
MARK = re.compile(r"<!-- measured: (.*?) -->\n(.*?)<!-- end -->", re.S)


def digits(value):
    """A number as the page shows it: whole ones in full, else three significant digits."""
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e6 else f"{value:.3g}"


def table(rows):
    lines = ["| on | what | value | may differ by | command |", "|---|---|---|---|---|"]
    before = ""
    for row in rows:
        unit = f" {row.unit}" if row.unit else ""
        lines.append(f"| {row.on} | {row.what} | {digits(row.value)}{unit} | "
                     f"{row.tolerance:.2g}{unit} | "
                     + (f"`{row.command}` |" if row.command != before else "as above |"))
        before = row.command
    return "\n".join(lines) + "\n"


def stated(block):
    """(on, what) -> value and tolerance of a table of the page."""
    found = {}
    for line in block.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) >= 4 and re.match(r"^[-+]?[0-9]", cells[2]):
            found[cells[0], cells[1]] = (float(cells[2].split()[0]), float(cells[3].split()[0]))
    return found


def compare(title, rows, block, times):
    """Sentences on what differs between the page and the measurement; of seconds if `times`."""
    page = stated(block)
    measured = {(row.on, row.what): row for row in rows}
    faults = [f"{title}: the page has no row '{what}' of {on}" for on, what in measured
              if (on, what) not in page]
    faults += [f"{title}: nothing measures '{what}' of {on}" for on, what in page
               if (on, what) not in measured]
    for key, row in measured.items():
        if key not in page or (row.unit == "s" and not times):
            continue
        value, tolerance = page[key]
        # What the page rounds away is no difference.
        if abs(row.value - value) > tolerance + 0.006 * abs(value):
            faults.append(f"{title}: {row.what} of {row.on} is {digits(row.value)}, the page says "
                          f"{digits(value)} +- {tolerance:g}")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("explica", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--no-times", dest="times", action="store_false")
    parser.add_argument("--work", type=pathlib.Path, help="folder for results, kept for a next run")
    words = parser.parse_args()
    chosen = [(title, measure) for title, measure in measures.ALL if words.only.lower() in title.lower()]
    if not chosen:
        parser.error(f"--only {words.only}: no section of the page has it in its title; there are "
                     + "; ".join(title for title, _ in measures.ALL))
    page = PAGE.read_text(encoding="utf-8")
    blocks = dict(MARK.findall(page))
    faults, skipped = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = words.work or pathlib.Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        explica = Explica(words.explica.resolve(), folder.resolve())
        figures = PAGE.parent if words.write else folder
        for title, measure in chosen:
            try:
                rows = measure(explica, figures)
            except NoRealData as missing:
                skipped += 1
                print(f"{title}: skipped: no real data ({missing})")
                continue
            if words.write:
                start = page.index(f"<!-- measured: {title} -->\n")
                end = page.index("<!-- end -->", start)
                start = page.index("\n", start) + 1
                page = page[:start] + table(rows) + page[end:]
            else:
                found = compare(title, rows, blocks.get(title, ""), words.times)
                faults += found
                print(f"{title}: {len(rows)} numbers, {len(found)} differ")
    if words.write:
        PAGE.write_text(page, encoding="utf-8")
    for fault in faults:
        print(fault)
    return 1 if faults or (skipped == len(chosen)) else 0


sys.exit(main())
