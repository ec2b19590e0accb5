#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Unfolds one patch again and again, a little different each time: does the result hang on chance?

    Modules/Unfolding/benchmark/robustness.py build/bin/explica SURFACE.gii --center=X,Y,Z --radius R --direction=X,Y,Z
        [--surround elastic] [--seed 7] [--shifts 0.5 1 2] [--jitters 6] [--uncut]

The centre is shifted by 0.5, 1 and 2 mm (--shifts) both ways along the three axes; vertices are moved by a thousandth of the mean
edge within their tangent planes, six times (--jitters); faces are cut in four (not with --uncut).  Prints a row for each run, then for each kind how many runs,
the least and the median visibility and share seen, the largest and the median strain, the largest collar stretch, new
crossings and flags.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import nibabel
import numpy as np

JITTER = 1e-3  # of the mean edge


def normals_of(positions, faces):
    normals = np.zeros_like(positions)
    corners = positions[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for k in range(3):
        np.add.at(normals, faces[:, k], across)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)


def jittered(positions, faces, random):
    edge = np.linalg.norm(positions[faces[:, 0]] - positions[faces[:, 1]], axis=1).mean()
    normals = normals_of(positions, faces)
    moves = random.normal(size=positions.shape)
    moves -= (moves * normals).sum(axis=1, keepdims=True) * normals
    return positions + JITTER * edge * moves


def cut_in_four(positions, faces):
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, middle = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = len(positions) + middle.reshape(-1).reshape(3, -1)
    a, b, c = faces.T
    four = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    points = np.concatenate([positions, positions[edges].mean(axis=1)])
    return points, np.concatenate([np.stack(f, axis=1) for f in four])


def write(path, positions, faces):
    intents = nibabel.nifti1.intent_codes
    arrays = [
        nibabel.gifti.GiftiDataArray(positions.astype(np.float32), intents["NIFTI_INTENT_POINTSET"]),
        nibabel.gifti.GiftiDataArray(faces.astype(np.int32), intents["NIFTI_INTENT_TRIANGLE"]),
    ]
    nibabel.save(nibabel.gifti.GiftiImage(darrays=arrays), path)
    return path


def variants(chosen, folder):
    """Kind, surface and centre of every run."""
    centre = np.array([float(x) for x in chosen.center.split(",")])
    yield "as it is", chosen.surface, centre
    for step in chosen.shifts:
        for axis in range(3):
            for sign in (-1, 1):
                yield "shifted", chosen.surface, centre + sign * step * np.eye(3)[axis]
    read = nibabel.load(chosen.surface)
    positions, faces = read.darrays[0].data.astype(float), read.darrays[1].data
    random = np.random.default_rng(chosen.seed)
    for n in range(chosen.jitters):
        path = write(f"{folder}/jittered{n}.surf.gii", jittered(positions, faces, random), faces)
        yield "jittered", path, centre
    if not chosen.uncut:
        yield "cut in four", write(f"{folder}/four.surf.gii", *cut_in_four(positions, faces)), centre


def unfold(chosen, surface, centre, out):
    words = [chosen.program, "unfold", surface, "--radius", str(chosen.radius)]
    words += ["--center=" + ",".join(f"{x:.4f}" for x in centre), f"--direction={chosen.direction}"]
    words += ["--surround", chosen.surround, "--out", out, "--force", "--quiet"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        return None
    return json.loads(pathlib.Path(out, "summary.json").read_text(encoding="utf-8"))


def say(kind, results):
    def column(key):
        return np.array([r[key] if r[key] is not None else np.nan for r in results])

    seen, visible, strain = column("seen_final"), column("visibility_final"), column("edge_strain_mean")
    print(
        f"{kind}: {len(results)} runs, visibility {visible.min():.4f} {np.median(visible):.4f}, "
        f"seen {seen.min():.4f} {np.median(seen):.4f}, strain {100 * strain.max():.2f} {100 * np.median(strain):.2f} %, "
        f"stretch {column('collar_stretch_max').max():.1f}, new crossings {sum(column('self_intersections_new')):.0f}, "
        f"flags {sorted({r['flag'] for r in results if r['flag']})}"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("surface")
    parser.add_argument("--center", required=True)
    parser.add_argument("--radius", type=float, required=True)
    parser.add_argument("--direction", required=True)
    parser.add_argument("--surround", default="elastic")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--shifts", type=float, nargs="*", default=[0.5, 1, 2])
    parser.add_argument("--jitters", type=int, default=6)
    parser.add_argument("--uncut", action="store_true")
    chosen = parser.parse_args()
    results = {}
    with tempfile.TemporaryDirectory() as folder:
        for kind, surface, centre in variants(chosen, folder):
            summary = unfold(chosen, surface, centre, folder + "/u")
            if summary is None:
                print(f"{kind}: refused")
                continue
            results.setdefault(kind, []).append(summary)
            print(
                f"{kind} {centre}: {summary['visibility_final']:.4f}, {100 * summary['edge_strain_mean']:.2f} %, "
                f"{summary['iterations']} iterations {summary['flag']}",
                flush=True,
            )
    for kind, found in results.items():
        say(kind, found)


if __name__ == "__main__":
    main()
