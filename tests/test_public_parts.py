"""Parts of public packages: what is joined, kept, said and taken up again; nothing is fetched."""

import numpy as np
import pytest

from palpate.experiments import public_parts
from palpate.experiments.public_parts import Source, Unavailable, fetch, joined, load_parts, manifest
from palpate.experiments.random_solids import prism
from palpate.experiments.solids import Solid, load_obj, read_obj, save_obj


def gear(name: str, teeth: int) -> Solid:
    angles = np.pi * np.arange(2 * teeth) / teeth
    radii = np.where(np.arange(2 * teeth) % 2, 30.0, 20.0)
    return prism(name, np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1), 9.0)


class Shop:
    """A source of gears whose number of teeth is their name; remembers what was asked of it."""

    def __init__(self):
        self.asked = []

    def source(self):
        return Source("shop", "none", "gears", lambda _: [str(k) for k in range(3, 40)], self.made)

    def made(self, _, names):
        for name in names:
            self.asked.append(name)
            yield gear(f"gear-{name}", int(name)) if int(name) % 5 else "out of stock"


@pytest.fixture
def folder(tmp_path):
    public_parts._begin(tmp_path, 0)
    return tmp_path


def test_parts_are_scaled_and_told(folder):
    kept = fetch(Shop().source(), folder, count=6, seed=0)
    assert [row["name"] for row in kept] == [solid.name for solid in load_parts(folder)]
    for row, solid in zip(kept, load_parts(folder), strict=True):
        assert (row["faces"], row["watertight"], row["license"]) == (solid.num_faces, True, "none")
        assert solid.across == pytest.approx(200.0)
        assert 20 <= solid.num_faces <= 400
    refused = {row["why"] for row in manifest(folder) if not row["kept"]}
    assert all(why == "out of stock" or why.endswith("planar faces") for why in refused)


def test_a_run_that_was_stopped_goes_on(folder):
    first = fetch(Shop().source(), folder, count=3, seed=0)
    with (folder / "manifest.jsonl").open("a") as file:
        file.write('{"source":"shop","cut sho')
    again = Shop()
    both = fetch(again.source(), folder, count=6, seed=0)
    assert both[:3] == first
    assert not {row["candidate"] for row in first} & set(again.asked)
    assert len(load_parts(folder)) == 6


def test_another_seed_needs_another_folder(folder):
    with pytest.raises(ValueError, match="seed 0, not 1"):
        manifest(folder, seed=1)


def test_a_missing_source_is_said_and_skipped(tmp_path, monkeypatch, capsys):
    def missing(_):
        raise Unavailable("pip is not installed")

    shop = Shop().source()
    monkeypatch.setattr(public_parts, "SOURCES", (Source("gone", "", "", missing, shop.made), shop))
    assert public_parts.main(["--folder", str(tmp_path), "--count", "2"]) == 1
    said = capsys.readouterr()
    assert said.err == "gone: skipped, pip is not installed\n"
    assert said.out.startswith("shop: 2 parts")


def test_a_missing_tool_is_unavailable():
    with pytest.raises(Unavailable, match="no-such-tool is not installed"):
        public_parts._run("no-such-tool")


def test_pieces_with_gaps_become_one_solid():
    pytest.importorskip("manifold3d")
    left = prism("left", np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]), 10.0).vertices
    solid = joined("two", [left, left + np.array([10.05, 2.0, 0.0])])
    assert isinstance(solid, Solid)
    assert solid.watertight
    assert solid.volume == pytest.approx(2000.0, rel=0.06)
    assert joined("apart", [left, left + np.array([30.0, 0.0, 0.0])]) == "2 bodies"


def test_obj_files_are_read_as_they_were_written(tmp_path):
    solid = gear("gear", 7)
    save_obj(tmp_path / "gear.obj", solid)
    again = load_obj(tmp_path / "gear.obj", "gear")
    assert (again.vertices == solid.vertices).all()
    assert (again.triangles == solid.triangles).all()
    [(name, _, triangles)] = read_obj("x", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/1 3/1 -1/1\n")
    assert (name, triangles.tolist()) == ("x", [[0, 1, 2], [0, 2, 3]])
