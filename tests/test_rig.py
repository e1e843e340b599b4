"""The rig: mechanics, bounds against the physics, control, and closed loops through it."""

import json
import math
import sys
from dataclasses import replace

import numpy as np
import pytest
from test_cli import run, validate

import palpate
from palpate.cli import main
from palpate.experiments import rig_control, rig_drill, rig_sensor, rig_solids
from palpate.probe import random_pose
from palpate.rig import SIZE, Bearing, RigProbe, RigSpec, bounds_of, without_errors
from palpate.rig import rig_sensor as sensor_of
from palpate.rig.beam import Beam
from palpate.rig.pieces import solid_pieces
from palpate.rig.recording import STATES
from palpate.truth import number_of_truth

BLOCK = palpate.Model.polygon([[100, 60], [180, 60], [180, 260], [100, 260]], name="block")
HERE = np.eye(3)


def test_the_thesiss_beam_recomputed():
    """MATH row 96."""
    printed = Beam(length=110.0)
    assert Beam().length_for(22.0, 0.0015) == pytest.approx(106.9, abs=0.05)
    assert printed.strain_per_force * 22.0 == pytest.approx(0.00155, abs=1e-5)
    assert printed.deflection(22.0) == pytest.approx(2.64, abs=0.01)
    assert printed.deflection(9.0) == pytest.approx(1.08, abs=0.01)
    assert math.degrees(printed.slope(22.0)) == pytest.approx(2.06, abs=0.01)


def test_bounds_are_the_thesiss_or_better_and_grow_with_their_sources():
    own = bounds_of(RigSpec(), dimension=2, size=SIZE[2])
    assert math.degrees(own.normal_error) <= 1.0 and own.position_error <= 0.5
    worse = RigSpec()
    for group, name in (("electronics", "drift"), ("electronics", "creep"), ("gantry", "resolution")):
        part = getattr(worse, group)
        spec = replace(RigSpec(), **{group: replace(part, **{name: 2.0 * getattr(part, name)})})
        more = bounds_of(spec, dimension=2, size=SIZE[2])
        assert more.position_error > own.position_error
    clean = bounds_of(without_errors(RigSpec(), "drift", "creep"), dimension=2, size=SIZE[2])
    assert clean.normal_error < own.normal_error


@pytest.mark.parametrize("number", range(0, 45))
def test_readings_are_within_their_bounds(number):
    row = rig_sensor.task(number)
    if row["reply"] == "Hit":
        assert row.get("normal_deg", 0.0) <= row["bounds"]["normal_deg"]
        assert max(row["rest"], row["first"]) <= row["bounds"]["position"]
    else:
        assert row["reply"] == "Skid" or "stem" in (row["reason"] or "")


@pytest.mark.parametrize("number", range(12))
def test_closed_loops_lose_no_truth(number):
    row = rig_drill.task(number)
    assert not row["lost"] and row["status"] in ("solved", "inseparable", "no_usable_path")


def test_the_same_seed_is_the_same_run_and_another_is_not():
    def touched(seed):
        return RigProbe(BLOCK, HERE, seed=seed).touch([85, 160], [110, 165]).contact

    assert touched(4) == touched(4) and touched(4) != touched(5)


def test_a_corner_that_sticks_in_has_no_normal():
    notch = palpate.Model.polygon(
        [[100, 60], [180, 60], [180, 260], [100, 260], [100, 180], [130, 160], [100, 140]], name="notch"
    )
    reply = RigProbe(notch, HERE, seed=0).touch([80, 160], [140, 160])
    assert isinstance(reply, palpate.Hit) and reply.contact.normal is None
    assert notch.distance(HERE, reply.contact.center) == pytest.approx(5.0, abs=0.2)


def test_a_steep_touch_is_a_skid_whose_way_was_free():
    probe = RigProbe(BLOCK, HERE, seed=0)
    reply = probe.touch([80, 100], [120, 240])
    assert isinstance(reply, palpate.Skid)
    assert BLOCK.distance(HERE, reply.free.end) > 5.0


