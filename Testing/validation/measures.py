# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The measurements: each returns its numbers, and draws its figure beside the page if it has one."""

import pathlib
from dataclasses import dataclass

import nibabel as nib
import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

import figures
from harness import Measured, real

BERT_FACES = 150000


# ---- thickness of shapes whose thickness is known ----

def shell_errors(explica, spacing, levels):
    """Mean absolute error of a shell's thickness, mm; the shell is 9.6 mm thick at any voxel size."""
    size = round(64 / spacing)
    phantom = explica("phantom", "shell", "--size", size, "--spacing", spacing, out=f"shell-{size}")
    where = ["--inner-level", phantom / "level.nii.gz", "--outer-level",
             phantom / "outer_level.nii.gz"] if levels else [
                 phantom / "labels.nii.gz", "--inner", 1, "--tissue", 2]
    made = explica("thickness", *where, out=f"shell-{size}-{'levels' if levels else 'labels'}")
    found = nib.load(made / "thickness.nii.gz").get_fdata()
    exact = nib.load(phantom / "thickness.nii.gz").get_fdata()
    at = found > 0
    return float(np.abs(found - exact)[at].mean()), made.command


def shells(explica, page):
    spacings = [4, 2, 1, 0.5]
    errors = {}
    rows = []
    for levels, name in ((False, "labels"), (True, "level sets")):
        errors[name] = []
        for spacing in spacings:
            error, command = shell_errors(explica, spacing, levels)
            errors[name].append(error)
            if spacing == 1:
                rows.append(Measured(f"thickness from {name}, mean absolute error",
                                     "shell of 9.6 mm, 1 mm voxels", error, "mm",
                                     0.1 * error + 1e-4, command))
        order = float(-np.polyfit(np.log(1 / np.array(spacings)), np.log(errors[name]), 1)[0])
        rows.append(Measured(f"thickness from {name}, order of convergence",
                             "shells of 4 to 0.5 mm voxels", order, "", 0.15, command))
    figures.errors_over_spacing(page / "shells.svg", spacings, errors)
    return rows


# ---- cortical thickness beside FreeSurfer's ----

def freesurfer_regions(side):
    """Mean thickness of each region as FreeSurfer's own statistics state it, mm."""
    lines = real("bert_freesurfer", "stats", f"{side}h.aparc.stats").read_text().splitlines()
    cells = [line.split() for line in lines if line and not line.startswith("#")]
    return {c[0]: float(c[4]) for c in cells}


def known_points(side):
    """Position (RAS mm) and FreeSurfer's thickness of points of its white surface."""
    table = np.genfromtxt(real("bert_freesurfer", f"{side}h.thickness_at_known_vertices.csv.gz"),
                          delimiter=",", names=True, dtype=None, encoding="utf-8")
    points = np.stack([table["ras_x"], table["ras_y"], table["ras_z"]], axis=1)
    inside = table["thickness_mm"] > 0
    return points[inside], table["thickness_mm"][inside]


def nearest_faces(points, positions, faces, count=12):
    """Distance of points from a triangulated surface, mm, and the nearest face: of those whose
    centres are nearest."""
    _, near = cKDTree(positions[faces].mean(axis=1)).query(points, k=count, workers=-1)
    apart = np.stack([distance_to_triangles(points, positions[faces[near[:, k]]])
                      for k in range(count)], axis=1)
    best = apart.argmin(axis=1)
    rows = np.arange(len(points))
    return apart[rows, best], near[rows, best]


def at_points(points, positions, corners, values):
    """Values at points: the mean over a face's corners, the nearer the more; 0 (not measured) at a
    corner makes the mean 0."""
    apart = np.linalg.norm(positions[corners] - points[:, None, :], axis=2)
    weight = 1 / np.maximum(apart, 1e-6)
    mean = (weight * values[corners]).sum(axis=1) / weight.sum(axis=1)
    return np.where((values[corners] > 0).all(axis=1), mean, 0)


