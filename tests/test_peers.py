"""The comparison with peers: when an answer is right, what pose sets fill, which rows are made anew."""

import json
import math

import numpy as np
import pytest

from palpate.experiments import campaign, peers
from palpate.experiments.peer_methods import METHODS, Method
from palpate.experiments.peer_page import markdown
from palpate.experiments.peer_truth import close_poses, mean_distances, number_of_places, share_of_all
from palpate.experiments.random_solids import prism, random_solid
from palpate.experiments.solid_particles import rotations
from palpate.experiments.solid_problems import draw_contacts, random_pose

BOX = prism("box", np.array([[-100.0, -60.0], [100.0, -60.0], [100.0, 60.0], [-100.0, 60.0]]), 30.0)
MIDDLE = np.array([0.0, 0.0, 15.0])


def moved(turn=(0.0, 0.0, 0.0), shift=(0.0, 0.0, 0.0)):
    """A turn about the middle of the box, then a shift; `(4, 4)`."""
    pose = np.eye(4)
    pose[:3, :3] = rotations(np.array([turn], dtype=float))[0]
    pose[:3, 3] = MIDDLE - pose[:3, :3] @ MIDDLE + shift
    return pose


TRUTH = random_pose(np.random.default_rng(3), 300.0)
HALF_TURN, QUARTER_TURN = (0.0, 0.0, math.pi), (0.0, 0.0, 0.5 * math.pi)


def test_mean_distances_are_those_of_the_vertices():
    poses = TRUTH @ np.stack([moved(), moved(shift=(1.2, 0.0, -0.9)), moved((0.0, 0.0, 0.01))])
    lever = math.hypot(100.0, 60.0)
    expected = [0.0, 1.5, 2.0 * lever * math.sin(0.005)]
    assert mean_distances(BOX, poses, TRUTH) == pytest.approx(expected, abs=1e-9)


def test_mean_distances_know_no_symmetric_places_apart():
    poses = TRUTH @ np.stack([moved(HALF_TURN), moved(QUARTER_TURN), moved(shift=(900.0, 0.0, 0.0))])
    same, other, far = mean_distances(BOX, poses, TRUTH)
    assert same == pytest.approx(0.0, abs=1e-9)
    assert other == far == 20.0
    assert mean_distances(BOX, poses[:0], TRUTH).shape == (0,)


@pytest.mark.parametrize("symmetry", [(0.0, 0.0, 0.0), HALF_TURN])
def test_close_poses_are_so_up_to_symmetry(symmetry):
    near = [moved(shift=(1.9, 0.0, 0.0)), moved((0.0, 0.019, 0.0))]
    far = [moved(shift=(2.1, 0.0, 0.0)), moved((0.0, 0.021, 0.0)), moved(QUARTER_TURN)]
    poses = TRUTH @ np.stack([*near, *far]) @ moved(symmetry)
    assert close_poses(BOX, poses, TRUTH).tolist() == [True, True, False, False, False]


def test_the_share_of_all_poses_is_that_of_random_ones():
    random = np.random.default_rng(0)
    poses = np.array([random_pose(random, 100.0) for _ in range(20_000)])
    angles = np.arccos(np.clip(0.5 * (np.trace(poses[:, :3, :3], axis1=1, axis2=2) - 1.0), -1.0, 1.0))
    within = (angles <= 2.0) & (np.linalg.norm(poses[:, :3, 3], axis=1) <= 90.0)
    assert share_of_all([2.0], [90.0]) == pytest.approx(within.mean(), rel=0.05)
    assert share_of_all([2.0, 2.0], [90.0, 90.0]) == pytest.approx(2.0 * share_of_all([2.0], [90.0]))
    assert share_of_all([math.pi, math.pi], [400.0, 400.0]) == 1.0
    assert share_of_all([], []) == share_of_all([0.0], [90.0]) == 0.0


def test_places_are_counted_over_all_sets():
    class Two:
        def __init__(self, shift):
            self.poses = np.stack([moved(), moved(shift=(shift, 0.0, 0.0))])

        def sample(self, count):
            return self.poses[np.arange(count) % 2]

    centers = np.array([[30.3, 0.3, 0.3], [0.3, 30.3, 0.3], [0.3, 0.3, 30.3]])
    assert number_of_places([], centers) == 0
    assert number_of_places([Two(0.0)], centers) == 1
    assert number_of_places([Two(20.0), Two(-20.0)], centers) == 3


@pytest.mark.parametrize("name", ["scaling series, 500 particles", "least squares, many starts"])
def test_a_peer_finds_the_pose_that_many_contacts_fix(name):
    solid = random_solid(np.random.default_rng(1))
    contacts = draw_contacts(
        np.random.default_rng(2), solid, TRUTH, bounds=peers.BOUNDS, count=12, manners=("around",)
    )
    poses = METHODS[name].prepare(solid, peers.SCALE)(contacts, 5)
    assert mean_distances(solid, poses, TRUTH).min() <= 2.0


