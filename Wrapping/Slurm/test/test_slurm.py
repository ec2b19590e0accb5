# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""A study as a job array on a real Slurm: killed, stopped, broken and good subjects."""

import pathlib
import tempfile
import unittest

import slurm_node
import small_study

SCRIPT = pathlib.Path(__file__).parents[1] / "explica-study-slurm"
ENDED = {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL", "OUT_OF_MEMORY"}


@unittest.skipIf(slurm_node.missing(), "skipped: " + slurm_node.missing())
class Slurm(unittest.TestCase):
    def setUp(self):
        node = slurm_node.SlurmNode(cpus=4)
        self.addCleanup(node.stop)
        node.start()
        self.node = node
        folder = tempfile.TemporaryDirectory(prefix="explica-study-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "results"
        node.environment["EXPLICA"] = small_study.EXECUTABLE

    def submit(self, study, *options):
        """Numbers of the array and of the table's job."""
        numbers = self.node.run(SCRIPT, study, self.out, *options).split()
        return numbers[0], numbers[-1]

    def wait_for(self, job):
        def ended():
            states = self.node.job_states(job)
            return states and set(states.values()) <= ENDED
        small_study.wait(f"job {job}", ended, lambda: f"{self.node.job_states(job)}\n{self.logs()}")
        return self.node.job_states(job)

    def logs(self):
        return "\n".join(log.read_text() for log in self.out.glob("slurm/*.log")) + self.node.logs()

    def test_every_fate_of_a_subject_ends_in_a_row_and_a_resume_does_what_is_missing(self):
        study = small_study.make(self.folder, broken=["04"])
        array, table = self.submit(study, "--cpus-per-task=1")
        waiting = {"02": lambda: self.node.kill_job_with("02"),
                   "03": lambda: self.node.run("scancel", "--signal=USR1", "--full", f"{array}_2")}

        def signalled():
            for label in [x for x in waiting if small_study.unfolding_has_begun(self.out, x)]:
                waiting.pop(label)()
            return not waiting

        small_study.wait("unfolding of 02 and 03", signalled, self.logs)
        states = self.wait_for(array)
        self.assertEqual(states[0], "FAILED", self.logs())  # exit code 3: a marked partial result
        self.assertNotEqual(states[1], "COMPLETED")
        self.assertNotEqual(states[3], "COMPLETED")
        self.assertEqual(self.wait_for(table), {-1: "COMPLETED"}, self.logs())

        rows = small_study.table(self.out)
        self.assertEqual(list(rows), ["sub-01", "sub-02", "sub-03", "sub-04"])
        self.assertIn("stopped early (unfold)", rows["sub-01"])  # its two iterations
        self.assertIn("failed: ended from outside", rows["sub-02"])
        self.assertIn("interrupted (unfold)", rows["sub-03"])
        self.assertIn("04.nii.gz", rows["sub-04"])
        # A partial result, if there was one by then, is whole and says what it is.
        if (small_study.run_folder(self.out, "03") / "unfold").exists():
            stopped = small_study.record(self.out, "03", "unfold")
            self.assertEqual((stopped["termination"], stopped["exit_code"]), ("interrupted", 3))
            small_study.explica("verify", "--deep", small_study.run_folder(self.out, "03") / "unfold")
        # One processor, because Slurm gave one.
        done = small_study.record(self.out, "01", "unfold")
        self.assertEqual(done["execution"]["threads"], {"count": 1, "because": "SLURM_CPUS_PER_TASK"})

        self.assertEqual(small_study.todo(study, self.out), ["02", "03", "04"])
        small_study.mend(self.folder, "04")
        before = small_study.records(self.out)
        array, table = self.submit(study, "--cpus-per-task=2")
        self.assertEqual(set(self.wait_for(array)), {0, 1, 2})
        self.assertEqual(self.wait_for(table), {-1: "COMPLETED"}, self.logs())
        self.assertEqual(small_study.todo(study, self.out), [])
        after = small_study.records(self.out)
        changed = {name for name in after if after[name] != before.get(name)}
        self.assertEqual(changed, {"runs/sub-02_hemi-L/unfold/provenance.json",
                                   "runs/sub-03_hemi-L/unfold/provenance.json",
                                   "runs/sub-04_hemi-L/surface/provenance.json",
                                   "runs/sub-04_hemi-L/unfold/provenance.json"})
        for label in ("01", "02", "03", "04"):
            self.assertEqual(small_study.record(self.out, label, "unfold")["termination"], "max-iterations")
            small_study.explica("verify", "--deep", small_study.run_folder(self.out, label))

        # Nothing is left: only the table's job is submitted.
        numbers = self.node.run(SCRIPT, study, self.out).split()
        self.assertEqual(len(numbers), 1)

    def test_the_line_on_the_page_works(self):
        page = (SCRIPT.parents[2] / "ExampleData/study/README.md").read_text()
        line = next(x.strip() for x in page.splitlines() if "/explica-study-slurm " in x)
        study = small_study.make(self.folder)
        study.write_text(study.read_text().replace("[surface, unfold]", "[surface]").replace("30000", "3000"))
        self.node.environment["EXPLICA_SOURCE"] = str(SCRIPT.parents[2])
        numbers = self.node.run("sh", "-c", line, cwd=self.folder).split()
        self.assertEqual(set(self.wait_for(numbers[0]).values()), {"COMPLETED"}, self.logs())
        self.assertEqual(self.wait_for(numbers[-1]), {-1: "COMPLETED"}, self.logs())
        self.assertEqual(set(small_study.table(self.out).values()), {"done"})

    def test_one_task_may_take_several_subjects(self):
        study = small_study.make(self.folder)
        study.write_text(study.read_text().replace("[surface, unfold]", "[surface]")
                         .replace("30000", "3000"))
        array, table = self.submit(study, "--per-task", "3", "--cpus-per-task=2")
        self.assertEqual(self.wait_for(array), {0: "COMPLETED", 1: "COMPLETED"}, self.logs())
        self.assertEqual(self.wait_for(table), {-1: "COMPLETED"}, self.logs())
        self.assertEqual(set(small_study.table(self.out).values()), {"done"})

    def test_before_the_time_limit_what_is_reached_is_written(self):
        study = small_study.make(self.folder)
        # Minutes of work, whatever the machine: goals out of reach.
        study.write_text(study.read_text().replace(
            "max-iterations: 12", "max-iterations: 100000, knot: thesis-tree, target-visibility: 1"))
        # Slurm counts in minutes and may give the signal up to one of them early.
        array, table = self.submit(study, "--per-task", "4", "--cpus-per-task=2", "--time=1",
                                   "--signal=B:USR1@40")
        self.assertEqual(self.wait_for(array), {0: "FAILED"}, self.logs())  # not TIMEOUT: exit code 3
        self.assertEqual(self.wait_for(table), {-1: "COMPLETED"}, self.logs())
        self.assertNotIn("ended from outside", " ".join(small_study.table(self.out).values()))
        self.assertIn("03", small_study.todo(study, self.out))


if __name__ == "__main__":
    unittest.main()
