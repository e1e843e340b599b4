"""One self-contained HTML page from headings, Markdown, tables and pictures.

The page is one file that asks no host for anything: its style is in it, its pictures are embedded. It follows
the reader's light or dark scheme and prints well. It is well-formed XML too, and the same content gives the
same file.

    page = Page("A run", lead="Seven touches of an unknown part.")
    page.heading("Result")
    page.text(f"It is **{plain(model.name)}**.")
    page.table(["", "x (mm)"], [["found", "12.3"], ["truth", "12.4"]])
    page.picture(plot_run(result), caption="The whole run.")
    page.save("run.html")
"""

from __future__ import annotations

import base64
import html
import os
import re
import string
from collections.abc import Iterable, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt
from matplotlib.figure import Figure

MEDIA_TYPES = {".svg": "image/svg+xml", ".png": "image/png"}

_MOST_WITHOUT_CONTENTS = 4  # headings
_PUNCTUATION = re.compile(f"([{re.escape(string.punctuation)}])")
_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

# HTML in the text is shown as it was written; an image would be asked for elsewhere, hence `picture`.
_MARKDOWN = MarkdownIt("commonmark", {"html": False, "xhtmlOut": True}).enable("table").disable("image")


def plain(text: object) -> str:
    """`text` as Markdown that shows it letter by letter: for names that come from elsewhere."""
    return _PUNCTUATION.sub(r"\\\1", " ".join(str(text).split()))


class Page:
    """A page that grows from top to bottom; `html` gives it, `save` writes it."""

    def __init__(self, title: str, *, lead: str = "") -> None:
        """An empty page; `title` is plain text, `lead` the Markdown below it."""
        self._title = title
        self._lead = lead
        self._blocks: list[str] = []
        self._headings: list[tuple[int, str]] = []

    def heading(self, text: str, *, level: int = 2) -> None:
        """A heading, plain text; those of level 2 make the table of contents.

        Raises:
            ValueError: A level other than 2, 3 or 4.
        """
        if level not in (2, 3, 4):
            raise ValueError(f"level: must be 2, 3 or 4 (got {level!r}); the title of the page has level 1")
        self._headings.append((level, text))
        anchor = len(self._headings)
        self._blocks.append(f'<h{level} id="part-{anchor}">{_escaped(text)}</h{level}>')

    def text(self, markdown: str) -> None:
        """CommonMark with tables. HTML in it is shown as it is written, images are not."""
        self._blocks.append(_rendered(markdown))

    def facts(self, pairs: Iterable[tuple[str, object]]) -> None:
        """Few figures in large letters: what each is, and its value; plain text."""
        boxes = (f"<div><dt>{_escaped(what)}</dt><dd>{_escaped(value)}</dd></div>" for what, value in pairs)
        self._blocks.append(f'<dl class="facts">{"".join(boxes)}</dl>')

    def table(self, header: Sequence[object], rows: Iterable[Sequence[object]], *, caption: str = "") -> None:
        """A table, plain text in its cells; `caption` is Markdown.

        Columns that hold nothing but numbers are aligned to the right.

        Raises:
            ValueError: A row with more or fewer cells than the header.
        """
        cells = [[str(cell) for cell in row] for row in rows]
        for number, row in enumerate(cells):
            if len(row) != len(header):
                raise ValueError(
                    f"rows[{number}]: must have {len(header)} cells, as the header (got {len(row)}); "
                    "give an empty text where there is nothing to say"
                )
        looks = [' class="number"' if _numeric(column) else "" for column in zip(*cells, strict=True)]
        looks = looks or [""] * len(header)
        head = _row("th", header, looks)
        body = "".join(_row("td", row, looks) for row in cells)
        told = f"<caption>{_inline(caption)}</caption>" if caption else ""
        self._blocks.append(
            f'<div class="wide"><table>{told}<thead>{head}</thead><tbody>{body}</tbody></table></div>'
        )

    def picture(self, source: Figure | str | Path, *, caption: str = "", alt: str = "") -> None:
        """A picture: a matplotlib figure, or an .svg or .png file; it becomes part of the page.

        Args:
            source: What is shown.
            caption: Markdown below it.
            alt: Plain text for readers who can't see it; the caption, if not given.

        Raises:
            ValueError: A file of another kind.
            OSError: A file that can't be read.
        """
        self._blocks.append(_figure(source, caption, alt))

    def gallery(self, pictures: Iterable[tuple[Figure | str | Path, str]]) -> None:
        """Pictures with their captions beside each other, where there is room; see `picture`."""
        shown = "".join(_figure(source, caption, "") for source, caption in pictures)
        self._blocks.append(f'<div class="gallery">{shown}</div>')

    def code(self, text: str, *, summary: str | None = None) -> None:
        """Text as it is, letters of one width; with a `summary`, plain text, folded away behind it."""
        block = f"<pre><code>{_escaped(text)}</code></pre>"
        if summary is not None:
            block = f"<details><summary>{_escaped(summary)}</summary>{block}</details>"
        self._blocks.append(block)

    def html(self) -> str:
        """The page as it is so far."""
        style = resources.files("palpate").joinpath("report.css").read_text(encoding="utf-8")
        lead = f'<div class="lead">{_rendered(self._lead)}</div>' if self._lead else ""
        parts = [f"<h1>{_escaped(self._title)}</h1>", lead, self._contents(), *self._blocks]
        return _PAGE.format(
            title=_escaped(self._title), style=style, body="\n".join(part for part in parts if part)
        )

    def save(self, path: str | Path) -> None:
        """Write the page, whole or not at all.

        Raises:
            ValueError: A suffix other than .html.
            OSError: It can't be written.
        """
        path = Path(path)
        if path.suffix.lower() != ".html":
            raise ValueError(f"path: must end in .html (got {str(path)!r}); name it so")
        partial = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            partial.write_text(self.html(), encoding="utf-8")
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)

    def _contents(self) -> str:
        listed = [(k, text) for k, (level, text) in enumerate(self._headings, start=1) if level == 2]
        if len(listed) <= _MOST_WITHOUT_CONTENTS:
            return ""
        items = (f'<li><a href="#part-{anchor}">{_escaped(text)}</a></li>' for anchor, text in listed)
        return f'<nav aria-label="Contents"><ol>{"".join(items)}</ol></nav>'


