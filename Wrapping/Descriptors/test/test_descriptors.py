# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The descriptions agree with the commands, and the tools that they are for can use them."""

import json
import os
import pathlib
import pty
import re
import select
import shlex
import shutil
import subprocess
import tempfile
import time
import unittest


HERE = pathlib.Path(__file__).resolve().parent
FOLDER = pathlib.Path(os.environ["EXPLICA_DESCRIPTORS"])
EXECUTABLE = pathlib.Path(os.environ["EXPLICA_EXECUTABLE"])


def declarations():
    return json.loads(subprocess.check_output([EXECUTABLE, "--describe"]))


def file_name(command):
    return "explica-" + command["command"].replace(" ", "-")


def samples():
    """What each format says of one small command, by file name."""

    def part(file, begin, end):
        text = (FOLDER / file).read_text()
        start = text.index(begin)
        return text[start : text.index(end, start) + len(end)]

    name = "explica-phantom-shell"
    return {
        f"{name}.1": (FOLDER / "man" / f"{name}.1").read_text(),
        f"{name}.bash": part("completion/explica.bash", "    'phantom shell')\n", "\n      ;;\n"),
        f"{name}.zsh": part("completion/_explica", "  'phantom shell')\n", "\n    ;;\n"),
    }


class Golden(unittest.TestCase):
    def test_formats_are_what_they_were(self):
        """If a difference is meant: Testing/update-pages.sh keeps the new samples."""
        folder = HERE / "golden"
        made = samples()
        if "EXPLICA_UPDATE_PAGES" in os.environ:
            for name, text in made.items():
                (folder / name).write_text(text)
        self.assertEqual({f.name for f in folder.iterdir()}, set(made))
        for name, text in made.items():
            kept = (folder / name).read_text()
            self.assertEqual(kept.splitlines(), text.splitlines(), f"{name}: Testing/update-pages.sh")


class Shell:
    """An interactive shell in a terminal, with `explica` replaced by what prints its arguments."""

    def __init__(self, words, setup):
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.environ.update(TERM="dumb", PS1="> ", HOME="/nonexistent", INPUTRC="/dev/null")
            os.execvp(words[0], words)
        self.say(setup + "; echo rea''dy\n")
        self.hear("ready")

    def say(self, text):
        os.write(self.terminal, text.encode())

    def hear(self, pattern, seconds=20):
        """What the shell has said, once it matches."""
        heard, end = "", time.monotonic() + seconds
        while time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.1)[0]:
                heard += os.read(self.terminal, 65536).decode(errors="replace")
            found = re.search(pattern, heard)
            if found:
                return found
        raise AssertionError(f"waited for {pattern!r}, heard {heard!r}")

    def complete(self, typed):
        """The arguments that `explica` gets when the last word is completed with the tabulator."""
        self.say(f"explica {typed}\t\n")
        return self.hear(r"GOT<(.*?)>")[1].split()

    def close(self):
        self.say("\x15exit\n")
        os.close(self.terminal)
        os.waitpid(self.pid, 0)


