"""From click to picture: the viewer with 100 hypotheses of a part of 1,000 faces, in a real browser.

    python -m palpate.experiments.view_speed --page docs/viewer.md

The part is a wheel of 250 teeth, one of them missing: a few touches leave a hypothesis for almost every
tooth. A time is from the click until a screenshot shows what it was for, so that the time of taking one is in
it. Needs Chromium and Playwright (`pip install "palpate[test]"`).
"""

from __future__ import annotations

import argparse
import io
import math
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import palpate
from palpate.view import Session, State, Viewer

from . import pages

TEETH = 250
HYPOTHESES = 100
RADIUS, TOOTH, THICKNESS = 100.0, 2.0, 20.0
SENSOR = palpate.Sensor(0.05, math.radians(0.3), math.radians(60.0))
MOVES = (
    ((150.0, 3.1, 10.0), (60.0, 3.1, 10.0)),
    ((20.0, 30.0, 60.0), (20.0, 30.0, -10.0)),
    ((3.3, 150.0, 8.0), (3.3, 60.0, 8.0)),
    ((-60.0, 20.0, 60.0), (-60.0, 20.0, -10.0)),
    ((10.0, -60.0, 60.0), (10.0, -60.0, -10.0)),
)
REPEATS = 3
FLAGS = ("--no-sandbox", "--disable-background-networking", "--no-first-run")
WIDTH, HEIGHT = 1280, 800
SCENE = {"x": 0, "y": 0, "width": 800, "height": HEIGHT}
LONGEST_S = 300.0
SIGHT_S = 4.0  # for which frames are counted


def wheel(teeth: int = TEETH) -> palpate.Model:
    """A toothed wheel without one of its teeth: four faces a tooth, and two lids."""
    step = math.tau / teeth
    outline = [(RADIUS, 0.0)]
    for number in range(1, teeth):
        for share, radius in ((0.0, RADIUS), (0.2, RADIUS + TOOTH), (0.55, RADIUS + TOOTH), (0.75, RADIUS)):
            angle = (number + share) * step
            outline.append((radius * math.cos(angle), radius * math.sin(angle)))
    rim = np.array(outline)
    count = len(rim)
    lids = [np.column_stack([rim, np.full(count, z)]) for z in (0.0, THICKNESS)]
    vertices = np.vstack([*lids, [[0.0, 0.0, 0.0], [0.0, 0.0, THICKNESS]]])
    here = np.arange(count)
    after = (here + 1) % count
    below, above = np.full(count, 2 * count), np.full(count, 2 * count + 1)
    triangles = np.vstack(
        [
            np.column_stack([here, after, count + after]),
            np.column_stack([here, count + after, count + here]),
            np.column_stack([after, here, below]),
            np.column_stack([count + here, count + after, above]),
        ]
    )
    return palpate.Model.mesh(vertices, triangles, name="wheel")


def touched(model: palpate.Model) -> list[palpate.Contact]:
    """Contacts with the wheel where it is."""
    probe = palpate.SimulatedProbe(model, np.eye(4), SENSOR, noise="none")
    replies = [probe.touch(*move) for move in MOVES]
    return [reply.contact for reply in replies if isinstance(reply, palpate.Hit)]


class _Timed(Session):
    """Knows how long the core searched."""

    searched = 0.0

    def recognize(self) -> State:
        began = time.perf_counter()
        state = super().recognize()
        self.searched = time.perf_counter() - began
        return state


