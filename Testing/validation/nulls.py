#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Data without any effect, analysed by `explica glm`: are its P-values uniform, and is a study in twenty
wrong?  Each data set is a table of correlated regions of two groups of different age.

    Testing/validation/nulls.py [DATA_SETS] [EXPLICA]

Prints the Kolmogorov-Smirnov distance of the least family-wise P by permutation, of the P of one region, and
the share of data sets with any P at or below 0.05; ends with 1 where one is out of its limits.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

import numpy

PEOPLE, REGIONS, SHUFFLES = 24, 40, 199


def write_people(path, generator):
    """A random walk over regions, an age that differs between groups and changes nothing."""
    values = numpy.cumsum(generator.normal(size=(PEOPLE, REGIONS)), axis=1) * 0.05 + 2.5
    group = numpy.arange(PEOPLE) % 2
    age = 40 + 10 * generator.normal(size=PEOPLE) + 5 * group
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, delimiter="\t")
        writer.writerow(["participant_id", "group", "age"] + [f"region{r}" for r in range(REGIONS)])
        for person in range(PEOPLE):
            writer.writerow([f"sub-{person}", "ab"[group[person]], age[person], *values[person]])


def analyse(explica, folder, seed):
    """P by t of the first region, and the least family-wise P."""
    write_people(folder / "people.tsv", numpy.random.default_rng(seed))
    subprocess.run([explica, "glm", folder / "people.tsv", "--model", "~ group + age", "--columns", "region*",
                    "--contrast", "group[b]", "--permutations", str(SHUFFLES), "--seed", str(seed),
                    "--threads", "1", "--quiet", "--force", "--out", folder / "out"], check=True)
    with open(folder / "out/regions.tsv") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    return float(rows[0]["p"]), min(float(row["p_fwe"]) for row in rows)


def distance(p, steps=None):
    """Kolmogorov-Smirnov distance to the uniform distribution, of multiples of 1 / steps if they are."""
    p = numpy.sort(p)
    at = numpy.arange(1, steps + 1) / steps if steps else p
    above = numpy.abs(numpy.searchsorted(p, at + 1e-9) / p.size - at).max()
    below = 0 if steps else numpy.abs(numpy.arange(p.size) / p.size - at).max()
    return max(above, below)


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    root = pathlib.Path(__file__).resolve().parents[2]
    explica = sys.argv[2] if len(sys.argv) > 2 else root / "build/bin/explica"
    with tempfile.TemporaryDirectory() as folder:
        p = numpy.array([analyse(explica, pathlib.Path(folder), seed) for seed in range(count)])
    limit = 1.63 / count ** 0.5  # exceeded by one uniform sample in a hundred
    single, least = distance(p[:, 0]), distance(p[:, 1], SHUFFLES + 1)
    wrong = (p[:, 1] <= 0.05 + 1e-9).mean()
    error = 2.58 * (0.05 * 0.95 / count) ** 0.5  # of the share: one sample in a hundred is further off
    print(f"{count} data sets without effect: distance {single:.4f} (P of one region), {least:.4f} (family-wise); "
          f"at most {limit:.4f}")
    print(f"any family-wise P at or below 0.05: {wrong:.4f}, expected 0.05 +- {error:.4f}")
    return int(single > limit or least > limit or abs(wrong - 0.05) > error)


if __name__ == "__main__":
    sys.exit(main())
