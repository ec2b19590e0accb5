# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Opens a report in headless Chromium; prints what a reader would notice, one fact a line, and ends with 0
if the page is sound: no console message of level error, no request but the page itself, a canvas that is not
of one colour, and a slider and a map choice that change the picture."""
import json
import sys

from browser import check, drawn, eventually, faults, is_ready, start, wait_until_ready

driver = start(1000, logging=True, drawing=True)


def picture():
    drawn(driver)
    return driver.execute_script("return document.getElementById('canvas').toDataURL()")


try:
    wait_until_ready(driver, sys.argv[1], "canvas")
    first = picture()
    colours = driver.execute_script("""
        const from = document.getElementById('canvas'), to = document.createElement('canvas');
        to.width = from.width; to.height = from.height;
        const pen = to.getContext('2d'); pen.drawImage(from, 0, 0);
        return new Set(new Uint32Array(pen.getImageData(0, 0, to.width, to.height).data.buffer)).size;""")
    check("canvas shows %d colours" % colours, colours > 20)
    driver.execute_script("const s = document.getElementById('frame'); s.value = s.max;"
                          "s.dispatchEvent(new Event('input'));")
    last = picture()
    check("slider changes the picture", last != first)
    driver.execute_script("document.getElementById('before-after').click()")
    check("before/after goes back", picture() == first)
    driver.execute_script("const m = document.getElementById('map'); m.value = 'facing';"
                          "m.dispatchEvent(new Event('change'));")
    facing = picture()
    check("map choice changes the picture", facing != first)
    driver.execute_script("const c = document.getElementById('canvas');"
                          "c.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}));")
    check("arrow key turns the surface", picture() != facing)
    driver.execute_script("""const m = document.getElementById('map'); m.value = '0';
        m.dispatchEvent(new Event('change'));
        const c = document.getElementById('canvas'), box = c.getBoundingClientRect();
        document.getElementById('reset').click();
        c.dispatchEvent(new PointerEvent('pointermove',
            {clientX: box.left + box.width / 2, clientY: box.top + box.height / 2}));""")
    drawn(driver)
    reading = driver.execute_script("return document.getElementById('under-pointer').textContent")
    check("value under the pointer: " + reading, "vertex" in reading and ":" in reading)
    if driver.execute_script("return document.getElementById('which').options.length") > 1:
        one = picture()
        driver.execute_script("const w = document.getElementById('which'); w.value = '1';"
                              "w.dispatchEvent(new Event('change'));")
        eventually(lambda: is_ready(driver, "canvas"))
        check("another patch is another picture", eventually(lambda: picture() != one))
        check("and is still chosen", driver.execute_script("return document.getElementById('which').value") == "1")
    driver.execute_script("""const m = document.getElementById('map'); m.value = 'none';
        m.dispatchEvent(new Event('change')); document.getElementById('reset').click();""")
    drawn(driver)
    cut = driver.execute_script("""
        const from = document.getElementById('canvas'), to = document.createElement('canvas');
        const width = to.width = from.width, height = to.height = from.height, pen = to.getContext('2d');
        pen.drawImage(from, 0, 0);
        const at = pen.getImageData(0, 0, width, height).data;
        let patch = 0, rim = 0;
        for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) {
            const i = 4 * (y * width + x);
            if (at[i] < at[i + 2] + 40) continue;  // not the patch's orange
            ++patch;
            if (x < 2 || y < 2 || x >= width - 2 || y >= height - 2) ++rim;
        }
        return [patch, rim];""")
    check("the patch is in sight from end to end %s" % cut, cut[0] > 100 and cut[1] == 0)
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": True})
    drawn(driver)
    width = driver.execute_script("return document.documentElement.scrollWidth")
    check("a phone's width holds the page (%d pixels)" % width, width <= 390)
    for entry in driver.get_log("browser"):
        check("console: " + entry["message"][:200], entry["level"] != "SEVERE")
    for entry in driver.get_log("performance"):
        event = json.loads(entry["message"])["message"]
        if event["method"] == "Network.requestWillBeSent":
            url = event["params"]["request"]["url"]
            check("request: " + url[:80], url.startswith(("data:", "blob:", "file://" + sys.argv[1])))
finally:
    driver.quit()
sys.exit(1 if faults else 0)