class Completion(unittest.TestCase):
    ECHO = 'explica() { printf "GO%s<%s>\\n" T "$*"; }'

    def check(self, shell):
        try:
            self.assertEqual(shell.complete("thick"), ["thickness"])
            self.assertEqual(shell.complete("phantom ecc"), ["phantom", "eccentric"])
            self.assertEqual(shell.complete("phantom shell --asp")[-1], "--aspect")
            self.assertEqual(shell.complete("thickness --method lagr")[-1], "lagrangian")
            self.assertEqual(shell.complete("surface --gen")[-1], "--genus")
            self.assertEqual(shell.complete("study part"), ["study", "participant"])
            self.assertEqual(shell.complete("study participant --participant")[-1], "--participant-label")
        finally:
            shell.close()

    def test_bash(self):
        script = FOLDER / "completion" / "explica.bash"
        self.check(Shell(["bash", "--norc", "--noprofile", "-i"], f"source {script}; {self.ECHO}"))

    @unittest.skipUnless(shutil.which("zsh"), "skipped: zsh is not installed")
    def test_zsh(self):
        folder = FOLDER / "completion"
        setup = f"fpath=({folder} $fpath); autoload -Uz compinit; compinit -D -u; {self.ECHO}"
        self.check(Shell(["zsh", "-f", "-i"], setup))

    def test_every_verb_is_offered(self):
        script = (
            f"source {FOLDER}/completion/explica.bash; COMP_WORDS=(explica ''); COMP_CWORD=1;"
            "_explica; echo ${COMPREPLY[@]}"
        )
        offered = subprocess.check_output(["bash", "-c", script], text=True).split()
        self.assertEqual(set(offered), {c["command"].split()[0] for c in declarations()})


    def offered(self, *words, folder="."):
        """What bash would offer for the last word, in its order."""
        script = (
            f"source {FOLDER}/completion/explica.bash; COMP_WORDS=({shlex.join(words)});"
            f"COMP_CWORD={len(words) - 1}; _explica; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        )
        return subprocess.check_output(["bash", "-c", script], text=True, cwd=folder).split("\n")[:-1]

    def test_commands_and_options_come_before_folders(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("thickness", "a folder"):
                (pathlib.Path(folder) / name).mkdir()
            verbs = self.offered("explica", "", folder=folder)
            self.assertNotIn("a folder", verbs)
            first = self.offered("explica", "unfold", "", folder=folder)
            self.assertEqual(set(first[-2:]), {"a folder", "thickness"})
            shown = [p for c in declarations() if c["command"] == "unfold" for p in c["parameters"]]
            shown = {"--" + p["name"] for p in shown if p["first"] and not p["positional"]}
            self.assertEqual(set(first[:-2]), shown)
            self.assertIn("a folder", self.offered("explica", "unfold", "x", "--label", "", folder=folder))
            self.assertEqual(self.offered("explica", "unfold", "x", "--radius", "", folder=folder), [""])
            self.assertEqual(
                self.offered("explica", "unfold", "x", "--out", "a", folder=folder), ["a folder"]
            )


class ManualPages(unittest.TestCase):
    def test_every_option_is_named(self):
        for command in declarations():
            page = (FOLDER / "man" / (file_name(command) + ".1")).read_text().replace("\\-", "-")
            for p in command["parameters"]:
                self.assertIn(p["name"], page)
            self.assertTrue(re.match(r"\.TH EXPLICA", page))

    @unittest.skipUnless(shutil.which("mandoc"), "skipped: mandoc is not installed")
    def test_mandoc_finds_no_fault(self):
        pages = sorted(str(page) for page in (FOLDER / "man").glob("*.1"))
        done = subprocess.run(
            ["mandoc", "-T", "lint", "-W", "warning", *pages], stdout=subprocess.PIPE, text=True
        )
        # Pages have no date: the same sources give the same bytes on every day.
        faults = [line for line in done.stdout.splitlines() if "missing date" not in line]
        self.assertEqual(faults, [])

    @unittest.skipUnless(shutil.which("man"), "skipped: man is not installed")
    def test_man_formats_every_page_without_warning(self):
        for page in (FOLDER / "man").glob("*.1"):
            done = subprocess.run(
                ["man", "--warnings", "-E", "UTF-8", "-l", str(page)], stdout=subprocess.PIPE,
                stderr=subprocess.PIPE, text=True,
                env=dict(os.environ, LC_ALL="C.UTF-8", MANPAGER="cat", MANWIDTH="80"),
            )  # fmt: skip
            self.assertEqual((done.returncode, done.stderr), (0, ""), page.name)
            self.assertIn("SYNOPSIS", done.stdout)


class StudySchema(unittest.TestCase):
    def test_it_takes_the_example_and_refuses_what_the_command_refuses(self):
        import jsonschema
        import yaml

        schema = json.loads((FOLDER / "study.schema.json").read_text())
        jsonschema.Draft7Validator.check_schema(schema)
        example = pathlib.Path(__file__).parents[3] / "ExampleData/study/study.yaml"
        study = yaml.safe_load(example.read_text())
        jsonschema.validate(study, schema, cls=jsonschema.Draft7Validator)
        study["parameters"]["unfold"]["max-iteration"] = 2
        with self.assertRaises(jsonschema.ValidationError):
            jsonschema.validate(study, schema, cls=jsonschema.Draft7Validator)

    def test_it_holds_every_option_of_run_that_a_study_may_set(self):
        schema = json.loads((FOLDER / "study.schema.json").read_text())
        known = set(schema["properties"]["parameters"]["properties"])
        run = next(c for c in declarations() if c["command"] == "run")
        common = {"out", "force", "config", "threads", "dry-run", "quiet", "verbose", "log", "private",
                  "max-time", "max-memory", "report"}
        options = {p["name"] for p in run["parameters"] if not p["positional"]} - common
        self.assertEqual(options - known, {"atlas", "hemisphere", "resume"})


if __name__ == "__main__":
    unittest.main()
