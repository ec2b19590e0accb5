# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Random patches of the surfaces at hand, unfolded with default options; called by patches.sh.

A seed fixes a patch: the person, the hemisphere, the surface (white, half way, pial), a vertex, a radius of 12 to 35 mm
(scaled by the root of the hemisphere's area over 90,000 mm^2, a human pial surface's), and the direction of the viewpoint:
along the mean normal of the ball about the vertex, or, one seed in five, turned away from it by 40 to 70 degrees.
Seconds are processor time of the whole command, user and system.

Seeds 0 to 199 are the measure of an unfolding in place.  A campaign takes other seeds (1000 and on), of which each third has
elastic, fixed and no surroundings: every method that promises that nothing new crosses.  It goes on from the rows that are
there, so that it can be stopped at any time.
"""
import argparse
import functools
import itertools
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import nibabel as nib
import numpy as np

SHARED = pathlib.Path(__file__).resolve().parents[3] / "shared"
DATA = SHARED / "data"
HUMAN = 90000.0  # mm^2
GOALS = {"visibility": 0.98, "seen": 0.98, "strain": 0.09}
SURROUNDS = ("elastic", "fixed", "none")
FIRST_OF_CAMPAIGN = 1000
COLUMNS = ["seed", "half", "surround", "person", "surface", "vertex", "radius", "turned", "faces", "exit", "verdict", "flag", "visibility", "seen",
           "strain", "area", "collar_mean", "collar_max", "iterations", "seconds", "new", "rest", "referee", "account", "met"]


def read(path):
    """Positions and faces."""
    if ".gii" in path.name:
        image = nib.load(path)
        return image.darrays[0].data.astype(float), image.darrays[1].data
    positions, faces = nib.freesurfer.read_geometry(path)[:2]
    return positions.astype(float), faces


def make(program, work):
    """Surfaces that no folder of ../shared/data has: of bert's ribbon, of Colin27's T1 and of the macaque's labels."""
    templates = pathlib.Path("/usr/share/mricron/templates")
    made = work / "surfaces"

    def once(name, *words):
        if not (made / name / "summary.json").exists():
            subprocess.run([program, *words, "--out", made / name, "--force", "--quiet"], check=False)

    for side in ("L", "R"):
        once(f"bert-{side}", "surface", DATA / "bert_freesurfer/mri/ribbon.mgz", "--preset", "ribbon", "--hemisphere", side)
    if not templates.exists():
        return
    if not (made / "labels/seg_R.nii.gz").exists():
        script = pathlib.Path(__file__).resolve().parents[2] / "Modules/Flattening/benchmark/macaque_labels.py"
        subprocess.run([sys.executable, script, made / "labels"], check=True)
    for side in ("L", "R"):
        once(f"macaque-{side}", "surface", made / f"labels/seg_{side}.nii.gz", "--white-label", "3", "--grey-label", "2", "--faces", "80000")
    if not (made / "Colin27-R/summary.json").exists():
        once("colin27", "run", templates / "ch2.nii.gz", "--steps", "segment,surface")
        for side in ("L", "R"):
            if (made / f"colin27/surface-{side}").exists():
                (made / f"Colin27-{side}").symlink_to(f"colin27/surface-{side}")


def people(work):
    """For each person and hemisphere, the files of its surfaces; the same names whatever is at hand, so that a seed is a patch."""
    found = {f"fsaverage5-{side}": {k: DATA / f"fsaverage5/{k}_{side}.gii.gz" for k in ("white", "pial")} for side in ("left", "right")}
    found["S1"] = {"white": DATA / "s1_pycortex_lh/wm_lh.gii", "pial": DATA / "s1_pycortex_lh/pia_lh.gii"}
    for person in ("OAS1_0001", "OAS1_0003"):
        found[person] = {"white": DATA / f"oasis_sd/{person}/lh.white"}
    for person in ("bert-L", "bert-R", "Colin27-L", "Colin27-R", "macaque-L", "macaque-R"):
        found[person] = {k: work / "surfaces" / person / f"{k}.surf.gii" for k in ("white", "pial")}
    return found


@functools.lru_cache(maxsize=4)
def surface_of(files, kind):
    files = dict(files)
    if kind != "mid":
        return read(files[kind])
    white, pial = read(files["white"]), read(files["pial"])
    return (white[0] + pial[0]) / 2, white[1]


