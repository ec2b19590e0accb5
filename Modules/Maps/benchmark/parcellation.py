#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Regions by `explica parcellate` beside a person's own.

    parcellation.py bert FOLDER [L|R]      fsaverage's aparc on bert, beside his own: at the points of FreeSurfer's
                                           surface that are known, which leave out most of some regions, and at
                                           all vertices by aparc+aseg
    parcellation.py people FOLDER 1 2 ...  OASIS-TRT, leave one out: each from the T1 alone, the others'
                                           manual DKT31 labels, beside the manual labels

Runs what FOLDER does not hold yet, with one thread.  Dice of each region, mean and least.  With --labels,
people's surfaces are made from the manual labels' cortex instead of the T1: what registration and voting leave
of a perfect segmentation.
"""

import csv
import gzip
import pathlib
import subprocess
import sys

import nibabel as nib
import numpy as np
from scipy.spatial import cKDTree

ROOT = pathlib.Path(__file__).resolve().parents[3]
DATA = ROOT.parent / "shared" / "data"
EXPLICA = ROOT / "build/bin/explica"
FIRST = {"L": 1000, "R": 2000}


def explica(*words, out, done=(0, 3)):
    if (out / "summary.json").exists():
        return
    code = subprocess.run([EXPLICA, *map(str, words), "--out", str(out), "--quiet", "--threads", "1", "--force"],
                          check=False).returncode
    if code not in done:
        raise SystemExit(f"{' '.join(map(str, words))}: exit {code}")


def dice(found, given):
    """Dice of each name that stands in `given`."""
    return {name: 2 * ((found == name) & (given == name)).sum() / ((found == name).sum() + (given == name).sum())
            for name in np.unique(given)}


def say(title, values):
    least = min(values, key=values.get)
    print(f"{title}: mean Dice {np.mean(list(values.values())):.3f}, least {values[least]:.3f} ({least}), "
          f"{len(values)} regions")


def bert(folder, side):
    """Points of bert's own white surface have the region of the nearest vertex of ours."""
    data = DATA / "bert_freesurfer"
    run = folder / f"bert-{side}"
    explica("run", data, "--hemisphere", side, "--steps", "surface,sphere,register,parcellate",
            "--template", DATA / "fsaverage", out=run)
    hemi = "lh" if side == "L" else "rh"
    with gzip.open(data / f"{hemi}.thickness_at_known_vertices.csv.gz", "rt") as file:
        rows = list(csv.DictReader(file))
    points = np.array([[float(row[f"ras_{a}"]) for a in "xyz"] for row in rows])
    given = np.array([row["aparc"] for row in rows])
    white = nib.load(run / "surface/white.surf.gii").agg_data("pointset")
    labels = nib.load(run / "parcellate/regions.label.gii")
    names = labels.labeltable.get_labels_as_dict()
    found = np.array([names[k] for k in labels.agg_data()])[cKDTree(white).query(points)[1]]
    cortex = ~np.isin(given, ["unknown", "corpuscallosum", "none", "???", ""])
    say(f"bert {side}, {cortex.sum()} known points", dice(found[cortex], given[cortex]))
    well = {name: value for name, value in dice(found[cortex], given[cortex]).items()
            if (given == name).sum() >= 1000}
    say(f"bert {side}, regions of which 1000 points or more are known", well)
    keys = labels_at_vertices(nib.load(data / "mri/aparc+aseg.mgz"), run / "surface", side) % 1000
    own = {name: key for key, name in np.genfromtxt(run / "parcellate/aparc.tsv", names=True, dtype=None,
                                                    encoding="utf-8")}
    all_found = np.array([own.get(names[k], 0) % 1000 for k in labels.agg_data()])
    say(f"bert {side}, {(keys > 0).sum()} vertices", dice(all_found[keys > 0], keys[keys > 0]))


