#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Table of the tests' times for Testing/README.md, of a whole run:

    ctest --test-dir build -j2 --output-junit times.xml
    Testing/test-times.py build            prints it
    Testing/test-times.py build --write    puts it into the page, below the heading "Times"
"""

import argparse
import collections
import json
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree as xml
from dataclasses import dataclass

PAGE = pathlib.Path(__file__).resolve().parent / "README.md"
BEGIN, END = "<!-- test-times.py -->", "<!-- end -->"
LONGEST = 5  # tests that are named


@dataclass
class Test:
    name: str
    label: str
    state: str
    seconds: float


def plain(name):
    """A test's name without the value of its parameter, which may hold addresses of one build."""
    return name.split("  # GetParam")[0]


def labels_of(build):
    """Each test's first label, as CTest tells them."""
    told = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], check=True, capture_output=True)
    labels = {}
    for test in json.loads(told.stdout)["tests"]:
        given = [p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"]
        labels[plain(test["name"])] = given[0][0] if given else "none"
    return labels


def read(build):
    """The tests of the run, its seconds by the clock and its day."""
    suite = xml.parse(build / "times.xml").getroot()
    labels = labels_of(build)
    tests = [Test(name, labels[name], case.get("status"), float(case.get("time")))
             for case in suite.iter("testcase") for name in [plain(case.get("name"))]]
    return tests, float(suite.get("time")), suite.get("timestamp")[:10]


def text(tests, wall, day):
    count, seconds = collections.Counter(), collections.Counter()
    for test in tests:
        count[test.label] += 1
        seconds[test.label] += test.seconds
    states = collections.Counter(test.state for test in tests)
    rows = [f"| `{label}` | {count[label]:,} | {seconds[label]:,.0f} |" for label in sorted(count)]
    rows.append(f"| all | {len(tests):,} | {sum(seconds.values()):,.0f}, {wall / 60:.0f} minutes by the clock |")
    longest = sorted(tests, key=lambda test: -test.seconds)[:LONGEST]
    named = ", ".join(f"`{test.name}` {test.seconds:.0f} s" for test in longest)
    quick = sum(test.seconds < 1 for test in tests)
    missed = states["notrun"] + states["disabled"]
    return "\n".join([f"Run of {day}: {states['run']:,} tests passed, {states['fail']} failed, {missed} skipped.", "",
                      "| label | tests | seconds, summed over tests |", "|---|---|---|", *rows, "",
                      f"The longest: {named}; {quick:,} take less than a second."])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    words = parser.parse_args()
    made = text(*read(words.build))
    if not words.write:
        print(made)
        return 0
    page = PAGE.read_text(encoding="utf-8")
    written, places = re.subn(f"(?s){BEGIN}.*?{END}", lambda _: f"{BEGIN}\n{made}\n{END}", page)
    if places != 1:
        sys.exit(f"{PAGE} has {places} places between {BEGIN} and {END}, expected one")
    PAGE.write_text(written, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
