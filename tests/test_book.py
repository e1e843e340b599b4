"""The book: theorems name tests that exist, the reference has every name, examples run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import palpate
from palpate.view import NO_VISER

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
SOURCES = [*(ROOT / "crates").rglob("*.rs"), *(ROOT / "tests").glob("*.py")]
THEOREMS = [
    section
    for section in re.split(r"^## ", (DOCS / "theory.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    if re.match(r"T\d+\. ", section)
]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9][0-9]_*.py"))


def _title(section: str) -> str:
    return section.partition("\n")[0]


def _tests_of(section: str) -> str:
    """The paragraph that names the tests of a theorem."""
    found = re.findall(r"^(?:Tests:|\*Backed by\*)(.*?)(?:\n\n|\Z)", section, flags=re.DOTALL | re.MULTILINE)
    assert len(found) == 1, f"{_title(section)} has {len(found)} paragraphs of tests"
    return " ".join(found[0].split())


def _places(named: str) -> list[str]:
    """Test files, modules and functions among what is in backticks; commands are of `make`."""
    return [
        name
        for name in re.findall(r"`([^`]+)`", named)
        if name.endswith((".rs", ".py")) or "::" in name or re.fullmatch(r"[a-z]+(_[a-z]+){2,}", name)
    ]


def _texts(name: str) -> list[str]:
    """What is written in the files that a name stands for."""
    if name.endswith((".rs", ".py")):
        return [path.read_text(encoding="utf-8") for path in SOURCES if path.as_posix().endswith(f"/{name}")]
    parts = [part for part in name.split("::") if part != "tests"]
    if len(parts) == 1:
        return [text for text in map(_read, SOURCES) if f"fn {name}(" in text]
    # `space::site::tests::name`: a module's file, or a test in it.
    for last in (len(parts), len(parts) - 1):
        ending = "/".join(parts[:last])
        texts = [_read(p) for p in SOURCES if p.as_posix().endswith((f"/{ending}.rs", f"/{ending}/mod.rs"))]
        if last < len(parts):
            texts = [text for text in texts if f"fn {parts[-1]}(" in text]
        if texts:
            return texts
    return []


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _functions(named: str) -> list[str]:
    """Words in italics, as the beginning of a function's name: *no truth is lost …* is `no_truth_is_lost`."""
    phrases = re.findall(r"(?<!\*)\*([^*]+)\*(?!\*)", named)
    return [re.sub(r"\W+", "_", phrase.removesuffix("…").strip()).lower() for phrase in phrases]


def test_there_are_theorems() -> None:
    assert [int(section[1 : section.index(".")]) for section in THEOREMS] == list(range(1, len(THEOREMS) + 1))
    assert len(THEOREMS) >= 21


@pytest.mark.parametrize("section", THEOREMS, ids=_title)
def test_a_theorem_names_tests_that_exist(section: str) -> None:
    named = _tests_of(section)
    places = _places(named)
    assert places, named
    texts: list[str] = []
    for place in places:
        found = _texts(place)
        assert found, f"{place} does not exist"
        assert any("#[test]" in text or "proptest!" in text or "def test_" in text for text in found), place
        texts += found
    for function in _functions(named):
        pattern = rf"(?:fn|def) (?:test_)?{function}"
        assert any(re.search(pattern, text, flags=re.IGNORECASE) for text in texts), function


def test_the_reference_has_every_name() -> None:
    listed = re.findall(
        r"^::: palpate\.(\S+)", (DOCS / "reference.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    public = {name for name in vars(palpate) if not name.startswith("_")} - {"TYPE_CHECKING", "Any"}
    modules = {name for name in public if type(getattr(palpate, name)).__name__ == "module"}
    assert {name for name in listed if "." not in name} - {"plots"} == public - modules
    assert len(listed) == len(set(listed))
    for name in listed:
        __import__(f"palpate.{name.partition('.')[0]}") if "." in name else None
        found = palpate
        for part in name.split("."):
            found = getattr(found, part)
        assert getattr(found, "__doc__", None), name


def test_every_page_is_in_the_navigation() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("nav:")[2]
    listed = set(re.findall(r"(\S+\.md)", navigation))
    pages = {path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md")}
    assert listed == pages - {"tables/no-normals.md"}  # in the text of others


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_an_example_runs(example: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        [sys.executable, "-W", "error", str(example)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=240,
        stdin=subprocess.DEVNULL,
    )
    if done.returncode and NO_VISER in done.stderr:
        pytest.skip(NO_VISER)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert list(tmp_path.iterdir()) == []


def test_the_examples_are_in_the_book() -> None:
    page = (DOCS / "examples.md").read_text(encoding="utf-8")
    assert [ROOT / path for path in re.findall(r'^--8<-- "(\S+)"', page, re.MULTILINE)] == EXAMPLES
    assert len(EXAMPLES) >= 5
    for example in EXAMPLES:
        assert example.read_text(encoding="utf-8").startswith('"""')
