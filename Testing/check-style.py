# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What the sources promise their readers, as far as a script can tell:

- a constant of a module's sources says what it is, in which unit and why so large, on its line or in a sentence
  above it (which may stand above several);
- constants of equal value and explanation stand once;
- no function is longer than 100 lines, the `run` of a command not longer than 60; the median body, headers
  included, has at most 8;
- no loop runs over a part of what a call has just handed out in a container: that is gone before the first turn;
- names in the unnamed namespaces of one module differ, since a build compiles several of its sources at once.

    check-style.py [--lengths]      with --lengths: the longest functions, too"""

import collections
import pathlib
import re
import statistics
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
LONGEST, LONGEST_RUN, MEDIAN = 100, 60, 8  # lines

CONSTANT = re.compile(r"(?:static |inline )*constexpr [^=({]*?\b(k[A-Z]\w*)")


# for (x : call(...).front().part): the call's container ends with the line, before the loop.
DANGLING = re.compile(r"\bfor \([^;]* : [^;{]*\w\([^;{]*\)\.(front|back|at|value)\(")


def sources(*patterns: str) -> list[pathlib.Path]:
    return sorted(path for pattern in patterns for path in ROOT.glob(pattern))


def explained(lines: list[str], at: int) -> bool:
    """Whether the constant that begins at a line, or the block of constants it stands in, has a comment."""
    end = at
    while ";" not in lines[end] and end + 1 < len(lines):
        end += 1
    if any("//" in line for line in lines[at:end + 1]):
        return True
    above = at
    while above > 0 and (CONSTANT.match(lines[above - 1]) or lines[above - 1].startswith("  ")):
        above -= 1
    return lines[above - 1].startswith("//")


def unexplained(path: pathlib.Path) -> list[str]:
    lines = path.read_text().split("\n")
    return [f"{path.relative_to(ROOT)}:{n + 1}: {match[1]} says neither unit nor reason"
            for n, line in enumerate(lines)
            if (match := CONSTANT.match(line)) and not explained(lines, n)]


def stated_twice() -> list[str]:
    """Constants that several files define with the same value for the same reason; how much a task takes is each loop's."""
    stated = collections.defaultdict(list)
    for path in sources("Modules/*/src/**/*.cpp", "Modules/*/src/**/*.h", "Modules/*/include/**/*.h",
                        "Applications/**/*.cpp", "Applications/**/*.h", "Wrapping/Python/src/*.cpp"):
        lines = path.read_text().split("\n")
        for n, line in enumerate(lines):
            match = re.search(r"constexpr [^=({]*?\bk[A-Z]\w*\s*=\s*([^;]+);\s*(?:///?<?\s*(.*))?$", line)
            if not match:
                continue
            reason = match[2] or (lines[n - 1].strip().lstrip("/ ") if lines[n - 1].strip().startswith("//") else "")
            if len(reason.split()) >= 3 and not reason.endswith("a task"):
                stated[match[1].rstrip("Ff"), reason].append(f"{path.relative_to(ROOT)}:{n + 1}")
    return [f"{' and '.join(where)} state the same constant: give it one home" for where in stated.values()
            if len({place.split(":")[0] for place in where}) > 1]


def dangling(path: pathlib.Path) -> list[str]:
    return [f"{path.relative_to(ROOT)}:{n + 1}: loops over a part of what is gone: name the container first"
            for n, line in enumerate(path.read_text().split("\n")) if DANGLING.search(line)]


def functions(path: pathlib.Path) -> list[tuple[int, int, str]]:
    """Lines, lines of the body and first line of each function: formatted sources close it as far left as it began."""
    found = []
    begin = {"": None, "  ": None}  # in a namespace, in a class: first line and line of the opening brace
    for n, line in enumerate(path.read_text().split("\n")):
        for indent, now in begin.items():
            inside = indent == "" or begin[""] and re.match(r"(struct|class|template)\b", begin[""][2])
            if now is None and inside and re.match(indent + r"[A-Za-z\[~]", line):
                now = [n, None, line.strip()]
            if now is None:
                continue
            if now[1] is None and line.endswith("{"):
                now[1] = n
            if now[1] == n - 1 and line.startswith(indent + "  static const "):
                begin[indent] = None  # a table with a function around it
                continue
            if line == indent + "}" and now[1] is not None:
                found.append((n - now[0] + 1, n - now[1] - 1, now[2]))
            if now[0] == n and indent and re.search(r"\)( const| override| noexcept)* \{ .* \}$", line):
                found.append((1, 1, now[2]))
            left = line.startswith(indent) and line[len(indent):len(indent) + 1] not in (" ", "")
            ends = line.startswith((indent + "}", "}")) or line.endswith("}") or line.endswith(";")
            begins_space = re.match(r"(inline )?(namespace|extern)\b.*\{$", line)
            begin[indent] = None if left and (ends or begins_space) else now
    return found


