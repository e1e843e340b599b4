"""The viewer in a real browser: what the page shows, and what the session knows."""

from __future__ import annotations

import numpy as np
import pytest
from browsing import PANEL, WIDTH, Tab, browser, colored, wait_for  # noqa: F401 - a fixture
from conftest import pose, usual_sensor

import palpate
from palpate.view import Session, Viewer
from palpate.view.picture import color_of

SIX = list(palpate.part_names())[:6]
BOOT = SIX.index("boot")
BRACKET_TOUCHES = [
    ((175.4, 160.2, 96.4), (-0.415, 0.769, 0.486)),
    ((223.3, 37.7, 82.5), (0.412, -0.761, -0.5)),
    ((216.9, 138.9, 83.1), (0.91, 0.326, 0.257)),
    ((221.1, 23.7, 109.5), (-0.012, -0.559, 0.829)),
]


@pytest.fixture
def tab(browser):  # noqa: F811
    opened = Tab(browser)
    yield opened
    opened.context.close()
    assert opened.errors == []


@pytest.fixture
def viewers():
    opened = []

    def view(session):
        opened.append(Viewer(session, port=0))
        return opened[-1]

    yield view
    for viewer in opened:
        viewer.stop()


def test_from_clicks_to_one_part_and_a_page_without_a_server(tab, viewers, browser, tmp_path):  # noqa: F811
    """Load, add contacts by clicks and by numbers, recognize, plan, touch until one is left, save, open."""
    truth = pose(0.5, 20.0, -10.0)
    boot = palpate.load_models("boot")[0]
    coarse = usual_sensor(position_error=3.0)  # from above only: it takes a few touches
    down = ((0.0, -1.0), 0.2)
    session = Session(palpate.load_models(SIX), coarse, truth=(boot, truth), directions=down, seed=3)
    viewer = viewers(session)
    tab.open(viewer)
    assert "No contacts yet" in tab.says("answer", "No contacts")
    laid_out = tab.scene("1-laid-out")
    for number in range(len(SIX)):
        assert colored(laid_out, color_of(number)).sum() > 50, SIX[number]

    # A click on the boot: where its colour is, tinted.
    rows, columns = np.nonzero(colored(laid_out, color_of(BOOT)))
    tab.page.mouse.click(int(np.median(columns)), int(np.median(rows)))
    wait_for(lambda: len(session.state.contacts) == 1)
    (placement,) = [one for one in session.placements(session.state) if one.model_number == BOOT]
    clicked = session.state.contacts[0]
    assert abs(boot.distance(placement.world_from_model, clicked.center)) < 1e-9
    assert "contact 1 added" in tab.says("status", "contact 1")
    with_contact = tab.scene("2-clicked")
    assert (with_contact != laid_out).any()
    tab.press("undo")
    wait_for(lambda: not session.state.contacts)

    # By numbers: where the truth would be touched. What can't be understood is said.
    tab.turn_to("contacts")
    tab.fill("centre", "1, two")
    tab.press("add this contact")
    assert "centre: must be 2 numbers (got '1, two')" in tab.says("status", "centre")
    first = palpate.random_contacts(boot, truth, coarse, count=2, seed=2)
    for number, contact in enumerate(first, start=1):
        tab.fill("centre", ", ".join(f"{value:.9f}" for value in contact.center))
        tab.fill("normal", ", ".join(f"{value:.9f}" for value in contact.normal))
        tab.press("add this contact")
        wait_for(lambda number=number: len(session.state.contacts) == number)
        assert f"{number}" in tab.says("evidence", f"{session.state.contacts[-1].center[0]:.4g}")
    assert np.allclose(session.state.contacts[1].center, first[1].center, atol=1e-8)

    tab.press("recognize")
    wait_for(lambda: session.state.left is not None)
    count = len(session.state.hypotheses)
    assert count > 1
    assert f"{count} hypotheses left" in tab.says("answer", f"{count} hypotheses")
    recognized = tab.scene("3-recognized")
    for number in {one.model_number for one in session.state.hypotheses}:
        assert colored(recognized, color_of(number)).sum() > 50

    touches = 0
    while len(session.state.hypotheses) > 1:
        tab.press("plan")
        wait_for(lambda: session.state.path is not None)
        tab.turn_to("path")
        path = session.state.path
        why = tab.says("reasons", f"{path.length:.4g}")
        assert ("Certain" if path.guaranteed else "Nothing is certain") in why
        for outcome in path.outcomes[:20]:
            assert (
                f"{outcome.hypothesis + 1} {session.state.hypotheses[outcome.hypothesis].model.name}" in why
            )
        planned = tab.scene(f"4-planned-{touches}")
        assert (planned != recognized).any()
        tab.press("touch")
        touches += 1
        wait_for(lambda done=touches: len(session.state.moves) == done)
        assert touches < 10
    assert touches > 1
    assert tab.says("answer", "1 hypothesis left")
    assert session.state.hypotheses[0].model.name == "boot"
    assert session.state.hypotheses[0].poses.contains(truth)
    solved = tab.scene("5-solved")
    assert colored(solved, color_of(BOOT)).sum() > 50
    tab.press("plan")
    assert "nothing to tell apart" in tab.says("reasons", "One hypothesis is left")

    tab.turn_to("history")
    with tab.page.expect_download() as download:
        tab.press("save as a page")
    page = tmp_path / "palpate.html"
    download.value.save_as(page)
    viewer.stop()

    alone = Tab(browser, offline=True)
    try:
        alone.page.goto(page.as_uri())
        last = len(session.states) - 1
        assert alone.page.locator("#number").inner_text() == f"{last} of {last}"
        alone.hide_toast(alone.page.frame_locator("#scene"))
        assert "1 hypothesis left" in alone.page.locator(f'section[data-moment="{last}"]').inner_text()
        saved = alone.scene("6-saved-page")
        assert colored(saved, color_of(BOOT)).sum() > 50
        for _ in range(2):
            alone.page.click("#back")
        alone.hide_toast(alone.page.frame_locator("#scene"))
        assert "Why this path" in alone.page.locator(f'section[data-moment="{last - 2}"]').inner_text()
        assert (alone.scene("7-saved-page-earlier") != saved).any()
        assert alone.errors == []
        assert [url for url in alone.asked if url.startswith(("http", "ws"))] == []
    finally:
        alone.context.close()


