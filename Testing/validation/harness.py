# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What every measurement of validate.py shares: running explica, and the numbers that result."""

import csv
import json
import pathlib
import shlex
import subprocess
import time
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data"


class NoRealData(Exception):
    """The real data of a measurement are not on this machine."""


@dataclass
class Measured:
    """One number of the page: what was measured on what, and how far it may be off next time."""
    what: str
    on: str
    value: float
    unit: str
    tolerance: float  # absolute, in the number's unit
    command: str


def real(*parts):
    """A file of the real data."""
    path = DATA.joinpath(*parts)
    if not path.exists():
        raise NoRealData(str(path))
    return path


class Explica:
    """Runs the program below a scratch folder; its commands are written on the page."""

    def __init__(self, program, folder):
        self.program, self.folder = str(program), pathlib.Path(folder)

    def __call__(self, *words, out, done=(0,)):
        """Runs one command into out (once), returns its folder; done: exit codes that are results."""
        folder = self.folder / out
        if (folder / "summary.json").exists():
            return Result(folder, *json.loads((folder / "how.json").read_text()))
        words = [str(word) for word in words]
        start = time.monotonic()
        code = subprocess.run([self.program, *words, "--out", str(folder), "--quiet", "--force"],
                              stderr=subprocess.PIPE, text=True, check=False)
        seconds = time.monotonic() - start
        if code.returncode not in done:
            raise RuntimeError(f"{shlex.join(words)}: exit {code.returncode}: {code.stderr}")
        shown = shlex.join(word.replace(str(DATA) + "/", "").replace(str(self.folder) + "/", "")
                           for word in words)
        how = ("explica " + shown, seconds)
        (folder / "how.json").write_text(json.dumps(how))
        return Result(folder, *how)


class Result:
    """The folder that a command wrote."""

    def __init__(self, folder, command, seconds):
        self.folder, self.command, self.seconds = folder, command, seconds
        self.summary = json.loads((folder / "summary.json").read_text())

    def __truediv__(self, name):
        return self.folder / name

    def step(self, name):
        """One step of a run, as the command of its own that it is."""
        return Result(self.folder / name, self.command, self.seconds)

    def table(self, name):
        with (self.folder / name).open(encoding="utf-8", newline="") as lines:
            return list(csv.DictReader(lines, delimiter="\t"))
