#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What a study of many subjects costs beside the work itself.

    Modules/Study/benchmark/many_subjects.py build/bin/explica [SUBJECTS] [--without-jobs]

One small subject is run in earnest; its account is copied to all others (both hemispheres), as if each
had been run.  --without-jobs leaves out the step that takes longest.  Do not rebuild meanwhile: another version
of the program has other keys.  Prints processor seconds (of the command and all it starts) and wall seconds of each step,
sizes, and how the page behaves in Chromium.
"""

import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]


def measure(what, words, **more):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.monotonic()
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **more)
    wall = time.monotonic() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"| {what} | {cpu:.1f} | {wall:.1f} |" + ("" if done.returncode == 0 else f" exit {done.returncode}"))
    if done.returncode not in (0, 3):
        sys.exit(done.stdout[-3000:])
    return done.stdout


def make_study(folder, labels):
    study = folder / "study.yaml"
    study.write_text(
        "name: Many subjects\ninput: phantom/labels.nii.gz\n"
        "parameters:\n  surface: {faces: 3000}\n  unfold: {direction: [0, 0, 1], radius: 8, max-iterations: 2}\n"
        "subjects:\n" + "".join(f'  "{label}": {{parameters: {{thickness.lambda: 0.{label}}}}}\n' for label in labels)
    )
    return study


def copy_accounts(out, made, labels):
    """Of one run, what the table reads, to every subject's runs."""
    names = [p.relative_to(made) for p in made.glob("**/summary.json")] + [pathlib.Path("run.json")]
    for label in labels:
        for hemisphere in ("L", "R"):
            run = out / "runs" / f"sub-{label}_hemi-{hemisphere}"
            if run == made:
                continue
            for name in names:
                (run / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(made / name, run / name)
            (run / "report.html").touch()


def stand_in(folder, executable):
    """An explica whose participant level only says that all is settled."""
    program = folder / "explica"
    program.write_text(
        f'#!/bin/sh\nif [ "$2" != participant ]; then exec {executable} "$@"; fi\n'
        'mkdir -p "$4/state"\nexec touch "$4/state/sub-$6-$(sed -n "s/^$6\t//p" "$4/../keys")".json\n'
    )
    program.chmod(0o755)
    return program


def look_at(page, picture):
    try:
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
        from selenium.webdriver.common.by import By
    except ImportError:
        return print("Chromium: python3-selenium is not installed")
    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1400,900"):
        options.add_argument(word)
    driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    try:
        begin = time.monotonic()
        driver.get(page.as_uri())
        loaded = time.monotonic() - begin
        rows = driver.execute_script("return document.querySelectorAll('tbody tr').length")
        buttons = driver.find_elements(By.CSS_SELECTOR, "th button")
        sorted_in = driver.execute_script(
            "const b=arguments[0],t=performance.now();b.click();document.body.offsetHeight;"
            "return performance.now()-t", buttons[min(8, len(buttons) - 1)]) / 1000
        driver.save_screenshot(str(picture))
        print(f"| page in Chromium: {rows} rows shown | | {loaded:.1f} |\n| one sort by a click | | {sorted_in:.2f} |")
    finally:
        driver.quit()


def main():
    executable = pathlib.Path(sys.argv[1]).resolve()
    words = [word for word in sys.argv[2:] if word != "--without-jobs"]
    count = int(words[0]) if words else 2000
    with tempfile.TemporaryDirectory(prefix="explica-many-") as name:
        folder = pathlib.Path(name)
        subprocess.run([executable, "phantom", "cortex", "--size", "40", "--depth", "0.1", "--waves", "3",
                        "--quiet", "--out", folder / "phantom"], check=True)
        labels = [f"{i:05d}" for i in range(1, count + 1)]
        study, out = make_study(folder, labels), folder / "results"
        print(f"{count} subjects, both hemispheres\n\n| | processor s | wall s |\n|---|---|---|")
        measure("study check", [executable, "study", "check", study])
        keys = measure("study list --keys (hashes every input)", [executable, "study", "list", study, "--keys"])
        (folder / "keys").write_text(keys)
        measure("one subject in earnest (40 x 40 x 40 voxels)",
                [executable, "study", "participant", study, out, "--participant-label", labels[0], "--quiet"])
        copy_accounts(out, out / "runs" / f"sub-{labels[0]}_hemi-L", labels)
        shutil.rmtree(out / "state")
        program = stand_in(folder, executable)
        snakemake = ["/usr/bin/snakemake", "-s", ROOT / "Wrapping/Snakemake/Snakefile", "--cores", "2", "--quiet",
                     "--config", f"study={study}", f"out={out}", f"explica={program}", "threads=1"]
        environment = dict(os.environ, HOME=name)
        measure("snakemake, dry run, nothing done", [*snakemake[:3], "--dry-run", *snakemake[3:]], cwd=folder, env=environment)
        if "--without-jobs" in sys.argv:
            (out / "state").mkdir()
            for line in keys.splitlines():
                (out / "state" / ("sub-" + line.replace("\t", "-") + ".json")).touch()
            measure("snakemake, every subject settled, and the table", snakemake, cwd=folder, env=environment)
        else:
            measure("snakemake, every subject a job that does nothing, and the table", snakemake, cwd=folder,
                    env=environment)
        measure("snakemake, everything settled", snakemake, cwd=folder, env=environment)
        measure("study list --todo", [executable, "study", "list", study, out, "--todo"])
        measure("study group", [executable, "study", "group", study, out])
        page = out / "index.html"
        look_at(page, pathlib.Path(tempfile.gettempdir()) / "explica-many-subjects.png")
        print(f"\nstudy.tsv {(out / 'study.tsv').stat().st_size / 1e6:.1f} MB, index.html {page.stat().st_size / 1e6:.1f} MB")
        states = json.loads((out / "summary.json").read_text())
        print({key: value for key, value in states.items() if key.startswith(("rows", "runs_"))})


if __name__ == "__main__":
    main()