def test_a_miss_and_free_moves_and_what_is_in_their_way():
    probe = RigProbe(BLOCK, HERE, seed=0)
    assert isinstance(probe.touch([50, 20], [250, 20]), palpate.Miss)
    assert probe.move([[250, 20], [250, 300]]) is None
    np.testing.assert_allclose(probe.plant.tip, [250, 300], atol=0.3)
    touched = probe.move([[140, 300], [140, 200]])
    assert isinstance(touched, palpate.UnexpectedTouch) and abs(touched.where[1] - 265.0) < 3.0


@pytest.mark.parametrize("overlap", [0.01, 0.03, 0.045])
def test_a_zero_is_not_taken_where_something_touches_lightly(overlap):
    """A corner beside the line, by less than the guard force, where the tip backs off to take its zero."""
    corner = [143.0, 165.0 - overlap]
    notch = [[150, 100], [200, 100], [200, 220], [130, 220], [130, 200], corner, [150, 200]]
    part = palpate.Model.polygon(notch, name="notch")
    for seed in range(3):
        reply = RigProbe(part, HERE, seed=seed).touch([100, 160], [160, 160])
        assert isinstance(reply, palpate.Fault) and "after it backed off" in reply.reason
        at_once = RigProbe(part, HERE, seed=seed).touch([143, 160 - overlap + 0.01], [143, 100])
        assert isinstance(at_once, palpate.AlreadyTouching)


@pytest.mark.parametrize("speed", [10.0, 20.0])
def test_a_slow_graze_is_no_miss(speed):
    """Along a face that comes nearer by less than drift could be taken for, deeper than the path error."""
    spec = replace(RigSpec(), control=replace(RigSpec().control, guard_speed=speed))
    for seed in range(3):
        probe = RigProbe(BLOCK, HERE, spec=spec, seed=seed)
        deep = probe.sensor.path_error + 0.05
        reply = probe.touch([94.9, 58], [95.0 + deep, 262])
        assert not isinstance(reply, palpate.Miss), reply


def test_a_way_that_is_said_to_be_free_is_free():
    """Lines that graze parts, by more and by less than the path error: against distances to the part."""
    replies = {"Miss": 0, "Hit": 0, "Skid": 0, "Fault": 0}
    for number in range(60):
        random = np.random.default_rng([number, 31])
        part = palpate.bundled_parts()[number % 9]
        pose = random_pose(part, np.array([[0.0, 0.0], [290.0, 320.0]]), room=25.0, random=random)
        corners = part.vertices @ pose[:2, :2].T + pose[:2, 2]
        turn = random.uniform(0.0, 2.0 * math.pi)
        along, aside = (np.array([math.cos(turn + q), math.sin(turn + q)]) for q in (0.0, math.pi / 2))
        offset = (corners @ aside).max() + 5.0 - random.uniform(-0.3, 0.9)
        first = (corners @ along)[np.argmax(corners @ aside)]
        start, end = (
            (first + side * random.uniform(10.0, 60.0)) * along + offset * aside for side in (-1, 1)
        )
        if not all(((point > -25.0) & (point < [315.0, 345.0])).all() for point in (start, end)):
            continue
        probe = RigProbe(part, pose, seed=number)
        reply = probe.touch(start, end)
        replies[type(reply).__name__] += 1
        sensor = probe.sensor
        if isinstance(reply, palpate.Fault):
            continue
        if isinstance(reply, palpate.Hit):
            free = (reply.contact.center - start) @ along - sensor.position_error
        else:
            miss = reply if isinstance(reply, palpate.Miss) else reply.free
            free = (miss.end - start) @ along
        for share in np.linspace(0.0, 1.0, 200):
            distance = part.distance(pose, start + share * max(0.0, free) * along)
            assert distance >= sensor.tip_radius - sensor.path_error - 1e-9, (number, reply)
    assert replies["Miss"] >= 10 and replies["Hit"] + replies["Skid"] >= 10 > replies["Fault"], replies


