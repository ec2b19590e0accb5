#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The T1 route on simulated heads of many people, beside the truth; called by population.sh.

A head is made of a label map by ../shared/referee/simulate_head.py, then resampled to the variant's voxels (trilinear after a blur
of half the gain in spacing).  The odd half of the people is the one constants are settled on, the even half is held out.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import time

import nibabel as nib
import numpy as np
from scipy.ndimage import affine_transform, gaussian_filter

SHARED = pathlib.Path(__file__).resolve().parents[3] / "shared"
# Noise in per cent of white matter, field, contrast of grey and white, voxels in mm.
VARIANTS = {1: (3, 0.2, 1.0, (1, 1, 1)), 2: (6, 0.4, 0.85, (1, 1, 1)), 3: (2, 0.3, 1.15, (0.7, 0.7, 0.7)),
            4: (4, 0.2, 1.0, (1.3, 1.3, 1.3)), 5: (3, 0.3, 1.0, (1, 1, 2))}
COLUMNS = ["person", "half", "variant", "exit", "flags", "seconds", "mask_dice", "cortex_outside_mask", "missing_ml", "extra_ml",
           "grey_dice", "white_dice", "agreement", "open_share", "thickness_left", "thickness_right", "truth_left", "truth_right",
           "defects_left", "defects_right"]


def canonical(path):
    return nib.as_closest_canonical(nib.load(path))


def on_voxels(image, spacing, order):
    """The image on other voxels along the same axes."""
    data, old = np.asarray(image.dataobj), np.sqrt((image.affine[:3, :3] ** 2).sum(0))
    ratio = np.array(spacing) / old
    if np.allclose(ratio, 1):
        return image
    if order:
        data = gaussian_filter(data.astype(np.float32), 0.5 * np.sqrt(np.maximum(ratio**2 - 1, 0)))
    size = np.floor((np.array(data.shape) - 1) / ratio).astype(int) + 1
    affine = image.affine.copy()
    affine[:3, :3] = affine[:3, :3] * ratio
    return nib.Nifti1Image(affine_transform(data, ratio, output_shape=tuple(size), order=order), affine)


def simulate(labels, person, variant, folder):
    noise, bias, contrast, spacing = VARIANTS[variant]
    whole = folder / "whole.nii.gz"
    subprocess.run([sys.executable, SHARED / "referee/simulate_head.py", labels, whole, str(100 * variant + person), str(noise),
                    str(bias), str(contrast)], check=True)
    nib.save(on_voxels(canonical(whole), spacing, 1), folder / "T1.nii.gz")
    whole.unlink()
    return np.asarray(on_voxels(canonical(labels), spacing, 0).dataobj).astype(int)


def dice(a, b):
    return 2 * (a & b).sum() / max(1, a.sum() + b.sum())


def compare(labels, folder, row):
    """Mask and tissues beside the labels."""
    mask = np.asarray(canonical(folder / "brain_mask.nii.gz").dataobj) > 0
    tissue = np.asarray(canonical(folder / "seg.nii.gz").dataobj)
    brain, cortex = (labels > 0) & (labels < 500), np.isin(labels, (3, 42))
    voxel = np.prod(nib.load(folder / "seg.nii.gz").header.get_zooms()[:3]) / 1000
    row["mask_dice"] = dice(mask, brain)
    row["cortex_outside_mask"] = (cortex & ~mask).sum() / cortex.sum()
    row["missing_ml"], row["extra_ml"] = (brain & ~mask).sum() * voxel, (mask & ~brain).sum() * voxel
    # Deep grey matter is neither to a classifier of brightness: only labels of cortex and white matter and what is called so there.
    known = np.isin(labels, (2, 41, 3, 42)) | (labels == 24) | (labels >= 500)
    row["grey_dice"] = dice((tissue == 2) & known, cortex)
    row["white_dice"] = dice((tissue == 3) & known, np.isin(labels, (2, 41)))


def summary(folder):
    path = folder / "summary.json"
    return json.loads(path.read_text()) if path.exists() else {}


def surfaces(program, labels, folder, row):
    for side, name in (("L", "left"), ("R", "right")):
        found = summary(folder / f"run/surface-{side}")
        row[f"thickness_{name}"], row[f"defects_{name}"] = found.get("thickness_mean"), found.get("defects_corrected")
        truth = folder.parent / f"truth-{side}"
        if not (truth / "summary.json").exists():
            subprocess.run([program, "surface", labels, "--preset", "aseg", "--hemisphere", side, "--out", truth, "--force"],
                           capture_output=True)
        row[f"truth_{name}"] = summary(truth).get("thickness_mean")


def row_of(program, path, variant, work, with_surfaces):
    person = int(path.name.split("_")[-1][:2])
    folder = work / f"{person:02d}" / f"variant-{variant}"
    kept = folder / ("surfaces.json" if with_surfaces else "row.json")
    if kept.exists():
        return json.loads(kept.read_text())
    folder.mkdir(parents=True, exist_ok=True)
    labels = simulate(path, person, variant, folder)
    row = {"person": person, "half": "settled" if person % 2 else "held out", "variant": variant}
    words = ["run", folder / "T1.nii.gz", "--steps", "segment,surface", "--out", folder / "run"] if with_surfaces else [
        "segment", folder / "T1.nii.gz", "--out", folder / "segment"]
    start = time.monotonic()
    done = subprocess.run([program, *words, "--force", "--quiet"], capture_output=True, text=True)
    row["seconds"], row["exit"] = time.monotonic() - start, done.returncode
    segment = folder / ("run/segment" if with_surfaces else "segment")
    found = summary(segment)
    row["flags"] = ",".join(flag["name"] for flag in found.get("flags", [])) or "none"
    row["agreement"], row["open_share"] = found.get("registration_correlation"), found.get("brain_border_open_share")
    if (segment / "seg.nii.gz").exists():
        compare(labels, segment, row)
    if with_surfaces:
        surfaces(program, path, folder, row)
    (folder / "T1.nii.gz").unlink()
    kept.write_text(json.dumps(row, default=float))
    return row


def text_of(value):
    return "" if value is None else f"{value:.4f}" if isinstance(value, float) else str(value)


def write_table(rows, path):
    lines = ["\t".join(COLUMNS)] + ["\t".join(text_of(row.get(c)) for c in COLUMNS) for row in rows]
    for half in ("settled", "held out"):
        of_half = [row for row in rows if row["half"] == half and row.get("mask_dice") is not None]
        for name, pick in (("median", np.median), ("worst", None)):
            if not of_half:
                continue
            worst = {"mask_dice": min, "grey_dice": min, "white_dice": min, "agreement": min}
            values = [text_of(float((pick or worst.get(c, max))([row[c] for row in of_half])))
                      if all(isinstance(row.get(c), (int, float)) for row in of_half) and c not in ("person", "variant") else ""
                      for c in COLUMNS[2:]]
            lines.append("\t".join([name, half, *values]))
    path.write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--surfaces", action="store_true")
    parser.add_argument("--people", default="")
    parser.add_argument("--variants", default="1,2,3,4,5")
    asked = parser.parse_args()
    people = [f"{int(p):02d}" for p in asked.people.split(",") if p]
    maps = [m for m in sorted((SHARED / "data/synthseg_people").glob("*.nii.gz")) if not people or m.name[-9:-7] in people]
    if not maps:
        sys.exit("population: no label maps in ../shared/data/synthseg_people")
    rows = [row_of(asked.program.resolve(), path, int(variant), asked.work, asked.surfaces)
            for variant in asked.variants.split(",") for path in maps]
    write_table(rows, asked.work / "population.tsv")


if __name__ == "__main__":
    main()
