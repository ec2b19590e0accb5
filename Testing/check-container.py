#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Carries out the run stage of the Containerfile where there is no container engine: its RUN and
COPY lines in a clean Debian made by debootstrap, then its ENTRYPOINT on a phantom.

    sudo Testing/check-container.py BUILD_DIR WORK_DIR

BUILD_DIR is a finished build; WORK_DIR is made, must not exist, and stays (delete it by hand).
Nothing is mounted into the new system, so that deleting it is safe.
"""

import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[1]


def last_stage(containerfile):
    """Instructions after the last FROM, continuation lines joined."""
    text = containerfile.read_text(encoding="utf-8").replace("\\\n", " ")
    stage = []
    for line in text.splitlines():
        words = line.strip()
        if not words or words.startswith("#"):
            continue
        instruction, _, rest = words.partition(" ")
        if instruction == "FROM":
            stage = []
        stage.append((instruction, rest.strip()))
    return stage


def run(words, **options):
    print("+", " ".join(map(str, words)), flush=True)
    return subprocess.run([str(word) for word in words], check=True, **options)


def copy(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target, dirs_exist_ok=True)
    else:
        shutil.copy2(source, target)


def main():
    build, work = map(pathlib.Path, sys.argv[1:3])
    work.mkdir(parents=True)
    tree, system = work / "tree", work / "system"
    run(["cmake", "--install", build, "--strip", "--prefix", tree / "opt/explica"],
        stdout=subprocess.DEVNULL)
    stage = last_stage(SOURCE / "Wrapping/Container/Containerfile")
    run(["debootstrap", "--variant=minbase", "bookworm", system, "http://deb.debian.org/debian"],
        stdout=subprocess.DEVNULL)

    environment = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"}
    for name in ("http_proxy", "https_proxy"):  # of this machine, as an engine passes them on
        if name in os.environ:
            environment[name] = os.environ[name]
    directory, entry = "/", []
    for instruction, rest in stage:
        if instruction == "RUN":
            run(["chroot", system, "/bin/sh", "-c", rest], env=environment,
                stdout=subprocess.DEVNULL)
        elif instruction == "COPY":
            words = shlex.split(rest)
            base = tree if words[0].startswith("--from=") else SOURCE
            source, target = words[-2:]
            copy(base / source.lstrip("/"), system / target.lstrip("/"))
        elif instruction == "ENV":
            name, _, value = rest.partition("=")
            environment[name] = value
        elif instruction == "WORKDIR":
            directory = rest
            (system / rest.lstrip("/")).mkdir(parents=True, exist_ok=True)
        elif instruction == "ENTRYPOINT":
            entry = json.loads(rest)
        elif instruction != "FROM":
            sys.exit(f"check.py does not know {instruction}")

    def explica(*words):
        script = f"cd {directory} && exec " + shlex.join([*entry, *words])
        return run(["chroot", system, "/bin/sh", "-c", script], env=environment)

    explica("--version")
    explica("phantom", "shell", "--size", "40", "--quiet", "--out", "shell")
    explica("thickness", "shell/labels.nii.gz", "--inner", "1", "--tissue", "2", "--quiet",
            "--out", "thickness")
    explica("phantom", "cortex", "--size", "40", "--quiet", "--out", "cortex")
    explica("run", "cortex/labels.nii.gz", "--surface.faces", "3000", "--unfold.radius", "9",
            "--quiet", "--out", "run")
    explica("verify", "run/surface", "--deep")
    data = system / directory.lstrip("/")
    summary = json.loads((data / "thickness/summary.json").read_text(encoding="utf-8"))
    print("thickness of the shell:", summary["thickness_mean"], "mm")
    # The same program outside gives the same bytes.
    outside = work / "outside"
    program = tree / "opt/explica/bin/explica"
    run([program, "thickness", data / "shell/labels.nii.gz", "--inner", "1", "--tissue", "2",
         "--quiet", "--out", outside])
    same = (outside / "thickness.nii.gz").read_bytes() == (
        data / "thickness/thickness.nii.gz").read_bytes()
    print("thickness.nii.gz inside and outside:", "the same bytes" if same else "DIFFERENT")
    size = subprocess.run(["du", "-sm", system], check=True, capture_output=True, text=True)
    print("size of the run stage:", size.stdout.split()[0], "MB")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