def test_what_a_miss_says_holds_by_itself():
    """A sensor that states no path error is taken to have its position error, in the replies too."""
    plain = sensor_of()
    stated = palpate.Sensor(plain.position_error, plain.normal_error, plain.max_incidence, plain.tip_radius)
    miss = RigProbe(BLOCK, HERE, stated, seed=0).touch([50, 20], [250, 20])
    assert isinstance(miss, palpate.Miss) and miss.path_error == stated.position_error


def test_faults_are_faults_and_the_rig_stops():
    (hexagon,) = palpate.load_models("hexagon")
    above = np.eye(4)
    above[:3, 3] = [150, 160, 90 - hexagon.vertices[:, 2].min()]
    probe = RigProbe(hexagon, above, seed=0)
    reply = probe.touch([20, 160, 60], [150, 160, 60])
    assert isinstance(reply, palpate.Fault) and "stem" in reply.reason
    assert isinstance(probe.touch([20, 160, 60], [150, 160, 60]), palpate.Fault)
    spec = RigSpec()
    fast = replace(spec, control=replace(spec.control, free_speed=300.0, acceleration=5000.0))
    reply = RigProbe(BLOCK, HERE, spec=fast, seed=0).move([[20, 160], [150, 160]])
    assert isinstance(reply, palpate.Fault) and "22 N" in reply.reason
    hasty = replace(spec, control=replace(spec.control, settle=0.3))
    reply = RigProbe(BLOCK, HERE, spec=hasty, seed=0).touch([85, 160], [120, 160])
    assert isinstance(reply, palpate.Fault) and "settle" in reply.reason
    fresh = RigProbe(BLOCK, HERE, spec=hasty, seed=0)
    result = palpate.identify([BLOCK], fresh, fresh.sensor, [[0, 0], [290, 320]])
    assert result.status == "fault" and "settle" in result.reason


def test_it_does_not_start_where_it_touches():
    assert isinstance(RigProbe(BLOCK, HERE).touch([96, 160], [120, 160]), palpate.AlreadyTouching)


def test_guarded_moves_press_on_no_more_than_they_may():
    for number in range(len(rig_control.SPEEDS)):
        row = rig_control.task(number)
        assert row["reply"] == "Hit" and row["pressed"] <= RigSpec().most_pressed(row["speed"])


@pytest.mark.parametrize("mode", rig_control.MODES)
def test_control_is_stable(mode):
    shares = np.array(rig_control.step(mode, 1.0, 0)["shares"])
    assert np.abs(shares[-20:] - 1.0).max() < 0.05 and shares.max() < 1.1


def test_pieces_of_solids_fill_them():
    manifold3d = pytest.importorskip("manifold3d")
    for model in palpate.bundled_solids():
        pieces = [manifold3d.Manifold.hull_points(points) for points in solid_pieces(model)]
        mesh = manifold3d.Mesh64(np.array(model.vertices), np.array(model.triangles, dtype=np.uint64))
        whole = manifold3d.Manifold(mesh)
        assert sum(piece.volume() for piece in pieces) == pytest.approx(whole.volume(), rel=1e-6)


