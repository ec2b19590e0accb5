#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""How much of a smooth brightness field `explica segment` finds, and what it costs: fields of 0.6 to 1.4 put on a brain
whose tissue labels are known.

    Modules/Segmentation/benchmark/fields.py build/bin/explica brain.mgz aseg.mgz [--widths 25 40] [--shapes ramp bump]

A row a width and field: slope of the estimated log field against the true one, the same less what is found without any
put on, Dice of white and grey matter against the labels within FreeSurfer's cerebrum, and against the labels found
without a field."""

import argparse
import pathlib
import subprocess
import tempfile

import nibabel
import numpy

WHITE, GREY = (2, 41, 77, 251, 252, 253, 254, 255), (3, 42)
SHAPES = {
    "ramp": lambda x, y, z: x,
    "bump": lambda x, y, z: 1 - 2 * numpy.minimum(1, x * x + y * y + z * z),
    "wave": lambda x, y, z: numpy.sin(1.6 * y + 0.4 * z),
}


def dice(a, b):
    return 2 * (a & b).sum() / (a.sum() + b.sum())


def segmented(explica, path, width, folder):
    out = folder / "out"
    subprocess.run([explica, "segment", str(path), "--template", "none", "--bias-width", str(width), "--quiet",
                    "--force", "--out", str(out)], check=False, stderr=subprocess.DEVNULL)
    return numpy.asarray(nibabel.load(out / "seg.nii.gz").dataobj), nibabel.load(out / "bias.nii.gz").get_fdata()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("explica")
    parser.add_argument("image")
    parser.add_argument("labels")
    parser.add_argument("--widths", type=float, nargs="+", default=[25])
    parser.add_argument("--shapes", nargs="+", choices=list(SHAPES), default=list(SHAPES))
    given = parser.parse_args()
    image = nibabel.load(given.image)
    brain = image.get_fdata()
    labels = numpy.asarray(nibabel.load(given.labels).dataobj)
    white, grey = numpy.isin(labels, WHITE), numpy.isin(labels, GREY)
    inside = white | grey
    places = numpy.argwhere(brain > 0)
    middle, reach = places.mean(axis=0), (places.max(axis=0) - places.min(axis=0)) / 2
    axes = [(numpy.arange(n) - middle[a]).reshape([-1 if b == a else 1 for b in range(3)]) / reach[a]
            for a, n in enumerate(brain.shape)]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for width in given.widths:
            plain, own = segmented(given.explica, given.image, width, folder)
            print(f"{width:g} mm, no field: Dice white {dice((plain == 3) & inside, white):.3f}, "
                  f"grey {dice((plain == 2) & inside, grey):.3f}", flush=True)
            for shape in given.shapes:
                field = numpy.broadcast_to(1 + 0.4 * numpy.clip(SHAPES[shape](*axes), -1, 1), brain.shape)
                shaded = folder / "shaded.nii.gz"
                nibabel.save(nibabel.Nifti1Image((brain * field).astype(numpy.float32), image.affine), shaded)
                found, bias = segmented(given.explica, shaded, width, folder)
                at = inside & (bias > 0) & (own > 0)
                true = numpy.log(field[at])
                slopes = [numpy.polyfit(true, log, 1)[0]
                          for log in (numpy.log(bias[at]), numpy.log(bias[at]) - numpy.log(own[at]))]
                print(f"{width:g} mm, {shape} {field[inside].min():.2f} to {field[inside].max():.2f}: slope "
                      f"{slopes[0]:.2f}, less its own {slopes[1]:.2f}; Dice white "
                      f"{dice((found == 3) & inside, white):.3f}, grey {dice((found == 2) & inside, grey):.3f}; "
                      f"with and without {dice(found == 3, plain == 3):.3f}, {dice(found == 2, plain == 2):.3f}",
                      flush=True)


if __name__ == "__main__":
    main()
