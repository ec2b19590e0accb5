class PhantomShellInputSpec(CommandLineInputSpec):
    size = traits.Int(desc="voxels along the first axis [8 to 1024]", argstr="--size %s")
    spacing = traits.Float(desc="voxel size along the first axis [mm]", argstr="--spacing %s")
    inner_radius = traits.Float(desc="inner radius over half the grid's width", argstr="--inner-radius %s")
    outer_radius = traits.Float(desc="outer radius over half the grid's width", argstr="--outer-radius %s")
    aspect = traits.Tuple(traits.Float(), traits.Float(), traits.Float(), desc="voxel size along each axis over --spacing", argstr="--aspect %s,%s,%s")
    out = traits.Str(desc="folder for the results; made if absent, refused if not empty", argstr="--out %s", mandatory=True)
    force = traits.Bool(desc="write into a folder that is not empty, replacing earlier results", argstr="--force")
    config = traits.Str(desc="JSON file with option values; the command line wins", argstr="--config %s")
    threads = traits.Int(desc="processors to use (default: all that this process may) [1 to 4096]", argstr="--threads %s")
    max_time = traits.Float(desc="ask for an end after this time, with what was reached [s; above 0, at most 1,000,000,000]", argstr="--max-time %s")
    max_memory = traits.Int(desc="memory at most [MB; 64 to 1,073,741,824]", argstr="--max-memory %s")
    dry_run = traits.Bool(desc="resolve and check everything, print the options, write nothing", argstr="--dry-run")
    quiet = traits.Bool(desc="say nothing but warnings and errors", argstr="--quiet")
    verbose = traits.Bool(desc="say more", argstr="--verbose")
    log = traits.Str(desc="file to which every message goes, with times", argstr="--log %s")
    private = traits.Bool(desc="leave host, user and absolute paths out of the record", argstr="--private")
    report = traits.Bool(desc="write report.html, a page on the results, too", argstr="--report")


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