def test_identify_with_the_rig(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    flags = ("drill-left", "drill-right", "--probe", "rig", "--truth", "drill-right", "--seed", 3)
    files = ("--record", "run.svg", "--film", "run.html", "--log", "run.jsonl")
    told = json.loads(run(capsys, "identify", *flags, *files, "--json"))
    validate(told, "result-1")
    assert told["status"] == "solved" and told["rig_seconds"]["initial_data"] > 5.0
    validate(json.loads((tmp_path / "run.jsonl").read_text().splitlines()[0]), "run-1")
    page = (tmp_path / "run.html").read_text()
    assert "/*RUN*/" not in page and "http" not in page.replace("http-equiv", "")
    assert (tmp_path / "run.svg").stat().st_size > 1000
    words = run(capsys, "identify", *flags, "--without", "noise,drift", "--guard-speed", 30)
    assert "simulated" in words and "among what is left" in words
    # The last frame is the end of the last move: what it met is drawn.
    shown = json.loads(page.partition("const run = ")[2].partition(";\n")[0].replace("<\\/", "</"))
    assert shown["times"][-1] >= shown["steps"][-1]["end"] and len(shown["steps"]) == told["touches"]


def test_what_was_not_moved_is_not_recorded(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    drawn = ("boot", "--probe", "rig", "--drawn", 6, "--record", "run.svg", "--film", "run.html")
    words = run(capsys, "identify", *drawn)
    assert "there is nothing to record or film" in words and not list(tmp_path.iterdir())
    words = run(capsys, "identify", "boot", "--max-touches", 1, "--workspace", "-900,-900,900,900")
    assert "nothing was recognized" in words


def test_a_solid_is_identified_from_above():
    result, probe, truth, pose = rig_solids.run(1)
    assert result.status == "solved" and probe.sensor.stem is not None
    assert number_of_truth(result.hypotheses, truth, pose) == 0
    ways = [step.end - step.start for step in result.steps]
    assert all(way[2] < 0.0 for way in ways)


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--probe", "rig", "--noise", "none"], "--noise none"),
        (["--guard-speed", "10"], "--probe rig"),
        (["--probe", "rig", "--position-error", "0.1"], "--position-error: must hold for the rig"),
        (["--probe", "rig", "--normal-error-deg", "0.5"], "--normal-error-deg: must hold for the rig"),
        (["--probe", "rig", "--without", "gravity"], "drift,creep,noise"),
        (["--probe", "rig", "--film", "run.mp4"], ".html"),
        (["--probe", "rig", "--press-force", "30"], "--press-force: must stay below"),
        (["--probe", "rig", "--guard-speed", "60"], "--guard-speed: must be so slow"),
        (["--probe", "rig", "--tip-radius", "2"], "--tip-radius: must be larger than the stem's"),
    ],
)
def test_bad_flags(flags, said, capsys):
    assert main(["identify", "boot", *flags]) == 2
    error = capsys.readouterr().err
    assert said in error and "Traceback" not in error


def test_bad_arguments():
    short, fast, near = RigSpec().electronics, RigSpec().control, [[0, 0], [100, 100]]
    for spec, workspace, said in (
        (RigSpec(electronics=replace(short, full_scale=10.0)), None, r"spec\.electronics\.full_scale"),
        (RigSpec(control=replace(fast, guard_speed=3.0)), None, r"drift may pass for a touch"),
        (RigSpec(control=replace(fast, clear=0.05)), near, r"spec\.control\.clear"),
        (RigSpec(stem_radius=5.0), None, r"spec\.bearing\.radius: must be larger than the stem's"),
    ):
        with pytest.raises(ValueError, match=said):
            RigProbe(BLOCK, HERE, spec=spec, workspace=workspace)
    with pytest.raises(ValueError, match="not closed"):
        RigProbe(palpate.Model.segments([[[0, 0], [10, 0]]], name="edge"), HERE)
    with pytest.raises(ValueError, match=r"spec\.bearing\.radius"):
        sensor_of(replace(RigSpec(), bearing=Bearing(radius=-1.0)))
    with pytest.raises(ValueError, match="tip_radius"):
        RigProbe(BLOCK, HERE, palpate.Sensor(4.0, 0.1, 1.0, 2.0))
    with pytest.raises(ValueError, match="out of reach"):
        RigProbe(BLOCK, HERE).touch([-100, 0], [10, 0])
    with pytest.raises(ValueError, match="names"):
        without_errors(RigSpec(), "gravity")


def test_a_missing_library_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ValueError, match=r"pip install 'palpate\[sim\]'"):
        RigProbe(BLOCK, HERE)


def test_every_state_is_seen_and_nothing_goes_on_for_ever():
    probe = RigProbe(BLOCK, HERE, seed=0)
    probe.touch([80, 160], [120, 160])
    probe.move([[80, 160], [80, 20]])
    assert set(probe.recording.states.tolist()) == set(range(len(STATES)))
    assert probe.clock < 15.0
