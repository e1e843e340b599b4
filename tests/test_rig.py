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
from palpate.experiments import rig_control, rig_drill, rig_sensor
from palpate.rig import SIZE, Bearing, RigProbe, RigSpec, bounds_of, without_errors
from palpate.rig import rig_sensor as sensor_of
from palpate.rig.beam import Beam
from palpate.rig.pieces import solid_pieces
from palpate.rig.recording import STATES

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
        assert row["reply"] == "Skid" or "stem" in row["reason"]


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


def test_faults_are_faults_and_the_rig_stops():
    thick = replace(RigSpec(), stem_radius=7.0)
    probe = RigProbe(BLOCK, HERE, spec=thick, seed=0)
    reply = probe.touch([80, 160], [120, 160])
    assert isinstance(reply, palpate.Fault) and "stem" in reply.reason
    assert isinstance(probe.touch([80, 160], [120, 160]), palpate.Fault)
    spec = RigSpec()
    fast = replace(spec, control=replace(spec.control, guard_speed=150.0))
    reply = RigProbe(BLOCK, HERE, spec=fast, seed=0).touch([20, 160], [150, 160])
    assert isinstance(reply, palpate.Fault) and "22 N" in reply.reason
    hasty = replace(spec, control=replace(spec.control, settle=0.3))
    reply = RigProbe(BLOCK, HERE, spec=hasty, seed=0).touch([85, 160], [120, 160])
    assert isinstance(reply, palpate.Fault) and "settle" in reply.reason
    fresh = RigProbe(BLOCK, HERE, spec=thick, seed=0)
    result = palpate.identify([BLOCK], fresh, fresh.sensor, [[0, 0], [290, 320]])
    assert result.status == "fault" and "stem" in result.reason


def test_it_does_not_start_where_it_touches():
    assert isinstance(RigProbe(BLOCK, HERE).touch([96, 160], [120, 160]), palpate.AlreadyTouching)


def test_guarded_moves_press_on_no_more_than_they_may():
    for number in range(len(rig_control.SPEEDS)):
        row = rig_control.task(number)
        assert row["reply"] == "Hit" and row["pressed"] <= rig_control.predicted(row["speed"])


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


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--probe", "rig", "--noise", "none"], "--noise none"),
        (["--guard-speed", "10"], "--probe rig"),
        (["--probe", "rig", "--position-error", "0.1"], "position_error"),
        (["--probe", "rig", "--normal-error-deg", "0.5"], "normal_error"),
        (["--probe", "rig", "--without", "gravity"], "drift,creep,noise"),
        (["--probe", "rig", "--film", "run.mp4"], ".html"),
        (["--probe", "rig", "--press-force", "30"], "control.force"),
    ],
)
def test_bad_flags(flags, said, capsys):
    assert main(["identify", "boot", *flags]) == 2
    error = capsys.readouterr().err
    assert said in error and "Traceback" not in error


def test_bad_arguments():
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
