"""A real browser for tests: Debian's Chromium, without a window and without a network."""

from __future__ import annotations

import io
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

CHROMIUM = os.environ.get("PALPATE_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
NO_BROWSER = "no chromium: install it (Debian: apt-get install chromium), or name it in PALPATE_CHROMIUM"
FLAGS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
PICTURES = Path(__file__).parent.parent / "target" / "view"
WIDTH, HEIGHT, PANEL = 1200, 760, 440


@pytest.fixture(scope="module")
def browser():
    if CHROMIUM is None:
        pytest.skip(NO_BROWSER)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield opened
        opened.close()


class Tab:
    """A page of the browser, with what a reader does and sees."""

    def __init__(self, browser, *, offline: bool = False):
        self.context = browser.new_context(
            viewport={"width": WIDTH, "height": HEIGHT}, accept_downloads=True, offline=offline
        )
        self.page = self.context.new_page()
        self.page.set_default_timeout(60_000)
        self.errors: list[str] = []
        self.asked: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))

    def open(self, viewer):
        """The viewer, ready to be used."""
        self.page.goto(viewer.url)
        self.says("answer", "")
        self.hide_toast(self.page)

    def hide_toast(self, frame):
        """Viser tells that this browser draws in software; it would be in the pictures."""
        toast = frame.get_by_text("Software WebGL rendering detected")
        toast.wait_for()
        frame.locator(".mantine-Notification-closeButton").first.click()
        toast.wait_for(state="hidden")

    def press(self, name):
        self.page.get_by_role("button", name=name, exact=True).click()

    def fill(self, label, text):
        self.page.locator(f"xpath=//*[normalize-space(text())='{label}']/following::input[1]").fill(text)

    def turn_to(self, tab):
        self.page.get_by_role("tab", name=tab, exact=True).click()

    def says(self, kind, text):
        """Wait until a piece of the panel holds a text; all of the piece."""
        piece = self.page.locator(f'[data-palpate="{kind}"]').filter(has_text=text).first
        piece.wait_for()
        return piece.inner_text()

    def picture(self, name):
        """What is seen, as colours of shape `(h, w, 3)`; kept for people to look at."""
        PICTURES.mkdir(parents=True, exist_ok=True)
        drawn = self.page.screenshot(path=PICTURES / f"{name}.png")
        return np.asarray(Image.open(io.BytesIO(drawn)).convert("RGB")).astype(int)

    def scene(self, name, width=WIDTH - PANEL):
        """The same without the panel, once two pictures are alike."""
        before = self.picture(name)[:, :width]
        for _ in range(20):
            time.sleep(0.2)
            after = self.picture(name)[:, :width]
            if (after == before).all():
                return after
            before = after
        raise AssertionError("the picture does not come to rest")


def colored(scene, color):
    """Where a picture has a tint of a colour on white."""
    dark, wanted = 255.0 - scene, 255.0 - np.array(color)
    along = dark @ wanted / np.linalg.norm(wanted)
    return (along > 30.0) & (along > 0.99 * np.linalg.norm(dark, axis=2))


def wait_for(condition: Callable[[], bool], *, seconds: float = 30.0) -> None:
    """Until the server's side is so."""
    for _ in range(round(seconds / 0.05)):
        if condition():
            return
        time.sleep(0.05)
    raise AssertionError("it did not come to that")