def test_solids_their_ranges_and_the_tree(tab, viewers):
    bounds = {"position_error": 0.5, "normal_error": float(np.radians(4))}
    touches = [palpate.Contact(*touch, **bounds) for touch in BRACKET_TOUCHES]
    session = Session(palpate.bundled_solids(), usual_sensor(), contacts=touches)
    viewer = viewers(session)
    tab.open(viewer)
    tab.press("recognize")
    assert "4 hypotheses left" in tab.says("answer", "4 hypotheses")
    plain = tab.scene("8-solids")
    for number in (0, 1):
        assert colored(plain, color_of(number)).sum() > 50

    tab.turn_to("look")
    tab.page.get_by_role("checkbox", name="sampled poses").click()
    tab.page.get_by_role("checkbox", name="places of corners").click()
    wait_for(lambda: viewer.look.samples and viewer.look.bounds)
    told = tab.says("range", "is in its ball")
    assert "Each is valid" in told and "whichever pose it is" in told
    ranges = tab.scene("9-solids-ranges")
    assert (ranges != plain).any()
    tab.page.get_by_role("checkbox", name="sampled poses").click()
    tab.page.get_by_role("checkbox", name="places of corners").click()
    wait_for(lambda: not viewer.look.bounds)

    tab.turn_to("tree")
    tab.press("grow the ambiguity tree")
    tree = tab.says("tree", "expected")
    assert session.state.tree is not None
    assert all(f"{number} {one.model.name}" in tree for number, one in enumerate(session.state.hypotheses, 1))

    # A click on a solid: the contact is where the ray meets it first.
    rows, columns = np.nonzero(colored(plain, color_of(0)))
    tab.page.mouse.click(int(np.median(columns)), int(np.median(rows)))
    wait_for(lambda: len(session.state.contacts) == 5)
    added = session.state.contacts[4].center
    places = session.placements(session.state)
    assert min(abs(one.model.distance(one.world_from_model, added)) for one in places) < 1e-6
    assert session.state.stale
    assert "recognize anew" in tab.says("answer", "A contact was added since")
    tab.press("plan")
    assert "recognize first" in tab.says("status", "not all contacts")
    tab.scene("10-solids-clicked")


def test_the_timeline_of_a_recorded_run(tab, viewers, tmp_path):
    models = palpate.load_models(["boot", "camera", "telephone"])
    probe = palpate.SimulatedProbe(models[0], pose(1.2, 40.0, -60.0), usual_sensor(), seed=1)
    result = palpate.identify(
        models, probe, usual_sensor(), [[-300, -300], [300, 300]], log=tmp_path / "run.jsonl"
    )
    viewer = viewers(Session.of_log(tmp_path / "run.jsonl"))
    tab.open(viewer)
    assert viewer.shown == result.touches
    assert "1 hypothesis left" in tab.says("answer", "1 hypothesis left")
    last = tab.scene("11-recorded-last")
    tab.turn_to("history")
    assert f"{result.touches}: solved" in tab.says("story", "solved")
    tab.page.get_by_role("slider").press("ArrowLeft")
    wait_for(lambda: viewer.shown == result.touches - 1)
    before = len(result.steps[-2].hypotheses)
    assert tab.says("answer", f"{before} hypotheses left")
    tab.turn_to("path")
    assert "As it was planned in the run." in tab.says("reasons", "As it was planned")
    assert (tab.scene("12-recorded-planned")[:, : WIDTH - PANEL] != last).any()
