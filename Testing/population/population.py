#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The T1 route on many people beside the truth: simulated heads, and brains whose cortex was labelled by hand; called by population.sh.

A head is made of a label map by ../shared/referee/simulate_head.py, then resampled to the variant's voxels (trilinear after a blur
of half the gain in spacing).  The odd half of the people is the one constants are settled on, the even half is held out.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import time

import nibabel as nib
import numpy as np
from scipy.spatial import cKDTree
from scipy.stats import spearmanr
from scipy.ndimage import affine_transform, distance_transform_edt, gaussian_filter

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "validation"))
from labelled_cortex import areas_of, beside_labels, surface_of, voxels_inside  # noqa: E402
from measures import signed_offset  # noqa: E402

SHARED = pathlib.Path(__file__).resolve().parents[3] / "shared"
# Noise in per cent of white matter, field, contrast of grey and white, voxels in mm.
VARIANTS = {1: (3, 0.2, 1.0, (1, 1, 1)), 2: (6, 0.4, 0.85, (1, 1, 1)), 3: (2, 0.3, 1.15, (0.7, 0.7, 0.7)),
            4: (4, 0.2, 1.0, (1.3, 1.3, 1.3)), 5: (3, 0.3, 1.0, (1, 1, 2))}
COLUMNS = ["person", "half", "variant", "exit", "flags", "seconds", "mask_dice", "cortex_outside_mask", "missing_ml", "extra_ml",
           "grey_dice", "white_dice", "agreement", "open_share"]
OF_A_SIDE = ["thickness", "truth", "region_r", "region_slope", "region_largest", "white_border", "pial_border", "cortex_between",
             "cortex_beyond_pial", "middle_inside", "defects", "doubtful", "doubt_rank"]
COLUMNS += [f"{name}_{side}" for name in OF_A_SIDE for side in ("left", "right")]
# The larger, the better.
RISING = {"mask_dice", "grey_dice", "white_dice", "agreement", "region_r", "cortex_between", "middle_inside"}


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


def regions_of(surfaces, atlas, side):
    """Mean thickness of each cortical region of AAL, by the label nearest to the middle surface within 3 mm."""
    image = nib.load(atlas)
    names = dict(line.split("\t") for line in atlas.with_name("atlas.tsv").read_text().splitlines()[1:])
    cortical = [int(key) for key, name in names.items() if name.endswith(f"_{side}") and not name.startswith(
        ("Cerebel", "Vermis", "Caudate", "Putamen", "Pallidum", "Thalamus", "Hippocampus", "Amygdala", "Deep_"))]
    data = np.asarray(image.dataobj).astype(int)
    apart, nearest = distance_transform_edt(~np.isin(data, cortical), return_indices=True)
    middle, faces = surface_of(surfaces, "mid")
    thickness = nib.load(surfaces / "thickness.shape.gii").darrays[0].data.astype(float)
    area = areas_of(middle, faces) * (thickness > 0)
    at = np.rint(nib.affines.apply_affine(np.linalg.inv(image.affine), middle)).astype(int)
    at = tuple(np.clip(at, 0, np.array(image.shape) - 1).T)
    label = np.where(apart[at] <= 3, data[tuple(n[at] for n in nearest)], 0)
    sums = np.bincount(label, area * thickness, max(cortical) + 1)
    areas = np.bincount(label, area, max(cortical) + 1)
    return {names[str(key)].removesuffix(f"_{side}"): sums[key] / areas[key] for key in cortical if areas[key] > 200}


