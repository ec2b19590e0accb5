#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Holds the lists of packages (ExampleData/packages.txt, Testing/packages.txt, the Containerfile, and what libexplica-dev depends on) to what CMake looks for, and the versions to CMake's: a library that is found by a build but not listed
fails here, and so does one that is listed and not looked for.

    Testing/check-recipes.py
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]

# What CMake looks for: Debian's package.
LIBRARIES = {
    "Boost": "libboost-dev",
    "CLI11": "libcli11-dev",
    "EXPAT": "libexpat1-dev",
    "Eigen3": "libeigen3-dev",
    "HDF5": "libinsighttoolkit5-dev",  # Debian's ITK brings it
    "ISAL": "libisal-dev",
    "ITK": "libinsighttoolkit5-dev",
    "PNG": "libpng-dev",
    "OpenSSL": "libssl-dev",
    "Python": "python3-dev",
    "Qt5": "qtbase5-dev",
    "TBB": "libtbb-dev",
    "VTK": "libvtk9-dev",
    "X11": "libx11-dev",
    "ZLIB": "zlib1g-dev",
    "embree": "libembree-dev",
    "hwy": "libhwy-dev",
    "nlohmann_json": "nlohmann-json3-dev",
    "pybind11": "pybind11-dev",
    "valijson": "libvalijson-dev",
    "yaml-cpp": "libyaml-cpp-dev",
}
FOR_TESTS = {"Explica", "GTest", "benchmark", "Threads"}  # or of the compiler


def looked_for():
    found = set()
    for path in ROOT.glob("[AMTW]*/**/*"):
        if path.name != "CMakeLists.txt" and path.suffix != ".cmake":
            continue
        text = re.sub(r"#.*", "", path.read_text())
        found.update(re.findall(r"find_package\(\s*([\w-]+)", text))
        if "valijson/" in text:
            found.add("valijson")
    return found - FOR_TESTS


def debian_packages():
    lists = ("ExampleData/packages.txt", "Testing/packages.txt")
    lines = [line for name in lists for line in (ROOT / name).read_text().splitlines()]
    return {line.split("#")[0].strip() for line in lines} - {""}


def consumers_look_for():
    """Debian's packages of what the modules' FIND names: what find_package(Explica) looks for elsewhere."""
    names = set()
    for path in ROOT.glob("Modules/*/CMakeLists.txt"):
        for line in re.findall(r"^ *FIND (.*)$", path.read_text(), re.MULTILINE):
            names.update(word.split()[0] for word in re.findall(r'"([^"]+)"', line))
    return {LIBRARIES[name] for name in names}


def development_packages():
    text = (ROOT / "Modules/CMake/ExplicaPackage.cmake").read_text().replace("\\\n", "")
    return set(re.search(r'DEVELOPMENT_PACKAGE_DEPENDS "([^"]+)"', text)[1].split(", "))


def versions():
    """The version wherever it is written."""
    places = {
        "CMakeLists.txt": r"project\(\s*Explica\s+VERSION\s+([\d.]+)",
        "Wrapping/Python/pyproject.toml": r'\nversion = "([\d.]+)"',
        "CITATION.cff": r'\nversion: "?([\d.]+)"?',
    }
    for place, pattern in places.items():
        match = re.search(pattern, (ROOT / place).read_text())
        yield place, match[1] if match else "none"


def main():
    wrong = []
    found = looked_for()
    debian = debian_packages()
    for name in sorted(found | set(LIBRARIES)):
        if name not in LIBRARIES:
            wrong.append(f"CMake looks for {name}, which Testing/check-recipes.py does not know")
            continue
        if name not in found:
            wrong.append(f"nothing looks for {name} any more: take it off the lists")
        if LIBRARIES[name] not in debian:
            wrong.append(f"the lists of packages lack {LIBRARIES[name]} ({name})")
    needed, given = consumers_look_for(), development_packages()
    wrong += [f"ExplicaPackage.cmake: libexplica-dev does not depend on {p}" for p in sorted(needed - given)]
    wrong += [f"ExplicaPackage.cmake: no module's FIND needs {p}" for p in sorted(given - needed)]
    told = dict(versions())
    if len(set(told.values())) != 1:
        wrong.append(f"versions differ: {told}")
    container = (ROOT / "Wrapping/Container/Containerfile").read_text()
    for path in re.findall(r"^COPY (?!--from)(\S+) ", container, re.MULTILINE):
        if path != "." and not (ROOT / path).exists():
            wrong.append(f"Containerfile copies {path}, which is not there")
    for line in wrong:
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
