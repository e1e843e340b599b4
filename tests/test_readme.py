"""The Python and the command lines in README and docs run as printed; their JSON is read."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import typer.main

import palpate
from palpate.cli import main
from palpate.cli.app import app

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def _blocks(page: Path) -> list[str]:
    text = page.read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", [page for page in PAGES if _blocks(page)], ids=lambda page: page.name)
def test_the_python_of_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    _write_parts()
    names: dict[str, object] = {"__name__": "__main__"}
    for number, block in enumerate(_blocks(page), start=1):
        exec(compile(block, f"{page.name}, block {number}", "exec"), names)


def test_the_readme_has_python() -> None:
    assert _blocks(ROOT / "README.md")


# What takes minutes, or needs what only its reader has, is not run: its arguments are checked.
TOO_LONG = ("experiment all",)
PAGES_OF_COMMANDS = ["README.md", "docs/solids.md", "docs/machine-tool.md", "docs/viewer.md"]


def _is_only_checked(command: str) -> bool:
    """A viewer is open until an interrupt, unless it saves a page."""
    return command.startswith(TOO_LONG) or (command.startswith("view") and "--save" not in command)


def _commands(page: Path) -> list[str]:
    """Indented lines that begin with the program, those that go on joined."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    return re.findall(r"^    (?:\.venv/bin/)?palpate (.+)$", text, flags=re.MULTILINE)


def _write_tables(page: Path) -> None:
    """Indented tables, as the files that are named last before them."""
    text = page.read_text(encoding="utf-8")
    for table in re.finditer(r"^    x,y.*\n(?:    .*\n)+", text, flags=re.MULTILINE):
        name = re.findall(r"`(\w+\.csv)`", text[: table.start()])[-1]
        Path(name).write_text(re.sub(r"^    ", "", table[0], flags=re.MULTILINE))


def _write_parts() -> None:
    """Parts of the reader's own."""
    drawing = ezdxf.new(setup=True)
    drawing.units = ezdxf.units.MM
    drawing.modelspace().add_lwpolyline([(0, 0), (80, 0), (80, 20), (20, 20), (20, 60), (0, 60)], close=True)
    drawing.saveas("my-part.dxf")
    Path("library").mkdir()
    for solid in palpate.bundled_solids():
        _write_stl(solid, Path("library") / f"{solid.name}.stl")
    shutil.copy("library/l-bracket.stl", "bracket.stl")


def _write_stl(solid: palpate.Model, path: Path) -> None:
    rows = [f"solid {solid.name}"]
    for corners in solid.vertices[np.asarray(solid.triangles)].tolist():
        rows += ["facet normal 0 0 0", "outer loop", *(f"vertex {x} {y} {z}" for x, y, z in corners)]
        rows += ["endloop", "endfacet"]
    path.write_text("\n".join([*rows, f"endsolid {solid.name}", ""]))


@pytest.mark.parametrize("page", [ROOT / page for page in PAGES_OF_COMMANDS], ids=lambda page: page.name)
def test_the_commands_of_a_page_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    _write_parts()
    _write_tables(page)
    # Files that its Python writes are there when its commands are read.
    names: dict[str, object] = {}
    for block in _blocks(page):
        exec(compile(block, page.name, "exec"), names)
    commands = _commands(page)
    assert len(commands) > 2
    for command in commands:
        if _is_only_checked(command):
            name, *arguments = shlex.split(command, comments=True)
            typer.main.get_command(app).commands[name].make_context(name, arguments)
            continue
        capsys.readouterr()
        assert main(shlex.split(command, comments=True)) == 0, (command, capsys.readouterr().err)
        assert capsys.readouterr().out, command


def test_the_json_of_pages_is_read(tmp_path: Path) -> None:
    read = {"palpate-contacts": palpate.read_contacts, "palpate-model": palpate.load_models}
    count = 0
    for page in PAGES:
        for block in re.findall(
            r"^```json\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
        ):
            file = tmp_path / f"{count}.json"
            file.write_text(block)
            assert read[json.loads(block)["schema"]](file)
            count += 1
    assert count >= 4


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_to_files_of_the_project_exist(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target