def doubt_and_error(made, truth):
    """Doubt and error of thickness, mm, each in the mean of 15 mm around 400 places of the cortex."""
    doubt = np.sqrt(sum(d.data.astype(float) ** 2 for d in nib.load(made / "doubt.shape.gii").darrays))
    middle, _ = surface_of(made, "mid")
    theirs, _ = surface_of(truth, "mid")
    ours, known = (nib.load(f / "thickness.shape.gii").darrays[0].data.astype(float) for f in (made, truth))
    apart, nearest = cKDTree(theirs).query(middle)
    error = np.hypot(ours - known[nearest], apart)
    good = (ours > 0) & (known[nearest] > 0)
    middle, doubt, error = middle[good], doubt[good], error[good]
    near = cKDTree(middle).query_ball_point(middle[:: max(1, len(middle) // 400)], 15)
    return [doubt[n].mean() for n in near], [error[n].mean() for n in near]


def of_side(labels, made, truth, atlas, side):
    """Borders, thickness by region and lost cortex of one hemisphere beside the surfaces of its labels."""
    ours, known = regions_of(made, atlas, side), regions_of(truth, atlas, side)
    a, b = np.array([(ours[name], known[name]) for name in ours if name in known]).T
    doubt, error = doubt_and_error(made, truth)
    image = nib.load(labels)
    cortex = np.asarray(image.dataobj) == {"L": 3, "R": 42}[side]
    white, pial = (voxels_inside(*surface_of(made, name), image.affine, image.shape) for name in ("white", "pial"))
    middle, faces = surface_of(made, "mid")
    area = areas_of(middle, faces) * (nib.load(made / "thickness.shape.gii").darrays[0].data > 0)
    at = np.rint(nib.affines.apply_affine(np.linalg.inv(image.affine), middle)).astype(int)
    return {"region_r": np.corrcoef(a, b)[0, 1], "region_slope": np.polyfit(b, a, 1)[0],
            "region_largest": np.abs(a - b).max(), "white_border": signed_offset(made, truth, "white"),
            "pial_border": signed_offset(made, truth, "pial"), "cortex_between": (pial & ~white)[cortex].mean(),
            "cortex_beyond_pial": (~pial)[cortex].mean(), "middle_inside": area[cortex[tuple(at.T)]].sum() / area.sum(),
            "doubt_rank": spearmanr(doubt, error)[0],
            "places": {"doubt": doubt, "error": error}, "regions": {name: ours[name] - known[name] for name in ours if name in known}}


def take(found, name, row):
    for key, column in (("thickness_mean", "thickness"), ("defects_corrected", "defects"), ("doubtful_share", "doubtful")):
        row[f"{column}_{name}"] = found.get(key)


def surfaces(program, labels, folder, row):
    for side, name in (("L", "left"), ("R", "right")):
        made = folder / f"run/surface-{side}"
        found = summary(made)
        take(found, name, row)
        truth = folder.parent / f"truth-{side}"
        if not (truth / "summary.json").exists():
            subprocess.run([program, "surface", labels, "--preset", "aseg", "--hemisphere", side, "--out", truth, "--force"],
                           capture_output=True)
        row[f"truth_{name}"] = summary(truth).get("thickness_mean")
        if not (made / "pial.surf.gii").exists():
            continue
        beside = of_side(labels, made, truth, folder / "run/segment/atlas.nii.gz", side)
        row.update({f"{key}_{name}": value for key, value in beside.items()})


def run_on(program, image, out, row, words=("run", "--steps", "segment,surface")):
    start = time.monotonic()
    done = subprocess.run([program, *words, image, "--out", out, "--force", "--quiet"], capture_output=True, text=True)
    row["seconds"], row["exit"] = time.monotonic() - start, done.returncode
    found = summary(out / "segment" if words[0] == "run" else out)
    row["flags"] = ",".join(flag["name"] for flag in found.get("flags", [])) or "none"
    row["agreement"], row["open_share"] = found.get("registration_correlation"), found.get("brain_border_open_share")


def row_of(program, path, variant, work, with_surfaces):
    person = int(path.name.split("_")[-1][:2])
    folder = work / f"{person:02d}" / f"variant-{variant}"
    kept = folder / ("surfaces.json" if with_surfaces else "row.json")
    if kept.exists():
        return json.loads(kept.read_text())
    folder.mkdir(parents=True, exist_ok=True)
    labels = simulate(path, person, variant, folder)
    row = {"person": person, "half": "settled" if person % 2 else "held out", "variant": variant}
    if with_surfaces:
        run_on(program, folder / "T1.nii.gz", folder / "run", row)
    else:
        run_on(program, folder / "T1.nii.gz", folder / "segment", row, ("segment",))
    segment = folder / ("run/segment" if with_surfaces else "segment")
    if (segment / "seg.nii.gz").exists():
        compare(labels, segment, row)
    if with_surfaces:
        surfaces(program, path, folder, row)
    (folder / "T1.nii.gz").unlink()
    kept.write_text(json.dumps(row, default=float))
    return row


def labelled_row(program, person, work):
    """The T1 of a person of oasis_trt, stripped along the folds, beside cortex labelled by hand."""
    data, folder = SHARED / f"data/oasis_trt/{person}", work / f"trt-{person}"
    if (folder / "row.json").exists():
        return json.loads((folder / "row.json").read_text())
    folder.mkdir(parents=True, exist_ok=True)
    row = {"person": f"trt-{person}", "half": "settled" if person % 2 else "held out", "variant": "T1"}
    run_on(program, data / "t1weighted_brain.nii.gz", folder / "run", row)
    for side, name in (("L", "left"), ("R", "right")):
        made = folder / f"run/surface-{side}"
        take(summary(made), name, row)
        if not (made / "pial.surf.gii").exists():
            continue
        found = beside_labels(data / "labels.DKT31.manual.nii.gz", side, made)
        row.update({f"cortex_between_{name}": found["between"], f"cortex_beyond_pial_{name}": found["beyond_pial"],
                    f"middle_inside_{name}": found["middle"], f"truth_{name}": row[f"thickness_{name}"] - found["thickness"]})
    (folder / "row.json").write_text(json.dumps(row, default=float))
    return row


def text_of(value):
    return "" if value is None else f"{value:.4f}" if isinstance(value, float) else str(value)


def worst_of(column, rows):
    """The value farthest from what it should be: 1 of a slope, large of a Dice, else 0."""
    stem = column.removesuffix("_left").removesuffix("_right")
    bad = {"region_slope": lambda value: abs(value - 1)}.get(stem, (lambda value: -value) if stem in RISING else abs)
    return max((row[column] for row in rows), key=bad)


def write_table(rows, path):
    lines = ["\t".join(COLUMNS)] + ["\t".join(text_of(row.get(c)) for c in COLUMNS) for row in rows]
    for half, labelled in ((h, k) for k in (False, True) for h in ("settled", "held out")):
        of_half = [row for row in rows if row["half"] == half and (row["variant"] == "T1") == labelled]
        for name, pick in (("median", np.median), ("worst", None)):
            if not of_half:
                continue
            values = [text_of(float(pick([row[c] for row in of_half]) if pick else worst_of(c, of_half)))
                      if all(isinstance(row.get(c), (int, float)) for row in of_half) and c not in ("person", "variant") else ""
                      for c in COLUMNS[2:]]
            lines.append("\t".join([f"{name} of {'labelled by hand' if labelled else 'simulated'}", half, *values]))
    path.write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def write_regions(rows, path):
    """By region, over the hemispheres of all heads: the median error of its thickness and the largest; and the rank correlation of
    error with doubt over all their places."""
    sides = [(f"{row['person']}{name[0].upper()}", row[f"regions_{name}"], row[f"places_{name}"]) for row in rows
             for name in ("left", "right") if f"regions_{name}" in row]
    if not sides:
        return
    lines = ["region\themispheres\tmedian_error_mm\tlargest_error_mm\tlargest_at"]
    for region in sorted({region for _, regions, _ in sides for region in regions}):
        errors = [(regions[region], who) for who, regions, _ in sides if region in regions]
        worst, who = max(errors, key=lambda item: abs(item[0]))
        lines.append(f"{region}\t{len(errors)}\t{np.median([e for e, _ in errors]):+.3f}\t{worst:+.3f}\t{who}")
    doubt, error = (np.concatenate([places[key] for _, _, places in sides]) for key in ("doubt", "error"))
    path.write_text("\n".join(lines) + "\n")
    print(f"rank correlation of error with doubt over {len(doubt)} places: {spearmanr(doubt, error)[0]:.3f}")


def reaches(row):
    """What the T1 route must not fall below on a simulated head: its brain found whole, grey matter nearly as labelled (the aim is
    0.93; voxels of 1.3 mm reach 0.90)."""
    return row["exit"] == 0 and row["mask_dice"] >= 0.95 and row["cortex_outside_mask"] <= 0.005 and row["grey_dice"] >= 0.88


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--surfaces", action="store_true")
    parser.add_argument("--people", default="")
    parser.add_argument("--labelled", default="", help="people of oasis_trt, such as 1,2")
    parser.add_argument("--check", action="store_true", help="make all rows anew and fail if one is beyond what a run must reach")
    parser.add_argument("--variants", default="1,2,3,4,5")
    asked = parser.parse_args()
    if asked.check:
        shutil.rmtree(asked.work, ignore_errors=True)
    asked.work.mkdir(parents=True, exist_ok=True)
    people = [f"{int(p):02d}" for p in asked.people.split(",") if p]
    maps = [m for m in sorted((SHARED / "data/synthseg_people").glob("*.nii.gz")) if not people or m.name[-9:-7] in people]
    if not maps:
        print("population: no label maps in ../shared/data/synthseg_people")
        sys.exit(77 if asked.check else 1)
    rows = [row_of(asked.program.resolve(), path, int(variant), asked.work, asked.surfaces)
            for variant in asked.variants.split(",") if variant for path in maps]
    rows += [labelled_row(asked.program.resolve(), int(person), asked.work) for person in asked.labelled.split(",") if person]
    write_table(rows, asked.work / "population.tsv")
    write_regions(rows, asked.work / "regions.tsv")
    if asked.check and not all(reaches(row) for row in rows):
        sys.exit("population: a row is beyond its limits")


if __name__ == "__main__":
    main()
