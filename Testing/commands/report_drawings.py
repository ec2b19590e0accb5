# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Opens a heart's report in headless Chromium; one fact a line, ends with 0 if each of its three bull's-eyes is in sight
as a whole on a desk and on a phone, with words of 9 pixels or more, and the page is as wide as its window."""
import base64
import re
import sys

from browser import check, eventually, faults, start

MEASURE = """const eyes = [...document.querySelectorAll('.panels img')];
    return eyes.every((eye) => eye.complete) && [document.documentElement.scrollWidth, ...eyes.map((eye) => {
        const box = eye.getBoundingClientRect(); return [box.left, box.right, box.top, box.bottom, eye.naturalHeight]; })];"""
driver = start(1440)
try:
    for width in (1440, 390):
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600})
        driver.get("file://" + sys.argv[1])
        eventually(lambda: driver.execute_script(MEASURE))
        page, *eyes = driver.execute_script(MEASURE)
        check("at %d pixels: the page has %d" % (width, page), page <= width)
        check("three bull's-eyes", len(eyes) == 3)
        for left, right, top, bottom, drawn in eyes:
            check("one from %d to %d" % (left, right), 0 <= left < right <= width)
        source = driver.execute_script("return document.querySelector('.panels img').src")
        letters = min(map(float, re.findall(r'font-size="([\d.]+)"', base64.b64decode(source.split(",")[1]).decode())))
        check("words of %.1f pixels" % (letters * (bottom - top) / drawn), letters * (bottom - top) / drawn >= 9)
        check("two in a row" if width > 600 else "one below another",
              eyes[0][2] == eyes[1][2] if width > 600 else eyes[0][3] <= eyes[1][2])
finally:
    driver.quit()
sys.exit(1 if faults else 0)