def distance_to_triangles(p, t):
    """Distance of each point from its own triangle (n x 3 x 3): inside the face's plane region the
    plane's, else the nearest side's."""
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    height = np.einsum("ij,ij->i", p - a, normal)
    foot = p - height[:, None] * normal
    inside = np.ones(len(p), dtype=bool)
    sides = np.full(len(p), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        inside &= np.einsum("ij,ij->i", np.cross(along, foot - start), normal) >= 0
        share = np.einsum("ij,ij->i", p - start, along) / np.maximum(
            np.einsum("ij,ij->i", along, along), 1e-12)
        at = start + np.clip(share, 0, 1)[:, None] * along
        sides = np.minimum(sides, np.linalg.norm(p - at, axis=1))
    return np.where(inside, np.abs(height), sides)


@dataclass
class Comparison:
    """One hemisphere beside FreeSurfer's: at the points whose thickness its files state (all, and
    where ours is known), and the regions that both name."""
    apart: np.ndarray  # of the points from our white surface, mm
    points: np.ndarray  # ours and theirs, mm
    regions: np.ndarray  # ours and theirs, mean thickness, mm
    names: tuple  # of the regions


def map_named(path, name):
    """One map of a GIFTI file by its name, a value per vertex."""
    return next(d.data for d in nib.load(path).darrays if d.meta["Name"] == name).astype(float)


def compare_with_freesurfer(made, side, motion=np.eye(4), measure="thickness"):
    """What a surface step made of bert's head, or of that head moved by motion (RAS mm), by one of the maps of
    thickness.shape.gii."""
    white = nib.load(made / "white.surf.gii")
    positions, faces = white.agg_data("pointset").astype(float), white.agg_data("triangle")
    thickness = map_named(made / "thickness.shape.gii", measure)
    points, reference = known_points(side)
    points = nib.affines.apply_affine(motion, points)
    apart, face = nearest_faces(points, positions, faces)
    at = at_points(points, positions, faces[face], thickness)
    theirs = freesurfer_regions(side)
    rows = [row for row in made.table("regions.tsv") if row["name"] in theirs]
    # FreeSurfer's means are over white vertices, ours in regions.tsv over the tissue's middle surface.
    labels = nib.load(made / "regions.label.gii").agg_data()
    areas = nib.load(made / "area.shape.gii").darrays[0].data * (thickness > 0)
    means = [np.average(thickness, weights=areas * (labels == int(row["index"]))) for row in rows]
    return Comparison(apart, np.stack([at, reference])[:, at > 0],
                      np.array([(mean, theirs[row["name"]]) for mean, row in zip(means, rows)]).T,
                      tuple(row["name"] for row in rows))


def beside_freesurfer(explica, page, made, side, kind):
    """Numbers of one hemisphere of bert against FreeSurfer's, vertex by vertex and by region."""
    on = f"bert, {'left' if side == 'l' else 'right'}, from {kind}"
    found = compare_with_freesurfer(made, side)
    at, reference = found.points
    b, a = found.regions
    nearest = compare_with_freesurfer(made, side, measure="thickness_nearest")
    figures.scatter_and_bland_altman(page / f"bert-{side}h-{kind.replace(' ', '-')}.svg",
                                     found.names, a, b, on)
    command = made.command
    return [
        Measured("known points to white surface, mean distance", on, float(found.apart.mean()), "mm",
                 0.02, command),
        Measured("thickness at known points, correlation", on,
                 float(np.corrcoef(at, reference)[0, 1]), "", 0.01, command),
        Measured("thickness at known points, mean absolute difference", on,
                 float(np.abs(at - reference).mean()), "mm", 0.02, command),
        Measured("thickness at known points, mean difference", on,
                 float((at - reference).mean()), "mm", 0.03, command),
        Measured("regional mean thickness, correlation", on, float(np.corrcoef(a, b)[0, 1]), "",
                 0.01, command),
        Measured("regional mean thickness, mean difference", on, float((b - a).mean()), "mm", 0.03,
                 command),
        Measured("regional mean thickness, largest difference", on, float(np.abs(b - a).max()),
                 "mm", 0.08, command),
        Measured("nearest distance at known points, mean difference", on,
                 float((nearest.points[0] - nearest.points[1]).mean()), "mm", 0.03, command),
        Measured("regional mean of the nearest distance, mean difference", on,
                 float((nearest.regions[0] - nearest.regions[1]).mean()), "mm", 0.03, command),
        Measured("pairs of faces that cross, white and pial", on,
                 made.summary["self_intersections"], "", 0, command),
    ]


def freesurfer_labels(explica, page):
    atlas = real("bert_freesurfer", "mri", "aparc+aseg.mgz")
    ribbon = real("bert_freesurfer", "mri", "ribbon.mgz")
    rows = []
    for side in "lr":
        made = explica("surface", ribbon, "--hemisphere", side.upper(), "--atlas", atlas,
                       out=f"bert-{side}")
        rows += beside_freesurfer(explica, page, made, side, "labels")
        rows.append(Measured("seconds of the whole command",
                             f"bert, {'left' if side == 'l' else 'right'}, {BERT_FACES} faces",
                             made.seconds, "s", 2 * made.seconds, made.command))
    return rows


def signed_offset(made, reference, name):
    """Mean signed distance of a surface from another one where both are cortex, by area, mm;
    positive outward."""
    ours, theirs = (nib.load(folder / f"{name}.surf.gii") for folder in (made, reference))
    positions, faces = ours.agg_data("pointset").astype(float), ours.agg_data("triangle")
    points, corners = theirs.agg_data("pointset").astype(float), theirs.agg_data("triangle")
    cortex, beside = (nib.load(folder / "thickness.shape.gii").darrays[0].data > 0
                      for folder in (made, reference))
    apart, face = nearest_faces(positions, points, corners)
    t = points[corners[face]]
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    side = np.sign(np.einsum("ij,ij->i", positions - t.mean(axis=1), normal))
    own = positions[faces]
    area = np.linalg.norm(np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]), axis=1) / 6
    weight = np.bincount(faces.ravel(), np.repeat(area, 3), len(positions))
    weight *= cortex & beside[corners[face]].all(axis=1)
    return float((weight * side * apart).sum() / weight.sum())


