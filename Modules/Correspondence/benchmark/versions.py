#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Processor time of one command by several versions of the program, in turns.

    versions.py [--repeats 5] PROGRAM... -- thickness LABELS --inner 1 --tissue 2

Prints for each program the least user, system and wall time of its runs, and which of the volumes
that it writes differ in a byte from the first program's.
"""
import argparse
import hashlib
import pathlib
import resource
import subprocess
import sys
import tempfile
import time


def run(program, words):
    """User, system and wall time, s, and a digest of each volume."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        subprocess.run([program, *words, "--out", out], check=True, capture_output=True)
        wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        digests = {path.name: hashlib.sha256(path.read_bytes()).hexdigest()
                   for path in out.glob("*.nii.gz")}
    return (after.ru_utime - before.ru_utime, after.ru_stime - before.ru_stime, wall), digests


def main():
    split = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("programs", nargs="+")
    given, words = parser.parse_args(sys.argv[1:split]), sys.argv[split + 1:]
    best, digests = {}, {}
    for _ in range(given.repeats):
        for program in given.programs:
            times, digests[program] = run(program, words)
            best[program] = tuple(map(min, times, best.get(program, times)))
    first = digests[given.programs[0]]
    for program in given.programs:
        other = sorted(name for name, digest in digests[program].items()
                       if first.get(name) != digest)
        user, system, wall = best[program]
        print(f"{program}: user {user:.2f} s, system {system:.2f} s, wall {wall:.2f} s; "
              f"other bytes: {', '.join(other) or 'none'}")


if __name__ == "__main__":
    main()
