#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Labels of 1 mm out of a white and an outer surface, so that a cortex whose surfaces are known
everywhere can be measured from labels.

    labels_of_surfaces.py WHITE PIAL LABELS.nii.gz POINTS.txt

Writes the labels (2 white, 3 grey) and, at every third white vertex that has cortex, its place (RAS
mm) and thickness by FreeSurfer's definition: mean of the nearest distances both ways, at most 5 mm.
`explica surface LABELS.nii.gz --white-label 2 --grey-label 3` and thickness_errors.py then tell how much of the
surfaces labels give back.
"""
import argparse

import nibabel as nib
import numpy as np
import vtk
from scipy import ndimage
from scipy.spatial import cKDTree
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

MARGIN = 5  # voxels around the surfaces
MOST = 5  # mm, where FreeSurfer's thickness ends
NO_CORTEX = 0.3  # mm between corresponding vertices, below which there is none


def read(path):
    surface = nib.load(path)
    return surface.agg_data("pointset").astype(float), surface.agg_data("triangle")


def inside(points, faces, origin, size):
    """Voxels of 1 mm whose centres lie within a closed surface."""
    mesh, places, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    places.SetData(numpy_to_vtk(points, deep=True))
    rows = np.hstack([np.full((len(faces), 1), 3), faces]).astype(np.int64)
    cells.SetCells(len(faces), numpy_to_vtkIdTypeArray(rows.ravel(), deep=True))
    mesh.SetPoints(places)
    mesh.SetPolys(cells)
    stencil = vtk.vtkPolyDataToImageStencil()
    stencil.SetInputData(mesh)
    stencil.SetOutputOrigin(*origin)
    stencil.SetOutputSpacing(1, 1, 1)
    stencil.SetOutputWholeExtent(0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1)
    image = vtk.vtkImageStencilToImage()
    image.SetInputConnection(stencil.GetOutputPort())
    image.SetInsideValue(1)
    image.SetOutsideValue(0)
    image.SetOutputScalarTypeToUnsignedChar()
    image.Update()
    values = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
    return values.reshape(size[::-1]).transpose(2, 1, 0) > 0


def largest_piece(mask):
    pieces, _ = ndimage.label(mask)
    return pieces == np.argmax(np.bincount(pieces.ravel())[1:]) + 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("white", "pial", "labels", "points"):
        parser.add_argument(name)
    paths = parser.parse_args()
    white, faces = read(paths.white)
    pial, _ = read(paths.pial)
    origin = np.floor(pial.min(axis=0)) - MARGIN
    size = (np.ceil(pial.max(axis=0) - origin) + MARGIN + 1).astype(int)

    within = largest_piece(inside(white, faces, origin, size))
    # The stencil loses single rows of voxels where a surface all but touches itself.
    tissue = largest_piece(ndimage.binary_fill_holes(within | inside(pial, faces, origin, size)))
    labels = np.where(within, 2, np.where(tissue, 3, 0)).astype(np.uint8)
    affine = np.eye(4)
    affine[:3, 3] = origin
    nib.save(nib.Nifti1Image(labels, affine), paths.labels)

    apart = 0.5 * (cKDTree(pial).query(white)[0] + cKDTree(white).query(pial)[0])
    cortex = (np.linalg.norm(white - pial, axis=1) > NO_CORTEX) & (np.arange(len(white)) % 3 == 0)
    np.savetxt(paths.points, np.c_[white, np.minimum(apart, MOST)][cortex], fmt="%.4f")


if __name__ == "__main__":
    main()