def test_a_part_is_touched_with_each_number_of_contacts():
    problems = [peers.problem(number, ()) for number in range(8)]
    assert [len(one.contacts) for one in problems] == [*peers.COUNTS, *peers.COUNTS]
    assert [one.solid.name == problems[0].solid.name for one in problems[:4]] == [True] * 4
    vertices = [one.solid.vertices for one in problems]
    assert all(np.array_equal(vertices[0], other) for other in vertices[:4])
    assert not np.array_equal(vertices[0], vertices[4])
    assert not np.array_equal(problems[0].world_from_model, problems[1].world_from_model)


@pytest.fixture
def guesser(monkeypatch):
    """A peer beside palpate that always answers one and the same pose, and how often it was asked."""
    asked = []

    def prepare(solid, scale):
        return lambda contacts, seed: asked.append(seed) or np.eye(4)[None]

    monkeypatch.setattr(peers, "NAMES", (peers.OURS, "guesser"))
    monkeypatch.setitem(METHODS, "guesser", Method(prepare, "numpy", "none"))
    return asked


def of_another_build(file):
    header, *rows = file.read_text().splitlines(keepends=True)
    file.write_text(json.dumps({**json.loads(header), "build": "another"}) + "\n" + "".join(rows))


def test_methods_are_asked_anew_alone_and_the_page_has_all(tmp_path, guesser, capsys):
    page = tmp_path / "page.md"
    command = ["--runs", "1", "--out", str(tmp_path), "--page", str(page)]
    assert peers.main(command) == 0
    first = page.read_text()
    assert first == capsys.readouterr().out
    assert "| palpate | 100 % (100 %) | 100 % (100 %) | 100 % (100 %) | 100 % (100 %) |" in first
    assert "| guesser | 0 % (0 %) | 0 % (0 %) | 0 % (0 %) | 0 % (0 %) |" in first
    assert guesser == [0, 1, 2, 3]

    ours, theirs = (peers.file_of(tmp_path, name) for name in peers.NAMES)
    for file in (ours, theirs):
        of_another_build(file)
    with pytest.raises(SystemExit):
        peers.main(command)
    assert peers.main([*command, "--methods", "palpate"]) == 0
    assert campaign.read(ours)[0]["build"] != campaign.read(theirs)[0]["build"] == "another"
    assert len(guesser) == 4
    assert "| guesser | 0 % (0 %)" in page.read_text()

    peers.main([*command, "--methods", "guesser"])
    assert len(guesser) == 8


def test_rows_of_other_problems_are_not_on_the_page(tmp_path, guesser, capsys):
    peers.main(["--runs", "1", "--out", str(tmp_path)])
    peers.main(["--runs", "2", "--out", str(tmp_path), "--methods", "palpate"])
    said = capsys.readouterr()
    assert "guesser: not on the page" in said.err
    assert "guesser" not in said.out.rpartition("# Peers in space")[2]
    assert peers.saved(peers.file_of(tmp_path, "guesser"), range(4), 1) is None


@pytest.mark.parametrize("error", [ImportError("No module named 'absent'"), OSError("libusb-1.0.so.0")])
def test_a_missing_package_leaves_a_method_out(guesser, monkeypatch, error):
    def prepare(solid, scale):
        raise error

    monkeypatch.setitem(METHODS, "absent", Method(prepare, "absent", "none"))
    said = []
    assert peers.installed(["guesser", "absent", peers.OURS], said.append) == ["guesser", peers.OURS]
    assert said == [f"absent: left out, {error}\n"]


def test_the_page_has_medians_and_the_longest_time():
    def row(contacts, **more):
        return {"contacts": contacts, "true": True, "strict": False, "best": False, "places": 5, **more}

    rows = [row(3, seconds=0.1), row(3, seconds=0.2, places=9), row(3, seconds=3.0, true=False)]
    header = {"settings": {"package": "open3d 1.2", "machine": "Abacus, 1 core"}}
    text = markdown({"Open3D": (header, rows)})
    assert "| Open3D | 67 % (0 %) |" in text
    assert "| Open3D | 5 |" in text
    assert "| Open3D | 200 ms, 3.00 s |" in text
    assert "- Open3D (open3d 1.2): " in text
    assert text.endswith("Measured on: Abacus, 1 core.\n")
    assert max(map(len, text.split("## Right")[1].splitlines())) <= 120

    other = {"settings": {"package": "x 1", "machine": "Loom"}}
    assert "Abacus, 1 core (Open3D) and Loom (small_gicp)." in markdown(
        {"Open3D": (header, rows), "small_gicp": (other, rows)}
    )
