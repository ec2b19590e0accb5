# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The installed package works by itself, and what pip would read is right."""

import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest

import explica

PYTHON = pathlib.Path(__file__).resolve().parents[1]
BUILD = pathlib.Path(os.environ["EXPLICA_BUILD"])


class Install(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.prefix = pathlib.Path(folder.name)
        subprocess.run(
            ["cmake", "--install", BUILD, "--component", "python", "--prefix", self.prefix],
            check=True, stdout=subprocess.DEVNULL,
        )  # fmt: skip
        self.package = self.prefix / "lib" / "python3" / "dist-packages" / "explica"

    def test_package_is_whole(self):
        sources = {f.name for f in (PYTHON / "explica").iterdir() if f.suffix != ".pyc" and f.is_file()}
        installed = {f.name for f in self.package.iterdir()}
        stubs = {f"{name.rpartition('.')[0]}.pyi" for name in sources if name[0] != "_"}
        stubs = (stubs - {"py.pyi", "types.pyi"}) | {"__init__.pyi"}
        (compiled,) = installed - sources - stubs
        self.assertTrue(compiled.startswith("_explica."))
        self.assertEqual(installed - {compiled}, sources | stubs)

    def test_wheel_is_made_and_installed_without_network(self):
        made = subprocess.run(
            [sys.executable, PYTHON / "tools" / "make_wheel.py", BUILD, self.prefix / "wheels"],
            check=True, capture_output=True, text=True,
        )  # fmt: skip
        wheel = pathlib.Path(made.stdout.strip())
        first = wheel.read_bytes()
        subprocess.run(
            [sys.executable, PYTHON / "tools" / "make_wheel.py", BUILD, self.prefix / "wheels"],
            check=True, stdout=subprocess.DEVNULL,
        )  # fmt: skip
        self.assertEqual(wheel.read_bytes(), first)
        target = self.prefix / "target"
        subprocess.run(
            [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps",
             "--disable-pip-version-check", "--root-user-action=ignore", "--target", target, wheel],
            check=True,
        )  # fmt: skip
        environment = {**os.environ, "PYTHONPATH": str(target)}
        said = subprocess.run(
            [sys.executable, "-c", "import explica; print(explica.__file__, explica.__version__)"],
            check=True, capture_output=True, text=True, env=environment,
        ).stdout.split()  # fmt: skip
        self.assertTrue(said[0].startswith(str(target)), said)
        self.assertIn(said[1], wheel.name)

    def test_installed_package_is_imported_and_works(self):
        program = (
            "import explica, pathlib; print(pathlib.Path(explica.__file__).parent);"
            "print(round(explica.enclosed_volume(explica.icosphere(5)), 1))"
        )
        environment = {k: v for k, v in os.environ.items() if k != "EXPLICA_EXECUTABLE"}
        environment["PYTHONPATH"] = str(self.package.parent)
        done = subprocess.check_output(
            [sys.executable, "-c", program], text=True, cwd=self.prefix, env=environment
        ).split()
        self.assertEqual(done, [str(self.package), "4.2"])

    def test_program_beside_it_is_found(self):
        program = self.prefix / "bin" / "explica"
        program.parent.mkdir()
        program.write_text("#!/bin/sh\n")
        environment = {k: v for k, v in os.environ.items() if k != "EXPLICA_EXECUTABLE"}
        environment["PYTHONPATH"] = str(self.package.parent)
        found = subprocess.check_output(
            [sys.executable, "-c", "import explica; print(explica.executable())"],
            text=True, cwd=self.prefix, env=environment,
        )  # fmt: skip
        self.assertEqual(found.strip(), str(program))


class Metadata(unittest.TestCase):
    def setUp(self):
        self.project = tomllib.loads((PYTHON / "pyproject.toml").read_text())

    def test_metadata_is_valid(self):
        from pyproject_metadata import StandardMetadata

        metadata = StandardMetadata.from_pyproject(self.project, project_dir=PYTHON)
        text = str(metadata.as_rfc822())
        self.assertIn("Name: explica", text)
        self.assertIn("Requires-Dist: numpy", text)

    def test_version_is_that_of_the_module(self):
        self.assertEqual(self.project["project"]["version"], explica.__version__)

    def test_settings_name_what_the_build_has(self):
        settings = self.project["tool"]["scikit-build"]
        root = PYTHON / settings["cmake"]["source-dir"]
        lists = (root / "CMakeLists.txt").read_text()
        lists += (PYTHON / "CMakeLists.txt").read_text()
        for option in settings["cmake"]["define"]:
            self.assertIn(option, lists)
        for target in settings["build"]["targets"]:
            self.assertIn(f"pybind11_add_module({target}", lists)
        for component in settings["install"]["components"]:
            self.assertIn(f"COMPONENT {component}", lists)


if __name__ == "__main__":
    unittest.main()
