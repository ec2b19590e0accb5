# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Compares the two states of a report's slices in headless Chromium, such as before and after a correction.

    report_flicker.py PAGE.html [BEFORE.png AFTER.png]

One fact a line; ends with 0 if each switch shows another picture and goes back to the same, by mouse and by
keyboard, and if the button flickers between these two pictures until it is pressed again."""
import sys
import time

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from browser import check, faults, start


def main():
    driver = start(1200)
    try:
        driver.get("file://" + sys.argv[1])
        driver.execute_script("for (const d of document.querySelectorAll('details')) d.open = true;")
        boxes = driver.find_elements(By.CSS_SELECTOR, "input.to-other")
        check("%d pictures have two states" % len(boxes), len(boxes) > 0)
        for n, box in enumerate(boxes):
            figure = box.find_element(By.XPATH, "./ancestor::figure")
            tiles = figure.find_elements(By.CSS_SELECTOR, ".tiles")[1]
            name = figure.find_element(By.TAG_NAME, "b").text
            driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", figure)
            before = tiles.screenshot_as_png
            driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", box)
            box.click()
            after = tiles.screenshot_as_png
            check(name + " the other state is another picture", after != before)
            box.send_keys(Keys.SPACE)
            check(name + " the space bar goes back", tiles.screenshot_as_png == before)
            button = figure.find_element(By.CSS_SELECTOR, "button.flicker")
            button.send_keys(Keys.ENTER)
            check(name + " the button is pressed", button.get_attribute("aria-pressed") == "true")
            states = set()
            for _ in range(40):
                states.add(driver.execute_script("return arguments[0].checked", box))
                time.sleep(0.1)
            check(name + " both states come in turn", states == {True, False})
            button.click()
            check(name + " the button is released", button.get_attribute("aria-pressed") == "false")
            if n == 0 and len(sys.argv) > 3:
                for path, picture in zip(sys.argv[2:], (before, after)):
                    with open(path, "wb") as file:
                        file.write(picture)
    finally:
        driver.quit()
    sys.exit(1 if faults else 0)


main()