def beside_aseg(explica, made, side):
    """Our surfaces from a T1 beside those that FreeSurfer's labels of the same head give."""
    on = f"bert, {'left' if side == 'l' else 'right'}, from T1"
    labels = explica("surface", real("bert_freesurfer", "mri", "aseg.mgz"), "--hemisphere",
                     side.upper(), out=f"bert-aseg-{side}")
    return [Measured(f"{name} surface from that of aseg, mean, outward positive", on,
                     signed_offset(made, labels, name), "mm", 0.03, made.command)
            for name in ("white", "pial")]


def phantom_borders(explica, page):
    """White and outer border of a ribbon of 2.5 mm in a T1, beside fluid of several widths."""
    del page
    rows = []
    dura = ["--dura", 1, "--dura-gap", 1]
    for title, words, noise in (("wide fluid", [], 3), ("1 mm of fluid to a sheet of dura", dura, 3),
                                ("1 mm of fluid to a sheet of dura", dura, 6)):
        out = f"ribbon-{'dura' if words else 'wide'}-{noise}"
        phantom = explica("phantom", "cortex", "--size", 48, "--ventricle", 4, "--noise", noise,
                          *words, out=out)
        tissue = explica("segment", phantom / "t1.nii.gz", "--template", "none", "--accept",
                         "brain-volume", out=out + "-tissue")
        made = explica("surface", "--inner-level", tissue / "wm.nii.gz", "--grey-share",
                       tissue / "gm.nii.gz", "--image", phantom / "t1.nii.gz", "--fluid",
                       f"{tissue.summary['fluid_of_white']:.3f}", "--faces", 8000,
                       out=out + "-surface")
        level = nib.load(phantom / "level.nii.gz")
        for name, depth in (("white", 0.0), ("pial", phantom.summary["thickness"])):
            at = nib.load(made / f"{name}.surf.gii").agg_data("pointset").astype(float)
            index = nib.affines.apply_affine(np.linalg.inv(level.affine), at)
            off = map_coordinates(level.get_fdata(), index.T, order=1) - depth
            rows.append(Measured(f"{name} surface, mean, outward positive",
                                 f"ribbon of 2.5 mm, {title}, noise {noise}",
                                 float(off.mean()), "mm", 0.02, made.command))
    return rows


