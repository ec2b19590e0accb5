# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Opens the page of a study in headless Chromium; prints what a reader would notice, one fact a line, and ends
with 0 if the page is sound.

    study_page.py PAGE.html [SECONDS [PICTURE.png]]

The page was made of at least 1,000 rows: it is below 20 MB, its first paint is counted by the browser (by
default not judged, since tests hang on no clock), it asks for nothing but thumbnails, the console is empty,
filter and sort do what they say, by mouse and by keyboard, and what failed can be read with its remedy."""
import json
import pathlib
import sys

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import check, faults, start


def wait(driver):
    driver.set_script_timeout(120)
    driver.execute_async_script("""const done = arguments[0];
        (function look() { document.body.dataset.ready ? done() : setTimeout(look, 50); })();""")


def column(driver, index):
    return driver.execute_script("""return [...document.querySelectorAll('tbody')[0].rows].map(
        (row) => row.cells[arguments[0]].textContent)""", index)


def timing(driver, page, limit):
    size = page.stat().st_size
    check("%.1f MB" % (size / 1e6), size < 20e6)
    rows = driver.execute_script("return JSON.parse(document.getElementById('data').textContent).rows.length")
    check("%d rows" % rows, rows >= 1000)
    paint = driver.execute_script("return performance.getEntriesByName('first-contentful-paint')[0].startTime")
    check("first paint after %.2f s" % (paint / 1e3), limit is None or paint < 1e3 * limit)


def filter_and_sort(driver):
    all_rows = int(driver.find_element(By.ID, "shown").text.split()[0])
    search = driver.find_element(By.ID, "search")
    search.send_keys("sub-7 ")
    names = column(driver, 0)
    check("the filter leaves %d of %d rows" % (len(names), all_rows), 0 < len(names) < all_rows)
    check("and only what was asked for", all("sub-7" in name for name in names))
    search.send_keys(Keys.BACKSPACE * 6)
    driver.execute_script("arguments[0].dispatchEvent(new Event('input'))", search)
    headings = driver.find_elements(By.CSS_SELECTOR, "thead th button")
    number = next(n for n, b in enumerate(headings) if "thickness" in b.text.lower())
    headings[number].click()
    values = [float(v) for v in column(driver, number) if v != "n/a"]
    least = values[0]
    check("a click sorts upwards", values == sorted(values))
    button = driver.find_elements(By.CSS_SELECTOR, "thead th button")[number]
    driver.execute_script("arguments[0].focus()", button)
    button.send_keys(Keys.ENTER)
    values = [float(v) for v in column(driver, number) if v != "n/a"]
    check("Enter on the heading sorts downwards", values == sorted(values, reverse=True) and values[0] > least)
    heading = driver.find_elements(By.CSS_SELECTOR, "thead th")[number]
    check("a screen reader is told so", heading.get_attribute("aria-sort") == "descending")
    driver.find_element(By.ID, "flagged").click()
    marked = driver.execute_script("""return [...document.querySelectorAll('tbody')[0].rows].every(
        (row) => row.querySelector('.odd, .bad'))""")
    check("only those that need a look can be shown", marked)
    driver.find_element(By.ID, "flagged").click()


def words(driver):
    check("every input and button has a name", driver.execute_script("""
        return [...document.querySelectorAll('button, input, select')].every((e) =>
            e.textContent.trim() || e.getAttribute('aria-label') || e.closest('label'))"""))
    check("every strip says what it shows", driver.execute_script("""
        const strips = [...document.querySelectorAll('.strip svg')];
        return strips.length > 2 && strips.every((s) => s.getAttribute('aria-label').includes('median'))"""))
    failure = driver.execute_script("""const box = document.querySelector('.failure');
        return box ? [box.textContent, box.clientWidth] : null""")
    if failure:
        check("a failure is read in %d pixels: %s" % (failure[1], failure[0][:90]), failure[1] > 900)
    stated = driver.execute_script("return document.body.textContent.includes('robust z above 3.5')")
    check("the rule for outliers is stated", stated)
    odd = driver.execute_script("return document.querySelectorAll('.strip circle.odd, .strip .beyond.odd').length")
    check("%d outliers are marked" % odd, odd > 0)


def groups(driver):
    offered = driver.execute_script("return [...document.getElementById('by').options].map((o) => o.text)")
    check("colours by %s, not by what has many values" % offered, offered == ["nothing", "sex"])
    shown = driver.execute_script("""const by = document.getElementById('by'), strips = document.getElementById('strips');
        by.value = by.options[1].value;
        by.dispatchEvent(new Event('change'));
        const result = [strips.querySelectorAll('.strip:first-child .group').length, document.getElementById('groups').textContent,
                        new Set([...strips.querySelectorAll('circle, .beyond')].map((dot) => dot.style.fill)).size];
        by.value = '';
        by.dispatchEvent(new Event('change'));
        return result;""")
    check("two groups have outlines, names and dots of two colours %s" % shown, shown == [2, "FM", 2])


def far_off(driver):
    """A row at a thousand times the others' value must leave them their axis."""
    ends, inside, words = driver.execute_script("""const strip = document.querySelector('.strip svg');
        const shape = strip.querySelector('.spread').getBBox();
        const ends = [...strip.querySelectorAll('.beyond')].map((e) => e.querySelector('title').textContent);
        return [ends, shape.width / 284, strip.textContent]""")
    full = driver.execute_script("""const steps = document.querySelector('.strip .spread').getAttribute('d')
        .match(/V[0-9.]+h/g).map((s) => parseFloat(s.slice(1)));
        return steps.filter((y) => y < 45.95).length / steps.length""")
    check("%d rows stand beyond an axis, with their names" % len(ends), len(ends) > 0 and all("sub-" in e for e in ends))
    check("the others keep %.0f %% of it" % (100 * full), inside > 0.99 and full > 0.9)
    check("their number is written", "%d beyond, to" % len(ends) in words)


def logs(driver):
    messages = [entry["message"][:200] for entry in driver.get_log("browser")]
    check("the console is empty %s" % (messages[:3] or ""), not messages)
    foreign = set()
    for entry in driver.get_log("performance"):
        event = json.loads(entry["message"])["message"]
        if event["method"] == "Network.requestWillBeSent":
            url = event["params"]["request"]["url"]
            if not url.startswith(("data:", "file://")):
                foreign.add(url)
    check("no request elsewhere %s" % (sorted(foreign) or ""), not foreign)


def main():
    page = pathlib.Path(sys.argv[1]).resolve()
    limit = float(sys.argv[2]) if len(sys.argv) > 2 else None
    driver = start(1440, logging=True)
    try:
        driver.get(page.as_uri())
        wait(driver)
        timing(driver, page, limit)
        filter_and_sort(driver)
        words(driver)
        groups(driver)
        far_off(driver)
        for width in (820, 390):
            driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                   {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": True})
            wide = driver.execute_script("return document.documentElement.scrollWidth")
            check("%d pixels hold the page (%d)" % (width, wide), wide <= width)
        logs(driver)
        if len(sys.argv) > 3:
            driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
            driver.save_screenshot(sys.argv[3])
    finally:
        driver.quit()
    sys.exit(1 if faults else 0)


main()
