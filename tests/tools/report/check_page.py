#!/usr/bin/python3
"""Opens a report in a headless Chromium and tries its 3-D view with a mouse; exits with an error where a claim fails.

usage: check_page.py loads PAGE...   no complaint of a script, no request but for the page itself, nothing wider than a phone
       check_page.py view PAGE       draws, turns, zooms, comes back, plays; frames, switches and opacity change what is seen
       check_page.py event PAGE      a row of the events shows its frame, the event marked at its place
       check_page.py pictures PAGE FOLDER   pictures of the page for a person to look at
"""
import pathlib
import sys
import tempfile

import matplotlib.image
import numpy as np

from browser import Browser

STAGE = "#viewer .stage"
VIEW = {"at": pathlib.Path(tempfile.mkdtemp(prefix="page-")), "number": 0}


def claim(holds, text):
    if not holds:
        sys.exit(f"check_page: {text}")


def seen(browser, selector=STAGE):
    """Pixels of the view, [height, width, 3] of 0 to 255."""
    path = VIEW["at"] / f"{VIEW['number']}.png"
    VIEW["number"] += 1
    browser.screenshot(path, selector)
    pixels = (matplotlib.image.imread(path)[:, :, :3] * 255).round().astype(int)
    path.unlink()
    return pixels


def difference(a, b):
    """Share of the pixels that differ."""
    return np.mean(np.abs(a - b).max(axis=2) > 24)


def colourful(pixels):
    """Share of the pixels that are not grey: objects and pores are coloured, the sample is not."""
    return np.mean(pixels.max(axis=2) - pixels.min(axis=2) > 60)


def colours(pixels):
    return len(np.unique(pixels.reshape(-1, 3), axis=0))


def no_complaints(browser):
    claim(not browser.complaints, f"the page complains: {browser.complaints}")
    outside = [url for url in browser.requests if not url.startswith(("file:", "data:", "about:"))]
    claim(not outside, f"the page asks the network for {outside}")
    claim(sum(url.startswith("file:") for url in browser.requests) == 1, f"the page is not one file: {browser.requests}")


def loads(browser, *more):
    loads_one(browser)
    for page in more:
        claim(pathlib.Path(page).is_file(), f"there is no page '{page}'")
        browser.complaints.clear()
        browser.requests.clear()
        browser.open(page)
        loads_one(browser)


def loads_one(browser):
    for width in (1280, 380):
        browser.size(width, 900)
        browser.drawn()
        wide = browser.evaluate("document.documentElement.scrollWidth")
        claim(wide <= width, f"the page is {wide} wide in a window of {width}")
    no_complaints(browser)


def view(browser):
    start = seen(browser)
    claim(colours(start) > 300, f"the view has only {colours(start)} colours")
    claim(colourful(start) > 0.01, "no object is seen")

    browser.drag(STAGE, 160, 60)
    turned = seen(browser)
    claim(difference(start, turned) > 0.04, "dragging the mouse does not turn the view")
    browser.wheel(STAGE, -400)
    closer = seen(browser)
    claim(difference(turned, closer) > 0.04, "the wheel does not zoom")
    claim(np.mean(closer.min(axis=2) < 250) > np.mean(turned.min(axis=2) < 250), "wheel up does not come closer")
    browser.click("#viewer .reset")
    claim(difference(start, seen(browser)) == 0, "reset does not bring the first view back")

    browser.click("#viewer .frame", 0.995)
    last = seen(browser)
    claim(difference(start, last) > 0.02, "the last frame looks as the first")
    caption = browser.evaluate("document.querySelector('#viewer .caption').textContent")
    claim(caption == "true strain −0.300", f"the last frame is said to be at '{caption}'")
    browser.click("#viewer .frame", 0.005)
    claim(difference(start, seen(browser)) == 0, "the slider does not come back to the first frame")

    browser.click("#viewer .play")
    browser.wait_until("document.querySelector('#viewer').dataset.drawn === '2'")
    browser.click("#viewer .play")
    stood = browser.evaluate("document.querySelector('#viewer').dataset.drawn")
    browser.evaluate("new Promise(done => setTimeout(() => done(1), 900))")
    claim(browser.evaluate("document.querySelector('#viewer').dataset.drawn") == stood, "play cannot be stopped")
    browser.click("#viewer .frame", 0.005)

    for layer in ("objects", "pores"):
        claim(browser.evaluate(f"!!document.querySelector('[data-layer={layer}]')"), f"there is no switch for {layer}")
        before = colourful(seen(browser))
        browser.click(f"#viewer [data-layer={layer}]")
        claim(colourful(seen(browser)) < 0.9 * before, f"the switch does not hide the {layer}")
    claim(colourful(seen(browser)) < 0.002, "something coloured is left without objects and pores")
    for layer in ("objects", "pores"):
        browser.click(f"#viewer [data-layer={layer}]")
    claim(difference(start, seen(browser)) == 0, "the switches do not bring back what they hid")

    browser.click("#viewer .opacity input", 0.995)
    claim(colourful(seen(browser)) < 0.1 * colourful(start), "an opaque sample does not hide what is in it")
    browser.click("#viewer .opacity input", 0.005)
    claim(colourful(seen(browser)) >= colourful(start), "a sample of no opacity hides something")
    no_complaints(browser)


def event(browser):
    browser.click("tr[data-view-frame]")
    browser.evaluate("new Promise(done => setTimeout(() => done(1), 800))")
    row = browser.evaluate("document.querySelector('tr[data-view-frame]').dataset.viewFrame")
    claim(browser.evaluate("document.querySelector('#viewer').dataset.drawn") == row, "the row does not show its frame")
    name = browser.evaluate("document.querySelector('tr[data-view-frame] td').textContent")
    claim(name == "pore closed", f"the first event is '{name}'")
    x, y = browser.evaluate("(e => [+e.getAttribute('cx'), +e.getAttribute('cy')])(document.querySelector('#viewer .overlay circle'))")
    _, _, width, height = browser.box(STAGE)
    claim(abs(x - width / 2) < 0.05 * width and abs(y - height / 2) < 0.05 * height,
          f"the event in the middle of the sample is marked at {x:.0f}, {y:.0f} of {width:.0f} x {height:.0f}")
    no_complaints(browser)


def pictures(browser, folder):
    folder = pathlib.Path(folder)
    browser.screenshot(folder / "laptop.png")
    browser.drag(STAGE, 200, 40)
    browser.click("#viewer .frame", 0.995)
    browser.screenshot(folder / "turned.png", "#viewer")
    browser.screenshot(folder / "whole.png", "main")
    browser.size(380, 800)
    browser.drawn()
    browser.screenshot(folder / "narrow.png", "main")


what, page, *rest = sys.argv[1:]
claim(pathlib.Path(page).is_file(), f"there is no page '{page}'")
with Browser() as chromium:
    chromium.open(page)
    {"loads": loads, "view": view, "event": event, "pictures": pictures}[what](chromium, *rest)
VIEW["at"].rmdir()