def freesurfer_image(explica, page):
    """From the T1 alone; the parcellation is used for regions and sides only."""
    made = explica("run", real("bert_freesurfer", "mri", "brain.mgz"), "--atlas",
                   real("bert_freesurfer", "mri", "aparc+aseg.mgz"), "--steps",
                   "segment,thickness,surface", out="bert-t1", done=(0, 3))
    rows = []
    for side in "lr":
        rows += beside_freesurfer(explica, page, made.step(f"surface-{side.upper()}"), side, "T1")
        rows += beside_aseg(explica, made.step(f"surface-{side.upper()}"), side)
    rows.append(Measured("seconds of the whole command", "bert, both hemispheres, from T1",
                         made.seconds, "s", 2 * made.seconds, made.command))
    return rows


# ---- unfolding in place ----

UNFOLDED = [
    ("fsaverage5 left pial, 25 mm", ("fsaverage5", "pial_left.gii.gz"),
     25, (-1, 0.2, 0.2)),
    ("fsaverage5 right white, 25 mm", ("fsaverage5", "white_right.gii.gz"),
     25, (1, 0.2, 0.2)),
    ("S1 left pial, 20 mm", ("s1_pycortex_lh", "pia_lh.gii"),
     20, (-1, 0.2, 0.2)),
    ("S1 left white, 20 mm", ("s1_pycortex_lh", "wm_lh.gii"),
     20, (-1, 0.2, 0.2)),
]


def unfolding(explica, page):
    """Patches about the vertex that lies farthest along a direction, opened towards it."""
    del page
    rows = []
    for on, path, radius, direction in UNFOLDED:
        surface = real(*path)
        farthest = int((nib.load(surface).agg_data("pointset") @ np.array(direction)).argmax())
        made = explica("unfold", surface, "--vertex", farthest, "--radius", radius,
                       "--direction=" + ",".join(map(str, direction)),
                       out=on.replace(",", "").replace(" ", "-"), done=(0, 3))
        s = made.summary
        new = s["self_intersections_final"] - s["self_intersections_initial"]
        rows += [
            Measured("average visibility", on, s["visibility_final"], "", 0.01, made.command),
            Measured("share of area seen", on, s["seen_final"], "", 0.01, made.command),
            Measured("mean area error", on, 100 * s["area_error_mean"], "%", 0.1, made.command),
            Measured("mean edge strain", on, 100 * s["edge_strain_mean"], "%", 0.7, made.command),
            Measured("mean stretch of the surroundings that move", on, s["collar_stretch_mean"],
                     "", 0.2, made.command),
            Measured("pairs of faces that cross, more than before", on, max(0, new), "", 0,
                     made.command),
            Measured("seconds of the whole command", on, made.seconds, "s", 2 * made.seconds + 1,
                     made.command),
        ]
    return rows


# ---- flat maps ----

def flat_maps(explica, page):
    rows, bars = [], {}
    for side in ("left", "right"):
        white = real("fsaverage5", f"white_{side}.gii.gz")
        shipped = real("fsaverage5", f"flat_{side}.gii.gz")
        on = f"fsaverage5 {side}, whole hemisphere"
        made = explica("flatten", white, "--cuts", shipped, out=f"flat-{side}", done=(0, 3))
        compared = explica("compare", white, made / "flat.surf.gii", shipped,
                           out=f"flat-{side}-compared")
        ours, theirs = compared.table("comparison.tsv")[:2]
        bars[on] = (ours, theirs)
        for key, what, tolerance in (("geodesic_error_local", "local distance error", 0.3),
                                     ("geodesic_error_all", "distance error over all pairs", 0.5)):
            for row, whose in ((ours, "ours"), (theirs, "FreeSurfer's")):
                rows.append(Measured(f"{what}, {whose}", on, 100 * float(row[key]), "%", tolerance,
                                     compared.command))
        for row, whose in ((ours, "ours"), (theirs, "FreeSurfer's")):
            rows.append(Measured(f"faces turned over, {whose}", on, float(row["turned_over"]), "",
                                 0, compared.command))
        rows.append(Measured("seconds of the whole command", on, made.seconds, "s",
                             2 * made.seconds + 1, made.command))
    figures.map_errors(page / "maps.svg", bars)
    return rows


# ---- volumes on surfaces ----

