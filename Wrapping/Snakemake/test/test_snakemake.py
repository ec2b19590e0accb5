# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The workflow with Debian's Snakemake: on this machine, and through its profile on a real Slurm."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).parents[1]
sys.path.insert(0, str(HERE.parent / "Slurm/test"))
import slurm_node  # noqa: E402
import small_study  # noqa: E402

SNAKEMAKE = "/usr/bin/snakemake"  # Debian's, whichever comes first in PATH
ABSENT = "" if os.path.exists(SNAKEMAKE) else "not installed: snakemake (apt-get install snakemake)"


@unittest.skipIf(ABSENT, "skipped: " + ABSENT)
class Snakemake(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="explica-study-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "results"
        self.environment = dict(os.environ, HOME=str(self.folder))

    def words(self, study, *options):
        return [SNAKEMAKE, "-s", HERE / "Snakefile", *options,
                "--config", f"study={study}", f"out={self.out}", f"explica={small_study.EXECUTABLE}", "threads=1",
                "mem_mb=500"]

    def snakemake(self, study, *options, check=True):
        done = subprocess.run(self.words(study, *options), cwd=self.folder, env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=small_study.PATIENCE, check=False)
        if check:
            self.assertEqual(done.returncode, 0, done.stdout)
        return done

    def test_a_failed_subject_is_a_row_and_only_what_changed_is_done_again(self):
        study = small_study.make(self.folder, broken=["04"])
        study.write_text(study.read_text().replace("30000", "3000").replace("14,", "8,"))
        local = ("--cores", "2", "--keep-going")
        first = self.snakemake(study, *local, check=False)
        self.assertEqual(first.returncode, 1, first.stdout)
        rows = small_study.table(self.out)
        self.assertEqual(list(rows), ["sub-01", "sub-02", "sub-03", "sub-04"])
        self.assertIn("04.nii.gz", rows["sub-04"])
        self.assertEqual(small_study.todo(study, self.out), ["04"])

        small_study.mend(self.folder, "04")
        before = small_study.records(self.out)
        self.snakemake(study, *local)
        after = small_study.records(self.out)
        self.assertTrue(all(after[name] == before[name] for name in before))
        self.assertEqual(small_study.todo(study, self.out), [])
        self.assertNotIn("failed", small_study.table(self.out)["sub-04"])

        # New dates and more threads change nothing; a new option of one subject only that subject.
        for file in self.folder.glob("0?.nii.gz"):
            file.touch()
        study.touch()
        self.assertIn("Nothing to be done", self.snakemake(study, *local, "--set-threads", "participant=2").stdout)
        study.write_text(study.read_text().replace('"01":', '"01": {parameters: {unfold: {radius: 7}}}'))
        self.snakemake(study, *local)
        again = small_study.records(self.out)
        self.assertEqual({name for name in again if again[name] != after[name]},
                         {"runs/sub-01_hemi-L/unfold/provenance.json"})

    def test_a_faulty_study_file_stops_before_anything_runs(self):
        study = small_study.make(self.folder)
        study.write_text(study.read_text().replace("radius", "radus", 1))
        done = self.snakemake(study, "--cores", "1", check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("did you mean 'radius'?", done.stdout)
        self.assertFalse(self.out.exists())

    @unittest.skipIf(slurm_node.missing(), "skipped: " + slurm_node.missing())
    def test_on_slurm_a_killed_job_is_noticed_and_the_table_is_written(self):
        study = small_study.make(self.folder)
        with slurm_node.SlurmNode(cpus=4) as node:
            self.environment = dict(node.environment, HOME=str(self.folder))
            profile = ("--profile", HERE / "slurm", "--latency-wait", "2")
            with subprocess.Popen(self.words(study, *profile), cwd=self.folder, env=self.environment,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as main:
                try:
                    small_study.wait("unfolding of 02",
                                     lambda: small_study.unfolding_has_begun(self.out, "02")
                                     or main.poll() is not None, node.logs)
                    self.assertIsNone(main.poll(), main.poll() is not None and main.stdout.read())
                    node.kill_job_with("02")
                    output, _ = main.communicate(timeout=small_study.PATIENCE)
                finally:
                    main.kill()
            self.assertEqual(main.returncode, 1, output)
            rows = small_study.table(self.out)
            self.assertIn("failed: ended from outside", rows["sub-02"], output)
            self.assertEqual(small_study.todo(study, self.out), ["02"])
            before = small_study.records(self.out)
            self.snakemake(study, *profile)
            after = small_study.records(self.out)
            self.assertEqual({name for name in after if after[name] != before.get(name)},
                             {"runs/sub-02_hemi-L/unfold/provenance.json"})
            self.assertEqual(small_study.todo(study, self.out), [])


if __name__ == "__main__":
    unittest.main()
