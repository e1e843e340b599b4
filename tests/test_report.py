"""Report pages: well-formed, self-contained, names shown as they are."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as Xml
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from palpate.report import Page, plain

XHTML = "{http://www.w3.org/1999/xhtml}"
NASTY = '<script src="http://evil.example/x.js"> & "boot" ![x](http://evil.example/y.png) *a* _b_ `c` |d|\x00'
SHOWN = NASTY.replace("\x00", "\ufffd")
LOADING = {"src", "srcset", "data", "poster", "background", "action", "formaction", "href"}
VOID = {"meta", "img", "br", "hr"}


class Strict(HTMLParser):
    """Tags as an HTML reader sees them; complains if they don't nest."""

    def __init__(self):
        super().__init__()
        self.open, self.loaded = [], []

    def handle_starttag(self, tag, attrs):
        if tag != "a":  # a link is followed by the reader, or not
            self.loaded += [value for name, value in attrs if name in LOADING]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag


def drawing() -> Figure:
    figure = Figure(figsize=(2, 1))
    figure.add_subplot().plot([0, 1], [1, 0])
    return figure


def everything(name: str) -> Page:
    page = Page(name, lead=f"About **{plain(name)}**.")
    for level in (2, 3, 4, 2, 2, 2, 2):
        page.heading(name, level=level)
    page.text(f"It is *{plain(name)}*, or:\n\n| a | b |\n|---|--:|\n| 1 | 2 |\n\n{name}")
    page.facts([(name, name)])
    page.table([name, "b"], [[name, 1], ["", 2]], caption=plain(name))
    page.picture(drawing(), caption=plain(name))
    page.gallery([(drawing(), plain(name)), (drawing(), "two")])
    page.code(name)
    page.code(name, summary=name)
    return page


def elements(page: Page) -> Xml.Element:
    return Xml.fromstring(page.html())


def texts(page: Page, tag: str) -> list[str]:
    return ["".join(one.itertext()) for one in elements(page).iter(f"{XHTML}{tag}")]


@pytest.mark.parametrize("name", ["boot", NASTY])
def test_a_page_nests_for_readers_of_html_and_of_xml(name):
    page = everything(name)
    strict = Strict()
    strict.feed(page.html())
    assert strict.open == []
    assert elements(page).tag == f"{XHTML}html"


def test_nothing_outside_is_referenced():
    page = everything(NASTY)
    strict = Strict()
    strict.feed(page.html())
    assert len(strict.loaded) == 3
    assert all(one.startswith("data:image/svg+xml;base64,") for one in strict.loaded)
    style = texts(page, "style")[0]
    assert "url(" not in style and "@import" not in style
    assert not list(elements(page).iter(f"{XHTML}script")) and not list(elements(page).iter(f"{XHTML}link"))


def test_names_are_shown_as_they_are():
    page = everything(NASTY)
    for tag in ("title", "h1", "h2", "h3", "h4", "dt", "dd", "summary"):
        assert set(texts(page, tag)) == {SHOWN}, tag
    assert SHOWN in texts(page, "td") and SHOWN in texts(page, "th")
    assert texts(page, "figcaption") == [SHOWN, SHOWN, "two"] and texts(page, "caption") == [SHOWN]
    assert f"About {SHOWN}." in texts(page, "p")
    assert [one.get("alt") for one in elements(page).iter(f"{XHTML}img")] == [SHOWN, SHOWN, "two"]


@given(st.text())
def test_plain_text_survives_markdown(text):
    page = Page("t")
    page.text(f"x{plain(text)}x")
    shown = re.sub("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "\ufffd", " ".join(text.split()))
    assert texts(page, "p") == [f"x{shown}x"]


def test_anchors_are_where_the_contents_point():
    page = everything("boot")
    ids = {one.get("id") for one in elements(page).iter() if one.get("id")}
    links = [one.get("href") for one in elements(page).iter(f"{XHTML}a")]
    assert len(links) == 5 and {link[1:] for link in links} <= ids


def test_few_headings_make_no_contents():
    page = Page("t")
    page.heading("one")
    assert not list(elements(page).iter(f"{XHTML}nav"))


def test_pictures_are_embedded_as_they_are(tmp_path):
    file = tmp_path / "a.png"
    drawing().savefig(file)
    page = Page("t")
    page.picture(file, alt="<a>")
    page.picture(drawing())
    kept, drawn = elements(page).iter(f"{XHTML}img")
    assert kept.get("alt") == "<a>"
    assert base64.b64decode(kept.get("src").removeprefix("data:image/png;base64,")) == file.read_bytes()
    svg = base64.b64decode(drawn.get("src").removeprefix("data:image/svg+xml;base64,"))
    assert Xml.fromstring(svg).tag == "{http://www.w3.org/2000/svg}svg"


def test_numbers_stand_to_the_right():
    page = Page("t")
    page.table(["a", "b", "c"], [["x", "≤ 0.2 mm", "1"], ["y", "", "none"]])
    looks = [one.get("class") for one in elements(page).iter(f"{XHTML}td")]
    assert looks == [None, "number", None] * 2
    page.table(["a"], [])
    assert texts(page, "th")[-1] == "a"


def test_the_same_content_gives_the_same_file(tmp_path):
    for name in ("a.html", "b.html"):
        everything("boot").save(tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.html", "b.html"]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda page: page.heading("x", level=1), r"level: must be 2, 3 or 4 \(got 1\)"),
        (lambda page: page.table(["a"], [["1"], ["1", "2"]]), r"rows\[1\]: must have 1 cells"),
        (lambda page: page.picture("a.pdf"), "source: must be a figure, .svg or .png .got 'a.pdf'"),
        (lambda page: page.save(Path("a.txt")), "path: must end in .html"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call(Page("t"))
