#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Are the packages of ExampleData/packages.txt enough to build the program?  Copies what those packages, what they
depend on and Debian's essential ones have installed here into a folder, configures the program there (as
Testing/setup.sh --program does), and asks ninja for every file that the build starts from.  Of the build that is
there, every header that the program's sources read and every library that it loads must be of those packages.

    Testing/check-lean.py BUILD_DIR    as root; ends with 77 where it cannot change the root folder
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
OPTIONS = ["-DEXPLICA_BUILD_TESTS=OFF", "-DEXPLICA_BUILD_PYTHON=OFF", "-DEXPLICA_WITH_WINDOW=OFF"]


def output(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def listed():
    lines = (ROOT / "ExampleData/packages.txt").read_text().splitlines()
    return [word for word in (line.split("#")[0].strip() for line in lines) if word]


def closure(names):
    """Those packages, the essential ones, and all that they depend on, as far as installed."""
    depends, provided, todo = {}, {}, list(names)
    form = "${Package}\t${Essential}\t${Depends}, ${Pre-Depends}\t${Provides}\n"
    for line in output("dpkg-query", "-W", "-f", form).splitlines():
        name, essential, needs, gives = line.split("\t")
        depends[name] = needs
        for other in re.findall(r"[^\s,()=]+", gives):
            provided.setdefault(other, name)
        if essential == "yes":
            todo.append(name)
    found = set()
    while todo:
        name = todo.pop()
        name = name if name in depends else provided.get(name)
        if name is None or name in found:
            continue
        found.add(name)
        for group in depends[name].split(","):
            choices = [re.split(r"[ :(]", choice.strip())[0] for choice in group.split("|")]
            todo += [c for c in choices if c in depends or c in provided][:1]
    return found


def files_of(packages):
    lines = output("dpkg", "-L", *sorted(packages)).splitlines()
    return [line for line in lines if line.startswith("/") and line != "/."]


def place(file, root):
    """The file in the other root, under its name there: a link where that goes, else a copy."""
    if file.startswith(("/usr/share/doc/", "/usr/share/man/", "/usr/share/locale/")) or not os.path.lexists(file):
        return
    real = os.path.join(os.path.realpath(os.path.dirname(file)), os.path.basename(file))  # of a merged /usr
    to = root / real[1:]
    if os.path.isdir(real) and not os.path.islink(real):
        to.mkdir(parents=True, exist_ok=True)
    elif not os.path.lexists(to):
        to.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(real, to, follow_symlinks=False)
        except OSError:
            shutil.copy2(real, to, follow_symlinks=False)


def configure(files, target):
    """The program's build, configured in a root that has those files alone."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name in ("bin", "lib", "lib64", "sbin"):
            (root / "usr" / name).mkdir(parents=True, exist_ok=True)
            (root / name).symlink_to("usr/" + name)
        (root / "tmp").mkdir()
        (root / "dev").mkdir()
        os.mknod(root / "dev/null", 0o020666, os.makedev(1, 3))
        alternatives = [str(p) for p in pathlib.Path("/etc/alternatives").iterdir()]
        for file in [*files, *alternatives, "/etc/ld.so.conf", *map(str, pathlib.Path("/etc/ld.so.conf.d").iterdir())]:
            place(file, root)
        (root / "src").mkdir()
        sources = subprocess.Popen(["tar", "-C", ROOT, "--exclude=./build*", "--exclude=./.git", "-cf", "-", "."],
                                   stdout=subprocess.PIPE)
        subprocess.run(["tar", "-C", root / "src", "-xf", "-"], stdin=sources.stdout, check=True)
        subprocess.run(["ldconfig", "-r", folder], check=True)
        clean = {"PATH": "/usr/bin:/bin", "HOME": "/tmp"}
        for words in (["cmake", "--preset", "ci", *OPTIONS], ["ninja", "-C", "build", "-n", target]):
            done = subprocess.run(["/usr/sbin/chroot", folder, "sh", "-c", 'cd /src && "$@"', "sh", *words], env=clean,
                                  capture_output=True, text=True)
            if done.returncode != 0:
                print(done.stdout[-3000:] + done.stderr[-3000:])
                return False
    return True


def used(build, target):
    """Headers outside of this folder that the target's objects read (the window's apart), and libraries that it loads."""
    objects = {line for line in output("ninja", "-C", build, "-t", "inputs", target).splitlines()
               if line.endswith(".o") and "Window" not in line}
    paths, inside = set(), False
    for line in output("ninja", "-C", build, "-t", "deps").splitlines():
        if line and not line.startswith(" "):
            inside = line.split(":")[0] in objects
        elif inside and line.strip().startswith("/usr/"):
            paths.add(os.path.realpath(line.strip()))
    for line in output("ldd", build / "bin" / target).splitlines():
        match = re.search(r"=> (/\S+)", line)
        if match:
            paths.add(os.path.realpath(match[1]))
    return paths


def main():
    if os.geteuid() != 0:
        print("skipped: only root may change the root folder")
        return 77
    packages = closure(listed())
    files = files_of(packages)
    known = {os.path.realpath(f) for f in files}
    foreign = sorted(used(pathlib.Path(sys.argv[1]), "explica") - known)
    for path in foreign[:20]:
        print(f"{path}: the program needs it, and no package of ExampleData/packages.txt has it")
    print(f"{len(packages)} packages")
    return 0 if configure(files, "explica") and not foreign else 1


if __name__ == "__main__":
    sys.exit(main())
