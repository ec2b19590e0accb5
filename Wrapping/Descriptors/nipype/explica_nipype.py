# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""nipype interfaces of Explica 0.1.0, generated from the commands' own declarations."""

import glob
import os

from nipype.interfaces.base import (
    CommandLine,
    CommandLineInputSpec,
    Directory,
    File,
    TraitedSpec,
    traits,
)


class BidsInputSpec(CommandLineInputSpec):
    bids_dir = Directory(exists=True, desc="data set or derivative with dataset_description.json", argstr="%s", position=0, mandatory=True)
    out_dir = traits.Str(desc="folder of the derivative data set", argstr="%s", position=1, mandatory=True)
    level = traits.Enum("participant", "group", desc="participant or group", argstr="%s", position=2, mandatory=True)
    participant_label = traits.List(traits.Str(), desc="participants to do, with or without sub-", argstr="--participant-label %s...")
    hemispheres = traits.List(traits.Enum("L", "R"), desc="hemispheres to do", argstr="--hemispheres %s", sep=",")
    skip_bids_validator = traits.Bool(desc="accepted; no validator is run", argstr="--skip-bids-validator")
    unfold_surface = traits.Enum("white", "mid", "pial", desc="which surface to unfold a patch of", argstr="--unfold-surface %s")
    given_surfaces = traits.Enum("use", "remake", desc="what to do with white and pial surfaces found in the input", argstr="--given-surfaces %s")
    steps = traits.List(traits.Enum("segment", "thickness", "surface", "unfold", "report"), desc="steps to do (default: all that the input allows)", argstr="--steps %s", sep=",")
    segment_mask = File(exists=True, desc="the brain is where this is not 0", argstr="--segment.mask %s")
    segment_atlas = File(exists=True, desc="labels in the space of the T1, as AAL's", argstr="--segment.atlas %s")
    segment_atlas_legend = File(exists=True, desc="what the atlas's labels mean, one 'value name' a line (default: the .tsv or .nii.txt beside it)", argstr="--segment.atlas-legend %s")
    segment_xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--segment.xform %s")
    segment_frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--segment.frame %s")
    segment_smooth = traits.Float(desc="weight of the Markov prior that smooths the classes; 0 for none", argstr="--segment.smooth %s")
    segment_bias_width = traits.Float(desc="standard deviation of the bias field's smoothing; 0 for no field [mm]", argstr="--segment.bias-width %s")
    segment_max_iterations = traits.Int(desc="expectation-maximisation iterations at most", argstr="--segment.max-iterations %s")
    segment_tolerance = traits.Float(desc="stop once no class mean moves by more than this share of their range", argstr="--segment.tolerance %s")
    segment_hemisphere = traits.Enum("both", "L", "R", desc="which hemisphere to take out", argstr="--segment.hemisphere %s")
    segment_core_depth = traits.Float(desc="least distance of the ventricles' voxels to cortical labels [mm]", argstr="--segment.core-depth %s")
    thickness_inner_level = File(exists=True, desc="scalar volume whose level --level is the inner boundary", argstr="--thickness.inner-level %s")
    thickness_outer_level = File(exists=True, desc="scalar volume whose level --level is the outer boundary", argstr="--thickness.outer-level %s")
    thickness_level = traits.Float(desc="value of the level sets on the boundary", argstr="--thickness.level %s")
    thickness_level_inside = traits.Enum("auto", "above", "below", desc="side of the level sets that is enclosed", argstr="--thickness.level-inside %s")
    thickness_xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--thickness.xform %s")
    thickness_frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--thickness.frame %s")
    thickness_inner = traits.List(traits.Int(), desc="labels of the enclosed region: white matter, blood pool", argstr="--thickness.inner %s", sep=",")
    thickness_tissue = traits.List(traits.Int(), desc="labels of the tissue between the two boundaries", argstr="--thickness.tissue %s", sep=",")
    thickness_outer = traits.List(traits.Int(), desc="labels outside the tissue (default: all other labels)", argstr="--thickness.outer %s", sep=",")
    thickness_insulated = traits.List(traits.Int(), desc="labels that neither side owns: no flux crosses into them", argstr="--thickness.insulated %s", sep=",")
    thickness_boundary = traits.Enum("subvoxel", "staircase", "embedding", desc="where the boundary lies between voxel centres", argstr="--thickness.boundary %s")
    thickness_open_ends = traits.Bool(desc="insulate the planes beyond the tissue's first and last slice", argstr="--thickness.open-ends")
    thickness_per_slice = traits.Bool(desc="measure every slice (along k) on its own, in two dimensions", argstr="--thickness.per-slice")
    thickness_sulci = traits.Enum("recover", "ignore", desc="what to do where the banks of a sulcus touch (default: recover; ignore with --per-slice, --open-ends or --aha, which are for hearts)", argstr="--thickness.sulci %s")
    thickness_facing = traits.Float(desc="smallest angle between two fronts from the inner boundary whose meeting is a sulcus [degrees]", argstr="--thickness.facing %s")
    thickness_method = traits.Enum("hybrid", "eulerian", "lagrangian", desc="how boundary points and lengths are found", argstr="--thickness.method %s")
    thickness_lambda = traits.Float(desc="hybrid: boundary points of neighbours nearer than this are interpolated, others followed; 0 follows all (default: twice the finest voxel size) [mm]", argstr="--thickness.lambda %s")
    thickness_layers = traits.Int(desc="number of layers, counted from the inner boundary", argstr="--thickness.layers %s")
    thickness_layer_kind = traits.Enum("depth", "volume", desc="layers of equal share of the thickness or of the column's volume", argstr="--thickness.layer-kind %s")
    thickness_grid = traits.Int(desc="write an anatomical grid with this many cells across", argstr="--thickness.grid %s")
    thickness_aha = traits.Bool(desc="table and picture of the left ventricle's 17 segments", argstr="--thickness.aha")
    thickness_rv_insertion = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="anterior insertion of the right ventricle, RAS [mm]", argstr="--thickness.rv-insertion %s,%s,%s")
    surface_inner_level = File(exists=True, desc="scalars that cross a level at the white surface: a probability or a distance", argstr="--surface.inner-level %s")
    surface_outer_level = File(exists=True, desc="scalars that cross a level at the outer surface", argstr="--surface.outer-level %s")
    surface_grey_share = File(exists=True, desc="probability of grey matter: with --inner-level the outer surface is where both together reach one half", argstr="--surface.grey-share %s")
    surface_insulated_mask = File(exists=True, desc="with --inner-level: not 0 where neither side is (a cut)", argstr="--surface.insulated-mask %s")
    surface_level = traits.Float(desc="value on the boundaries of level volumes (default: half the largest value of shares, 0 of distances)", argstr="--surface.level %s")
    surface_white_surface = File(exists=True, desc="white surface that is there already", argstr="--surface.white-surface %s")
    surface_pial_surface = File(exists=True, desc="its pial surface, same faces", argstr="--surface.pial-surface %s")
    surface_mid_surface = File(exists=True, desc="its middle surface, same faces (default: half way)", argstr="--surface.mid-surface %s")
    surface_surface_space = traits.Enum("stated", "scanner", "tkr", desc="frame of their coordinates, if the files do not say", argstr="--surface.surface-space %s")
    surface_atlas = File(exists=True, desc="labels of cortical regions in the same space: writes regions.tsv", argstr="--surface.atlas %s")
    surface_atlas_legend = File(exists=True, desc="what its labels are called (default: the .tsv or .nii.txt beside it; FreeSurfer's names are known)", argstr="--surface.atlas-legend %s")
    surface_parcellation = File(exists=True, desc="regions of given surfaces, vertex by vertex, instead of --atlas", argstr="--surface.parcellation %s")
    surface_xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--surface.xform %s")
    surface_frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--surface.frame %s")
    surface_preset = traits.Enum("auto", "aseg", "ribbon", "three-class", "wm", "none", desc="what the labels mean", argstr="--surface.preset %s")
    surface_white = traits.List(traits.Int(), desc="labels of white matter (default: the preset's)", argstr="--surface.white %s", sep=",")
    surface_grey = traits.List(traits.Int(), desc="labels of grey matter (default: the preset's)", argstr="--surface.grey %s", sep=",")
    surface_fill = traits.List(traits.Int(), desc="labels joined to white matter, such as deep structures and ventricles (default: the preset's)", argstr="--surface.fill %s", sep=",")
    surface_insulated = traits.List(traits.Int(), desc="labels that are neither inside nor outside (default: the preset's)", argstr="--surface.insulated %s", sep=",")
    surface_hemisphere = traits.Enum("L", "R", desc="which hemisphere to take, where labels hold both", argstr="--surface.hemisphere %s")
    surface_no_fill = traits.Bool(desc="join nothing to white matter", argstr="--surface.no-fill")
    surface_close_edges = traits.Bool(desc="close the surface where tissue meets the edge of the field of view, instead of refusing", argstr="--surface.close-edges")
    surface_genus = traits.Enum("zero", "keep", desc="whether handles and tunnels are removed", argstr="--surface.genus %s")
    surface_faces = traits.Int(desc="faces of each surface", argstr="--surface.faces %s")
    surface_steps = traits.Int(desc="in which the outer surface grows out of the white one", argstr="--surface.steps %s")
    surface_freesurfer = traits.Str(desc="write lh.white, lh.pial, lh.thickness and so on, too, into this folder (within --out if relative)", argstr="--surface.freesurfer %s")
    surface_fs_volume = File(exists=True, desc="volume (orig.mgz) whose surface RAS FreeSurfer files use, read or written (default: the labels, if FreeSurfer's)", argstr="--surface.fs-volume %s")
    unfold_surface_space = traits.Enum("stated", "scanner", "tkr", desc="frame of the surface's coordinates, if its file does not say", argstr="--unfold.surface-space %s")
    unfold_fs_volume = traits.Str(desc="FreeSurfer volume (orig.mgz) whose geometry places the surface", argstr="--unfold.fs-volume %s")
    unfold_viewpoint = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="point to look from [mm]", argstr="--unfold.viewpoint %s,%s,%s")
    unfold_direction = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="look from the region's centroid plus --distance along this", argstr="--unfold.direction %s,%s,%s")
    unfold_distance = traits.Float(desc="how far off a viewpoint given by --direction is [mm]", argstr="--unfold.distance %s")
    unfold_view_line = traits.List(traits.Float(), desc="look from a segment: X,Y,Z of its start and of its end [mm]", argstr="--unfold.view-line %s", sep=",")
    unfold_view_surface = File(exists=True, desc="look from all points of this surface", argstr="--unfold.view-surface %s")
    unfold_center = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="the vertex nearest to this point is the region's centre [mm]", argstr="--unfold.center %s,%s,%s")
    unfold_vertex = traits.Int(desc="vertex that is the region's centre, from 0", argstr="--unfold.vertex %s")
    unfold_radius = traits.Float(desc="how far the region reaches from its centre [mm]", argstr="--unfold.radius %s")
    unfold_metric = traits.Enum("euclidean", "geodesic", desc="how the radius is measured", argstr="--unfold.metric %s")
    unfold_cone = traits.Float(desc="region of what lies within this angle of the line from viewpoint to centre, on the near side and connected to the centre [degrees]", argstr="--unfold.cone %s")
    unfold_label = File(exists=True, desc="the region is where this label is not 0", argstr="--unfold.label %s")
    unfold_label_key = traits.Int(desc="the region is where --label has this key", argstr="--unfold.label-key %s")
    unfold_adjust_region = traits.Bool(desc="grow or shrink the region until its visibility is positive", argstr="--unfold.adjust-region")
    unfold_repair = traits.Bool(desc="part faces that intersect at the start, by small moves where that goes; the result is compared with the surface so repaired", argstr="--unfold.repair")
    unfold_surround = traits.Enum("fixed", "elastic", "none", desc="the surface around the region stays, follows with a collar, or is left out", argstr="--unfold.surround %s")
    unfold_collar_rings = traits.Int(desc="rings of faces of an elastic collar", argstr="--unfold.collar-rings %s")
    unfold_contact_range = traits.Float(desc="reach of the contact barrier in mean edge lengths", argstr="--unfold.contact-range %s")
    unfold_largest_move = traits.Float(desc="mean edge lengths that a vertex goes per iteration at most", argstr="--unfold.largest-move %s")
    unfold_method = traits.Enum("implicit", "thesis", desc="implicit steps, or the thesis's gradient flow as the baseline", argstr="--unfold.method %s")
    unfold_knot = traits.Enum("tree", "thesis-tree", "all-pairs", "off", desc="who evaluates the knot energy", argstr="--unfold.knot %s")
    unfold_keep_areas = traits.Bool(desc="thesis method: project onto kept areas", argstr="--unfold.keep-areas")
    unfold_time_step = traits.Float(desc="thesis method: fixed step instead of an adaptive one", argstr="--unfold.time-step %s")
    unfold_area_weight = traits.Float(desc="stiffness of face areas before it is tightened", argstr="--unfold.area-weight %s")
    unfold_spring_weight = traits.Float(desc="stiffness of edge lengths", argstr="--unfold.spring-weight %s")
    unfold_knot_weight = traits.Float(desc="strength of the knot energy", argstr="--unfold.knot-weight %s")
    unfold_contact_weight = traits.Float(desc="strength of the contact barrier", argstr="--unfold.contact-weight %s")
    unfold_lift_weight = traits.Float(desc="pull out of fixed or elastic surroundings, up to where the flat region has room", argstr="--unfold.lift-weight %s")
    unfold_collar_weight = traits.Float(desc="stiffness of an elastic collar beside the region's", argstr="--unfold.collar-weight %s")
    unfold_target_visibility = traits.Float(desc="stop once the average visibility reaches this; without it, once it no longer rises", argstr="--unfold.target-visibility %s")
    unfold_area_tolerance = traits.Float(desc="mean relative area error of faces that a goal asks for", argstr="--unfold.area-tolerance %s")
    unfold_max_iterations = traits.Int(desc="iterations at most", argstr="--unfold.max-iterations %s")
    unfold_max_time = traits.Float(desc="stop after this time [s]", argstr="--unfold.max-time %s")
    unfold_frames = traits.Int(desc="states to write on the way, evenly spaced in visibility", argstr="--unfold.frames %s")
    unfold_resume = traits.Bool(desc="continue the run whose outputs are in --out", argstr="--unfold.resume")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class BidsOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    dataset_description_json = File(desc="what this derivative is")
    descriptions_tsv = File(desc="what each desc- means")
    bidsignore = File(desc="files that BIDS does not know yet")
    sub_ = traits.List(File(), desc="results by BIDS names")
    runs = File(desc="the runs themselves, with records and reports")
    study_tsv = File(desc="one row a participant and hemisphere")
    index_html = File(desc="the same, to sort and click")
    prov_prov_explica_json = traits.List(File(), desc="how everything came about, as BIDS-Prov")
    ro_crate_metadata_json = File(desc="the same as an RO-Crate")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Bids(CommandLine):
    """a BIDS data set, participant by participant, to a derivative and a study table."""

    _cmd = "explica bids"
    input_spec = BidsInputSpec
    output_spec = BidsOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "dataset_description_json": "dataset_description.json",
            "descriptions_tsv": "descriptions.tsv",
            "bidsignore": ".bidsignore",
            "sub_": "sub-*",
            "runs": "runs",
            "study_tsv": "study.tsv",
            "index_html": "index.html",
            "prov_prov_explica_json": "prov/prov-explica_*.json",
            "ro_crate_metadata_json": "ro-crate-metadata.json",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class DescriptorsInputSpec(CommandLineInputSpec):
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class DescriptorsOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    boutiques_explica_json = traits.List(File(), desc="Boutiques descriptors, schema 0.5")
    slicer_explica_xml = traits.List(File(), desc="3D Slicer command descriptions")
    nipype_explica_nipype_py = File(desc="nipype interfaces, one a command")
    completion_explica_bash = File(desc="completion for bash")
    completion_explica = File(desc="completion for zsh")
    man_explica_1 = traits.List(File(), desc="manual pages")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Descriptors(CommandLine):
    """descriptions of every command for other tools: Boutiques, nipype, Slicer, shells, man."""

    _cmd = "explica descriptors"
    input_spec = DescriptorsInputSpec
    output_spec = DescriptorsOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "boutiques_explica_json": "boutiques/explica-*.json",
            "slicer_explica_xml": "slicer/explica-*.xml",
            "nipype_explica_nipype_py": "nipype/explica_nipype.py",
            "completion_explica_bash": "completion/explica.bash",
            "completion_explica": "completion/_explica",
            "man_explica_1": "man/explica-*.1",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class EmbedInputSpec(CommandLineInputSpec):
    target = traits.List(File(exists=True), desc="polygons, label images, surfaces or coefficients.json", argstr="%s", position=0, mandatory=True)
    fit = traits.Bool(desc="fit a single target (default for one target)", argstr="--fit")
    average = traits.Bool(desc="mean of the targets (default for several)", argstr="--average")
    combine = traits.List(traits.Float(), desc="weights of the targets, one each", argstr="--combine %s", sep=",")
    xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--xform %s")
    frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--frame %s")
    label = traits.Int(desc="take the contour of this label of an image", argstr="--label %s")
    slice = traits.Int(desc="slice along the third axis; default: where the label is largest", argstr="--slice %s")
    contour = traits.Int(desc="which contour, by area, 0 the largest", argstr="--contour %s")
    edges = traits.Int(desc="resample the contour to this many equal edges", argstr="--edges %s")
    smooth = traits.Float(desc="Gaussian that anti-aliases the label's mask [voxels]", argstr="--smooth %s")
    centre = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="default: mean of the targets' points [mm]", argstr="--centre %s,%s,%s")
    inner_radius = traits.Float(desc="default: 0.85 of the nearest target point [mm]", argstr="--inner-radius %s")
    outer_radius = traits.Float(desc="default: 1.15 of the farthest target point [mm]", argstr="--outer-radius %s")
    order = traits.Int(desc="highest angular frequency; default 64 in 2D, 14 in 3D", argstr="--order %s")
    band = traits.Float(desc="in 2D: all within this distance of the targets instead [mm]", argstr="--band %s")
    annulus = traits.List(File(exists=True), desc="in 2D: its boundaries; two polygons, or one label image with --inner and --tissue", argstr="--annulus %s...")
    inner = traits.List(traits.Int(), desc="labels that a given annulus encloses", argstr="--inner %s", sep=",")
    tissue = traits.List(traits.Int(), desc="labels of a given annulus itself", argstr="--tissue %s", sep=",")
    samples = traits.Int(desc="points of each target's boundary that are fitted", argstr="--samples %s")
    max_iterations = traits.Int(desc="iterations of the fit", argstr="--max-iterations %s")
    fit_step = traits.Float(desc="share of the way to each iteration's optimum", argstr="--fit-step %s")
    smoothness = traits.Float(desc="pull of the amplitudes towards the concentric shape", argstr="--smoothness %s")
    grid = traits.Int(desc="voxels per side, for drawing the shape", argstr="--grid %s")
    frames = traits.Int(desc="states of the first target's fit", argstr="--frames %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class EmbedOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    coefficients_json = File(desc="the shape's coefficients")
    field_nii_gz = File(desc="in 3D: u on the grid; the shape is its 1/2 level")
    shape_csv = File(desc="in 2D: the shape")
    shape_surf_gii = File(desc="in 3D: the shape")
    fit_tsv = File(desc="one row a target and iteration")
    evolution_svg = File(desc="the same states in one figure with the target; in 3D: the section through the annulus' centre")
    frames_frame_csv = traits.List(File(), desc="in 2D: from the initial estimate to the fit")
    frames_frame_surf_gii = traits.List(File(), desc="in 3D: the same")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Embed(CommandLine):
    """closed shapes as harmonic functions: fitted, averaged, combined."""

    _cmd = "explica embed"
    input_spec = EmbedInputSpec
    output_spec = EmbedOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "coefficients_json": "coefficients.json",
            "field_nii_gz": "field.nii.gz",
            "shape_csv": "shape.csv",
            "shape_surf_gii": "shape.surf.gii",
            "fit_tsv": "fit.tsv",
            "evolution_svg": "evolution.svg",
            "frames_frame_csv": "frames/frame-*.csv",
            "frames_frame_surf_gii": "frames/frame-*.surf.gii",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class HistoryInputSpec(CommandLineInputSpec):
    file = File(exists=True, desc="a result, or a provenance.json", argstr="%s", position=0, mandatory=True)
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class HistoryOutputSpec(TraitedSpec):
    pass


class History(CommandLine):
    """how a file came about, step by step, back to the first input."""

    _cmd = "explica history"
    input_spec = HistoryInputSpec
    output_spec = HistoryOutputSpec


class PhantomCortexInputSpec(CommandLineInputSpec):
    size = traits.Int(desc="voxels along each axis", argstr="--size %s")
    spacing = traits.Float(desc="voxel size [mm]", argstr="--spacing %s")
    thickness = traits.Float(desc="of the grey ribbon [mm]", argstr="--thickness %s")
    depth = traits.Float(desc="of the folds, share of the radius", argstr="--depth %s")
    waves = traits.Int(desc="folds along an axis", argstr="--waves %s")
    noise = traits.Float(desc="standard deviation in the image, where tissues differ by 30", argstr="--noise %s")
    bias = traits.Float(desc="brightening from the middle to the right side, share", argstr="--bias %s")
    seed = traits.Int(desc="of the noise", argstr="--seed %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PhantomCortexOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    labels_nii_gz = File(desc="3 white, 2 grey, 1 fluid, 0 outside")
    t1_nii_gz = File(desc="T1-weighted image, skull-stripped")
    level_nii_gz = File(desc="distance to the white surface, mm, negative inside")
    white_surf_gii = File(desc="the exact white surface")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class PhantomCortex(CommandLine):
    """folded grey ribbon of constant thickness, as labels and as a T1-weighted image."""

    _cmd = "explica phantom cortex"
    input_spec = PhantomCortexInputSpec
    output_spec = PhantomCortexOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "labels_nii_gz": "labels.nii.gz",
            "t1_nii_gz": "t1.nii.gz",
            "level_nii_gz": "level.nii.gz",
            "white_surf_gii": "white.surf.gii",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class PhantomEccentricInputSpec(CommandLineInputSpec):
    size = traits.Int(desc="voxels along each axis [voxels]", argstr="--size %s")
    spacing = traits.Float(desc="voxel size [mm]", argstr="--spacing %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PhantomEccentricOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    labels_nii_gz = File(desc="1 inner, 2 tissue, 0 outer")
    inner_level_nii_gz = File(desc="inner boundary at 0, mm, negative inside")
    outer_level_nii_gz = File(desc="outer boundary at 0, mm, negative inside")
    harmonic_nii_gz = File(desc="exact harmonic function")
    thickness_nii_gz = File(desc="exact thickness, mm")
    inner_distance_nii_gz = File(desc="exact L0, mm")
    outer_distance_nii_gz = File(desc="exact L1, mm")
    inner_point_nii_gz = File(desc="exact phi0, RAS mm")
    outer_point_nii_gz = File(desc="exact phi1, RAS mm")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class PhantomEccentric(CommandLine):
    """two eccentric circles with their exact answers (bipolar coordinates)."""

    _cmd = "explica phantom eccentric"
    input_spec = PhantomEccentricInputSpec
    output_spec = PhantomEccentricOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "labels_nii_gz": "labels.nii.gz",
            "inner_level_nii_gz": "inner_level.nii.gz",
            "outer_level_nii_gz": "outer_level.nii.gz",
            "harmonic_nii_gz": "harmonic.nii.gz",
            "thickness_nii_gz": "thickness.nii.gz",
            "inner_distance_nii_gz": "inner_distance.nii.gz",
            "outer_distance_nii_gz": "outer_distance.nii.gz",
            "inner_point_nii_gz": "inner_point.nii.gz",
            "outer_point_nii_gz": "outer_point.nii.gz",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class PhantomPolygon19InputSpec(CommandLineInputSpec):
    spacing = traits.Float(desc="size of a pixel [mm]", argstr="--spacing %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PhantomPolygon19OutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    polygon_csv = File(desc="vertices in order, counter-clockwise")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class PhantomPolygon19(CommandLine):
    """polygon with an intricate region of 19 edges."""

    _cmd = "explica phantom polygon19"
    input_spec = PhantomPolygon19InputSpec
    output_spec = PhantomPolygon19OutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "polygon_csv": "polygon.csv",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class PhantomPolygon34InputSpec(CommandLineInputSpec):
    spacing = traits.Float(desc="size of a pixel [mm]", argstr="--spacing %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PhantomPolygon34OutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    polygon_csv = File(desc="vertices in order, counter-clockwise")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class PhantomPolygon34(CommandLine):
    """polygon with a highly convoluted region of 34 edges."""

    _cmd = "explica phantom polygon34"
    input_spec = PhantomPolygon34InputSpec
    output_spec = PhantomPolygon34OutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "polygon_csv": "polygon.csv",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class PhantomShellInputSpec(CommandLineInputSpec):
    size = traits.Int(desc="voxels along the first axis", argstr="--size %s")
    spacing = traits.Float(desc="voxel size along the first axis [mm]", argstr="--spacing %s")
    inner_radius = traits.Float(desc="inner radius over half the grid's width", argstr="--inner-radius %s")
    outer_radius = traits.Float(desc="outer radius over half the grid's width", argstr="--outer-radius %s")
    aspect = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="voxel size along each axis over --spacing", argstr="--aspect %s,%s,%s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PhantomShellOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    labels_nii_gz = File(desc="1 inside, 2 tissue, 0 outside")
    level_nii_gz = File(desc="distance from the inner sphere, mm, negative inside")
    outer_level_nii_gz = File(desc="distance from the outer sphere, mm, negative inside")
    harmonic_nii_gz = File(desc="exact harmonic function, 0 inside to 1 outside")
    thickness_nii_gz = File(desc="exact thickness, mm")
    inner_distance_nii_gz = File(desc="exact L0, mm")
    outer_distance_nii_gz = File(desc="exact L1, mm")
    inner_point_nii_gz = File(desc="exact phi0, RAS mm")
    outer_point_nii_gz = File(desc="exact phi1, RAS mm")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class PhantomShell(CommandLine):
    """spherical shell of tissue with its exact thickness and harmonic function."""

    _cmd = "explica phantom shell"
    input_spec = PhantomShellInputSpec
    output_spec = PhantomShellOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "labels_nii_gz": "labels.nii.gz",
            "level_nii_gz": "level.nii.gz",
            "outer_level_nii_gz": "outer_level.nii.gz",
            "harmonic_nii_gz": "harmonic.nii.gz",
            "thickness_nii_gz": "thickness.nii.gz",
            "inner_distance_nii_gz": "inner_distance.nii.gz",
            "outer_distance_nii_gz": "outer_distance.nii.gz",
            "inner_point_nii_gz": "inner_point.nii.gz",
            "outer_point_nii_gz": "outer_point.nii.gz",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class PhantomSpheroidInputSpec(CommandLineInputSpec):
    size = traits.Int(desc="voxels along each axis [voxels]", argstr="--size %s")
    spacing = traits.Float(desc="voxel size [mm]", argstr="--spacing %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PhantomSpheroidOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    labels_nii_gz = File(desc="1 inner, 2 tissue, 0 outer")
    inner_level_nii_gz = File(desc="inner boundary at 0, mm, negative inside")
    outer_level_nii_gz = File(desc="outer boundary at 0, mm, negative inside")
    harmonic_nii_gz = File(desc="exact harmonic function")
    thickness_nii_gz = File(desc="exact thickness, mm")
    inner_distance_nii_gz = File(desc="exact L0, mm")
    outer_distance_nii_gz = File(desc="exact L1, mm")
    inner_point_nii_gz = File(desc="exact phi0, RAS mm")
    outer_point_nii_gz = File(desc="exact phi1, RAS mm")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class PhantomSpheroid(CommandLine):
    """confocal spheroids with their exact answers."""

    _cmd = "explica phantom spheroid"
    input_spec = PhantomSpheroidInputSpec
    output_spec = PhantomSpheroidOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "labels_nii_gz": "labels.nii.gz",
            "inner_level_nii_gz": "inner_level.nii.gz",
            "outer_level_nii_gz": "outer_level.nii.gz",
            "harmonic_nii_gz": "harmonic.nii.gz",
            "thickness_nii_gz": "thickness.nii.gz",
            "inner_distance_nii_gz": "inner_distance.nii.gz",
            "outer_distance_nii_gz": "outer_distance.nii.gz",
            "inner_point_nii_gz": "inner_point.nii.gz",
            "outer_point_nii_gz": "outer_point.nii.gz",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class PhantomVentricleInputSpec(CommandLineInputSpec):
    size = traits.Int(desc="voxels along each axis [voxels]", argstr="--size %s")
    spacing = traits.Float(desc="voxel size [mm]", argstr="--spacing %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PhantomVentricleOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    labels_nii_gz = File(desc="1 inner, 2 tissue, 0 outer")
    inner_level_nii_gz = File(desc="inner boundary at 0, mm, negative inside")
    outer_level_nii_gz = File(desc="outer boundary at 0, mm, negative inside")
    harmonic_nii_gz = File(desc="exact harmonic function")
    thickness_nii_gz = File(desc="exact thickness, mm")
    inner_distance_nii_gz = File(desc="exact L0, mm")
    outer_distance_nii_gz = File(desc="exact L1, mm")
    inner_point_nii_gz = File(desc="exact phi0, RAS mm")
    outer_point_nii_gz = File(desc="exact phi1, RAS mm")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class PhantomVentricle(CommandLine):
    """a left ventricle between confocal spheroids, cut at its base, with exact answers."""

    _cmd = "explica phantom ventricle"
    input_spec = PhantomVentricleInputSpec
    output_spec = PhantomVentricleOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "labels_nii_gz": "labels.nii.gz",
            "inner_level_nii_gz": "inner_level.nii.gz",
            "outer_level_nii_gz": "outer_level.nii.gz",
            "harmonic_nii_gz": "harmonic.nii.gz",
            "thickness_nii_gz": "thickness.nii.gz",
            "inner_distance_nii_gz": "inner_distance.nii.gz",
            "outer_distance_nii_gz": "outer_distance.nii.gz",
            "inner_point_nii_gz": "inner_point.nii.gz",
            "outer_point_nii_gz": "outer_point.nii.gz",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class PolygonInputSpec(CommandLineInputSpec):
    file = File(exists=True, desc="polygon (CSV, VTK polydata), or label image", argstr="%s", position=0)
    phantom = traits.Enum("polygon19", "polygon34", desc="instead of FILE: a phantom with its region and viewpoint", argstr="--phantom %s")
    xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--xform %s")
    frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--frame %s")
    label = traits.Int(desc="take the contour of this label of an image", argstr="--label %s")
    slice = traits.Int(desc="slice along the third axis; default: where the label is largest", argstr="--slice %s")
    contour = traits.Int(desc="which contour, by area, 0 the largest", argstr="--contour %s")
    edges = traits.Int(desc="resample the contour to this many equal edges", argstr="--edges %s")
    smooth = traits.Float(desc="Gaussian that anti-aliases the label's mask [voxels]", argstr="--smooth %s")
    region = traits.Str(desc="first and last vertex, I:J; default: the whole polygon", argstr="--region %s")
    viewpoint = traits.Tuple(traits.Float(), traits.Float(), desc="point to look from [mm]", argstr="--viewpoint %s,%s")
    direction = traits.Tuple(traits.Float(), traits.Float(), desc="look from the region's centroid plus --distance along this", argstr="--direction %s,%s")
    distance = traits.Float(desc="how far off a viewpoint given by --direction is [mm]", argstr="--distance %s")
    view_line = traits.List(traits.Float(), desc="look from all points of the line X,Y,X,Y between two [mm]", argstr="--view-line %s", sep=",")
    method = traits.Enum("implicit", "thesis", desc="implicit steps, or the thesis's explicit flow", argstr="--method %s")
    surround = traits.Enum("fixed", "elastic", "none", desc="what happens to the polygon outside the region", argstr="--surround %s")
    collar = traits.Int(desc="edges on each side that follow an elastic surround", argstr="--collar %s")
    no_length = traits.Bool(desc="let edges of the region change their length", argstr="--no-length")
    no_topology = traits.Bool(desc="let edges cross: no repulsion, no collision detection", argstr="--no-topology")
    knot = traits.Enum("tree", "all-pairs", "off", desc="how the knot energy is summed", argstr="--knot %s")
    knot_weight = traits.Float(desc="implicit method: weight of the knot energy", argstr="--knot-weight %s")
    target_visibility = traits.Float(desc="stop at this average visibility", argstr="--target-visibility %s")
    max_iterations = traits.Int(desc="stop after this many iterations", argstr="--max-iterations %s")
    max_time = traits.Float(desc="stop after this time [s]", argstr="--max-time %s")
    visibility_gain = traits.Float(desc="thesis method: mu, the weight of the visibility", argstr="--visibility-gain %s")
    repulsion_gain = traits.Float(desc="thesis method: mu_R, the weight of the knot energy", argstr="--repulsion-gain %s")
    explicit_step = traits.Float(desc="thesis method: largest motion per iteration, in mean edges", argstr="--explicit-step %s")
    resume = traits.Bool(desc="continue the run whose outputs are in --out", argstr="--resume")
    frames = traits.Int(desc="write this many states on the way", argstr="--frames %s")
    stages = traits.Int(desc="panels of evolution.svg", argstr="--stages %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class PolygonOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    polygon_csv = File(desc="the polygon as it was understood")
    unfolded_csv = File(desc="the unfolded polygon")
    unfolded_vtp = File(desc="the same with flux and seen share of each edge")
    evolution_tsv = File(desc="one row an iteration")
    evolution_svg = File(desc="start, stages and end, with the direction of view")
    frames_frame_csv = traits.List(File(), desc="states on the way")
    polygon_state = File(desc="what --resume needs")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Polygon(CommandLine):
    """a region of a polygon opened towards a viewpoint, lengths kept."""

    _cmd = "explica polygon"
    input_spec = PolygonInputSpec
    output_spec = PolygonOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "polygon_csv": "polygon.csv",
            "unfolded_csv": "unfolded.csv",
            "unfolded_vtp": "unfolded.vtp",
            "evolution_tsv": "evolution.tsv",
            "evolution_svg": "evolution.svg",
            "frames_frame_csv": "frames/frame-*.csv",
            "polygon_state": "polygon.state",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class ReplayInputSpec(CommandLineInputSpec):
    provenance = File(exists=True, desc="a provenance.json, or the folder that holds it", argstr="%s", position=0, mandatory=True)
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class ReplayOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Replay(CommandLine):
    """run again what a record describes, and compare the results with it."""

    _cmd = "explica replay"
    input_spec = ReplayInputSpec
    output_spec = ReplayOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class ReportInputSpec(CommandLineInputSpec):
    dir = Directory(exists=True, desc="output folder of a command or of explica run", argstr="%s", position=0, mandatory=True)
    page = traits.Str(desc="file to write (default: report.html in the folder)", argstr="--page %s")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class ReportOutputSpec(TraitedSpec):
    pass


class Report(CommandLine):
    """one self-contained web page on what a command or a whole run did."""

    _cmd = "explica report"
    input_spec = ReportInputSpec
    output_spec = ReportOutputSpec


class RunInputSpec(CommandLineInputSpec):
    input = File(exists=True, desc="skull-stripped T1, label volume, FreeSurfer subject directory, or BIDS anat folder", argstr="%s", position=0, mandatory=True)
    atlas = File(exists=True, desc="labels in the input's space, as AAL's: tell a T1's hemispheres apart, and are the regions of regions.tsv", argstr="--atlas %s")
    kind = traits.Enum("auto", "t1", "labels", "freesurfer", "bids", desc="what the input is", argstr="--kind %s")
    hemisphere = traits.Enum("L", "R", desc="which hemisphere to work on", argstr="--hemisphere %s")
    unfold_surface = traits.Enum("white", "mid", "pial", desc="which surface to unfold a patch of", argstr="--unfold-surface %s")
    given_surfaces = traits.Enum("use", "remake", desc="what to do with white and pial surfaces found in the input", argstr="--given-surfaces %s")
    steps = traits.List(traits.Enum("segment", "thickness", "surface", "unfold", "report"), desc="steps to do (default: all that the input allows)", argstr="--steps %s", sep=",")
    resume = traits.Bool(desc="keep steps of an earlier run into --out that are still true", argstr="--resume")
    segment_mask = File(exists=True, desc="the brain is where this is not 0", argstr="--segment.mask %s")
    segment_atlas = File(exists=True, desc="labels in the space of the T1, as AAL's", argstr="--segment.atlas %s")
    segment_atlas_legend = File(exists=True, desc="what the atlas's labels mean, one 'value name' a line (default: the .tsv or .nii.txt beside it)", argstr="--segment.atlas-legend %s")
    segment_xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--segment.xform %s")
    segment_frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--segment.frame %s")
    segment_smooth = traits.Float(desc="weight of the Markov prior that smooths the classes; 0 for none", argstr="--segment.smooth %s")
    segment_bias_width = traits.Float(desc="standard deviation of the bias field's smoothing; 0 for no field [mm]", argstr="--segment.bias-width %s")
    segment_max_iterations = traits.Int(desc="expectation-maximisation iterations at most", argstr="--segment.max-iterations %s")
    segment_tolerance = traits.Float(desc="stop once no class mean moves by more than this share of their range", argstr="--segment.tolerance %s")
    segment_hemisphere = traits.Enum("both", "L", "R", desc="which hemisphere to take out", argstr="--segment.hemisphere %s")
    segment_core_depth = traits.Float(desc="least distance of the ventricles' voxels to cortical labels [mm]", argstr="--segment.core-depth %s")
    thickness_inner_level = File(exists=True, desc="scalar volume whose level --level is the inner boundary", argstr="--thickness.inner-level %s")
    thickness_outer_level = File(exists=True, desc="scalar volume whose level --level is the outer boundary", argstr="--thickness.outer-level %s")
    thickness_level = traits.Float(desc="value of the level sets on the boundary", argstr="--thickness.level %s")
    thickness_level_inside = traits.Enum("auto", "above", "below", desc="side of the level sets that is enclosed", argstr="--thickness.level-inside %s")
    thickness_xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--thickness.xform %s")
    thickness_frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--thickness.frame %s")
    thickness_inner = traits.List(traits.Int(), desc="labels of the enclosed region: white matter, blood pool", argstr="--thickness.inner %s", sep=",")
    thickness_tissue = traits.List(traits.Int(), desc="labels of the tissue between the two boundaries", argstr="--thickness.tissue %s", sep=",")
    thickness_outer = traits.List(traits.Int(), desc="labels outside the tissue (default: all other labels)", argstr="--thickness.outer %s", sep=",")
    thickness_insulated = traits.List(traits.Int(), desc="labels that neither side owns: no flux crosses into them", argstr="--thickness.insulated %s", sep=",")
    thickness_boundary = traits.Enum("subvoxel", "staircase", "embedding", desc="where the boundary lies between voxel centres", argstr="--thickness.boundary %s")
    thickness_open_ends = traits.Bool(desc="insulate the planes beyond the tissue's first and last slice", argstr="--thickness.open-ends")
    thickness_per_slice = traits.Bool(desc="measure every slice (along k) on its own, in two dimensions", argstr="--thickness.per-slice")
    thickness_sulci = traits.Enum("recover", "ignore", desc="what to do where the banks of a sulcus touch (default: recover; ignore with --per-slice, --open-ends or --aha, which are for hearts)", argstr="--thickness.sulci %s")
    thickness_facing = traits.Float(desc="smallest angle between two fronts from the inner boundary whose meeting is a sulcus [degrees]", argstr="--thickness.facing %s")
    thickness_method = traits.Enum("hybrid", "eulerian", "lagrangian", desc="how boundary points and lengths are found", argstr="--thickness.method %s")
    thickness_lambda = traits.Float(desc="hybrid: boundary points of neighbours nearer than this are interpolated, others followed; 0 follows all (default: twice the finest voxel size) [mm]", argstr="--thickness.lambda %s")
    thickness_layers = traits.Int(desc="number of layers, counted from the inner boundary", argstr="--thickness.layers %s")
    thickness_layer_kind = traits.Enum("depth", "volume", desc="layers of equal share of the thickness or of the column's volume", argstr="--thickness.layer-kind %s")
    thickness_grid = traits.Int(desc="write an anatomical grid with this many cells across", argstr="--thickness.grid %s")
    thickness_aha = traits.Bool(desc="table and picture of the left ventricle's 17 segments", argstr="--thickness.aha")
    thickness_rv_insertion = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="anterior insertion of the right ventricle, RAS [mm]", argstr="--thickness.rv-insertion %s,%s,%s")
    surface_inner_level = File(exists=True, desc="scalars that cross a level at the white surface: a probability or a distance", argstr="--surface.inner-level %s")
    surface_outer_level = File(exists=True, desc="scalars that cross a level at the outer surface", argstr="--surface.outer-level %s")
    surface_grey_share = File(exists=True, desc="probability of grey matter: with --inner-level the outer surface is where both together reach one half", argstr="--surface.grey-share %s")
    surface_insulated_mask = File(exists=True, desc="with --inner-level: not 0 where neither side is (a cut)", argstr="--surface.insulated-mask %s")
    surface_level = traits.Float(desc="value on the boundaries of level volumes (default: half the largest value of shares, 0 of distances)", argstr="--surface.level %s")
    surface_white_surface = File(exists=True, desc="white surface that is there already", argstr="--surface.white-surface %s")
    surface_pial_surface = File(exists=True, desc="its pial surface, same faces", argstr="--surface.pial-surface %s")
    surface_mid_surface = File(exists=True, desc="its middle surface, same faces (default: half way)", argstr="--surface.mid-surface %s")
    surface_surface_space = traits.Enum("stated", "scanner", "tkr", desc="frame of their coordinates, if the files do not say", argstr="--surface.surface-space %s")
    surface_atlas = File(exists=True, desc="labels of cortical regions in the same space: writes regions.tsv", argstr="--surface.atlas %s")
    surface_atlas_legend = File(exists=True, desc="what its labels are called (default: the .tsv or .nii.txt beside it; FreeSurfer's names are known)", argstr="--surface.atlas-legend %s")
    surface_parcellation = File(exists=True, desc="regions of given surfaces, vertex by vertex, instead of --atlas", argstr="--surface.parcellation %s")
    surface_xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--surface.xform %s")
    surface_frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--surface.frame %s")
    surface_preset = traits.Enum("auto", "aseg", "ribbon", "three-class", "wm", "none", desc="what the labels mean", argstr="--surface.preset %s")
    surface_white = traits.List(traits.Int(), desc="labels of white matter (default: the preset's)", argstr="--surface.white %s", sep=",")
    surface_grey = traits.List(traits.Int(), desc="labels of grey matter (default: the preset's)", argstr="--surface.grey %s", sep=",")
    surface_fill = traits.List(traits.Int(), desc="labels joined to white matter, such as deep structures and ventricles (default: the preset's)", argstr="--surface.fill %s", sep=",")
    surface_insulated = traits.List(traits.Int(), desc="labels that are neither inside nor outside (default: the preset's)", argstr="--surface.insulated %s", sep=",")
    surface_hemisphere = traits.Enum("L", "R", desc="which hemisphere to take, where labels hold both", argstr="--surface.hemisphere %s")
    surface_no_fill = traits.Bool(desc="join nothing to white matter", argstr="--surface.no-fill")
    surface_close_edges = traits.Bool(desc="close the surface where tissue meets the edge of the field of view, instead of refusing", argstr="--surface.close-edges")
    surface_genus = traits.Enum("zero", "keep", desc="whether handles and tunnels are removed", argstr="--surface.genus %s")
    surface_faces = traits.Int(desc="faces of each surface", argstr="--surface.faces %s")
    surface_steps = traits.Int(desc="in which the outer surface grows out of the white one", argstr="--surface.steps %s")
    surface_freesurfer = traits.Str(desc="write lh.white, lh.pial, lh.thickness and so on, too, into this folder (within --out if relative)", argstr="--surface.freesurfer %s")
    surface_fs_volume = File(exists=True, desc="volume (orig.mgz) whose surface RAS FreeSurfer files use, read or written (default: the labels, if FreeSurfer's)", argstr="--surface.fs-volume %s")
    unfold_surface_space = traits.Enum("stated", "scanner", "tkr", desc="frame of the surface's coordinates, if its file does not say", argstr="--unfold.surface-space %s")
    unfold_fs_volume = traits.Str(desc="FreeSurfer volume (orig.mgz) whose geometry places the surface", argstr="--unfold.fs-volume %s")
    unfold_viewpoint = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="point to look from [mm]", argstr="--unfold.viewpoint %s,%s,%s")
    unfold_direction = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="look from the region's centroid plus --distance along this", argstr="--unfold.direction %s,%s,%s")
    unfold_distance = traits.Float(desc="how far off a viewpoint given by --direction is [mm]", argstr="--unfold.distance %s")
    unfold_view_line = traits.List(traits.Float(), desc="look from a segment: X,Y,Z of its start and of its end [mm]", argstr="--unfold.view-line %s", sep=",")
    unfold_view_surface = File(exists=True, desc="look from all points of this surface", argstr="--unfold.view-surface %s")
    unfold_center = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="the vertex nearest to this point is the region's centre [mm]", argstr="--unfold.center %s,%s,%s")
    unfold_vertex = traits.Int(desc="vertex that is the region's centre, from 0", argstr="--unfold.vertex %s")
    unfold_radius = traits.Float(desc="how far the region reaches from its centre [mm]", argstr="--unfold.radius %s")
    unfold_metric = traits.Enum("euclidean", "geodesic", desc="how the radius is measured", argstr="--unfold.metric %s")
    unfold_cone = traits.Float(desc="region of what lies within this angle of the line from viewpoint to centre, on the near side and connected to the centre [degrees]", argstr="--unfold.cone %s")
    unfold_label = File(exists=True, desc="the region is where this label is not 0", argstr="--unfold.label %s")
    unfold_label_key = traits.Int(desc="the region is where --label has this key", argstr="--unfold.label-key %s")
    unfold_adjust_region = traits.Bool(desc="grow or shrink the region until its visibility is positive", argstr="--unfold.adjust-region")
    unfold_repair = traits.Bool(desc="part faces that intersect at the start, by small moves where that goes; the result is compared with the surface so repaired", argstr="--unfold.repair")
    unfold_surround = traits.Enum("fixed", "elastic", "none", desc="the surface around the region stays, follows with a collar, or is left out", argstr="--unfold.surround %s")
    unfold_collar_rings = traits.Int(desc="rings of faces of an elastic collar", argstr="--unfold.collar-rings %s")
    unfold_contact_range = traits.Float(desc="reach of the contact barrier in mean edge lengths", argstr="--unfold.contact-range %s")
    unfold_largest_move = traits.Float(desc="mean edge lengths that a vertex goes per iteration at most", argstr="--unfold.largest-move %s")
    unfold_method = traits.Enum("implicit", "thesis", desc="implicit steps, or the thesis's gradient flow as the baseline", argstr="--unfold.method %s")
    unfold_knot = traits.Enum("tree", "thesis-tree", "all-pairs", "off", desc="who evaluates the knot energy", argstr="--unfold.knot %s")
    unfold_keep_areas = traits.Bool(desc="thesis method: project onto kept areas", argstr="--unfold.keep-areas")
    unfold_time_step = traits.Float(desc="thesis method: fixed step instead of an adaptive one", argstr="--unfold.time-step %s")
    unfold_area_weight = traits.Float(desc="stiffness of face areas before it is tightened", argstr="--unfold.area-weight %s")
    unfold_spring_weight = traits.Float(desc="stiffness of edge lengths", argstr="--unfold.spring-weight %s")
    unfold_knot_weight = traits.Float(desc="strength of the knot energy", argstr="--unfold.knot-weight %s")
    unfold_contact_weight = traits.Float(desc="strength of the contact barrier", argstr="--unfold.contact-weight %s")
    unfold_lift_weight = traits.Float(desc="pull out of fixed or elastic surroundings, up to where the flat region has room", argstr="--unfold.lift-weight %s")
    unfold_collar_weight = traits.Float(desc="stiffness of an elastic collar beside the region's", argstr="--unfold.collar-weight %s")
    unfold_target_visibility = traits.Float(desc="stop once the average visibility reaches this; without it, once it no longer rises", argstr="--unfold.target-visibility %s")
    unfold_area_tolerance = traits.Float(desc="mean relative area error of faces that a goal asks for", argstr="--unfold.area-tolerance %s")
    unfold_max_iterations = traits.Int(desc="iterations at most", argstr="--unfold.max-iterations %s")
    unfold_max_time = traits.Float(desc="stop after this time [s]", argstr="--unfold.max-time %s")
    unfold_frames = traits.Int(desc="states to write on the way, evenly spaced in visibility", argstr="--unfold.frames %s")
    unfold_resume = traits.Bool(desc="continue the run whose outputs are in --out", argstr="--unfold.resume")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class RunOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    report_html = File(desc="everything to look at")
    run_json = File(desc="how each step went")
    segment = File(desc="tissues and hemisphere")
    thickness = File(desc="harmonic interpolant, correspondences, thickness")
    surface = File(desc="white, middle and pial surface")
    unfold = File(desc="the unfolded patch and its evolution")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Run(CommandLine):
    """from a T1, label volume or FreeSurfer subject to an unfolded patch of cortex and a report."""

    _cmd = "explica run"
    input_spec = RunInputSpec
    output_spec = RunOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "report_html": "report.html",
            "run_json": "run.json",
            "segment": "segment",
            "thickness": "thickness",
            "surface": "surface",
            "unfold": "unfold",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class SegmentInputSpec(CommandLineInputSpec):
    t1 = File(exists=True, desc="skull-stripped T1-weighted image: the brain is where it is above 0", argstr="%s", position=0, mandatory=True)
    mask = File(exists=True, desc="the brain is where this is not 0", argstr="--mask %s")
    atlas = File(exists=True, desc="labels in the space of the T1, as AAL's", argstr="--atlas %s")
    atlas_legend = File(exists=True, desc="what the atlas's labels mean, one 'value name' a line (default: the .tsv or .nii.txt beside it)", argstr="--atlas-legend %s")
    xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--xform %s")
    frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--frame %s")
    smooth = traits.Float(desc="weight of the Markov prior that smooths the classes; 0 for none", argstr="--smooth %s")
    bias_width = traits.Float(desc="standard deviation of the bias field's smoothing; 0 for no field [mm]", argstr="--bias-width %s")
    max_iterations = traits.Int(desc="expectation-maximisation iterations at most", argstr="--max-iterations %s")
    tolerance = traits.Float(desc="stop once no class mean moves by more than this share of their range", argstr="--tolerance %s")
    hemisphere = traits.Enum("both", "L", "R", desc="which hemisphere to take out", argstr="--hemisphere %s")
    core_depth = traits.Float(desc="least distance of the ventricles' voxels to cortical labels [mm]", argstr="--core-depth %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class SegmentOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    seg_nii_gz = File(desc="1 fluid, 2 grey, 3 white, 0 outside")
    csf_nii_gz = File(desc="share of fluid in each voxel")
    gm_nii_gz = File(desc="share of grey matter in each voxel")
    wm_nii_gz = File(desc="share of white matter in each voxel")
    bias_nii_gz = File(desc="multiplicative bias field")
    hemisphere_nii_gz = File(desc="with --atlas: 3 white matter, filled; 2 grey ribbon; 1 fluid; 4 cut tissue; 0 outside")
    white_share_nii_gz = File(desc="with --atlas: 0.5 is the white surface")
    cut_nii_gz = File(desc="with --atlas: 1 in cut tissue")
    tissue_share_nii_gz = File(desc="with --atlas: 0.5 is the pial surface")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Segment(CommandLine):
    """fluid, grey and white matter of a skull-stripped T1, and one hemisphere by an atlas."""

    _cmd = "explica segment"
    input_spec = SegmentInputSpec
    output_spec = SegmentOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "seg_nii_gz": "seg.nii.gz",
            "csf_nii_gz": "csf.nii.gz",
            "gm_nii_gz": "gm.nii.gz",
            "wm_nii_gz": "wm.nii.gz",
            "bias_nii_gz": "bias.nii.gz",
            "hemisphere_nii_gz": "hemisphere.nii.gz",
            "white_share_nii_gz": "white_share.nii.gz",
            "cut_nii_gz": "cut.nii.gz",
            "tissue_share_nii_gz": "tissue_share.nii.gz",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class StudyCheckInputSpec(CommandLineInputSpec):
    study = File(exists=True, desc="study file, YAML or JSON", argstr="%s", position=0, mandatory=True)
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class StudyCheckOutputSpec(TraitedSpec):
    pass


class StudyCheck(CommandLine):
    """whether a study file can be run."""

    _cmd = "explica study check"
    input_spec = StudyCheckInputSpec
    output_spec = StudyCheckOutputSpec


class StudyGroupInputSpec(CommandLineInputSpec):
    study = File(exists=True, desc="study file, YAML or JSON", argstr="%s", position=0, mandatory=True)
    out_dir = traits.Str(desc="folder of the results", argstr="%s", position=1, mandatory=True)
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class StudyGroupOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    study_tsv = File(desc="one row a subject, hemisphere and region")
    index_html = File(desc="the same, to sort and click")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class StudyGroup(CommandLine):
    """the table of a study and its page."""

    _cmd = "explica study group"
    input_spec = StudyGroupInputSpec
    output_spec = StudyGroupOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "study_tsv": "study.tsv",
            "index_html": "index.html",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class StudyListInputSpec(CommandLineInputSpec):
    study = File(exists=True, desc="study file, YAML or JSON", argstr="%s", position=0, mandatory=True)
    out_dir = traits.Str(desc="folder of the results; only for --todo", argstr="%s", position=1)
    todo = traits.Bool(desc="only subjects whose work is not settled", argstr="--todo")
    keys = traits.Bool(desc="the key of each subject, too", argstr="--keys")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class StudyListOutputSpec(TraitedSpec):
    pass


class StudyList(CommandLine):
    """the subjects of a study, one a line, for schedulers."""

    _cmd = "explica study list"
    input_spec = StudyListInputSpec
    output_spec = StudyListOutputSpec


class StudyParticipantInputSpec(CommandLineInputSpec):
    study = File(exists=True, desc="study file, YAML or JSON", argstr="%s", position=0, mandatory=True)
    out_dir = traits.Str(desc="folder of the results", argstr="%s", position=1, mandatory=True)
    participant_label = traits.List(traits.Str(), desc="subjects to do, with or without sub-", argstr="--participant-label %s...")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class StudyParticipantOutputSpec(TraitedSpec):
    pass


class StudyParticipant(CommandLine):
    """the runs of a study's subjects."""

    _cmd = "explica study participant"
    input_spec = StudyParticipantInputSpec
    output_spec = StudyParticipantOutputSpec


class StudySchemaInputSpec(CommandLineInputSpec):
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class StudySchemaOutputSpec(TraitedSpec):
    pass


class StudySchema(CommandLine):
    """the JSON schema of study files, for editors and other programs."""

    _cmd = "explica study schema"
    input_spec = StudySchemaInputSpec
    output_spec = StudySchemaOutputSpec


class SurfaceInputSpec(CommandLineInputSpec):
    seg = File(exists=True, desc="labels; may be left out if --inner-level or --white-surface is given", argstr="%s", position=0)
    inner_level = File(exists=True, desc="scalars that cross a level at the white surface: a probability or a distance", argstr="--inner-level %s")
    outer_level = File(exists=True, desc="scalars that cross a level at the outer surface", argstr="--outer-level %s")
    grey_share = File(exists=True, desc="probability of grey matter: with --inner-level the outer surface is where both together reach one half", argstr="--grey-share %s")
    insulated_mask = File(exists=True, desc="with --inner-level: not 0 where neither side is (a cut)", argstr="--insulated-mask %s")
    level = traits.Float(desc="value on the boundaries of level volumes (default: half the largest value of shares, 0 of distances)", argstr="--level %s")
    white_surface = File(exists=True, desc="white surface that is there already", argstr="--white-surface %s")
    pial_surface = File(exists=True, desc="its pial surface, same faces", argstr="--pial-surface %s")
    mid_surface = File(exists=True, desc="its middle surface, same faces (default: half way)", argstr="--mid-surface %s")
    surface_space = traits.Enum("stated", "scanner", "tkr", desc="frame of their coordinates, if the files do not say", argstr="--surface-space %s")
    atlas = File(exists=True, desc="labels of cortical regions in the same space: writes regions.tsv", argstr="--atlas %s")
    atlas_legend = File(exists=True, desc="what its labels are called (default: the .tsv or .nii.txt beside it; FreeSurfer's names are known)", argstr="--atlas-legend %s")
    parcellation = File(exists=True, desc="regions of given surfaces, vertex by vertex, instead of --atlas", argstr="--parcellation %s")
    xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--xform %s")
    frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--frame %s")
    preset = traits.Enum("auto", "aseg", "ribbon", "three-class", "wm", "none", desc="what the labels mean", argstr="--preset %s")
    white = traits.List(traits.Int(), desc="labels of white matter (default: the preset's)", argstr="--white %s", sep=",")
    grey = traits.List(traits.Int(), desc="labels of grey matter (default: the preset's)", argstr="--grey %s", sep=",")
    fill = traits.List(traits.Int(), desc="labels joined to white matter, such as deep structures and ventricles (default: the preset's)", argstr="--fill %s", sep=",")
    insulated = traits.List(traits.Int(), desc="labels that are neither inside nor outside (default: the preset's)", argstr="--insulated %s", sep=",")
    hemisphere = traits.Enum("L", "R", desc="which hemisphere to take, where labels hold both", argstr="--hemisphere %s")
    no_fill = traits.Bool(desc="join nothing to white matter", argstr="--no-fill")
    close_edges = traits.Bool(desc="close the surface where tissue meets the edge of the field of view, instead of refusing", argstr="--close-edges")
    genus = traits.Enum("zero", "keep", desc="whether handles and tunnels are removed", argstr="--genus %s")
    faces = traits.Int(desc="faces of each surface", argstr="--faces %s")
    steps = traits.Int(desc="in which the outer surface grows out of the white one", argstr="--steps %s")
    freesurfer = traits.Str(desc="write lh.white, lh.pial, lh.thickness and so on, too, into this folder (within --out if relative)", argstr="--freesurfer %s")
    fs_volume = File(exists=True, desc="volume (orig.mgz) whose surface RAS FreeSurfer files use, read or written (default: the labels, if FreeSurfer's)", argstr="--fs-volume %s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class SurfaceOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    white_surf_gii = File(desc="white surface")
    mid_surf_gii = File(desc="surface at half depth, same faces")
    pial_surf_gii = File(desc="outer surface, same faces")
    thickness_shape_gii = File(desc="length of each vertex's trajectory, mm; 0 where there is no grey matter")
    valid_shape_gii = File(desc="1 where the thickness is defined, else 0")
    curvature_shape_gii = File(desc="mean curvature of the white surface, 1/mm, positive in sulci")
    sulc_shape_gii = File(desc="depth of the middle surface below the hull, mm")
    area_shape_gii = File(desc="area at each vertex of the white, middle and outer surface, mm^2")
    topology_tsv = File(desc="one row for each corrected defect")
    regions_tsv = File(desc="with --atlas: area and thickness of each region")
    regions_label_gii = File(desc="with --atlas: region of each vertex")
    surface_spec = File(desc="opens everything in Workbench")
    lh_ = traits.List(File(), desc="with --freesurfer: FreeSurfer files, left")
    rh_ = traits.List(File(), desc="with --freesurfer: FreeSurfer files, right")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Surface(CommandLine):
    """inner, middle and outer surface of the cortical ribbon, vertex by vertex."""

    _cmd = "explica surface"
    input_spec = SurfaceInputSpec
    output_spec = SurfaceOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "white_surf_gii": "white.surf.gii",
            "mid_surf_gii": "mid.surf.gii",
            "pial_surf_gii": "pial.surf.gii",
            "thickness_shape_gii": "thickness.shape.gii",
            "valid_shape_gii": "valid.shape.gii",
            "curvature_shape_gii": "curvature.shape.gii",
            "sulc_shape_gii": "sulc.shape.gii",
            "area_shape_gii": "area.shape.gii",
            "topology_tsv": "topology.tsv",
            "regions_tsv": "regions.tsv",
            "regions_label_gii": "regions.label.gii",
            "surface_spec": "surface.spec",
            "lh_": "*lh.*",
            "rh_": "*rh.*",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class ThicknessInputSpec(CommandLineInputSpec):
    seg = File(exists=True, desc="label volume; with level sets it may be left out, or say what is insulated", argstr="%s", position=0)
    inner_level = File(exists=True, desc="scalar volume whose level --level is the inner boundary", argstr="--inner-level %s")
    outer_level = File(exists=True, desc="scalar volume whose level --level is the outer boundary", argstr="--outer-level %s")
    level = traits.Float(desc="value of the level sets on the boundary", argstr="--level %s")
    level_inside = traits.Enum("auto", "above", "below", desc="side of the level sets that is enclosed", argstr="--level-inside %s")
    xform = traits.Enum("agreed", "qform", "sform", "none", desc="which placement of a NIfTI header to believe where the two differ", argstr="--xform %s")
    frame = traits.Int(desc="which volume of a file that holds several, counted from 0", argstr="--frame %s")
    inner = traits.List(traits.Int(), desc="labels of the enclosed region: white matter, blood pool", argstr="--inner %s", sep=",")
    tissue = traits.List(traits.Int(), desc="labels of the tissue between the two boundaries", argstr="--tissue %s", sep=",")
    outer = traits.List(traits.Int(), desc="labels outside the tissue (default: all other labels)", argstr="--outer %s", sep=",")
    insulated = traits.List(traits.Int(), desc="labels that neither side owns: no flux crosses into them", argstr="--insulated %s", sep=",")
    boundary = traits.Enum("subvoxel", "staircase", "embedding", desc="where the boundary lies between voxel centres", argstr="--boundary %s")
    open_ends = traits.Bool(desc="insulate the planes beyond the tissue's first and last slice", argstr="--open-ends")
    per_slice = traits.Bool(desc="measure every slice (along k) on its own, in two dimensions", argstr="--per-slice")
    sulci = traits.Enum("recover", "ignore", desc="what to do where the banks of a sulcus touch (default: recover; ignore with --per-slice, --open-ends or --aha, which are for hearts)", argstr="--sulci %s")
    facing = traits.Float(desc="smallest angle between two fronts from the inner boundary whose meeting is a sulcus [degrees]", argstr="--facing %s")
    method = traits.Enum("hybrid", "eulerian", "lagrangian", desc="how boundary points and lengths are found", argstr="--method %s")
    lambda_ = traits.Float(desc="hybrid: boundary points of neighbours nearer than this are interpolated, others followed; 0 follows all (default: twice the finest voxel size) [mm]", argstr="--lambda %s")
    layers = traits.Int(desc="number of layers, counted from the inner boundary", argstr="--layers %s")
    layer_kind = traits.Enum("depth", "volume", desc="layers of equal share of the thickness or of the column's volume", argstr="--layer-kind %s")
    grid = traits.Int(desc="write an anatomical grid with this many cells across", argstr="--grid %s")
    aha = traits.Bool(desc="table and picture of the left ventricle's 17 segments", argstr="--aha")
    rv_insertion = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="anterior insertion of the right ventricle, RAS [mm]", argstr="--rv-insertion %s,%s,%s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class ThicknessOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    harmonic_nii_gz = File(desc="u: 0 at the inner boundary to 1 at the outer one")
    thickness_nii_gz = File(desc="length of the trajectory, mm; 0 off the tissue")
    inner_distance_nii_gz = File(desc="L0: length to the inner boundary, mm")
    outer_distance_nii_gz = File(desc="L1: length to the outer boundary, mm")
    depth_nii_gz = File(desc="L0 / thickness")
    inner_point_nii_gz = File(desc="phi0: corresponding point of the inner boundary, RAS mm")
    outer_point_nii_gz = File(desc="phi1: corresponding point of the outer boundary, RAS mm")
    layers_nii_gz = File(desc="layer, 1 at the inner boundary")
    grid_vtu = File(desc="with --grid: points at equal depths along trajectories, with depth and thickness")
    segments_tsv = File(desc="with --aha: thickness of the 17 segments")
    segments_nii_gz = File(desc="with --aha: segment of each voxel")
    bullseye_svg = File(desc="with --aha: the segments' mean thickness, mm")
    sulci_nii_gz = File(desc="where sulci are recovered: 1 beside a boundary that was put between banks")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Thickness(CommandLine):
    """thickness, depth and layers of the tissue between two boundaries."""

    _cmd = "explica thickness"
    input_spec = ThicknessInputSpec
    output_spec = ThicknessOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "harmonic_nii_gz": "harmonic.nii.gz",
            "thickness_nii_gz": "thickness.nii.gz",
            "inner_distance_nii_gz": "inner_distance.nii.gz",
            "outer_distance_nii_gz": "outer_distance.nii.gz",
            "depth_nii_gz": "depth.nii.gz",
            "inner_point_nii_gz": "inner_point.nii.gz",
            "outer_point_nii_gz": "outer_point.nii.gz",
            "layers_nii_gz": "layers.nii.gz",
            "grid_vtu": "grid.vtu",
            "segments_tsv": "segments.tsv",
            "segments_nii_gz": "segments.nii.gz",
            "bullseye_svg": "bullseye.svg",
            "sulci_nii_gz": "sulci.nii.gz",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class UnfoldInputSpec(CommandLineInputSpec):
    surface = File(exists=True, desc="triangulated surface", argstr="%s", position=0, mandatory=True)
    surface_space = traits.Enum("stated", "scanner", "tkr", desc="frame of the surface's coordinates, if its file does not say", argstr="--surface-space %s")
    fs_volume = traits.Str(desc="FreeSurfer volume (orig.mgz) whose geometry places the surface", argstr="--fs-volume %s")
    viewpoint = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="point to look from [mm]", argstr="--viewpoint %s,%s,%s")
    direction = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="look from the region's centroid plus --distance along this", argstr="--direction %s,%s,%s")
    distance = traits.Float(desc="how far off a viewpoint given by --direction is [mm]", argstr="--distance %s")
    view_line = traits.List(traits.Float(), desc="look from a segment: X,Y,Z of its start and of its end [mm]", argstr="--view-line %s", sep=",")
    view_surface = File(exists=True, desc="look from all points of this surface", argstr="--view-surface %s")
    center = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="the vertex nearest to this point is the region's centre [mm]", argstr="--center %s,%s,%s")
    vertex = traits.Int(desc="vertex that is the region's centre, from 0", argstr="--vertex %s")
    radius = traits.Float(desc="how far the region reaches from its centre [mm]", argstr="--radius %s")
    metric = traits.Enum("euclidean", "geodesic", desc="how the radius is measured", argstr="--metric %s")
    cone = traits.Float(desc="region of what lies within this angle of the line from viewpoint to centre, on the near side and connected to the centre [degrees]", argstr="--cone %s")
    label = File(exists=True, desc="the region is where this label is not 0", argstr="--label %s")
    label_key = traits.Int(desc="the region is where --label has this key", argstr="--label-key %s")
    adjust_region = traits.Bool(desc="grow or shrink the region until its visibility is positive", argstr="--adjust-region")
    repair = traits.Bool(desc="part faces that intersect at the start, by small moves where that goes; the result is compared with the surface so repaired", argstr="--repair")
    surround = traits.Enum("fixed", "elastic", "none", desc="the surface around the region stays, follows with a collar, or is left out", argstr="--surround %s")
    collar_rings = traits.Int(desc="rings of faces of an elastic collar", argstr="--collar-rings %s")
    contact_range = traits.Float(desc="reach of the contact barrier in mean edge lengths", argstr="--contact-range %s")
    largest_move = traits.Float(desc="mean edge lengths that a vertex goes per iteration at most", argstr="--largest-move %s")
    method = traits.Enum("implicit", "thesis", desc="implicit steps, or the thesis's gradient flow as the baseline", argstr="--method %s")
    knot = traits.Enum("tree", "thesis-tree", "all-pairs", "off", desc="who evaluates the knot energy", argstr="--knot %s")
    keep_areas = traits.Bool(desc="thesis method: project onto kept areas", argstr="--keep-areas")
    time_step = traits.Float(desc="thesis method: fixed step instead of an adaptive one", argstr="--time-step %s")
    area_weight = traits.Float(desc="stiffness of face areas before it is tightened", argstr="--area-weight %s")
    spring_weight = traits.Float(desc="stiffness of edge lengths", argstr="--spring-weight %s")
    knot_weight = traits.Float(desc="strength of the knot energy", argstr="--knot-weight %s")
    contact_weight = traits.Float(desc="strength of the contact barrier", argstr="--contact-weight %s")
    lift_weight = traits.Float(desc="pull out of fixed or elastic surroundings, up to where the flat region has room", argstr="--lift-weight %s")
    collar_weight = traits.Float(desc="stiffness of an elastic collar beside the region's", argstr="--collar-weight %s")
    target_visibility = traits.Float(desc="stop once the average visibility reaches this; without it, once it no longer rises", argstr="--target-visibility %s")
    area_tolerance = traits.Float(desc="mean relative area error of faces that a goal asks for", argstr="--area-tolerance %s")
    max_iterations = traits.Int(desc="iterations at most", argstr="--max-iterations %s")
    max_time = traits.Float(desc="stop after this time [s]", argstr="--max-time %s")
    frames = traits.Int(desc="states to write on the way, evenly spaced in visibility", argstr="--frames %s")
    resume = traits.Bool(desc="continue the run whose outputs are in --out", argstr="--resume")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")


class UnfoldOutputSpec(TraitedSpec):
    out = Directory(desc="folder of the results")
    unfolded_surf_gii = File(desc="the surface with its region unfolded")
    unfolded_vtp = File(desc="the same with all values of vertices and faces")
    region_label_gii = File(desc="1 in the region")
    visibility_shape_gii = File(desc="flux before, flux after, seen before, seen after")
    distortion_shape_gii = File(desc="area ratio, angle change in degrees, edge strain")
    evolution_tsv = File(desc="one row per iteration")
    intersections_tsv = File(desc="pairs of faces that intersect at the start, where, and whether --repair parted them")
    frames_frame_surf_gii = traits.List(File(), desc="--frames states on the way")
    unfolding_state = File(desc="what --resume needs")
    summary_json = File(desc="the numbers")
    provenance_json = File(desc="what ran on what, with hashes")


class Unfold(CommandLine):
    """a region of a folded surface opened towards a viewpoint, areas kept."""

    _cmd = "explica unfold"
    input_spec = UnfoldInputSpec
    output_spec = UnfoldOutputSpec

    def _list_outputs(self):
        outputs = self.output_spec().get()
        out = os.path.abspath(self.inputs.out)
        outputs["out"] = out
        for name, pattern in {
            "unfolded_surf_gii": "unfolded.surf.gii",
            "unfolded_vtp": "unfolded.vtp",
            "region_label_gii": "region.label.gii",
            "visibility_shape_gii": "visibility.shape.gii",
            "distortion_shape_gii": "distortion.shape.gii",
            "evolution_tsv": "evolution.tsv",
            "intersections_tsv": "intersections.tsv",
            "frames_frame_surf_gii": "frames/frame-*.surf.gii",
            "unfolding_state": "unfolding.state",
            "summary_json": "summary.json",
            "provenance_json": "provenance.json",
        }.items():
            found = sorted(glob.glob(os.path.join(out, pattern)))
            if found:
                outputs[name] = found if "*" in pattern else found[0]
        return outputs


class VerifyInputSpec(CommandLineInputSpec):
    provenance = File(exists=True, desc="a provenance.json, or the folder that holds it", argstr="%s", position=0, mandatory=True)
    deep = traits.Bool(desc="follow the records of the inputs, back to the first", argstr="--deep")
    prov_json = traits.Bool(desc="print the record as W3C PROV-JSON instead of verifying; with --deep those of its inputs too", argstr="--prov-json")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class VerifyOutputSpec(TraitedSpec):
    pass


class Verify(CommandLine):
    """compare inputs and outputs of a run with the hashes in its record."""

    _cmd = "explica verify"
    input_spec = VerifyInputSpec
    output_spec = VerifyOutputSpec


class ViewInputSpec(CommandLineInputSpec):
    file = traits.List(File(exists=True), desc="surfaces; or a volume and surfaces; or a folder of `explica unfold`", argstr="%s", position=0, mandatory=True)
    screenshot = traits.Str(desc="PNG file to write", argstr="--screenshot %s")
    film = traits.Str(desc="animated .gif or .png to write, from a folder of `explica unfold`", argstr="--film %s")
    map = File(exists=True, desc="per-vertex values to colour the surface by", argstr="--map %s")
    map_name = traits.Str(desc="which of the map file's maps (default: the first)", argstr="--map-name %s")
    labels = File(exists=True, desc="per-vertex labels to colour the surface by", argstr="--labels %s")
    region = File(exists=True, desc="labels: vertices of label 0 are drawn paler", argstr="--region %s")
    views = traits.List(traits.Enum("left", "right", "front", "back", "top", "bottom"), desc="sides to look from (default: left,right)", argstr="--views %s", sep=",")
    direction = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="look from this side instead: a direction from the surface to the eye", argstr="--direction %s,%s,%s")
    focus = traits.Bool(desc="fill the picture with the --region", argstr="--focus")
    colours = traits.Enum("sequential", "heat", "diverging", "grey", desc="colour map (default: by the values)", argstr="--colours %s")
    range = traits.Tuple(traits.Float(), traits.Float(), desc="values of the first and last colour", argstr="--range %s,%s")
    columns = traits.Int(desc="views in a row", argstr="--columns %s")
    slices = traits.Int(desc="slices of a volume in each direction", argstr="--slices %s")
    fps = traits.Float(desc="frames a second of a film", argstr="--fps %s")
    width = traits.Int(desc="width of a view [pixels]", argstr="--width %s")
    height = traits.Int(desc="height of a view [pixels]", argstr="--height %s")
    samples = traits.Int(desc="rays a pixel in each direction, against jagged edges", argstr="--samples %s")
    occlusion = traits.Float(desc="how much folds darken, 0 to 1", argstr="--occlusion %s")
    vertex = traits.Int(desc="centre of the region to start with", argstr="--vertex %s")
    radius = traits.Float(desc="of the region to start with [mm]", argstr="--radius %s")
    distance = traits.Float(desc="of the viewpoint from the region [mm]", argstr="--distance %s")
    surround = traits.Enum("fixed", "elastic", "none", desc="what becomes of the surface around the region", argstr="--surround %s")
    save = traits.Str(desc="folder for saved states: each goes into iteration-N in it", argstr="--save %s")
    script = traits.Str(desc="file of events to play instead of waiting for the user's", argstr="--script %s")
    surface_space = traits.Enum("stated", "scanner", "tkr", desc="frame of the surface's coordinates, if its file does not say", argstr="--surface-space %s")
    fs_volume = traits.Str(desc="FreeSurfer volume (orig.mgz) whose geometry places the surface", argstr="--fs-volume %s")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may)", argstr="--threads %s")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")


class ViewOutputSpec(TraitedSpec):
    pass


class View(CommandLine):
    """choose and steer an unfolding in a window; pictures and films without one."""

    _cmd = "explica view"
    input_spec = ViewInputSpec
    output_spec = ViewOutputSpec
