#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What pages name to be run must exist: numbers on a page are worth the command that gives them.

    Testing/check-pages.py [EXPLICA]

Of every README.md: scripts and files of the repository, test programs and benchmarks (as CMake makes
them), tests named after `ctest -R` or a gtest filter, and, with the program given, commands and
options of `explica`.  Pages written from the declarations (Applications/NAME/README.md) are tested
by ReferencePages.  A section with three measured numbers or more (times, memory, shares, errors) must
name a test, a script, a benchmark or a command that gives such numbers.
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
ROOTS = ("Testing", "ExampleData", "Modules", "Applications", "Wrapping")
SOURCES = [p for root in ROOTS for p in (ROOT / root).rglob("*") if p.is_file()]


def codes(text):
    """Words in code: of blocks line by line, and of spans."""
    for block in re.findall(r"^```\w*\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        yield from block.replace("\\\n", " ").splitlines()
    yield from re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE))


def programs():
    """Test programs and benchmarks that CMake makes."""
    made = set()
    for path in SOURCES:
        if path.name != "CMakeLists.txt":
            continue
        text = path.read_text()
        for module, body in re.findall(r"explica_add_module\((\w+)(.*)", text, re.DOTALL):
            made.update(f"Explica{module}{kind}Tests" for kind in ("Unit", "Property", "Slow"))
            made.update(f"Explica{module}{name}" for name in
                        re.findall(r"benchmark/(\w+Benchmark)\.cpp", body))
        made.update(re.findall(r"explica_add_(?:test_executable|command_tests)\((\w+)", text))
    return made


def tests():
    """Names of suites and tests, of ctest's own ones, and of parameters."""
    names = []
    for path in SOURCES:
        if path.suffix == ".cpp" and path.name.endswith("Test.cpp"):
            text = path.read_text()
            for suite, test in re.findall(r"TEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)", text):
                names.append(f"{suite}.{test}")
            names += re.findall(r"INSTANTIATE_TEST_SUITE_P\(\s*(\w+)", text)
            names += re.findall(r'\{"(\w+)"', text)
        elif path.name == "CMakeLists.txt":
            names += re.findall(r"add_test\(NAME ([\w.${}]+)", path.read_text())
    names += [f"Python.{path.stem}" for path in SOURCES if path.name.startswith("test_")]
    return names


def described(program):
    """Options by command."""
    said = json.loads(subprocess.run([program, "--describe"], check=True, capture_output=True,
                                     text=True).stdout)
    commands = said["commands"] if isinstance(said, dict) else said
    common = {"--help", "--help-all", "--version", "--out", "--force", "--threads", "--quiet",
              "--verbose", "--log", "--dry-run", "--config", "--report", "--private", "--max-time",
              "--max-memory", "--describe", "--xml"}
    return {c["command"]: common | {f"--{p['name']}" for p in c["parameters"]} for c in commands}


def files_missing(words):
    """Paths of the repository that are named and not there."""
    for word in re.split(r"[\s'\"(),;]+", words):
        word = word.removeprefix("./").rstrip(".:")
        if not word.startswith(tuple(f"{root}/" for root in ROOTS)):
            continue
        if any(c in word for c in "*<>$[{") or (ROOT / word).exists():
            continue
        yield f"{word}: is not there"


def tests_missing(words, known):
    """Programs and filters that name nothing."""
    made, named = known
    for program in re.findall(r"\b(Explica\w+(?:Tests|Benchmark))\b", words):
        if program not in made:
            yield f"{program}: nothing makes it"
    for pattern in re.findall(r"(?:-R |--gtest_filter=)'?\"?([^\s'\"`]+)", words):
        gtest = "--gtest_filter" in words
        expression = (re.escape(pattern).replace(r"\*", ".*").replace(":", "|") if gtest else pattern)
        if "$" in pattern or "NAME" in pattern:
            continue
        if not any(re.search(expression, name) for name in named):
            yield f"no test is called {pattern}"


def options_missing(words, options):
    """Commands and options of the program that it does not have."""
    if "..." in words:
        return
    for line in re.split(r"\s(?:&&|\||;)\s", words):
        call = re.match(r"(?:\$?\S*/)?explica ((?:phantom )?[a-z]+)(?= |$)(.*)", line.strip())
        if not call:
            continue
        command = call[1]
        if command not in options:
            if not any(name.split()[0] == command for name in options):
                yield f"explica {command}: no such command"
            continue
        for option in re.findall(r"(?<=\s)--[a-z][\w.-]*", call[2]):
            if option not in options[command]:
                yield f"explica {command} has no {option}"


MEASURED = re.compile(r"\d(?:\.\d+)?\s?(?:ms|s|min|minutes|seconds|GB|MB|%)(?!\w)|\d\.?\d*e-\d")
GIVES = re.compile(r"\.(?:sh|py)\b|Benchmark|\bexplica \w|\b(?:c?test|ninja|cmake) |--benchmark|Tests?\b")


def numbers_without_source(text, suites):
    """Headings of sections whose numbers nothing that is kept gives; ranges of options are no measurements."""
    for section in re.split(r"^(?=#{1,3} )", re.sub(r"^\| `--.*", "", text, flags=re.MULTILINE), flags=re.MULTILINE):
        words = list(codes(section)) + re.findall(r"\]\(([^)\s]+)", section)
        named = any(GIVES.search(w) or suites & set(re.findall(r"\w+", w)) for w in words)
        if len(MEASURED.findall(section)) >= 3 and not named:
            yield section.partition("\n")[0].lstrip("# ")


def main(program=None):
    known = programs(), tests()
    suites = {name.split(".")[0] for name in known[1] if "." in name}
    options = described(program) if program else {}
    wrong = []
    for page in [ROOT / "README.md", *sorted(p for p in SOURCES if p.name == "README.md")]:
        text = page.read_text()
        if "Written by `explica" in text:
            continue
        for words in codes(text):
            found = [*files_missing(words), *tests_missing(words, known)]
            if options:
                found += options_missing(words, options)
            wrong += [f"{page.relative_to(ROOT)}: {what}" for what in found]
        wrong += [f"{page.relative_to(ROOT)}: no command gives the numbers under '{heading}'"
                  for heading in numbers_without_source(text, suites)]
        for target in re.findall(r"\]\((?!https?:|#|mailto:)([^)#\s]+)", text):
            if not (page.parent / target).exists():
                wrong.append(f"{page.relative_to(ROOT)}: links to {target}, which is not there")
    for line in dict.fromkeys(wrong):
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