def labels_at_vertices(image, surface, side):
    """Manual label at half depth of each vertex, else at a quarter and three quarters, else at the ends."""
    voxels = np.asarray(image.dataobj).astype(int)
    white, pial = (nib.load(surface / f"{n}.surf.gii").agg_data("pointset") for n in ("white", "pial"))
    keys = np.zeros(len(white), dtype=np.int32)
    for depth in (0.5, 0.25, 0.75, 0, 1):
        at = nib.affines.apply_affine(np.linalg.inv(image.affine), (1 - depth) * white + depth * pial)
        at = np.clip(np.rint(at).astype(int), 0, np.array(image.shape) - 1)
        here = voxels[tuple(at.T)]
        take = (keys == 0) & (here // 1000 * 1000 == FIRST[side])
        keys[take] = here[take]
    return keys


def write_labels(path, keys, side):
    table = nib.gifti.GiftiLabelTable()
    for key in np.unique(np.append(keys, 0)):
        label = nib.gifti.GiftiLabel(int(key), (key % 7) / 7, (key % 11) / 11, (key % 13) / 13, 1)
        label.label = "unknown" if key == 0 else f"region{key % 1000}"
        table.labels.append(label)
    meta = nib.gifti.GiftiMetaData({"AnatomicalStructurePrimary": "CortexLeft" if side == "L" else "CortexRight"})
    array = nib.gifti.GiftiDataArray(keys, intent="NIFTI_INTENT_LABEL", datatype="NIFTI_TYPE_INT32", meta=meta)
    nib.save(nib.gifti.GiftiImage(darrays=[array], labeltable=table, meta=meta), path)


def white_filled(person, folder):
    """FreeSurfer's ribbon labels from the manual cortex: white is what the cortex encloses."""
    from scipy import ndimage
    image = nib.load(DATA / "oasis_trt" / person / "labels.DKT31.manual.nii.gz")
    manual = np.asarray(image.dataobj).astype(int)
    brain = np.asarray(nib.load(DATA / "oasis_trt" / person / f"atlas_{person}_labels.nii.gz").dataobj).astype(int)
    t1 = np.asarray(nib.load(DATA / "oasis_trt" / person / "t1weighted_brain.nii.gz").dataobj)
    ribbon = np.zeros(manual.shape, dtype=np.int16)
    inner = (t1 > 0) & (manual == 0) & ~np.isin(brain, [7, 8, 16, 46, 47, 6, 45, 630, 631, 632, 15, 14])
    left, right = manual // 1000 == 1, manual // 1000 == 2
    nearest_left = ndimage.distance_transform_edt(~left) < ndimage.distance_transform_edt(~right)
    for cortex, side, white in ((left, nearest_left, 2), (right, ~nearest_left, 41)):
        pieces, _ = ndimage.label(inner & side)
        sizes = np.bincount(pieces.ravel())
        sizes[0] = 0
        ribbon[pieces == sizes.argmax()] = white
        ribbon[cortex] = white + 1
    out = folder / f"ribbon-{person}.nii.gz"
    nib.save(nib.Nifti1Image(ribbon, image.affine), out)
    return out


def prepare(folder, person, from_labels):
    given = (white_filled(person, folder) if from_labels
             else DATA / "oasis_trt" / person / "t1weighted_brain.nii.gz")
    run = folder / f"person-{person}"
    steps = "surface,sphere,register" if from_labels else "segment,surface,sphere,register"
    explica("run", given, "--steps", steps, "--template", DATA / "fsaverage", out=run)
    image = nib.load(DATA / "oasis_trt" / person / "labels.DKT31.manual.nii.gz")
    for side in "LR":
        place = run / f"register-{side}"
        write_labels(place / "manual.label.gii", labels_at_vertices(image, run / f"surface-{side}", side), side)
        if not (place / "sulc.shape.gii").exists():
            (place / "sulc.shape.gii").symlink_to(run / f"surface-{side}/sulc.shape.gii")


def people(folder, persons, from_labels):
    for person in persons:
        prepare(folder, person, from_labels)
    for person in persons:
        run = folder / f"person-{person}"
        image = nib.load(DATA / "oasis_trt" / person / "labels.DKT31.manual.nii.gz")
        manual = np.asarray(image.dataobj).astype(int)
        found = np.zeros_like(manual)
        for side in "LR":
            atlases = []
            for other in persons:
                if other != person:
                    atlases += ["--atlas", folder / f"person-{other}/register-{side}/manual.label.gii"]
            out = folder / f"regions-{person}-{side}"
            explica("parcellate", run / f"register-{side}", *atlases, "--hemisphere", side, "--volume",
                    "--ribbon", run / f"surface-{side}", "--like",
                    DATA / "oasis_trt" / person / "labels.DKT31.manual.nii.gz", out=out)
            legend = np.genfromtxt(out / "aparc.tsv", names=True, dtype=None, encoding="utf-8")
            volume = np.asarray(nib.load(out / "aparc.nii.gz").dataobj).astype(int)
            for key, name in legend:
                found[volume == key] = FIRST[side] + int(name[6:])
        cortex = manual > 0
        missed = (found[cortex] == 0).mean()
        # Voxels that the surfaces miss get the label of the nearest that they do not.
        at = np.argwhere(found > 0)
        _, near = cKDTree(at).query(np.argwhere(cortex))
        nearest = found[tuple(at[near].T)]
        say(f"person {person}, voxels between our surfaces ({missed:.1%} of the manual cortex are not)",
            dice(found[cortex], manual[cortex]))
        say(f"person {person}, voxels of the manual cortex by the nearest label",
            dice(nearest, manual[cortex]))


def main():
    words = [word for word in sys.argv[1:] if word != "--labels"]
    folder = pathlib.Path(words[1])
    folder.mkdir(parents=True, exist_ok=True)
    if words[0] == "bert":
        bert(folder, words[2] if len(words) > 2 else "L")
    else:
        people(folder, words[2:], "--labels" in sys.argv)


if __name__ == "__main__":
    main()
