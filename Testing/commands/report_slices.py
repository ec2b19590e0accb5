# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Scrolls, zooms and rates the slices of a report in headless Chromium; one fact a line, ends with 0 if each
does what it says.  Of a place told by the view in three dimensions, the slices go there."""
import functools
import sys

import browser
from browser import check, faults

driver = browser.start(1200, logging=True, drawing=True)
ask = functools.partial(browser.ask, driver)


def pictures():
    browser.drawn(driver)
    return ask("return [0, 1, 2].map((n) => byId('cut-' + n).toDataURL())")


def changed(what, script, expected):
    """Which of the axial, coronal and sagittal slices a deed changes."""
    before = pictures()
    ask(script)
    after = pictures()
    found = [a != b for a, b in zip(before, after)]
    check("%s changes %s" % (what, found), found == expected)


def press(key):
    return "byId('cut-0').dispatchEvent(new KeyboardEvent('keydown', {key: '%s'}))" % key


try:
    browser.wait_until_ready(driver, sys.argv[1], "cuts")
    colours = ask("""const c = byId('cut-0'), pen = c.getContext('2d');
        return new Set(new Uint32Array(pen.getImageData(0, 0, c.width, c.height).data.buffer)).size""")
    check("a slice has %d colours" % colours, colours > 5)
    at = ask("return byId('cut-at').textContent")
    changed("Page up", press("PageUp"), [True, True, True])
    check("the place is said: " + at, ask("return byId('cut-at').textContent") != at)
    changed("outlines off", press("o"), [True, True, True])
    changed("outlines on", press("o"), [True, True, True])
    changed("zoom", press("+"), [True, True, True])
    changed("brightness", "byId('cut-bright').value = 90; byId('cut-bright').dispatchEvent(new Event('input'))",
            [True, True, True])
    ask("document.dispatchEvent(new CustomEvent('place', {detail: {at: [3, 2, 1], from: 'surface'}}))")
    browser.drawn(driver)
    place = [float(word.split("=")[1].split()[0]) for word in ask("return byId('cut-at').textContent").split(",")]
    check("a place of the surface is gone to: %s" % place,
          all(abs(x - y) < 1.01 for x, y in zip(place, (3, 2, 1))))
    if ask("return byId('cut-places').options.length") > 0:
        ask(press("n"))
        ask(press("3"))
        check("a place is rated", "wrong" in ask("return byId('cut-places').selectedOptions[0].text"))
    saved = driver.execute_async_script("""const done = arguments[arguments.length - 1];
        const make = URL.createObjectURL;
        HTMLAnchorElement.prototype.click = () => {};
        URL.createObjectURL = (blob) => { blob.text().then((text) => done(JSON.parse(text))); return make(blob); };
        document.getElementById('cut-save').click();""")
    check("the rating is saved", saved["format"] == "explica-rating" and "ratings" in saved)
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": False})
    ask("byId('cut-places').add(new Option('a place of many words '.repeat(5)))")
    browser.drawn(driver)
    width = driver.execute_script("return document.documentElement.scrollWidth")
    check("a phone's width holds the page (%d pixels)" % width, width <= 390)
    driver.refresh()
    check("of a phone's figures the slices are open, the others folded", browser.eventually(
        lambda: ask("return [...document.querySelectorAll('figure > details[open]')]"
                    ".map((details) => details.querySelector('#cuts') !== null)") == [True]))
    for entry in driver.get_log("browser"):
        check("console: " + entry["message"][:200], entry["level"] != "SEVERE")
finally:
    driver.quit()
sys.exit(1 if faults else 0)
