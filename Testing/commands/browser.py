# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Debian's Chromium without a window, and what was found not to hold in it."""
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

faults = []


def check(fact, holds):
    print(("ok    " if holds else "FAULT ") + fact)
    if not holds:
        faults.append(fact)


def start(width, logging=False, drawing=False):
    """A driver of a page `width` pixels wide; `logging` keeps console and requests, `drawing` is for pages
    with a canvas in three dimensions (by the processor)."""
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    graphics = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                "--ignore-gpu-blocklist") if drawing else ("--disable-gpu",)
    for flag in ("--headless=new", "--no-sandbox", *graphics, "--window-size=%d,900" % width):
        options.add_argument(flag)
    if logging:
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def ask(driver, script):
    """What a script says that may call byId()."""
    return driver.execute_script("const byId = (id) => document.getElementById(id); " + script)


def eventually(condition):
    """Whether a condition holds within a minute, however slow the machine is."""
    end = time.time() + 60
    while not condition():
        if time.time() > end:
            return False
        time.sleep(0.05)
    return True


def wait_until_ready(driver, page, canvas):
    """Opens a page and waits until it has drawn a canvas."""
    driver.get("file://" + page)
    eventually(lambda: is_ready(driver, canvas))


def is_ready(driver, canvas):
    return ask(driver, "return byId('%s').dataset.ready" % canvas) == "true"


def drawn(driver):
    """Waits until what was asked for is drawn: pages draw in the next frame."""
    driver.execute_async_script("const done = arguments[arguments.length - 1];"
                                "requestAnimationFrame(() => requestAnimationFrame(() => done()));")