def areas_of(positions, faces):
    corners = positions[faces]
    return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def patch_of(seed, everyone):
    random = np.random.default_rng(seed)
    person = random.choice(sorted(everyone))
    files = everyone[person]
    kind = random.choice(["white", "mid", "pial"] if len(files) > 1 else ["white"])
    campaign = seed >= FIRST_OF_CAMPAIGN
    patch = {"seed": seed, "half": "campaign" if campaign else "judge" if seed % 2 else "settle",
             "surround": SURROUNDS[seed % 3] if campaign else "elastic", "person": str(person), "surface": str(kind)}
    if not all(path.exists() for path in files.values()):
        return patch | {"turned": 0, "verdict": "surface not at hand"}, None, None
    positions, faces = surface_of(tuple(sorted(files.items())), kind)
    areas = areas_of(positions, faces)
    scale = np.sqrt(np.linalg.norm(areas, axis=1).sum() / HUMAN)
    vertex, radius = int(random.integers(len(positions))), float(random.uniform(12, 35)) * min(1.0, scale)
    near = np.linalg.norm(positions[faces].mean(axis=1) - positions[vertex], axis=1) < radius
    normal = areas[near].sum(axis=0)
    normal /= np.linalg.norm(normal)
    turned = seed % 5 == 4
    if turned:
        across = np.cross(normal, random.normal(size=3))
        angle = np.radians(random.uniform(40, 70))
        normal = np.cos(angle) * normal + np.sin(angle) * across / np.linalg.norm(across)
    return patch | {"vertex": vertex, "radius": radius, "turned": int(turned), "direction": list(normal)}, positions, faces


def write(path, positions, faces):
    scanner = nib.gifti.GiftiCoordSystem(1, 1)
    arrays = [nib.gifti.GiftiDataArray(positions.astype(np.float32), "NIFTI_INTENT_POINTSET", coordsys=scanner),
              nib.gifti.GiftiDataArray(faces.astype(np.int32), "NIFTI_INTENT_TRIANGLE")]
    nib.save(nib.gifti.GiftiImage(darrays=arrays), path)


def pairs(referee, positions, faces, folder):
    """Intersecting pairs by the referee's exact test."""
    path = folder / "mesh.off"
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(positions)} {len(faces)} 0\n")
        np.savetxt(file, positions, "%.9g")
        np.savetxt(file, np.c_[np.full(len(faces), 3), faces], "%d")
    text = subprocess.run([referee, path], capture_output=True, text=True, check=True).stdout
    return int(text.split("self_intersecting_pairs ")[1].split()[0])


def account(out, start, faces, summary):
    """Largest relative difference between the summary and what the written files give."""
    reference = out / "reference.surf.gii"
    before = (read(reference)[0] if reference.exists() else start).astype(np.float32).astype(float)
    after, kept = read(out / "unfolded.surf.gii")
    marked = nib.load(out / "region.label.gii").darrays[0].data > 0
    inside = marked[kept].all(axis=1)
    moved = (after != before).any(axis=1)[kept].any(axis=1) & ~inside
    old, new = (np.linalg.norm(areas_of(p, kept), axis=1) for p in (before, after))
    ratio = new / np.where(old > 0, old, np.inf)
    edges = np.unique(np.sort(np.concatenate([kept[inside][:, [0, 1]], kept[inside][:, [1, 2]], kept[inside][:, [2, 0]]])), axis=0)
    length = [np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (before, after)]
    again = {"edge_strain_mean": np.abs(length[1] / length[0] - 1).mean(), "area_error_mean": np.abs(ratio[inside] - 1).mean()}
    if moved.any():
        again["collar_stretch_max"] = ratio[moved].max()
    eye = np.array(summary["viewpoint"])
    towards = eye - after[kept[inside]].mean(axis=1)
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    vectors = areas_of(after, kept[inside])
    again["visibility_final"] = (vectors * towards).sum() / np.linalg.norm(vectors, axis=1).sum()
    return max(abs(summary[key] / value - 1) for key, value in again.items())


