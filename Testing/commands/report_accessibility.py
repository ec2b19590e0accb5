# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Asks axe-core (npm install axe-core) about pages, in light and dark, on a desk, a tablet and a phone.

    report_accessibility.py node_modules/axe-core/axe.min.js PAGE.html...

One line a page, mode and width; ends with 1 if a serious or critical rule is broken anywhere, or if a
page is wider than its window."""
import pathlib
import sys
import time

from browser import start

WIDTHS = (1440, 820, 390)
ASK = """const done = arguments[arguments.length - 1];
axe.run(document, {resultTypes: ['violations']}).then((r) => done(r.violations));"""


def browser(dark):
    driver = start(WIDTHS[0], drawing=True)
    driver.set_script_timeout(240)
    if dark:
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                               {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
    return driver


def findings(driver, page, width, axe):
    """Broken rules of a page with everything on it unfolded, and how wide it is."""
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False})
    driver.get(page.resolve().as_uri())
    end = time.time() + 60
    while time.time() < end and not driver.execute_script(
            "const c = document.getElementById('canvas'); return !c || c.dataset.ready === 'true'"):
        time.sleep(0.2)
    driver.execute_script("for (const d of document.querySelectorAll('details')) d.open = true;")
    driver.execute_script(axe)
    wide = driver.execute_script("return document.documentElement.scrollWidth")
    return driver.execute_async_script(ASK), wide


def main():
    axe, pages = pathlib.Path(sys.argv[1]).read_text(), [pathlib.Path(p) for p in sys.argv[2:]]
    sound = True
    for dark in (False, True):
        driver = browser(dark)
        try:
            for page in pages:
                for width in WIDTHS:
                    broken, wide = findings(driver, page, width, axe)
                    words = [f"{rule['id']} ({rule['impact']}, {len(rule['nodes'])} places: "
                             f"{rule['nodes'][0]['html'][:80]})" for rule in broken]
                    if wide > width:
                        words.append(f"{wide} pixels wide")
                    sound &= wide <= width
                    sound &= not any(rule["impact"] in ("serious", "critical") for rule in broken)
                    print(page, "dark" if dark else "light", width, "; ".join(words) or "nothing found")
        finally:
            driver.quit()
    sys.exit(0 if sound else 1)


main()
