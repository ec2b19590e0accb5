# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The descriptions agree with the commands, and the tools that they are for can use them."""

import importlib.util
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

import jsonschema

HERE = pathlib.Path(__file__).resolve().parent
FOLDER = pathlib.Path(os.environ["EXPLICA_DESCRIPTORS"])
EXECUTABLE = pathlib.Path(os.environ["EXPLICA_EXECUTABLE"])


def declarations():
    return json.loads(subprocess.check_output([EXECUTABLE, "--describe"]))


def file_name(command):
    return "explica-" + command["command"].replace(" ", "-")


def boutiques():
    """(declaration, descriptor) of every command."""
    for command in declarations():
        file = FOLDER / "boutiques" / (file_name(command) + ".json")
        yield command, json.loads(file.read_text())


def samples():
    """What each format says of one small command, by file name."""

    def part(file, begin, end):
        text = (FOLDER / file).read_text()
        start = text.index(begin)
        return text[start : text.index(end, start) + len(end)]

    name = "explica-phantom-shell"
    return {
        f"{name}.json": (FOLDER / "boutiques" / f"{name}.json").read_text(),
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


class Boutiques(unittest.TestCase):
    def test_descriptors_obey_the_schema(self):
        schema = json.loads((HERE / "boutiques.schema.json").read_text())
        jsonschema.Draft7Validator.check_schema(schema)
        for command, descriptor in boutiques():
            with self.subTest(command=command["command"]):
                jsonschema.validate(descriptor, schema)

    def test_schema_refuses_mistakes(self):
        schema = json.loads((HERE / "boutiques.schema.json").read_text())
        _, right = next(boutiques())
        for change in (
            lambda d: d.pop("command-line"),
            lambda d: d.update(colour="red"),
            lambda d: d["inputs"][0].update(type="Integer"),
            lambda d: d["inputs"].append(d["inputs"][0]),
            lambda d: d["inputs"][0].update({"type": "File", "value-choices": ["a"]}),
            lambda d: d["output-files"][0].pop("path-template"),
        ):
            wrong = json.loads(json.dumps(right))
            change(wrong)
            with self.assertRaises(jsonschema.ValidationError):
                jsonschema.validate(wrong, schema)

    @unittest.skipUnless(importlib.util.find_spec("boutiques"), "skipped: boutiques is not installed")
    def test_descriptors_obey_the_schema_proper(self):
        from boutiques.validator import validate_descriptor

        for command in declarations():
            validate_descriptor(str(FOLDER / "boutiques" / (file_name(command) + ".json")))

    def test_rules_beyond_the_schema(self):
        for command, d in boutiques():
            with self.subTest(command=command["command"]):
                for key in ("id", "value-key"):
                    values = [i[key] for i in d["inputs"]]
                    self.assertEqual(len(values), len(set(values)), "unique " + key)
                ids = [o["id"] for o in d.get("output-files", [])]
                self.assertEqual(len(ids), len(set(ids)))
                keys = re.findall(r"\[[^\]]*\]", d["command-line"])
                self.assertEqual(keys, [i["value-key"] for i in d["inputs"]])
                for o in d.get("output-files", []):
                    self.assertTrue(o["path-template"].startswith("[OUT]/"))
                self.assertEqual([e["code"] for e in d["error-codes"]], [1, 2, 3, 4])

    def test_every_option_of_the_command_is_there(self):
        for command, d in boutiques():
            self.assertEqual(
                {i["name"] for i in d["inputs"]}, {p["name"] for p in command["parameters"]}
            )

    @staticmethod
    def line(descriptor, values):
        """The command line that Boutiques makes of a descriptor and an invocation."""
        line = descriptor["command-line"]
        for i in descriptor["inputs"]:
            text = ""
            if i["id"] in values:
                value = values[i["id"]]
                if i["type"] == "Flag":
                    text = i["command-line-flag"] if value else ""
                else:
                    separator = i.get("list-separator", " ")
                    given = separator.join(map(str, value)) if i.get("list") else str(value)
                    flag = i.get("command-line-flag")
                    text = flag + i.get("command-line-flag-separator", " ") + given if flag else given
            elif not i["optional"]:
                raise KeyError(i["id"])
            line = line.replace(i["value-key"], text)
        return line

    def run_line(self, name, **values):
        descriptor = dict((c["command"], d) for c, d in boutiques())[name]
        words = shlex.split(self.line(descriptor, values))
        self.assertEqual(words[0], "explica")
        done = subprocess.run([EXECUTABLE, *words[1:]])
        self.assertIn(done.returncode, (0, 3))

    def test_invocations_run(self):
        with tempfile.TemporaryDirectory() as folder:
            shell, thick, both = (f"{folder}/{name}" for name in ("shell", "thick", "both"))
            self.run_line("phantom shell", size=16, aspect="1,1,2", out=shell, quiet=True)
            self.run_line("thickness", SEG=f"{shell}/labels.nii.gz", inner=[1], tissue=[2],
                          layers=2, method="eulerian", out=thick, quiet=True)  # fmt: skip
            record = json.loads(pathlib.Path(thick, "provenance.json").read_text())
            self.assertEqual(record["options"]["method"], "eulerian")
            for name in ("p19", "p34"):
                self.run_line(f"phantom polygon{name[1:]}", out=f"{folder}/{name}", quiet=True)
            self.run_line("embed", TARGET=[f"{folder}/{n}/polygon.csv" for n in ("p19", "p34")],
                          combine=[0.3, 0.7], order=8, max_iterations=2, out=both, quiet=True)  # fmt: skip


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