def main() -> None:
    """Measure and print; with `--page`, write it there."""
    parser = argparse.ArgumentParser(prog="view_speed", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--page", type=Path, help="a page with a place for it")
    options = parser.parse_args()
    text = _measured()
    print(text)
    if options.page is not None:
        pages.rewrite(options.page, "view-speed", text)


def _measured() -> str:
    from playwright.sync_api import sync_playwright

    chromium = os.environ.get("PALPATE_CHROMIUM") or shutil.which("chromium")
    if chromium is None:
        raise SystemExit("chromium: is not there; install it (Debian: apt-get install chromium)")
    model = wheel()
    contacts = touched(model)
    rows: list[tuple[str, float, float]] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        for _ in range(REPEATS):
            session = _Timed([model], SENSOR, contacts=contacts, max_hypotheses=HYPOTHESES)
            viewer = Viewer(session, port=0)
            try:
                page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
                page.goto(viewer.url)
                page.get_by_role("button", name="recognize", exact=True).wait_for()
                _rest(page)
                rows += _clicks(page, viewer, session)
                page.close()
            finally:
                viewer.stop()
        browser.close()
    named = dict.fromkeys(name for name, _, _ in rows)
    told: list[list[str]] = []
    for name in named:
        pictures, works = zip(*((picture, work) for each, picture, work in rows if each == name), strict=True)
        if name == FRAMES:
            told.append([name, f"{float(np.median(pictures)):.0f} a second", ""])
        else:
            work = float(np.median(works))
            told.append(
                [name, pages.duration(float(np.median(pictures))), pages.duration(work) if work else ""]
            )
    return (
        f"{HYPOTHESES} hypotheses of a wheel of {len(model.faces)} faces ({len(model.triangles)} triangles); "
        f"medians of {REPEATS} sessions in Chromium, drawing without a graphics card:\n\n"
        + pages.table(["click", "until the picture shows it", "of it the search"], told)
        + f"\n\nMeasured on {pages.machine()}."
    )


FRAMES = "frames while the view is turned"
COUNT_FRAMES = """() => {
    window.drawn = 0;
    const tick = () => { window.drawn++; requestAnimationFrame(tick) };
    tick();
}"""


def _clicks(page: Any, viewer: Viewer, session: _Timed) -> list[tuple[str, float, float]]:
    """What each click takes, and how much of it is the core's work."""
    found = _until_drawn(page, lambda: page.get_by_role("button", name="recognize", exact=True).click())
    if len(session.state.hypotheses) != HYPOTHESES:
        raise SystemExit(f"hypotheses: {len(session.state.hypotheses)} were left, not {HYPOTHESES}")
    while viewer.busy:
        time.sleep(0.05)
    _rest(page)
    box = page.locator("canvas").first.bounding_box()
    added = _until_drawn(
        page, lambda: page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    )
    if len(session.state.contacts) != len(MOVES) + 1:
        raise SystemExit("contacts: the click added none")
    page.get_by_role("tab", name="look", exact=True).click()
    _rest(page)

    def choose() -> None:
        page.locator("xpath=//*[normalize-space(text())='hypothesis']/following::input[1]").click()
        page.get_by_role("option", name="7", exact=True).click()

    chosen = _until_drawn(page, choose)
    return [
        ("recognize", found, session.searched),
        ("on a part: a contact is added", added, 0.0),
        ("choose one of the hypotheses", chosen, 0.0),
        (FRAMES, _frames(page), 0.0),
    ]


def _until_drawn(page: Any, click: Callable[[], None]) -> float:
    """Seconds until the scene is another one."""
    before = _scene(page)
    began = time.perf_counter()
    click()
    while (_scene(page) == before).all():
        if time.perf_counter() - began > LONGEST_S:
            raise SystemExit("the picture does not change")
    return time.perf_counter() - began


def _rest(page: Any) -> None:
    """Until nothing changes any more."""
    before = _scene(page)
    time.sleep(0.5)
    while not (before == (before := _scene(page))).all():
        time.sleep(0.5)


def _frames(page: Any) -> float:
    """Frames a second while the view is turned about."""
    page.evaluate(COUNT_FRAMES)
    page.mouse.move(400, 400)
    page.mouse.down()
    began, first = time.perf_counter(), page.evaluate("() => window.drawn")
    step = 0
    while time.perf_counter() - began < SIGHT_S:
        step += 1
        page.mouse.move(400 + 3 * step % 200, 400 + step % 60)
        time.sleep(0.02)
    drawn = page.evaluate("() => window.drawn") - first
    seconds = time.perf_counter() - began
    page.mouse.up()
    return float(drawn / seconds)


def _scene(page: Any) -> Any:
    from matplotlib.image import imread

    return imread(io.BytesIO(page.screenshot(clip=SCENE)), format="png")


if __name__ == "__main__":
    main()
