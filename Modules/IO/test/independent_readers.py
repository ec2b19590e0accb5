# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What nibabel says of our files, and files of nibabel's for us: run by IndependentReadersTest.cpp.

    independent_readers.py CHECK FOLDER

Our files stand in FOLDER beside what is expected of them; a failed check exits with 1 and says why.
"""

import gzip
import sys
import warnings
from pathlib import Path

try:
    import nibabel as nib
    import numpy as np
except ImportError as missing:
    print(f"{missing.name} is missing: apt-get install python3-nibabel (Testing/packages.txt)")
    sys.exit(1)


def expected(folder, stem):
    """Affine, values with i fastest."""
    lines = (folder / f"{stem}.txt").read_text().split("\n")
    shape = tuple(int(n) for n in lines[0].split())
    affine = np.array([float(x) for x in lines[1].split()]).reshape(4, 4)
    values = np.fromfile(folder / f"{stem}.raw", dtype="<f8").reshape(shape, order="F")
    return affine, values


def put_expected(folder, stem, affine, values):
    values = np.asarray(values, dtype="<f8")
    shape = " ".join(str(n) for n in values.shape)
    numbers = " ".join(repr(float(x)) for x in np.asarray(affine, dtype=float).ravel())
    (folder / f"{stem}.txt").write_text(f"{shape}\n{numbers}\n")
    values.ravel(order="F").tofile(folder / f"{stem}.raw")


def our_volumes(folder):
    for path in sorted(folder.iterdir()):
        if path.suffix in (".txt", ".raw"):
            continue
        affine, values = expected(folder, path.name)
        image = nib.load(path)
        assert image.shape == values.shape, (path, image.shape, values.shape)
        assert np.abs(image.affine - affine).max() < 2e-5, (path, image.affine - affine)
        assert np.array_equal(np.asarray(image.dataobj, dtype="<f8"), values), path
        if isinstance(image, (nib.Nifti1Image, nib.Nifti2Image)):
            header = image.header
            qform, qcode = header.get_qform(coded=True)
            sform, scode = header.get_sform(coded=True)
            assert (int(qcode), int(scode)) == (1, 1), path
            assert np.abs(qform - sform).max() < 2e-5, (path, qform - sform)
            assert header.get_xyzt_units()[0] == "mm", path
            stem = path.name.split(".")[0]
            intent = {"vectors": "vector", "labels": "label"}.get(stem, "none")
            assert header.get_intent()[::2] == (intent, stem), (path, header.get_intent())
        if path.name.startswith("labels."):
            assert image.get_data_dtype().kind in "iu", (path, image.get_data_dtype())


def oblique():
    from math import cos, sin
    a, b = 0.3, -1.1
    first = np.array([[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]])
    second = np.array([[1, 0, 0], [0, cos(b), -sin(b)], [0, sin(b), cos(b)]])
    affine = np.eye(4)
    affine[:3, :3] = first @ second @ np.diag([0.75, 1.25, 3.0])
    affine[:3, 3] = [-12.5, 40.25, 7.0]
    return affine


def their_volumes(folder):
    rng = np.random.default_rng(7)
    affine = oblique()
    shape = (5, 4, 3)
    small = rng.integers(1, 100, shape)
    for name in ("uint8", "int16", "int32", "float32"):
        values = small.astype(name)
        nib.save(nib.MGHImage(values, affine), folder / f"{name}.mgz")
        put_expected(folder, f"{name}.mgz", affine, values)
    nib.save(nib.MGHImage(small.astype("float32"), affine), folder / "plain.mgh")
    put_expected(folder, "plain.mgh", affine, small)

    for name in ("uint8", "int8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
                 "float32", "float64"):
        for kind, version in ((nib.Nifti1Image, 1), (nib.Nifti2Image, 2)):
            for endian in "<>":
                header = kind.header_class(endianness=endian)
                header.set_data_dtype(np.dtype(name))
                image = kind(small.astype(name), affine, header)
                image.set_sform(affine, 1)
                image.set_qform(affine, 1)
                stem = f"{name}-{version}-{'little' if endian == '<' else 'big'}.nii.gz"
                nib.save(image, folder / stem)
                put_expected(folder, stem, affine, small)
    scaled = nib.Nifti1Image(small * 0.25, affine)
    scaled.set_data_dtype(np.int16)  # nibabel chooses slope and intercept
    scaled.set_qform(None, 0)
    nib.save(scaled, folder / "scaled.nii")
    put_expected(folder, "scaled.nii", affine, nib.load(folder / "scaled.nii").get_fdata())


def our_surfaces(folder):
    positions = np.fromfile(folder / "positions.raw", dtype="<f8").reshape(-1, 3)
    faces = np.fromfile(folder / "faces.raw", dtype="<i4").reshape(-1, 3)
    values = np.fromfile(folder / "values.raw", dtype="<f8")
    keys = np.fromfile(folder / "keys.raw", dtype="<i4")
    exact = positions.astype("f4")

    surface = nib.load(folder / "a.surf.gii")
    points, triangles = surface.agg_data(("pointset", "triangle"))
    assert points.dtype == np.float32 and np.array_equal(points, exact)
    assert triangles.dtype == np.int32 and np.array_equal(triangles, faces)
    coordinates = surface.darrays[0].coordsys
    assert (coordinates.dataspace, coordinates.xformspace) == (1, 1)
    assert np.array_equal(coordinates.xform, np.eye(4))
    meta = dict(surface.darrays[0].meta)
    assert meta["AnatomicalStructurePrimary"] == "CortexLeft", meta
    assert meta["AnatomicalStructureSecondary"] == "MidThickness", meta
    assert meta["GeometricType"] == "Anatomical", meta
    assert dict(surface.darrays[1].meta)["TopologicalType"] == "Closed"
    packed = nib.gifti.GiftiImage.from_bytes(gzip.decompress((folder / "a.surf.gii.gz").read_bytes()))
    assert np.array_equal(packed.agg_data("pointset"), exact)

    shape = nib.load(folder / "a.shape.gii")
    assert np.array_equal(shape.darrays[0].data, values.astype("f4"))
    assert dict(shape.darrays[0].meta)["Name"] == "thickness"
    label = nib.load(folder / "a.label.gii")
    assert np.array_equal(label.darrays[0].data, keys)
    assert label.labeltable.get_labels_as_dict() == {0: "outside", 3: "in & out"}

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        got, their_faces, info, stamp = nib.freesurfer.read_geometry(
            folder / "lh.white", read_metadata=True, read_stamp=True)
    assert np.array_equal(got.astype("f4"), exact) and np.array_equal(their_faces, faces)
    assert info["valid"].startswith("1") and stamp == "created by Explica", (info, stamp)
    assert np.array_equal(info["cras"], np.zeros(3)), info
    assert np.array_equal(info["xras"], [-1, 0, 0]) and np.array_equal(info["yras"], [0, 0, -1])
    curv = nib.freesurfer.read_morph_data(folder / "lh.thickness")
    assert np.array_equal(curv, values.astype("f4"))
    labels, table, names = nib.freesurfer.read_annot(folder / "lh.parts.annot", orig_ids=False)
    # The colour 0 of "outside" means "no label" in this format, which nibabel gives as -1.
    assert np.array_equal(labels, np.where(keys == 3, 1, -1)), labels  # places in the list of names
    assert names == [b"outside", b"in & out"], names
    listed = nib.freesurfer.read_label(folder / "lh.part.label")
    assert np.array_equal(np.sort(listed), np.flatnonzero(keys))

    patch = (folder / "lh.part.patch.3d").read_bytes()
    mark, count = np.frombuffer(patch[:8], ">i4")
    entries = np.frombuffer(patch[8:], [("vertex", ">i4"), ("place", ">f4", 3)])
    assert mark == -1 and count == len(entries) == np.count_nonzero(keys), (mark, count)
    vertices = np.abs(entries["vertex"]) - 1
    assert np.array_equal(vertices, np.flatnonzero(keys))
    assert np.array_equal(entries["place"], exact[vertices])


def our_cifti(folder):
    """Values, axes and tables as nibabel's cifti2 reads them."""
    left = np.fromfile(folder / "left.raw", dtype="<i4")
    right = np.fromfile(folder / "right.raw", dtype="<i4")

    def models(image):
        axis = image.header.get_axis(1)
        for name, indices, part in axis.iter_structures():
            side = left if name == "CIFTI_STRUCTURE_CORTEX_LEFT" else right
            assert np.array_equal(part.vertex, side), name
            assert part.nvertices[name] == 642, part.nvertices
        assert len(axis) == len(left) + len(right)

    def whole(side, vertices):
        return 1000 * side + vertices

    both = np.concatenate([whole(1, left), whole(2, right)])
    scalars = nib.load(folder / "a.dscalar.nii")
    models(scalars)
    assert list(scalars.header.get_axis(0).name) == ["first", "in & out"]
    values = scalars.get_fdata()
    assert np.array_equal(values[0], both)
    assert np.isnan(values[1][0]) and np.array_equal(values[1][1:], -both[1:])

    series = nib.load(folder / "a.dtseries.nii")
    models(series)
    axis = series.header.get_axis(0)
    assert (axis.size, axis.start, axis.step, axis.unit) == (5, 0, 1.5, "SECOND")
    assert np.array_equal(series.get_fdata(), both + 0.25 * np.arange(5)[:, None])

    labels = nib.load(folder / "a.dlabel.nii")
    models(labels)
    table = labels.header.get_axis(0).label[0]
    assert table[1024][0] == "ctx-lh-precentral", table
    assert np.allclose(table[1024][1], (60 / 255, 20 / 255, 220 / 255, 1)), table
    assert 0 in table
    assert np.array_equal(labels.get_fdata()[0], np.repeat([1024, 2022], [len(left), len(right)]))