_PAGE = """<!DOCTYPE html>
<html lang="en" xmlns="http://www.w3.org/1999/xhtml">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta name="color-scheme" content="light dark"/>
<meta http-equiv="Content-Security-Policy" \
content="default-src 'none'; img-src data:; style-src 'unsafe-inline'"/>
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<main>
{body}
</main>
</body>
</html>
"""


def _escaped(text: object) -> str:
    return html.escape(_NOT_IN_XML.sub("\ufffd", str(text)))


def _rendered(markdown: str) -> str:
    rendered = str(_MARKDOWN.render(_NOT_IN_XML.sub("\ufffd", markdown))).strip()
    return rendered.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")


def _inline(markdown: str) -> str:
    return str(_MARKDOWN.renderInline(_NOT_IN_XML.sub("\ufffd", markdown))).strip()


def _row(cell: str, texts: Sequence[object], looks: Sequence[str]) -> str:
    cells = (f"<{cell}{look}>{_escaped(text)}</{cell}>" for text, look in zip(texts, looks, strict=True))
    return f"<tr>{''.join(cells)}</tr>"


def _numeric(column: Sequence[str]) -> bool:
    """Whether every cell that says something begins with a number, perhaps with a sign or a ≤ before it."""
    said = [cell for cell in column if cell.strip()]
    return bool(said) and all(re.match(r"\s*[≤≥<>±+\-−]?\s*[\d.]", cell) for cell in said)


def _figure(source: Figure | str | Path, caption: str, alt: str) -> str:
    media, content = _picture(source)
    told = _inline(caption)
    # Tags out, entities kept: what is read aloud is what the caption shows.
    spoken = _escaped(alt) if alt else re.sub(r"<[^>]*>", "", told)
    data = base64.b64encode(content).decode("ascii")
    shown = f'<img alt="{spoken}" src="data:{media};base64,{data}"/>'
    return f"<figure>{shown}{f'<figcaption>{told}</figcaption>' if told else ''}</figure>"


def _picture(source: Any) -> tuple[str, bytes]:
    if isinstance(source, Figure):
        from palpate.plots.style import svg_of

        return MEDIA_TYPES[".svg"], svg_of(source)
    path = Path(source)
    media = MEDIA_TYPES.get(path.suffix.lower())
    if media is None:
        raise ValueError(
            f"source: must be a figure, .svg or .png (got {str(path)!r}); save it as one of them"
        )
    return media, path.read_bytes()
