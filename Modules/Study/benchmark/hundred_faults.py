# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""A study of 24 good people and 100 with faulty inputs of 27 kinds, killed and resumed again and again:

    hundred_faults.py build/bin/explica WORK

Ends with 0 if each faulty person is failed or doubted in study.tsv and each good one is done, and if the tables of the
study that was killed have the bytes of the one that was not.
"""
import csv
import gzip
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys

import nibabel as nib
import numpy as np

program, work = sys.argv[1], pathlib.Path(sys.argv[2])
OPTIONS = ["--steps", "thickness,surface", "--hemisphere", "L", "--surface.faces", "1000"]


def image(labels, kind=None):
    return lambda path: nib.save(nib.Nifti1Image(labels if kind is None else labels.astype(kind), affine), path)


def content(data):
    return lambda path: path.write_bytes(data)


def header(place, form, *values):
    """The good file with other values in its header."""
    changed = bytearray(plain)
    struct.pack_into(form, changed, place, *values)
    return content(gzip.compress(bytes(changed)))


def without_axes():
    changed = bytearray(plain)
    struct.pack_into("<2h", changed, 252, 0, 1)
    struct.pack_into("<12f", changed, 280, *[0] * 12)
    return content(gzip.compress(bytes(changed)))


shutil.rmtree(work, ignore_errors=True)
work.mkdir(parents=True)
subprocess.run([program, "phantom", "cortex", "--size", "32", "--spacing", "2", "--out", work / "phantom", "--quiet"], check=True)
raw = (work / "phantom/labels.nii.gz").read_bytes()
plain = gzip.decompress(raw)
good = nib.load(work / "phantom/labels.nii.gz")
labels, affine = np.asarray(good.dataobj).astype(np.uint8), good.affine  # 1 fluid, 2 grey, 3 white
noise = np.random.default_rng(3)
KINDS = {
    "truncated": content(raw[:len(raw) // 2]), "empty": content(b""), "text": content(b"hello world\n" * 100),
    "bytes": content(noise.bytes(4000)), "shortdata": content(gzip.compress(plain[:352 + len(plain) // 3])),
    "zeros": image(0 * labels), "onelabel": image(0 * labels + 1), "greyonly": image(2 * (labels == 2).astype(np.uint8)),
    "exchanged": image(np.choose(labels, [0, 3, 2, 1]), np.uint8), "slice": image(labels[:, :, 16:17]),
    "tiny": image(labels[14:16, 14:16, 14:16]), "negative": image(-labels.astype(np.int16)),
    "halves": image(np.where(labels > 0, labels + .5, 0), np.float32), "huge": image(labels * 1e20, np.float32),
    "nan": image(np.where(labels == 2, np.nan, labels), np.float32), "noise": image(100 * noise.random(labels.shape), np.float32),
    "series": image(np.stack([labels] * 4, -1)), "complex": image(labels, np.complex64),
    "negativesize": header(40, "<8h", 3, -32, 32, 32, 1, 1, 1, 1), "hugesize": header(40, "<8h", 3, 32767, 32767, 32767, 1, 1, 1, 1),
    "nanspacing": header(76, "<8f", 1, float("nan"), 2, 2, 1, 1, 1, 1), "signature": header(344, "<4s", b"abcd"),
    "datatype": header(70, "<h", 9999), "noaxes": without_axes(), "folder": pathlib.Path.mkdir,
    "dangling": lambda path: path.symlink_to("nowhere"), "loop": lambda path: path.symlink_to(path.name),
}
data = work / "data"
data.mkdir()
(data / "dataset_description.json").write_text('{"Name": "faults", "BIDSVersion": "1.8.0", "License": "CC0"}')
people = {"good%02d" % n: content(raw) for n in range(24)}
for n in range(100):
    kind = list(KINDS)[n % len(KINDS)]
    people["%s%02d" % (kind, n)] = KINDS[kind]
for label, write in people.items():
    path = data / ("sub-" + label) / "anat" / ("sub-%s_dseg.nii.gz" % label)
    path.parent.mkdir(parents=True)
    write(path)


def start(out):
    return subprocess.Popen([program, "bids", data, out, "participant", *OPTIONS, "--quiet"], stderr=subprocess.DEVNULL)


def group(out):
    subprocess.run([program, "bids", data, out, "group", "--quiet"], check=True, stderr=subprocess.DEVNULL)


whole, killed = work / "whole", work / "killed"
assert start(whole).wait() == 3
group(whole)
moments, kills = random.Random(5), 0
while True:
    process = start(killed)
    try:
        code = process.wait(moments.uniform(.3, 9))
        break
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        kills += 1
group(killed)
faults = [] if code == 3 else ["the resumed study ended with %d" % code]
with open(whole / "study.tsv", newline="") as table:
    rows = {row["participant_id"].removeprefix("sub-"): row["state"] for row in csv.DictReader(table, delimiter="\t")}
for label in people:
    state = rows.get(label, "")
    right = state == "done" if label.startswith("good") else state.startswith(("failed: ", "implausible"))
    if not right:
        faults.append("sub-%s: %s" % (label, state or "not in the table"))
for name in ("study.tsv", "study_regions.tsv"):
    if (whole / name).read_bytes() != (killed / name).read_bytes():
        faults.append(name + " differs after kills")
print("\n".join(faults) or "each of 100 faults is named; same tables after %d kills" % kills)
sys.exit(bool(faults))
