# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The stubs agree with the module; type checkers accept what is right and refuse what is wrong."""

import importlib.util
import inspect
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import explica

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = pathlib.Path(explica.__file__).parent
HAS_MYPY = importlib.util.find_spec("mypy") is not None


def mypy(*words, folder):
    """Runs mypy with a copy of what the package has for type checkers."""
    types = pathlib.Path(folder) / "types" / "explica"
    if not types.exists():
        types.mkdir(parents=True)
        for file in [*PACKAGE.glob("*.pyi"), PACKAGE / "types.py", PACKAGE / "py.typed"]:
            shutil.copy(file, types)
    return subprocess.run(
        [sys.executable, "-m", *words], cwd=folder, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, env=dict(os.environ, MYPYPATH=str(types.parent)),
    )  # fmt: skip


class Stubs(unittest.TestCase):
    def test_stub_of_a_small_module_is_what_it_was(self):
        """If a difference is meant: Testing/update-pages.sh keeps the new sample."""
        kept = HERE / "golden" / "provenance.pyi"
        made = (PACKAGE / "provenance.pyi").read_text()
        if "EXPLICA_UPDATE_PAGES" in os.environ:
            kept.write_text(made)
        self.assertEqual(kept.read_text(), made, "Testing/update-pages.sh")

    def test_every_public_module_has_its_stub(self):
        modules = {n for n in explica.__all__ if inspect.ismodule(getattr(explica, n))}
        names = {file.stem for file in PACKAGE.glob("*.pyi")}
        self.assertEqual(names, (modules - {"types"}) | {"__init__"})

    def test_every_public_function_says_what_it_does(self):
        for module in (explica, *(getattr(explica, n) for n in explica.__all__)):
            if not inspect.ismodule(module) or module is explica.types:
                continue
            for name in module.__all__:
                value = getattr(module, name)
                with self.subTest(name=f"{module.__name__}.{name}"):
                    self.assertTrue(value.__doc__ or issubclass(value, Exception))

    def test_keywords_stand_in_signatures(self):
        signature = inspect.signature(explica.unfold)
        self.assertEqual(list(signature.parameters)[:3], ["surface", "region", "viewpoints"])
        self.assertEqual(signature.parameters["max_iterations"].default, 500)
        self.assertIn("max_iterations : integer = 500", explica.unfold.__doc__)

    @unittest.skipUnless(HAS_MYPY, "skipped: mypy is not installed")
    def test_mypy_finds_stubs_and_runtime_equal(self):
        with tempfile.TemporaryDirectory() as folder:
            # Stubs cannot name pybind11's metaclass; mypy 1.0 takes Protocol for a variable.
            allowed = pathlib.Path(folder) / "allowed"
            classes = ("Unfolder", "Viewpoints", "types.Protocol")
            allowed.write_text("".join(f"explica.{name}\n" for name in classes))
            done = mypy("mypy.stubtest", "explica", "--ignore-missing-stub", "--allowlist",
                        str(allowed), folder=folder)  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stdout)

    @unittest.skipUnless(HAS_MYPY, "skipped: mypy is not installed")
    def test_mypy_accepts_the_examples_and_refuses_mistakes(self):
        with tempfile.TemporaryDirectory() as folder:
            mistakes = pathlib.Path(folder) / "mistakes.py"
            mistakes.write_text(
                "import explica\n"
                "explica.unfold('a.surf.gii', [1], [0, 0, 9], max_iteration=3)\n"
                "explica.thickness([[1]], method='fast')\n"
                "x: str = explica.enclosed_volume('a.surf.gii')\n"
            )
            done = mypy("mypy", "--ignore-missing-imports", str(mistakes), folder=folder)
            for line in (2, 3, 4):
                self.assertIn(f"mistakes.py:{line}: error", done.stdout)
            examples = sorted(str(file) for file in (HERE.parent / "examples").glob("*.py"))
            self.assertGreater(len(examples), 0)
            for example in examples:
                done = mypy("mypy", "--ignore-missing-imports", example, folder=folder)
                self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    unittest.main()
