# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The descriptions agree with the commands, and the tools that they are for can use them."""

import importlib.util
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

FOLDER = pathlib.Path(os.environ["EXPLICA_DESCRIPTORS"])
EXECUTABLE = pathlib.Path(os.environ["EXPLICA_EXECUTABLE"])


def declarations():
    return json.loads(subprocess.check_output([EXECUTABLE, "--describe"]))


def file_name(command):
    return "explica-" + command["command"].replace(" ", "-")


class Boutiques(unittest.TestCase):
    # What the schema 0.5 of Boutiques demands of the parts that we write.
    KEYS = {
        "id", "name", "description", "type", "optional", "value-key", "command-line-flag", "integer",
        "value-choices", "list", "list-separator", "command-line-flag-separator", "default-value",
    }  # fmt: skip

    def test_descriptors_obey_the_schema(self):
        for command in declarations():
            d = json.loads((FOLDER / "boutiques" / (file_name(command) + ".json")).read_text())
            with self.subTest(command=command["command"]):
                for key in ("name", "description", "tool-version", "schema-version", "command-line"):
                    self.assertTrue(d[key])
                self.assertEqual(d["schema-version"], "0.5")
                self.assertGreater(len(d["inputs"]), 0)
                ids = [i["id"] for i in d["inputs"]]
                self.assertEqual(len(ids), len(set(ids)))
                for i in d["inputs"]:
                    self.assertLessEqual(set(i), self.KEYS)
                    self.assertRegex(i["id"], r"^[0-9_a-zA-Z]+$")
                    self.assertIn(i["type"], ("String", "File", "Flag", "Number"))
                    self.assertIn(i["value-key"], d["command-line"])
                    if i["type"] == "Flag":
                        self.assertTrue(i["optional"])
                        self.assertIn("command-line-flag", i)
                    if "value-choices" in i and "default-value" in i:
                        self.assertIn(i["default-value"], i["value-choices"])
                for o in d.get("output-files", []):
                    self.assertRegex(o["id"], r"^[0-9_a-zA-Z]+$")
                    self.assertTrue(o["path-template"].startswith("[OUT]/"))

    def test_every_option_of_the_command_is_there(self):
        for command in declarations():
            d = json.loads((FOLDER / "boutiques" / (file_name(command) + ".json")).read_text())
            self.assertEqual(
                {i["name"] for i in d["inputs"]}, {p["name"] for p in command["parameters"]}
            )


class Slicer(unittest.TestCase):
    def test_xml_is_well_formed_complete_and_printed_by_the_command(self):
        for command in declarations():
            text = (FOLDER / "slicer" / (file_name(command) + ".xml")).read_text()
            printed = subprocess.check_output(
                [EXECUTABLE, *command["command"].split(), "--xml"], text=True
            )
            self.assertEqual(text, printed)
            root = xml.etree.ElementTree.fromstring(text.encode())
            self.assertEqual(root.tag, "executable")
            labels = {n.text for n in root.iter("label")}
            for p in command["parameters"]:
                self.assertIn(p["name"], labels)
            for choice in root.iter("string-enumeration"):
                self.assertIn(choice.findtext("default"), [e.text for e in choice.iter("element")] + [None])


class Shells(unittest.TestCase):
    def complete(self, *words):
        script = (
            f"source {FOLDER}/completion/explica.bash; COMP_WORDS=({' '.join(words)} '');"
            f"COMP_CWORD={len(words)}; _explica; echo ${{COMPREPLY[@]}}"
        )
        return subprocess.check_output(["bash", "-c", script], text=True).split()

    def test_bash_completes_verbs_kinds_and_options(self):
        verbs = {c["command"].split()[0] for c in declarations()}
        self.assertEqual(set(self.complete("explica")), verbs)
        self.assertIn("shell", self.complete("explica", "phantom"))
        script = (
            f"source {FOLDER}/completion/explica.bash; COMP_WORDS=(explica phantom shell --si);"
            "COMP_CWORD=3; _explica; echo ${COMPREPLY[@]}"
        )
        self.assertEqual(subprocess.check_output(["bash", "-c", script], text=True).split(), ["--size"])


class ManualPages(unittest.TestCase):
    def test_every_option_is_named(self):
        for command in declarations():
            page = (FOLDER / "man" / (file_name(command) + ".1")).read_text().replace("\\-", "-")
            for p in command["parameters"]:
                self.assertIn(p["name"], page)
            self.assertTrue(re.match(r"\.TH EXPLICA", page))


@unittest.skipUnless(importlib.util.find_spec("nipype"), "skipped: python3-nipype is not installed")
class Nipype(unittest.TestCase):
    def interfaces(self):
        path = FOLDER / "nipype" / "explica_nipype.py"
        spec = importlib.util.spec_from_file_location("explica_nipype", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    def test_interface_runs_the_command_and_finds_its_outputs(self):
        os.environ["PATH"] = f"{EXECUTABLE.parent}:{os.environ['PATH']}"
        with tempfile.TemporaryDirectory() as folder:
            shell = self.interfaces().PhantomShell(
                size=16, aspect=(1.0, 1.0, 2.0), out=os.path.join(folder, "shell")
            )
            self.assertIn("--aspect 1.0,1.0,2.0", shell.cmdline)
            outputs = shell.run().outputs
            self.assertTrue(os.path.isfile(outputs.labels_nii_gz))
            self.assertTrue(os.path.isfile(outputs.provenance_json))

    def test_every_command_has_an_interface(self):
        module = self.interfaces()
        for command in declarations():
            name = "".join(w.capitalize() for w in command["command"].split())
            interface = getattr(module, name)
            required = {
                p["name"].lower().replace("_", "-")
                for p in command["parameters"]
                if p["required"] or p["name"] == "out"
            }
            mandatory = {
                t.rstrip("_").replace("_", "-")
                for t, trait in interface.input_spec().traits().items()
                if trait.mandatory
            }
            self.assertEqual(mandatory, required)


if __name__ == "__main__":
    unittest.main()
