# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Whole commands, such as `explica run`, with their output folder, summary and record."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys

from . import _explica

# By exit code, as `explica --help` lists them; 3 is a result, not an error.
_ERRORS = {1: _explica.UsageError, 2: _explica.InvalidInput, 4: _explica.MachineError}


def executable() -> str:
    """The program `explica`: of EXPLICA_EXECUTABLE, beside this package's installation, or in PATH.

    Raises FileError if there is none.
    """
    named = os.environ.get("EXPLICA_EXECUTABLE")
    if named:
        return named
    for parent in pathlib.Path(__file__).resolve().parents[1:5]:
        beside = parent / "bin" / "explica"
        if beside.is_file():
            return str(beside)
    found = shutil.which("explica")
    if found is None:
        raise _explica.FileError("explica: the program was not found; name it in EXPLICA_EXECUTABLE")
    return found


def _words(options):
    """Options as words of a command line: max_iterations=5 becomes --max-iterations 5."""
    words = []
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("__", ".").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(flag)
        elif isinstance(value, (str, os.PathLike)) or not hasattr(value, "__iter__"):
            words += [flag, str(value)]
        elif all(isinstance(item, (str, os.PathLike)) for item in value):
            for item in value:
                words += [flag, str(item)]
        else:
            words += [flag, ",".join(str(item) for item in value)]
    return words


def command(
    name: str, *inputs: "Path", out: "Optional[Path]" = None, **options: "Any"
) -> "Dict[str, Any]":
    """Run `explica NAME INPUTS... --out OUT` with options as keywords, as on the command line.

    `max_iterations=5` is `--max-iterations 5`, and a double underscore stands for the dot of a
    step's option: `unfold__radius=20` is `--unfold.radius 20`.  Messages go to standard error
    (`quiet=True` silences them).  Ctrl-C stops the command at its next consistent state.

    Returns a dict: exit_code (0, or 3 if a goal or check was missed), and, with `out`, out,
    summary and provenance, the contents of summary.json and provenance.json.
    Raises UsageError, InvalidInput (unusable data or files) or MachineError, with the command's
    own sentence.
    """
    words = [executable(), *name.split(), *(os.fspath(path) for path in inputs)]
    if out is not None:
        words += ["--out", os.fspath(out)]
    said = []
    with subprocess.Popen([*words, *_words(options)], stderr=subprocess.PIPE, text=True) as process:
        try:
            for line in process.stderr:
                said.append(line.rstrip())
                if not options.get("quiet"):
                    print(said[-1], file=sys.stderr)
            code = process.wait()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            process.wait()
            raise
    if code not in (0, 3):
        sentences = [line for line in said if line.startswith("error")] or said[-1:]
        raise _ERRORS.get(code, _explica.Error)(" ".join(sentences) or f"exit code {code}")
    result = {"exit_code": code}
    if out is not None:
        folder = pathlib.Path(out)
        result["out"] = str(folder)
        for key in ("summary", "provenance"):
            file = folder / f"{key}.json"
            if file.is_file():
                result[key] = json.loads(file.read_text())
    return result