def sampled(explica, page):
    del page
    scan = real("bert_freesurfer", "mri", "brain.mgz")
    surfaces = explica("surface", real("bert_freesurfer", "mri", "ribbon.mgz"), "--hemisphere", "L",
                       "--atlas", real("bert_freesurfer", "mri", "aparc+aseg.mgz"), out="bert-l")
    image = nib.load(scan)
    ijk = np.stack(np.meshgrid(*map(np.arange, image.shape), indexing="ij"), axis=-1)
    place = nib.affines.apply_affine(image.affine, ijk).astype(np.float32)
    white, pial = (nib.load(surfaces / f"{name}.surf.gii").agg_data("pointset")
                   for name in ("white", "pial"))
    half = (white.astype(float) + pial) / 2
    worst, command = 0.0, ""
    for axis in range(3):
        volume = explica.folder / f"coordinate-{axis}.nii.gz"
        if not volume.exists():
            nib.save(nib.Nifti1Image(place[..., axis], image.affine), volume)
        made = explica("sample", volume, "--surfaces", surfaces.folder, "--depths", "0.5",
                       out=f"coordinate-{axis}-sampled")
        found = nib.load(next(pathlib.Path(made.folder).glob("*.func.gii"))).darrays[0].data
        worst = max(worst, float(np.abs(found - half[:, axis]).max()))
        command = made.command
    return [Measured("coordinates sampled half way from white to pial, largest error", "bert, left", worst, "mm",
                     1e-4, command)]


# ---- the heart ----

def heart(explica, page):
    del page
    phantom = explica("phantom", "ventricle", "--frames", 2, "--slice", 8, "--spacing", 1.4,
                      "--size", 96, "--tilt", 10, out="ventricle")
    frames = sorted(phantom.folder.glob("frame-*.nii.gz"))
    beat = explica("heart", *frames, out="ventricle-measured")
    exact = {(r["segment"], r["frame"]): float(r["thickness"])
             for r in phantom.table("segments_exact.tsv")}
    off = [abs(float(r["thickness"]) - exact[r["segment"], r["frame"]])
           for r in beat.table("segments.tsv")
           if r["frame"] == "0" and (r["segment"], r["frame"]) in exact
           and r["thickness"] != "n/a" and int(r["segment"]) < 17]
    volumes = [abs(float(a["cavity_volume_ml"]) / float(b["cavity_volume_ml"]) - 1)
               for a, b in zip(beat.table("frames.tsv"), phantom.table("frames_exact.tsv"))]
    on = "ventricle tilted by 10 degrees, 1.4 x 1.4 x 8 mm"
    rows = [
        Measured("thickness of segments 1 to 16, mean absolute error", on, float(np.mean(off)),
                 "mm", 0.05, beat.command),
        Measured("thickness of segments 1 to 16, largest error", on, float(np.max(off)), "mm", 0.1,
                 beat.command),
        Measured("cavity volume, largest error", on, 100 * max(volumes), "%", 0.3, beat.command),
    ]
    real_heart = explica("heart", real("lv_sunnybrook_SCD0000101", "ED_label.nii.gz"), out="heart")
    rings = [r for r in real_heart.table("slices.tsv") if r["thickness_plain"] != "n/a"]
    plain = np.array([float(r["thickness_plain"]) for r in rings])
    circles = np.array([float(r["area_equivalent"]) for r in rings])
    on = "SCD0000101, end diastole"
    return rows + [
        Measured("wall per slice beside circles of equal area, correlation", on,
                 float(np.corrcoef(plain, circles)[0, 1]), "", 0.01, real_heart.command),
        Measured("wall per slice beside circles of equal area, mean difference", on,
                 float(np.abs(plain - circles).mean()), "mm", 0.05, real_heart.command),
    ]


ALL = [
    ("Thickness where it is known", shells),
    ("Cortex from labels, beside FreeSurfer", freesurfer_labels),
    ("Cortex from a T1 alone, beside FreeSurfer", freesurfer_image),
    ("Borders in a T1 that are known", phantom_borders),
    ("Unfolding in place, default options", unfolding),
    ("Flat maps beside FreeSurfer's", flat_maps),
    ("Volumes on surfaces", sampled),
    ("The heart", heart),
]
