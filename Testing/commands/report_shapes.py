# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Morphs the surfaces of a run's report in headless Chromium; one fact a line, ends with 0 if the slider shows each
shape by its name, the patch opens on the shape of which it is, and the pointer names what it is on."""
import functools
import sys

import browser
from browser import check, faults

driver = browser.start(1200, logging=True, drawing=True)
ask = functools.partial(browser.ask, driver)


def picture():
    browser.drawn(driver)
    return ask("return byId('canvas').toDataURL()")


def change(control, value, event):
    ask("byId('%s').value = '%s'; byId('%s').dispatchEvent(new Event('%s'))" % (control, value, control, event))
    return picture()


try:
    browser.wait_until_ready(driver, sys.argv[1], "canvas")
    shown, names = [], []
    for n in range(1 + int(ask("return byId('shape').max"))):
        shown.append(change("shape", n, "input"))
        names.append(ask("return byId('shape-title').textContent"))
    check("shapes: " + ", ".join(names), names == ["white", "middle", "pial", "inflated", "sphere", "flat"])
    check("each is another picture", len(set(shown)) == len(shown))
    change("shape", 3.5, "input")
    between = ask("return byId('shape-title').textContent")
    check("between two shapes: " + between, between == "inflated to sphere")
    opened = change("frame", ask("return byId('frame').max"), "input")
    check("the patch opens on the middle surface", ask("return byId('shape-title').textContent") == "middle")
    check("which changes it", opened != shown[1])
    check("and a shape closes it", change("shape", 1, "input") == shown[1] and ask("return byId('frame').value") == "0")
    bar = ask("return byId('bar-title').textContent")
    check("a map has a bar with its unit: " + bar, "[mm]" in bar)
    ask("""const c = byId('canvas'), box = c.getBoundingClientRect();
        c.dispatchEvent(new PointerEvent('pointermove',
            {clientX: box.left + box.width / 2, clientY: box.top + box.height / 2}))""")
    browser.drawn(driver)
    reading = ask("return byId('under-pointer').textContent")
    check("under the pointer: " + reading, "vertex" in reading and "thickness" in reading)
    slices = ask("return byId('cut-1').toDataURL()")
    ask("byId('canvas').dispatchEvent(new MouseEvent('click'))")
    check("a click moves the slices",
          browser.eventually(lambda: ask("return byId('cut-1').toDataURL()") != slices))
    ask("const real = window.requestAnimationFrame; "
        "window.requestAnimationFrame = (work) => real((time) => work(10 * time));")  # as if pictures took long
    width = ask("return byId('canvas').width")
    for _ in range(6):
        ask("byId('canvas').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}))")
        browser.drawn(driver)
    less = ask("return [Number(byId('canvas').dataset.less), byId('canvas').width]")
    check("a view that moves slowly has fewer faces and pixels: %s" % less, less[0] > 0 and less[1] < width)
    check("and all of them where it stands", browser.eventually(
        lambda: ask("return [byId('canvas').dataset.less, byId('canvas').width]") == ["", width]))
    for entry in driver.get_log("browser"):
        check("console: " + entry["message"][:200], entry["level"] != "SEVERE")
finally:
    driver.quit()
sys.exit(1 if faults else 0)
