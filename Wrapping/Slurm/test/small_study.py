# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Four small subjects for the tests of the engines, and what became of them."""

import csv
import hashlib
import json
import os
import pathlib
import subprocess
import time

EXECUTABLE = os.environ["EXPLICA_EXECUTABLE"]
PATIENCE = 240  # s; a limit against hanging only

# Unfolding takes some seconds, so that a signal can meet it; it ends at its last iteration.
STUDY = """\
name: Four small subjects
hemispheres: [L]
input: "{subject}.nii.gz"
parameters:
  steps: [surface, unfold]
  surface: {faces: 3000}
  unfold: {direction: [0, 0, 1], radius: 8, max-iterations: 2}
subjects:
  "01":
  "02": {parameters: {surface: {faces: 30000}, unfold: {radius: 14, max-iterations: 12}}}
  "03": {parameters: {surface: {faces: 30000}, unfold: {radius: 14, max-iterations: 12}}}
  "04":
"""


def explica(*words, check=True):
    return subprocess.run([EXECUTABLE, *words], stdout=subprocess.PIPE, text=True, check=check,
                          timeout=PATIENCE).stdout


def make(folder, broken=()):
    """Writes study.yaml and the inputs of 01 to 04; those of `broken` are no images."""
    folder = pathlib.Path(folder)
    explica("phantom", "cortex", "--size", "40", "--depth", "0.1", "--waves", "3", "--quiet",
            "--out", folder / "phantom")
    labels = (folder / "phantom/labels.nii.gz").read_bytes()
    for label in ("01", "02", "03", "04"):
        (folder / f"{label}.nii.gz").write_bytes(b"no image" if label in broken else labels)
    (folder / "study.yaml").write_text(STUDY)
    return folder / "study.yaml"


def mend(folder, label):
    (folder / f"{label}.nii.gz").write_bytes((folder / "phantom/labels.nii.gz").read_bytes())


def table(out):
    """State by subject."""
    with open(out / "study.tsv") as file:
        return {row["participant_id"]: row["state"] for row in csv.DictReader(file, delimiter="\t")}


def todo(study, out):
    return explica("study", "list", study, out, "--todo").split()


def run_folder(out, label):
    return out / "runs" / f"sub-{label}_hemi-L"


def record(out, label, step=""):
    return json.loads((run_folder(out, label) / step / "provenance.json").read_text())


def records(out):
    """Hash of every step's record: a step that is done again gets a new one."""
    return {str(path.relative_to(out)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(out.glob("runs/*/*/provenance.json"))}


def unfolding_has_begun(out, label):
    """The surface is whole, and the unfolding has made the place for its results."""
    run = run_folder(out, label)
    return (run / "surface/provenance.json").exists() and any(run.glob(".unfold.explica-stage"))


def wait(what, holds, explain=lambda: ""):
    end = time.monotonic() + PATIENCE
    while not holds():
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {PATIENCE} s\n{explain()}")
        time.sleep(0.05)