def without_texts(source: str) -> str:
    """The source without comments and with empty literals, so that its braces can be counted."""
    source = re.sub(r'R"(\w*)\(.*?\)\1"', '""', source, flags=re.S)
    source = re.sub(r'//[^\n]*|/\*.*?\*/', "", source, flags=re.S)
    return re.sub(r"""'(\\.|[^'\\\w]|\w)'|"(\\.|[^"\\\n])*\"""", '""', source)


def hidden_names(path: pathlib.Path) -> set[str]:
    """Types, constants and functions (with the types of their arguments) of a file's unnamed namespaces."""
    text = without_texts(path.read_text())
    names = set()
    for space in re.finditer(r"\bnamespace\s*\{", text):
        depth, at, outer = 1, space.end(), []
        while depth and at < len(text):
            depth += {"{": 1, "}": -1}.get(text[at], 0)
            if depth == 1 or (depth == 2 and text[at] == "{"):
                outer.append(text[at])
            at += 1
        outer = "".join(outer)
        names |= set(re.findall(r"\b(?:struct|class|enum class)\s+(\w+)\s*(?:\{|:(?!:)|final)", outer))
        names |= set(re.findall(r"\b(k[A-Z]\w*)\b\s*(?:\[[^\]]*\])?\s*(?:=|\{)", outer))
        for name, arguments in re.findall(r"[\w&*>] +(\w+)\(([^;{}()]*)\)\s*(?:const)?\s*[{;]", outer):
            types = [re.sub(r"\s*\b\w+\s*$", "", argument) for argument in arguments.split(",")]
            names.add(f"{name}({', '.join(' '.join(t.split()) for t in types)})")
    return names


def repeated_names() -> list[str]:
    faults = []
    for module in sources("Modules/*/src"):
        files = collections.defaultdict(list)
        for path in sorted(module.rglob("*.cpp")):
            for name in hidden_names(path):
                files[name].append(path.name)
        faults += [f"{module.relative_to(ROOT)}: {name} stands in {' and '.join(where)}: give them names of their own "
                   "or one home" for name, where in sorted(files.items()) if len(where) > 1]
    return faults


def main() -> int:
    faults = [fault for path in sources("Modules/*/src/**/*.cpp", "Modules/*/src/**/*.h")
              for fault in unexplained(path)]
    faults += [fault for root in ("Modules", "Applications", "Wrapping", "Testing")
               for path in sources(f"{root}/**/*.cpp", f"{root}/**/*.h") for fault in dangling(path)]
    faults += repeated_names() + stated_twice()
    lengths = []
    bodies = []
    for path in sources("Modules/*/src/**/*.cpp", "Modules/*/src/**/*.h", "Modules/*/include/**/*.h",
                        "Applications/**/*.cpp", "Applications/**/*.h", "Wrapping/Python/src/*.cpp"):
        for length, body, first in functions(path):
            lengths.append((length, path, first))
            bodies.append(body)
            command = path.is_relative_to(ROOT / "Applications") and re.match(r"Termination run\(", first)
            limit = LONGEST_RUN if command else LONGEST
            if length > limit:
                faults.append(f"{path.relative_to(ROOT)}: {length} lines, more than {limit}: {first}")
    median = statistics.median(bodies)
    if median > MEDIAN:
        faults.append(f"the median body has {median:g} lines, more than {MEDIAN}")
    if "--lengths" in sys.argv:
        for length, path, first in sorted(lengths, key=lambda entry: -entry[0])[:15]:
            print(f"{length:4d}  {path.relative_to(ROOT)}: {first}")
    print(f"{len(lengths)} functions, median body {median:g} lines, longest {max(lengths)[0]}")
    print("\n".join(faults) if faults else "every constant says what it is")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
