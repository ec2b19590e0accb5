# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Opens a heart's report in headless Chromium; one fact a line, ends with 0 if three bull's-eyes in a row take the
whole width beside the verdict, can be moved sideways on a phone, and the page stays as wide as its window."""
import sys

from browser import check, eventually, faults, start

MEASURE = """const box = document.querySelector('.drawn.broad');
    return box && [box.clientWidth, box.parentElement.clientWidth, box.querySelector('img').clientWidth,
                   document.documentElement.scrollWidth];"""
driver = start(1440)
try:
    for width in (1440, 390):
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600})
        driver.get("file://" + sys.argv[1])
        eventually(lambda: driver.execute_script(MEASURE))
        box, head, image, page = driver.execute_script(MEASURE)
        check("at %d pixels the bull's-eyes have %d of %d" % (width, box, head), box == head)
        check("and are drawn on %d" % image, image >= 840)
        check("the page holds them (%d)" % page, page <= width)
finally:
    driver.quit()
sys.exit(1 if faults else 0)