def their_surfaces(folder):
    rng = np.random.default_rng(11)
    points = rng.normal(size=(50, 3)).astype("f4") * 30
    faces = rng.integers(0, 50, (90, 3)).astype("i4")
    points.astype("<f8").tofile(folder / "positions.raw")
    faces.astype("<i4").tofile(folder / "faces.raw")
    values = rng.normal(size=50).astype("f4")
    values.astype("<f8").tofile(folder / "values.raw")
    space = nib.gifti.GiftiCoordSystem("NIFTI_XFORM_SCANNER_ANAT", "NIFTI_XFORM_SCANNER_ANAT",
                                       np.eye(4))
    for encoding in ("ASCII", "B64BIN", "B64GZ"):
        for endian in ("little", "big"):
            def array(data, intent, kind):
                stored = data.astype(data.dtype.newbyteorder("<" if endian == "little" else ">"))
                return nib.gifti.GiftiDataArray(
                    stored, intent=intent, datatype=kind, encoding=f"GIFTI_ENCODING_{encoding}",
                    endian=f"GIFTI_ENDIAN_{endian.upper()}", coordsys=space)
            image = nib.gifti.GiftiImage(darrays=[
                array(points, "NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32"),
                array(faces, "NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32")])
            text = image.to_xml()
            (folder / f"{encoding}-{endian}.surf.gii").write_bytes(text)
            with gzip.open(folder / f"{encoding}-{endian}.surf.gii.gz", "wb") as packed:
                packed.write(text)
    # External data: a big-endian file with an offset, as the standard has it.
    raw = b"skipped" + points.astype(">f4").tobytes() + faces.astype(">i4").tobytes()
    (folder / "external.dat").write_bytes(raw)

    def external(intent, kind, rows, offset):
        return (f'<DataArray Intent="NIFTI_INTENT_{intent}" DataType="NIFTI_TYPE_{kind}" '
                f'ArrayIndexingOrder="RowMajorOrder" Dimensionality="2" Dim0="{rows}" Dim1="3" '
                'Encoding="ExternalFileBinary" Endian="BigEndian" ExternalFileName="external.dat" '
                f'ExternalFileOffset="{offset}"><Data></Data></DataArray>')
    (folder / "external.surf.gii").write_text(
        '<?xml version="1.0" encoding="UTF-8"?><GIFTI Version="1.0" NumberOfDataArrays="2">'
        + external("POINTSET", "FLOAT32", 50, 7) + external("TRIANGLE", "INT32", 90, 607)
        + "</GIFTI>")
    nib.freesurfer.write_geometry(folder / "lh.plain", points, faces)
    nib.freesurfer.write_morph_data(folder / "lh.sulc", values)
    keys = rng.integers(0, 3, 50)
    keys.astype("<i4").tofile(folder / "keys.raw")
    table = np.array([[10, 20, 30, 0, 0], [40, 50, 60, 0, 0], [70, 80, 90, 0, 0]])
    nib.freesurfer.write_annot(folder / "lh.parts.annot", keys, table, ["a", "b", "c"],
                               fill_ctab=True)


def real_data(folder):
    """Real volumes and surfaces by nibabel, for our reader to be compared with."""
    data = Path((folder / "data.txt").read_text().strip())
    for index, name in enumerate(("bert_freesurfer/mri/ribbon.mgz",
                                  "lv_sunnybrook_SCD0000101/ED_label.nii.gz",
                                  "laynii_sc/sc_rim.nii.gz")):
        image = nib.load(data / name)
        put_expected(folder, f"volume{index}", image.affine, np.asarray(image.dataobj))
    surface = nib.load(data / "s1_pycortex_lh/wm_lh.gii")
    surface.agg_data("pointset").astype("<f8").tofile(folder / "positions.raw")
    surface.agg_data("triangle").astype("<i4").tofile(folder / "faces.raw")


if __name__ == "__main__":
    globals()[sys.argv[1]](Path(sys.argv[2]))