def unfold(asked, patch, positions, faces, folder):
    surface, out = folder / "patch.surf.gii", folder / "out"
    write(surface, positions, faces)
    words = [asked.program, "unfold", surface, "--vertex", patch["vertex"], "--radius", f"{patch['radius']:.4f}",
             "--direction=" + ",".join(f"{x:.6f}" for x in patch["direction"]), "--surround", patch["surround"], "--out", out,
             "--force", "--quiet", *asked.more]
    process = subprocess.Popen([str(w) for w in words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    error = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    patch["exit"] = os.waitstatus_to_exitcode(status)
    patch["seconds"] = used.ru_utime + used.ru_stime
    if patch["exit"] not in (0, 3):
        patch["verdict"] = error.strip().splitlines()[-1][:90]
        return
    s = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    patch |= {"faces": s["region_faces"], "verdict": s["verdict"], "flag": s["flag"], "visibility": s["visibility_final"],
              "seen": s["seen_final"], "strain": s["edge_strain_mean"], "area": s["area_error_mean"],
              "collar_mean": s.get("collar_stretch_mean"), "collar_max": s.get("collar_stretch_max"), "iterations": s["iterations"],
              "new": s["self_intersections_new"], "rest": s["crossings_with_rest"]}
    start = positions.astype(np.float32).astype(float)
    patch["account"] = account(out, start, faces, s)
    if asked.referee:
        after, kept = read(out / "unfolded.surf.gii")
        left = s["self_intersections_initial"] - s["self_intersections_repaired"]
        if patch["surround"] == "none":  # what crossed elsewhere is not written
            left = pairs(asked.referee, start, kept, folder)
        patch["referee"] = pairs(asked.referee, after, kept, folder) - left
    patch["met"] = int(s["visibility_final"] >= 0.98 and s["seen_final"] >= 0.98 and s["edge_strain_mean"] <= 0.09)


def row_of(asked, seed, everyone):
    kept = asked.work / "rows" / f"{seed:03d}.json"
    if kept.exists():
        return json.loads(kept.read_text(encoding="utf-8"))
    patch, positions, faces = patch_of(seed, everyone)
    if positions is None:
        return patch
    with tempfile.TemporaryDirectory() as folder:
        unfold(asked, patch, positions, faces, pathlib.Path(folder))
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(patch, default=float), encoding="utf-8")
    return patch


def text_of(value):
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def summarise(rows):
    """For each half and kind of viewpoint: median, worst tenth and worst, and the shares that meet each goal."""
    lines = []
    for half, surround, turned in itertools.product(("settle", "judge", "campaign"), SURROUNDS, (0, 1)):
        if half == "campaign" or surround == "elastic":
            some = [r for r in rows if r["half"] == half and r["surround"] == surround and r["turned"] == turned]
            ended = [r for r in some if "visibility" in r]
            if not ended:
                continue
            lines.append(f"{half}, {surround}, {'badly chosen' if turned else 'mean normal'}: {len(some)} patches, {len(ended)} unfolded, "
                         f"{sum(r['met'] for r in ended)} meet all goals; new crossings {sum(r['new'] for r in ended)}, "
                         f"by the referee {sum(max(0, r.get('referee', 0)) for r in ended)}; "
                         f"misses not said {sum(not r['met'] and r['verdict'] == 'right' for r in ended)}, with exit 0 "
                         f"{sum(not r['met'] and r['exit'] == 0 for r in ended)}; "
                         f"account off by {max(r['account'] for r in ended):.2g} at most")
            for key, worst in (("visibility", 10), ("seen", 10), ("strain", 90), ("collar_mean", 90), ("collar_max", 90), ("seconds", 90)):
                values = np.array([r[key] for r in ended if r[key] is not None])
                if not len(values):  # no surroundings, no collar
                    continue
                pick = min if worst == 10 else max
                share = f", goal met by {np.mean(values >= 0.98 if worst == 10 else values <= 0.09):.0%}" if key in GOALS else ""
                lines.append(f"  {key}: median {np.median(values):.4g}, worst tenth {np.percentile(values, worst):.4g}, "
                             f"worst {pick(values):.4g}{share}")
    return lines


def seeds_of(asked):
    if asked.campaign:
        return range(FIRST_OF_CAMPAIGN, FIRST_OF_CAMPAIGN + asked.campaign)
    if asked.seeds:
        first, last = asked.seeds.split("-") if "-" in asked.seeds else (asked.seeds, asked.seeds)
        return range(int(first), int(last) + 1)
    wanted = {"settle": [0], "judge": [1], "both": [0, 1]}[asked.half]
    return [s for s in range(200) if s % 2 in wanted][:asked.count]


def main():
    given = sys.argv[1:]
    cut = given.index("--") if "--" in given else len(given)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--seeds")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--campaign", type=int, metavar="N", help="the first N patches of the campaign")
    parser.add_argument("--half", choices=["settle", "judge", "both"], default="both")
    parser.add_argument("--make", action="store_true", help="make the surfaces that ../shared/data does not have first")
    parser.add_argument("--referee", help="selfintersect of ../shared/referee, built")
    asked = parser.parse_args(given[:cut])
    asked.more, asked.program = given[cut + 1:], asked.program.resolve()
    if not DATA.exists():
        sys.exit("patches: no surfaces in ../shared/data")
    if asked.make:
        make(asked.program, asked.work)
    everyone = people(asked.work)
    rows = []
    for seed in seeds_of(asked):
        rows.append(row_of(asked, seed, everyone))
        print("\t".join(text_of(rows[-1].get(c)) for c in COLUMNS), flush=True)
    lines = ["\t".join(COLUMNS)] + ["\t".join(text_of(r.get(c)) for c in COLUMNS) for r in rows]
    (asked.work / "patches.tsv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(summarise(rows)))


if __name__ == "__main__":
    main()
